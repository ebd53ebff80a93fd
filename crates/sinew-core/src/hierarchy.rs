//! A tree of latent spaces for a tracker to walk down.
//!
//! After Lawrence & Moore (2007) and Raskin, Rudzsky & Rivlin (2011). The root holds the whole pose, the nodes below parts of it, the leaves parts that cover it once.
//!
//! Node n of latent θ_n covers some coordinates of the pose: ω|n = ℘_n(θ_n), [`Node::pose`]. A parent's latent says where that of a child is to be looked for: θ_c = φ_c(θ_n), [`Node::from_parent`]. The root's [`Decode::encode`] is ℘⁻¹.
//! Where ℘_n(θ)|c = ℘_c(φ_c(θ)) for all children c, going down changes no pose. Nothing is known here of what the maps are, nor of coordinates that come before ω and belong to no latent space.

use crate::Error;
use crate::decode::Decode;
use crate::part::{Part, Partition};
use core::fmt;
use std::sync::Arc;

/// Any decoder.
pub type AnyDecode = dyn Decode + Send + Sync;

/// One latent space.
pub struct Node<D: ?Sized = AnyDecode> {
    /// Place of its parent; of the root none.
    pub parent: Option<usize>,
    /// Depth in the tree, the root's is 1.
    pub layer: usize,
    /// Coordinates of the pose that it covers.
    pub coordinates: Vec<usize>,
    /// φ: from the parent's latent to this one; of the root none.
    pub from_parent: Option<Arc<D>>,
    /// ℘: from the latent to its coordinates of the pose, in their order.
    pub pose: Arc<D>,
    /// Standard deviations of the latent's step from frame to frame.
    pub step_sd: Vec<f64>,
}

/// The tree.
pub struct Hierarchy<D: ?Sized = AnyDecode> {
    nodes: Vec<Node<D>>,
}

impl<D: Decode + ?Sized> Hierarchy<D> {
    /// Checks a tree whose nodes come after their parents, the root first.
    ///
    /// # Errors
    /// [`Error::Root`], [`Error::ParentNotBefore`], [`Error::NodeDimension`] for a layer, a map or standard deviations that do not fit; [`Error::NodeCoordinates`] where a node has not its children's coordinates;
    /// and what [`Partition::new`] refuses where the leaves do not cover every coordinate once.
    pub fn new(nodes: Vec<Node<D>>) -> Result<Self, Error> {
        let tree = Self { nodes };
        for node in 0..tree.nodes.len() {
            tree.check_node(node)?;
        }
        let dim = tree.nodes.first().ok_or(Error::Root { node: 0 })?.coordinates.len();
        let part = |node: usize| Part::new(tree.nodes[node].coordinates.clone(), dim);
        Partition::new(tree.leaves().map(part).collect::<Result<_, _>>()?, dim)?;
        for node in 0..tree.nodes.len() {
            let children: Vec<usize> =
                tree.children(node).flat_map(|child| &tree.nodes[child].coordinates).copied().collect();
            if !children.is_empty() && Part::new(children, dim)? != part(node)? {
                return Err(Error::NodeCoordinates { node });
            }
        }
        Ok(tree)
    }

    fn check_node(&self, node: usize) -> Result<(), Error> {
        let Node { parent, layer, coordinates, from_parent, pose, step_sd } = &self.nodes[node];
        let check = |name, found, expected| {
            if found == expected { Ok(()) } else { Err(Error::NodeDimension { node, name, found, expected }) }
        };
        if parent.is_none() != (node == 0) {
            return Err(Error::Root { node });
        }
        if parent.is_some_and(|parent| parent >= node) {
            return Err(Error::ParentNotBefore { part: node });
        }
        let latent = pose.source_dim();
        check("layer", *layer, parent.map_or(1, |parent| self.nodes[parent].layer + 1))?;
        check("pose", pose.target_dim(), coordinates.len())?;
        check("number of standard deviations", step_sd.len(), latent)?;
        check("number of maps from the parent", from_parent.iter().count(), parent.iter().count())?;
        if let (Some(map), Some(parent)) = (from_parent, parent) {
            check("latent of the parent", map.source_dim(), self.nodes[*parent].pose.source_dim())?;
            check("latent", map.target_dim(), latent)?;
        }
        Ok(())
    }
}

impl<D: ?Sized> Hierarchy<D> {
    /// The same tree with that many times the standard deviations of all steps.
    #[must_use]
    pub fn with_noise(mut self, factor: f64) -> Self {
        self.nodes.iter_mut().flat_map(|node| &mut node.step_sd).for_each(|sd| *sd *= factor);
        self
    }

    /// The nodes, the root first, parents before children.
    #[must_use]
    pub fn nodes(&self) -> &[Node<D>] {
        &self.nodes
    }

    /// Dimension of the pose ω.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.nodes[0].coordinates.len()
    }

    /// Number of layers H.
    #[must_use]
    pub fn layers(&self) -> usize {
        self.nodes.iter().map(|node| node.layer).max().unwrap_or(0)
    }

    /// The nodes of a layer.
    pub fn layer(&self, layer: usize) -> impl Iterator<Item = usize> {
        (0..self.nodes.len()).filter(move |&node| self.nodes[node].layer == layer)
    }

    /// The nodes that hang on a node.
    pub fn children(&self, node: usize) -> impl Iterator<Item = usize> {
        (0..self.nodes.len()).filter(move |&child| self.nodes[child].parent == Some(node))
    }

    /// The nodes without children, whatever their layer.
    pub fn leaves(&self) -> impl Iterator<Item = usize> {
        (0..self.nodes.len()).filter(|&node| self.children(node).next().is_none())
    }
}

impl<D: ?Sized> fmt::Debug for Hierarchy<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.nodes.iter().map(|node| (node.parent, node.layer, &node.coordinates))).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Block;

    /// A map of these dimensions that nobody asks for a value.
    struct Shape(usize, usize);
    impl Decode for Shape {
        fn source_dim(&self) -> usize {
            self.0
        }
        fn target_dim(&self) -> usize {
            self.1
        }
        fn decode_block(&self, _x: &[Block], _out: &mut [Block], _ws: &mut [Block]) {}
        fn pullback_block(&self, _x: &[Block], _grad_out: &[Block], _grad: &mut [Block], _ws: &mut [Block]) {}
        fn encode(&self, _decoded: &[f64]) -> Option<Vec<f64>> {
            None
        }
    }

    /// Nodes of these parents and coordinates, each with a latent of two.
    fn nodes(tree: &[(Option<usize>, &[usize])]) -> Vec<Node<Shape>> {
        let mut nodes: Vec<Node<Shape>> = vec![];
        for &(parent, coordinates) in tree {
            nodes.push(Node {
                parent,
                layer: parent.map_or(1, |parent| nodes[parent].layer + 1),
                coordinates: coordinates.to_vec(),
                from_parent: parent.map(|_| Arc::new(Shape(2, 2))),
                pose: Arc::new(Shape(2, coordinates.len())),
                step_sd: vec![0.1; 2],
            });
        }
        nodes
    }

    /// Leaves of a hierarchy (A14): whatever the layers of the leaves, every coordinate has one that holds it, or the tree is refused.
    #[test]
    fn leaves_cover_every_coordinate_once() {
        let tree: [(Option<usize>, &[usize]); 5] =
            [(None, &[0, 1, 2, 3, 4]), (Some(0), &[4, 1, 2]), (Some(0), &[3, 0]), (Some(1), &[2, 4]), (Some(1), &[1])];
        let made = Hierarchy::new(nodes(&tree)).expect("a tree");
        assert_eq!((made.dim(), made.layers(), made.nodes().len()), (5, 3, 5));
        assert_eq!(made.leaves().collect::<Vec<_>>(), [2, 3, 4]);
        assert_eq!(
            (1..=3).map(|h| made.layer(h).collect()).collect::<Vec<Vec<_>>>(),
            [vec![0], vec![1, 2], vec![3, 4]]
        );
        assert_eq!(made.children(1).collect::<Vec<_>>(), [3, 4]);
        let with = |node: usize, coordinates: &'static [usize]| {
            let mut tree = tree;
            tree[node].1 = coordinates;
            Hierarchy::new(nodes(&tree)).expect_err("a bad tree")
        };
        assert_eq!(with(4, &[2]), Error::DuplicateIndex { index: 2 });
        assert_eq!(with(3, &[2]), Error::Uncovered { index: 4 });
        assert_eq!(with(2, &[3, 5]), Error::IndexOutOfRange { index: 5, dim: 5 });
        assert_eq!(with(2, &[3, 3]), Error::DuplicateIndex { index: 3 });
        assert_eq!(with(1, &[4, 1]), Error::NodeCoordinates { node: 0 });
        assert_eq!(with(0, &[0, 1, 2, 3, 3]), Error::DuplicateIndex { index: 3 });
    }

    #[test]
    fn trees_that_do_not_fit_are_refused() {
        let broken = |spoil: fn(&mut Vec<Node<Shape>>)| {
            let mut nodes = nodes(&[(None, &[0, 1, 2]), (Some(0), &[0, 1, 2]), (Some(1), &[0, 1, 2])]);
            spoil(&mut nodes);
            Hierarchy::new(nodes).expect_err("a bad tree")
        };
        let dimension = |node, name, found, expected| Error::NodeDimension { node, name, found, expected };
        assert_eq!(broken(Vec::clear), Error::Root { node: 0 });
        assert_eq!(broken(|n| n[1].parent = None), Error::Root { node: 1 });
        assert_eq!(broken(|n| n[1].parent = Some(2)), Error::ParentNotBefore { part: 1 });
        assert_eq!(broken(|n| n[2].layer = 2), dimension(2, "layer", 2, 3));
        assert_eq!(broken(|n| n[0].layer = 0), dimension(0, "layer", 0, 1));
        assert_eq!(broken(|n| n[1].pose = Arc::new(Shape(2, 4))), dimension(1, "pose", 4, 3));
        assert_eq!(broken(|n| n[1].step_sd.clear()), dimension(1, "number of standard deviations", 0, 2));
        let maps = |node, found| dimension(node, "number of maps from the parent", found, 1 - found);
        assert_eq!(broken(|n| n[2].from_parent = None), maps(2, 0));
        assert_eq!(broken(|n| n[0].from_parent = Some(Arc::new(Shape(2, 2)))), maps(0, 1));
        assert_eq!(
            broken(|n| n[2].from_parent = Some(Arc::new(Shape(5, 2)))),
            dimension(2, "latent of the parent", 5, 2)
        );
        assert_eq!(broken(|n| n[2].from_parent = Some(Arc::new(Shape(2, 3)))), dimension(2, "latent", 3, 2));
    }
}
