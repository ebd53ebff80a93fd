//! How good a folder of results is: joints against a file of true ones, intervals, speed.

use crate::support::outcome::Outcome;
use serde_json::{Value, json};
use sinew::formats::trc;
use sinew_tests::evaluation::LIMB_JOINTS;
use std::path::Path;

/// Frames below this mean error count as followed, millimetres.
const FOLLOWED_MM: f64 = 150.0;

/// What came of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Worth {
    /// Mean distance of the twelve limb joints, millimetres.
    pub(crate) error_mm: f64,
    /// Share of frames whose mean distance is below 150 mm.
    pub(crate) followed: f64,
    /// Share of true coordinates within the 90 % intervals.
    pub(crate) covered: f64,
    /// Share of frames at which tracking began again.
    pub(crate) restarted: f64,
    /// Frames per second, without the set-up.
    pub(crate) frames_per_second: f64,
}

impl Worth {
    pub(super) fn to_json(self) -> Value {
        let Self { error_mm, followed, covered, restarted, frames_per_second } = self;
        json!({
            "error_mm": error_mm,
            "followed": followed,
            "covered": covered,
            "restarted": restarted,
            "frames_per_second": frames_per_second,
        })
    }

    pub(super) fn from_json(value: &Value) -> Self {
        let number = |name: &str| value[name].as_f64().unwrap_or(f64::NAN);
        Self {
            error_mm: number("error_mm"),
            followed: number("followed"),
            covered: number("covered"),
            restarted: number("restarted"),
            frames_per_second: number("frames_per_second"),
        }
    }
}

/// Reads `joints.csv`, `summary.json` and `timings.json` of a folder, and a TRC file of true joints of the same frames.
pub(crate) fn of(folder: &Path, truth: &Path) -> Outcome<Worth> {
    let json =
        |name: &str| -> Outcome<Value> { Ok(serde_json::from_str(&std::fs::read_to_string(folder.join(name))?)?) };
    let (timings, summary) = (json("timings.json")?, json("summary.json")?);
    let name = truth.display().to_string();
    let truth = trc::read(&name, &std::fs::read_to_string(truth)?)?;
    let text = std::fs::read_to_string(folder.join("joints.csv"))?;
    let found = compared(&text, |frame, joint| truth.point_in_world(frame, truth.marker_index(joint)?))?;
    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
    let frames_per_second = number(&timings["frames_per_second"]);
    let restarted = number(&summary["restarted_frames"]) / number(&summary["frame_count"]);
    Ok(Worth { restarted, frames_per_second, ..found })
}

/// Mean distance of the limb joints, millimetres, where the true pose of the first frame is carried along by the true middle of the hips.
pub(super) fn held_mm(truth: &Path) -> Outcome<f64> {
    let truth = trc::read(&truth.display().to_string(), &std::fs::read_to_string(truth)?)?;
    let at = |frame: usize, name: &str| truth.point_in_world(frame, truth.marker_index(name)?);
    let hips = |frame: usize| {
        let (left, right) = (at(frame, "LHip")?, at(frame, "RHip")?);
        Some([0, 1, 2].map(|k: usize| 0.5 * (left[k] + right[k])))
    };
    let mut distances = vec![];
    for frame in 0..truth.frames.len() {
        for joint in LIMB_JOINTS {
            let places = [at(0, joint), hips(0), at(frame, joint), hips(frame)];
            let [Some(first), Some(first_hips), Some(now), Some(hips_now)] = places else { continue };
            let square = |k: usize| (first[k] - first_hips[k] - now[k] + hips_now[k]).powi(2);
            distances.push(1e3 * (0..3).map(square).sum::<f64>().sqrt());
        }
    }
    match distances.len() {
        0 => Err("no joints beside hips in the file of truth".into()),
        count => Ok(distances.iter().sum::<f64>() / count as f64),
    }
}

/// Compares a table of joints with their true places, all but for the speed.
fn compared(text: &str, truth: impl Fn(usize, &str) -> Option<[f64; 3]>) -> Outcome<Worth> {
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().ok_or("an empty table of joints")?.split(',').collect();
    let column = |name: &str| header.iter().position(|found| *found == name).ok_or(format!("no column {name}"));
    let triple = |end: &str| -> Outcome<[usize; 3]> {
        let [x, y, z] = ["x", "y", "z"].map(|axis| column(&format!("{axis}_{end}_m")));
        Ok([x?, y?, z?])
    };
    let (frame, joint) = (column("frame")?, column("joint")?);
    let (mean, low, high) = (triple("mean")?, triple("q05")?, triple("q95")?);
    let (mut sums, mut inside, mut judged): (Vec<[f64; 2]>, _, _) = (vec![], 0_usize, 0_usize);
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let of = |columns: [usize; 3]| columns.map(|k| cells[k].parse::<f64>().unwrap_or(f64::NAN));
        let number: usize = cells[frame].parse()?;
        if !LIMB_JOINTS.contains(&cells[joint]) {
            continue;
        }
        let Some(true_place) = truth(number, cells[joint]) else { continue };
        let (mean, low, high) = (of(mean), of(low), of(high));
        sums.resize(sums.len().max(number + 1), [0.0; 2]);
        let distance = (0..3).map(|k| (mean[k] - true_place[k]).powi(2)).sum::<f64>().sqrt();
        sums[number] = [sums[number][0] + 1e3 * distance, sums[number][1] + 1.0];
        inside += (0..3).filter(|&k| low[k] <= true_place[k] && true_place[k] <= high[k]).count();
        judged += 3;
    }
    let frames: Vec<f64> = sums.iter().filter(|[_, count]| *count > 0.0).map(|[sum, count]| sum / count).collect();
    if frames.is_empty() {
        return Err("no joint of the results has a true place".into());
    }
    let count = frames.len() as f64;
    Ok(Worth {
        error_mm: frames.iter().sum::<f64>() / count,
        followed: frames.iter().filter(|error| **error < FOLLOWED_MM).count() as f64 / count,
        covered: inside as f64 / judged as f64,
        restarted: f64::NAN,
        frames_per_second: f64::NAN,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_are_compared_frame_by_frame() {
        let header =
            "frame,time_s,person,joint,x_mean_m,y_mean_m,z_mean_m,x_q05_m,y_q05_m,z_q05_m,x_q95_m,y_q95_m,z_q95_m";
        let text = format!(
            "{header}\n0,0,0,RKnee,1,2,3,0.9,1.9,2.9,1.1,2.1,3.1\n0,0,0,Nose,9,9,9,9,9,9,9,9,9\n1,0,0,RKnee,1,2,3.3,0.9,1.9,3.2,1.1,2.1,3.4\n"
        );
        let found = compared(&text, |_, _| Some([1.0, 2.0, 3.0])).unwrap();
        assert!((found.error_mm - 150.0).abs() < 1e-9, "{found:?}");
        assert_eq!((found.followed, found.covered), (0.5, 5.0 / 6.0));
        assert!(compared(&text, |_, _| None).is_err() && compared("frame\n", |_, _| None).is_err());
    }
}
