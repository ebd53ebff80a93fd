//! Limbs bend the way that joints do after hanging straight, where nothing shows how they are turned.

use sinew::config::settings::Settings;
use sinew::core::random::Stage;
use sinew::input::in_memory::InMemory;
use sinew_simulate::adult;
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::evaluation::{Run, run};

/// Somebody who stands with straight arms for the first second, and then walks.
fn walk(seed: u64, script: Script) -> InMemory {
    let script = Script { proportions: adult::drawn(&Stage::new(seed, "walker")), ..script };
    let SyntheticRecording { cameras, layout, keypoints, .. } = SyntheticRecording::new(&script, seed).unwrap();
    InMemory { cameras, layout, keypoints }
}

/// Bends of both elbows in frames that were tracked, degrees.
fn elbows(found: &Run) -> Vec<f64> {
    let names = found.tree.dof_names();
    let places = (0..names.len()).filter(|&place| names[place].ends_with("_forearm.rx")).collect::<Vec<_>>();
    let frames = found.filtered.iter();
    frames.flat_map(|frame| places.iter().map(|&place| frame.mean_state[place].to_degrees())).collect()
}

/// Without limits of elbows the right one bends backward, by 60 and 51°.
#[test]
fn elbows_bend_forward_after_hanging_straight() {
    for seed in [3013, 3014] {
        let script = Script { duration_s: 271.0 / 30.0, calibration: CalibrationError::USUAL, ..Script::default() };
        let found = run(&mut walk(seed, script), 30..90, 30..90, &Settings::default(), None).unwrap();
        let bends = elbows(&found).split_off(60);
        assert!(bends.iter().all(|bend| *bend > 0.0), "seed {seed}: {bends:.0?}");
    }
}

/// Chains that all turned an arm the wrong way while it hung straight do not come back by themselves: without a half turn the elbow of the first bends backward by 40, of the second by 38°.
#[test]
fn an_arm_that_turned_the_wrong_way_turns_back() {
    for seed in [3102, 3115] {
        let settings = Settings { seed, ..Settings::default() };
        let found = run(&mut walk(seed, Script::default()), 0..120, 0..120, &settings, None).unwrap();
        let bends = elbows(&found);
        assert!(bends.iter().all(|bend| *bend > -20.0), "seed {seed}: {bends:.0?}");
        assert!(bends[120..].iter().all(|bend| *bend > -5.0), "seed {seed}: {bends:.0?}");
    }
}
