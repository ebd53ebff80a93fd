//! Where a truth falls among the draws of its posterior.
//!
//! The *rank* of a true number among L draws is how many of them are smaller, 0 to L. Where the draws come from the posterior that the truth came from, truth and draws are exchangeable and every
//! rank is equally probable (Talts et al. 2018, theorem 1). From the ranks follow
//!
//! - the coverage of central intervals: that of level p leaves out `(1 − p)/2 · (L + 1)` ranks at each end, which is exact where this is a whole number ([`is_covered`]; L = 199 serves all levels of [`LEVELS`]);
//! - histograms ([`histogram`]), whose [`chi_square`] has its distribution only where the ranks are independent;
//! - the [`Shape`]: draws that are too wide make ranks crowd in the middle, draws that are too narrow at the ends.
//!
//! Draws that depend on each other, as a chain's do, leave each rank's distribution nearly uniform as long as they are many compared with their autocorrelation time.

use sinew::body::{KinematicTree, Plan, point_positions};
use sinew::core::lanes::Isa;
use sinew_body::points::Trajectories;
use sinew_results::estimate::FrameEstimate;
use statrs::distribution::{ChiSquared, ContinuousCDF as _};

/// Levels of central intervals that are looked at.
pub const LEVELS: [f64; 4] = [0.5, 0.8, 0.9, 0.95];

/// Number of draws for which intervals of all [`LEVELS`] are exact: 200 ranks.
pub const DRAWS: usize = 199;

/// Ranks of the true coordinates of named points among the draws of each estimate: frame by frame, point by point, axis by axis. Points that the truth or the body lacks are left out.
#[must_use]
pub fn at_points(
    tree: &KinematicTree,
    estimates: &[FrameEstimate],
    truth: &Trajectories,
    names: &[&str],
) -> Vec<Vec<[u32; 3]>> {
    let columns: Vec<(usize, usize)> =
        names.iter().filter_map(|name| Some((tree.point_index(name)?, truth.index(name)?))).collect();
    let plan = Plan::new(tree, &columns.iter().map(|(k, _)| *k).collect::<Vec<_>>());
    let mut at = vec![0.0; 3 * plan.points()];
    let frame_ranks = |estimate: &FrameEstimate| {
        let mut ranks = vec![[0; 3]; columns.len()];
        for (i, state) in estimate.draws.states.chunks_exact(tree.dof()).enumerate() {
            point_positions(&plan, Isa::baseline(), state, &mut at);
            let shape = estimate.draws.shape.get(3 * tree.points().len() * i..).unwrap_or_default();
            for (x, k) in at.chunks_exact_mut(3).zip(columns.iter().map(|(k, _)| *k)) {
                x.iter_mut().zip(shape.iter().skip(3 * k)).for_each(|(x, by)| *x += by);
            }
            let size = estimate.draws.size.get(i).copied().unwrap_or(1.0);
            for ((rank, drawn), (_, m)) in ranks.iter_mut().zip(at.chunks_exact(3)).zip(&columns) {
                for a in 0..3 {
                    // A body of another size has its root at the same place.
                    let drawn = state[a] + size * (drawn[a] - state[a]);
                    rank[a] += u32::from(drawn < truth.frames[estimate.number as usize][*m][a]);
                }
            }
        }
        ranks
    };
    estimates.iter().map(frame_ranks).collect()
}

/// Whether the central interval of a level, 0 to 1, holds a truth of that rank among `draws` draws.
#[must_use]
pub fn is_covered(rank: u32, draws: usize, level: f64) -> bool {
    let beyond = (0.5 * (1.0 - level) * (draws as f64 + 1.0)).round() as u32;
    (beyond..=(draws as u32).saturating_sub(beyond)).contains(&rank)
}

/// Share of some ranks that is covered; NaN of none.
#[must_use]
pub fn coverage(ranks: &[u32], draws: usize, level: f64) -> f64 {
    ranks.iter().filter(|rank| is_covered(**rank, draws, level)).count() as f64 / ranks.len() as f64
}

/// Numbers of ranks in bins of equal width; exact where `bins` divides the number of ranks, `draws + 1`.
#[must_use]
pub fn histogram(ranks: &[u32], draws: usize, bins: usize) -> Vec<u64> {
    let mut counts = vec![0; bins];
    for rank in ranks {
        let bin = *rank as usize * bins / (draws + 1);
        if let Some(count) = counts.get_mut(bin) {
            *count += 1;
        }
    }
    counts
}

/// Pearson's statistic of a histogram against bins that are equally probable. For independent counts it is about χ² with one degree of freedom less than bins.
#[must_use]
pub fn chi_square(histogram: &[u64]) -> f64 {
    let expected = histogram.iter().sum::<u64>() as f64 / histogram.len() as f64;
    histogram.iter().map(|count| (*count as f64 - expected).powi(2) / expected).sum()
}

/// Probability of a larger χ² of the ranks in `bins` bins, were they uniform and independent.
#[must_use]
pub fn uniformity(ranks: &[u32], draws: usize, bins: usize) -> f64 {
    let chi_square = chi_square(&histogram(ranks, draws, bins));
    ChiSquared::new(bins as f64 - 1.0).map_or(f64::NAN, |law| law.sf(chi_square))
}

/// Whether several coordinates are uniform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AllUniform {
    /// Number of coordinates.
    pub coordinates: usize,
    /// Probability of the largest χ² among the coordinates, times their number (Bonferroni), at most 1.
    pub p: f64,
    /// Coordinates whose own probability is below 0.05; one in twenty is expected.
    pub below: usize,
}

/// Judges coordinates by their probabilities ([`uniformity`]); none without any.
#[must_use]
pub fn all_uniform(probabilities: &[f64]) -> Option<AllUniform> {
    let coordinates = Some(probabilities.len()).filter(|n| *n > 0)?;
    let least = probabilities.iter().copied().fold(1.0, f64::min);
    let below = probabilities.iter().filter(|p| **p < 0.05).count();
    Some(AllUniform { coordinates, p: (least * coordinates as f64).min(1.0), below })
}

/// Mean distance of coverages from the levels that promise them.
#[must_use]
pub fn calibration_error(found: &[f64], promised: &[f64]) -> f64 {
    let pairs = found.iter().zip(promised);
    pairs.map(|(found, promised)| (found - promised).abs()).sum::<f64>() / found.len().min(promised.len()) as f64
}

/// What a histogram of ranks looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Mean rank as a fraction of the largest, less ½: 0 where calibrated, positive where the draws lie too low.
    pub bias: f64,
    /// Mean squared distance of the ranks from the middle over that of uniform ones: 1 where calibrated, less where the draws are too wide, more (at most 3) where they are too narrow.
    pub width: f64,
}

/// The shape of some ranks; NaN of none.
#[must_use]
pub fn shape(ranks: &[u32], draws: usize) -> Shape {
    let (n, last) = (ranks.len() as f64, draws as f64);
    let mean = ranks.iter().map(|rank| f64::from(*rank)).sum::<f64>() / n;
    let square = ranks.iter().map(|rank| (f64::from(*rank) - 0.5 * last).powi(2)).sum::<f64>() / n;
    Shape { bias: mean / last - 0.5, width: square / (last * (last + 2.0) / 12.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::body::Proportions;
    use sinew::body::standard::h32;
    use sinew_results::estimate::Draws;

    #[test]
    fn uniform_ranks_are_covered_as_promised() {
        let all: Vec<u32> = (0..=DRAWS as u32).collect();
        for level in LEVELS {
            assert_eq!(coverage(&all, DRAWS, level), level);
        }
        assert!(is_covered(0, DRAWS, 1.0) && is_covered(DRAWS as u32, DRAWS, 1.0));
        assert_eq!([9, 10, 189, 190].map(|rank| is_covered(rank, DRAWS, 0.9)), [false, true, true, false]);
        assert!(coverage(&[], DRAWS, 0.9).is_nan());
    }

    #[test]
    fn shapes_of_calibrated_narrow_and_shifted_draws() {
        let all: Vec<u32> = (0..=DRAWS as u32).collect();
        let Shape { bias, width } = shape(&all, DRAWS);
        assert!(bias.abs() < 1e-12 && (width - 1.0).abs() < 1e-12, "{bias} {width}");
        // Every truth is beyond all draws, at one end or the other: 3 L/(L + 2).
        let Shape { bias, width } = shape(&[0, 199, 0, 199], DRAWS);
        assert!(bias.abs() < 1e-12 && (width - 3.0 * 199.0 / 201.0).abs() < 1e-12, "{width}");
        assert_eq!(shape(&[199; 3], DRAWS).bias, 0.5);
    }

    #[test]
    fn crowded_ranks_are_not_uniform_and_many_coordinates_are_judged_together() {
        let all: Vec<u32> = (0..=DRAWS as u32).collect();
        assert!((uniformity(&all, DRAWS, 20) - 1.0).abs() < 1e-12);
        // χ² = 3.6 of two bins: p of 1 degree of freedom.
        assert!((uniformity(&[0, 0, 0, 0, 0, 0, 0, 0, 1, 1], 1, 2) - 0.057_779_6).abs() < 1e-6);
        let found = all_uniform(&[0.2, 0.01, 0.04, 0.9]).unwrap();
        assert_eq!(found, AllUniform { coordinates: 4, p: 0.04, below: 2 });
        assert_eq!(all_uniform(&[0.7, 0.8]).map(|found| found.p), Some(1.0));
        assert_eq!(all_uniform(&[]), None);
    }

    #[test]
    fn histograms_count_and_their_statistic_is_that_of_pearson() {
        let all: Vec<u32> = (0..=DRAWS as u32).collect();
        assert_eq!(histogram(&all, DRAWS, 20), [10; 20]);
        assert_eq!(histogram(&[0, 9, 10, 199], DRAWS, 20)[..2], [2, 1]);
        assert_eq!(chi_square(&[10; 20]), 0.0);
        // (8 − 5)²/5 + (2 − 5)²/5
        assert!((chi_square(&[8, 2]) - 3.6).abs() < 1e-12);
    }

    #[test]
    fn the_calibration_error_is_a_mean_distance() {
        assert!((calibration_error(&[0.4, 0.9], &[0.5, 0.8]) - 0.1).abs() < 1e-15);
    }

    #[test]
    fn ranks_count_the_draws_below_and_know_their_sizes() {
        let tree = h32(&Proportions::default());
        let draw = |x: f64| {
            let mut state = vec![0.0; tree.dof()];
            state[0] = x;
            state
        };
        let states: Vec<f64> = [-1.0, 0.0, 1.0, 2.0].into_iter().flat_map(draw).collect();
        // The head is 0.73 m above the root of the default body.
        let truth = Trajectories { names: vec!["Head".into()], frames: vec![vec![[0.5, -1e-9, 0.8]]] };
        let rank = |size: Vec<f64>| {
            let estimate = FrameEstimate {
                draws: Draws { states: states.clone(), size, ..Draws::default() },
                ..FrameEstimate::default()
            };
            at_points(&tree, &[estimate], &truth, &["Head", "nothing"])
        };
        assert_eq!(rank(vec![]), [[[2, 0, 4]]]);
        assert_eq!(rank(vec![1.0, 2.0, 2.0, 1.0])[0][0][2], 2);
    }
}
