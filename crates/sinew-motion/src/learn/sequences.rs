//! Motion files as sequences of a body's states at the rate of a model.
//!
//! The working rate is the model's times the least whole number that reaches the file's, so that no frame of a file is lost; its phases are sequences of their own.
//!
//! Angles of different files are made comparable: whole turns are taken off a file's angles so that its first frame lies in (−π, π]; from there they are continuous in time.

use super::error::LearnError;
use crate::Error;
use crate::convert::{Format, recorded_joints};
use crate::follow::{Followed, NamedBody, follow};
use rayon::prelude::*;
use sinew_body::{Joint, KinematicTree};
use sinew_dynamics::primitives::windows::subsampled;
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// How well the body follows a file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileFit {
    /// The file.
    pub path: PathBuf,
    /// Frames at the working rate.
    pub frames: usize,
    /// Frames per second of the file.
    pub recorded_hz: f64,
    /// Working rate, frames per second.
    pub working_hz: f64,
    /// Mean distance of the body's 15 joints of evaluation to the recorded ones, metres.
    pub mean_error_m: f64,
    /// Sequences that it gives: phases of the model's rate.
    pub sequences: usize,
}

/// States of some files at the rate of a model.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sequences {
    /// States, one after the other; each file gives one sequence for each phase.
    pub states: Vec<Vec<f64>>,
    /// The files, in their order.
    pub files: Vec<FileFit>,
    /// What was odd.
    pub warnings: Vec<String>,
}

/// Mean error above which a file's states are doubtful, metres.
const DOUBTFUL_M: f64 = 0.03;

/// Mean error above which a file's numbers are no joints of a person in metres.
const IMPOSSIBLE_M: f64 = 1.0;

/// How far a rate may be above a whole multiple of the model's and still count as it.
const SAME_RATE: f64 = 0.01;

/// How many working frames one of the model has.
fn phases(recorded_hz: f64, fps: f64) -> usize {
    ((recorded_hz / fps - SAME_RATE).ceil() as usize).max(1)
}

/// What AMC files do not say themselves.
#[derive(Clone, Copy, Debug, Default)]
pub struct Acclaim<'a> {
    /// Skeleton of all of them; each has its own beside it if `None`.
    pub skeleton: Option<&'a Path>,
    /// Frames per second; 120 if `None`.
    pub hz: Option<f64>,
}

/// States of some files at the rate `fps`. `done` takes the number of files that are done.
///
/// # Errors
/// The first file, in their order, that cannot be read or followed.
pub fn sequences(
    body: NamedBody,
    files: &[PathBuf],
    acclaim: Acclaim<'_>,
    fps: f64,
    done: &mut (dyn FnMut(usize) + Send),
) -> Result<Sequences, Error> {
    let count = AtomicUsize::new(0);
    let done = std::sync::Mutex::new(done);
    let one = |path: &PathBuf| {
        let found = file_states(body, path, acclaim, fps);
        if found.is_ok()
            && let Ok(mut done) = done.lock()
        {
            done(count.fetch_add(1, Ordering::SeqCst) + 1);
        }
        found
    };
    let found: Vec<_> = files.par_iter().map(one).collect();
    let mut all = Sequences::default();
    for file in found {
        let (states, fit, warnings) = file?;
        all.states.extend(states);
        all.warnings.extend(warnings);
        if fit.mean_error_m > DOUBTFUL_M {
            all.warnings.push(format!(
                "{}: the body misses the recorded joints by {:.0} mm on average, more than {:.0}; its angles mean little",
                fit.path.display(),
                1000.0 * fit.mean_error_m,
                1000.0 * DOUBTFUL_M
            ));
        }
        all.files.push(fit);
    }
    Ok(all)
}

type FileStates = (Vec<Vec<f64>>, FileFit, Vec<String>);

fn file_states(body: NamedBody, path: &Path, acclaim: Acclaim<'_>, fps: f64) -> Result<FileStates, Error> {
    let (own, hz) = match (Format::of(path)?, acclaim.skeleton) {
        (Format::Amc, None) => (Some(skeleton_beside(path)?), acclaim.hz),
        (Format::Amc, Some(skeleton)) => (Some(skeleton.to_owned()), acclaim.hz),
        _ => (None, None),
    };
    let working = |recorded_hz: f64| fps * phases(recorded_hz, fps) as f64;
    let joints = recorded_joints(path, own.as_deref(), hz, working)?;
    let (frames, recorded_hz) = (joints.motion.frames.len(), joints.recorded_hz);
    if frames < 2 {
        return Err(LearnError::TooShort { path: path.to_owned(), frames, rate_hz: working(recorded_hz) }.into());
    }
    let followed = follow(body, &joints.motion).map_err(|problem| LearnError::Follow { path: path.into(), problem })?;
    let Followed { body: tree, mut states, mean_error_m } = followed;
    if mean_error_m.is_nan() || mean_error_m > IMPOSSIBLE_M {
        return Err(LearnError::OtherUnits { path: path.into(), error_m: mean_error_m }.into());
    }
    comparable(&tree, &mut states);
    let states = subsampled(&states.concat(), tree.dof(), phases(recorded_hz, fps)).map_err(LearnError::Learning)?;
    let (working_hz, sequences) = (working(recorded_hz), states.len());
    let fit = FileFit { path: path.to_owned(), frames, recorded_hz, working_hz, mean_error_m, sequences };
    Ok((states, fit, joints.warnings))
}

/// Takes whole turns off every angle, so that it begins in (−π, π].
fn comparable(tree: &KinematicTree, states: &mut [Vec<f64>]) {
    for (i, joint) in tree.joints().map(|(_, joint)| joint).enumerate() {
        if matches!(joint, Joint::Rotate(_)) {
            let turns = states.first().map_or(0.0, |first| ((first[i] - PI) / TAU).ceil());
            states.iter_mut().for_each(|state| state[i] -= TAU * turns);
        }
    }
}

/// The skeleton of an AMC file: that of its subject, what comes before `_` in its name, or the only one beside it.
fn skeleton_beside(path: &Path) -> Result<PathBuf, Error> {
    std::fs::metadata(path).map_err(sinew_results::Error::io("read", path))?;
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let sought = format!("{}.asf", stem.split('_').next().unwrap_or_default());
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let own = folder.join(&sought);
    if own.is_file() {
        return Ok(own);
    }
    let entries = std::fs::read_dir(folder).map_err(sinew_results::Error::io("read", folder))?;
    let is_skeleton = |path: &PathBuf| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("asf"));
    let mut others: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(is_skeleton).collect();
    match (others.pop(), others.is_empty()) {
        (Some(only), true) => Ok(only),
        _ => Err(LearnError::NoSkeleton { path: path.to_owned(), sought }.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn working_rates_are_multiples_that_lose_no_frame() {
        let found = [(120.0, 20.0), (120.1, 20.0), (30.0, 20.0), (59.94, 20.0), (15.0, 20.0), (100.0, 30.0)];
        assert_eq!(found.map(|(recorded, fps)| phases(recorded, fps)), [6, 6, 2, 3, 1, 4]);
    }

    #[test]
    fn angles_begin_within_half_a_turn_and_stay_continuous() {
        let tree = NamedBody::Hppf24.tree();
        let mut states = [7.0, 7.5, 8.0].map(|x: f64| vec![x; 24]).to_vec();
        states[0][5] = -PI;
        comparable(&tree, &mut states);
        assert_eq!(states[0][..3], [7.0; 3]);
        let [a, b] = [0, 2].map(|frame: usize| states[frame][3]);
        assert!((a - (7.0 - TAU)).abs() < 1e-12 && (b - a - 1.0).abs() < 1e-12);
        assert!((states[0][5] - PI).abs() < 1e-12, "{}", states[0][5]);
    }

    #[test]
    fn skeletons_are_found_by_name_or_as_the_only_one() {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str| std::fs::write(folder.path().join(name), "").unwrap();
        let sought = || skeleton_beside(&folder.path().join("07_01.amc"));
        let message = sought().unwrap_err().to_string();
        assert!(message.contains("cannot read") && message.contains("07_01.amc"), "{message}");
        put("07_01.amc");
        assert!(sought().is_err());
        put("b.asf");
        assert_eq!(sought().unwrap(), folder.path().join("b.asf"));
        put("c.asf");
        let message = sought().unwrap_err().to_string();
        assert!(message.contains("neither `07.asf` nor one single .asf file is beside it"), "{message}");
        put("07.asf");
        assert_eq!(sought().unwrap(), folder.path().join("07.asf"));
    }
}
