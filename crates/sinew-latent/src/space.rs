//! Latent spaces as decoders: from the latent of a node to the columns of data below it.
//!
//! [`Space`] is one node, a [`Decode`] to its own outputs. [`Below`] is ℘_n, a [`Decode`] to the data's columns that the leaves below a node generate: μ_n at a leaf, else ℘_c of every child's part of μ_n.

use crate::Error;
use crate::inverse::Inverse;
use crate::mapping::Mapping;
use crate::model::{LatentModel, Outputs};
use sinew_core::decode::{Decode, LaneDecode};
use sinew_core::density::Lanes;
use sinew_core::lanes::{Block, Isa, Real};
use std::ops::Range;
use std::sync::Arc;

/// Steps of an inverse map up its density, in trackers.
pub const INVERSE_STEPS: usize = 3;

/// One node: its processes and their inverse.
#[derive(Clone, Debug)]
pub struct Space {
    /// From latents to outputs.
    pub mapping: Arc<Mapping>,
    /// From outputs to latents.
    pub inverse: Arc<Inverse>,
}

impl Space {
    /// Of a node, whose inverse makes [`INVERSE_STEPS`].
    ///
    /// # Errors
    /// [`Error::Singular`].
    pub fn new(model: &LatentModel, node: usize) -> Result<Self, Error> {
        Self::with_steps(model, node, INVERSE_STEPS)
    }

    /// The same with another number of steps at most; with none the inverse is regression alone.
    ///
    /// # Errors
    /// [`Error::Singular`].
    pub fn with_steps(model: &LatentModel, node: usize, steps: usize) -> Result<Self, Error> {
        let mapping = Arc::new(Mapping::new(model, node)?);
        let inverse = Arc::new(Inverse::new(model, node, mapping.clone(), steps)?);
        Ok(Self { mapping, inverse })
    }
}

impl LaneDecode for Space {
    fn source_dim(&self) -> usize {
        self.mapping.dim()
    }
    fn target_dim(&self) -> usize {
        self.mapping.outputs()
    }
    fn workspace(&self) -> usize {
        self.mapping.workspace()
    }
    #[inline(always)]
    fn decode<V: Real>(&self, x: &[V::Mem], out: &mut [V::Mem], ws: &mut [V::Mem]) {
        self.mapping.mean::<V>(x, out, ws);
    }
    #[inline(always)]
    fn pullback<V: Real>(&self, x: &[V::Mem], grad_out: &[V::Mem], grad: &mut [V::Mem], ws: &mut [V::Mem]) {
        self.mapping.pullback::<V>(x, grad_out, grad, ws);
    }
    #[inline(always)]
    fn jacobian<V: Real>(&self, x: &[V::Mem], jacobian: &mut [V::Mem], ws: &mut [V::Mem]) {
        self.mapping.jacobian::<V>(x, jacobian, ws);
    }
    fn encode(&self, decoded: &[f64]) -> Option<Vec<f64>> {
        Some(self.inverse.latent(decoded))
    }
}

/// The part of a node's outputs that a child takes as its latent, and the places of the child's columns among the node's.
#[derive(Clone, Debug)]
struct Child {
    latent: Range<usize>,
    columns: Vec<usize>,
    below: Below,
}

/// ℘_n of a node: all columns that the leaves below it generate, in ascending order.
#[derive(Clone, Debug)]
pub struct Below {
    space: Lanes<Space>,
    /// Columns of the data, ascending.
    columns: Vec<usize>,
    /// For a leaf, where each output goes among the columns.
    places: Vec<usize>,
    children: Vec<Child>,
}

impl Below {
    /// Of a node of a model; inverses of leaves make [`INVERSE_STEPS`].
    ///
    /// # Errors
    /// [`Error::Singular`].
    pub fn new(model: &LatentModel, node: usize, isa: Isa) -> Result<Self, Error> {
        Self::with_steps(model, node, INVERSE_STEPS, isa)
    }

    /// The same with another number of steps of the inverses of leaves at most. Inverses of inner nodes are regression alone: the noise of their processes is so small that a density is sharp, and steps up it from a poor start lead astray.
    ///
    /// # Errors
    /// [`Error::Singular`].
    pub fn with_steps(model: &LatentModel, node: usize, steps: usize, isa: Isa) -> Result<Self, Error> {
        let is_leaf = matches!(model.nodes[node].outputs, Outputs::Columns(_));
        let space = Lanes { leaf: Space::with_steps(model, node, if is_leaf { steps } else { 0 })?, isa };
        let place = |columns: &[usize], column: usize| columns.partition_point(|&other| other < column);
        match &model.nodes[node].outputs {
            Outputs::Columns(own) => {
                let mut columns = own.clone();
                columns.sort_unstable();
                let places = own.iter().map(|&column| place(&columns, column)).collect();
                Ok(Self { space, columns, places, children: vec![] })
            }
            Outputs::Nodes(nodes) => {
                let below =
                    nodes.iter().map(|&c| Self::with_steps(model, c, steps, isa)).collect::<Result<Vec<_>, _>>()?;
                let mut columns: Vec<usize> = below.iter().flat_map(|child| child.columns.iter().copied()).collect();
                columns.sort_unstable();
                let mut first = 0;
                let children = below.into_iter().map(|below| {
                    let latent = first..first + below.source_dim();
                    first = latent.end;
                    let columns = below.columns.iter().map(|&column| place(&columns, column)).collect();
                    Child { latent, columns, below }
                });
                let children = children.collect();
                Ok(Self { space, columns, places: vec![], children })
            }
        }
    }

    /// Columns of the data that it decodes to, ascending.
    #[must_use]
    pub fn columns(&self) -> &[usize] {
        &self.columns
    }

    /// The node's own processes.
    #[must_use]
    pub fn space(&self) -> &Space {
        &self.space.leaf
    }

    /// Blocks of scratch of the largest child.
    fn children_workspace(&self) -> usize {
        let need = |child: &Child| child.below.workspace() + child.below.target_dim();
        self.children.iter().map(need).max().unwrap_or(0)
    }
}

impl Decode for Below {
    fn source_dim(&self) -> usize {
        self.space.leaf.mapping.dim()
    }

    fn target_dim(&self) -> usize {
        self.columns.len()
    }

    fn workspace(&self) -> usize {
        let own = self.space.leaf.mapping.outputs();
        2 * own + self.children_workspace().max(Decode::workspace(&self.space))
    }

    fn decode_block(&self, x: &[Block], out: &mut [Block], ws: &mut [Block]) {
        let (own, ws) = ws.split_at_mut(self.space.leaf.mapping.outputs());
        self.space.decode_block(x, own, ws);
        for (&place, y) in self.places.iter().zip(&*own) {
            out[place] = *y;
        }
        for child in &self.children {
            let (decoded, ws) = ws.split_at_mut(child.below.target_dim());
            child.below.decode_block(&own[child.latent.clone()], decoded, ws);
            child.columns.iter().zip(&*decoded).for_each(|(&place, y)| out[place] = *y);
        }
    }

    fn pullback_block(&self, x: &[Block], grad_out: &[Block], grad: &mut [Block], ws: &mut [Block]) {
        let outputs = self.space.leaf.mapping.outputs();
        let (own, ws) = ws.split_at_mut(outputs);
        let (own_grad, ws) = ws.split_at_mut(outputs);
        for (&place, g) in self.places.iter().zip(own_grad.iter_mut()) {
            *g = grad_out[place];
        }
        if !self.children.is_empty() {
            self.space.decode_block(x, own, ws);
        }
        for child in &self.children {
            let (gathered, ws) = ws.split_at_mut(child.below.target_dim());
            child.columns.iter().zip(gathered.iter_mut()).for_each(|(&place, g)| *g = grad_out[place]);
            let range = child.latent.clone();
            child.below.pullback_block(&own[range.clone()], gathered, &mut own_grad[range], ws);
        }
        self.space.pullback_block(x, own_grad, grad, ws);
    }

    /// Upward: each leaf from its columns, then each inner node from its children's latents.
    fn encode(&self, decoded: &[f64]) -> Option<Vec<f64>> {
        if self.children.is_empty() {
            let own: Vec<f64> = self.places.iter().map(|&place| decoded[place]).collect();
            return self.space.leaf.encode(&own);
        }
        let mut latents = Vec::new();
        for child in &self.children {
            let columns: Vec<f64> = child.columns.iter().map(|&place| decoded[place]).collect();
            latents.extend(child.below.encode(&columns)?);
        }
        self.space.leaf.encode(&latents)
    }
}

/// φ of a child: its part of its parent's mean.
#[derive(Clone, Debug)]
pub struct ToChild {
    space: Lanes<Space>,
    latent: Range<usize>,
}

impl ToChild {
    /// From a node to the child of this number among its children.
    ///
    /// # Errors
    /// [`Error::Singular`], and [`Error::Shape`] for a leaf or a child that is not there.
    pub fn new(model: &LatentModel, node: usize, child: usize, space: Space, isa: Isa) -> Result<Self, Error> {
        let Outputs::Nodes(children) = &model.nodes[node].outputs else {
            return Err(Error::Shape { name: "children of a leaf", found: 0, expected: child + 1 });
        };
        if child >= children.len() {
            return Err(Error::Shape { name: "children of a node", found: children.len(), expected: child + 1 });
        }
        let first = children[..child].iter().map(|&c| model.nodes[c].dim).sum();
        let latent = first..first + model.nodes[children[child]].dim;
        Ok(Self { space: Lanes { leaf: space, isa }, latent })
    }
}

impl Decode for ToChild {
    fn source_dim(&self) -> usize {
        self.space.leaf.mapping.dim()
    }
    fn target_dim(&self) -> usize {
        self.latent.len()
    }
    fn workspace(&self) -> usize {
        self.space.leaf.mapping.outputs() + Decode::workspace(&self.space)
    }
    fn decode_block(&self, x: &[Block], out: &mut [Block], ws: &mut [Block]) {
        let (own, ws) = ws.split_at_mut(self.space.leaf.mapping.outputs());
        self.space.decode_block(x, own, ws);
        out.copy_from_slice(&own[self.latent.clone()]);
    }
    fn pullback_block(&self, x: &[Block], grad_out: &[Block], grad: &mut [Block], ws: &mut [Block]) {
        let (own, ws) = ws.split_at_mut(self.space.leaf.mapping.outputs());
        own.fill(Block::ZERO);
        own[self.latent.clone()].copy_from_slice(grad_out);
        self.space.pullback_block(x, own, grad, ws);
    }
    /// None: a child's latent does not tell its parent's.
    fn encode(&self, _decoded: &[f64]) -> Option<Vec<f64>> {
        None
    }
}
