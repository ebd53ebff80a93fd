//! Joint angles of a trial, draw by draw: their mean over time and, of smoothed results, their range.
//!
//! Draws of a filtered run share what lasts over the run and nothing else, so that a range over time of one of them would hold the errors of single frames; a mean over time does not.
//! Angles are continuous over the time of a draw, and all draws lie about their mean direction, which is within half a turn.
//! In runs with one set-up draw i is of the same constants: statistics over trials are taken draw by draw, and what the trials share does not average out.

use crate::Error;
use serde_json::Value;
use sinew::angles::circle::{TURN_DEG, direction, near};
use sinew::angles::{AngleDraws, Convention, JointAngles};
use sinew::body::KinematicTree;
use sinew::formats::source_text::{MAX_CONFIG_BYTES, MAX_TEXT_BYTES, decode};
use sinew::setup::Setup;
use sinew_results::stored_array::stored_array_in;
use sinew_results::{Storage, own_place, read_stored};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;
use std::sync::Arc;

/// Name of the table in a result folder.
pub(super) const ANGLE_DRAWS: &str = sinew_results::ANGLE_DRAWS_NAME;

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
    storage: &Arc<dyn Storage>,
    folder: &Path,
    body: Option<&KinematicTree>,
) -> Result<(), Error> {
    let Some(angles) = angles_over_time(&**storage, folder, body)? else { return Ok(()) };
    let mut text = HEADS.to_owned();
    for (name, AngleOverTime { mean_deg, range_deg }) in &angles {
        for (draw, mean) in mean_deg.iter().enumerate() {
            let range = range_deg.get(draw).map(|range| format!("{range:.6}")).unwrap_or_default();
            let _ = writeln!(text, "{name},{draw},{mean:.6},{range}");
        }
    }
    let path = own_place(storage, folder, ANGLE_DRAWS)?;
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
    let all = over_time(&draws, convention);
    let is_smoothed = summary["kind"] == "smoothed";
    let kept = |(name, AngleOverTime { mean_deg, range_deg })| {
        (name, AngleOverTime { mean_deg, range_deg: if is_smoothed { range_deg } else { vec![] } })
    };
    Ok(Some(all.into_iter().map(kept).collect()))
}

/// Means and ranges of each angle over the time of each draw.
fn over_time(draws: &AngleDraws, convention: Convention) -> Vec<(String, AngleOverTime)> {
    let angles = JointAngles::new(draws.tree(), &[], true, convention);
    let mut all: Vec<(String, AngleOverTime)> =
        angles.names().iter().map(|name| (name.clone(), AngleOverTime::default())).collect();
    let mut raw = vec![0.0; angles.raw_count()];
    let mut first: Option<Vec<f64>> = None;
    for draw in 0..draws.draws() {
        let mut before = first.clone();
        let mut over = vec![(0.0, f64::INFINITY, f64::NEG_INFINITY); all.len()];
        for frame in 0..draws.frames() {
            angles.raw(&draws.state(draw, frame), before.as_deref(), &mut raw);
            for (angle, (sum, least, most)) in over.iter_mut().enumerate() {
                let degrees = angles.signed(angle, &raw).to_degrees();
                (*sum, *least, *most) = (*sum + degrees, least.min(degrees), most.max(degrees));
            }
            before = Some(raw.clone());
            first.get_or_insert_with(|| raw.clone());
        }
        for ((_, angle), (sum, least, most)) in all.iter_mut().zip(over) {
            angle.mean_deg.push(sum / draws.frames() as f64);
            angle.range_deg.push(most - least);
        }
    }
    for (_, AngleOverTime { mean_deg, .. }) in &mut all {
        about(direction(mean_deg.iter().copied(), TURN_DEG), mean_deg);
    }
    all
}

/// Takes each angle of the same direction that is nearest to another one.
fn about(middle_deg: f64, angles_deg: &mut [f64]) {
    angles_deg.iter_mut().for_each(|angle| *angle = near(*angle, middle_deg, TURN_DEG));
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

#[cfg(test)]
mod tests {
    use super::super::group_statistics::Groups;
    use super::*;
    use sinew::body::{Joint, Proportions, standard};
    use std::f64::consts::PI;

    const DRAWS: usize = 200;
    const FRAMES: usize = 20;

    /// Draws of somebody whose pelvis is turned to `heading_deg` with errors of 2.5°, equally spaced through the normal distribution, and sways by 4°; as files hold them, within half a turn.
    fn facing(heading_deg: f64) -> AngleDraws {
        let tree = standard::h32(&Proportions::default());
        let rotations: Vec<String> = tree
            .dof_names()
            .into_iter()
            .zip(tree.joints())
            .filter(|(_, (_, joint))| matches!(joint, Joint::Rotate(_)))
            .map(|(name, _)| name)
            .collect();
        let turn = rotations.iter().position(|name| name == "pelvis.rz").unwrap();
        let mut values = vec![0.0; DRAWS * FRAMES * rotations.len()];
        for (at, state) in values.chunks_exact_mut(rotations.len()).enumerate() {
            let (draw, frame) = (at / FRAMES, at % FRAMES);
            let sway = 4.0 * (2.0 * PI * frame as f64 / FRAMES as f64).sin();
            let heading = (heading_deg + 2.5 * errors(draw) + sway).to_radians();
            state[turn] = heading.sin().atan2(heading.cos());
        }
        AngleDraws::new(tree, &[1, DRAWS, FRAMES, rotations.len()], values).unwrap()
    }

    /// Quantiles of the logistic law that is nearest to the standard normal one, in an order that is none.
    fn errors(draw: usize) -> f64 {
        let p = ((draw * 77 % DRAWS) as f64 + 0.5) / DRAWS as f64;
        (p / (1.0 - p)).ln() / 1.702
    }

    fn heading_of(draws: &AngleDraws) -> AngleOverTime {
        let all = over_time(draws, Convention::Isb);
        all.into_iter().find(|(name, _)| name == "pelvic_rotation").unwrap().1
    }

    /// Mean of angles by its definition, and how far each is from it: no part of what is tested.
    fn circular(degrees: &[f64]) -> (f64, Vec<f64>) {
        let (sin, cos) =
            degrees.iter().fold((0.0, 0.0), |(s, c), x| (s + x.to_radians().sin(), c + x.to_radians().cos()));
        let middle = f64::atan2(sin, cos).to_degrees();
        let apart = degrees.iter().map(|x| {
            let turn = (x - middle).to_radians();
            turn.sin().atan2(turn.cos()).to_degrees()
        });
        (middle, apart.collect())
    }

    #[test]
    fn the_mean_of_an_angle_over_time_does_not_know_the_cut() {
        for heading in [0.0, 180.0, -178.0, 90.0] {
            let AngleOverTime { mean_deg, range_deg } = heading_of(&facing(heading));
            let (middle, apart) = circular(&(0..DRAWS).map(|draw| heading + 2.5 * errors(draw)).collect::<Vec<_>>());
            for (draw, mean) in mean_deg.iter().enumerate() {
                let expected = middle + apart[draw];
                let off = mean - expected;
                assert!((off - 360.0 * (off / 360.0).round()).abs() < 1e-6, "{heading}: {mean} for {expected}");
                assert!((mean - mean_deg[0]).abs() < 40.0, "{heading}: {mean} beside {}", mean_deg[0]);
            }
            assert!(range_deg.iter().all(|range| (range - 8.0).abs() < 1e-6), "{heading}: {range_deg:?}");
        }
    }

    /// Three trials of somebody who faces to 178, 182 and 186°: 182°, and ±2.5 · 1.645 for draws that all trials share.
    #[test]
    fn the_mean_over_trials_does_not_know_the_cut() {
        let mut groups = Groups::default();
        for heading in [178.0, -178.0, -174.0] {
            groups.add("all", vec![("pelvic_rotation".to_owned(), heading_of(&facing(heading)))]);
        }
        let found = groups.statistics();
        let mean = found.iter().find(|angle| angle.what == "mean over time").unwrap();
        let mut shared: Vec<f64> = (0..DRAWS).map(|draw| 2.5 * errors(draw)).collect();
        shared.sort_by(f64::total_cmp);
        assert!((mean.mean_deg + 178.0).abs() < 1e-6, "{mean:?}");
        // The tenth of 200 rising draws is where 5 % are below, the 191st where 5 % are above.
        let [low, high] = mean.interval_deg.map(|end| end + 178.0);
        assert!(low > shared[9] - 1e-6 && low < shared[10] + 1e-6, "{mean:?}");
        assert!(high > shared[189] - 1e-6 && high < shared[190] + 1e-6, "{mean:?}");
        assert!((mean.sd_between_deg - 4.0).abs() < 1e-6, "{mean:?}");
        let range = found.iter().find(|angle| angle.what == "range over time").unwrap();
        assert!((range.mean_deg - 8.0).abs() < 1e-6, "{range:?}");
    }
}
