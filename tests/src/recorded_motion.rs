//! Recorded motion from ASF and AMC files, as points at a rate.

use sinew::formats::{amc, asf};
use sinew_body::points::Trajectories;
use sinew_motion::cmu::{RATE_HZ, joints};
use crate::combo::{Sequence, Trial, combo};
use std::error::Error;
use std::fs;
use std::path::Path;

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Points of an AMC file at a rate.
///
/// # Errors
/// Files that cannot be read or that their readers refuse.
pub fn recorded(motion: &Path, skeleton: &Path, rate_hz: f64) -> Outcome<Trajectories> {
    let skeleton = asf::read(&skeleton.display().to_string(), &fs::read_to_string(skeleton)?)?;
    let motion = amc::read(&motion.display().to_string(), &fs::read_to_string(motion)?, &skeleton)?;
    Ok(joints(&skeleton, &motion, RATE_HZ / rate_hz))
}

/// The recorded trials of CMB: name of the motion and of its skeleton, and whether it goes somewhere.
pub const CMB: [(&str, &str, bool); 3] = [("07_01", "07", true), ("09_06", "09", true), ("49_18", "49", false)];

/// CMB from a folder with the recordings `07_01.amc`, `07.asf` and so on, see [`CMB`]; those that go somewhere go round with the radius that `radius_m` has for them.
///
/// # Errors
/// Files that are missing or that their readers refuse; as [`combo`].
pub fn recorded_combo(folder: &Path, rate_hz: f64, radius_m: impl Fn(&Trajectories) -> f64) -> Outcome<Sequence> {
    let read = |(name, skeleton, is_locomotion): (&str, &str, bool)| -> Outcome<Trial> {
        let [motion, skeleton] = [format!("{name}.amc"), format!("{skeleton}.asf")].map(|file| folder.join(file));
        let motion = recorded(&motion, &skeleton, rate_hz)?;
        let turn_radius_m = is_locomotion.then(|| radius_m(&motion));
        Ok(Trial { name: name.to_owned(), motion, turn_radius_m })
    };
    let trials = CMB.into_iter().map(read).collect::<Outcome<Vec<Trial>>>()?;
    Ok(combo("CMB", &trials, rate_hz)?)
}
