//! What a camera that a run did not use should see.
//!
//! Mean and covariance of each keypoint's observation come from the run's draws.
//!
//! With u⁽ⁱ⁾ the pixel of draw i's keypoint in the camera as it is calibrated,
//!
//! ```text
//! mean = mean of u⁽ⁱ⁾
//! total = cov(u⁽ⁱ⁾) + G Σ Gᵀ + ℓ² f fᵀ + (b² + n²) I
//! common = cov(mean of u⁽ⁱ⁾ over frames and keypoints) + Ḡ Σ Ḡᵀ + ℓ² f̄ f̄ᵀ
//! ```
//!
//! The mean over frames and keypoints counts each by the inverse of its total variance: where the camera is aside is seen in keypoints that are known well.
//! G is the derivative of the pixel by what the camera may be off by ([`sinew_observe::camera_error`]), Σ its prior with the scale that the other cameras show, Ḡ the same mean of G; f is how far the keypoint moves in a second, from the frame before to the frame after, f̄ its mean, ℓ the size of the lag of the camera's clock, seconds; b is the size of a bias of the camera's detector for that kind of keypoint, n the scatter
//! of an observation of usual confidence, both as the other cameras show them, in proportion to the size of the person in the image. `common` is the part that all keypoints of the camera share in all frames. A keypoint that lies outside the image in the mean is not predicted: pixels of points near the plane of a camera say nothing of it.

pub(crate) mod error;

pub use error::PredictError;

use crate::Error;
use rayon::prelude::*;
use sinew::files::{read_bytes, read_text};
use sinew::input::recording::Calibrated;
use sinew::input::up_axis::upright;
use sinew::results::tracked::Tracked;
use sinew::setup::lasting_errors::MeasuredErrors;
use sinew::setup::lasting_prior::{CAMERA_UNITS, HEAVY, KIND_SCALES, LAG_SCALE, kind};
use sinew_formats::camera_name;
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_formats::zarr::reader::{self, NumberArray};
use sinew_observe::Camera;
use sinew_observe::camera_error::{NUMBERS, PixelDerivatives, derivatives};
use sinew_observe::lasting_errors::pixels_per_metre;
use std::fmt::Write as _;
use std::path::Path;

/// A keypoint's observation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Predicted {
    /// Pixel.
    pub mean: [f64; 2],
    /// Covariance uu, uv, vv, square pixels.
    pub total: [f64; 3],
}

/// What the camera should see.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraPrediction {
    /// The camera.
    pub camera: Camera,
    /// NumberArray of the frames.
    pub frames: Vec<u64>,
    /// Names of the keypoints.
    pub keypoints: Vec<String>,
    /// Frame by frame, keypoint by keypoint; `None` where the camera cannot show it.
    pub predicted: Vec<Option<Predicted>>,
    /// Covariance that all share, uu, uv, vv, square pixels.
    pub common: [f64; 3],
}

impl CameraPrediction {
    /// The table as text: `frame,camera,keypoint,u,v,uu,uv,vv,common_uu,common_uv,common_vv`.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut text = "frame,camera,keypoint,u,v,uu,uv,vv,common_uu,common_uv,common_vv\n".to_owned();
        let [cuu, cuv, cvv] = self.common;
        for (frame, row) in self.frames.iter().zip(self.predicted.chunks(self.keypoints.len().max(1))) {
            for (keypoint, predicted) in self.keypoints.iter().zip(row) {
                let Some(Predicted { mean: [u, v], total: [uu, uv, vv] }) = predicted else { continue };
                let name = &self.camera.name;
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
    let array = folder.join("posterior.zarr/posterior").join(variable);
    let document = array.join("zarr.json");
    if !document.is_file() {
        return Err(PredictError::NoKeypoints(folder.to_owned()).into());
    }
    let text = read_text(&document, MAX_TEXT_BYTES)?;
    let mut failed = None;
    let read = reader::numbers(&document.display().to_string(), &text, |key| {
        let path = array.join(key);
        let bytes = path.exists().then(|| read_bytes(&path, MAX_TEXT_BYTES)).transpose();
        Ok(bytes.unwrap_or_else(|error| {
            failed.get_or_insert(error);
            None
        }))
    });
    failed.map_or(Ok(()), Err)?;
    Ok(read?)
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
    let sigma = camera_variances(known);
    let biases: Vec<f64> =
        known.points.iter().map(|point| HEAVY * mean_square(known, KIND_SCALES[kind(point)])).collect();
    let draw = |index: usize| {
        let (frame, point) = (index / points, index % points);
        let at = |draw: usize| {
            let first = ((draw * in_frames + frame) * points + point) * 3;
            [numbers.values[first], numbers.values[first + 1], numbers.values[first + 2]]
        };
        let seen: Option<Vec<Seen>> = (0..draws).map(|draw| Seen::of(&camera, at(draw))).collect();
        seen.filter(|seen| is_shown(seen, camera.image_size_px))
    };
    let shown: Vec<Option<Vec<Seen>>> = (0..in_frames * points).into_par_iter().map(draw).collect();
    let times_s: Vec<f64> = frames.iter().map(|number| *number as f64 / tracked.fps).collect();
    let flows = flows(&shown, &times_s, points);
    let late = HEAVY * mean_square(known, LAG_SCALE);
    let one = |(index, seen): (usize, &Option<Vec<Seen>>)| {
        let seen = seen.as_ref()?;
        let pixels: Vec<[f64; 2]> = seen.iter().map(|seen| seen.pixel).collect();
        let (mean, mut total) = moments(&pixels);
        add(&mut total, spread(&mean_error(seen.iter().map(|seen| (1.0, seen))), &sigma));
        add(&mut total, square(flows[index]).map(|x| late * x));
        let model = (setup.model_error_m * scale).powi(2);
        let alone = scale * scale * (biases[index % points] + noise_m2) + model;
        add(&mut total, [alone, 0.0, alone]);
        Some(Predicted { mean, total })
    };
    let predicted: Vec<Option<Predicted>> = shown.iter().enumerate().map(one).collect();
    let common = common(&shown, &predicted, (&flows, draws), (&sigma, late));
    Ok(CameraPrediction { camera, frames, keypoints: known.points.clone(), predicted, common })
}

/// A draw's keypoint in the camera.
struct Seen {
    pixel: [f64; 2],
    by_error: [[f64; NUMBERS]; 2],
}

impl Seen {
    fn of(camera: &Camera, point: [f64; 3]) -> Option<Self> {
        let PixelDerivatives { pixel, by_error, .. } = derivatives(camera, point)?;
        Some(Self { pixel, by_error })
    }
}

/// How each keypoint moves, pixels a second, in the mean of its draws: from the frame before to the frame after, where they show it.
fn flows(shown: &[Option<Vec<Seen>>], times_s: &[f64], points: usize) -> Vec<[f64; 2]> {
    let mean = |index: usize| {
        let seen = shown[index].as_ref()?;
        Some([0, 1].map(|axis: usize| seen.iter().map(|seen| seen.pixel[axis]).sum::<f64>() / seen.len() as f64))
    };
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

/// x xᵀ: uu, uv, vv.
fn square([u, v]: [f64; 2]) -> [f64; 3] {
    [u * u, u * v, v * v]
}

/// Whether the mean of the draws lies in the image.
fn is_shown(seen: &[Seen], size_px: [f64; 2]) -> bool {
    let mean = |axis: usize| seen.iter().map(|seen| seen.pixel[axis]).sum::<f64>() / seen.len() as f64;
    (0..2).all(|axis| (0.0..=size_px[axis]).contains(&mean(axis)))
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

/// Mean derivative by the camera's error, with weights.
fn mean_error<'a>(seen: impl Iterator<Item = (f64, &'a Seen)>) -> [[f64; NUMBERS]; 2] {
    let (mut sum, mut weights) = ([[0.0; NUMBERS]; 2], 0.0);
    for (weight, seen) in seen {
        weights += weight;
        sum.as_flattened_mut().iter_mut().zip(seen.by_error.as_flattened()).for_each(|(sum, x)| *sum += weight * x);
    }
    sum.map(|row| row.map(|x| x / weights))
}

/// G Σ Gᵀ.
fn spread(by_error: &[[f64; NUMBERS]; 2], variances: &[f64; NUMBERS]) -> [f64; 3] {
    let product = |a: usize, b: usize| (0..NUMBERS).map(|k| by_error[a][k] * variances[k] * by_error[b][k]).sum();
    [product(0, 0), product(0, 1), product(1, 1)]
}

/// The part that all keypoints share in all frames.
fn common(
    shown: &[Option<Vec<Seen>>],
    predicted: &[Option<Predicted>],
    (flows, draws): (&[[f64; 2]], usize),
    (variances, late): (&[f64; NUMBERS], f64),
) -> [f64; 3] {
    let all = shown.iter().zip(predicted).zip(flows);
    let known: Vec<(f64, &Vec<Seen>, &[f64; 2])> = all
        .filter_map(|((seen, predicted), flow)| {
            let [uu, _, vv] = (*predicted)?.total;
            Some(((uu + vv).recip(), seen.as_ref()?, flow))
        })
        .collect();
    let weights: f64 = known.iter().map(|(weight, ..)| weight).sum();
    if weights == 0.0 {
        return [0.0; 3];
    }
    let in_draw = |draw: usize| {
        [0, 1].map(|axis: usize| known.iter().map(|(w, seen, _)| w * seen[draw].pixel[axis]).sum::<f64>() / weights)
    };
    let (_, mut covariance) = moments(&(0..draws).map(in_draw).collect::<Vec<_>>());
    let each = known.iter().flat_map(|(weight, seen, _)| seen.iter().map(move |seen| (*weight, seen)));
    add(&mut covariance, spread(&mean_error(each), variances));
    let flow = [0, 1].map(|axis: usize| known.iter().map(|(w, _, flow)| w * flow[axis]).sum::<f64>() / weights);
    add(&mut covariance, square(flow).map(|x| late * x));
    covariance
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

    /// Two keypoints that move together, and a third one of which next to nothing is known.
    #[test]
    fn keypoints_that_are_known_say_what_all_share() {
        let seen = |pixels: &[[f64; 2]]| -> Option<Vec<Seen>> {
            Some(pixels.iter().map(|pixel| Seen { pixel: *pixel, by_error: [[0.0; NUMBERS]; 2] }).collect())
        };
        let known = seen(&[[10.0, 5.0], [12.0, 5.0], [14.0, 5.0]]);
        let other = seen(&[[30.0, 9.0], [32.0, 9.0], [34.0, 9.0]]);
        let unknown = seen(&[[900.0, 90.0], [-300.0, 20.0], [100.0, 50.0]]);
        let predicted = |variance: f64| Some(Predicted { mean: [0.0; 2], total: [variance, 0.0, variance] });
        let shown = [known, other, unknown, None];
        let predicted = [predicted(5.0), predicted(5.0), predicted(1e9), None];
        let [uu, _, vv] = common(&shown, &predicted, (&[[0.0; 2]; 4], 3), (&[0.0; NUMBERS], 0.0));
        assert!((uu - 4.0).abs() < 1e-3 && vv < 1e-3, "{uu} {vv}");
        // A camera that is late shows all of them where they were.
        let flows = [[2.0, 1.0], [4.0, 1.0], [900.0, 0.0], [0.0; 2]];
        let [uu, uv, vv] = common(&shown, &predicted, (&flows, 3), (&[0.0; NUMBERS], 0.25));
        assert!((uu - 4.0 - 0.25 * 9.0).abs() < 1e-3 && (uv - 0.25 * 3.0).abs() < 1e-3, "{uu} {uv}");
        assert!((vv - 0.25).abs() < 1e-3, "{vv}");
    }

    #[test]
    fn a_keypoint_flows_from_the_frame_before_to_the_frame_after() {
        let seen = |u: f64| Some(vec![Seen { pixel: [u, 2.0 * u], by_error: [[0.0; NUMBERS]; 2] }]);
        let shown = [seen(0.0), seen(3.0), None, seen(9.0)];
        let found = flows(&shown, &[0.0, 0.5, 1.0, 2.0], 1);
        assert_eq!(found, [[6.0, 12.0], [6.0, 12.0], [4.0, 8.0], [0.0, 0.0]]);
    }

    #[test]
    fn keypoints_outside_the_image_are_not_shown() {
        let seen = |pixels: &[[f64; 2]]| -> Vec<Seen> {
            pixels.iter().map(|pixel| Seen { pixel: *pixel, by_error: [[0.0; NUMBERS]; 2] }).collect()
        };
        assert!(is_shown(&seen(&[[10.0, 5.0], [-8.0, 5.0]]), [100.0, 50.0]));
        assert!(!is_shown(&seen(&[[10.0, 5.0], [1e7, 5.0]]), [100.0, 50.0]));
        assert!(!is_shown(&seen(&[[10.0, -1.0]]), [100.0, 50.0]));
    }
}
