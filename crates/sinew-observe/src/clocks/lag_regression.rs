//! The linear model of [`crate::clocks::lag_estimate`]: what keypoints in several cameras say of lags and drifts.
//!
//! A *sight* is a keypoint in a frame with what all cameras show of it. Its place in space and, for each of its cameras, an offset that lasts four seconds (`BLOCK_S`) and changes evenly within them are nuisance: all are eliminated (Schur complements), so that only what swings within them counts. Offsets change evenly where somebody walks past a camera that is not quite where its calibration says.
//!
//! Velocities have errors, whose squares would count as motion, where there is none: the information about lags and drifts is made of products of a velocity from odd frames and one from even ones, whose errors are apart (instrumental variables).
//! A point whose two velocities are far apart has been taken for something else near by, and does not count: velocities that are too large would weigh most.
//! Robust weights (Cauchy's, Holland & Welsch 1977) are iterated. Standard deviations come from the jackknife over keypoints, in one step: a detector errs for some frames, and in the same pose, as it did before, so that only keypoints are independent; and the few that move
//! most say most.

use crate::cameras::camera::Camera;
use crate::cameras::offsets::{self, CameraNoise, Sighted, point_from_views};
use crate::clocks::point_velocity::{reach, two_velocities, velocity};
use nalgebra::{DMatrix, DVector, Matrix2, Matrix2x3, Matrix3, Vector2, Vector3};
use sinew_core::estimators::median;
use std::collections::BTreeMap;

/// Numbers of a camera: lag, in frames, and drift, in frames over half of the span.
pub(crate) const OWN: usize = 2;
/// Seconds for which a keypoint's offset in a camera lasts.
const BLOCK_S: f64 = 4.0;
/// Numbers of an offset: where it is in the middle, and its change in half of that time, two each.
const OFFSET: usize = 4;
/// Distance of two velocities of a point, in medians of it, from which on one of them comes from something else.
const AGREEING: f64 = 3.0;
/// Variance of what nothing is known of.
const NOTHING_KNOWN: f64 = 1e6;
/// Times that weights are computed.
const WEIGHTINGS: usize = 4;
/// Residual, in standard deviations, at which a weight is a half.
const SOFT: f64 = 2.0;

/// How lags are looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LagSearch {
    /// Frames a second.
    pub fps: f64,
    /// Which keypoints count, and how the scatter of the cameras is estimated.
    pub offsets: offsets::Config,
    /// Whether clocks may drift.
    pub drifts: bool,
}

/// A keypoint in a frame, seen by several cameras.
pub(crate) struct Sight {
    /// Keypoint, and part of the recording in which its offsets last.
    block: (usize, u64),
    /// Time within that part, −1 at its start and 1 at its end.
    within: f64,
    pub(crate) views: Vec<SightView>,
}

pub(crate) struct SightView {
    pub(crate) camera: usize,
    residual: Vector2<f64>,
    point: Matrix2x3<f64>,
    /// Derivative by the camera's numbers, with velocities from all near frames, from odd ones and from even ones.
    own: [Matrix2<f64>; 3],
}

/// The time in which drifts are measured: s = (f − middle) / half.
#[derive(Clone, Copy)]
pub(crate) struct Span {
    pub(crate) middle: f64,
    pub(crate) half: f64,
}

impl Span {
    pub(crate) fn over(runs: &[&[(u64, Sighted)]]) -> Self {
        let numbers = || runs.iter().flat_map(|run| run.iter()).map(|(number, _)| *number as f64);
        let (first, last) = (numbers().fold(f64::INFINITY, f64::min), numbers().fold(0.0, f64::max));
        Self { middle: 0.5 * (first + last), half: (0.5 * (last - first)).max(1.0) }
    }

    pub(crate) fn at(&self, number: u64) -> f64 {
        (number as f64 - self.middle) / self.half
    }
}

/// What the frames of a run show, keypoint by keypoint.
pub(crate) fn sights_of(
    cameras: &[Camera],
    noise: &[CameraNoise],
    frames: &[(u64, Sighted)],
    span: Span,
    search: &LagSearch,
) -> Vec<Sight> {
    let keypoints = frames.iter().flat_map(|(_, views)| views).map(Vec::len).max().unwrap_or(0);
    let numbers: Vec<u64> = frames.iter().map(|(number, _)| *number).collect();
    let length = (BLOCK_S * search.fps).round().max(1.0) as u64;
    // Odd and even frames on both sides.
    let reach = reach(search.fps).max(2);
    let mut sights = vec![];
    for keypoint in 0..keypoints {
        let found: Vec<Option<([f64; 3], Vec<usize>)>> = frames
            .iter()
            .map(|(_, views)| {
                let (refined, used) =
                    point_from_views(cameras, noise, views, keypoint, search.offsets.least_confidence)?;
                Some((refined.point, used))
            })
            .collect();
        let points: Vec<Option<[f64; 3]>> = found.iter().map(|found| found.as_ref().map(|(point, _)| *point)).collect();
        let halves: Vec<_> = (0..points.len()).map(|at| two_velocities(&points, &numbers, at, reach)).collect();
        let mut apart: Vec<f64> = halves.iter().flatten().map(|[odd, even]| (odd - even).norm()).collect();
        let most = AGREEING * if apart.is_empty() { 0.0 } else { median(&mut apart) };
        for (at, (found, halves)) in found.iter().zip(&halves).enumerate() {
            let (Some((point, used)), Some(velocity), Some([odd, even])) =
                (found, velocity(&points, &numbers, at, reach), *halves)
            else {
                continue;
            };
            if (odd - even).norm() > most {
                continue;
            }
            let views: Vec<SightView> = used
                .iter()
                .filter_map(|&camera| {
                    let pixel = frames[at].1.get(camera)?.get(keypoint).copied().flatten()?.pixel;
                    let known = (&cameras[camera], &noise[camera]);
                    view(known, camera, pixel, *point, [velocity, odd, even], span.at(frames[at].0))
                })
                .collect();
            if views.len() > 1 {
                let (part, frame) = (frames[at].0 / length, frames[at].0 % length);
                sights.push(Sight { block: (keypoint, part), within: 2.0 * frame as f64 / length as f64 - 1.0, views });
            }
        }
    }
    sights
}

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
    let own = velocities.map(|velocity| {
        let flow = by_point * velocity;
        Matrix2::new(-flow[0], -time * flow[0], -flow[1], -time * flow[1])
    });
    Some(SightView { camera, residual, point: by_point, own })
}

/// Normal equations of the sights of a keypoint while its offsets last: of the cameras' numbers, of their offsets, and between them.
struct Block {
    numbers: DMatrix<f64>,
    between: DMatrix<f64>,
    offsets: DMatrix<f64>,
    score_of_numbers: DVector<f64>,
    score_of_offsets: DVector<f64>,
}

/// Standard deviations of priors about 0.
pub(crate) struct PriorSds {
    /// Lag and drift of a camera, frames.
    pub(crate) own: [f64; OWN],
    /// Offset of a keypoint, and its change in half of the time that it lasts, pixels.
    pub(crate) offset_px: f64,
}

/// What sights say.
pub(crate) struct Regression {
    /// What is left of the numbers of all cameras.
    pub(crate) rest: DVector<f64>,
    pub(crate) covariance: DMatrix<f64>,
    /// Mean loss of a view, in squared standard deviations.
    pub(crate) loss: f64,
}

/// What is left of the numbers of all cameras beyond `total`; `None` where velocities have nothing in common but errors.
///
pub(crate) fn regression(
    noise: &[CameraNoise],
    sights: &[Sight],
    total: &DVector<f64>,
    prior: &PriorSds,
) -> Option<Regression> {
    let size = total.len();
    let sigma: Vec<f64> = noise.iter().map(|n| if n.sigma_px.is_finite() { n.sigma_px } else { 1.0 }).collect();
    let prior_of_offsets = prior.offset_px.powi(-2);
    let prior = DMatrix::from_diagonal(&DVector::from_fn(size, |i, _| prior.own[i % OWN].powi(-2)));
    let blocks: Vec<&[Sight]> = sights.chunk_by(|a, b| a.block == b.block).collect();
    let pixels = OFFSET * noise.len();
    let mut offsets = vec![DVector::zeros(pixels); blocks.len()];
    let mut solution = DVector::zeros(size);
    let mut covariance = DMatrix::zeros(size, size);
    let mut loss = 0.0;
    for _ in 0..WEIGHTINGS {
        let mut sums = Sums::default();
        let summed: Vec<Block> = (blocks.iter().zip(&offsets))
            .map(|(sights, offsets)| summed(sights, &sigma, &solution, offsets, &mut sums))
            .collect();
        // The derivative of a weighted residual is less than its weight, on the whole by this share (Huber 1981, section 7.6).
        let share = sums.derivatives / sums.weights.max(f64::MIN_POSITIVE);
        loss = sums.loss / sums.views.max(1.0);
        let mut information = prior.clone();
        let mut by_keypoint: BTreeMap<usize, (DMatrix<f64>, DVector<f64>)> = BTreeMap::new();
        let mut score = -&prior * (&solution + total);
        let mut eliminated = vec![];
        for ((sights, block), offsets) in blocks.iter().zip(&summed).zip(&offsets) {
            let precise = block.offsets.scale(share) + DMatrix::identity(pixels, pixels).scale(prior_of_offsets);
            let inverse = precise.cholesky()?.inverse();
            let score_of_offsets = &block.score_of_offsets - offsets.scale(prior_of_offsets);
            let between = block.between.scale(share);
            let through = &between * &inverse;
            let score_left = &block.score_of_numbers - &through * &score_of_offsets;
            let own = block.numbers.scale(share) - &through * between.transpose();
            score += &score_left;
            information += &own;
            if let Some(sight) = sights.first() {
                let nothing = || (DMatrix::zeros(size, size), DVector::zeros(size));
                let sums_of_one = by_keypoint.entry(sight.block.0).or_insert_with(nothing);
                *sums_of_one = (&sums_of_one.0 + own, &sums_of_one.1 + score_left);
            }
            eliminated.push((inverse, between, score_of_offsets));
        }
        let inverse = information.clone().cholesky()?.inverse();
        let step = &inverse * score;
        for ((inverse, between, score), offsets) in eliminated.iter().zip(&mut offsets) {
            *offsets += inverse * (score - between.transpose() * &step);
        }
        solution += step;
        covariance = &inverse * &prior * &inverse + jackknife(&information, &by_keypoint);
    }
    Some(Regression { rest: solution, covariance, loss })
}

/// Covariance of the numbers by leaving out one keypoint after the other, a Newton step each (Miller 1974).
fn jackknife(information: &DMatrix<f64>, by_keypoint: &BTreeMap<usize, (DMatrix<f64>, DVector<f64>)>) -> DMatrix<f64> {
    let count = by_keypoint.len() as f64;
    let mut sum = DMatrix::zeros(information.nrows(), information.nrows());
    for (own, score) in by_keypoint.values() {
        let Some(without) = (information - own).cholesky() else {
            // A keypoint says it all, and nothing how far it errs.
            return DMatrix::identity(information.nrows(), information.nrows()).scale(NOTHING_KNOWN);
        };
        let moved = without.solve(score);
        sum += &moved * moved.transpose();
    }
    sum * ((count - 1.0) / count.max(1.0))
}

/// Sums over views.
#[derive(Default)]
struct Sums {
    weights: f64,
    /// Of weighted residuals.
    derivatives: f64,
    loss: f64,
    views: f64,
}

/// Sums over the sights of a block; what is over views goes to `sums`.
fn summed(sights: &[Sight], sigma: &[f64], solution: &DVector<f64>, offsets: &DVector<f64>, sums: &mut Sums) -> Block {
    let (numbers, pixels) = (solution.len(), offsets.len());
    let mut block = Block {
        numbers: DMatrix::zeros(numbers, numbers),
        between: DMatrix::zeros(numbers, pixels),
        offsets: DMatrix::zeros(pixels, pixels),
        score_of_numbers: DVector::zeros(numbers),
        score_of_offsets: DVector::zeros(pixels),
    };
    let two = |of: &DVector<f64>, at: usize| Vector2::new(of[at], of[at + 1]);
    for sight in sights {
        let shape = [1.0, sight.within];
        let offset = |camera: usize| two(offsets, OFFSET * camera) + sight.within * two(offsets, OFFSET * camera + 2);
        let left = |v: &SightView| v.residual - v.own[0] * two(solution, OWN * v.camera) - offset(v.camera);
        let left: Vec<Vector2<f64>> = sight.views.iter().map(left).collect();
        let plain: Vec<f64> = sight.views.iter().map(|v| sigma[v.camera].powi(-2)).collect();
        let Some((step, _)) = point_step(sight, &left, &plain) else { continue };
        let weights: Vec<f64> = (sight.views.iter().zip(&left).zip(&plain))
            .map(|((v, left), plain)| plain / (1.0 + plain * (left - v.point * step).norm_squared() / (SOFT * SOFT)))
            .collect();
        let Some((step, inverse)) = point_step(sight, &left, &weights) else { continue };
        for ((a, left), weight) in sight.views.iter().zip(&left).zip(&weights) {
            let left = left - a.point * step;
            sums.weights += weight;
            sums.derivatives += weight - weight.powi(2) * left.norm_squared() / (SOFT * SOFT);
            sums.loss += SOFT * SOFT * (sigma[a.camera].powi(-2) * left.norm_squared() / (SOFT * SOFT)).ln_1p();
            sums.views += 1.0;
            for (part, by) in shape.into_iter().enumerate() {
                add_to(&mut block.score_of_offsets, OFFSET * a.camera + 2 * part, *weight * by * left);
            }
            add_to(&mut block.score_of_numbers, OWN * a.camera, *weight * a.own[0].transpose() * left);
            for (b, other) in sight.views.iter().zip(&weights) {
                let mut weighted = -*weight * *other * (a.point * inverse * b.point.transpose());
                if a.camera == b.camera {
                    weighted += *weight * Matrix2::identity();
                }
                let ([whole, odd, even], at) = (a.own, (OWN * a.camera, OWN * b.camera));
                let crossed = odd.transpose() * weighted * b.own[2] + even.transpose() * weighted * b.own[1];
                let mut place = block.numbers.fixed_view_mut::<OWN, OWN>(at.0, at.1);
                place += 0.5 * crossed;
                for (part, by) in shape.into_iter().enumerate() {
                    let column = OFFSET * b.camera + 2 * part;
                    let mut place = block.between.fixed_view_mut::<OWN, 2>(at.0, column);
                    place += by * whole.transpose() * weighted;
                    for (other, factor) in shape.into_iter().enumerate() {
                        let row = OFFSET * a.camera + 2 * other;
                        let mut place = block.offsets.fixed_view_mut::<2, 2>(row, column);
                        place += factor * by * weighted;
                    }
                }
            }
        }
    }
    block
}

fn add_to(vector: &mut DVector<f64>, at: usize, pair: Vector2<f64>) {
    let mut place = vector.fixed_rows_mut::<2>(at);
    place += pair;
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
