//! Marginals of points and degrees of freedom from the draws of a frame.
//!
//! Quantiles are those of the weighted draws: the least value at which the cumulated weight reaches p.

use crate::estimate::{PointMarginal, StateMarginal};
use rayon::prelude::*;
use sinew_body::{KinematicTree, Plan, point_positions_block};
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_tracking::posterior::Posterior;

/// Reusable buffers for one body.
pub(super) struct Marginals {
    plan: Plan,
    isa: Isa,
    /// Positions of all points in each block of draws.
    positions: Vec<Block>,
}

/// Mean, standard deviation, 5 % and 95 % quantile of a series; reorders it where the weights are equal.
fn describe(series: &mut [f64], weights: &[f64], equal: bool) -> [f64; 4] {
    let mean: f64 = series.iter().zip(weights).map(|(x, w)| w * x).sum();
    let variance: f64 = series.iter().zip(weights).map(|(x, w)| w * (x - mean) * (x - mean)).sum();
    let [low, high] = if equal {
        let n = series.len();
        let at = |p: f64| ((p * n as f64).ceil() as usize).clamp(1, n) - 1;
        let (low, high) = (at(0.05), at(0.95));
        let (left, &mut high_value, _) = series.select_nth_unstable_by(high, f64::total_cmp);
        let low_value = if low < high { *left.select_nth_unstable_by(low, f64::total_cmp).1 } else { high_value };
        [low_value, high_value]
    } else {
        let mut order: Vec<(f64, f64)> = series.iter().copied().zip(weights.iter().copied()).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        [0.05, 0.95].map(|p| {
            let mut sum = 0.0;
            let reached = order.iter().find(|(_, w)| {
                sum += w;
                sum >= p
            });
            reached.or(order.last()).map_or(mean, |(x, _)| *x)
        })
    };
    [mean, variance.max(0.0).sqrt(), low, high]
}

impl Marginals {
    pub(super) fn new(tree: &KinematicTree, isa: Isa) -> Self {
        Self { plan: Plan::with_all_points(tree), isa, positions: vec![] }
    }

    /// Marginals of all points of the body and of all degrees of freedom.
    pub(super) fn of(&mut self, posterior: &Posterior<'_>) -> (Vec<PointMarginal>, Vec<StateMarginal>) {
        let Self { plan, isa, positions } = self;
        let (d, coordinates) = (posterior.dim, 3 * plan.points());
        positions.resize(posterior.count().div_ceil(LANES) * coordinates, Block::ZERO);
        let blocks = posterior.states.par_chunks_exact(d).zip(positions.par_chunks_exact_mut(coordinates));
        let scratch = || vec![Block::ZERO; plan.workspace()];
        blocks.for_each_init(scratch, |ws, (states, out)| point_positions_block(plan, *isa, states, out, ws));

        let equal = !posterior.chain_stats.is_empty();
        let of_column = |series: &mut Vec<f64>, all: &[Block], width: usize, column: usize| {
            let blocks = all.iter().skip(column).step_by(width);
            series.clear();
            series.extend(blocks.flat_map(|block| block.0).take(posterior.count()));
            describe(series, posterior.weights, equal)
        };
        let described: Vec<[f64; 4]> = (0..coordinates + d)
            .into_par_iter()
            .map_init(Vec::new, |series, column| match column.checked_sub(coordinates) {
                None => of_column(series, positions, coordinates, column),
                Some(j) => of_column(series, posterior.states, d, j),
            })
            .collect();
        let (of_points, of_states) = described.split_at(coordinates);
        let point = |axes: &[[f64; 4]]| {
            let mut point = PointMarginal::default();
            for (axis, &[mean, sd, q05, q95]) in axes.iter().enumerate() {
                (point.mean[axis], point.sd[axis], point.q05[axis], point.q95[axis]) = (mean, sd, q05, q95);
            }
            point
        };
        let state = |&[mean, _, q05, q95]: &[f64; 4]| StateMarginal { mean, q05, q95 };
        (of_points.chunks_exact(3).map(point).collect(), of_states.iter().map(state).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_equal_and_of_given_weights_agree() {
        let mut series: Vec<f64> = (0..100).map(|i| f64::from(i * 37 % 100)).collect();
        let weights = vec![0.01; 100];
        let weighted = describe(&mut series.clone(), &weights, false);
        assert_eq!(describe(&mut series, &weights, true)[2..], [4.0, 94.0]);
        assert!((weighted[0] - 49.5).abs() < 1e-12);
        assert!((weighted[2] - 4.0).abs() <= 1.0 && (weighted[3] - 94.0).abs() <= 1.0);
    }

    #[test]
    fn one_heavy_draw_is_all_there_is() {
        let described = describe(&mut [1.0, 5.0, 2.0], &[0.0, 1.0, 0.0], false);
        assert_eq!(described, [5.0, 0.0, 5.0, 5.0]);
    }
}
