//! What a motion file holds: points, coordinates or a skeleton, their frames, and where in the world they are.

use super::facts::{Facts, Odd, shortened};
use crate::Error;
use sinew_formats::point_table::PointTable;
use sinew_motion::convert::{self, Content, Motion};
use std::path::Path;

/// Facts of a motion; `skeleton` is the ASF file of an AMC file.
pub(super) fn facts(path: &Path, skeleton: Option<&Path>) -> Result<Facts, Error> {
    Ok(motion_facts(path, convert::read(path, skeleton, None)?))
}

/// Facts of a motion that was read.
pub(super) fn motion_facts(path: &Path, motion: Motion) -> Facts {
    let kind = match &motion.content {
        Content::Points(points) => format!("{} points", points.names.len()),
        Content::Coordinates(coordinates) => format!("{} coordinates", coordinates.columns.len()),
        Content::Skeleton(skeleton) => format!("skeleton of {} joints", skeleton.joints.len()),
    };
    let mut facts = Facts::new(format!("{}: {}, {kind}", path.display(), motion.format.name()));
    let seconds = if motion.rate_hz > 0.0 { motion.frames() as f64 / motion.rate_hz } else { 0.0 };
    // Times in the file have few digits.
    let rate_hz = (1e3 * motion.rate_hz).round() / 1e3;
    facts.row("frames", format!("{} at {rate_hz} per second, {seconds:.2} s", motion.frames()));
    let names: Vec<String> = match &motion.content {
        Content::Points(points) => points.names.clone(),
        Content::Coordinates(coordinates) => coordinates.columns.clone(),
        Content::Skeleton(skeleton) => skeleton.joints.iter().map(|joint| joint.name.clone()).collect(),
    };
    facts.row("names", shortened(&names));
    if let Some(points) = motion.points() {
        extent(&mut facts, &points);
    }
    facts.odd.extend(motion.warnings.into_iter().map(Odd::Words));
    facts
}

fn extent(facts: &mut Facts, points: &PointTable) {
    let all = points.frames.iter().flatten();
    let missing = all.clone().filter(|point| point.is_none()).count();
    if missing > 0 {
        facts.row("missing", format!("{missing} of {} points", points.names.len() * points.frames.len()));
    }
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for point in all.flatten() {
        for k in 0..3 {
            (low[k], high[k]) = (low[k].min(point[k]), high[k].max(point[k]));
        }
    }
    if low[0] <= high[0] {
        let range = |k: usize| format!("{:.2} to {:.2}", low[k], high[k]);
        facts.row("world, m", format!("x {}, y {}, z {} (up)", range(0), range(1), range(2)));
        let height = high[2] - low[2];
        if (0..3).all(|k| high[k] - low[k] < 0.05) && points.names.len() > 1 {
            facts.odd.push("all points lie within 5 cm; is the unit of the file right?".into());
        }
        if height > 20.0 {
            facts
                .odd
                .push(format!("points spread over {height:.0} m in height; is the unit of the file right?").into());
        }
    }
}
