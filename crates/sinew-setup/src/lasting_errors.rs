//! What is constant over a recording, as the set-up stores it.
//!
//! Each number has the value that tracking uses, and draws of how far the truth may be from it.
//!
//! [`LastingErrors`] says what the numbers are.

use super::lasting_sources::PointSources;
use serde::{Deserialize, Serialize};
use sinew_body::point_derivatives::length_names;
use sinew_dynamics::persistent_errors::Persistence;
use sinew_observe::Camera;
use sinew_observe::cameras::camera_error::NUMBERS;
use sinew_observe::lasting::lasting_errors::{LastingErrors, pixels_per_metre};

/// Share of the variance of a detector's error that persists from frame to frame (0.93 · exp(−lag/τ) fits residuals of four cameras at 60 frames a second; the rest is white).
pub const LASTING_SHARE: f64 = 0.93;
/// Errors of frames that follow each other and correlate less are taken as independent.
const LEAST_CORRELATION: f64 = 0.02;

/// Longest persistence, seconds.
const LONGEST_S: f64 = 100.0;

/// Version of the table.
pub const VERSION: u32 = 5;

/// What the set-up found out about what is constant.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasuredErrors {
    /// Version of this table.
    pub version: u32,
    /// Names of the cameras.
    pub cameras: Vec<String>,
    /// Those of them that showed nobody in the frames looked at: of their errors only the prior is known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub blind_cameras: Vec<String>,
    /// Names of the body's points that are keypoints.
    pub points: Vec<String>,
    /// Middle of the person in the frames looked at, metres: biases are in metres at its distance.
    pub middle_m: [f64; 3],
    /// Number of frames looked at.
    pub frames: usize,
    /// Number of independent frames that say as much of a constant as these frames do.
    pub worth: f64,
    /// Time in which errors of detectors are forgotten by the factor e, seconds.
    pub persistence_s: f64,
    /// Scales of the prior.
    pub scale: Vec<DrawnScale>,
    /// The numbers, one after the other.
    pub number: Vec<DrawnNumber>,
    /// What the uncertainty of each point of the body comes from; empty in set-ups before it was found.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub source: Vec<PointSources>,
}

/// A scale of the prior.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrawnScale {
    /// Name.
    pub name: String,
    /// Its value in each draw.
    pub draws: Vec<f64>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes references")]
fn is_zero(x: &f64) -> bool {
    *x == 0.0
}

/// A constant number.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrawnNumber {
    /// Name with its unit.
    pub name: String,
    /// Value that tracking uses.
    pub value: f64,
    /// Mean of the prior; 0 in set-ups before it was stored.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub prior_mean: f64,
    /// Standard deviation of the prior: the median over the draws of its scales.
    pub prior_sd: f64,
    /// Draws of the truth less `value`; the draws of all numbers belong together.
    pub draws: Vec<f64>,
}

impl MeasuredErrors {
    /// What the numbers are.
    #[must_use]
    pub fn layout(&self) -> LastingErrors {
        LastingErrors { cameras: self.cameras.len(), lengths: length_names().len(), points: self.points.len() }
    }

    /// How errors persist from a frame to the next, `seconds` later; `None` where they do not.
    #[must_use]
    pub fn persistence(&self, seconds: f64) -> Option<Persistence> {
        let correlation = (-seconds / self.persistence_s).exp();
        (self.persistence_s > 0.0 && correlation > LEAST_CORRELATION)
            .then_some(Persistence { share: LASTING_SHARE, correlation })
    }

    /// How many draws there are.
    #[must_use]
    pub fn draws(&self) -> usize {
        self.number.first().map_or(0, |number| number.draws.len())
    }

    /// A camera's difference from its calibration; `None` for a camera that the set-up did not use.
    #[must_use]
    pub fn camera_error(&self, name: &str) -> Option<[f64; NUMBERS]> {
        let camera = self.cameras.iter().position(|camera| camera == name)?;
        let values = self.layout().camera(camera).map(|place| self.number[place].value);
        values.collect::<Vec<_>>().try_into().ok()
    }

    /// How late a camera's clock is, seconds; 0 for a camera that the set-up did not use.
    #[must_use]
    pub fn lag_s(&self, name: &str) -> f64 {
        let camera = self.cameras.iter().position(|camera| camera == name);
        camera.map_or(0.0, |camera| self.number[self.layout().lag(camera)].value)
    }

    /// Biases of a camera's detector for the points, pixels; `camera` is the calibrated one.
    #[must_use]
    pub fn bias_px(&self, camera: &Camera) -> Vec<[f64; 2]> {
        let Some(index) = self.cameras.iter().position(|name| *name == camera.name) else { return vec![] };
        let scale = pixels_per_metre(camera, self.middle_m);
        let bias = |point| {
            let first = self.layout().bias(index, point).start;
            [first, first + 1].map(|place| scale * self.number[place].value)
        };
        (0..self.points.len()).map(bias).collect()
    }

    /// Places of the keypoints on their links, from the joints that they are named after, metres.
    #[must_use]
    pub fn places_m(&self) -> Vec<[f64; 3]> {
        let place = |point| {
            let first = self.layout().place(point).start;
            [0, 1, 2].map(|axis: usize| self.number[first + axis].value)
        };
        (0..self.points.len()).map(place).collect()
    }

    /// What cannot be, if anything.
    #[must_use]
    pub fn problem(&self, cameras: &[&str]) -> Option<String> {
        if self.version != VERSION {
            let found = self.version;
            return Some(format!("lasting: version = {found}; this version reads {VERSION}: make the set-up again"));
        }
        if let Some(camera) = self.cameras.iter().find(|name| !cameras.contains(&name.as_str())) {
            return Some(format!("lasting: no camera `{camera}`; the set-up has: {}", cameras.join(", ")));
        }
        if !self.middle_m.iter().all(|x| x.is_finite()) {
            return Some("lasting: middle_m holds a number that is not finite".into());
        }
        if !(0.0..=LONGEST_S).contains(&self.persistence_s) {
            return Some(format!("lasting: persistence_s = {}; must be from 0 to {LONGEST_S}", self.persistence_s));
        }
        let (found, expected) = (self.number.len(), self.layout().count());
        if found != expected {
            return Some(format!("lasting: {found} numbers; its cameras and points make {expected}"));
        }
        let draws = self.draws();
        let wrong =
            |values: &[f64]| values.len() != draws || values.is_empty() || !values.iter().all(|x| x.is_finite());
        let named = |name: &str, kind| Some(format!("lasting: `{name}` needs {draws} draws, all {kind}"));
        let is_wrong = |scale: &&DrawnScale| wrong(&scale.draws) || !scale.draws.iter().all(|x| *x > 0.0);
        if let Some(scale) = self.scale.iter().find(is_wrong) {
            return named(&scale.name, "finite and above 0");
        }
        if let Some(number) = self.number.iter().find(|number| wrong(&number.draws) || !number.value.is_finite()) {
            return named(&number.name, "finite");
        }
        let source = self.source.iter().find(|source| !source.parts().iter().all(|part| part.is_finite()));
        source.map(|source| format!("lasting: the sources of `{}` hold a number that is not finite", source.point))
    }

    /// Draws of a scale, if there is one of that name.
    #[must_use]
    pub fn scale(&self, name: &str) -> Option<&[f64]> {
        self.scale.iter().find(|scale| scale.name == name).map(|scale| scale.draws.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known() -> MeasuredErrors {
        let number =
            |_| DrawnNumber { name: "n".into(), value: 0.0, prior_mean: 0.0, prior_sd: 1.0, draws: vec![0.1, -0.1] };
        let mut known = MeasuredErrors {
            version: VERSION,
            cameras: vec!["C1".into()],
            points: vec!["LKnee".into()],
            middle_m: [0.0; 3],
            frames: 2,
            worth: 2.0,
            persistence_s: 0.1,
            scale: vec![DrawnScale { name: "cameras".into(), draws: vec![1.0, 2.0] }],
            source: vec![PointSources { point: "Nose".into(), ..PointSources::default() }],
            ..MeasuredErrors::default()
        };
        known.number = (0..known.layout().count()).map(number).collect();
        known
    }

    #[test]
    fn tables_that_cannot_be_are_refused_in_words() {
        assert_eq!(known().problem(&["C1", "C2"]), None);
        let refused = |change: fn(&mut MeasuredErrors), expected: &str| {
            let mut wrong = known();
            change(&mut wrong);
            assert_eq!(wrong.problem(&["C1"]).as_deref(), Some(expected));
        };
        refused(|k| k.version = 9, "lasting: version = 9; this version reads 5: make the set-up again");
        refused(|k| k.cameras[0] = "C7".into(), "lasting: no camera `C7`; the set-up has: C1");
        refused(|k| k.middle_m[1] = f64::NAN, "lasting: middle_m holds a number that is not finite");
        refused(|k| k.persistence_s = -1.0, "lasting: persistence_s = -1; must be from 0 to 100");
        refused(|k| k.number.truncate(3), "lasting: 3 numbers; its cameras and points make 25");
        refused(|k| k.number[4].draws.clear(), "lasting: `n` needs 2 draws, all finite");
        let message = "lasting: the sources of `Nose` hold a number that is not finite";
        refused(|k| k.source[0].biases_m2 = f64::INFINITY, message);
        refused(|k| k.scale[0].draws[1] = -1.0, "lasting: `cameras` needs 2 draws, all finite and above 0");
    }
}
