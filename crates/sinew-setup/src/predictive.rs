//! Posterior-predictive checks (Gelman, Meng & Stern 1996), streamed over the frames: do the keypoints look as the model says?
//!
//! A draw x of the posterior of a frame stands in for the truth: where the model is right, (keypoints, draw) has the distribution of (keypoints, truth), so that the residual of a keypoint about the
//! projection of a *draw* is distributed as its error, whatever the posterior is. (A residual about the mean pose would be smaller, the more the pose follows the keypoints.) With s, the standard deviation
//! that the likelihood gives the keypoint, four numbers of each camera are held against what is expected:
//!
//! - *gross*: share of residuals beyond 4 s;
//! - *offset*: mean of the others, pixels;
//! - *scatter*: their root mean square about that offset, in s;
//! - *persistence*: correlation of a keypoint's residual with that in the frame before.
//!
//! Two come from points triangulated without the body, where two cameras at least see them:
//!
//! - *disagreement*: root mean square of the residuals between the cameras, each divided by `σ √(1 − leverage)`; it knows nothing of the body and of the model error, which hide a wrong σ from the scatter;
//! - *limb*: length between triangulated ends over that of the body, left and right together, after the length that noise adds.
//!
//! A number is reported ([`Doubt`]) where it is beyond a bound that means something for the intervals *and* more than `SURE` standard errors beyond what is expected. Errors that the body or the set-up
//! absorbs do not show here: with one camera every error that looks like a motion of the person, with several a shift of the whole world. How large that shift may be is shown by the offsets that the set-up found
//! ([`Doubt::Calibration`]), with the same bound on each camera's.
//!
//! Memory does not grow with the frames.

mod doubt;
mod expected;

pub use doubt::{Doubt, Lengths, Origins};

use expected::{Expected, GROSS};
use serde::{Deserialize, Serialize};
use sinew_observe::Noise;

/// Limbs whose lengths are looked at: name and its ends without their side.
pub const LIMBS: [(&str, [&str; 2]); 4] = [
    ("upper arms", ["Shoulder", "Elbow"]),
    ("forearms", ["Elbow", "Wrist"]),
    ("thighs", ["Hip", "Knee"]),
    ("shins", ["Knee", "Ankle"]),
];

/// Frames below which nothing is reported.
const FEWEST_FRAMES: f64 = 15.0;
/// Standard errors.
const SURE: f64 = 4.0;
/// Offset, in units of the assumed noise, that is reported. Half of the width of a 90 % interval of a joint seen by four cameras is about one such unit.
pub const OFFSET: f64 = 0.3;
/// Scatter and disagreement that are reported, as a multiple of the expected one.
const SCATTER: f64 = 1.2;
/// Gross residuals that are reported: a multiple of the expected share, and what they exceed it by as a share of all.
const OUTLIERS: [f64; 2] = [1.5, 0.01];
/// Correlation of successive residuals that is reported.
const PERSISTENCE: f64 = 0.3;
/// Relative difference in length that is reported.
const LIMB: f64 = 0.02;

/// Sums over the frames of values, for their mean and its standard error.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Sum {
    count: f64,
    sum: f64,
    squares: f64,
}

impl Sum {
    fn add(&mut self, value: f64) {
        self.count += 1.0;
        self.sum += value;
        self.squares += value * value;
    }

    fn mean(&self) -> f64 {
        self.sum / self.count
    }

    /// Standard error of the mean of independent values.
    fn error(&self) -> f64 {
        ((self.squares / self.count - self.mean().powi(2)).max(0.0) / (self.count - 1.0)).sqrt()
    }
}

/// Residuals of one keypoint in one camera about some draws of a frame, summed up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Residual {
    /// Assumed standard deviation per axis, pixels.
    pub sd_px: f64,
    /// Mean residual over the draws in which it is not gross, pixels.
    pub mean_px: [f64; 2],
    /// Mean of (u² + v²) / `sd_px`² over the same draws, for a residual (u, v) in pixels; about 2 for a Gaussian error.
    pub square: f64,
    /// Share of the draws in which it is gross.
    pub gross: f64,
}

impl Residual {
    /// From the residuals about some draws; `None` without any.
    pub fn of(sd_px: f64, about_draws: &[[f64; 2]]) -> Option<Self> {
        let mut found = Self { sd_px, ..Self::default() };
        let mut near = 0.0;
        for [u, v] in about_draws {
            let square = (u * u + v * v) / (sd_px * sd_px);
            // A residual that is no number is beyond.
            if square <= GROSS * GROSS {
                near += 1.0;
                found.mean_px = [found.mean_px[0] + u, found.mean_px[1] + v];
                found.square += square;
            } else {
                found.gross += 1.0;
            }
        }
        if near > 0.0 {
            found.mean_px = found.mean_px.map(|sum| sum / near);
            found.square /= near;
        }
        found.gross /= about_draws.len() as f64;
        (!about_draws.is_empty()).then_some(found)
    }
}

/// Sums over the frames for one camera.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Watched {
    name: String,
    /// Frames' shares of gross residuals.
    gross: Sum,
    /// Frames' mean residuals, pixels, by axis.
    offset: [Sum; 2],
    /// Frames' mean squares, two axes together, in units of the assumed deviation.
    scatter: Sum,
    /// Assumed deviations.
    sd_px: Sum,
    /// Frames' mean squares of the standardised residuals between cameras, per axis.
    disagreement: Sum,
    /// Products of successive mean residuals, and their squares, in units of the assumed deviation, both axes.
    products: Sum,
    power: Sum,
    /// Mean residuals of the last frame by keypoint, in units of the assumed deviation.
    last: Vec<Option<[f64; 2]>>,
    last_number: u64,
}

/// Sums over the frames for one kind of limb.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Limb {
    /// Frames' length between the keypoints over that of the body.
    ratio: Sum,
    /// Length in the body, metres.
    body_m: Sum,
}

/// The checks of a run. Plain numbers: what a stopped run needs to resume.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Predictive {
    expected: Expected,
    cameras: Vec<Watched>,
    limbs: [Limb; LIMBS.len()],
}

impl Predictive {
    /// Nothing seen yet in cameras of these names.
    pub fn new(cameras: impl Iterator<Item = String>, noise: Noise) -> Self {
        let watched = |name| Watched { name, ..Watched::default() };
        Self { expected: Expected::of(noise), cameras: cameras.map(watched).collect(), limbs: Default::default() }
    }

    /// Number of cameras.
    pub const fn cameras(&self) -> usize {
        self.cameras.len()
    }

    /// Takes in what a camera shows in a frame: each keypoint that it sees, and the mean square of its standardised residuals against the other cameras, if there are any.
    pub fn camera(&mut self, number: u64, camera: usize, residuals: &[Option<Residual>], disagreement: Option<f64>) {
        let Some(watched) = self.cameras.get_mut(camera) else { return };
        let seen: Vec<&Residual> = residuals.iter().flatten().collect();
        if seen.is_empty() {
            return;
        }
        watched.gross.add(seen.iter().map(|r| r.gross).sum::<f64>() / seen.len() as f64);
        let near: Vec<&&Residual> = seen.iter().filter(|r| r.gross < 0.5).collect();
        let count = near.len() as f64;
        if near.is_empty() {
            return;
        }
        for (axis, sum) in watched.offset.iter_mut().enumerate() {
            sum.add(near.iter().map(|r| r.mean_px[axis]).sum::<f64>() / count);
        }
        watched.scatter.add(near.iter().map(|r| r.square).sum::<f64>() / count);
        watched.sd_px.add(near.iter().map(|r| r.sd_px).sum::<f64>() / count);
        if let Some(square) = disagreement {
            watched.disagreement.add(square);
        }
        let now: Vec<Option<[f64; 2]>> =
            residuals.iter().map(|r| r.filter(|r| r.gross < 0.5).map(|r| r.mean_px.map(|x| x / r.sd_px))).collect();
        let follows = number == watched.last_number + 1;
        for (now, before) in now.iter().zip(&watched.last).filter(|_| follows) {
            let (Some(a), Some(b)) = (now, before) else { continue };
            for axis in 0..2 {
                watched.products.add(a[axis] * b[axis]);
                watched.power.add(0.5 * (a[axis] * a[axis] + b[axis] * b[axis]));
            }
        }
        (watched.last, watched.last_number) = (now, number);
    }

    /// Takes in a limb of a frame: its length between the keypoints, less what noise adds, and in the body, metres.
    pub fn limb(&mut self, limb: usize, keypoints_m: f64, body_m: f64) {
        let Some(limb) = self.limbs.get_mut(limb) else { return };
        if body_m > 0.0 && keypoints_m.is_finite() {
            limb.ratio.add(keypoints_m / body_m);
            limb.body_m.add(body_m);
        }
    }

    /// Summary of the checks of lengths. `doubts` are all doubts of the run ([`Predictive::doubts`]); the limbs counted are those measured in at least `FEWEST_FRAMES` frames.
    pub fn lengths(&self, doubts: &[Doubt]) -> Lengths {
        let checked = self.limbs.iter().filter(|limb| limb.ratio.count >= FEWEST_FRAMES).count();
        if doubts.iter().any(|doubt| matches!(doubt, Doubt::Limb { .. } | Doubt::Offset { .. })) {
            return Lengths::Doubted;
        }
        if checked == 0 { Lengths::Unchecked } else { Lengths::Undoubted(checked) }
    }

    /// The numbers of the module's list that are beyond both of their bounds. `held` is the correlation of errors from frame to frame for which the intervals have been widened already.
    pub fn doubts(&self, held: f64) -> Vec<Doubt> {
        let mut doubts: Vec<Doubt> = self.cameras.iter().flat_map(|camera| camera.doubts(&self.expected)).collect();
        let persistent = |camera: &Watched| Some((camera.name.clone(), camera.persistence()?));
        let cameras: Vec<(String, f64)> = self.cameras.iter().filter_map(persistent).collect();
        if !cameras.is_empty() {
            doubts.push(Doubt::Persistent { cameras, held });
        }
        for ((name, _), limb) in LIMBS.iter().zip(&self.limbs) {
            let (ratio, error) = (limb.ratio.mean(), limb.ratio.error());
            let off = (ratio - 1.0).abs();
            if limb.ratio.count >= FEWEST_FRAMES && off > LIMB && off > SURE * error {
                doubts.push(Doubt::Limb { name, ratio, body_m: limb.body_m.mean() });
            }
        }
        doubts
    }
}

impl Watched {
    /// Correlation of successive residuals about the camera's offset, where it is to be reported.
    fn persistence(&self) -> Option<f64> {
        let offset = self.offset.map(|sum| (sum.mean() / self.sd_px.mean()).powi(2)).iter().sum::<f64>() / 2.0;
        let correlation = (self.products.mean() - offset) / (self.power.mean() - offset);
        let error = self.products.count.sqrt().recip();
        let is_large = self.offset[0].count >= FEWEST_FRAMES && correlation > PERSISTENCE && correlation > SURE * error;
        is_large.then_some(correlation)
    }

    fn doubts(&self, expected: &Expected) -> Vec<Doubt> {
        let mut doubts = vec![];
        let camera = || self.name.clone();
        let sd_px = self.sd_px.mean();
        if self.gross.count < FEWEST_FRAMES || sd_px.is_nan() {
            return doubts;
        }
        let [factor, more] = OUTLIERS;
        let (share, error) = (self.gross.mean(), self.gross.error());
        let bound = factor * expected.gross + more;
        if share > bound && share - expected.gross > SURE * error {
            doubts.push(Doubt::Outliers { camera: camera(), share, expected: expected.gross });
        }
        let offset_px = self.offset.map(|sum| sum.mean());
        // Errors that persist make a mean less sure than its frames are many: squares of errors that correlate by r do so by r².
        let persistence = self.persistence().unwrap_or(0.0);
        let inflation = |r: f64| ((1.0 + r) / (1.0 - r).max(0.05)).sqrt();
        let error = self.offset[0].error().hypot(self.offset[1].error()) * inflation(persistence);
        let length = offset_px[0].hypot(offset_px[1]);
        if length > OFFSET * sd_px && length > SURE * error {
            let frames = self.offset[0].count as u64;
            doubts.push(Doubt::Offset { camera: camera(), offset_px, frames, usual_px: error });
        }
        let about_offset = self.scatter.mean() - (length / sd_px).powi(2);
        let scatter = (about_offset / expected.square).max(0.0).sqrt();
        let disagreement = (self.disagreement.mean() / (0.5 * expected.square)).sqrt();
        // Mean squares are held against the errors of mean squares.
        let error = |sum: &Sum| SURE * sum.error() * inflation(persistence * persistence);
        let is_wide = scatter > SCATTER && about_offset - expected.square > error(&self.scatter);
        let between = self.disagreement.mean() - 0.5 * expected.square;
        let is_apart = disagreement > SCATTER && between > error(&self.disagreement);
        let ratio = match (is_wide, self.disagreement.count >= FEWEST_FRAMES && is_apart) {
            (false, false) => return doubts,
            (true, false) => scatter,
            (false, true) => disagreement,
            (true, true) => scatter.max(disagreement),
        };
        doubts.push(Doubt::Scatter { camera: camera(), ratio });
        doubts
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::lanes::{Block, Isa};
    use sinew_core::random::Stage;

    /// How a camera of standard deviation 2 px errs.
    #[derive(Clone, Copy)]
    struct Errs {
        offset_px: f64,
        size: f64,
        persistence: f64,
        /// One keypoint in this number is far away.
        outlier: usize,
        disagreement: f64,
    }

    const RIGHT: Errs = Errs { offset_px: 0.0, size: 1.0, persistence: 0.0, outlier: 50, disagreement: 1.0 };

    /// Doubts about a camera that sees twelve keypoints in each of `frames` frames.
    fn doubted(errs: Errs, frames: u64) -> Vec<Doubt> {
        doubted_of(errs, frames, 4)
    }

    fn doubted_of(errs: Errs, frames: u64, seed: u64) -> Vec<Doubt> {
        let mut predictive = Predictive::new(["C1".to_owned()].into_iter(), Noise::OutlierFloor { outlier: 0.02 });
        let mut errors = [[0.0; 2]; 12];
        for number in 0..frames {
            let mut normal = [Block::ZERO; 3];
            Stage::new(seed, "errors").at_frame(number as u32).whole().fill_normal(Isa::baseline(), &mut normal);
            let normal: Vec<f64> = normal.iter().flat_map(|block| block.0).collect();
            let fresh = if number == 0 { 1.0 } else { (1.0 - errs.persistence * errs.persistence).sqrt() };
            let residual = |(k, error): (usize, &mut [f64; 2])| {
                for a in 0..2 {
                    error[a] = errs.persistence * error[a] + fresh * normal[2 * k + a];
                }
                let far = (number as usize * 12 + k).is_multiple_of(errs.outlier);
                let at = |a: usize| errs.size * 2.0 * error[a] + if far { 100.0 } else { 0.0 };
                Residual::of(2.0, &[[at(0) + errs.offset_px, at(1)]])
            };
            let residuals: Vec<_> = errors.iter_mut().enumerate().map(residual).collect();
            predictive.camera(number, 0, &residuals, Some(errs.disagreement * if number % 2 == 0 { 0.9 } else { 1.1 }));
        }
        predictive.doubts(0.0)
    }

    fn kinds(doubts: &[Doubt]) -> Vec<&'static str> {
        doubts.iter().map(Doubt::kind).collect()
    }

    #[test]
    fn residuals_as_the_model_says_are_not_reported() {
        assert_eq!(doubted(RIGHT, 400), []);
    }

    #[test]
    fn each_error_is_reported_by_its_name_and_size() {
        let is = |errs: Errs, kind: &str| {
            let doubts = doubted(errs, 200);
            assert_eq!(kinds(&doubts), [kind], "{doubts:?}");
            doubts.into_iter().next()
        };
        let Some(Doubt::Offset { offset_px, frames, usual_px, .. }) = is(Errs { offset_px: 1.0, ..RIGHT }, "offset")
        else {
            return;
        };
        // 2 px over √(12 · 200) keypoints of each axis.
        assert!((offset_px[0] - 1.0).abs() < 0.2 && offset_px[1].abs() < 0.2 && frames == 200, "{offset_px:?}");
        assert!((usual_px / (2.0_f64 / 1200.0).sqrt() / 2.0 * 2.0_f64.sqrt() - 1.0).abs() < 0.3, "{usual_px}");
        let Some(Doubt::Scatter { ratio, .. }) = is(Errs { size: 1.4, ..RIGHT }, "scatter") else { return };
        assert!((ratio - 1.4).abs() < 0.1, "{ratio}");
        // Between the cameras alone: the square of 1.5.
        let Some(Doubt::Scatter { ratio, .. }) = is(Errs { disagreement: 2.25, ..RIGHT }, "scatter") else { return };
        assert!((ratio - 1.5).abs() < 0.05, "{ratio}");
        let Some(Doubt::Outliers { share, expected, .. }) = is(Errs { outlier: 20, ..RIGHT }, "outliers") else {
            return;
        };
        assert!((share - 0.05).abs() < 0.01 && (expected - 0.02).abs() < 1e-3, "{share} {expected}");
        let Some(Doubt::Persistent { cameras, .. }) = is(Errs { persistence: 0.6, ..RIGHT }, "persistence") else {
            return;
        };
        assert!((cameras[0].1 - 0.6).abs() < 0.1, "{cameras:?}");
    }

    /// With 1.4 times the scatter a frame's mean square over twelve keypoints, 24 squares of a normal deviate, is 2 · 1.96 ± 2 · 1.96 √(2/24) = 3.92 ± 1.13, and the mean over 30 frames is known to ± 0.21: the 1.92 that are too many are nine of that.
    #[test]
    fn a_second_of_errors_that_are_too_wide_is_enough() {
        for seed in 0..20 {
            let doubts = doubted_of(Errs { size: 1.4, outlier: 1000, ..RIGHT }, 30, seed);
            assert_eq!(kinds(&doubts), ["scatter"], "{seed}: {doubts:?}");
            let right = doubted_of(Errs { outlier: 1000, ..RIGHT }, 30, seed);
            assert_eq!(kinds(&right), [""; 0], "{seed}");
        }
    }

    #[test]
    fn too_few_frames_show_nothing() {
        assert_eq!(doubted(Errs { offset_px: 9.0, size: 2.0, ..RIGHT }, 14), []);
    }

    #[test]
    fn limbs_are_reported_where_their_lengths_differ_surely() {
        let doubted = |ratio: f64, scatter: f64| {
            let mut predictive = Predictive::new(std::iter::empty(), Noise::StudentT { degrees: 4.0 });
            for number in 0..40 {
                predictive.limb(2, 0.43 * (ratio + if number % 2 == 0 { scatter } else { -scatter }), 0.43);
            }
            predictive.doubts(0.0)
        };
        assert_eq!(doubted(1.01, 0.001), []);
        // 0.03 is fewer than four of the standard errors of 40 frames.
        assert_eq!(doubted(1.03, 0.05), []);
        let doubts = doubted(1.03, 0.01);
        assert_eq!(doubts.len(), 1);
        assert_eq!(
            doubts[0].describe(Origins::default()),
            "thighs: 3.0 % longer between the keypoints than in the body (430 mm, left and right together). The intervals do not know of it and hold the truth less often than they promise: choose frames for the set-up that show the person better (`--setup-frames`), or give a body file with these lengths (`--body`)"
        );
    }

    /// A camera with ten keypoints that err by ± 0.5 px: eight as in the frame before and two by the other sign, so that errors correlate by (8 − 2)/10 = 0.6. Squares of normal deviates that correlate by r do so by r², here by 0.36, and their mean over 26 frames is less sure by √(1.36/0.64) = 1.46.
    fn doubted_where_errors_persist(apart: f64) -> Vec<Doubt> {
        let mut predictive = Predictive::new(["C1".to_owned()].into_iter(), Noise::OutlierFloor { outlier: 0.02 });
        for number in 0..26 {
            let other = if number % 2 == 0 { 1.0 } else { -1.0 };
            let residual = |k: usize| {
                let side = if k.is_multiple_of(2) { 0.5 } else { -0.5 } * if k < 2 { other } else { 1.0 };
                Some(Residual { sd_px: 2.0, mean_px: [side; 2], square: 3.0 + other * apart, gross: 0.0 })
            };
            predictive.camera(number, 0, &(0..10).map(residual).collect::<Vec<_>>(), None);
        }
        predictive.doubts(0.0)
    }

    /// 3.00 are 1.005 more than the 1.995 of a normal law cut at four deviations. With frames 0.75 apart from their mean the standard error is 0.75/√25 = 0.15, and four of these are 0.60; where errors persist, 0.87. With 0.90 it is 1.05.
    #[test]
    fn squares_of_errors_that_persist_are_less_sure_by_the_square_of_their_correlation() {
        assert_eq!(kinds(&doubted_where_errors_persist(0.75)), ["scatter", "persistence"]);
        assert_eq!(kinds(&doubted_where_errors_persist(0.9)), ["persistence"]);
    }
}
