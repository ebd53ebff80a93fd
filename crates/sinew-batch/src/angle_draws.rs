//! Joint angles of a trial, draw by draw: their mean over time and, of smoothed results, their range.
//!
//! Draws of a filtered run share what lasts over the run and nothing else, so that a range over time of one of them would hold the errors of single frames; a mean over time does not.
//! In runs with one set-up draw i is of the same constants: statistics over trials are taken draw by draw, and what the trials share does not average out.

use crate::Error;
use serde_json::Value;
use sinew::angles::{AngleDraws, Convention, JointAngles};
use sinew::body::KinematicTree;
use sinew::formats::source_text::{MAX_CONFIG_BYTES, MAX_TEXT_BYTES, decode};
use sinew::setup::Setup;
use sinew_results::stored_array::stored_array_in;
use sinew_results::{Storage, read_stored};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

/// Name of the table in a result folder.
pub(super) const ANGLE_DRAWS: &str = "angle_draws.csv";

/// Heads of its columns.
const HEADS: &str = "name,draw,mean_deg,range_deg\n";

/// An angle over the time of a trial, by draw.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct AngleOverTime {
    /// Mean, degrees.
    pub(super) mean_deg: Vec<f64>,
    /// Greatest less least, degrees; of smoothed results only.
    pub(super) range_deg: Vec<f64>,
}

/// Writes the table of a result folder of one person; `body` is the body of the run, read from its `setup.toml` if `None`. Writes no file where there are no draws, or where a standing trial gives the zero of the angles. Does not wait for the disk.
///
/// # Errors
/// Files of the folder that cannot be read, and of the disk.
pub(super) fn write_angle_draws(
    storage: &dyn Storage,
    folder: &Path,
    body: Option<&KinematicTree>,
) -> Result<(), Error> {
    let Some(angles) = angles_over_time(storage, folder, body)? else { return Ok(()) };
    let mut text = HEADS.to_owned();
    for (name, AngleOverTime { mean_deg, range_deg }) in &angles {
        for (draw, mean) in mean_deg.iter().enumerate() {
            let range = range_deg.get(draw).map(|range| format!("{range:.6}")).unwrap_or_default();
            let _ = writeln!(text, "{name},{draw},{mean:.6},{range}");
        }
    }
    let path = folder.join(ANGLE_DRAWS);
    let written = storage.create(&path).and_then(|mut file| file.write_all(text.as_bytes()));
    Ok(written.map_err(sinew::Error::io("write", path))?)
}

/// The body of a result folder.
fn stored_body(storage: &dyn Storage, folder: &Path) -> Result<KinematicTree, Error> {
    let path = folder.join("setup.toml");
    let name = path.display().to_string();
    let bytes = read_stored(storage, &path, MAX_CONFIG_BYTES)?;
    let text = decode(&name, &bytes, MAX_CONFIG_BYTES).map_err(sinew::Error::from)?;
    Ok(Setup::from_toml(&name, text)?.tree())
}

fn angles_over_time(
    storage: &dyn Storage,
    folder: &Path,
    body: Option<&KinematicTree>,
) -> Result<Option<Vec<(String, AngleOverTime)>>, Error> {
    let summary = read_stored(storage, &folder.join("summary.json"), MAX_TEXT_BYTES)?;
    let summary: Value = serde_json::from_slice(&summary).unwrap_or_default();
    let convention = summary["angles"]["convention"].as_str().and_then(Convention::named);
    let has_zero = summary["settings"].get("static").is_some();
    let (Some(convention), false) = (convention, has_zero) else { return Ok(None) };
    let body = body.cloned().map_or_else(|| stored_body(storage, folder), Ok)?;
    let array = stored_array_in(storage, folder, "posterior/angle")?;
    let Some(draws) = array.and_then(|array| AngleDraws::new(body, &array.shape, array.values)) else {
        return Ok(None);
    };
    let is_smoothed = summary["kind"] == "smoothed";
    let angles = JointAngles::new(draws.tree(), &[], true, convention);
    let mut all: Vec<(String, AngleOverTime)> =
        angles.names().iter().map(|name| (name.clone(), AngleOverTime::default())).collect();
    let mut raw = vec![0.0; angles.raw_count()];
    for draw in 0..draws.draws() {
        let mut before: Option<Vec<f64>> = None;
        let mut over = vec![(0.0, f64::INFINITY, f64::NEG_INFINITY); all.len()];
        for frame in 0..draws.frames() {
            angles.raw(&draws.state(draw, frame), before.as_deref(), &mut raw);
            for (angle, (sum, least, most)) in over.iter_mut().enumerate() {
                let degrees = angles.signed(angle, &raw).to_degrees();
                (*sum, *least, *most) = (*sum + degrees, least.min(degrees), most.max(degrees));
            }
            before = Some(raw.clone());
        }
        for ((_, angle), (sum, least, most)) in all.iter_mut().zip(over) {
            angle.mean_deg.push(sum / draws.frames() as f64);
            if is_smoothed {
                angle.range_deg.push(most - least);
            }
        }
    }
    Ok(Some(all))
}

/// The table as it was written.
pub(super) fn read_angle_draws(text: &str) -> Vec<(String, AngleOverTime)> {
    let mut all: Vec<(String, AngleOverTime)> = vec![];
    for line in text.lines().skip(1) {
        let mut cells = line.split(',');
        let (Some(name), Some(_), Some(mean)) = (cells.next(), cells.next(), cells.next()) else { continue };
        let Ok(mean) = mean.parse() else { continue };
        if all.last().is_none_or(|(known, _)| known != name) {
            all.push((name.to_owned(), AngleOverTime::default()));
        }
        if let Some((_, angle)) = all.last_mut() {
            angle.mean_deg.push(mean);
            angle.range_deg.extend(cells.next().and_then(|range| range.parse::<f64>().ok()));
        }
    }
    all
}
