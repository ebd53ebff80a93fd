//! Marginals of points and degrees of freedom from the draws of a frame.
//!
//! Quantiles are taken of the weighted draws: the least value at which the cumulated weight reaches p. A body of unknown size before one camera has draws of all
//! sizes ([`UnknownSize`]); where the lengths of the body are known up to an error, its points move with them ([`Moved`]).
//!
//! With s⁽ⁱ⁾ the shift of the world that the cameras of draw i look like, and m⁽ⁱ⁾ the mean place of all points in it, the shift that all points share is the least-squares fit Λ s⁽ⁱ⁾ to m⁽ⁱ⁾ − m̄ over the draws. It is not s⁽ⁱ⁾ itself: lengths of the body and how it moves hold a person back where two cameras side by side leave the distance open.
//! The spread within the run is that of x⁽ⁱ⁾ − Λ s⁽ⁱ⁾. Of a coordinate that does not go with the others, which it would widen, nothing is taken off: no part exceeds the whole.

use crate::setup::unknown_size::UnknownSize;
use rayon::prelude::*;
use sinew_body::{KinematicTree, Plan, point_positions_block};
use sinew_core::estimators::mean;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_results::estimate::{PointMarginal, StateMarginal};
use sinew_tracking::moved::{Moved, add_row};
use sinew_tracking::posterior::Posterior;
use sinew_tracking::series::{describe, moments};
use std::sync::Arc;

/// Reusable buffers for one body.
pub(super) struct Marginals {
    plan: Plan,
    /// The keypoints where the detectors see them, if that is known apart from the points of the body.
    keypoints: Option<Arc<Plan>>,
    isa: Isa,
    size: Option<UnknownSize>,
    /// Positions of all points, then keypoints, in each block of draws.
    positions: Vec<Block>,
}

/// What is said of a frame's draws.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Described {
    /// All points of the body.
    pub points: Vec<PointMarginal>,
    /// The keypoints as the detectors see them.
    pub keypoints: Vec<PointMarginal>,
    /// All degrees of freedom.
    pub state: Vec<StateMarginal>,
}

impl Marginals {
    pub(super) fn new(tree: &KinematicTree, keypoints: Option<Arc<Plan>>, isa: Isa, size: Option<UnknownSize>) -> Self {
        Self { plan: Plan::with_all_points(tree), keypoints, isa, size, positions: vec![] }
    }

    /// Sizes of the draws, for a body that was not measured.
    pub(super) const fn size(&self) -> Option<&UnknownSize> {
        self.size.as_ref()
    }

    /// Moves some states, draw after draw, to where a body of their size stands, and gives these sizes; nothing for a body of known size.
    pub(super) fn size_draws(&mut self, states: &mut [f64], dim: usize) -> Vec<f64> {
        let Some(size) = &mut self.size else { return vec![] };
        size.prepare((states.len() / dim).div_ceil(LANES));
        let place = |(draw, state): (usize, &mut [f64])| {
            size.place_root(draw, state);
            size.factor(draw)
        };
        states.chunks_exact_mut(dim).enumerate().map(place).collect()
    }

    /// Positions of all points, then keypoints, in the draws of a posterior.
    fn positions(&mut self, posterior: &Posterior<'_>) {
        let Self { plan, keypoints, isa, positions, .. } = self;
        let (body, coordinates) =
            (3 * plan.points(), 3 * (plan.points() + keypoints.as_ref().map_or(0, |k| k.points())));
        positions.resize(posterior.count().div_ceil(LANES) * coordinates, Block::ZERO);
        let blocks = posterior.states.par_chunks_exact(posterior.dim).zip(positions.par_chunks_exact_mut(coordinates));
        let workspace = plan.workspace().max(keypoints.as_ref().map_or(0, |k| k.workspace()));
        let scratch = || vec![Block::ZERO; workspace];
        blocks.for_each_init(scratch, |ws, (states, out)| {
            let (points, detected) = out.split_at_mut(body);
            point_positions_block(plan, *isa, states, points, ws);
            if let Some(keypoints) = keypoints.as_deref() {
                point_positions_block(keypoints, *isa, states, detected, ws);
            }
        });
    }

    /// Marginals of all points of the body, keypoints and degrees of freedom; the draws move as `moved` says, if there is one, in their order.
    pub(super) fn of(&mut self, posterior: &Posterior<'_>, moved: Option<&Moved>) -> Described {
        self.positions(posterior);
        // By now the chains of the next step wait for a thread: they go first.
        rayon::yield_now();
        let Self { plan, keypoints, size, positions, .. } = self;
        let (d, body) = (posterior.dim, 3 * plan.points());
        let coordinates = body + 3 * keypoints.as_ref().map_or(0, |k| k.points());
        if let Some(size) = size {
            size.prepare(posterior.count().div_ceil(LANES));
        }
        let equal = posterior.weights.windows(2).all(|pair| pair[0] == pair[1]);
        let add_shape = |series: &mut Vec<f64>, column: usize| {
            if let Some(Moved { points, keypoints, .. }) = moved {
                add_row(series, column.checked_sub(body).map_or_else(|| points.row(column), |row| keypoints.row(row)));
            }
        };
        let draws_of = |series: &mut Vec<f64>, all: &[Block], width: usize, column: usize| {
            series.clear();
            all.chunks_exact(width).for_each(|block| series.extend_from_slice(&block[column].0));
            series.truncate(posterior.count());
            if width == coordinates {
                add_shape(series, column);
            }
            if let Some(size) = size.as_ref().filter(|_| width == coordinates || column < 3) {
                series.iter_mut().enumerate().for_each(|(draw, x)| *x = size.place(draw, column % 3, *x));
            }
        };
        let middle = |axis: usize| {
            let (mut sum, mut series) = (vec![0.0; posterior.count()], vec![]);
            for column in (axis..body).step_by(3) {
                draws_of(&mut series, positions, coordinates, column);
                sum.iter_mut().zip(&series).for_each(|(sum, x)| *sum += 3.0 * x / body as f64);
            }
            sum
        };
        let shared = moved.map(|moved| {
            let directions = independent(&moved.shifts, posterior.count());
            let along = |axis: usize| fitted(&middle(axis), &directions);
            (0..3).into_par_iter().map(along).collect::<Vec<_>>()
        });
        let within = |series: &[f64], axis: usize, sd: f64| {
            let shared = shared.as_ref()?;
            let own: Vec<f64> = series.iter().zip(&shared[axis]).map(|(x, shared)| x - shared).collect();
            Some(moments(&own, posterior.weights, equal)[1].min(sd))
        };
        let described_column = |series: &mut Vec<f64>, all: &[Block], width: usize, column: usize| {
            draws_of(series, all, width, column);
            let [mean, sd, q05, q95] = describe(series, posterior.weights, equal);
            let within = if width == coordinates { within(series, column % 3, sd) } else { None };
            [mean, sd, q05, q95, within.unwrap_or(sd)]
        };
        let described: Vec<[f64; 5]> = (0..coordinates + d)
            .into_par_iter()
            .map_init(Vec::new, |series, column| match column.checked_sub(coordinates) {
                None => described_column(series, positions, coordinates, column),
                Some(j) => described_column(series, posterior.states, d, j),
            })
            .collect();
        let (at_points, from_states) = described.split_at(coordinates);
        let (at_points, at_keypoints) = at_points.split_at(body);
        let point = |axes: &[[f64; 5]]| {
            let mut point = PointMarginal::default();
            for (axis, &[mean, sd, q05, q95, within]) in axes.iter().enumerate() {
                (point.mean[axis], point.sd[axis], point.q05[axis], point.q95[axis]) = (mean, sd, q05, q95);
                point.sd_within[axis] = within;
            }
            point
        };
        let state = |&[mean, _, q05, q95, _]: &[f64; 5]| StateMarginal { mean, q05, q95 };
        Described {
            points: at_points.chunks_exact(3).map(point).collect(),
            keypoints: at_keypoints.chunks_exact(3).map(point).collect(),
            state: from_states.iter().map(state).collect(),
        }
    }
}

/// Series without their mean that are orthogonal to each other and span the axes of the shifts, which repeat over `count` draws; axes that add nothing are left out.
fn independent(shifts: &[[f64; 3]], count: usize) -> Vec<Vec<f64>> {
    let mut found: Vec<Vec<f64>> = vec![];
    for axis in [0, 1, 2_usize] {
        let whole = centred((0..count).map(|draw| shifts[draw % shifts.len()][axis]).collect());
        let fit = fitted(&whole, &found);
        let rest: Vec<f64> = whole.iter().zip(fit).map(|(x, fit)| x - fit).collect();
        if dot(&rest, &rest) > LEAST_OWN * dot(&whole, &whole) {
            found.push(rest);
        }
    }
    found
}

/// Share of its square below which an axis adds nothing to the others.
const LEAST_OWN: f64 = 1e-12;

/// The least-squares fit to a series by some that are orthogonal to each other and have no mean.
fn fitted(series: &[f64], directions: &[Vec<f64>]) -> Vec<f64> {
    let mut found = vec![0.0; series.len()];
    for direction in directions {
        let by = dot(series, direction) / dot(direction, direction);
        found.iter_mut().zip(direction).for_each(|(sum, x)| *sum += by * x);
    }
    found
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn centred(mut series: Vec<f64>) -> Vec<f64> {
    let middle = mean(&series);
    series.iter_mut().for_each(|x| *x -= middle);
    series
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::random::Stage;
    use sinew_observe::Camera;
    use sinew_tracking::moved::Rows;

    /// One camera five metres in front of a body of unknown size.
    #[test]
    fn an_unknown_size_widens_the_intervals_along_the_ray_only() {
        let tree = sinew_body::standard::h32(&sinew_body::Proportions::default());
        let camera = Camera::look_at("C1", [1000.0; 2], 1000.0, [5.0, 0.0, 1.0], [0.0, 0.0, 1.0]).unwrap();
        let (draws, d) = (4096, tree.dof());
        let mut states = vec![Block::ZERO; draws / LANES * d];
        states.iter_mut().skip(2).step_by(d).for_each(|z| *z = Block([1.0; LANES]));
        let weights = vec![1.0 / draws as f64; draws];
        let posterior = Posterior { dim: d, states: &states, weights: &weights, effective: 1.0, chain_stats: &[] };
        let size = UnknownSize::with_sd(&camera, 0.05, 1);
        let mut marginals = Marginals::new(&tree, None, Isa::best(), Some(size));
        let Described { points, state, .. } = marginals.of(&posterior, None);
        let hip = points[tree.point_index("MidHip").unwrap()];
        assert!((hip.sd[0] - 0.25).abs() < 0.02 && hip.sd[1] < 1e-12 && hip.sd[2] < 0.01, "{hip:?}");
        assert!((hip.q95[0] - hip.q05[0] - 2.0 * 1.645 * 0.25).abs() < 0.04, "{hip:?}");
        assert!((state[0].q95 - state[0].q05 - (hip.q95[0] - hip.q05[0])).abs() < 0.01);

        // Every draw is seen at the same pixels.
        let mut kept: Vec<f64> =
            (0..8).flat_map(|i| states[i / LANES * d..][..d].iter().map(move |b| b.0[i % LANES])).collect();
        let sizes = marginals.size_draws(&mut kept, d);
        let plan = Plan::with_all_points(&tree);
        let nose = |state: &[f64], size: f64| {
            let mut positions = vec![0.0; 3 * plan.points()];
            sinew_body::point_positions(&plan, Isa::baseline(), state, &mut positions);
            let k = tree.point_index("Nose").unwrap();
            camera
                .project([0, 1, 2].map(|a: usize| state[a] + size * (positions[3 * k + a] - state[a])))
                .pixel()
                .unwrap()
        };
        let mut first = vec![0.0; d];
        first[2] = 1.0;
        let [u, v] = nose(&first, 1.0);
        for (state, size) in kept.chunks_exact(d).zip(sizes) {
            let [a, b] = nose(state, size);
            assert!((a - u).hypot(b - v) < 1e-9 && (size - 1.0).abs() > 1e-6);
        }
    }

    /// Two keypoints 1 cm from their joints, which one of two draws of the lengths moves 2 cm farther.
    #[test]
    fn keypoints_lie_where_detectors_see_them() {
        let tree = sinew_body::standard::h32(&sinew_body::Proportions::default());
        let (d, count, shown) = (tree.dof(), tree.points().len(), [3, 0]);
        let places = vec![[0.01, 0.0, 0.0]; count];
        let keypoints = Arc::new(Plan::new(&tree.with_points_moved(&places), &shown));
        let (states, weights) = (vec![Block::ZERO; d], vec![1.0 / LANES as f64; LANES]);
        let posterior = Posterior { dim: d, states: &states, weights: &weights, effective: 1.0, chain_stats: &[] };
        let mut moved = Moved {
            shifts: vec![[0.0; 3]; 2],
            states: Rows::new(&vec![0.0; 2 * d], 2),
            points: Rows::new(&vec![0.0; 6 * count], 2),
            keypoints: Rows::new(&[0.0; 12], 2),
        };
        // The second keypoint, along y, in the second draw.
        moved.keypoints.values[4].0[1] = 0.02;
        let mut marginals = Marginals::new(&tree, Some(keypoints), Isa::baseline(), None);
        let Described { points, keypoints, state } = marginals.of(&posterior, Some(&moved));
        assert_eq!((points.len(), keypoints.len(), state.len()), (count, 2, d));
        for (k, (keypoint, point)) in keypoints.iter().zip(shown).enumerate() {
            let along_y = if k == 1 { 0.01 } else { 0.0 };
            let from_joint = [0, 1, 2].map(|axis: usize| keypoint.mean[axis] - points[point].mean[axis]);
            let expected = [0.01, along_y, 0.0];
            assert!(from_joint.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{from_joint:?}");
            assert!((keypoint.sd[1] - along_y).abs() < 1e-12 && keypoint.sd[0] < 1e-12);
        }
    }

    /// A person who goes with the shifts of two cameras side by side only as far as the lengths of the body let them: x = A s + e, both Gaussian. The spread within the run is that of e, and never more than all.
    /// One point stays where it is, whatever the cameras say: of it nothing is taken off.
    #[test]
    fn the_spread_within_the_run_is_what_a_gaussian_leaves_without_its_shared_shift() {
        const DRAWS: usize = 4096;
        const SHIFT: [f64; 3] = [1.5, 0.4, 0.03];
        const GOES: [[f64; 3]; 3] = [[0.1, 0.05, 0.0], [0.0, 0.2, 0.0], [0.0, 0.0, 1.0]];
        const OWN: [f64; 3] = [0.05, 0.04, 0.01];
        let tree = sinew_body::standard::h32(&sinew_body::Proportions::default());
        let (d, count, still) = (tree.dof(), tree.points().len(), tree.point_index("LWrist").unwrap());
        let mut normal = vec![Block::ZERO; 6 * DRAWS / LANES];
        Stage::new(3, "Gaussian").whole().fill_normal(Isa::baseline(), &mut normal);
        let normal: Vec<[f64; 6]> = sinew_core::lanes::numbers(&normal).as_chunks::<6>().0.to_vec();
        let shifts: Vec<[f64; 3]> = normal.iter().map(|z| [0, 1, 2].map(|k: usize| SHIFT[k] * z[k])).collect();
        let shared = |draw: usize, axis: usize| (0..3).map(|k| GOES[axis][k] * shifts[draw][k]).sum::<f64>();
        let mut states = vec![Block::ZERO; DRAWS / LANES * d];
        let mut points = vec![0.0; 3 * count * DRAWS];
        for (draw, z) in normal.iter().enumerate() {
            for axis in 0..3 {
                states[draw / LANES * d + axis].0[draw % LANES] = shared(draw, axis) + OWN[axis] * z[3 + axis];
                points[(3 * still + axis) * DRAWS + draw] = -shared(draw, axis);
            }
        }
        let weights = vec![1.0 / DRAWS as f64; DRAWS];
        let posterior = Posterior { dim: d, states: &states, weights: &weights, effective: 1.0, chain_stats: &[] };
        let moved = Moved {
            shifts,
            states: Rows::new(&vec![0.0; d * DRAWS], DRAWS),
            points: Rows::new(&points, DRAWS),
            keypoints: Rows::new(&[], DRAWS),
        };
        let found = Marginals::new(&tree, None, Isa::baseline(), None).of(&posterior, Some(&moved)).points;
        // One point of `count` does not go with the others: they share (count − 1)/count of A s.
        let left = 1.0 / count as f64;
        for (index, point) in found.iter().enumerate() {
            for axis in 0..3 {
                let along = (0..3).map(|k| (GOES[axis][k] * SHIFT[k]).powi(2)).sum::<f64>();
                let goes = if index == still { 0.0 } else { 1.0 };
                let all = (along * goes + OWN[axis].powi(2)).sqrt();
                let within = if index == still { all } else { (along * left * left + OWN[axis].powi(2)).sqrt() };
                assert!((point.sd[axis] / all - 1.0).abs() < 0.04, "{axis}: {} for {all}", point.sd[axis]);
                let own = point.sd_within[axis];
                assert!((own / within - 1.0).abs() < 0.04 && own <= point.sd[axis], "{axis}: {own} for {within}");
            }
        }
    }

    /// A body that goes as far along x as the cameras say, and as far along y, where they say the same as along x and more: nothing is left within the run.
    #[test]
    fn axes_of_the_shared_shift_that_go_together_count_once() {
        let tree = sinew_body::standard::h32(&sinew_body::Proportions::default());
        let (d, count) = (tree.dof(), tree.points().len());
        let along = [1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0];
        let aside = [1.0, 1.0, -1.0, -1.0, 1.0, 1.0, -1.0, -1.0];
        let shifts: Vec<[f64; 3]> = (0..LANES).map(|draw| [along[draw], along[draw] + aside[draw], 0.0]).collect();
        let mut states = vec![Block::ZERO; d];
        for (draw, shift) in shifts.iter().enumerate() {
            (0..3).for_each(|axis| states[axis].0[draw] = shift[axis]);
        }
        let weights = vec![1.0 / LANES as f64; LANES];
        let posterior = Posterior { dim: d, states: &states, weights: &weights, effective: 1.0, chain_stats: &[] };
        let still = |rows: usize| Rows::new(&vec![0.0; rows * LANES], LANES);
        let moved = Moved { shifts, states: still(d), points: still(3 * count), keypoints: Rows::new(&[], LANES) };
        for point in Marginals::new(&tree, None, Isa::baseline(), None).of(&posterior, Some(&moved)).points {
            let expected = [1.0, 2.0_f64.sqrt(), 0.0];
            assert!((0..3).all(|axis| (point.sd[axis] - expected[axis]).abs() < 1e-9), "{point:?}");
            assert!(point.sd_within.iter().all(|sd| *sd < 1e-6), "{point:?}");
        }
    }
}
