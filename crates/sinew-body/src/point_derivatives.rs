//! How the points of a body move with its pose, its lengths, and their own places on their links.
//!
//! At fixed angles the points of the standard bodies are linear in every length and in every place. A length moves offsets of links and of points by constant vectors, each turned as its link is:
//!
//! ```text
//! ∂p_b/∂ℓ = ∂p_parent/∂ℓ + R_parent ∂offset_b/∂ℓ        ∂P/∂ℓ = ∂p_b/∂ℓ + R_b ∂m/∂ℓ        ∂P/∂m = R_b
//! ```

use crate::kinematics::{Plan, point_jacobian};
use crate::rotation::{Matrix, apply};
use crate::sizes::SIZES;
use crate::standard::Proportions;
use crate::tree::{KinematicTree, Link};
use sinew_core::lanes::Isa;

const ISA: Isa = Isa::baseline();

/// Difference to a longer body, metres.
const DIFFERENCE_M: f64 = 1e-3;

/// How the offset of a link or a point grows with a length.
#[derive(Clone, Debug)]
struct Growth {
    length: usize,
    by: [f64; 3],
}

/// A body, some of its points, and what its lengths move.
#[derive(Clone, Debug)]
pub struct Neighbours {
    plan: Plan,
    tree: KinematicTree,
    /// Which points of the tree.
    chosen: Vec<usize>,
    /// Link of each point.
    link_of: Vec<usize>,
    /// Growths of each link's offset.
    links: Vec<Vec<Growth>>,
    /// Growths of each point's offset.
    points: Vec<Vec<Growth>>,
}

/// Points of a body in a pose, K of them, and their derivatives; three numbers a point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointDerivatives {
    /// Positions in the world, metres.
    pub positions: Vec<f64>,
    /// By the degrees of freedom: row `3 k + a`, dof columns.
    pub by_pose: Vec<f64>,
    /// By the lengths: row `3 k + a`, a column for each of [`length_names`].
    pub by_length: Vec<f64>,
    /// Axes of each point's link in the world: row `3 k + a`, columns x, y, z.
    pub link_axes: Vec<f64>,
}

/// Names of the lengths of the standard bodies, in order.
#[must_use]
pub fn length_names() -> Vec<&'static str> {
    SIZES.iter().filter(|(_, is_length, _)| *is_length).map(|(name, ..)| *name).collect()
}

/// Lengths of a subject, metres, in the order of [`length_names`].
#[must_use]
pub fn lengths(proportions: &Proportions) -> Vec<f64> {
    let mut sizes = *proportions;
    SIZES.iter().filter(|(_, is_length, _)| *is_length).map(|(_, _, size)| *size(&mut sizes)).collect()
}

/// A subject with some lengths longer, metres, in the order of [`length_names`]; no length becomes less than a millimetre.
#[must_use]
pub fn lengthened(proportions: &Proportions, by: &[f64]) -> Proportions {
    let mut sizes = *proportions;
    for ((_, _, size), by) in SIZES.iter().filter(|(_, is_length, _)| *is_length).zip(by) {
        let place = size(&mut sizes);
        *place = (*place + by).max(1e-3);
    }
    sizes
}

/// Growths of an offset, from itself and the offsets of the longer bodies.
fn growths<'a>(offset: [f64; 3], longer: impl Iterator<Item = &'a [f64; 3]>) -> Vec<Growth> {
    let growth = |(length, longer): (usize, &[f64; 3])| {
        let by = [0, 1, 2].map(|a: usize| (longer[a] - offset[a]) / DIFFERENCE_M);
        by.iter().any(|x| *x != 0.0).then_some(Growth { length, by })
    };
    longer.enumerate().filter_map(growth).collect()
}

impl Neighbours {
    /// For some points (their indices in the body) of the body that `build` makes. A body whose sizes are fixed has `build` ignore them, and derivatives of 0.
    #[must_use]
    pub fn new(build: impl Fn(&Proportions) -> KinematicTree, proportions: &Proportions, points: &[usize]) -> Self {
        let tree = build(proportions);
        let count = length_names().len();
        let longer = |length: usize| {
            let by: Vec<f64> = (0..count).map(|k| if k == length { DIFFERENCE_M } else { 0.0 }).collect();
            build(&lengthened(proportions, &by))
        };
        let longer: Vec<KinematicTree> = (0..count).map(longer).collect();
        let from_link =
            |(i, link): (usize, &Link)| growths(link.offset, longer.iter().map(|tree| &tree.links()[i].offset));
        let from_point =
            |&p: &usize| growths(tree.points()[p].offset, longer.iter().map(|tree| &tree.points()[p].offset));
        Self {
            plan: Plan::new(&tree, points),
            links: tree.links().iter().enumerate().map(from_link).collect(),
            points: points.iter().map(from_point).collect(),
            link_of: points.iter().map(|&p| tree.points()[p].link).collect(),
            chosen: points.to_vec(),
            tree,
        }
    }

    /// The body with longer lengths, metres, and its points elsewhere on their links, metres, three numbers a point.
    #[must_use]
    pub fn reshaped(&self, longer: &[f64], places: &[f64]) -> Self {
        let grown = |growths: &Vec<Growth>| {
            let mut by = [0.0; 3];
            for growth in growths {
                by.iter_mut().zip(growth.by).for_each(|(x, by)| *x += by * longer[growth.length]);
            }
            by
        };
        let mut moved = vec![[0.0; 3]; self.tree.points().len()];
        for ((&point, growths), place) in self.chosen.iter().zip(&self.points).zip(places.chunks_exact(3)) {
            let by = grown(growths);
            moved[point] = [0, 1, 2].map(|a: usize| by[a] + place[a]);
        }
        let links: Vec<[f64; 3]> = self.links.iter().map(grown).collect();
        let tree = self.tree.with_links_moved(&links).with_points_moved(&moved);
        Self { plan: Plan::new(&tree, &self.chosen), tree, ..self.clone() }
    }

    /// Where a point is in the frame of its link, metres.
    #[must_use]
    pub fn offset(&self, point: usize) -> [f64; 3] {
        self.tree.points()[self.chosen[point]].offset
    }

    /// Points and derivatives in a pose.
    #[must_use]
    pub fn at(&self, pose: &[f64]) -> PointDerivatives {
        let count = 3 * self.plan.points();
        let (mut positions, mut by_pose) = (vec![0.0; count], vec![0.0; count * self.plan.dof()]);
        point_jacobian(&self.plan, ISA, pose, &mut positions, &mut by_pose);
        let rotations = self.rotations(pose);
        let link_axes = self.link_of.iter().flat_map(|&link| rotations[link]).flatten().collect();
        PointDerivatives { positions, by_pose, by_length: self.lengthening(&rotations), link_axes }
    }

    /// How the points move with the lengths, as in [`PointDerivatives::by_length`].
    #[must_use]
    pub fn by_length(&self, pose: &[f64]) -> Vec<f64> {
        self.lengthening(&self.rotations(pose))
    }

    /// Rotation of each link, world from link.
    fn rotations(&self, pose: &[f64]) -> Vec<Matrix> {
        self.tree.link_frames(pose).into_iter().map(|(rotation, _)| rotation).collect()
    }

    fn lengthening(&self, rotations: &[Matrix]) -> Vec<f64> {
        let count = length_names().len();
        let mut origins = vec![[0.0; 3]; self.tree.links().len() * count];
        let add = |to: &mut [[f64; 3]], rotation: &Matrix, growths: &[Growth]| {
            for Growth { length, by } in growths {
                to[*length].iter_mut().zip(apply(rotation, *by)).for_each(|(x, by)| *x += by);
            }
        };
        for (index, link) in self.tree.links().iter().enumerate() {
            let (above, own) = origins.split_at_mut(index * count);
            if let Some(parent) = link.parent {
                own[..count].copy_from_slice(&above[parent * count..][..count]);
                add(&mut own[..count], &rotations[parent], &self.links[index]);
            }
        }
        let mut out = vec![0.0; 3 * count * self.link_of.len()];
        let mut moved = vec![[0.0; 3]; count];
        for ((&link, growths), out) in self.link_of.iter().zip(&self.points).zip(out.chunks_exact_mut(3 * count)) {
            moved.copy_from_slice(&origins[link * count..][..count]);
            add(&mut moved, &rotations[link], growths);
            for (length, moved) in moved.iter().enumerate() {
                moved.iter().enumerate().for_each(|(a, x)| out[a * count + length] = *x);
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::h32;

    #[test]
    fn a_reshaped_body_is_a_body_of_those_sizes() {
        let proportions = Proportions::default();
        let tree = h32(&proportions);
        let points: Vec<usize> = (0..tree.points().len()).collect();
        let pose: Vec<f64> = (0..tree.dof()).map(|j| 0.1 * ((3 * j) % 7) as f64 - 0.2).collect();
        let longer: Vec<f64> = (0..length_names().len()).map(|k| 0.01 * k as f64 - 0.03).collect();
        let places: Vec<[f64; 3]> = points.iter().map(|&k| [0.001 * k as f64, -0.01, 0.002 * k as f64]).collect();
        let found = Neighbours::new(h32, &proportions, &points).reshaped(&longer, places.as_flattened()).at(&pose);
        let build = |sizes: &Proportions| h32(sizes).with_points_moved(&places);
        let expected = Neighbours::new(build, &lengthened(&proportions, &longer), &points).at(&pose);
        let agree = |found: &[f64], expected: &[f64]| {
            assert_eq!(found.len(), expected.len());
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9));
        };
        agree(&found.positions, &expected.positions);
        agree(&found.by_pose, &expected.by_pose);
        agree(&found.by_length, &expected.by_length);
        agree(&found.link_axes, &expected.link_axes);
    }

    #[test]
    fn a_body_of_fixed_sizes_does_not_change_with_them() {
        let proportions = Proportions::default();
        let found = Neighbours::new(|_| h32(&Proportions::default()), &proportions, &[0, 3]).at(&[0.1; 32]);
        assert!(found.by_length.iter().all(|x| *x == 0.0));
        assert_eq!(lengths(&lengthened(&proportions, &[-9.0])), {
            let mut expected = lengths(&proportions);
            expected[0] = 1e-3;
            expected
        });
    }
}
