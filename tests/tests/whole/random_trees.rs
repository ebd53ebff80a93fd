//! The backward sweep of any tree gives the gradient of what is seen of it (K4).
//! Trees come from the strategies of the kit.

use proptest::prelude::*;
use sinew::body::{Axis, Joint, KinematicTree, Link, Plan, Point};
use sinew::core::density::GradLogDensity;
use sinew::core::lanes::Isa;
use sinew::observe::ObservationModel;
use sinew_invariance::{Differences, gradient, strategies};
use sinew_markers::MarkerModel;
use std::sync::Arc;

/// The nearest axis of the coordinate frame: joints here turn about those.
fn nearest(axis: [f64; 3]) -> Axis {
    let [x, y, z] = axis.map(f64::abs);
    if x >= y && x >= z {
        Axis::X
    } else if y >= z {
        Axis::Y
    } else {
        Axis::Z
    }
}

/// A body with a point on every link, free to move at its root.
fn body(tree: &strategies::Tree) -> KinematicTree {
    let links =
        tree.parents.iter().zip(&tree.offsets).zip(&tree.axes).enumerate().map(|(i, ((parent, offset), axes))| {
            let moves = if i == 0 { vec![Joint::Translate(Axis::X), Joint::Translate(Axis::Z)] } else { vec![] };
            let turns = axes.iter().map(|&axis| Joint::Rotate(nearest(axis)));
            Link::new(format!("link {i}"), *parent, *offset, moves.into_iter().chain(turns).collect())
        });
    let points =
        (0..tree.parents.len()).map(|link| Point { name: format!("point {link}"), link, offset: [0.1, -0.05, 0.2] });
    KinematicTree::new(links.collect(), points.collect()).expect("parents come first")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn gradients_of_any_tree_agree_with_differences(tree in strategies::trees(1..=10), turn in -1.0..1.0_f64) {
        let body = body(&tree);
        let plan = Arc::new(Plan::with_all_points(&body));
        let model = MarkerModel { plan, centre: [0.0, -12.0, 0.0], sigma: 0.1, isa: Isa::best() };
        let seen: Vec<_> = (0..body.points().len()).map(|k| Some([0.03 * k as f64, 0.1 * turn])).collect();
        let density = model.bind(&seen);
        let pose: Vec<f64> = (0..body.dof()).map(|j| turn * (1.3 * j as f64).cos()).collect();
        let report = gradient(&Differences::default(), |x, g| density.log_density_grad(x, g), &[pose]);
        prop_assert!(report.holds(), "{report}");
    }
}
