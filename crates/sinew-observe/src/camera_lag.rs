//! Lags of the cameras' clocks against each other, and their drifts, to fractions of a frame, from how keypoints move.
//!
//! A camera that is τ frames late shows in its frame f what the others show in their frame f − τ. A point at X with velocity V (metres a frame) then lies, beside its
//! constant offset b, `−τ J V` pixels from where the others place it, J the derivative of the camera's pixels. With r = observed − projected for all cameras of a point,
//! stacked,
//!
//! ```text
//! r = J δ − (τ + s ρ) ∘ (J V) + b + ε     δ: error of the triangulated point, removed by projection
//! ```
//!
//! is linear in the τ, drifts ρ and b of all cameras together, so that one late camera does not make another look early; s is the time, −1 in the first frame and 1 in the last. Robust weights (Cauchy's, Holland & Welsch 1977) are
//! iterated. Velocities have errors. Their squares would count as motion, where there is none: the information about lags and drifts is made of products of a velocity from odd frames and one from even ones, whose errors are apart (instrumental variables). What is found is taken away, by interpolation between frames ([`crate::between_frames`]), and the rest is estimated again until nothing is left: V is constant over a few frames only. A lag common to all cameras is not
//! seen: lags are those against the largest group of cameras that agree within half a frame, or against the first camera where all differ.
//!
//! Standard deviations follow from the estimating equations with errors that are shared within a keypoint's `BLOCK` frames (Liang & Zeger 1986): detectors err the
//! same way for some frames. A weak prior keeps what nothing determines at 0 with a standard deviation of `PRIOR_FRAMES`, and a drift of `PRIOR_PPM`.

use crate::between_frames::keypoint_between;
use crate::camera::Camera;
use crate::offsets::{CameraNoise, Sighted, point_from_views};
use crate::point_velocity::{two_velocities, velocity};
use nalgebra::{DMatrix, DVector, Matrix2, Matrix2x3, Matrix3, SMatrix, SVector, Vector2, Vector3};
use std::collections::HashMap;

/// How late a camera's clock is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraLag {
    /// Frames; a late camera shows in frame f what others show in frame f − `frames`.
    pub frames: f64,
    /// Standard deviation, frames.
    pub sd: f64,
}

/// How a camera's clock runs against the others.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraClock {
    /// Its lag in the frame `middle`.
    pub lag: CameraLag,
    /// Frames that it falls behind in a frame, and their standard deviation.
    pub drift: [f64; 2],
    /// Middle of the frames that were looked at.
    pub middle: f64,
}

/// Lag from which on a camera is said to be late or early, frames.
const LEAST: f64 = 0.5;
/// Standard deviations that a lag must differ from 0 by.
const CERTAIN: f64 = 4.0;
/// Standard deviations, and frames, within which a lag may be that of a whole frame.
const WHOLE: f64 = 2.0;
const NEARLY: f64 = 0.05;

impl CameraLag {
    /// Whether the camera is off by half a frame or more beyond doubt.
    #[must_use]
    pub fn is_off(&self) -> bool {
        self.frames.abs() >= LEAST && self.frames.abs() > CERTAIN * self.sd
    }

    /// The lag as it should be declared: whole frames where it may be whole, hundredths of a frame elsewhere.
    #[must_use]
    pub fn rounded(&self) -> f64 {
        let whole = self.frames.round();
        let may_be_whole = (self.frames - whole).abs() < (WHOLE * self.sd).max(NEARLY);
        // Adding 0 makes 0 of −0.
        if may_be_whole { whole + 0.0 } else { (100.0 * self.frames).round() / 100.0 }
    }
}

/// Standard deviations of the prior: lag in frames, offset in pixels, drift in parts in a million.
const PRIOR_FRAMES: f64 = 10.0;
const PRIOR_PX: f64 = 100.0;
const PRIOR_PPM: f64 = 300.0;
/// Drift where none is looked for, frames.
const NO_DRIFT: f64 = 1e-6;
/// Frames on each side from which a velocity is estimated.
const REACH: u64 = 3;
/// Consecutive frames in which the errors of a keypoint count as one.
const BLOCK: u64 = 15;
/// Times that what was found is taken away, and times that weights are computed.
const ROUNDS: usize = 12;
const WEIGHTINGS: usize = 4;
/// What may be left at the end, frames.
const LEFT: f64 = 0.003;
/// Standard deviation of a lag of which nothing is known, frames.
const UNKNOWN: f64 = 2.0;
/// Largest lag, frames.
const MOST: f64 = 30.0;
/// Residual, in standard deviations, at which a weight is a half.
const SOFT: f64 = 2.0;
/// Numbers of a camera: lag, drift, offset.
const OWN: usize = 4;

/// A keypoint in a frame, seen by several cameras.
struct Sight {
    cluster: usize,
    views: Vec<SightView>,
}

struct SightView {
    camera: usize,
    residual: Vector2<f64>,
    point: Matrix2x3<f64>,
    /// Derivative by the camera's numbers.
    own: SMatrix<f64, 2, OWN>,
    /// The same with velocities from odd and from even frames.
    odd: SMatrix<f64, 2, OWN>,
    even: SMatrix<f64, 2, OWN>,
}

/// The time in which drifts are measured: s = (f − middle) / half.
#[derive(Clone, Copy)]
struct Span {
    middle: f64,
    half: f64,
}

impl Span {
    fn over(runs: &[&[(u64, Sighted)]]) -> Self {
        let numbers = || runs.iter().flat_map(|run| run.iter()).map(|(number, _)| *number as f64);
        let (first, last) = (numbers().fold(f64::INFINITY, f64::min), numbers().fold(0.0, f64::max));
        Self { middle: 0.5 * (first + last), half: (0.5 * (last - first)).max(1.0) }
    }

    fn at(&self, number: u64) -> f64 {
        (number as f64 - self.middle) / self.half
    }
}

/// Lags of all cameras, from runs of frames (number, detections) in which one person is followed; `None` with fewer than two cameras.
#[must_use]
pub fn camera_lags(
    cameras: &[Camera],
    noise: &[CameraNoise],
    runs: &[&[(u64, Sighted)]],
    least_confidence: f64,
) -> Option<Vec<CameraLag>> {
    let clocks = camera_clocks(cameras, noise, runs, least_confidence, false)?;
    Some(clocks.into_iter().map(|clock| clock.lag).collect())
}

/// Lags and, if looked for, drifts of all cameras, from runs as for [`camera_lags`]; `None` with fewer than two cameras.
#[must_use]
pub fn camera_clocks(
    cameras: &[Camera],
    noise: &[CameraNoise],
    runs: &[&[(u64, Sighted)]],
    least_confidence: f64,
    drifts: bool,
) -> Option<Vec<CameraClock>> {
    let count = cameras.len();
    if count < 2 {
        return None;
    }
    let span = Span::over(runs);
    let drift_sd = if drifts { 1e-6 * PRIOR_PPM * span.half } else { NO_DRIFT };
    let mut total = DVector::zeros(OWN * count);
    let mut covariance = DMatrix::zeros(OWN * count, OWN * count);
    let mut known = vec![false; count];
    for _ in 0..ROUNDS {
        let mut sights = vec![];
        for (run, frames) in runs.iter().enumerate() {
            let shifted = shifted(frames, &total, span);
            sights.extend(sights_of(cameras, noise, (&shifted, run), span, least_confidence));
        }
        let Some((rest, of_rest)) = regression(noise, &sights, &total, drift_sd) else {
            known.fill(false);
            break;
        };
        known = are_known(&sights, &rest, &of_rest);
        covariance = of_rest;
        let mut most: f64 = 0.0;
        for (camera, own) in rest.as_slice().chunks_exact(OWN).enumerate().filter(|(camera, _)| known[*camera]) {
            for place in [OWN * camera, OWN * camera + 1] {
                let before = total[place];
                total[place] = f64::clamp(before + own[place % OWN], -MOST, MOST);
                most = most.max((total[place] - before).abs());
            }
        }
        if most < LEFT {
            break;
        }
    }
    Some(against_reference(&total, &covariance, &known, span))
}

/// Frames in which each camera shows what it saw when its clock said so.
fn shifted(frames: &[(u64, Sighted)], total: &DVector<f64>, span: Span) -> Vec<(u64, Sighted)> {
    let place: HashMap<u64, usize> = frames.iter().enumerate().map(|(place, (number, _))| (*number, place)).collect();
    let view = |number: f64, camera: usize| {
        let place = (number >= 0.0).then(|| place.get(&(number as u64))).flatten()?;
        frames[*place].1.get(camera)
    };
    let shown = |number: u64, camera: usize| {
        let time = number as f64 + total[OWN * camera] + total[OWN * camera + 1] * span.at(number);
        let (start, share) = (time.floor(), time - time.floor());
        let near = [-1.0, 0.0, 1.0, 2.0].map(|step| view(start + step, camera));
        let keypoints = near.iter().flatten().map(|view| view.len()).max().unwrap_or(0);
        let at = |k: usize| near.map(|view| view.and_then(|view| view.get(k).copied().flatten()));
        (0..keypoints).map(|k| if share == 0.0 { at(k)[1] } else { keypoint_between(at(k), share) }).collect()
    };
    let cameras = total.len() / OWN;
    frames.iter().map(|(number, _)| (*number, (0..cameras).map(|c| shown(*number, c)).collect())).collect()
}

fn sights_of(
    cameras: &[Camera],
    noise: &[CameraNoise],
    (frames, run): (&[(u64, Sighted)], usize),
    span: Span,
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
            let halves = two_velocities(&points, &numbers, at, REACH);
            let (Some((point, used)), Some(velocity), Some([odd, even])) =
                (found, velocity(&points, &numbers, at, REACH), halves)
            else {
                continue;
            };
            let views: Vec<SightView> = used
                .iter()
                .filter_map(|&camera| {
                    let pixel = frames[at].1.get(camera)?.get(keypoint).copied().flatten()?.pixel;
                    view((&cameras[camera], &noise[camera]), camera, pixel, *point, [velocity, odd, even], span.at(frames[at].0))
                })
                .collect();
            if views.len() > 1 {
                let block = ((frames[at].0 - first) / BLOCK) as usize;
                let cluster = (run * keypoints + keypoint) * CLUSTER_STRIDE + block;
                sights.push(Sight { cluster, views });
            }
        }
    }
    sights
}

/// More blocks than a run has.
const CLUSTER_STRIDE: usize = 1 << 32;

fn view(
    (known, noise): (&Camera, &CameraNoise),
    camera: usize,
    pixel: [f64; 2],
    point: [f64; 3],
    velocities: [Vector3<f64>; 3],
    time: f64,
) -> Option<SightView> {
    let (projected, jacobian) = known.project_with_jacobian(point)?;
    let residual = Vector2::from_fn(|axis, _| pixel[axis] - noise.offset_px[axis] - projected[axis]);
    let by_point = Matrix2x3::from_fn(|axis, k| jacobian[axis][k]);
    let [own, odd, even] = velocities.map(|velocity| {
        let flow = by_point * velocity;
        SMatrix::from_row_slice(&[-flow[0], -time * flow[0], 1.0, 0.0, -flow[1], -time * flow[1], 0.0, 1.0])
    });
    Some(SightView { camera, residual, point: by_point, own, odd, even })
}

/// Which cameras' lags are known at all, against the mean of the cameras that show something.
fn are_known(sights: &[Sight], rest: &DVector<f64>, covariance: &DMatrix<f64>) -> Vec<bool> {
    let count = rest.len() / OWN;
    let mut shows = vec![false; count];
    sights.iter().flat_map(|sight| &sight.views).for_each(|view| shows[view.camera] = true);
    let showing: Vec<usize> = (0..count).filter(|&c| shows[c]).collect();
    let is_known = |c: usize| {
        let contrast = contrast(rest.len(), 0, c, &showing);
        shows[c] && contrast.dot(rest).abs() < MOST && contrast.dot(&(covariance * &contrast)) < UNKNOWN.powi(2)
    };
    (0..count).map(is_known).collect()
}

/// The difference of one of a camera's numbers from its mean over some cameras, as a row of weights.
fn contrast(size: usize, place: usize, camera: usize, mean: &[usize]) -> DVector<f64> {
    let share = -1.0 / mean.len().max(1) as f64;
    let weight = |c: usize| f64::from(c == camera) + if mean.contains(&c) { share } else { 0.0 };
    DVector::from_fn(size, |i, _| if i % OWN == place { weight(i / OWN) } else { 0.0 })
}

/// What is left of the numbers of all cameras beyond `total`, and their covariance; `None` where velocities have nothing in common but errors.
fn regression(
    noise: &[CameraNoise],
    sights: &[Sight],
    total: &DVector<f64>,
    drift_sd: f64,
) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let size = total.len();
    let sigma: Vec<f64> = noise.iter().map(|n| if n.sigma_px.is_finite() { n.sigma_px } else { 1.0 }).collect();
    let prior_sd = [PRIOR_FRAMES, drift_sd, PRIOR_PX, PRIOR_PX];
    let prior = DMatrix::from_diagonal(&DVector::from_fn(size, |i, _| prior_sd[i % OWN].powi(-2)));
    let mut solution = DVector::zeros(size);
    let mut covariance = DMatrix::zeros(size, size);
    for _ in 0..WEIGHTINGS {
        let mut score = -&prior * (&solution + total);
        let mut clusters: HashMap<usize, DVector<f64>> = HashMap::new();
        let mut weights = [0.0; 2];
        let mut seen = DMatrix::zeros(size, size);
        for sight in sights {
            let cluster = clusters.entry(sight.cluster).or_insert_with(|| DVector::zeros(size));
            add(sight, &sigma, &solution, &mut seen, cluster, &mut weights);
        }
        // The derivative of a weighted residual is less than its weight, on the whole by this share (Huber 1981, section 7.6).
        let [weight, derivative] = weights;
        let mut information = prior.clone();
        information += seen * (derivative / weight.max(f64::MIN_POSITIVE));
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
    Some((solution, covariance))
}

/// Adds what a keypoint in a frame says beyond where it is; to `sums` weights, and derivatives of weighted residuals.
fn add(
    sight: &Sight,
    sigma: &[f64],
    solution: &DVector<f64>,
    information: &mut DMatrix<f64>,
    score: &mut DVector<f64>,
    sums: &mut [f64; 2],
) {
    let own = |camera: usize| SVector::<f64, OWN>::from_fn(|i, _| solution[OWN * camera + i]);
    let left: Vec<Vector2<f64>> = sight.views.iter().map(|v| v.residual - v.own * own(v.camera)).collect();
    let plain: Vec<f64> = sight.views.iter().map(|v| sigma[v.camera].powi(-2)).collect();
    let Some((step, _)) = point_step(sight, &left, &plain) else { return };
    let weights: Vec<f64> = (sight.views.iter().zip(&left).zip(&plain))
        .map(|((v, left), plain)| plain / (1.0 + plain * (left - v.point * step).norm_squared() / (SOFT * SOFT)))
        .collect();
    let Some((step, inverse)) = point_step(sight, &left, &weights) else { return };
    for ((a, left), weight) in sight.views.iter().zip(&left).zip(&weights) {
        let square = (left - a.point * step).norm_squared();
        *sums = [sums[0] + weight, sums[1] + weight - weight.powi(2) * square / (SOFT * SOFT)];
        let rows = OWN * a.camera;
        let gradient = *weight * a.own.transpose() * (left - a.point * step);
        let mut place = score.rows_mut(rows, OWN);
        place += gradient;
        for (b, other) in sight.views.iter().zip(&weights) {
            let mut between = -*weight * *other * (a.point * inverse * b.point.transpose());
            if a.camera == b.camera {
                between += *weight * Matrix2::identity();
            }
            let product = a.odd.transpose() * between * b.even + a.even.transpose() * between * b.odd;
            let mut place = information.view_mut((rows, OWN * b.camera), (OWN, OWN));
            place += 0.5 * product;
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

/// Clocks against the cameras that agree with each other.
fn against_reference(
    total: &DVector<f64>,
    covariance: &DMatrix<f64>,
    known: &[bool],
    span: Span,
) -> Vec<CameraClock> {
    let count = total.len() / OWN;
    let late = |c: usize| total[OWN * c];
    let group =
        |c: usize| (0..count).filter(|&d| known[d] && (late(d) - late(c)).abs() < LEAST).collect::<Vec<usize>>();
    // The first of equal groups.
    let reference = (0..count).rev().filter(|c| known[*c]).map(group).max_by_key(Vec::len).unwrap_or_default();
    let difference = |c: usize, place: usize| {
        let contrast = contrast(total.len(), place, c, &reference);
        [contrast.dot(total), contrast.dot(&(covariance * &contrast)).max(0.0).sqrt()]
    };
    let clock = |c: usize| {
        if !known[c] {
            let lag = CameraLag { frames: 0.0, sd: PRIOR_FRAMES };
            return CameraClock { lag, drift: [0.0, 1e-6 * PRIOR_PPM], middle: span.middle };
        }
        let [frames, sd] = difference(c, 0);
        let drift = difference(c, 1).map(|drift| drift / span.half);
        CameraClock { lag: CameraLag { frames, sd }, drift, middle: span.middle }
    };
    (0..count).map(clock).collect()
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

    fn record(
        cameras: &[Camera],
        time: impl Fn(usize, f64) -> f64,
        frames: u64,
        speed: f64,
        seed: u64,
    ) -> Vec<(u64, Sighted)> {
        let mut seed = seed;
        let mut frame = |number: u64| {
            let view = |(index, camera): (usize, &Camera)| {
                (0..POINTS)
                    .map(|point| {
                        let [u, v] = camera.project(at(point, time(index, number as f64), speed)).pixel()?;
                        let pixel = [u + 4.0 + SIGMA_PX * chance(&mut seed), v - 6.0 + SIGMA_PX * chance(&mut seed)];
                        Some(Detection::new(pixel, 0.9))
                    })
                    .collect()
            };
            (number, cameras.iter().enumerate().map(view).collect())
        };
        (0..frames).map(&mut frame).collect()
    }

    fn found(lags: &[f64], speed: f64, seed: u64) -> Vec<CameraLag> {
        let cameras = ring(lags.len());
        let frames = record(&cameras, |camera, time| time - lags[camera], 90, speed, seed);
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

    /// The stated standard deviations are as large as the errors; so are lags of part of a frame, which interpolation takes away.
    #[test]
    fn errors_of_lags_are_as_large_as_stated() {
        // No two within half a frame: the first is the reference.
        let truth = [0.0, 0.8, -0.7, 2.4];
        let (mut squares, mut errors) = (vec![], vec![]);
        for seed in 1..=12 {
            let found = found(&truth, 0.6, seed);
            assert_eq!(found[0], CameraLag::default());
            for (lag, truth) in found.iter().zip(truth).skip(1) {
                squares.push(((lag.frames - truth) / lag.sd).powi(2));
                errors.push(lag.frames - truth);
            }
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        assert!((0.3..2.0).contains(&mean(&squares)), "{}", mean(&squares));
        // Their root mean square is some 0.13, shared within a seed.
        assert!(mean(&errors).abs() < 3.0 * 0.13 / 12.0_f64.sqrt(), "{errors:?}");
    }

    #[test]
    fn a_clock_that_runs_at_another_rate_is_found() {
        let cameras = ring(4);
        let ppm = [0.0, 0.0, 400.0, 0.0];
        let time = |camera: usize, number: f64| number - 0.4 * f64::from(camera == 3) - 1e-6 * ppm[camera] * number;
        let frames = record(&cameras, time, 1500, 1.0, 3);
        let runs: Vec<&[(u64, Sighted)]> = frames.chunks(100).step_by(2).collect();
        let sighted: Vec<Sighted> = frames.iter().step_by(10).map(|(_, sighted)| sighted.clone()).collect();
        let noise = crate::offsets::estimate(&cameras, &sighted, &crate::offsets::Config::default());
        let clocks = camera_clocks(&cameras, &noise, &runs, 0.3, true).unwrap();
        for (camera, clock) in clocks.iter().enumerate() {
            let [drift, sd] = clock.drift;
            let truth = 1e-6 * (ppm[camera] - 400.0 / 4.0);
            assert!((drift - truth).abs() < 4.0 * sd && sd < 4e-5, "{camera}: {clock:?}");
        }
        let lag = clocks[2].lag.frames - clocks[0].lag.frames;
        assert!((lag - 400e-6 * clocks[2].middle).abs() < 0.05, "{lag} {clocks:?}");
    }

    #[test]
    fn clocks_that_agree_and_people_who_stand_still_say_nothing() {
        let mut squares = vec![];
        for seed in 1..=8 {
            for lag in found(&[0.0; 4], 1.0, seed) {
                assert!(!lag.is_off(), "{lag:?}");
                squares.push((lag.frames / lag.sd).powi(2));
            }
            let still = found(&[0.0, 0.0, 2.0, 0.0], 0.0, seed);
            assert!(still.iter().all(|lag| !lag.is_off()));
        }
        // The errors are as large as they are said to be: a mean of 32 squares, of which 24 are independent; 3 sd of their mean are about 0.9.
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        assert!((0.3..2.0).contains(&mean), "{mean}");
    }
}
