//! Girths of a simulated person come back from masks.

use sinew::body::{KinematicTree, hppf24};
use sinew::core::random::Stage;
use sinew::observe::Camera;
use sinew::observe::girth::{Girth, Sight, before_cameras, fit_girth, intersection_over_union, mask_overlap};
use sinew_motion::damped_fit::{MotionFollowing, states};
use sinew_motion::points::points_of_states;
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
            let of = |girth: Girth| [girth.trunk, girth.arms, girth.legs];
            for (found, truth) in of(found.girth).into_iter().zip(of(truth)) {
                assert!((found / truth - 1.0).abs() < BOUND, "{found} for {truth}, {level:?}, bound {BOUND}");
            }
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
