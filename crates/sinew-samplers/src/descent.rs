//! Down a hierarchy of latent spaces, and from its leaves back to whole poses.
//!
//! After Raskin, Rudzsky & Rivlin (2011, eqs. 4 to 8).
//!
//! States of a node are [λ, θ, ρ] ([`Beside`]): free coordinates, the node's latent, and the coordinates of the pose that the node does not cover, as its ancestors left them.
//!
//! - [`descend`]: a child's states are [λ, φ(θ), ρ'] of the chosen states of its parent, ρ' their pose where the child does not cover it. Law `descent_keeps_poses`: where ℘_parent = ℘_child ∘ φ on the child's coordinates, every pose stays.
//! - [`assemble`]: pose j has coordinate i of state `ancestors[j]` of the one part that holds i, and the mean of the parts' λ. Law `parts_are_put_together`.
//!
//! The parts are paired by index, so their ancestors must be in random order ([`crate::resample::shuffle`]). What is put together has lost what its parts knew of each other: a step of a search.

use crate::decoded::decoded;
use crate::moments;
use crate::particles::{Particles, take};
use crate::resample::Ancestors;
use rayon::prelude::*;
use sinew_core::beside::Beside;
use sinew_core::decode::Decode;
use sinew_core::lanes::{Block, LANES};

/// The states of a child, equally weighted, from these ancestors among its parent's. `map` is φ, from latent to latent.
#[must_use]
pub fn descend<C: Decode, M: Decode + ?Sized>(
    parent: &Particles,
    ancestors: Ancestors,
    from: &Beside<C>,
    map: &M,
    to: &Beside<C>,
) -> Particles {
    let mut chosen = parent.clone();
    take(&mut chosen, ancestors);
    let poses = decoded(chosen.states(), from);
    let mut states = vec![Block::ZERO; poses.len() / to.target_dim() * to.source_dim()];
    let parents = chosen.states().par_chunks_exact(from.source_dim()).zip(poses.par_chunks_exact(to.target_dim()));
    states.par_chunks_exact_mut(to.source_dim()).zip(parents).for_each_init(
        || vec![Block::ZERO; map.workspace()],
        |ws, (state, (parent, pose))| {
            map.decode_block(&parent[from.latent()], &mut state[to.latent()], ws);
            to.pass(pose, state);
        },
    );
    Particles::of(to.source_dim(), chosen.count(), states)
}

/// A part of whole poses.
#[derive(Clone, Debug)]
pub struct PosePart<'a> {
    /// Poses [λ, ω], in blocks of eight.
    pub poses: Vec<Block>,
    /// Their weights, as many as there are poses.
    pub weights: &'a [f64],
    /// The coordinates that the part holds, in [λ, ω].
    pub coordinates: Vec<usize>,
}

/// Poses of dimension `dim`, of which the first `free` coordinates are λ, from the chosen ones of each part, which together hold all others once; idle lanes repeat the last pose.
#[must_use]
pub fn assemble(parts: &[PosePart<'_>], ancestors: &[Ancestors], free: usize, dim: usize) -> Vec<Block> {
    let count = ancestors.first().map_or(0, Vec::len);
    let mut out = vec![Block::ZERO; count.div_ceil(LANES) * dim];
    for (part, ancestors) in parts.iter().zip(ancestors) {
        for slot in 0..out.len() / dim * LANES {
            let (ancestor, lane) = (ancestors[slot.min(count - 1)], slot % LANES);
            let (from, to) = (&part.poses[ancestor / LANES * dim..], &mut out[slot / LANES * dim..]);
            for i in 0..free {
                to[i].0[lane] += from[i].0[ancestor % LANES] / parts.len() as f64;
            }
            for &i in &part.coordinates {
                to[i].0[lane] = from[i].0[ancestor % LANES];
            }
        }
    }
    out
}

/// Mean pose: each coordinate the weighted mean of the part that holds it, λ the mean of the parts' means.
#[must_use]
pub fn mean_of_parts(parts: &[PosePart<'_>], free: usize, dim: usize) -> Vec<f64> {
    let mut out = vec![0.0; dim];
    for part in parts {
        let mean = moments::mean(&part.poses, dim, part.weights);
        out[..free].iter_mut().zip(&mean).for_each(|(sum, x)| *sum += x / parts.len() as f64);
        part.coordinates.iter().for_each(|&i| out[i] = mean[i]);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diffusion::diffuse;
    use sinew_core::decode::Linear;
    use sinew_core::density::Lanes;
    use sinew_core::lanes::Isa;
    use sinew_core::random::Stage;

    fn linear(matrix: &[f64], source_dim: usize) -> Lanes<Linear> {
        Lanes { leaf: Linear::new(matrix.to_vec(), source_dim).expect("rows"), isa: Isa::best() }
    }

    fn pose(particles: &Particles, index: usize, decoder: &Beside<Lanes<Linear>>) -> Vec<f64> {
        let mut pose = vec![0.0; decoder.target_dim()];
        decoder.decode(&particles.state(index), &mut pose);
        pose
    }

    /// A latent of two decodes to three coordinates, a child's of one to the outer two of these: [2 t, t] with t = u + v.
    #[test]
    fn descent_keeps_poses() {
        let root = Beside::new(1, linear(&[2.0, 2.0, 0.3, -0.4, 1.0, 1.0], 2), &[0, 1, 2], 3).expect("fits");
        let child = Beside::new(1, linear(&[1.0, 2.0], 1), &[2, 0], 3).expect("fits");
        let mut parent = Particles::new(&[5.0, 0.5, -0.2], 11).expect("not empty");
        diffuse(&mut parent, None, &[1.0; 3], Isa::best(), Stage::new(1, "descent"));
        let ancestors: Ancestors = (0..11).map(|i| i * 7 % 11).collect();
        let below = descend(&parent, ancestors.clone(), &root, &linear(&[1.0, 1.0], 2), &child);
        assert_eq!((below.dim(), below.count(), below.weights()[3]), (3, 11, 1.0 / 11.0));
        for (i, ancestor) in ancestors.into_iter().enumerate() {
            let (from, to) = (pose(&parent, ancestor, &root), pose(&below, i, &child));
            assert!(from.iter().zip(to).all(|(a, b)| (a - b).abs() < 1e-14), "{i}");
        }
    }

    #[test]
    fn parts_are_put_together() {
        let poses = |sign: f64| -> Vec<Block> {
            (0..8).map(|k| Block(std::array::from_fn(|lane| sign * (10 * (k / 4 * 8 + lane) + k % 4) as f64))).collect()
        };
        let mut weights = [0.0; 11];
        (weights[2], weights[9]) = (0.25, 0.75);
        let part = |sign, coordinates: &[usize]| PosePart {
            poses: poses(sign),
            weights: &weights,
            coordinates: coordinates.to_vec(),
        };
        let parts = [part(1.0, &[3]), part(-1.0, &[2, 1])];
        let ancestors: [Ancestors; 2] = [(0..11).rev().collect(), vec![4; 11]];
        let whole = Particles::of(4, 11, assemble(&parts, &ancestors, 1, 4));
        for i in 0..11 {
            let first = 10.0 * (10 - i) as f64;
            assert_eq!(whole.state(i), [0.5 * first - 20.0, -41.0, -42.0, first + 3.0]);
        }
        assert_eq!(mean_of_parts(&parts, 1, 4), [0.0, -73.5, -74.5, 75.5]);
    }
}
