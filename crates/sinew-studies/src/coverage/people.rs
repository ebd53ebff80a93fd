//! People who move, and how they are filmed.
//!
//! Trials of the CMU database on the bodies fitted to them, or synthetic walkers of several sizes where there is no data.

use crate::support::outcome::Outcome;
use sinew::body::{KinematicTree, Proportions};
use sinew_body::points::{Trajectories, points_of_states};
use sinew_motion::retarget::retarget;
use sinew_simulate::walker::{Gait, Walker, walker_states};
use sinew_tests::recorded_motion;
use std::path::Path;

/// Frames per second of all recordings.
pub(super) const RATE_HZ: f64 = 30.0;

/// Trials with their subjects.
const TRIALS: [(&str, &str); 10] = [
    ("07", "07_01"),
    ("09", "09_06"),
    ("131", "131_04"),
    ("49", "49_18"),
    ("charleston", "charleston1"),
    ("01", "01_01"),
    ("135", "135_06"),
    ("07", "07_02"),
    ("49", "49_19"),
    ("07", "07_05"),
];

/// Factors on the default sizes of the walkers: whole body, legs, arms.
const WALKERS: [[f64; 3]; 4] = [[1.0, 1.0, 1.0], [0.92, 1.04, 0.96], [1.08, 0.97, 1.03], [1.0, 0.95, 1.06]];

/// Someone's motion.
pub(super) struct Person {
    /// Whose body.
    pub(super) subject: String,
    pub(super) body: KinematicTree,
    pub(super) proportions: Proportions,
    pub(super) states: Vec<Vec<f64>>,
    /// Points of the body in its states.
    pub(super) fitted: Trajectories,
    /// Joints of the recording's own skeleton, where there is one.
    pub(super) recorded: Option<Trajectories>,
}

/// Everybody; walkers where the data folder has no trials.
pub(super) fn all(data: &Path) -> Outcome<Vec<Person>> {
    let folder = data.join("cmu_amc");
    if !folder.is_dir() {
        println!("no recorded motion in {}: synthetic walkers instead", data.display());
        return Ok(WALKERS.iter().map(walker).collect());
    }
    TRIALS.iter().map(|(subject, trial)| recorded(&folder, subject, trial)).collect()
}

fn recorded(folder: &Path, subject: &str, trial: &str) -> Outcome<Person> {
    let [motion, skeleton] = [format!("{trial}.amc"), format!("{subject}.asf")].map(|file| folder.join(file));
    let recorded = recorded_motion::recorded(&motion, &skeleton, RATE_HZ)?;
    let fitted = retarget(&recorded).ok_or("no pose in the first frame")?;
    Ok(Person {
        subject: subject.into(),
        body: fitted.body,
        proportions: fitted.proportions,
        states: fitted.states,
        fitted: fitted.points,
        recorded: Some(recorded),
    })
}

fn walker([whole, legs, arms]: &[f64; 3]) -> Person {
    let p = Proportions::default();
    let proportions = Proportions {
        spine: p.spine * whole,
        shoulder_height: p.shoulder_height * whole,
        shoulder_half_width: p.shoulder_half_width * whole,
        hip_half_width: p.hip_half_width * whole,
        pelvis_drop: p.pelvis_drop * whole,
        upper_arm: p.upper_arm * whole * arms,
        forearm: p.forearm * whole * arms,
        thigh: p.thigh * whole * legs,
        shin: p.shin * whole * legs,
        ..p
    };
    let walker = Walker::new(Gait { duration_s: 6.0, proportions, ..Gait::default() });
    let states = walker_states(&walker, RATE_HZ);
    Person {
        subject: format!("walker {whole} {legs} {arms}"),
        fitted: points_of_states(&walker.body, &states),
        body: walker.body,
        proportions,
        states,
        recorded: None,
    }
}

/// Some frames of a motion.
pub(super) fn cut(motion: &Trajectories, frames: std::ops::Range<usize>) -> Trajectories {
    Trajectories { names: motion.names.clone(), frames: motion.frames[frames].to_vec() }
}
