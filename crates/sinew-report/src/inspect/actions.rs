//! The actions of a run, and the errors of its joints beside them.

use super::action_picture::action_picture;
use super::error::InspectError;
use super::facts::Facts;
use super::table_file;
use crate::Error;
use sinew_body::points::distance;
use sinew_core::estimators::mean;
use sinew_formats::point_table::PointTable;
use sinew_motion::convert;
use sinew_results::action_trace::{ActionTrace, PartActions};
use std::path::{Path, PathBuf};

/// Files of a result folder that say where the joints are, and where they were in truth.
const FOUND: &str = "markers.trc";
const TRUTH: &str = "truth.trc";

pub(super) fn facts(path: &Path) -> Result<Facts, Error> {
    let trace = ActionTrace::read(path)?;
    let mut facts = table_file::facts(path)?.unwrap_or_else(|| Facts::new(path.display().to_string()));
    for PartActions { name, frames } in &trace.parts {
        let shares = || frames.iter().flatten();
        let by_primitives: f64 = shares().filter(|(by, _)| by.is_some()).map(|(_, share)| share).sum();
        let mut clusters: Vec<usize> = shares().filter_map(|(by, _)| *by).collect();
        clusters.sort_unstable();
        clusters.dedup();
        let share = 100.0 * by_primitives / frames.len().max(1) as f64;
        facts.row(format!("part {name}"), format!("{} clusters, {share:.0} % moved by primitives", clusters.len()));
    }
    Ok(facts)
}

/// The picture of `actions.csv` as SVG, with the errors of the joints in `markers.trc` beside it: to the points of `truth`, or of `truth.trc` beside it where there is one.
///
/// # Errors
/// Files that cannot be read, and a truth without points of the same names at the same times.
pub fn picture_of_actions(path: &Path, truth: Option<&Path>) -> Result<String, Error> {
    let trace = ActionTrace::read(path)?;
    let beside = |name: &str| path.with_file_name(name);
    let truth = truth.map(Path::to_owned).or_else(|| Some(beside(TRUTH)).filter(|path| path.exists()));
    let errors = match &truth {
        Some(truth) => joint_errors(&beside(FOUND), truth)?,
        None => vec![],
    };
    let folder = path.parent().and_then(Path::file_name).map(|name| format!("{}/", name.display())).unwrap_or_default();
    let name = path.file_name().unwrap_or_default().display().to_string();
    Ok(action_picture(&format!("{folder}{name}"), &trace, &errors))
}

/// Mean distances of the points of one name in two motions, (seconds, millimetres), at the times of the first.
fn joint_errors(found: &Path, truth: &Path) -> Result<Vec<(f64, f64)>, Error> {
    let points = |path: &Path| -> Result<PointTable, Error> {
        let points = convert::read(path, None, None)?.points();
        points.ok_or_else(|| InspectError::NoPoints { path: PathBuf::from(path) }.into())
    };
    let (a, b) = (points(found)?, points(truth)?);
    let index = |name: &String| b.names.iter().position(|other| other == name);
    let pairs: Vec<(usize, usize)> =
        a.names.iter().enumerate().filter_map(|(i, name)| Some((i, index(name)?))).collect();
    let at = |second: &f64| {
        let place = b.time_s.partition_point(|other| *other < second - SAME_TIME);
        b.time_s.get(place).filter(|other| (*other - second).abs() <= SAME_TIME).map(|_| &b.frames[place])
    };
    let error = |(second, frame): (&f64, &Vec<Option<[f64; 3]>>)| {
        let truth = at(second)?;
        let apart: Vec<f64> = pairs.iter().filter_map(|&(i, j)| Some(distance(frame[i]?, truth[j]?))).collect();
        (!apart.is_empty()).then(|| (*second, 1e3 * mean(&apart)))
    };
    let errors: Vec<(f64, f64)> = a.time_s.iter().zip(&a.frames).filter_map(error).collect();
    match errors.is_empty() {
        true => Err(InspectError::OtherMotion { found: found.to_owned(), truth: truth.to_owned() }.into()),
        false => Ok(errors),
    }
}

/// How far times of two files may be apart to be of one frame, seconds.
const SAME_TIME: f64 = 0.004;

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn table(names: &[&str], rows: &[(f64, f64)]) -> String {
        let head: Vec<String> = names.iter().map(|name| format!("{name}_x_m,{name}_y_m,{name}_z_m")).collect();
        let row = |(second, x): &(f64, f64)| format!("{second}{}\n", format!(",{x},0,0").repeat(names.len()));
        format!("time_s,{}\n{}", head.join(","), rows.iter().map(row).collect::<String>())
    }

    #[test]
    fn errors_compare_points_of_one_name_at_one_time() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: String| {
            fs::write(folder.path().join(name), text).unwrap();
            folder.path().join(name)
        };
        let found = write("found.csv", table(&["Head", "Nose"], &[(0.1, 1.0), (0.2, 1.0), (0.3, 1.0)]));
        let truth = write("truth.csv", table(&["Neck", "Head"], &[(0.2001, 1.01), (0.3, 1.03)]));
        let errors = joint_errors(&found, &truth).unwrap();
        assert_eq!(errors.iter().map(|(t, mm)| (*t, mm.round())).collect::<Vec<_>>(), [(0.2, 10.0), (0.3, 30.0)]);
        let other = write("other.csv", table(&["Neck"], &[(0.2, 1.0)]));
        let words = joint_errors(&found, &other).unwrap_err().to_string();
        assert!(words.contains("other.csv: no point at a time") && words.contains("found.csv"), "{words}");
    }
}
