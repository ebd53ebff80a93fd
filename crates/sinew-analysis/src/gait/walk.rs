//! Pelvis and feet of a person over time, as a result folder has them.
//!
//! Means are of the draws where the folder has draws, else they come from `joints.csv`. Feet are taken where the detector has them (`keypoints.csv`); of a layout without heels and toes the ankles stand for both.

use super::error::GaitError;
use crate::Error;
use sinew_formats::zarr::reader::NumberArray;
use sinew_results::folder_table::FolderTable;
use sinew_results::stored_array::stored_array;
use std::path::Path;

/// Sides in the order of all pairs here, as tables write them.
pub(super) const SIDES: [&str; 2] = ["left", "right"];

/// Letters with which names of points on a side begin.
const LETTERS: [&str; 2] = ["L", "R"];

/// Frames above which draws would take more than a gigabyte.
pub(super) const MOST_FRAMES: usize = 20_000;

/// A point over the frames, metres, z up.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Path3 {
    /// Mean, frame by frame.
    pub(super) mean: Vec<[f64; 3]>,
    /// Draws, each frame by frame; none where the folder has none.
    pub(super) draws: Vec<Vec<[f64; 3]>>,
}

/// The points of a foot that say when it meets the ground and leaves it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Foot {
    /// Name and path of the heel, or of the ankle.
    pub(super) heel: (String, Path3),
    /// The same of the big toe, or of the ankle.
    pub(super) toe: (String, Path3),
}

/// A person's pelvis and feet.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Walk {
    /// Number of each frame.
    pub(super) numbers: Vec<f64>,
    pub(super) times_s: Vec<f64>,
    pub(super) pelvis: Path3,
    /// Left and right.
    pub(super) feet: [Foot; 2],
    /// Whether the layout has no feet.
    pub(super) ankles_only: bool,
    /// Time after which errors of a draw are independent, seconds; infinite where it is not known, as of a run without `--smooth`, whose draws share from frame to frame what lasts over the run and nothing else.
    pub(super) apart_s: f64,
}

impl Walk {
    /// Reads a result folder, of which `apart_s` is known.
    pub(super) fn read(folder: &Path, apart_s: f64) -> Result<Self, Error> {
        let frames = FolderTable::read(folder, "frames.csv")?;
        let (numbers, times_s) = (frames.column("frame")?, frames.column("time_s")?);
        check_times(folder, &numbers, &times_s)?;
        let joints = FolderTable::read(folder, "joints.csv")?.by_name("joint", &MEANS, numbers.len())?;
        let names: Vec<&str> = joints.iter().map(|(name, _)| name.as_str()).collect();
        let has = |name: &String| names.contains(&name.as_str());
        let seen = seen(folder)?;
        let is_seen = |name: &String| has(name) && (seen.is_empty() || seen.contains(name));
        let feet = LETTERS.map(|side| ["Heel", "BigToe"].map(|point| format!("{side}{point}")));
        let ankles_only = !feet.as_flattened().iter().all(is_seen);
        let feet = if ankles_only { LETTERS.map(|side| [(); 2].map(|()| format!("{side}Ankle"))) } else { feet };
        let hips = LETTERS.map(|side| format!("{side}Hip"));
        let wanted: Vec<String> = feet.as_flattened().iter().chain(&hips).filter(|name| !has(name)).cloned().collect();
        if !wanted.is_empty() {
            let (file, found) = (folder.join("joints.csv"), names.iter().map(ToString::to_string).collect());
            return Err(GaitError::NoPoints { file, wanted, found }.into());
        }
        let draws = draws(folder, numbers.len(), joints.len())?;
        let path = |name: &String| {
            let place = names.iter().position(|own| own == name).unwrap_or_default();
            let path = Path3::new(&joints[place].1, place, draws.as_ref());
            finite(folder, name, &numbers, path)
        };
        let pelvis = middle(&path(&hips[0])?, &path(&hips[1])?);
        let named = |name: &String| Ok::<_, Error>((name.clone(), path(name)?));
        let [left, right] = &feet;
        let foot = |[heel, toe]: &[String; 2]| Ok::<_, Error>(Foot { heel: named(heel)?, toe: named(toe)? });
        Ok(Self { pelvis, feet: [foot(left)?, foot(right)?], ankles_only, apart_s, numbers, times_s })
    }

    /// Number of draws.
    pub(super) fn draws(&self) -> usize {
        self.pelvis.draws.len()
    }

    /// Number of the frame at a time, with its fraction.
    pub(super) fn frame_at(&self, time_s: f64) -> f64 {
        interpolated(&self.times_s, &self.numbers, time_s)
    }
}

/// A series at a time, on the line between the frames around it.
pub(super) fn interpolated(times_s: &[f64], values: &[f64], time_s: f64) -> f64 {
    let after = times_s.partition_point(|t| *t <= time_s).clamp(1, times_s.len().max(2) - 1);
    let [(Some(t0), Some(x0)), (Some(t1), Some(x1))] =
        [after - 1, after].map(|frame| (times_s.get(frame), values.get(frame)))
    else {
        return f64::NAN;
    };
    x0 + (x1 - x0) * (time_s - t0) / (t1 - t0)
}

const MEANS: [&str; 3] = ["x_mean_m", "y_mean_m", "z_mean_m"];

impl Path3 {
    /// From the columns of means and the draws, in which the point has a place.
    fn new(means: &[Vec<f64>], place: usize, draws: Option<&NumberArray>) -> Self {
        let frames = means[0].len();
        let Some(NumberArray { shape, values }) = draws else {
            return Self {
                mean: (0..frames).map(|f| [0, 1, 2].map(|axis: usize| means[axis][f])).collect(),
                draws: vec![],
            };
        };
        let points = shape[3];
        let at = |draw: usize, frame: usize| {
            let first = ((draw * frames + frame) * points + place) * 3;
            [values[first], values[first + 1], values[first + 2]]
        };
        let count = shape[1];
        let draws: Vec<Vec<[f64; 3]>> =
            (0..count).map(|draw| (0..frames).map(|frame| at(draw, frame)).collect()).collect();
        let mean = |frame: usize| {
            [0, 1, 2].map(|axis: usize| draws.iter().map(|path| path[frame][axis]).sum::<f64>() / count as f64)
        };
        Self { mean: (0..frames).map(mean).collect(), draws }
    }
}

fn middle(a: &Path3, b: &Path3) -> Path3 {
    let between = |a: &[[f64; 3]], b: &[[f64; 3]]| {
        a.iter().zip(b).map(|(a, b)| [0, 1, 2].map(|axis: usize| 0.5 * (a[axis] + b[axis]))).collect::<Vec<_>>()
    };
    let draws = a.draws.iter().zip(&b.draws).map(|(a, b)| between(a, b)).collect();
    Path3 { mean: between(&a.mean, &b.mean), draws }
}

/// Names of the keypoints that the detector has; none where the folder does not know them.
fn seen(folder: &Path) -> Result<Vec<String>, Error> {
    if !folder.join("keypoints.csv").exists() {
        return Ok(vec![]);
    }
    let mut names = FolderTable::read(folder, "keypoints.csv")?.texts("keypoint")?;
    names.sort_unstable();
    names.dedup();
    Ok(names)
}

/// Draws of all points: draw by draw, frame by frame; `None` where there are none or too many.
fn draws(folder: &Path, frames: usize, points: usize) -> Result<Option<NumberArray>, Error> {
    let found = if frames <= MOST_FRAMES { stored_array(folder, "posterior/marker_position")? } else { None };
    let Some(found) = found else { return Ok(None) };
    match found.shape[..] {
        [1, draws, in_frames, at_points, 3] if draws > 1 && in_frames == frames && at_points == points => {
            Ok(Some(found))
        }
        _ => Err(sinew_results::ReadError::OtherRun(folder.join("posterior.zarr")).into()),
    }
}

fn check_times(folder: &Path, numbers: &[f64], times_s: &[f64]) -> Result<(), Error> {
    if numbers.is_empty() {
        return Err(sinew_results::ReadError::NoFrames(folder.to_owned()).into());
    }
    let rises = |k: usize| times_s[k].is_finite() && numbers[k].is_finite() && (k == 0 || times_s[k] > times_s[k - 1]);
    match (0..numbers.len()).find(|&k| !rises(k)) {
        Some(k) => {
            let (file, what) = (folder.join("frames.csv"), "a time that does not rise".into());
            Err(GaitError::NoNumber { file, what, frame: numbers[k] }.into())
        }
        None => Ok(()),
    }
}

fn finite(folder: &Path, name: &str, numbers: &[f64], path: Path3) -> Result<Path3, Error> {
    let is_finite = |frame: usize| {
        let all = path.draws.iter().map(|draw| &draw[frame]).chain([&path.mean[frame]]);
        all.flatten().all(|x| x.is_finite())
    };
    match (0..numbers.len()).find(|&frame| !is_finite(frame)) {
        Some(frame) => {
            let (file, what) = (folder.join("joints.csv"), format!("a place of {name} that is no number"));
            Err(GaitError::NoNumber { file, what, frame: numbers[frame] }.into())
        }
        None => Ok(path),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of two draws, three frames and two points: a number says which, and along which axis.
    #[test]
    fn a_path_is_taken_from_the_draws_of_its_point() {
        let number = |draw: usize, frame: usize, point: usize, axis: usize| {
            (1000 * draw + 100 * frame + 10 * point + axis) as f64
        };
        let mut values = vec![];
        for draw in 0..2 {
            for frame in 0..3 {
                (0..2).for_each(|point| values.extend([0, 1, 2].map(|axis| number(draw, frame, point, axis))));
            }
        }
        let draws = NumberArray { shape: vec![1, 2, 3, 2, 3], values };
        let path = Path3::new(&[vec![0.0; 3], vec![0.0; 3], vec![0.0; 3]], 1, Some(&draws));
        for frame in 0..3 {
            assert_eq!(path.mean[frame], [0, 1, 2].map(|axis| 500.0 + number(0, frame, 1, axis)));
            for draw in 0..2 {
                assert_eq!(path.draws[draw][frame], [0, 1, 2].map(|axis| number(draw, frame, 1, axis)));
            }
        }
        let mean = Path3::new(&[vec![1.0, 2.0], vec![3.0, 4.0], vec![5.0, 6.0]], 1, None);
        assert_eq!(mean, Path3 { mean: vec![[1.0, 3.0, 5.0], [2.0, 4.0, 6.0]], draws: vec![] });
    }
}
