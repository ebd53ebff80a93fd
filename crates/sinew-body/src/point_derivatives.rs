//! How the points of a body move with its pose, its lengths, and their own places on their links.
//!
//! At fixed angles the points of the standard bodies are linear in every length and in every place, so differences are derivatives.

use crate::kinematics::{Plan, point_jacobian, point_positions};
use crate::sizes::SIZES;
use crate::standard::Proportions;
use crate::tree::KinematicTree;
use sinew_core::lanes::Isa;

const ISA: Isa = Isa::baseline();

/// Difference to the neighbours, metres.
const DIFFERENCE_M: f64 = 1e-3;

/// A body and its neighbours: with each length a little longer, with all points a little farther along an axis of their links.
#[derive(Clone, Debug)]
pub struct Neighbours {
    plan: Plan,
    longer: Vec<Plan>,
    moved: Vec<Plan>,
}

/// Points of a body in a pose, K of them, and their derivatives; three numbers a point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointDerivatives {
    /// Positions in the world, metres.
    pub positions: Vec<f64>,
    /// By the degrees of freedom: row `3 k + a`, dof columns.
    pub by_pose: Vec<f64>,
    /// By each length.
    pub by_length: Vec<Vec<f64>>,
    /// Axes x, y, z of each point's link in the world.
    pub link_axes: Vec<Vec<f64>>,
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

impl Neighbours {
    /// Neighbours of the body that `build` makes, for some of its points (their indices in the body). A body whose sizes are fixed has `build` ignore them, and derivatives of 0.
    #[must_use]
    pub fn new(build: impl Fn(&Proportions) -> KinematicTree, proportions: &Proportions, points: &[usize]) -> Self {
        let tree = build(proportions);
        let names = length_names();
        let longer = (0..names.len()).map(|length| {
            let by: Vec<f64> = (0..names.len()).map(|k| if k == length { DIFFERENCE_M } else { 0.0 }).collect();
            Plan::new(&build(&lengthened(proportions, &by)), points)
        });
        let moved = (0..3).map(|axis| {
            let mut places = vec![[0.0; 3]; tree.points().len()];
            places.iter_mut().for_each(|place| place[axis] = DIFFERENCE_M);
            Plan::new(&tree.with_points_moved(&places), points)
        });
        Self { plan: Plan::new(&tree, points), longer: longer.collect(), moved: moved.collect() }
    }

    /// Points and derivatives in a pose.
    #[must_use]
    pub fn at(&self, pose: &[f64]) -> PointDerivatives {
        let count = 3 * self.plan.points();
        let (mut positions, mut by_pose) = (vec![0.0; count], vec![0.0; count * self.plan.dof()]);
        point_jacobian(&self.plan, ISA, pose, &mut positions, &mut by_pose);
        let difference = |plan: &Plan| {
            let mut out = vec![0.0; count];
            point_positions(plan, ISA, pose, &mut out);
            out.iter_mut().zip(&positions).for_each(|(x, p)| *x = (*x - p) / DIFFERENCE_M);
            out
        };
        let by_length = self.longer.iter().map(difference).collect();
        let link_axes = self.moved.iter().map(difference).collect();
        PointDerivatives { positions, by_pose, by_length, link_axes }
    }
}

impl PointDerivatives {
    /// Moves the points as longer lengths and other places on their links do (metres; three numbers a point); derivatives by the pose stay.
    pub fn reshape(&mut self, longer: &[f64], places: &[f64]) {
        for (moved, by) in self.by_length.iter().zip(longer) {
            self.positions.iter_mut().zip(moved).for_each(|(x, moved)| *x += by * moved);
        }
        for (axis, along) in self.link_axes.iter().enumerate() {
            for (k, place) in places.chunks_exact(3).enumerate() {
                (0..3).for_each(|a| self.positions[3 * k + a] += place[axis] * along[3 * k + a]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::h32;

    #[test]
    fn a_reshaped_body_has_its_points_where_a_body_of_those_sizes_has_them() {
        let proportions = Proportions::default();
        let tree = h32(&proportions);
        let points: Vec<usize> = (0..tree.points().len()).collect();
        let pose: Vec<f64> = (0..tree.dof()).map(|j| 0.1 * ((3 * j) % 7) as f64 - 0.2).collect();
        let mut found = Neighbours::new(h32, &proportions, &points).at(&pose);
        let longer: Vec<f64> = (0..length_names().len()).map(|k| 0.01 * k as f64 - 0.03).collect();
        let places: Vec<[f64; 3]> = points.iter().map(|&k| [0.001 * k as f64, -0.01, 0.002 * k as f64]).collect();
        found.reshape(&longer, places.as_flattened());
        let other = h32(&lengthened(&proportions, &longer)).with_points_moved(&places);
        let mut expected = vec![0.0; 3 * points.len()];
        point_positions(&Plan::new(&other, &points), ISA, &pose, &mut expected);
        assert!(found.positions.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-9));
    }

    #[test]
    fn a_body_of_fixed_sizes_does_not_change_with_them() {
        let proportions = Proportions::default();
        let found = Neighbours::new(|_| h32(&Proportions::default()), &proportions, &[0, 3]).at(&[0.1; 32]);
        assert!(found.by_length.iter().flatten().all(|x| *x == 0.0));
        assert_eq!(lengths(&lengthened(&proportions, &[-9.0])), {
            let mut expected = lengths(&proportions);
            expected[0] = 1e-3;
            expected
        });
    }
}
