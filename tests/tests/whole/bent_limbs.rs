//! Limbs bend the way that joints do after hanging straight, where nothing shows how they are turned.

use sinew::config::settings::Settings;
use sinew::core::random::Stage;
use sinew::input::in_memory::InMemory;
use sinew_simulate::adult;
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::evaluation::run;

/// Somebody who stands with straight arms for the first second, and then walks.
fn walk(seed: u64) -> InMemory {
    let script = Script {
        duration_s: 271.0 / 30.0,
        proportions: adult::drawn(&Stage::new(seed, "walker")),
        calibration: CalibrationError::USUAL,
        ..Script::default()
    };
    let SyntheticRecording { cameras, layout, keypoints, .. } = SyntheticRecording::new(&script, seed).unwrap();
    InMemory { cameras, layout, keypoints }
}

/// Without limits of elbows the right one bends backward, by 60 and 51°.
#[test]
fn elbows_bend_forward_after_hanging_straight() {
    for seed in [3013, 3014] {
        let mut source = walk(seed);
        let found = run(&mut source, 30..90, 30..90, &Settings::default(), None).unwrap();
        let names = found.tree.dof_names();
        for name in ["r_forearm.rx", "l_forearm.rx"] {
            let place = names.iter().position(|known| known == name).unwrap();
            let later = found.filtered[30..].iter();
            let bends: Vec<f64> = later.map(|frame| frame.mean_state[place].to_degrees()).collect();
            assert!(bends.iter().all(|bend| *bend > 0.0), "seed {seed}, {name}: {bends:.0?}");
        }
    }
}
