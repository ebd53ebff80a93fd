//! What a camera that a run did not use should see.
//!
//! Mean and covariance of each keypoint's observation come from the run's draws.
//!
//! With u⁽ⁱ⁾ the pixel of draw i's keypoint in the camera as it is calibrated,
//!
//! ```text
//! mean = mean of u⁽ⁱ⁾
//! total = cov(u⁽ⁱ⁾) + G Σ Gᵀ + ℓ² f fᵀ + (b² + n²) I
//! common = cov(ū⁽ⁱ⁾) + Ḡ Σ Ḡᵀ + ℓ² f̄ f̄ᵀ,   ū⁽ⁱ⁾ the mean of u⁽ⁱ⁾ over frames and keypoints
//! own = cov(u⁽ⁱ⁾ − ū⁽ⁱ⁾) + (G − Ḡ) Σ (G − Ḡ)ᵀ + ℓ² (f − f̄)(f − f̄)ᵀ + (b² + n²) I
//! ```
//!
//! The mean over frames and keypoints weighs each by the inverse of its total variance: a shift of the camera shows in keypoints that are known well.
//! G is the derivative of the pixel by what the camera may be off by ([`sinew_observe::cameras::camera_error`]), Σ its prior with the scale that the other cameras show, Ḡ the same mean of G; f is how far the keypoint moves in a second, from the frame before to the frame after, f̄ its mean, ℓ the size of the lag of the camera's clock, seconds; b is the size of a bias of the camera's detector for that kind of keypoint, n the scatter
//! of an observation of usual confidence, both as the other cameras show them, in proportion to the size of the person in the image. `common` is that of the shift that all keypoints of the camera share in all frames, `own` that of a keypoint once this shift is taken off. They add up to `total` only where a keypoint moves as all do in the mean; a turn of the camera moves keypoints near the margins of its image differently. A keypoint that lies outside the image in the mean is not predicted: pixels of points near the plane of a camera say nothing of it.

pub(crate) mod error;

pub use error::PredictError;

use crate::Error;
use crate::input::recording::Calibrated;
use crate::input::up_axis::upright;
use crate::setup::lasting_errors::MeasuredErrors;
use crate::setup::lasting_prior::{CAMERA_UNITS, HEAVY, KIND_SCALES, LAG_SCALE, kind};
use rayon::prelude::*;
use sinew_formats::camera_name;
use sinew_formats::zarr::reader::NumberArray;
use sinew_observe::Camera;
use sinew_observe::cameras::camera_error::{NUMBERS, PixelDerivatives, derivatives};
use sinew_observe::lasting::lasting_errors::pixels_per_metre;
use sinew_results::stored_array::stored_array;
use sinew_results::tracked::Tracked;
use std::fmt::Write as _;
use std::path::Path;

/// Predicted observation of a keypoint: mean and covariance of its pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Predicted {
    /// Pixel.
    pub mean: [f64; 2],
    /// Covariance uu, uv, vv, square pixels.
    pub total: [f64; 3],
    /// The same once the shift that all keypoints of the camera share is subtracted.
    pub own: [f64; 3],
}

/// What the camera should see.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPrediction {
    /// The camera.
    pub camera: Camera,
    /// Numbers of the frames.
    pub frames: Vec<u64>,
    /// Names of the keypoints.
    pub keypoints: Vec<String>,
    /// Frame by frame, keypoint by keypoint; `None` where the camera cannot show it.
    pub predicted: Vec<Option<Predicted>>,
    /// Covariance of the shift that all share, uu, uv, vv, square pixels.
    pub common: [f64; 3],
}

impl CameraPrediction {
    /// The table as text: `frame,camera,keypoint,u,v,uu,uv,vv,common_uu,common_uv,common_vv`, the last three what goes with the shift that all keypoints share, total − own.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut text = "frame,camera,keypoint,u,v,uu,uv,vv,common_uu,common_uv,common_vv\n".to_owned();
        for (frame, row) in self.frames.iter().zip(self.predicted.chunks(self.keypoints.len().max(1))) {
            for (keypoint, predicted) in self.keypoints.iter().zip(row) {
                let Some(Predicted { mean: [u, v], total, own }) = predicted else { continue };
                let name = &self.camera.name;
                let ([uu, uv, vv], [cuu, cuv, cvv]) = (total, [0, 1, 2].map(|k: usize| total[k] - own[k]));
                let _ = writeln!(
                    text,
                    "{frame},{name},{keypoint},{u:.3},{v:.3},{uu:.4},{uv:.4},{vv:.4},{cuu:.4},{cuv:.4},{cvv:.4}"
                );
            }
        }
        text
    }
}

/// The draws of a variable of `posterior.zarr` of a result folder: draw by draw, frame by frame.
///
/// # Errors
/// A folder without the variable, files that cannot be read.
pub fn drawn(folder: &Path, variable: &str) -> Result<NumberArray, Error> {
    let found = stored_array(folder, &format!("posterior/{variable}"))?;
    Ok(found.ok_or_else(|| PredictError::NoKeypoints(folder.to_owned()))?)
}

/// Predicts what `camera` of a calibration should see of a run that did not use it.
///
/// # Errors
/// A folder without draws of keypoints, a calibration that cannot be read or lacks the camera, and a camera that the run used.
pub fn predict(folder: &Path, calibration: &Path, camera: &str) -> Result<CameraPrediction, Error> {
    let tracked = Tracked::read(folder)?;
    let setup = &tracked.setup;
    let Some(known) = &setup.lasting else { return Err(PredictError::NoKeypoints(folder.to_owned()).into()) };
    let Calibrated { cameras, names, .. } = Calibrated::read(calibration)?;
    let is_it = |name: &str| camera_name::fold(name) == camera_name::fold(camera);
    let Some(found) = cameras.into_iter().find(|known| is_it(&known.name)) else {
        let (calibration, camera) = (calibration.to_owned(), camera.to_owned());
        return Err(PredictError::UnknownCamera { calibration, camera, calibrated: names }.into());
    };
    if setup.camera.iter().any(|used| is_it(&used.name)) {
        return Err(PredictError::UsedCamera(found.name).into());
    }
    let found = found.resized(tracked.image_scale);
    let camera = upright(vec![found.clone()], &setup.world_up).pop().unwrap_or(found);
    let numbers = drawn(folder, "keypoint_position")?;
    let frames: Vec<u64> = tracked.frames.iter().map(|(number, _)| *number).collect();
    let [_, draws, in_frames, points, 3] = numbers.shape[..] else {
        return Err(PredictError::NoKeypoints(folder.to_owned()).into());
    };
    if in_frames != frames.len() || points != known.points.len() {
        return Err(PredictError::OtherRun(folder.to_owned()).into());
    }
    // Sizes at the distance of the middle.
    let scale = pixels_per_metre(&camera, known.middle_m);
    let calibrated = tracked.cameras(calibration)?.0;
    let noise_m2 = noise_m2(&tracked, known, &calibrated);
    let biases: Vec<f64> =
        known.points.iter().map(|point| HEAVY * mean_square(known, KIND_SCALES[kind(point)])).collect();
    let seen = |index: usize| {
        let (frame, point) = (index / points, index % points);
        let at = |draw: usize| {
            let first = ((draw * in_frames + frame) * points + point) * 3;
            derivatives(&camera, [numbers.values[first], numbers.values[first + 1], numbers.values[first + 2]])
        };
        Moved::in_draws(draws, at).filter(|moved| moved.is_shown(camera.image_size_px))
    };
    let mut shown: Vec<Option<Moved>> = (0..in_frames * points).into_par_iter().map(seen).collect();
    let times_s: Vec<f64> = frames.iter().map(|number| *number as f64 / tracked.fps).collect();
    let flows = flows(&shown, &times_s, points);
    for (moved, flow) in shown.iter_mut().zip(flows) {
        moved.iter_mut().for_each(|moved| moved.flow = flow);
    }
    let expected = Expected { camera: camera_variances(known), late: HEAVY * mean_square(known, LAG_SCALE) };
    let alone = |point: usize| scale * scale * (biases[point] + noise_m2) + (setup.model_error_m * scale).powi(2);
    let alone: Vec<f64> = (0..points).map(alone).collect();
    let (predicted, common) = covariances(&shown, &alone, &expected);
    Ok(CameraPrediction { camera, frames, keypoints: known.points.clone(), predicted, common })
}

/// What a camera that is left out is expected to be wrong by.
struct Expected {
    /// Variances of its own numbers.
    camera: [f64; NUMBERS],
    /// Variance of its lag, square seconds.
    late: f64,
}

/// Where a keypoint is seen, and what moves it in the image.
#[derive(Clone, Debug, PartialEq)]
struct Moved {
    /// Its pixel in each draw.
    pixels: Vec<[f64; 2]>,
    /// Mean derivative by the camera's own numbers.
    by_error: [[f64; NUMBERS]; 2],
    /// Pixels a second.
    flow: [f64; 2],
}

impl Moved {
    /// `None` where the camera cannot show a draw.
    fn in_draws(draws: usize, at: impl Fn(usize) -> Option<PixelDerivatives>) -> Option<Self> {
        let mut moved = Self::nowhere(draws);
        for (draw, pixel) in moved.pixels.iter_mut().enumerate() {
            let found = at(draw)?;
            *pixel = found.pixel;
            let sums = moved.by_error.as_flattened_mut().iter_mut();
            sums.zip(found.by_error.as_flattened()).for_each(|(sum, by)| *sum += by / draws as f64);
        }
        Some(moved)
    }

    fn nowhere(draws: usize) -> Self {
        Self { pixels: vec![[0.0; 2]; draws], by_error: [[0.0; NUMBERS]; 2], flow: [0.0; 2] }
    }

    /// Whether the mean of the draws lies in the image.
    fn is_shown(&self, size_px: [f64; 2]) -> bool {
        let mean = moments(&self.pixels).0;
        (0..2).all(|axis| (0.0..=size_px[axis]).contains(&mean[axis]))
    }

    /// Adds another one, times a factor.
    fn add(&mut self, factor: f64, other: &Self) {
        let add = |to: &mut [f64], from: &[f64]| to.iter_mut().zip(from).for_each(|(to, x)| *to += factor * x);
        add(self.pixels.as_flattened_mut(), other.pixels.as_flattened());
        add(self.by_error.as_flattened_mut(), other.by_error.as_flattened());
        add(&mut self.flow, &other.flow);
    }

    fn covariance(&self, Expected { camera, late }: &Expected) -> [f64; 3] {
        let mut covariance = moments(&self.pixels).1;
        let of = |a: usize, b: usize| (0..NUMBERS).map(|k| self.by_error[a][k] * camera[k] * self.by_error[b][k]).sum();
        add(&mut covariance, [of(0, 0), of(0, 1), of(1, 1)]);
        add(&mut covariance, square(self.flow).map(|x| late * x));
        covariance
    }
}

/// How each keypoint moves, pixels a second, in the mean of its draws: from the frame before to the frame after, where they show it.
fn flows(shown: &[Option<Moved>], times_s: &[f64], points: usize) -> Vec<[f64; 2]> {
    let mean = |index: usize| Some(moments(&shown[index].as_ref()?.pixels).0);
    let flow = |index: usize| {
        let (frame, point) = (index / points, index % points);
        let near = frame.saturating_sub(1)..times_s.len().min(frame + 2);
        let at = |frame: usize| Some((times_s[frame], mean(frame * points + point)?));
        let (before, after) = (near.clone().find_map(at)?, near.rev().find_map(at)?);
        let apart = after.0 - before.0;
        (apart > 0.0).then(|| [0, 1].map(|axis: usize| (after.1[axis] - before.1[axis]) / apart))
    };
    (0..shown.len()).map(|index| flow(index).unwrap_or_default()).collect()
}

/// Means and covariances of the keypoints, of which each has a variance of its own besides, and the covariance of what all share.
fn covariances(shown: &[Option<Moved>], alone: &[f64], expected: &Expected) -> (Vec<Option<Predicted>>, [f64; 3]) {
    let with_alone = |moved: &Moved, index: usize| {
        let ([uu, uv, vv], alone) = (moved.covariance(expected), alone[index % alone.len()]);
        [uu + alone, uv, vv + alone]
    };
    let total = |(index, moved): (usize, &Option<Moved>)| moved.as_ref().map(|moved| with_alone(moved, index));
    let totals: Vec<Option<[f64; 3]>> = shown.iter().enumerate().map(total).collect();
    let mut shared = Moved::nowhere(shown.iter().flatten().next().map_or(0, |moved| moved.pixels.len()));
    let weight = |total: &[f64; 3]| (total[0] + total[2]).recip();
    let weights: f64 = totals.iter().flatten().map(weight).sum();
    for (moved, total) in shown.iter().zip(&totals) {
        if let Some((moved, total)) = moved.as_ref().zip(total.as_ref()) {
            shared.add(weight(total) / weights, moved);
        }
    }
    let one = |((index, moved), total): ((usize, &Option<Moved>), &Option<[f64; 3]>)| {
        let (moved, total) = (moved.as_ref()?, (*total)?);
        let mut apart = moved.clone();
        apart.add(-1.0, &shared);
        Some(Predicted { mean: moments(&moved.pixels).0, total, own: with_alone(&apart, index) })
    };
    let predicted = shown.iter().enumerate().zip(&totals).map(one).collect();
    (predicted, shared.covariance(expected))
}

/// x xᵀ: uu, uv, vv.
fn square([u, v]: [f64; 2]) -> [f64; 3] {
    [u * u, u * v, v * v]
}

fn add(to: &mut [f64; 3], from: [f64; 3]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
}

/// Mean, and covariance uu, uv, vv.
fn moments(pixels: &[[f64; 2]]) -> ([f64; 2], [f64; 3]) {
    let n = pixels.len() as f64;
    let mean = [0, 1].map(|axis: usize| pixels.iter().map(|p| p[axis]).sum::<f64>() / n);
    let mut covariance = [0.0; 3];
    for [u, v] in pixels {
        add(&mut covariance, square([u - mean[0], v - mean[1]]));
    }
    // The mean of n draws takes one of them.
    (mean, covariance.map(|x| x / (n - 1.0).max(1.0)))
}

/// Mean square of a scale over its draws; 0 where there is none.
fn mean_square(known: &MeasuredErrors, name: &str) -> f64 {
    known.scale(name).map_or(0.0, |draws| draws.iter().map(|x| x * x).sum::<f64>() / draws.len() as f64)
}

/// Variances of what a camera may be off by.
fn camera_variances(known: &MeasuredErrors) -> [f64; NUMBERS] {
    let square = HEAVY * mean_square(known, "cameras");
    CAMERA_UNITS.map(|unit| unit * unit * square)
}

/// Variance of a detection of usual confidence at the distance of the middle, square metres: the mean of the run's cameras.
fn noise_m2(tracked: &Tracked, known: &MeasuredErrors, calibrated: &[Camera]) -> f64 {
    let square = |camera: &Camera| {
        let setup = tracked.setup.camera.iter().find(|known| known.name == camera.name)?;
        let scale = tracked.image_scale * pixels_per_metre(camera, known.middle_m);
        Some((setup.sigma_px / scale).powi(2))
    };
    let all: Vec<f64> = calibrated.iter().filter_map(square).collect();
    all.iter().sum::<f64>() / all.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(pixels: &[[f64; 2]], flow: [f64; 2]) -> Option<Moved> {
        Some(Moved { pixels: pixels.to_vec(), flow, ..Moved::nowhere(0) })
    }

    const PUNCTUAL: Expected = Expected { camera: [0.0; NUMBERS], late: 0.0 };

    /// Two keypoints that move together, and a third one of which next to nothing is known.
    #[test]
    fn keypoints_that_are_known_say_what_all_share() {
        let shown = [
            seen(&[[10.0, 5.0], [12.0, 5.0], [14.0, 5.0]], [2.0, 1.0]),
            seen(&[[30.0, 9.0], [32.0, 9.0], [34.0, 9.0]], [4.0, 1.0]),
            seen(&[[900.0, 90.0], [-300.0, 20.0], [100.0, 50.0]], [900.0, 0.0]),
            None,
        ];
        let alone = [1.0, 1.0, 1e9, 1.0];
        let (predicted, [uu, _, vv]) = covariances(&shown, &alone, &PUNCTUAL);
        assert!((uu - 4.0).abs() < 1e-3 && vv < 1e-3, "{uu} {vv}");
        let Predicted { mean, total, own } = predicted[0].unwrap();
        assert_eq!((mean, total), ([12.0, 5.0], [5.0, 0.0, 1.0]));
        assert!((own[0] - 1.0).abs() < 1e-3 && (own[2] - 1.0).abs() < 1e-3, "{own:?}");
        assert!(predicted[3].is_none());
        // A camera that is late shows all of them where they were, and the slower one less so.
        let late = Expected { late: 0.25, ..PUNCTUAL };
        let (predicted, [uu, uv, vv]) = covariances(&shown, &alone, &late);
        let weights = [2, 0].map(|k: usize| predicted[k / 2].unwrap().total).map(|[uu, _, vv]| (uu + vv).recip());
        let flow = (4.0 * weights[0] + 2.0 * weights[1]) / (weights[0] + weights[1]);
        assert!((uu - 4.0 - 0.25 * flow * flow).abs() < 1e-2 && (uv - 0.25 * flow).abs() < 1e-2, "{uu} {uv}");
        assert!((vv - 0.25).abs() < 1e-3, "{vv}");
        let own = predicted[0].unwrap().own[0];
        assert!((own - 1.0 - 0.25 * (2.0 - flow).powi(2)).abs() < 1e-2, "{own}");
    }

    /// The whole formula: draws, errors of the camera, a lag, what each keypoint has of its own, and weights; by sums over draws that are written out.
    #[test]
    fn total_own_and_common_are_those_of_the_formula() {
        const DRAWS: usize = 5;
        let pixel =
            |k: usize, i: usize, a: usize| 100.0 + (3.7 * k as f64 + 1.9 * (i * (a + 2)) as f64).sin() * [4.0, 2.5][a];
        let by_error = |k: usize, a: usize, e: usize| (0.7 * (k + 1) as f64 * (e + 1) as f64 + a as f64).cos();
        let flow = |k: usize, a: usize| [[3.0, -1.0], [0.5, 2.0], [-2.0, 0.3]][k][a];
        let (alone, late) = ([0.6, 1.4, 2.2], 0.3);
        let camera: [f64; NUMBERS] = std::array::from_fn(|e| 0.1 + 0.05 * e as f64);
        let moved = |k: usize| Moved {
            pixels: (0..DRAWS).map(|i| [0, 1].map(|a| pixel(k, i, a))).collect(),
            by_error: [0, 1].map(|a| std::array::from_fn(|e| by_error(k, a, e))),
            flow: [0, 1].map(|a| flow(k, a)),
        };
        let (found, common) = covariances(&[0, 1, 2].map(|k| Some(moved(k))), &alone, &Expected { camera, late });

        // Of keypoints mixed with these weights: all that is linear in them.
        let covariance = |mix: [f64; 3], a: usize, b: usize| {
            let sum = |of: &dyn Fn(usize) -> f64| (0..3).map(|k| mix[k] * of(k)).sum::<f64>();
            let at = |i: usize, a: usize| sum(&|k| pixel(k, i, a));
            let mean = |a: usize| (0..DRAWS).map(|i| at(i, a)).sum::<f64>() / DRAWS as f64;
            let drawn: f64 =
                (0..DRAWS).map(|i| (at(i, a) - mean(a)) * (at(i, b) - mean(b))).sum::<f64>() / (DRAWS - 1) as f64;
            let of_camera: f64 =
                (0..NUMBERS).map(|e| sum(&|k| by_error(k, a, e)) * camera[e] * sum(&|k| by_error(k, b, e))).sum();
            drawn + of_camera + late * sum(&|k| flow(k, a)) * sum(&|k| flow(k, b))
        };
        let unit = |k: usize| std::array::from_fn(|l| f64::from(u8::from(k == l)));
        let own_variance = |k: usize, a: usize, b: usize| if a == b { alone[k] } else { 0.0 };
        let trace = |k: usize| covariance(unit(k), 0, 0) + covariance(unit(k), 1, 1) + 2.0 * alone[k];
        let weights = [0, 1, 2].map(|k| 1.0 / trace(k));
        let shared = weights.map(|weight| weight / weights.iter().sum::<f64>());
        for (pair, (a, b)) in [(0, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            assert!((common[pair] - covariance(shared, a, b)).abs() < 1e-9);
            for (k, found) in found.iter().enumerate() {
                let Predicted { mean, total, own } = found.unwrap();
                let apart: [f64; 3] = std::array::from_fn(|l| unit(k)[l] - shared[l]);
                assert!((total[pair] - covariance(unit(k), a, b) - own_variance(k, a, b)).abs() < 1e-9);
                assert!((own[pair] - covariance(apart, a, b) - own_variance(k, a, b)).abs() < 1e-9);
                let middle = (0..DRAWS).map(|i| pixel(k, i, a)).sum::<f64>() / DRAWS as f64;
                assert!((mean[a] - middle).abs() < 1e-9);
            }
        }
    }

    /// One keypoint stands where the camera turns about: it does not move, and has a region all the same.
    #[test]
    fn a_keypoint_that_moves_less_than_all_share_keeps_a_region() {
        let mut shown = [[0.0; 2], [8.0, 0.0], [8.0, 0.0], [8.0, 0.0]].map(|_| seen(&[[1.0, 1.0]; 3], [0.0; 2]));
        for (k, moved) in shown.iter_mut().flatten().enumerate() {
            moved.by_error[0][0] = if k == 0 { 0.0 } else { 8.0 };
        }
        let expected = Expected { camera: [1.0; NUMBERS], late: 0.0 };
        let (predicted, common) = covariances(&shown, &[60.0; 4], &expected);
        let [still, moving] = [0, 1].map(|k: usize| predicted[k].unwrap());
        assert!(still.total[0] < common[0] + 60.0 && still.own[0] > still.total[0], "{still:?} {common:?}");
        assert!(moving.own[0] > 60.0 && moving.own[0] < moving.total[0] - 0.5 * common[0], "{moving:?}");
    }

    #[test]
    fn a_keypoint_flows_from_the_frame_before_to_the_frame_after() {
        let at = |u: f64| seen(&[[u, 2.0 * u]], [0.0; 2]);
        let shown = [at(0.0), at(3.0), None, at(9.0)];
        let found = flows(&shown, &[0.0, 0.5, 1.0, 2.0], 1);
        assert_eq!(found, [[6.0, 12.0], [6.0, 12.0], [4.0, 8.0], [0.0, 0.0]]);
    }

    #[test]
    fn keypoints_outside_the_image_are_not_shown() {
        let is_shown = |pixels: &[[f64; 2]]| seen(pixels, [0.0; 2]).unwrap().is_shown([100.0, 50.0]);
        assert!(is_shown(&[[10.0, 5.0], [-8.0, 5.0]]));
        assert!(!is_shown(&[[10.0, 5.0], [1e7, 5.0]]) && !is_shown(&[[10.0, -1.0]]));
    }

    #[test]
    fn a_keypoint_that_a_draw_does_not_show_is_not_predicted() {
        let found =
            |pixel: [f64; 2]| PixelDerivatives { pixel, by_point: [[0.0; 3]; 2], by_error: [[0.0; NUMBERS]; 2] };
        assert!(Moved::in_draws(2, |draw| (draw == 0).then(|| found([1.0, 2.0]))).is_none());
        let moved = Moved::in_draws(2, |draw| Some(found([draw as f64, 2.0]))).unwrap();
        assert_eq!(moved.pixels, [[0.0, 2.0], [1.0, 2.0]]);
    }

    /// A camera with 1000 pixels of its calibration for a metre at 1 m, shown at half its size from 5 m: 100 pixels for a metre, of which 3 are 3 cm.
    #[test]
    fn scatter_in_pixels_is_that_of_the_images_which_were_shown() {
        let camera = Camera::look_at("C1", [1000.0; 2], 1000.0, [5.0, 0.0, 1.0], [0.0, 0.0, 1.0]).unwrap();
        let known =
            MeasuredErrors { cameras: vec!["C1".into()], middle_m: [0.0, 0.0, 1.0], ..MeasuredErrors::default() };
        let own = crate::setup::CameraSetup {
            name: "C1".into(),
            offset_px: [0.0; 2],
            sigma_px: 3.0,
            usual_confidence: 1.0,
            exchanged: 0.0,
            elsewhere: 0.0,
        };
        let layout = sinew_formats::layout::find("body-25b").unwrap();
        let setup = crate::setup::unmeasured(&layout, &crate::setup::SetupRequest::default(), vec![own]);
        let tracked =
            |image_scale: f64| Tracked { setup: setup.clone(), image_scale, lag: vec![], fps: 30.0, frames: vec![] };
        let found = |image_scale: f64| noise_m2(&tracked(image_scale), &known, std::slice::from_ref(&camera)).sqrt();
        assert!(
            (found(1.0) - 0.015).abs() < 1e-12 && (found(0.5) - 0.030).abs() < 1e-12,
            "{} {}",
            found(1.0),
            found(0.5)
        );
    }
}
