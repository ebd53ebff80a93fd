//! Cameras that several recordings share, such as the cameras of a session with several subjects.
//!
//! Each recording says something of them ([`CameraInformation`], [`sinew_dynamics::shared_numbers`]). From all of that and one prior come draws of the cameras ([`SharedCameras`]), given which each recording draws its own numbers: draw i of all set-ups is of the same cameras, so that what errors of cameras do to a mean over subjects does not average out.

use super::lasting_prior::{CAMERA_UNITS, camera_prior};
use crate::Error;
use serde::{Deserialize, Serialize};
use sinew_core::random::Stage;
use sinew_dynamics::lasting_scales::{HeldDraws, LastingData, SweepSchedule, draws};
use sinew_dynamics::shared_numbers::{disagreement, together};
use sinew_input::files::{FNV_START, fnv};
use sinew_observe::cameras::camera_error::NUMBERS;

/// What a recording says of its cameras.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraInformation {
    /// Names of the cameras.
    pub cameras: Vec<String>,
    /// Axis or direction that points up: cameras of worlds that are turned differently are not the same.
    pub world_up: String,
    /// Λ of their numbers, ten a camera ([`sinew_observe::cameras::camera_error`]), row after row, without a prior.
    pub information: Vec<f64>,
    /// λ of their numbers.
    pub pull: Vec<f64>,
}

/// Draws of the cameras that several recordings share.
#[derive(Clone, Debug, PartialEq)]
pub struct SharedCameras {
    /// Names of the cameras.
    pub cameras: Vec<String>,
    /// Axis or direction that points up.
    pub world_up: String,
    /// Their numbers in each draw.
    pub held: HeldDraws,
}

impl CameraInformation {
    /// Whether the numbers are of the same cameras in the same world.
    #[must_use]
    pub fn is_of(&self, other: &Self) -> bool {
        self.cameras == other.cameras && self.world_up == other.world_up
    }

    /// Whether it has as many numbers as its cameras need, all finite.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        let count = NUMBERS * self.cameras.len();
        let sizes = (self.information.len(), self.pull.len()) == (count * count, count);
        sizes && self.information.iter().chain(&self.pull).all(|x| x.is_finite())
    }
}

impl SharedCameras {
    /// Draws of the cameras of which all say something; `None` of nobody, and where the cameras are hardly the same for all.
    ///
    /// # Errors
    /// A posterior that does not exist.
    pub fn draw(said: &[&CameraInformation], seed: u64) -> Result<Option<Self>, Error> {
        let each: Vec<LastingData> = said
            .iter()
            .map(|said| LastingData { information: said.information.clone(), pull: said.pull.clone() })
            .collect();
        let (Some(first), Some(data)) = (said.first(), together(&each)) else { return Ok(None) };
        if disagreement(&each, &CAMERA_UNITS.repeat(first.cameras.len()))?.is_gross() {
            return Ok(None);
        }
        let prior = camera_prior(first.cameras.len());
        // Another session draws other numbers with the same seed.
        let told = |hash, number: &f64| fnv(hash, &number.to_bits().to_le_bytes());
        let own = data.pull.iter().fold(fnv(FNV_START, &seed.to_le_bytes()), told);
        let found = draws(&data, &prior, SweepSchedule::default(), Stage::new(own, "shared cameras"))?;
        let held = HeldDraws { places: 0..data.pull.len(), draws: found.errors };
        Ok(Some(Self { cameras: first.cameras.clone(), world_up: first.world_up.clone(), held }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Says of a camera that its first number is `value`, as precisely as its unit.
    fn said(value: f64) -> CameraInformation {
        let (mut information, mut pull) = (vec![0.0; NUMBERS * NUMBERS], vec![0.0; NUMBERS]);
        let precision = 3.5e-3_f64.powi(-2);
        (information[0], pull[0]) = (precision, precision * value);
        CameraInformation { cameras: vec!["C1".into()], world_up: "+z".into(), information, pull }
    }

    fn moments(said: &[&CameraInformation]) -> [f64; 2] {
        let shared = SharedCameras::draw(said, 1).unwrap().unwrap();
        let first: Vec<f64> = shared.held.draws.iter().map(|draw| draw[0]).collect();
        let mean = first.iter().sum::<f64>() / first.len() as f64;
        [mean, first.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / first.len() as f64]
    }

    #[test]
    fn more_recordings_tell_more() {
        // With a prior of the size of its unit one recording leaves half of its variance, four a fifth.
        let one = said(0.004);
        let [mean, variance] = moments(&[&one]);
        let [mean_of_four, variance_of_four] = moments(&[&one; 4]);
        assert!(0.0 < mean && mean < mean_of_four && mean_of_four < 0.004, "{mean} {mean_of_four}");
        assert!(variance_of_four < 0.6 * variance, "{variance_of_four} {variance}");
        assert_eq!(SharedCameras::draw(&[], 1).unwrap(), None);
        // A camera that was turned by two degrees between two subjects.
        assert_eq!(SharedCameras::draw(&[&one, &said(0.039)], 1).unwrap(), None);
    }

    #[test]
    fn others_are_recognised() {
        let one = said(0.0);
        assert!(one.is_whole() && one.is_of(&said(1.0)));
        assert!(!one.is_of(&CameraInformation { world_up: "+y".into(), ..said(0.0) }));
        assert!(!CameraInformation { pull: vec![0.0; 3], ..said(0.0) }.is_whole());
        assert!(!said(f64::NAN).is_whole());
    }
}
