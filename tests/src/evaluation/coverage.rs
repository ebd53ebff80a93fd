//! Share of true coordinates inside intervals, and its standard error.
//!
//! The intervals are the 90 % intervals that a run writes; the standard error is for frames that depend on each other.

use sinew::body::KinematicTree;
use sinew::core::lanes::Block;
use sinew::core::random::Stage;
use sinew_body::points::Trajectories;
use sinew_results::estimate::FrameEstimate;

/// For each frame and named point the share of its three true coordinates inside the 90 % intervals; NaN for points that the truth or the body lacks.
#[must_use]
pub fn covered(
    tree: &KinematicTree,
    estimates: &[FrameEstimate],
    truth: &Trajectories,
    names: &[&str],
) -> Vec<Vec<f64>> {
    let columns: Vec<_> = names.iter().map(|name| Some((tree.point_index(name)?, truth.index(name)?))).collect();
    let share = |estimate: &FrameEstimate, (k, m): (usize, usize)| {
        let (marginal, point) = (&estimate.points[k], truth.frames[estimate.number as usize][m]);
        let inside = |a: &usize| (marginal.q05[*a]..=marginal.q95[*a]).contains(&point[*a]);
        (0..3).filter(inside).count() as f64 / 3.0
    };
    estimates.iter().map(|e| columns.iter().map(|c| c.map_or(f64::NAN, |c| share(e, c))).collect()).collect()
}

/// Mean half-width of the 90 % intervals of some points, metres: over frames, points and axes.
#[must_use]
pub fn half_width_m(tree: &KinematicTree, estimates: &[FrameEstimate], names: &[&str]) -> f64 {
    let points: Vec<usize> = names.iter().filter_map(|name| tree.point_index(name)).collect();
    let marginals = || estimates.iter().flat_map(|estimate| points.iter().map(|&point| &estimate.points[point]));
    let widths = || marginals().flat_map(|marginal| (0..3).map(|axis| marginal.q95[axis] - marginal.q05[axis]));
    0.5 * widths().sum::<f64>() / widths().count() as f64
}

/// Standard error of the mean of some time series, by a block bootstrap (Künsch 1989): as many blocks of `block` consecutive values as make up each series are drawn from it again, with replacement,
/// and the mean over all series is taken; `replicates` times.
#[must_use]
pub fn block_bootstrap(series: &[Vec<f64>], block: usize, replicates: usize, seed: u64) -> f64 {
    let mut uniform = uniforms(seed);
    spread_of(replicates, || mean_of_blocks(series, block, &mut uniform))
}

/// The same for the mean over groups of series, each with the same weight: as many groups are drawn again, with replacement, and blocks within each of their series.
#[must_use]
pub fn grouped_block_bootstrap(groups: &[Vec<Vec<f64>>], block: usize, replicates: usize, seed: u64) -> f64 {
    let mut uniform = uniforms(seed);
    spread_of(replicates, || {
        let mut drawn = || &groups[(uniform() * groups.len() as f64) as usize];
        let drawn: Vec<&Vec<Vec<f64>>> = (0..groups.len()).map(|_| drawn()).collect();
        drawn.iter().map(|series| mean_of_blocks(series, block, &mut uniform)).sum::<f64>() / groups.len() as f64
    })
}

/// Uniform numbers below 1.
fn uniforms(seed: u64) -> impl FnMut() -> f64 {
    let mut rng = Stage::new(seed, "block bootstrap").whole();
    let mut buffer = [Block::ZERO; 8];
    let mut left: Vec<f64> = vec![];
    move || {
        if left.is_empty() {
            rng.fill_uniform(&mut buffer);
            left.extend(buffer.iter().flat_map(|block| block.0));
        }
        left.pop().unwrap_or(0.5)
    }
}

/// Mean over all series of blocks drawn from each.
fn mean_of_blocks(series: &[Vec<f64>], block: usize, uniform: &mut impl FnMut() -> f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for values in series.iter().filter(|values| !values.is_empty()) {
        let size = block.clamp(1, values.len());
        for _ in 0..values.len().div_ceil(size) {
            let first = (uniform() * (values.len() - size + 1) as f64) as usize;
            sum += values[first..first + size].iter().sum::<f64>();
            count += size as f64;
        }
    }
    sum / count
}

/// Standard deviation of replicates.
fn spread_of(replicates: usize, mut replicate: impl FnMut() -> f64) -> f64 {
    let means: Vec<f64> = (0..replicates).map(|_| replicate()).collect();
    let centre = means.iter().sum::<f64>() / means.len() as f64;
    (means.iter().map(|m| (m - centre).powi(2)).sum::<f64>() / (means.len() as f64 - 1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bootstrap_finds_the_standard_error_of_independent_and_of_sticky_values() {
        let mut normal = vec![Block::ZERO; 100];
        Stage::new(3, "test").whole().fill_normal(sinew::core::lanes::Isa::baseline(), &mut normal);
        let values: Vec<f64> = normal.iter().flat_map(|block| block.0).collect();
        let se = block_bootstrap(std::slice::from_ref(&values), 1, 400, 1);
        assert!((se * 800.0_f64.sqrt() - 1.0).abs() < 0.15, "{se}");
        let sticky: Vec<f64> = values.iter().flat_map(|x| [*x; 10]).collect();
        let se = block_bootstrap(&[sticky], 40, 400, 1);
        assert!((se * 800.0_f64.sqrt() - 1.0).abs() < 0.25, "{se}");
    }
    /// Groups that differ by more than their series do: the standard error is that of the mean of the groups.
    #[test]
    fn groups_are_drawn_again_as_wholes() {
        let groups: Vec<Vec<Vec<f64>>> = (0..50).map(|k| vec![vec![f64::from(k % 2); 30]; 3]).collect();
        let se = grouped_block_bootstrap(&groups, 10, 2000, 1);
        assert!((se / (0.5 / 50.0_f64.sqrt()) - 1.0).abs() < 0.1, "{se}");
        let alike = vec![vec![vec![1.0; 30]; 3]; 5];
        assert_eq!(grouped_block_bootstrap(&alike, 10, 20, 1), 0.0);
    }
}
