//! One constant offset per camera, and how much its detections scatter.
//!
//! A camera whose calibration is slightly wrong, or whose detector leans to one side, sees everything shifted by a constant `b_c` (observed − projected, pixels).
//! It is estimated once, before any pose: together with the pose a free offset is a free shift of the whole body. Rounds of
//!
//! 1. point of each frame and keypoint from all cameras that saw it, from pixels less the present offsets ([`refined`], robust);
//! 2. `b_c` = median over frames and keypoints of (observed − projected), per axis;
//!
//! until nothing moves. The first round alone is not enough where cameras see different keypoints or large residuals are weighed down: points absorb part of the
//! offsets then. What no amount of rounds can show is the *common mode*: offsets `J_c δ` that a shift δ of the whole world explains as well (`J_c` the derivative
//! of camera c's pixels at the middle of the recording). It is settled by the calibrations as they are: δ is such that in the median over frames and keypoints the
//! points lie where the cameras that agree best put them without any offset ([`triangulate`](crate::cameras::triangulate::triangulate), greedy). On the recording that the
//! tests use, frames 0–59, one round gives (10.5, 1.0), (−3.0, −2.9), (11.3, 10.8), (2.2, −3.2) px and rounds to the end give (12.9, 0.8), (−4.7, −4.2),
//! (17.3, 13.8), (2.2, −2.3) px with points within 3 mm, in the median, of the published ones; the offsets of least squares, (16.4, 0.8), (−4.9, −5.0), (13.3, 11.2),
//! (2.1, −5.8) px, let the same rays meet as well but put everything 13 mm aside.
//!
//! The scatter σ_c per axis is the scaled median absolute deviation of what remains, each residual divided by `√(1 − h)`, h its leverage: a point fitted to few
//! cameras lies near their pixels whatever their noise is.

use crate::cameras::camera::Camera;
use crate::cameras::triangulate::{self, Refined, Seen, linear, refined};
use crate::keypoints::keypoint_model::Detection;
use nalgebra::{Matrix2x3, Matrix3};
use sinew_core::estimators::median;

/// The tracked person's keypoints in one frame: camera by camera, empty where they were not found.
pub type Sighted = Vec<Vec<Option<Detection>>>;

/// How offsets are estimated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Detections of lower confidence do not count.
    pub least_confidence: f64,
    /// Rounds at most.
    pub rounds: usize,
    /// Change at which rounds end, pixels.
    pub tolerance_px: f64,
    /// Scatter assumed at first, pixels.
    pub first_sigma_px: f64,
    /// Least scatter, pixels.
    pub least_sigma_px: f64,
    /// Keep all offsets 0 and estimate the scatter only.
    pub no_offsets: bool,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            least_confidence: 0.3,
            rounds: 30,
            tolerance_px: 0.05,
            first_sigma_px: 10.0,
            least_sigma_px: 0.5,
            no_offsets: false,
        }
    }
}

/// What is constant about each camera's detections.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraNoise {
    /// Observed − projected, pixels.
    pub offset_px: [f64; 2],
    /// Standard deviation per axis of what remains, pixels; NaN where nothing was seen.
    pub sigma_px: f64,
    /// Median confidence of the detections that count; NaN where there is none.
    pub usual_confidence: f64,
    /// Residuals that this rests on.
    pub residuals: usize,
}

impl CameraNoise {
    /// Of a camera whose offset is part of itself.
    #[must_use]
    pub const fn without_offset(sigma_px: f64, usual_confidence: f64) -> Self {
        Self { offset_px: [0.0; 2], sigma_px, usual_confidence, residuals: 0 }
    }
}

/// 1.4826 × the median absolute value: the standard deviation of a centred Gaussian, untouched by outliers.
#[must_use]
pub fn robust_sigma(values: impl Iterator<Item = f64>) -> f64 {
    1.4826 * median(&mut values.map(f64::abs).collect::<Vec<_>>())
}

/// Residual, in standard deviations, beyond which a detection is left out.
const GROSS: f64 = 5.0;

/// A keypoint in space from all cameras that saw it, with offsets removed; also the cameras, in the order of its residuals.
#[must_use]
pub fn point_from_views(
    cameras: &[Camera],
    noise: &[CameraNoise],
    frame: &Sighted,
    keypoint: usize,
    least_confidence: f64,
) -> Option<(Refined, Vec<usize>)> {
    let mut used = vec![];
    let mut sigma = vec![];
    let mut seen = vec![];
    for (c, camera) in cameras.iter().enumerate() {
        let Some(d) = frame.get(c).and_then(|points| points.get(keypoint).copied().flatten()) else { continue };
        if d.confidence >= least_confidence && d.pixel.iter().all(|x| x.is_finite()) {
            let [du, dv] = noise[c].offset_px;
            seen.push(Seen { camera, pixel: [d.pixel[0] - du, d.pixel[1] - dv], confidence: d.confidence });
            sigma.push(if noise[c].sigma_px.is_finite() { noise[c].sigma_px } else { 1.0 });
            used.push(c);
        }
    }
    loop {
        let ideal: Vec<Seen<'_>> =
            seen.iter().filter_map(|s| Some(Seen { pixel: s.camera.undistort(s.pixel).ok()?, ..*s })).collect();
        let found = refined(&seen, &sigma, linear(&ideal, true)?)?;
        let scaled = |i: usize| match found.residual_px[i] {
            Some([u, v]) => u.hypot(v) / sigma[i],
            None => f64::INFINITY,
        };
        let worst = (0..seen.len()).max_by(|&a, &b| scaled(a).total_cmp(&scaled(b)))?;
        if scaled(worst) <= GROSS {
            return Some((found, used));
        }
        if seen.len() <= 2 {
            return None;
        }
        seen.remove(worst);
        sigma.remove(worst);
        used.remove(worst);
    }
}

/// What is assumed of a camera at first.
fn first_noise(camera: usize, frames: &[Sighted], config: &Config) -> CameraNoise {
    let mut confidences: Vec<f64> = frames
        .iter()
        .filter_map(|frame| frame.get(camera))
        .flatten()
        .flatten()
        .map(|d| d.confidence)
        .filter(|c| *c >= config.least_confidence)
        .collect();
    CameraNoise {
        offset_px: [0.0; 2],
        sigma_px: config.first_sigma_px,
        usual_confidence: median(&mut confidences),
        residuals: 0,
    }
}

/// Points in space at the present offsets.
struct Round {
    /// For each camera and axis, residuals in pixels with their leverages.
    residuals: Vec<[Vec<(f64, f64)>; 2]>,
    points: Vec<[f64; 3]>,
    /// How far points without offsets lie from them.
    shifts: Vec<[f64; 3]>,
}

fn round(
    cameras: &[Camera],
    frames: &[Sighted],
    plain: &[Vec<Option<[f64; 3]>>],
    noise: &[CameraNoise],
    config: &Config,
) -> Round {
    let mut residuals: Vec<[Vec<(f64, f64)>; 2]> = vec![[vec![], vec![]]; cameras.len()];
    let (mut points, mut shifts): (Vec<[f64; 3]>, Vec<[f64; 3]>) = (vec![], vec![]);
    for (frame, plain) in frames.iter().zip(plain) {
        for (k, plain) in plain.iter().enumerate() {
            let Some((found, used)) = point_from_views(cameras, noise, frame, k, config.least_confidence) else {
                continue;
            };
            points.push(found.point);
            if let Some(plain) = plain {
                shifts.push([0, 1, 2].map(|a: usize| plain[a] - found.point[a]));
            }
            for (i, &c) in used.iter().enumerate() {
                if let Some(r) = found.residual_px[i] {
                    for axis in 0..2 {
                        residuals[c][axis].push((r[axis], found.leverage[i][axis]));
                    }
                }
            }
        }
    }
    Round { residuals, points, shifts }
}

/// Estimates offsets and scatter of all cameras.
#[must_use]
pub fn estimate(cameras: &[Camera], frames: &[Sighted], config: &Config) -> Vec<CameraNoise> {
    let mut noise: Vec<CameraNoise> = (0..cameras.len()).map(|camera| first_noise(camera, frames, config)).collect();
    let keypoints = frames.iter().flatten().map(Vec::len).max().unwrap_or(0);
    let plain: Vec<Vec<Option<[f64; 3]>>> = frames
        .iter()
        .map(|frame| (0..keypoints).map(|k| without_offsets(cameras, frame, k, config)).collect())
        .collect();
    for _ in 0..config.rounds.max(1) {
        let Round { residuals, points, shifts } = round(cameras, frames, &plain, &noise, config);
        let mut moved = 0.0_f64;
        for (c, axes) in residuals.iter().enumerate() {
            noise[c].residuals = axes[0].len();
            let mut shift = [0.0; 2];
            if !config.no_offsets {
                shift = [0, 1].map(|a: usize| median(&mut axes[a].iter().map(|(r, _)| *r).collect::<Vec<_>>()));
                shift = shift.map(|s| if s.is_finite() { s } else { 0.0 });
            }
            let standardised = axes.iter().zip(shift).flat_map(|(axis, s)| {
                // A residual that its own leverage hides says nothing.
                axis.iter().filter(|(_, h)| *h < 0.9).map(move |(r, h)| (r - s) / (1.0 - h).sqrt())
            });
            let sigma = robust_sigma(standardised);
            let sigma = if sigma.is_nan() { sigma } else { sigma.max(config.least_sigma_px) };
            if sigma.is_finite() {
                moved = moved.max((sigma - noise[c].sigma_px).abs());
                noise[c].sigma_px = sigma;
            }
            for (offset, shift) in noise[c].offset_px.iter_mut().zip(shift) {
                *offset += shift;
                moved = moved.max(shift.abs());
            }
        }
        if !config.no_offsets {
            settle_common_mode(cameras, &mut noise, &shifts, &points);
        }
        if moved < config.tolerance_px {
            break;
        }
    }
    for n in &mut noise {
        if n.residuals == 0 {
            n.sigma_px = f64::NAN;
        }
    }
    noise
}

/// Where a keypoint lies by those cameras that agree best as they are calibrated.
fn without_offsets(cameras: &[Camera], frame: &Sighted, keypoint: usize, config: &Config) -> Option<[f64; 3]> {
    let seen: Vec<Seen<'_>> = cameras
        .iter()
        .zip(frame)
        .filter_map(|(camera, points)| {
            let d = points.get(keypoint).copied().flatten()?;
            Some(Seen { camera, pixel: d.pixel, confidence: d.confidence })
        })
        .collect();
    let plain = triangulate::Config { least_confidence: config.least_confidence, ..triangulate::Config::default() };
    triangulate::triangulate(&seen, &plain).map(|t| t.point)
}

/// Standard deviation per axis, metres, of the shift of the whole world that estimated offsets leave unsettled at a point of it; `None` where too few cameras see the point.
///
/// Were the calibrations wrong by independent offsets of variance b² per axis, the shift that explains them best would have the covariance `b² (Σ J_cᵀ J_c)⁻¹`, and what
/// remains, the estimated offsets, would have b² in `2 C − 3` directions of the `2 C` of C cameras. The answer is the root of a third of that covariance's trace, with `b² = Σ |b_c|² / (2 C − 3)`.
#[must_use]
pub fn hidden_shift_m(cameras: &[Camera], offsets_px: &[[f64; 2]], at: [f64; 3]) -> Option<f64> {
    let mut information = Matrix3::<f64>::zeros();
    let (mut squares, mut directions) = (0.0, -3.0);
    for (camera, [du, dv]) in cameras.iter().zip(offsets_px) {
        let Some((_, jacobian)) = camera.project_with_jacobian(at) else { continue };
        let jacobian = Matrix2x3::from_fn(|axis, k| jacobian[axis][k]);
        information += jacobian.transpose() * jacobian;
        squares += du * du + dv * dv;
        directions += 2.0;
    }
    let covariance = information.try_inverse().filter(|_| directions > 0.0)? * (squares / directions);
    Some((covariance.trace() / 3.0).sqrt()).filter(|shift| shift.is_finite())
}

/// Chooses the common mode: the shift of the world that takes the points, in the median, to where they are without offsets.
fn settle_common_mode(cameras: &[Camera], noise: &mut [CameraNoise], shifts: &[[f64; 3]], points: &[[f64; 3]]) {
    let middle_of =
        |points: &[[f64; 3]]| [0, 1, 2].map(|k: usize| median(&mut points.iter().map(|p| p[k]).collect::<Vec<_>>()));
    let (middle, shift) = (middle_of(points), middle_of(shifts));
    if !shift.iter().chain(&middle).all(|x| x.is_finite()) {
        return;
    }
    for (camera, n) in cameras.iter().zip(noise) {
        if n.residuals == 0 {
            continue;
        }
        let Some((_, jacobian)) = camera.project_with_jacobian(middle) else { continue };
        for (d, b) in jacobian.iter().zip(&mut n.offset_px) {
            *b -= (0..3).map(|k| d[k] * shift[k]).sum::<f64>();
        }
    }
}
