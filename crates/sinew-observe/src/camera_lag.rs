//! Lags of the cameras' clocks against each other, to fractions of a frame, from how keypoints move.
//!
//! A camera that is τ frames late shows in its frame f what the others show in their frame f − τ. A point at X with velocity V (metres a frame) then lies, beside its
//! constant offset b, `−τ J V` pixels from where the others place it, J the derivative of the camera's pixels. With r = observed − projected for all cameras of a point,
//! stacked,
//!
//! ```text
//! r = J δ − τ ∘ (J V) + b + ε         δ: error of the triangulated point, removed by projection
//! ```
//!
//! is linear in the τ and b of all cameras together, so that one late camera does not make another look early. Robust weights (Cauchy's, Holland & Welsch 1977) are
//! iterated. Whole frames that are found are taken away and the rest is estimated again, since V is constant over a few frames only. A lag common to all cameras is not
//! seen: lags are those against the largest group of cameras that agree within half a frame, or against the first camera where all differ.
//!
//! Standard deviations follow from the estimating equations with errors that are shared within a keypoint's `BLOCK` frames (Liang & Zeger 1986): detectors err the
//! same way for some frames. A weak prior keeps what nothing determines at 0 with a standard deviation of `PRIOR_FRAMES`.

use crate::camera::Camera;
use crate::offsets::{CameraNoise, Sighted, point_from_views};
use crate::point_velocity::velocity;
use nalgebra::{DMatrix, DVector, Matrix2x3, Matrix3, Vector2, Vector3};
use std::collections::HashMap;

/// How late a camera's clock is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraLag {
    /// Frames; a late camera shows in frame f what others show in frame f − `frames`.
    pub frames: f64,
    /// Standard deviation, frames.
    pub sd: f64,
}

/// Lag from which on a camera is said to be late or early, frames.
const LEAST: f64 = 0.5;
/// Standard deviations that a lag must differ from 0 by.
const CERTAIN: f64 = 4.0;

impl CameraLag {
    /// Whether the camera is off by half a frame or more beyond doubt.
    #[must_use]
    pub fn is_off(&self) -> bool {
        self.frames.abs() >= LEAST && self.frames.abs() > CERTAIN * self.sd
    }
}

/// Standard deviations of the prior: lag in frames, offset in pixels.
const PRIOR_FRAMES: f64 = 10.0;
const PRIOR_PX: f64 = 100.0;
/// Frames on each side from which a velocity is estimated.
const REACH: u64 = 3;
/// Consecutive frames in which the errors of a keypoint count as one.
const BLOCK: u64 = 15;
/// Times that whole frames are taken away, and times that weights are computed.
const ROUNDS: usize = 6;
const WEIGHTINGS: usize = 4;
/// Largest lag, frames.
const MOST: f64 = 30.0;
/// Residual, in standard deviations, at which a weight is a half.
const SOFT: f64 = 2.0;

/// A keypoint in a frame, seen by several cameras.
struct Sight {
    cluster: usize,
    views: Vec<SightView>,
}

struct SightView {
    camera: usize,
    residual: Vector2<f64>,
    point: Matrix2x3<f64>,
    /// Derivative by lag and offset.
    own: Matrix2x3<f64>,
}

/// Lags of all cameras, from runs of frames (number, detections) in which one person is followed; `None` with fewer than two cameras.
#[must_use]
pub fn camera_lags(
    cameras: &[Camera],
    noise: &[CameraNoise],
    runs: &[&[(u64, Sighted)]],
    least_confidence: f64,
) -> Option<Vec<CameraLag>> {
    let count = cameras.len();
    if count < 2 {
        return None;
    }
    let mut whole = vec![0_i64; count];
    let mut found = vec![];
    for _ in 0..ROUNDS {
        let mut sights = vec![];
        for (run, frames) in runs.iter().enumerate() {
            let shifted = shifted(frames, &whole);
            sights.extend(sights_of(cameras, noise, &shifted, run, least_confidence));
        }
        let (rest, covariance) = regression(noise, &sights, count)?;
        let total: Vec<f64> = (0..count).map(|c| whole[c] as f64 + rest[c]).collect();
        found = against_reference(&total, &covariance);
        let next: Vec<i64> = found.iter().map(|lag| lag.frames.round().clamp(-MOST, MOST) as i64).collect();
        if next == whole {
            break;
        }
        whole = next;
    }
    Some(found)
}

/// Frames in which each camera shows what it saw some frames later.
fn shifted(frames: &[(u64, Sighted)], by: &[i64]) -> Vec<(u64, Sighted)> {
    let place: HashMap<u64, usize> = frames.iter().enumerate().map(|(place, (number, _))| (*number, place)).collect();
    let shown = |number: u64, camera: usize| {
        let place = place.get(&number.checked_add_signed(by[camera])?)?;
        frames[*place].1.get(camera).cloned()
    };
    let frame =
        |number: u64| (0..by.len()).map(|camera| shown(number, camera).unwrap_or_default()).collect::<Sighted>();
    frames.iter().map(|(number, _)| (*number, frame(*number))).collect()
}

fn sights_of(
    cameras: &[Camera],
    noise: &[CameraNoise],
    frames: &[(u64, Sighted)],
    run: usize,
    least_confidence: f64,
) -> Vec<Sight> {
    let keypoints = frames.iter().flat_map(|(_, views)| views).map(Vec::len).max().unwrap_or(0);
    let first = frames.first().map_or(0, |(number, _)| *number);
    let numbers: Vec<u64> = frames.iter().map(|(number, _)| *number).collect();
    let mut sights = vec![];
    for keypoint in 0..keypoints {
        let found: Vec<Option<([f64; 3], Vec<usize>)>> = frames
            .iter()
            .map(|(_, views)| {
                let (refined, used) = point_from_views(cameras, noise, views, keypoint, least_confidence)?;
                Some((refined.point, used))
            })
            .collect();
        let points: Vec<Option<[f64; 3]>> = found.iter().map(|found| found.as_ref().map(|(point, _)| *point)).collect();
        for (at, found) in found.iter().enumerate() {
            let (Some((point, used)), Some(velocity)) = (found, velocity(&points, &numbers, at, REACH)) else {
                continue;
            };
            let views: Vec<SightView> = used
                .iter()
                .filter_map(|&camera| {
                    let pixel = frames[at].1.get(camera)?.get(keypoint).copied().flatten()?.pixel;
                    view(cameras, noise, camera, pixel, *point, velocity)
                })
                .collect();
            if views.len() > 1 {
                let block = ((frames[at].0 - first) / BLOCK) as usize;
                sights.push(Sight { cluster: (run * keypoints + keypoint) * CLUSTER_STRIDE + block, views });
            }
        }
    }
    sights
}

/// More blocks than a run has.
const CLUSTER_STRIDE: usize = 1 << 32;

fn view(
    cameras: &[Camera],
    noise: &[CameraNoise],
    camera: usize,
    pixel: [f64; 2],
    point: [f64; 3],
    velocity: Vector3<f64>,
) -> Option<SightView> {
    let (projected, jacobian) = cameras[camera].project_with_jacobian(point)?;
    let offset = noise[camera].offset_px;
    let residual = Vector2::from_fn(|axis, _| pixel[axis] - offset[axis] - projected[axis]);
    let by_point = Matrix2x3::from_fn(|axis, k| jacobian[axis][k]);
    let flow = by_point * velocity;
    let own = Matrix2x3::new(-flow[0], 1.0, 0.0, -flow[1], 0.0, 1.0);
    Some(SightView { camera, residual, point: by_point, own })
}

/// Lags, and the covariance of the lags.
fn regression(noise: &[CameraNoise], sights: &[Sight], count: usize) -> Option<(Vec<f64>, DMatrix<f64>)> {
    let size = 3 * count;
    let sigma: Vec<f64> = noise.iter().map(|n| if n.sigma_px.is_finite() { n.sigma_px } else { 1.0 }).collect();
    let prior = DMatrix::from_diagonal(&DVector::from_fn(size, |i, _| {
        if i % 3 == 0 { PRIOR_FRAMES.powi(-2) } else { PRIOR_PX.powi(-2) }
    }));
    let mut solution = DVector::zeros(size);
    let mut covariance = DMatrix::zeros(size, size);
    for _ in 0..WEIGHTINGS {
        let mut information = prior.clone();
        let mut score = -&prior * &solution;
        let mut clusters: HashMap<usize, DVector<f64>> = HashMap::new();
        for sight in sights {
            let cluster = clusters.entry(sight.cluster).or_insert_with(|| DVector::zeros(size));
            add(sight, &sigma, &solution, &mut information, cluster);
        }
        // In the order of the clusters, so that sums are the same from run to run.
        let mut clusters: Vec<(usize, DVector<f64>)> = clusters.into_iter().collect();
        clusters.sort_by_key(|(cluster, _)| *cluster);
        let mut spread = prior.clone();
        for (_, own) in &clusters {
            score += own;
            spread += own * own.transpose();
        }
        let inverse = information.cholesky()?.inverse();
        solution += &inverse * score;
        covariance = &inverse * spread * &inverse;
    }
    let lags = (0..count).map(|c| solution[3 * c]).collect();
    Some((lags, DMatrix::from_fn(count, count, |a, b| covariance[(3 * a, 3 * b)])))
}

/// Adds what a keypoint in a frame says beyond where it is.
fn add(
    sight: &Sight,
    sigma: &[f64],
    solution: &DVector<f64>,
    information: &mut DMatrix<f64>,
    score: &mut DVector<f64>,
) {
    let own = |camera: usize| Vector3::from_fn(|i, _| solution[3 * camera + i]);
    let left: Vec<Vector2<f64>> = sight.views.iter().map(|v| v.residual - v.own * own(v.camera)).collect();
    let plain: Vec<f64> = sight.views.iter().map(|v| sigma[v.camera].powi(-2)).collect();
    let Some((step, _)) = point_step(sight, &left, &plain) else { return };
    let weights: Vec<f64> = (sight.views.iter().zip(&left).zip(&plain))
        .map(|((v, left), plain)| plain / (1.0 + plain * (left - v.point * step).norm_squared() / (SOFT * SOFT)))
        .collect();
    let Some((step, inverse)) = point_step(sight, &left, &weights) else { return };
    for ((a, left), weight) in sight.views.iter().zip(&left).zip(&weights) {
        let rows = 3 * a.camera;
        let gradient = *weight * a.own.transpose() * (left - a.point * step);
        let mut place = score.rows_mut(rows, 3);
        place += gradient;
        for (b, other) in sight.views.iter().zip(&weights) {
            let through = *weight * *other * (a.own.transpose() * a.point * inverse * b.point.transpose() * b.own);
            let direct = if a.camera == b.camera { *weight * (a.own.transpose() * a.own) } else { Matrix3::zeros() };
            let mut place = information.view_mut((rows, 3 * b.camera), (3, 3));
            place += direct - through;
        }
    }
}

/// Shift of the point that explains most of the residuals, and the inverse of its information.
fn point_step(sight: &Sight, left: &[Vector2<f64>], weights: &[f64]) -> Option<(Vector3<f64>, Matrix3<f64>)> {
    let mut normal = Matrix3::zeros();
    let mut gradient = Vector3::zeros();
    for ((view, left), weight) in sight.views.iter().zip(left).zip(weights) {
        normal += *weight * view.point.transpose() * view.point;
        gradient += *weight * view.point.transpose() * left;
    }
    let inverse = normal.cholesky()?.inverse();
    Some((inverse * gradient, inverse))
}

/// Lags against those cameras that agree with each other.
fn against_reference(total: &[f64], covariance: &DMatrix<f64>) -> Vec<CameraLag> {
    let count = total.len();
    let group = |c: usize| (0..count).filter(|&d| (total[d] - total[c]).abs() < LEAST).collect::<Vec<usize>>();
    // The first of equal groups.
    let reference = (0..count).rev().map(group).max_by_key(Vec::len).unwrap_or_default();
    let lag = |c: usize| {
        let others: Vec<usize> = reference.iter().copied().filter(|&d| d != c).collect();
        let mean = reference.iter().map(|&d| total[d]).sum::<f64>() / reference.len().max(1) as f64;
        if others.is_empty() {
            return CameraLag { frames: 0.0, sd: 0.0 };
        }
        let share = -1.0 / others.len() as f64;
        let contrast = DVector::from_fn(count, |d, _| match d {
            d if d == c => 1.0,
            d if others.contains(&d) => share,
            _ => 0.0,
        });
        CameraLag { frames: total[c] - mean, sd: contrast.dot(&(covariance * &contrast)).max(0.0).sqrt() }
    };
    (0..count).map(lag).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Detection;

    const POINTS: usize = 12;
    const SIGMA_PX: f64 = 3.0;

    fn ring(count: usize) -> Vec<Camera> {
        let camera = |i: usize| {
            let angle = 0.4 + std::f64::consts::TAU * i as f64 / count as f64;
            let centre = [4.0 * angle.cos(), 4.0 * angle.sin(), 1.8];
            Camera::look_at(&format!("C{i}"), [1000.0, 1000.0], 1000.0, centre, [0.0, 0.0, 1.0]).unwrap()
        };
        (0..count).map(camera).collect()
    }

    /// A repeatable number of variance 1.
    fn chance(seed: &mut u64) -> f64 {
        let mut one = || {
            *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        one() + one() + one()
    }

    /// Points that swing and wander, times `speed`.
    fn at(point: usize, time: f64, speed: f64) -> [f64; 3] {
        let k = point as f64;
        let phase = speed * 0.15 * time + k;
        [0.3 * k.sin() + 0.15 * phase.sin() + 0.004 * speed * time, 0.3 * k.cos() + 0.1 * phase.cos(), 0.15 * k]
    }

    fn record(cameras: &[Camera], lags: &[f64], frames: u64, speed: f64, seed: u64) -> Vec<(u64, Sighted)> {
        let mut seed = seed;
        let mut frame = |number: u64| {
            let view = |(camera, lag): (&Camera, &f64)| {
                (0..POINTS)
                    .map(|point| {
                        let [u, v] = camera.project(at(point, number as f64 - lag, speed)).pixel()?;
                        let pixel = [u + 4.0 + SIGMA_PX * chance(&mut seed), v - 6.0 + SIGMA_PX * chance(&mut seed)];
                        Some(Detection { pixel, confidence: 0.9 })
                    })
                    .collect()
            };
            (number, cameras.iter().zip(lags).map(view).collect())
        };
        (0..frames).map(&mut frame).collect()
    }

    fn found(lags: &[f64], speed: f64, seed: u64) -> Vec<CameraLag> {
        let cameras = ring(lags.len());
        let frames = record(&cameras, lags, 90, speed, seed);
        let sighted: Vec<Sighted> = frames.iter().map(|(_, sighted)| sighted.clone()).collect();
        let noise = crate::offsets::estimate(&cameras, &sighted, &crate::offsets::Config::default());
        camera_lags(&cameras, &noise, &[&frames], 0.3).unwrap()
    }

    #[test]
    fn lags_of_whole_and_part_frames_are_found() {
        for lags in [
            vec![0.0, 0.0, 1.0, 0.0],
            vec![0.0, -2.0, 0.0, 0.0],
            vec![0.0, 0.0, 0.75, 0.0, 0.0],
            vec![0.0, 3.0, -1.0, 0.0, 0.0],
            vec![0.0, 2.0],
        ] {
            for (lag, truth) in found(&lags, 1.0, 5).iter().zip(&lags) {
                assert!((lag.frames - truth).abs() < 0.15 + 3.0 * lag.sd, "{lag:?}, truly {truth}");
                assert_eq!(lag.is_off(), truth.abs() > 0.5, "{lag:?}, truly {truth}");
            }
        }
    }

    #[test]
    fn clocks_that_agree_and_people_who_stand_still_say_nothing() {
        let mut squares = vec![];
        for seed in 1..=8 {
            for lag in found(&[0.0; 4], 1.0, seed) {
                assert!(!lag.is_off(), "{lag:?}");
                squares.push((lag.frames / lag.sd).powi(2));
            }
            assert!(found(&[0.0, 0.0, 2.0, 0.0], 0.0, seed).iter().all(|lag| !lag.is_off()));
        }
        // The errors are as large as they are said to be: a mean of 32 squares, of which 24 are independent; 3 sd of their mean are about 0.9.
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        assert!((0.3..2.0).contains(&mean), "{mean}");
    }
}
