//! Strategies of proptest for targets, weights and kinematic trees (feature `proptest`).
//!
//! What is random here is the problem, not the sampler's draws: pass a seed from the strategy, or a fixed one, to the test that you call. With many cases the rates of false alarms add up: 256 cases at 10⁻⁶ are 3 · 10⁻⁴.

use crate::targets::{Banana, GaussianTarget, HalfLine, MixtureTarget, Truncated};
use proptest::collection::vec;
use proptest::prelude::*;
use std::ops::RangeInclusive;

/// Gaussians with any mean in ±3, standard deviations from about 0.1 to 10, and correlations up to strong.
pub fn gaussians(dim: RangeInclusive<usize>) -> impl Strategy<Value = GaussianTarget> {
    dim.prop_flat_map(|d| (vec(-3.0..3.0, d), vec(-2.0..2.0_f64, d), vec(-1.0..1.0_f64, d * d))).prop_map(
        |(mean, log_scale, entries)| {
            let d = mean.len();
            let row = |i: usize| {
                let scale = log_scale[i].exp();
                (0..=i).map(|j| if i == j { scale } else { scale * entries[i * d + j] }).collect()
            };
            GaussianTarget::new(mean, (0..d).map(row).collect())
        },
    )
}

/// Mixtures of two or three Gaussians whose modes may be far apart or on top of each other.
pub fn mixtures(dim: RangeInclusive<usize>) -> impl Strategy<Value = MixtureTarget> {
    (dim, 2..=3_usize)
        .prop_flat_map(|(d, k)| (vec(0.1..1.0, k), vec(gaussians(d..=d), k)))
        .prop_map(|(weights, components)| MixtureTarget::new(weights, components))
}

/// Bananas from nearly straight to strongly bent.
pub fn bananas() -> impl Strategy<Value = Banana> {
    (0.3..3.0, -1.0..1.0).prop_map(|(sd, bend)| Banana { sd, bend })
}

/// Exponential coordinates with rates over two decades.
pub fn half_lines(dim: RangeInclusive<usize>) -> impl Strategy<Value = HalfLine> {
    vec(-2.3..2.3_f64, dim).prop_map(|log_rate| HalfLine { rate: log_rate.iter().map(|r| r.exp()).collect() })
}

/// Gaussians with a cliff to −∞ that leaves between a sixth and nearly all of them.
pub fn cliffs(dim: RangeInclusive<usize>) -> impl Strategy<Value = Truncated> {
    truncated(dim, f64::NEG_INFINITY)
}

/// The same with a region where the density is NaN.
pub fn nan_regions(dim: RangeInclusive<usize>) -> impl Strategy<Value = Truncated> {
    truncated(dim, f64::NAN)
}

fn truncated(dim: RangeInclusive<usize>, beyond: f64) -> impl Strategy<Value = Truncated> {
    (gaussians(dim), -1.0..3.0).prop_map(move |(whole, at)| {
        let edge = whole.mean()[0] + at * whole.covariance(0, 0).sqrt();
        Truncated { whole, edge, beyond }
    })
}

/// Normalised weights with all that breaks resampling: zeros, denormals, one that is 1 − 10⁻¹⁶, equal ones, and ordinary ones.
pub fn weights(count: RangeInclusive<usize>) -> impl Strategy<Value = Vec<f64>> {
    let entry = prop_oneof![
        4 => 0.0..1.0_f64,
        1 => Just(0.0),
        1 => Just(f64::from_bits(1)),
        1 => Just(1e-300),
        1 => Just(1e-16),
    ];
    let ordinary = vec(entry, count.clone()).prop_map(normalised);
    let one_for_all = (count.clone(), any::<prop::sample::Index>()).prop_map(|(n, at)| {
        let rest = if n > 1 { 1e-16 / (n - 1) as f64 } else { 0.0 };
        let mut weights = vec![rest; n];
        weights[at.index(n)] = if n > 1 { 1.0 - 1e-16 } else { 1.0 };
        weights
    });
    let equal = count.prop_map(|n| vec![1.0 / n as f64; n]);
    prop_oneof![4 => ordinary, 1 => one_for_all, 1 => equal]
}

/// Weights that sum to 1; the first takes all where nothing else would.
fn normalised(mut weights: Vec<f64>) -> Vec<f64> {
    let sum: f64 = weights.iter().sum();
    // A sum that is itself denormal cannot be divided by without losing all digits.
    if sum < 1e-200 {
        weights.fill(0.0);
        weights[0] = 1.0;
        return weights;
    }
    weights.iter().map(|w| w / sum).collect()
}

/// A kinematic tree as plain numbers: what a body is before any library makes something of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    /// Parent of each link, always before it; `None` for the root alone.
    pub parents: Vec<Option<usize>>,
    /// Origin of each link in its parent's frame, metres.
    pub offsets: Vec<[f64; 3]>,
    /// Unit axes of each link's rotations, in order; between none and three.
    pub axes: Vec<Vec<[f64; 3]>>,
}

/// Trees of `links` links: chains, stars and all between, with offsets up to half a metre, some zero.
pub fn trees(links: RangeInclusive<usize>) -> impl Strategy<Value = Tree> {
    let offset = prop_oneof![5 => [-0.5..0.5_f64, -0.5..0.5, -0.5..0.5], 1 => Just([0.0; 3])];
    let link = (any::<prop::sample::Index>(), offset, vec(unit_vectors(), 0..=3));
    vec(link, links).prop_map(|links| {
        let parents = links.iter().enumerate().map(|(i, (at, ..))| (i > 0).then(|| at.index(i))).collect();
        let (offsets, axes) = links.into_iter().map(|(_, offset, axes)| (offset, axes)).unzip();
        Tree { parents, offsets, axes }
    })
}

/// Directions, the coordinate axes among them.
fn unit_vectors() -> impl Strategy<Value = [f64; 3]> {
    let any_way = (-1.0..1.0_f64, 0.0..std::f64::consts::TAU).prop_map(|(z, turn): (f64, f64)| {
        let r = (1.0 - z * z).sqrt();
        [r * turn.cos(), r * turn.sin(), z]
    });
    prop_oneof![2 => any_way, 1 => prop::sample::select(vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])]
}
