//! First poses from points: exact where the points suffice, near where they do not, else `None`.

use sinew_body::fit::Target;
use sinew_body::initial::initial_pose;
use sinew_body::standard::{cf28, h32};
use sinew_body::{Axis, Joint, KinematicTree, Link, Plan, Point, Proportions, point_positions};
use sinew_core::lanes::Isa;

fn positions(tree: &KinematicTree, q: &[f64]) -> Vec<[f64; 3]> {
    let plan = Plan::with_all_points(tree);
    let mut p = vec![0.0; 3 * plan.points()];
    point_positions(&plan, Isa::baseline(), q, &mut p);
    p.chunks(3).map(|p| [p[0], p[1], p[2]]).collect()
}

fn targets(tree: &KinematicTree, q: &[f64]) -> Vec<Option<Target>> {
    positions(tree, q).into_iter().map(|position| Some(Target { position, weight: 1.0 })).collect()
}

/// Leaves out all points but the ones with these names.
fn only(tree: &KinematicTree, targets: &mut [Option<Target>], names: &[&str]) {
    for (target, point) in targets.iter_mut().zip(tree.points()) {
        *target = target.filter(|_| names.contains(&point.name.as_str()));
    }
}

/// Root, upper limbs and hinges anywhere; what a first pose leaves at 0 is 0.
fn pose(tree: &KinematicTree, heading: f64) -> Vec<f64> {
    let limb = |z: f64, y: f64, x: f64, bend: f64| [z, y, x, bend];
    let mut q = vec![0.0; tree.dof()];
    q[..6].copy_from_slice(&[0.4, -1.1, 0.9, heading, 0.3, -0.2]);
    for (upper, hinge, [z, y, x, bend]) in [
        ("l_upper_arm", "l_forearm", limb(0.4, 0.7, -0.5, 0.9)),
        ("r_upper_arm", "r_forearm", limb(-0.3, -0.8, 0.6, 1.6)),
        ("l_thigh", "l_shin", limb(0.2, 0.1, 0.7, -0.8)),
        ("r_thigh", "r_shin", limb(-0.1, -0.2, -0.4, -1.3)),
    ] {
        let first = tree.first_dof(tree.link_index(upper).unwrap());
        q[first..first + 3].copy_from_slice(&[z, y, x]);
        q[tree.first_dof(tree.link_index(hinge).unwrap())] = bend;
    }
    q
}

fn farthest(a: &[[f64; 3]], b: &[[f64; 3]]) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn root_limbs_and_hinges_are_found_exactly() {
    for tree in [cf28(&Proportions::default()), h32(&Proportions::default())] {
        for heading in [-3.0, -1.2, 0.0, 0.4, 2.1] {
            let truth = pose(&tree, heading);
            let found = initial_pose(&tree, &targets(&tree, &truth)).unwrap();
            for (j, (f, t)) in found.iter().zip(&truth).enumerate() {
                assert!((f - t).abs() < 1e-9, "heading {heading}, {}: {f} for {t}", tree.dof_names()[j]);
            }
        }
    }
}

/// Where a shoulder or hip is not seen, the trunk says where it is.
#[test]
fn a_limb_hangs_where_the_trunk_says() {
    let tree = cf28(&Proportions::default());
    let truth = pose(&tree, 0.7);
    let mut seen = targets(&tree, &truth);
    for name in ["LShoulder", "RHip"] {
        seen[tree.point_index(name).unwrap()] = None;
    }
    let found = initial_pose(&tree, &seen).unwrap();
    assert!(farthest(&positions(&tree, &found), &positions(&tree, &truth)) < 1e-9);
    // Without its end a limb stays at zero, and so do its angles.
    seen[tree.point_index("RWrist").unwrap()] = None;
    let found = initial_pose(&tree, &seen).unwrap();
    let first = tree.first_dof(tree.link_index("r_upper_arm").unwrap());
    assert_eq!(found[first..first + 4], [0.0; 4]);
    assert!((found[3] - 0.7).abs() < 1e-9);
}

/// Straight limbs have no plane: their hinges are at 0 and they turn as little about themselves as the trunk does.
#[test]
fn straight_limbs_are_straight() {
    let tree = cf28(&Proportions::default());
    let mut truth = pose(&tree, -0.9);
    for name in ["l_forearm", "r_forearm", "l_shin", "r_shin"] {
        truth[tree.first_dof(tree.link_index(name).unwrap())] = 0.0;
    }
    let found = initial_pose(&tree, &targets(&tree, &truth)).unwrap();
    assert!(farthest(&positions(&tree, &found), &positions(&tree, &truth)) < 1e-9);
    // Arms held out to the sides lie along the trunk's x axis, which then says nothing about their turn.
    let mut out = vec![0.0; tree.dof()];
    for (name, angle) in [("l_upper_arm", 1.0), ("r_upper_arm", -1.0)] {
        out[tree.first_dof(tree.link_index(name).unwrap()) + 1] = angle * std::f64::consts::FRAC_PI_2;
    }
    let found = initial_pose(&tree, &targets(&tree, &out)).unwrap();
    assert!(farthest(&positions(&tree, &found), &positions(&tree, &out)) < 1e-9);
    // The turn about the upper arm's own axis takes its x axis to where its y axis, forward, is the trunk's.
    let first = tree.first_dof(tree.link_index("l_upper_arm").unwrap());
    assert!((found[first + 1] - out[first + 1]).abs() < 1e-6, "{:?}", &found[first..first + 4]);
}

/// A limb that is nearly straight, on either side of where its plane counts.
#[test]
fn hinges_bend_to_their_natural_side() {
    let tree = cf28(&Proportions::default());
    for bend in [0.05, 0.15, 2.5] {
        let mut truth = pose(&tree, 0.2);
        for (name, sign) in [("l_forearm", 1.0), ("r_forearm", 1.0), ("l_shin", -1.0), ("r_shin", -1.0)] {
            truth[tree.first_dof(tree.link_index(name).unwrap())] = sign * bend;
        }
        let found = initial_pose(&tree, &targets(&tree, &truth)).unwrap();
        for name in ["l_forearm", "r_forearm", "l_shin", "r_shin"] {
            let j = tree.first_dof(tree.link_index(name).unwrap());
            assert!((found[j] - truth[j]).abs() < 1e-9, "{name}: {} for {}", found[j], truth[j]);
        }
        // The sine of the bend is the bound of what counts as a plane: 0.1.
        let exact = farthest(&positions(&tree, &found), &positions(&tree, &truth)) < 1e-9;
        assert_eq!(exact, bend > 0.1, "{bend}");
    }
}

/// Pitched by a quarter of a turn, heading and roll are one angle: heading takes it.
#[test]
fn a_body_lying_down_is_found() {
    let tree = cf28(&Proportions::default());
    let mut truth = vec![0.0; tree.dof()];
    truth[..6].copy_from_slice(&[1.0, 2.0, 0.3, 0.8, std::f64::consts::FRAC_PI_2, 0.0]);
    let found = initial_pose(&tree, &targets(&tree, &truth)).unwrap();
    assert!(farthest(&positions(&tree, &found), &positions(&tree, &truth)) < 1e-7);
    assert!((found[4] - truth[4]).abs() < 1e-7);
}

/// The trunk alone says where the root is, whatever the head and the limbs do; without a trunk every point counts.
#[test]
fn the_trunk_goes_before_all_points() {
    let tree = cf28(&Proportions::default());
    let truth = pose(&tree, 1.3);
    let mut trunk = targets(&tree, &truth);
    only(&tree, &mut trunk, &["LHip", "RHip", "Neck"]);
    let found = initial_pose(&tree, &trunk).unwrap();
    assert!(found[..6].iter().zip(&truth).all(|(f, t)| (f - t).abs() < 1e-9), "{:?}", &found[..6]);
    assert_eq!(found[6..], vec![0.0; 22]);
    let mut standing = vec![0.0; tree.dof()];
    standing[..6].copy_from_slice(&truth[..6]);
    let mut limbs = targets(&tree, &standing);
    only(&tree, &mut limbs, &["Nose", "LKnee", "RWrist", "Head"]);
    let found = initial_pose(&tree, &limbs).unwrap();
    assert!(farthest(&positions(&tree, &found), &positions(&tree, &standing)) < 1e-9);
}

#[test]
fn too_little_gives_no_pose() {
    let tree = cf28(&Proportions::default());
    let all = targets(&tree, &pose(&tree, 0.0));
    let with = |names: &[&str]| {
        let mut targets = all.clone();
        only(&tree, &mut targets, names);
        initial_pose(&tree, &targets)
    };
    assert!(with(&["LHip", "RHip", "Neck"]).is_some());
    assert_eq!(with(&["LHip", "RHip"]), None);
    // On one line.
    assert_eq!(with(&["LHip", "MidHip", "RHip"]), None);
    // A line of the trunk is no trunk; two points more are a body.
    assert!(with(&["LHip", "MidHip", "RHip", "LKnee", "RElbow"]).is_some());
    let mut more = all.clone();
    more.push(all[0]);
    assert_eq!(initial_pose(&tree, &more), None);
    let fixed = Link::new("root", None, [0.0; 3], vec![Joint::Translate(Axis::X)]);
    let point = |k: usize| Point { name: format!("{k}"), link: 0, offset: [k as f64, (k * k) as f64, 0.0] };
    let slider = KinematicTree::new(vec![fixed], (0..4).map(point).collect()).unwrap();
    assert_eq!(initial_pose(&slider, &targets(&slider, &[0.5])), None);
}

/// Errors of points bend a nearly straight knee forward: it starts a little beyond straight, and not on a thigh that is turned by half a turn.
#[test]
fn a_straight_knee_that_errors_bend_forward_stays_on_its_thigh() {
    let tree = h32(&Proportions::default());
    let mut truth = vec![0.0; tree.dof()];
    let hinge = tree.first_dof(tree.link_index("l_shin").unwrap());
    let turn = tree.first_dof(tree.link_index("l_thigh").unwrap());
    for bend in [-0.6, -0.2, 0.1, 0.2, 0.6] {
        truth[hinge] = bend;
        let found = initial_pose(&tree, &targets(&tree, &truth)).unwrap();
        assert!((found[hinge] - bend).abs() < 1e-6 && found[turn].abs() < 1e-6, "{bend}: {:?}", &found[turn..turn + 4]);
    }
    // So far no knee bends forward: the leg is turned round.
    truth[hinge] = 1.2;
    let found = initial_pose(&tree, &targets(&tree, &truth)).unwrap();
    assert!(found[hinge] < -1.1 && found[turn].abs() > 3.0, "{:?}", &found[turn..turn + 4]);
}
