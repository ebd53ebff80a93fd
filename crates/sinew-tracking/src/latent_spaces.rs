//! The latent spaces of a hierarchy as a tracker moves in them.
//!
//! Particles [λ, θ, ρ] of each node ([`Beside`]), their noise, and what the leaves make of a pose together.

use crate::Error;
use sinew_core::beside::Beside;
use sinew_core::decode::Decode;
use sinew_core::hierarchy::{AnyDecode, Hierarchy};
use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;
use sinew_samplers::annealed_search;
use sinew_samplers::decoded::decoded;
use sinew_samplers::descent::{PosePart, assemble, descend};
use sinew_samplers::diffusion::diffuse;
use sinew_samplers::particles::{Particles, resample};
use sinew_samplers::resample::{Ancestors, shuffle};
use std::fmt;
use std::sync::Arc;

/// Refuses a schedule of visits that does not walk from the root down to the deepest of these layers.
pub(crate) fn check_schedule(schedule: &[usize], layers: usize) -> Result<(), Error> {
    let check = |name, value: usize, inside: bool, expected| {
        if inside { Ok(()) } else { Err(Error::Config { name, value: value as f64, expected }) }
    };
    let [first, last] = [schedule.first(), schedule.last()].map(|layer| layer.copied().unwrap_or(0));
    check("first layer of the schedule", first, first == 1, "must be 1, the root's")?;
    for pair in schedule.windows(2) {
        let inside = pair[1] == pair[0] || pair[1] == pair[0] + 1;
        check("layer of the schedule", pair[1], inside, "must be the layer before or the next below")?;
    }
    check("last layer of the schedule", last, last == layers, "must be the deepest of the hierarchy")
}

/// The spaces.
#[derive(Clone)]
pub(crate) struct LatentSpaces {
    /// Their tree.
    pub hierarchy: Arc<Hierarchy>,
    /// Number of coordinates λ.
    pub free: usize,
    /// Of each node: from its particles to poses, and the standard deviations of Σ.
    nodes: Vec<(Beside<Arc<AnyDecode>>, Vec<f64>)>,
    layers: annealed_search::Config,
    isa: Isa,
}

impl LatentSpaces {
    /// Spaces beside as many coordinates as there are standard deviations of λ.
    pub fn new(
        hierarchy: Arc<Hierarchy>,
        lambda_sd: &[f64],
        layers: annealed_search::Config,
        isa: Isa,
    ) -> Result<Self, Error> {
        let (free, dim) = (lambda_sd.len(), hierarchy.dim());
        let mut nodes = vec![];
        for node in hierarchy.nodes() {
            let decoder = Beside::new(free, node.pose.clone(), &node.coordinates, dim)?;
            let mut sd = [lambda_sd, &node.step_sd].concat();
            sd.resize(decoder.source_dim(), 0.0);
            layers.check(&sd, decoder.source_dim())?;
            nodes.push((decoder, sd));
        }
        Ok(Self { hierarchy, free, nodes, layers, isa })
    }

    /// From a node's particles to poses.
    pub fn decoder(&self, node: usize) -> &Beside<Arc<AnyDecode>> {
        &self.nodes[node].0
    }

    /// The particles of a node for a visit, 0 the first: from its parent's where its layer is new, else from its own.
    pub fn renewed(
        &self,
        sets: &[Particles],
        node: usize,
        is_new: bool,
        visit: usize,
        [to_resample, to_diffuse]: [Stage; 2],
    ) -> Particles {
        let (decoder, sd) = &self.nodes[node];
        let above = &self.hierarchy.nodes()[node];
        let (mut set, ancestors) = match (above.parent, &above.from_parent) {
            (Some(parent), Some(map)) if is_new => {
                let ancestors = resample(&sets[parent], self.layers.scheme, to_resample);
                (descend(&sets[parent], ancestors, self.decoder(parent), map, decoder), None)
            }
            _ => (sets[node].clone(), Some(resample(&sets[node], self.layers.scheme, to_resample))),
        };
        diffuse(&mut set, ancestors, &self.layers.noise(sd, visit), self.isa, to_diffuse);
        set
    }

    /// The leaves' particles as parts of poses.
    pub fn parts<'a>(&self, sets: &'a [Particles]) -> Vec<PosePart<'a>> {
        let part = |leaf: usize| PosePart {
            poses: decoded(sets[leaf].states(), self.decoder(leaf)),
            weights: sets[leaf].weights(),
            coordinates: self.hierarchy.nodes()[leaf].coordinates.iter().map(|i| self.free + i).collect(),
        };
        self.hierarchy.leaves().map(part).collect()
    }

    /// Poses of one draw by weight of each leaf, independently of each other.
    pub fn assembled(&self, sets: &[Particles], parts: &[PosePart<'_>], [to_draw, to_pair]: [Stage; 2]) -> Vec<Block> {
        let draw = |(k, leaf): (usize, usize)| {
            let mut ancestors = resample(&sets[leaf], self.layers.scheme, to_draw.round(k));
            shuffle(&mut ancestors, &mut to_pair.round(k).whole());
            ancestors
        };
        let ancestors: Vec<Ancestors> = self.hierarchy.leaves().enumerate().map(draw).collect();
        assemble(parts, &ancestors, self.free, self.free + self.hierarchy.dim())
    }

    /// The same poses at the place λ of one.
    pub fn placed(&self, poses: &[Block], at: &[f64]) -> Vec<Block> {
        let mut poses = poses.to_vec();
        for pose in poses.chunks_exact_mut(at.len()) {
            pose.iter_mut().zip(&at[..self.free]).for_each(|(x, lambda)| *x = Block::splat(*lambda));
        }
        poses
    }
}

impl fmt::Debug for LatentSpaces {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { hierarchy, free, layers, .. } = self;
        write!(f, "LatentSpaces {{ {hierarchy:?}, beside {free}, {layers:?} }}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::decode::{Identity, Linear};
    use sinew_core::density::Lanes;
    use sinew_core::hierarchy::Node;
    use sinew_core::lanes::{LANES, get_lane};
    use sinew_samplers::resample::Scheme;

    const COUNT: usize = 1000;

    /// A pose of two coordinates, each a leaf of its own; beside it a place.
    fn spaces() -> LatentSpaces {
        let node = |parent: Option<usize>, coordinates: Vec<usize>| Node {
            parent,
            layer: if parent.is_some() { 2 } else { 1 },
            from_parent: parent.map(|_| {
                let matrix = coordinates.iter().flat_map(|&j| [f64::from(j == 0), f64::from(j == 1)]).collect();
                Arc::new(Lanes { leaf: Linear::new(matrix, 2).expect("rows"), isa: Isa::best() }) as Arc<AnyDecode>
            }),
            pose: Arc::new(Identity(coordinates.len())) as Arc<AnyDecode>,
            step_sd: vec![0.1; coordinates.len()],
            coordinates,
        };
        let nodes = vec![node(None, vec![0, 1]), node(Some(0), vec![1]), node(Some(0), vec![0])];
        let layers = annealed_search::Config { scheme: Scheme::Systematic, ..annealed_search::Config::default() };
        LatentSpaces::new(Arc::new(Hierarchy::new(nodes).expect("a tree")), &[0.2], layers, Isa::best()).expect("valid")
    }

    /// Equally weighted leaves whose particle i is at i: each is taken once, and what is put together of them is paired at random. |r| √N < 4.5, false alarm 7e-6.
    #[test]
    fn limbs_are_paired_at_random() {
        let spaces = spaces();
        let at_index = |k: usize| Block(std::array::from_fn(|lane| (k / 3 * LANES + lane) as f64));
        let leaf = || Particles::of(3, COUNT, (0..COUNT.div_ceil(LANES) * 3).map(at_index).collect());
        let sets = [leaf(), leaf(), leaf()];
        let poses = spaces.assembled(&sets, &spaces.parts(&sets), ["draw", "pair"].map(|verb| Stage::new(1, verb)));
        let mut drawn: Vec<[f64; 3]> = vec![[0.0; 3]; COUNT];
        drawn.iter_mut().enumerate().for_each(|(i, pose)| get_lane(&poses[i / LANES * 3..][..3], i % LANES, pose));
        let (mean, variance) = (0.5 * (COUNT - 1) as f64, (COUNT * COUNT - 1) as f64 / 12.0);
        let product: f64 = drawn.iter().map(|[_, a, b]| (a - mean) * (b - mean)).sum();
        let correlation = product / variance / COUNT as f64;
        assert!(correlation.abs() * (COUNT as f64).sqrt() < 4.5, "{correlation}");
        for j in [1, 2] {
            let mut limb: Vec<f64> = drawn.iter().map(|pose| pose[j]).collect();
            limb.sort_by(f64::total_cmp);
            assert!(limb.into_iter().eq((0..COUNT).map(|i| i as f64)));
        }
        assert!(drawn.iter().all(|[place, a, b]| *place == 0.5 * (a + b)));
        assert!(spaces.placed(&poses, &[7.0, 0.0, 0.0]).chunks(3).all(|pose| pose[0] == Block::splat(7.0)));
    }

    /// In a new layer a child has its parents' poses but for noise on the place and on its own coordinate; in the same one it has its own. Systematic resampling of equal weights leaves each in its place.
    /// After two weightings the noise has half of its standard deviations, 0.2 and 0.1; variances within 4.5 standard errors, false alarm 3e-5.
    #[test]
    fn noise_moves_the_place_and_the_node_alone() {
        const BLOCKS: usize = 500;
        let spaces = spaces();
        let root = Particles::of(3, BLOCKS * LANES, [1.0, 2.0, 3.0].map(Block::splat).repeat(BLOCKS));
        let mut sets = vec![root; 3];
        for is_new in [true, false] {
            let stages = || ["draw", "noise"].map(|verb| Stage::new(u64::from(is_new), verb));
            let before: Vec<Block> = decoded(sets[1].states(), spaces.decoder(usize::from(!is_new)));
            sets[1] = spaces.renewed(&sets, 1, is_new, 2, stages());
            let after = decoded(sets[1].states(), spaces.decoder(1));
            let mut squares = [0.0; 3];
            for (from, to) in before.chunks(3).zip(after.chunks(3)) {
                assert_eq!(from[1], to[1], "the other leaf's coordinate");
                for (square, (from, to)) in squares.iter_mut().zip(from.iter().zip(to)) {
                    *square += from.0.iter().zip(to.0).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
                }
            }
            let count = (BLOCKS * LANES) as f64;
            for (square, sd) in [(squares[0], 0.1), (squares[2], 0.05)] {
                let ratio = square / count / (sd * sd);
                assert!((ratio - 1.0).abs() < 4.5 * (2.0 / count).sqrt(), "{ratio}");
            }
        }
    }
}
