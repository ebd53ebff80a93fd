//! Particles on a [`crate::grid`].
//!
//! They make a first-order walk over partition centres, and all that stand on the same ones are evaluated once.

use crate::grid::GridAxis;
use crate::particles::{Particles, move_by};
use crate::resample::Ancestors;
use sinew_core::density::LogDensity;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::{BlockRng, Stage};

/// Moves each state from its ancestor, with equal weights: by `drift`, by noise with the axes' widths as standard deviations, and, where `snapped`, to the nearest centre.
pub fn walk(
    particles: &mut Particles,
    ancestors: Ancestors,
    drift: &[f64],
    axes: &[GridAxis],
    snapped: bool,
    isa: Isa,
    stage: Stage,
) {
    let step = |from: &[Block], to: &mut [Block], rng: &mut BlockRng| {
        rng.fill_normal(isa, to);
        for (((z, x), drift), axis) in to.iter_mut().zip(from).zip(drift).zip(axes) {
            for (z, x) in z.0.iter_mut().zip(x.0) {
                let moved = x + drift + axis.width() * *z;
                *z = if snapped { axis.snap(moved) } else { moved };
            }
        }
    };
    move_by(particles, Some(ancestors), step, stage);
}

/// Evaluates the log likelihood of every state, of equal states once, for [`crate::particles::temper`]. Returns the number of evaluations.
pub fn evaluate_distinct<D: LogDensity + ?Sized>(particles: &mut Particles, likelihood: &D) -> usize {
    let (d, states) = (particles.dim(), &particles.states);
    let coordinates = |i: usize| (0..d).map(move |j| states[i / LANES * d + j].0[i % LANES].to_bits());
    let mut order: Vec<usize> = (0..particles.count()).collect();
    order.sort_by(|&a, &b| coordinates(a).cmp(coordinates(b)));
    let groups: Vec<&[usize]> = order.chunk_by(|&a, &b| coordinates(a).eq(coordinates(b))).collect();
    let firsts: Vec<usize> = groups.iter().map(|group| group[0]).collect();
    let found = particles.population().gather(&firsts).log_densities(likelihood);
    for (group, value) in groups.iter().zip(found) {
        group.iter().for_each(|&i| particles.values[i / LANES].0[i % LANES] = value);
    }
    groups.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::evaluate;
    use sinew_core::toy::Quadratic;

    fn axes() -> Vec<GridAxis> {
        vec![GridAxis::new(-2.0, 2.0, 0.5, false).expect("valid"), GridAxis::new(-3.0, 3.0, 0.7, true).expect("valid")]
    }

    fn walked(snapped: bool, drift: &[f64]) -> Particles {
        let mut particles = Particles::new(&[0.25, 2.8], 203).expect("not empty");
        walk(&mut particles, vec![7; 203], drift, &axes(), snapped, Isa::best(), Stage::new(1, "walk"));
        particles
    }

    #[test]
    fn snapped_states_stand_on_centres() {
        let (free, snapped) = (walked(false, &[0.1, 0.2]), walked(true, &[0.1, 0.2]));
        for i in 0..203 {
            for (j, axis) in axes().iter().enumerate() {
                assert_eq!(snapped.state(i)[j], axis.snap(free.state(i)[j]));
            }
        }
        assert!((0..203).any(|i| free.state(i)[1] > 3.0), "some go round");
        let still = walked(false, &[0.0, 0.0]);
        assert!((0..203).all(|i| (free.state(i)[0] - still.state(i)[0] - 0.1).abs() < 1e-12));
    }

    #[test]
    fn equal_states_share_an_evaluation() {
        let target = Quadratic { centre: vec![0.1, 0.2], precision: vec![1.0, 3.0] };
        for (snapped, fewer) in [(true, true), (false, false)] {
            let mut shared = walked(snapped, &[0.0, 0.0]);
            let mut each = shared.clone();
            let count = evaluate_distinct(&mut shared, &target);
            evaluate(&mut each, &target);
            assert_eq!(shared.values(), each.values());
            let different: std::collections::BTreeSet<Vec<u64>> =
                (0..203).map(|i| shared.state(i).iter().map(|x| x.to_bits()).collect()).collect();
            assert_eq!(count, different.len());
            assert_eq!(count < 203, fewer);
        }
    }
}
