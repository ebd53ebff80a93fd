//! Laws of fitting: a body is recovered from its own points, whatever its pose and size.

use proptest::prelude::*;
use sinew_body::fit::{Config, Orientation, Target, fit_oriented, fit_pose};
use sinew_body::initial::initial_pose;
use sinew_body::standard::{cf28, h32};
use sinew_body::{KinematicTree, Plan, Proportions, bundle, point_positions};
use sinew_core::lanes::Isa;

/// Ordinary poses: any place and heading, limbs within the reach of most people.
fn pose(tree: &KinematicTree) -> impl Strategy<Value = Vec<f64>> + use<> {
    let ranges: Vec<(f64, f64)> = tree
        .dof_names()
        .iter()
        .enumerate()
        .map(|(dof, name)| match name.as_str() {
            _ if dof < 3 => (-3.0, 3.0),
            _ if dof == 3 => (-3.1, 3.1),
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

    /// Fitting a body to its own points recovers them (K15).
    #[test]
    fn fitting_recovers_the_points_of_cf28(q in pose(&cf28(&Proportions::default()))) {
        check(&cf28(&Proportions::default()), &q)?;
    }

    /// Fitting a body to its own points recovers them (K15).
    #[test]
    fn fitting_recovers_the_points_of_h32(q in pose(&h32(&Proportions::default()))) {
        check(&h32(&Proportions::default()), &q)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Orientations of all links and the place of one point give the pose back, from the upright one at its heading.
    #[test]
    fn orientations_of_links_and_one_point_give_the_pose(q in pose(&h32(&Proportions::default()))) {
        let tree = h32(&Proportions::default());
        let orientations: Vec<Orientation> = (0..).zip(tree.link_frames(&q))
            .map(|(link, (rotation, _))| Orientation { link, rotation, weight: 0.1 })
            .collect();
        let hip = tree.point_index("MidHip").expect("a point");
        let seen: Vec<_> = (0..).zip(targets(&tree, &q)).map(|(k, t)| t.filter(|_| k == hip)).collect();
        let mut start = vec![0.0; tree.dof()];
        start[3] = q[3];
        let found = fit_oriented(&tree, &seen, &orientations, &start, &Config { damping: 0.0, ..Config::default() });
        let angle = found.rms_rad.expect("orientations");
        prop_assert!(angle < 1e-6 && found.rms_m < 1e-6, "{angle} rad, {} m, {} steps", found.rms_m, found.steps);
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

/// Twelve frames of a moving body, noise-free.
fn moving(tree: &KinematicTree) -> Vec<Vec<f64>> {
    let at = |f: usize| (0..tree.dof()).map(move |j| 0.35 * (0.5 * f as f64 + 1.7 * j as f64).sin()).collect();
    (0..12).map(at).collect()
}

/// Sizes and poses are solved for together: one round leaves a fraction of the error, and eight leave nothing.
#[test]
fn rounds_of_sizes_converge() {
    let truth = Proportions { thigh: 0.46, upper_arm: 0.28, nose: [0.0, 0.12, 0.11], ..Proportions::default() };
    let frames: Vec<_> = moving(&h32(&truth)).iter().map(|q| targets(&h32(&truth), q)).collect();
    let off = |rounds: usize| {
        let config = bundle::Config { rounds, sigma_m: 1e-3, change_sd: 1e3, length_sd_m: 10.0, offset_sd_m: 10.0 };
        let found = bundle::refine(h32, &Proportions::default(), &frames, &config);
        assert!(found.poses.iter().all(Option::is_some) && found.poses.len() == frames.len());
        let p = found.proportions;
        // What the nose's distance from the neck leaves open, a nod of the head can take.
        [p.thigh - 0.46, p.upper_arm - 0.28, p.nose[1].hypot(p.nose[2]) - 0.12_f64.hypot(0.11)].map(f64::abs)
    };
    assert!(
        off(0)
            .iter()
            .zip([0.03, 0.02, 0.12_f64.hypot(0.11) - 0.10_f64.hypot(0.12)])
            .all(|(off, x)| (off - x).abs() < 1e-12)
    );
    assert!(off(1).iter().all(|x| *x < 4e-3), "{:?}", off(1));
    assert!(off(8).iter().all(|x| *x < 1e-5), "{:?}", off(8));
}

/// The prior holds what it is made to hold, and what nothing measures stays.
#[test]
fn the_prior_of_the_sizes_holds_them() {
    let truth = Proportions { thigh: 0.46, nose: [0.0, 0.12, 0.11], ..Proportions::default() };
    let frames: Vec<_> = moving(&h32(&truth)).iter().map(|q| targets(&h32(&truth), q)).collect();
    let refined = |config: bundle::Config| bundle::refine(h32, &Proportions::default(), &frames, &config).proportions;
    let stiff = refined(bundle::Config { length_sd_m: 1e-7, ..bundle::Config::default() });
    assert!((stiff.thigh - 0.43).abs() < 1e-4 && (stiff.nose[1] - 0.12).abs() < 5e-3, "{stiff:?}");
    let stiff = refined(bundle::Config { offset_sd_m: 1e-7, ..bundle::Config::default() });
    assert!((stiff.thigh - 0.46).abs() < 5e-3 && (stiff.nose[1] - 0.10).abs() < 1e-4, "{stiff:?}");
    let unseen = bundle::refine(h32, &truth, &[vec![None; frames[0].len()]], &bundle::Config::default());
    assert_eq!((unseen.proportions, unseen.poses), (truth, vec![None]));
}

/// Largest distance of a pose's points from their targets along an axis, metres.
fn off(tree: &KinematicTree, pose: &[f64], to: &[Option<Target>]) -> f64 {
    let distance = |(a, b): (&Option<Target>, &Option<Target>)| {
        let (a, b) = (a.unwrap().position, b.unwrap().position);
        (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max)
    };
    targets(tree, pose).iter().zip(to).map(distance).fold(0.0, f64::max)
}

/// A body that turns and turns. Its root turns with it, and never back by a whole turn; how much of what lies between hips and shoulders is the spine's and how much the girdle's no point shows.
#[test]
fn poses_continue_from_frame_to_frame() {
    let tree = h32(&Proportions::default());
    let config = Config { damping: 1e-6, ..Config::default() };
    let turned = |heading: f64| {
        let mut q = vec![0.1; tree.dof()];
        q[3] = heading;
        q
    };
    let mut frames: Vec<_> = (0..26).map(|f| targets(&tree, &turned(0.5 * f as f64))).collect();
    frames[7] = vec![None; frames[7].len()];
    let poses = bundle::fit_poses(&tree, &frames, &[], &config);
    assert!(poses[7].is_none() && poses.len() == 26);
    for (pose, targets) in poses.iter().zip(&frames) {
        assert!(pose.as_ref().is_none_or(|pose| off(&tree, pose, targets) < 1e-3));
    }
    let headings: Vec<f64> = poses.iter().flatten().map(|pose| pose[3]).collect();
    assert!(headings.windows(2).all(|pair| (0.2..1.1).contains(&(pair[1] - pair[0]))), "{headings:?}");
    // About-face: the pose before is no start, and another is looked for, within half a turn.
    let sitting = |heading: f64| {
        let mut q = turned(heading);
        let bends = [
            ("l_upper_arm.rx", 1.4),
            ("r_upper_arm.rx", 1.4),
            ("l_thigh.rx", 1.4),
            ("r_thigh.rx", 1.4),
            ("l_shin.rx", -1.4),
            ("r_shin.rx", -1.4),
        ];
        for (name, bend) in bends {
            q[tree.dof_names().iter().position(|n| n == name).unwrap()] = bend;
        }
        targets(&tree, &q)
    };
    let about = [sitting(3.0), sitting(3.0 + std::f64::consts::PI)];
    let poses = bundle::fit_poses(&tree, &about, &[], &config);
    for (pose, targets) in poses.iter().zip(&about) {
        assert!(off(&tree, pose.as_ref().unwrap(), targets) < 0.02, "{}", off(&tree, pose.as_ref().unwrap(), targets));
    }
    // Starts that are given are taken: without steps they are the answer.
    let starts = vec![Some(turned(0.01)), Some(turned(0.49))];
    assert_eq!(bundle::fit_poses(&tree, &frames[..2], &starts, &Config { steps: 0, ..config }), starts);
}
