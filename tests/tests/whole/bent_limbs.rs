//! Limbs bend the way that joints do, where a straight limb shows nothing of how it is turned about itself.

use sinew::body::KinematicTree;
use sinew::body::motion_ranges::motion_ranges;
use sinew::config::settings::Settings;
use sinew::core::random::Stage;
use sinew::input::in_memory::InMemory;
use sinew::input::source::FrameSource as _;
use sinew::results::estimate::FrameEstimate;
use sinew::track::Pipeline;
use sinew::tracking::posterior::Posterior;
use sinew_simulate::adult;
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::evaluation::{run, set_up};

/// Somebody who stands with straight arms for the first second, and then walks.
fn walk(seed: u64) -> InMemory {
    let script = Script {
        duration_s: 9.0,
        proportions: adult::drawn(&Stage::new(seed, "walker")),
        calibration: CalibrationError::USUAL,
        ..Script::default()
    };
    let SyntheticRecording { cameras, layout, keypoints, .. } = SyntheticRecording::new(&script, seed).unwrap();
    InMemory { cameras, layout, keypoints }
}

/// Coordinates that are beyond the ranges of their joints by more than 20°.
fn beyond(tree: &KinematicTree, state: &[f64]) -> Vec<(String, f64)> {
    let all = tree.dof_names().into_iter().zip(motion_ranges(tree)).zip(state);
    let excess = |((name, range), x): ((String, Option<[f64; 2]>), &f64)| {
        let [low, high] = range?;
        let excess = (low - x).max(x - high).to_degrees();
        (excess > 20.0).then_some((name, excess))
    };
    all.filter_map(excess).collect()
}

/// Without limits both elbows bend backward.
#[test]
fn elbows_bend_forward_after_hanging_straight() {
    let mut source = walk(3003);
    let found = run(&mut source, 30..90, 30..90, &Settings::default(), None).unwrap();
    let names = found.tree.dof_names();
    for name in ["r_forearm.rx", "l_forearm.rx"] {
        let place = names.iter().position(|known| known == name).unwrap();
        let bends: Vec<f64> = found.filtered[30..].iter().map(|frame| frame.mean_state[place].to_degrees()).collect();
        assert!(bends.iter().all(|bend| *bend > 0.0), "{name}: {bends:.0?}");
    }
}

/// With the set-up of other frames, a run begins at a pose of its own in its first frame.
#[test]
fn a_run_with_a_given_set_up_begins_within_the_limits_of_joints() {
    let settings = Settings { setup_is_given: true, ..Settings::default() };
    let mut source = walk(3006);
    let setup = set_up(&mut source, 210..270, &settings, |_| ()).unwrap();
    let (tree, cameras, layout) = (setup.tree(), source.cameras().to_vec(), source.layout().clone());
    for first in (30..210).step_by(6) {
        let mut pipeline = Pipeline::new(&setup, &tree, &cameras, &layout, settings.clone()).unwrap();
        let check = |estimate: FrameEstimate, _: &Posterior<'_>| {
            let odd = beyond(&tree, &estimate.mean_state);
            assert!(odd.is_empty(), "frame {first}: {odd:.0?}");
            Ok(())
        };
        pipeline.track(&mut source, first..first + 1, check).unwrap();
    }
}
