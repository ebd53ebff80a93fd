//! Gaussian noise on the coordinates of particles, and how wide it should be.
//!
//! [`diffuse`] adds N(0, diag(sd²)). [`spread`] measures the standard deviations of the set that resampling leaves, before it is diffused: noise no wider than these gives little of it to coordinates that
//! the likelihood has already determined, the "soft partitioning" of Deutscher & Reid (2005).

use crate::moments;
use crate::particles::{Particles, move_by};
use crate::resample::Ancestors;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::{BlockRng, Stage};

/// Moves the states by noise of these standard deviations: each from its ancestor, with equal weights, or without `ancestors` each from itself, with the weight it has.
pub fn diffuse(particles: &mut Particles, ancestors: Option<Ancestors>, sd: &[f64], isa: Isa, stage: Stage) {
    let noisy = |from: &[Block], to: &mut [Block], rng: &mut BlockRng| {
        rng.fill_normal(isa, to);
        for ((z, x), sd) in to.iter_mut().zip(from).zip(sd) {
            for (z, x) in z.0.iter_mut().zip(x.0) {
                *z = x + sd * *z;
            }
        }
    };
    move_by(particles, ancestors, noisy, stage);
}

/// Standard deviation of each coordinate over the states of these ancestors.
#[must_use]
pub fn spread(particles: &Particles, ancestors: &[usize]) -> Vec<f64> {
    let share = 1.0 / ancestors.len() as f64;
    let mut weights = vec![0.0; particles.count()];
    ancestors.iter().for_each(|&a| weights[a] += share);
    let mean = moments::mean(particles.states(), particles.dim(), &weights);
    let mut squares = vec![0.0; mean.len()];
    for (i, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
        let block = &particles.states()[i / LANES * mean.len()..];
        for ((square, x), mean) in squares.iter_mut().zip(block).zip(&mean) {
            *square += weight * (x.0[i % LANES] - mean).powi(2);
        }
    }
    squares.into_iter().map(f64::sqrt).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moved(count: usize) -> Particles {
        let mut particles = Particles::new(&[1.0, -2.0], count).expect("not empty");
        diffuse(&mut particles, None, &[0.5, 0.0], Isa::best(), Stage::new(1, "diffuse"));
        particles
    }

    #[test]
    fn noise_is_added_where_it_has_a_width() {
        let particles = moved(4000);
        let everyone: Vec<usize> = (0..4000).collect();
        let sd = spread(&particles, &everyone);
        assert!((sd[0] / 0.5 - 1.0).abs() < 0.05 && sd[1] < 1e-14, "{sd:?}");
        assert!(particles.states().chunks(2).all(|b| b[1] == Block::splat(-2.0)));
    }

    #[test]
    fn the_spread_is_that_of_the_ancestors() {
        let particles = moved(11);
        assert!(spread(&particles, &[9; 11]).iter().all(|sd| *sd < 1e-14));
        let sd = spread(&particles, &[3, 10]);
        let half = 0.5 * (particles.state(3)[0] - particles.state(10)[0]).abs();
        assert!((sd[0] - half).abs() < 1e-14);
    }
}
