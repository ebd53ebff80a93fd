//! A toy hierarchy: limbs on sheets, limbs in pairs, and the whole; beside it a place.

use sinew_core::decode::{Decode, Linear};
use sinew_core::density::Lanes;
use sinew_core::hierarchy::{AnyDecode, Hierarchy, Node};
use sinew_core::lanes::{Block, Isa};
use sinew_core::toy::Sheet;
use std::sync::Arc;

/// Number of limbs, coordinates of each, and of all with the place before them.
pub const LIMBS: usize = 4;
pub const LIMB: usize = 4;
pub const PLACE: usize = 2;
pub const DIM: usize = PLACE + LIMBS * LIMB;

/// A latent of two, from which matrices make latents of parts, which stand one after the other.
pub struct Stack {
    pub parts: Vec<(Arc<AnyDecode>, Arc<AnyDecode>)>,
    /// All matrices, row after row.
    whole: Lanes<Linear>,
}

impl Decode for Stack {
    fn source_dim(&self) -> usize {
        2
    }
    fn target_dim(&self) -> usize {
        self.parts.iter().map(|(_, pose)| pose.target_dim()).sum()
    }
    fn workspace(&self) -> usize {
        4 + self.parts.iter().map(|(_, pose)| pose.workspace()).max().unwrap_or(0)
    }
    fn decode_block(&self, x: &[Block], out: &mut [Block], ws: &mut [Block]) {
        let (latent, ws) = ws.split_at_mut(2);
        let mut rest = out;
        for (map, pose) in &self.parts {
            let (part, others) = rest.split_at_mut(pose.target_dim());
            map.decode_block(x, latent, ws);
            pose.decode_block(latent, part, ws);
            rest = others;
        }
    }
    fn pullback_block(&self, x: &[Block], grad_out: &[Block], grad: &mut [Block], ws: &mut [Block]) {
        let (latents, ws) = ws.split_at_mut(4);
        let (latent, pulled) = latents.split_at_mut(2);
        let (mut rest, mut sum) = (grad_out, [Block::ZERO; 2]);
        for (map, pose) in &self.parts {
            let (part, others) = rest.split_at(pose.target_dim());
            map.decode_block(x, latent, ws);
            pose.pullback_block(latent, part, pulled, ws);
            map.pullback_block(x, pulled, grad, ws);
            sum.iter_mut().zip(&*grad).for_each(|(s, g)| s.0.iter_mut().zip(g.0).for_each(|(s, g)| *s += g));
            rest = others;
        }
        grad.copy_from_slice(&sum);
    }
    fn encode(&self, decoded: &[f64]) -> Option<Vec<f64>> {
        let (mut rest, mut latents) = (decoded, vec![]);
        for (_, pose) in &self.parts {
            let (part, others) = rest.split_at(pose.target_dim());
            latents.extend(pose.encode(part)?);
            rest = others;
        }
        self.whole.encode(&latents)
    }
}

fn linear(matrix: Vec<f64>) -> Lanes<Linear> {
    Lanes { leaf: Linear::new(matrix, 2).expect("rows"), isa: Isa::best() }
}

/// The matrix from a node's latent to that of its child.
fn matrix(child: usize) -> Vec<f64> {
    let angle = 0.4 * child as f64;
    let (sin, cos) = angle.sin_cos();
    vec![cos, -sin, 0.8 * sin, 0.8 * cos]
}

fn stack(poses: &[Arc<AnyDecode>], first: usize) -> Arc<AnyDecode> {
    let maps = (first..).map(|child| Arc::new(linear(matrix(child))) as Arc<AnyDecode>);
    let whole = linear((first..first + poses.len()).flat_map(matrix).collect());
    Arc::new(Stack { parts: maps.zip(poses.iter().cloned()).collect(), whole })
}

/// Limb k, a sheet.
pub fn limb(k: usize) -> Arc<AnyDecode> {
    Arc::new(Lanes { leaf: Sheet { radius: 0.8 + 0.1 * k as f64, twist: 0.3 }, isa: Isa::best() })
}

/// The coordinates of limb k, which stand apart.
pub fn coordinates(k: usize) -> Vec<usize> {
    (0..LIMB).map(|j| LIMBS * j + k).collect()
}

/// The whole in one layer, in two with pairs of limbs, or in three with limbs, of which the last pair may have none.
pub fn hierarchy(layers: usize, last_pair_is_leaf: bool) -> Hierarchy {
    let limbs: Vec<Arc<AnyDecode>> = (0..LIMBS).map(limb).collect();
    let pairs: Vec<Arc<AnyDecode>> = (0..2).map(|p| stack(&limbs[2 * p..][..2], 3 + 2 * p)).collect();
    let whole = stack(&pairs, 1);
    let of = |limbs: std::ops::Range<usize>| limbs.flat_map(coordinates).collect::<Vec<_>>();
    let node = |parent: Option<usize>, layer, coordinates: Vec<usize>, child: usize, pose: &Arc<AnyDecode>| Node {
        parent,
        layer,
        coordinates,
        from_parent: parent.map(|_| Arc::new(linear(matrix(child))) as Arc<AnyDecode>),
        pose: pose.clone(),
        step_sd: vec![0.15; 2],
    };
    let mut nodes = vec![node(None, 1, of(0..LIMBS), 0, &whole)];
    if layers > 1 {
        nodes.extend((0..2).map(|p| node(Some(0), 2, of(2 * p..2 * p + 2), 1 + p, &pairs[p])));
    }
    if layers > 2 {
        let below = if last_pair_is_leaf { 2 } else { LIMBS };
        nodes.extend((0..below).map(|k| node(Some(1 + k / 2), 3, coordinates(k), 3 + k, &limbs[k])));
    }
    Hierarchy::new(nodes).expect("a tree")
}
