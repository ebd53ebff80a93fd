//! A model as the tree of latent spaces that a tracker walks down.

use crate::Error;
use crate::model::{LatentModel, Outputs};
use crate::motion::step_sd;
use crate::space::{Below, ToChild};
use sinew_core::decode::Decode;
use sinew_core::hierarchy::{Hierarchy, Node};
use sinew_core::lanes::Isa;
use std::sync::Arc;

/// The tree of a model: φ and ℘ of every node, and half of the largest step of its latents between consecutive rows as standard deviations. A model of one node is a tree of one layer. Inverses are regression alone: a tracker needs one a particle, frame and node, and steps up a density are most of its time and bring it no nearer.
///
/// # Errors
/// [`Error::Singular`], [`Error::Roots`] for a model with several roots, and [`Error::Tree`].
pub fn hierarchy(model: &LatentModel, isa: Isa) -> Result<Hierarchy, Error> {
    hierarchy_with_steps(model, 0, isa)
}

/// The same with a number of steps of the inverses of leaves at most.
///
/// # Errors
/// As [`hierarchy`].
pub fn hierarchy_with_steps(model: &LatentModel, steps: usize, isa: Isa) -> Result<Hierarchy, Error> {
    let roots = model.roots();
    if roots != [0] {
        return Err(Error::Roots { found: roots.len() });
    }
    let mut nodes: Vec<Node> = Vec::new();
    let mut spaces = Vec::new();
    for n in 0..model.nodes.len() {
        let below = Below::with_steps(model, n, steps, isa)?;
        spaces.push(below.space().clone());
        let above = (0..n).find_map(|p| match &model.nodes[p].outputs {
            Outputs::Nodes(children) => children.iter().position(|&c| c == n).map(|place| (p, place)),
            Outputs::Columns(_) => None,
        });
        let from_parent = above.map(|(p, place)| ToChild::new(model, p, place, spaces[p].clone(), isa)).transpose()?;
        nodes.push(Node {
            parent: above.map(|(p, _)| p),
            layer: above.map_or(1, |(p, _)| nodes[p].layer + 1),
            coordinates: below.columns().to_vec(),
            from_parent: from_parent.map(|map| Arc::new(map) as Arc<dyn Decode + Send + Sync>),
            pose: Arc::new(below),
            step_sd: step_sd(model, n),
        });
    }
    Ok(Hierarchy::new(nodes)?)
}
