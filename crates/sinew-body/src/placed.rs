//! Where the points of a body are, by name; for unit tests.

use crate::kinematics::{Plan, point_positions};
use crate::tree::KinematicTree;
use sinew_core::lanes::Isa;

/// From the name of a point to its place in metres, in the pose of these coordinates.
pub(crate) fn points(tree: KinematicTree, q: &[f64]) -> impl Fn(&str) -> [f64; 3] + use<> {
    let plan = Plan::with_all_points(&tree);
    let mut at = vec![0.0; 3 * plan.points()];
    point_positions(&plan, Isa::baseline(), q, &mut at);
    move |name| {
        let k = tree.point_index(name).expect("a point");
        [at[3 * k], at[3 * k + 1], at[3 * k + 2]]
    }
}

/// Whether two places are the same but for rounding.
pub(crate) fn near(a: [f64; 3], b: [f64; 3]) -> bool {
    a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12)
}
