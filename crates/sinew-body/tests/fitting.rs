//! Laws of fitting: a body is recovered from its own points, whatever its pose and size.

use proptest::prelude::*;
use sinew_body::fit::{Config, Target, fit_pose};
use sinew_body::initial::initial_pose;
use sinew_body::standard::{cf28, h32};
use sinew_body::{KinematicTree, Plan, Proportions, bundle, point_positions};
use sinew_core::lanes::Isa;

/// Ordinary poses: any place and heading, limbs within the reach of most people.
fn pose(tree: &KinematicTree) -> impl Strategy<Value = Vec<f64>> + use<> {
    let ranges: Vec<(f64, f64)> = tree
        .dof_names()
        .iter()
        .map(|name| match name.as_str() {
            "spine.tx" | "spine.ty" | "spine.tz" => (-3.0, 3.0),
            "spine.rz" => (-3.1, 3.1),
            "l_forearm.rx" | "r_forearm.rx" => (0.1, 2.0),
            "l_shin.rx" | "r_shin.rx" => (-1.8, -0.1),
            "l_upper_arm.rx" | "r_upper_arm.rx" | "l_thigh.rx" | "r_thigh.rx" => (-0.6, 1.2),
            "l_upper_arm.ry" => (-0.2, 1.0),
            "r_upper_arm.ry" => (-1.0, 0.2),
            _ => (-0.3, 0.3),
        })
        .collect();
    ranges.into_iter().map(|(low, high)| low..high).collect::<Vec<_>>()
}

fn targets(tree: &KinematicTree, q: &[f64]) -> Vec<Option<Target>> {
    let plan = Plan::with_all_points(tree);
    let mut p = vec![0.0; 3 * plan.points()];
    point_positions(&plan, Isa::best(), q, &mut p);
    p.chunks(3).map(|p| Some(Target { position: [p[0], p[1], p[2]], weight: 1.0 })).collect()
}

fn check(tree: &KinematicTree, q: &[f64]) -> Result<(), TestCaseError> {
    let targets = targets(tree, q);
    let start = initial_pose(tree, &targets).expect("all points are there");
    let found = fit_pose(&Plan::with_all_points(tree), &targets, &start, &Config { damping: 0.0, ..Config::default() });
    prop_assert!(found.rms_m < 1e-6, "{} m after {} steps", found.rms_m, found.steps);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// K15 for both bodies.
    #[test]
    fn fitting_recovers_the_points_of_cf28(q in pose(&cf28(&Proportions::default()))) {
        check(&cf28(&Proportions::default()), &q)?;
    }

    /// K15 for both bodies.
    #[test]
    fn fitting_recovers_the_points_of_h32(q in pose(&h32(&Proportions::default()))) {
        check(&h32(&Proportions::default()), &q)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]

    /// Limb lengths come back from points of moving bodies that are started with wrong ones.
    #[test]
    fn bundle_recovers_limb_lengths(poses in prop::collection::vec(pose(&h32(&Proportions::default())), 20), thigh in 0.38..0.48, forearm in 0.22..0.30) {
        let truth = Proportions { thigh, forearm, ..Proportions::default() };
        let frames: Vec<_> = poses.iter().map(|q| targets(&h32(&truth), q)).collect();
        let config = bundle::Config { rounds: 12, ..bundle::Config::default() };
        let found = bundle::refine(h32, &Proportions::default(), &frames, &config).proportions;
        prop_assert!((found.thigh - thigh).abs() < 3e-3, "thigh {} for {thigh}", found.thigh);
        prop_assert!((found.forearm - forearm).abs() < 3e-3, "forearm {} for {forearm}", found.forearm);
        prop_assert!((found.shin - truth.shin).abs() < 3e-3, "shin {}", found.shin);
    }
}
