//! Girths of a simulated person come back from masks.

use sinew::body::{KinematicTree, hppf24};
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::core::random::Stage;
use sinew::observe::Camera;
use sinew::observe::silhouettes::girth::{
    Girth, Sight, before_cameras, fit_girth, intersection_over_union, mask_overlap,
};
use sinew::observe::silhouettes::girth_with_pose::{fit_girth_and_poses, fit_poses};
use sinew_body::points::points_of_states;
use sinew_motion::damped_fit::{MotionFollowing, states};
use sinew_simulate::ring::{Ring, around};
use sinew_simulate::segmentation_noise::{Level, segmented};
use sinew_simulate::walker::{Gait, Walker, walker_states};

/// Largest error of a girth, as a share.
const BOUND: f64 = 0.05;
/// Frames of the first second, as many of the next are held out.
const FRAMES: usize = 6;

/// The body of a walker, four cameras and its states, six frames a second.
fn walk() -> (KinematicTree, Vec<Camera>, Vec<Vec<f64>>) {
    let walker = Walker::new(Gait { still_s: 0.0, duration_s: 2.4, ..Gait::default() });
    let points = points_of_states(&walker.body, &walker_states(&walker, FRAMES as f64));
    let tree = hppf24::tree(1.0);
    let states = states(&tree, &points, &MotionFollowing::default()).expect("hips");
    let cameras = around(&points, &Ring::SMALL_PICTURES).expect("a ring");
    (tree, cameras, states)
}

fn sights(girth: Girth, level: Option<Level>, seed: u64) -> (KinematicTree, Vec<Camera>, Vec<Sight>) {
    let (tree, cameras, states) = walk();
    let model = before_cameras(&tree, &girth.applied(&hppf24::flesh(1.0)), &cameras).expect("a body");
    let stage = Stage::new(seed, "masks");
    let sight = |(frame, state): (usize, &Vec<f64>)| {
        let masks = model.silhouettes(state).into_iter().enumerate().map(|(camera, mask)| {
            Some(match level {
                Some(level) => segmented(&mask, None, level, stage.round(camera).at_frame(frame as u32)),
                None => mask,
            })
        });
        Sight { state: state.clone(), silhouettes: masks.collect() }
    };
    let sights = states.iter().enumerate().map(sight).collect();
    (tree, cameras, sights)
}

/// The largest error of the three, as a share.
fn error(found: Girth, truth: Girth) -> f64 {
    let of = |girth: Girth| [girth.trunk, girth.arms, girth.legs];
    of(found).into_iter().zip(of(truth)).map(|(found, truth)| (found / truth - 1.0).abs()).fold(0.0, f64::max)
}

/// Trunk, arms and legs from 0.8 to 1.3, masks without errors and with usual ones, within 5 %; frames that were held out are matched better than without.
#[test]
fn girths_come_back_from_masks() {
    let girths = [[0.8, 0.8, 0.8], [1.3, 1.3, 1.3], [0.8, 1.3, 1.1], [1.2, 0.9, 0.8], [1.0, 1.0, 1.3]];
    for (seed, [trunk, arms, legs]) in girths.into_iter().enumerate() {
        let truth = Girth { trunk, arms, legs };
        for level in [None, Some(Level::Normal)] {
            let (tree, cameras, sights) = sights(truth, level, seed as u64);
            let (first, held_out) = sights.split_at(FRAMES);
            let flesh = hppf24::flesh(1.0);
            let found = fit_girth(&tree, &flesh, &cameras, first).expect("a body");
            assert!(error(found.girth, truth) < BOUND, "{found:?} for {truth:?}, {level:?}, bound {BOUND}");
            let iou = |girth: Girth| {
                let model = before_cameras(&tree, &girth.applied(&flesh), &cameras).expect("a body");
                intersection_over_union(held_out.iter().map(|sight| mask_overlap(&model, sight)).sum())
            };
            assert!(found.iou[1] > found.iou[0] && iou(found.girth) > iou(Girth::default()), "{found:?}");
        }
    }
}

/// The prior decides where no mask shows anything.
#[test]
fn without_masks_girths_stay() {
    let (tree, cameras, mut sights) = sights(Girth::default(), None, 1);
    sights.iter_mut().for_each(|sight| sight.silhouettes.fill(None));
    let found = fit_girth(&tree, &hppf24::flesh(1.0), &cameras, &sights).expect("a body");
    assert_eq!(found.girth, Girth::default());
}

/// The poses that a file of joints gives whose positions are off by some metres in each coordinate, independently in every frame.
fn roughly(tree: &KinematicTree, sights: &[Sight], error_m: f64, seed: u64) -> Vec<Sight> {
    let known: Vec<Vec<f64>> = sights.iter().map(|sight| sight.state.clone()).collect();
    let mut points = points_of_states(tree, &known);
    let mut errors = vec![Block([0.0; LANES]); (points.frames.len() * points.names.len() * 3).div_ceil(LANES)];
    Stage::new(seed, "errors of joints").whole().fill_normal(Isa::baseline(), &mut errors);
    let coordinates = points.frames.iter_mut().flatten().flatten();
    coordinates.zip(errors.iter().flat_map(|block| block.0)).for_each(|(x, error)| *x += error_m * error);
    let rough = states(tree, &points, &MotionFollowing::default()).expect("hips");
    sights.iter().zip(rough).map(|(sight, state)| Sight { state, ..sight.clone() }).collect()
}

/// Girths that come back from masks of a level and poses whose joints are some metres off: the largest errors, by poses and girths together and by girths in these poses alone.
fn worst_errors(level: Option<Level>, error_m: f64) -> [f64; 2] {
    let flesh = hppf24::flesh(1.0);
    let girths = [[0.8, 0.8, 0.8], [1.0, 1.0, 1.0], [1.3, 1.3, 1.3], [0.8, 1.3, 1.1], [1.2, 0.9, 0.8]];
    let mut worst = [0.0_f64; 2];
    for (seed, [trunk, arms, legs]) in girths.into_iter().enumerate() {
        let truth = Girth { trunk, arms, legs };
        let (tree, cameras, known) = sights(truth, level, seed as u64);
        let rough = roughly(&tree, &known, error_m, seed as u64);
        let (first, held_out) = rough.split_at(FRAMES);
        let joint = fit_girth_and_poses(&tree, &flesh, &cameras, first).expect("a body").girth;
        let in_these_poses = fit_girth(&tree, &flesh, &cameras, first).expect("a body").girth;
        for (worst, found) in worst.iter_mut().zip([joint, in_these_poses]) {
            *worst = worst.max(error(found, truth));
        }
        let iou = |girth: Girth| {
            let model = before_cameras(&tree, &girth.applied(&flesh), &cameras).expect("a body");
            let posed = fit_poses(&tree, &flesh, &cameras, held_out, girth).expect("a body");
            intersection_over_union(posed.iter().map(|sight| mask_overlap(&model, sight)).sum())
        };
        assert!(truth == Girth::default() || iou(joint) > iou(Girth::default()), "{truth:?}: {joint:?}");
    }
    worst
}

/// Trunk, arms and legs from 0.8 to 1.3 come back within 5 % where poses come from joints that are 1 cm off in each coordinate and masks have no errors. Frames that were held out are matched better where the girth is not the usual one.
#[test]
fn girths_come_back_where_poses_are_known_roughly() {
    let [joint, in_these_poses] = worst_errors(None, 0.01);
    assert!(joint < BOUND, "{joint}, in these poses {in_these_poses}");
}

/// Masks with usual errors and joints that are 2 cm off: girths are nearer than those that are fitted in these poses. [`BOUND`] is not reached there, and not asserted: arms are six pixels wide in these masks.
#[test]
fn girths_are_nearer_where_poses_follow_the_masks() {
    let [joint, in_these_poses] = worst_errors(Some(Level::Normal), 0.02);
    assert!(joint < in_these_poses, "{joint}, in these poses {in_these_poses}");
}
