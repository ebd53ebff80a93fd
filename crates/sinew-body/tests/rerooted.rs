//! H32 beside CF28: the same poses under another root, and the one direction that no point shows.

use nalgebra::Rotation3;
use proptest::prelude::*;
use sinew_body::standard::{cf28, h32};
use sinew_body::{KinematicTree, Plan, Proportions, point_positions};
use sinew_core::lanes::Isa;

fn points(tree: &KinematicTree, q: &[f64]) -> Vec<f64> {
    let plan = Plan::with_all_points(tree);
    let mut positions = vec![0.0; 3 * plan.points()];
    point_positions(&plan, Isa::best(), q, &mut positions);
    positions
}

/// R_Z(z) R_Y(y) R_X(x).
fn zyx(z: f64, y: f64, x: f64) -> Rotation3<f64> {
    Rotation3::from_euler_angles(x, y, z)
}

proptest! {
    /// The pelvis of CF28 is turned from the spine by R_Z(a) R_Y(b); the spine of H32 from the pelvis by R_Y(−b) R_Z(−a).
    #[test]
    fn h32_takes_every_pose_of_cf28(q in prop::collection::vec(-1.2..1.2f64, 28)) {
        let (from, to) = (cf28(&Proportions::default()), h32(&Proportions::default()));
        let pelvis = zyx(q[3], q[4], q[5]) * zyx(q[18], q[19], 0.0);
        let (x, y, z) = pelvis.euler_angles();
        let same = [&q[..3], &[z, y, x, -q[19], -q[18]], &q[6..18], &q[20..28], &[0.0; 4]].concat();
        let (at, found) = (points(&from, &q), points(&to, &same));
        for (k, point) in from.points().iter().enumerate() {
            let Some(other) = to.point_index(&point.name) else { continue };
            for a in 0..3 {
                prop_assert!((at[3 * k + a] - found[3 * other + a]).abs() < 1e-9, "{}", point.name);
            }
        }
    }

    /// A turn of the spine about itself that girdle and head undo, from any pose, by any angle: a straight line of states.
    #[test]
    fn no_point_shows_how_far_the_spine_is_turned_about_itself(mut q in prop::collection::vec(-3.0..3.0f64, 32), turn in -3.0..3.0f64) {
        let tree = h32(&Proportions::default());
        let before = points(&tree, &q);
        for (name, by) in [("spine.rz", turn), ("girdle.rz", -turn), ("head.rz", -turn)] {
            let dof = tree.dof_names().iter().position(|known| known == name).expect("a degree of freedom of H32");
            q[dof] += by;
        }
        prop_assert!(points(&tree, &q).iter().zip(before).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}
