//! Lags and drifts of the cameras' clocks, to fractions of a frame, from how keypoints move.
//!
//! A camera that is τ frames late shows in its frame f what the others show in their frame f − τ. A point at X with velocity V (metres a frame) then lies, beside its
//! constant offset b, `−τ J V` pixels from where the others place it, J the derivative of the camera's pixels. With r = observed − projected for all cameras of a point,
//! stacked,
//!
//! ```text
//! r = J δ − (τ + s ρ) ∘ (J V) + b + ε     δ: error of the triangulated point, removed by projection
//! ```
//!
//! is linear in the τ, drifts ρ and b of all cameras together, so that one late camera does not make another look early; s is the time, −1 in the first frame and 1 in the last. The b are a keypoint's own for some seconds, and change evenly within them (`lag_regression`):
//! of somebody who walks straight ahead, a lag and an offset look alike, and cameras that are not quite where their calibration says have other offsets wherever they are. It is the swing of their limbs that says how late a camera is. What is found is taken away, by interpolation between frames ([`crate::clocks::between_frames`]), and the rest is estimated again until nothing is left: V is constant over a few frames only, and velocities have errors. A lag common to all cameras is not
//! seen: lags are those against the largest group of cameras that agree within half a frame, or against the first camera where all differ.
//!
//! A lag is known only if it follows a test: where a camera is off, its views are moved in time and its lag is estimated again. Keypoints that stand on a coarse grid of pixels while somebody hardly moves have lags that do not.
//!
//! A weak prior keeps what nothing determines at 0 with a standard deviation of `PRIOR_FRAMES`, and a drift of `PRIOR_PPM`; drifts are taken where one of them is certain.

use crate::cameras::camera::Camera;
use crate::cameras::offsets::{self, CameraNoise, Sighted};
use crate::clocks::between_frames::keypoint_between;
pub use crate::clocks::lag_regression::LagSearch;
use crate::clocks::lag_regression::{OWN, PriorSds, Regression, Sight, Span, regression, sights_of};
use nalgebra::{DMatrix, DVector};
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
    /// Frames that it falls behind in a frame, and their standard deviation; 0 where no camera drifts beyond doubt.
    pub drift: [f64; 2],
    /// Middle of the frames that were looked at.
    pub middle: f64,
}

/// The lag from which on a camera is said to be late or early, frames.
const LEAST: f64 = 0.5;
/// Standard deviations that a lag must differ from 0 by.
const CERTAIN: f64 = 4.0;
/// Standard deviations, and frames, within which a lag may be a whole one: errors are 1.5 times as large as stated and more, and up to a fifth of a frame (docs/evidence/sync.md).
const WHOLE: f64 = 3.0;
const NEARLY: f64 = 0.2;

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

/// Standard deviations of the prior: lag in frames, drift in parts in a million.
const PRIOR_FRAMES: f64 = 10.0;
const PRIOR_PPM: f64 = 300.0;
/// Drift where none is looked for, frames.
const NO_DRIFT: f64 = 1e-6;
/// Seconds within which no clock is seen to drift.
const LEAST_DRIFT_S: f64 = 10.0;
/// Times that what was found is taken away.
const ROUNDS: usize = 10;
/// What may be left at the end, frames.
const LEFT: f64 = 0.02;
/// Standard deviation of a lag of which nothing is known, frames.
const UNKNOWN: f64 = 2.0;
/// Largest lag, frames.
const MOST: f64 = 30.0;
/// Frames from which offsets and scatter are estimated, and rounds of that.
const OFFSET_FRAMES: usize = 40;
const OFFSET_ROUNDS: usize = 8;
/// Lags that must lower the misfit, frames: beyond it the model is not linear, and people who are taken for each other or whose limbs are exchanged lead to lags that nothing has.
const FAR: f64 = 1.5;
/// Standard deviation of what is not to be estimated.
const NOT_FREE: f64 = 1e-6;
/// Standard deviations of a keypoint's offset, pixels: one that lets a lag alone, and one as calibrations and detectors have it. A lag of half a stride, in which one leg looks like the other, needs offsets as long as the way in that time.
const ANY_OFFSET_PX: f64 = 100.0;
const USUAL_OFFSET_PX: f64 = 10.0;
/// Frames by which the views of a camera that is off are moved to see whether its lag follows, and the share that it must follow by.
const MOVED_BY: f64 = 4.0;
const FOLLOWED: f64 = 0.5;
/// Change of a lag after which they are estimated again, frames.
const SCATTERS: f64 = 0.1;

/// Clocks of all cameras, from runs of frames (number, detections) in which one person is followed; `None` with fewer than two cameras.
///
/// Lags contain the frames `taken` away from each camera when the runs were read.
#[must_use]
pub fn camera_clocks(
    (cameras, taken): (&[Camera], &[f64]),
    runs: &[&[(u64, Sighted)]],
    search: &LagSearch,
) -> Option<Vec<CameraClock>> {
    if cameras.len() < 2 {
        return None;
    }
    let span = Span::over(runs);
    let seen = SeenRuns { cameras, runs, search, span };
    let mut fit = Fit::nothing_known(cameras.len());
    fit.improve(&seen, NO_DRIFT);
    fit.doubt(&seen, NO_DRIFT, taken);
    if search.drifts && 2.0 * span.half > LEAST_DRIFT_S * search.fps {
        let mut drifting = fit.clone();
        let drift_sd = 1e-6 * PRIOR_PPM * span.half;
        drifting.improve(&seen, drift_sd);
        drifting.doubt(&seen, drift_sd, taken);
        let found = drifting.clocks(taken, span);
        if found.iter().any(|clock| clock.drift[0].abs() > CERTAIN * clock.drift[1]) {
            return Some(found);
        }
    }
    let still = |clock: CameraClock| CameraClock { drift: [0.0; 2], ..clock };
    Some(fit.clocks(taken, span).into_iter().map(still).collect())
}

/// Runs of frames (number, detections) of some cameras, and the frames that they span.
struct SeenRuns<'a> {
    cameras: &'a [Camera],
    runs: &'a [&'a [(u64, Sighted)]],
    search: &'a LagSearch,
    span: Span,
}

/// What is known of the numbers of all cameras: lag and drift of each.
#[derive(Clone)]
struct Fit {
    total: DVector<f64>,
    covariance: DMatrix<f64>,
    known: Vec<bool>,
}

impl Fit {
    fn nothing_known(count: usize) -> Self {
        let size = OWN * count;
        Self { total: DVector::zeros(size), covariance: DMatrix::zeros(size, size), known: vec![false; count] }
    }

    /// Takes away what is found, until nothing is left.
    fn improve(&mut self, seen: &SeenRuns<'_>, drift_sd: f64) {
        let &SeenRuns { cameras, runs, search, span } = seen;
        let mut noise = vec![];
        let mut most = f64::INFINITY;
        let prior = PriorSds { own: [PRIOR_FRAMES, drift_sd], offset_px: ANY_OFFSET_PX };
        for _ in 0..ROUNDS {
            let runs: Vec<_> = runs.iter().map(|frames| shifted(frames, &self.total, span)).collect();
            if most > SCATTERS {
                noise = scatter(cameras, &runs, search);
            }
            let sights: Vec<Sight> =
                runs.iter().flat_map(|frames| sights_of(cameras, &noise, frames, span, search)).collect();
            let Some(Regression { rest, covariance, .. }) = regression(&noise, &sights, &self.total, &prior) else {
                self.known.fill(false);
                return;
            };
            self.known = are_known(&sights, &rest, &covariance);
            self.covariance = covariance;
            most = 0.0;
            for (place, own) in rest.iter().enumerate().filter(|(place, _)| self.known[place / OWN]) {
                let before = self.total[place];
                self.total[place] = f64::clamp(before + own, -MOST, MOST);
                most = most.max((self.total[place] - before).abs());
            }
            if most < LEFT {
                break;
            }
        }
        let is_far = (0..cameras.len()).any(|c| self.total[OWN * c].abs() >= FAR);
        let misfit = |lags: &DVector<f64>| misfit(seen, &noise, lags);
        let none = DVector::zeros(self.total.len());
        if is_far && misfit(&self.total).zip(misfit(&none)).is_none_or(|(found, none)| found >= none) {
            self.known.fill(false);
        }
    }

    /// Clocks, the frames `taken` away before among their lags.
    fn clocks(&self, taken: &[f64], span: Span) -> Vec<CameraClock> {
        let lags = self.total.iter().enumerate().map(|(i, own)| own + if i % OWN == 0 { taken[i / OWN] } else { 0.0 });
        against_reference(&DVector::from_iterator(self.total.len(), lags), &self.covariance, &self.known, span)
    }

    /// Takes the lag of a camera that is off as unknown if it does not follow where the camera's views are moved in time, towards the others.
    fn doubt(&mut self, seen: &SeenRuns<'_>, drift_sd: f64, taken: &[f64]) {
        let &SeenRuns { cameras, runs, span, .. } = seen;
        let clocks = self.clocks(taken, span);
        let follows = |camera: usize| {
            let by = MOVED_BY.copysign(clocks[camera].lag.frames);
            let mut moves = DVector::zeros(self.total.len());
            moves[OWN * camera] = by;
            let moved: Vec<_> = runs.iter().map(|frames| shifted(frames, &moves, span)).collect();
            let moved: Vec<&[(u64, Sighted)]> = moved.iter().map(Vec::as_slice).collect();
            let mut fit = Self::nothing_known(cameras.len());
            fit.improve(&SeenRuns { runs: &moved, ..*seen }, drift_sd);
            let late = |of: &Self| {
                let others: Vec<f64> = (0..cameras.len())
                    .filter(|other| *other != camera && self.known[*other])
                    .map(|other| of.total[OWN * other])
                    .collect();
                of.total[OWN * camera] - others.iter().sum::<f64>() / others.len().max(1) as f64
            };
            fit.known[camera] && (late(self) - late(&fit)) / by >= FOLLOWED
        };
        let doubtful: Vec<usize> =
            (0..cameras.len()).filter(|c| self.known[*c] && clocks[*c].lag.is_off() && !follows(*c)).collect();
        doubtful.into_iter().for_each(|camera| self.known[camera] = false);
    }
}

/// How badly cameras agree once lags are taken away: the mean loss of a view; `None` where that is not known.
fn misfit(seen: &SeenRuns<'_>, noise: &[CameraNoise], lags: &DVector<f64>) -> Option<f64> {
    let &SeenRuns { cameras, runs, search, span } = seen;
    let runs = runs.iter().map(|frames| shifted(frames, lags, span));
    let sights: Vec<Sight> = runs.flat_map(|frames| sights_of(cameras, noise, &frames, span, search)).collect();
    let none = DVector::zeros(lags.len());
    (!sights.is_empty()).then_some(())?;
    Some(regression(noise, &sights, &none, &PriorSds { own: [NOT_FREE; OWN], offset_px: USUAL_OFFSET_PX })?.loss)
}

/// Offsets and scatter of the cameras, from some of the frames: late cameras scatter more than they do once their lags are taken away.
fn scatter(cameras: &[Camera], runs: &[Vec<(u64, Sighted)>], search: &LagSearch) -> Vec<CameraNoise> {
    let frames = runs.iter().map(Vec::len).sum::<usize>();
    let some = runs.iter().flatten().step_by(frames.div_ceil(OFFSET_FRAMES).max(1));
    let some: Vec<Sighted> = some.map(|(_, sighted)| sighted.clone()).collect();
    // Weights need no better: offsets of keypoints are estimated with the lags.
    let roughly = offsets::Config { rounds: OFFSET_ROUNDS, ..search.offsets };
    offsets::estimate(cameras, &some, &roughly)
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

/// Clocks against the cameras that agree with each other.
fn against_reference(total: &DVector<f64>, covariance: &DMatrix<f64>, known: &[bool], span: Span) -> Vec<CameraClock> {
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

    fn search() -> LagSearch {
        LagSearch { fps: 60.0, offsets: offsets::Config::default(), drifts: true }
    }
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

    /// Points that swing and walk to and fro, times `speed`.
    fn at(point: usize, time: f64, speed: f64) -> [f64; 3] {
        let k = point as f64;
        let phase = speed * 0.15 * time + k;
        [
            0.3 * k.sin() + 0.15 * phase.sin() + 0.5 * (0.008 * speed * time).sin(),
            0.3 * k.cos() + 0.1 * phase.cos(),
            0.15 * k,
        ]
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

    fn found(lags: &[f64], frames: u64, speed: f64, seed: u64) -> Vec<CameraLag> {
        let cameras = ring(lags.len());
        let frames = record(&cameras, |camera, time| time - lags[camera], frames, speed, seed);
        let clocks = camera_clocks((&cameras, &vec![0.0; lags.len()]), &[&frames], &search()).unwrap();
        clocks.into_iter().map(|clock| clock.lag).collect()
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
            for (lag, truth) in found(&lags, 90, 1.0, 5).iter().zip(&lags) {
                assert!((lag.frames - truth).abs() < 0.15 + 3.0 * lag.sd, "{lag:?}, truly {truth}");
                assert_eq!(lag.is_off(), truth.abs() > 0.5, "{lag:?}, truly {truth}");
            }
        }
    }

    /// The stated standard deviations are as large as the errors; so are lags of part of a frame, which interpolation takes away.
    #[test]
    fn errors_of_lags_are_as_large_as_stated() {
        // No two within half a frame: the first is the reference.
        let truth = [0.0, 1.2, -1.3, 2.5];
        let (mut squares, mut errors) = (vec![], vec![]);
        for seed in 1..=16 {
            let found = found(&truth, 360, 1.0, seed);
            assert_eq!(found[0], CameraLag::default());
            for (lag, truth) in found.iter().zip(truth).skip(1) {
                squares.push(((lag.frames - truth) / lag.sd).powi(2));
                errors.push(lag.frames - truth);
            }
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        // 48 squares, three of a seed sharing the reference's error: 3 sd of their mean are about 0.8.
        assert!((0.4..1.8).contains(&mean(&squares)), "{}", mean(&squares));
        // Errors share the reference's within a seed.
        let square = mean(&errors.iter().map(|error| error * error).collect::<Vec<_>>());
        assert!(mean(&errors).abs() < 3.0 * (square / 16.0).sqrt() && square.sqrt() < 0.1, "{errors:?}");
    }

    /// An offset that changes evenly within its four seconds is taken off: what is left is noise, and lags stay.
    #[test]
    fn offsets_that_change_evenly_leave_nothing_but_noise() {
        let cameras = ring(4);
        let steady = record(&cameras, |_, time| time, 240, 1.0, 3);
        let mut changing = steady.clone();
        for (number, views) in &mut changing {
            let within = 2.0 * *number as f64 / 240.0 - 1.0;
            for (camera, points) in views.iter_mut().enumerate() {
                for (keypoint, seen) in points.iter_mut().enumerate() {
                    let direction = (3 * camera + keypoint) as f64;
                    seen.iter_mut().for_each(|seen| {
                        seen.pixel[0] += 6.0 * within * direction.cos();
                        seen.pixel[1] += 6.0 * within * direction.sin();
                    });
                }
            }
        }
        let known = CameraNoise { offset_px: [4.0, -6.0], ..CameraNoise::without_offset(SIGMA_PX, 0.9) };
        let noise = vec![known; cameras.len()];
        let regressed = |frames: &[(u64, Sighted)]| {
            let sights = sights_of(&cameras, &noise, frames, Span::over(&[frames]), &search());
            let prior = PriorSds { own: [3.0, 3.0], offset_px: 30.0 };
            regression(&noise, &sights, &DVector::zeros(OWN * cameras.len()), &prior).unwrap()
        };
        let [steady, changing] = [&steady, &changing].map(|frames| regressed(frames));
        // Four cameras have eight coordinates, of which the point takes three: squared residuals, two coordinates each, are 5/8 of chi-squared's, and the mean of 4 ln(1 + r²/4) is 4 exp(3.2) E1(3.2).
        let expected = 0.994;
        for found in [&steady, &changing] {
            assert!((found.loss / expected - 1.0).abs() < 0.08, "{}", found.loss);
        }
        for i in (0..OWN * cameras.len()).step_by(OWN) {
            let sd = steady.covariance[(i, i)].sqrt();
            assert!((steady.rest[i] - changing.rest[i]).abs() < 0.5 * sd, "{i}: {} {}", steady.rest, changing.rest);
        }
    }

    #[test]
    fn a_clock_that_runs_at_another_rate_is_found() {
        let cameras = ring(4);
        let ppm = [0.0, 0.0, 400.0, 0.0];
        let time = |camera: usize, number: f64| number - 0.4 * f64::from(camera == 3) - 1e-6 * ppm[camera] * number;
        let frames = record(&cameras, time, 1500, 1.0, 3);
        let runs: Vec<&[(u64, Sighted)]> = frames.chunks(100).step_by(2).collect();
        let clocks = camera_clocks((&cameras, &[0.0; 4]), &runs, &search()).unwrap();
        for (camera, clock) in clocks.iter().enumerate() {
            let [drift, sd] = clock.drift;
            let truth = 1e-6 * (ppm[camera] - 400.0 / 4.0);
            assert!((drift - truth).abs() < 4.0 * sd && sd < 6e-5, "{camera}: {clock:?}");
        }
        let lag = clocks[2].lag.frames - clocks[0].lag.frames;
        assert!((lag - 400e-6 * clocks[2].middle).abs() < 0.05, "{lag} {clocks:?}");
    }

    #[test]
    fn clocks_that_agree_and_people_who_stand_still_say_nothing() {
        let mut squares = vec![];
        for seed in 1..=8 {
            for lag in found(&[0.0; 4], 90, 1.0, seed) {
                assert!(!lag.is_off(), "{lag:?}");
                squares.push((lag.frames / lag.sd).powi(2));
            }
            let still = found(&[0.0, 0.0, 2.0, 0.0], 90, 0.0, seed);
            assert!(still.iter().all(|lag| !lag.is_off()));
        }
        // The errors are as large as they are said to be: a mean of 32 squares, of which 24 are independent; 3 sd of their mean are about 0.9.
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        assert!((0.3..2.0).contains(&mean), "{mean}");
    }

    /// One camera shows somebody else, who walks the same way in another phase.
    #[test]
    fn a_camera_that_shows_somebody_else_is_not_said_to_be_late() {
        let cameras = ring(4);
        for (seed, behind) in (1..).zip([8.0, 16.0, 24.0]) {
            let time = |camera: usize, number: f64| number - if camera == 2 { behind } else { 0.0 };
            let mut frames = record(&cameras, time, 90, 1.0, seed);
            for pixel in frames.iter_mut().flat_map(|(_, views)| &mut views[2]).flatten().map(|seen| &mut seen.pixel) {
                pixel[0] += 150.0;
            }
            let clocks = camera_clocks((&cameras, &[0.0; 4]), &[&frames], &search()).unwrap();
            assert!(clocks.iter().all(|clock| !clock.lag.is_off()), "{behind} frames behind: {clocks:?}");
        }
    }
}
