//! Methods on clean simulated masks: how near they stay to the person, two seconds who stands and then walks.

use crate::common::{Trial, limb_error_mm};

/// Tracks by masks with some settings; what was printed, and the mean error of the limb joints, millimetres.
fn tracked(settings: &[&str]) -> (String, f64) {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let simulated = trial.run(&[
        "simulate",
        "--no-progress",
        "-orec",
        "--duration=2",
        "--fps=15",
        "--segmentation=clean",
        "--images=none",
    ]);
    assert!(simulated.status.success(), "{}", trial.printed(&simulated));
    let masks = ["--calibration=rec/Calib.toml", "--silhouettes=rec/masks", "--init=rec/truth.trc", "--fps=15"];
    let tracked = trial.run(&[&["track", "--no-progress", "-oout"], &masks[..], settings].concat());
    let printed = trial.printed(&tracked);
    assert!(tracked.status.success(), "{printed}");
    let mean_mm = limb_error_mm(&trial, "rec/truth.trc", "out/markers.trc");
    println!("{mean_mm:.1} mm");
    (printed, mean_mm)
}

/// Stated before the run: 60 mm; product over parts had 107 to 125 mm there.
#[test]
fn partitioned_sampling_stays_near() {
    let (_, mean_mm) = tracked(&["--method=partitioned", "--particles=200", "--min-ess=1"]);
    assert!(mean_mm < 60.0, "{mean_mm:.1} mm");
}

/// The body of its paper, without a motion model. Stated before the run: 120 mm, where the product over parts had 107 to 125 mm in partitioned sampling.
#[test]
fn hppf_without_a_motion_model_stays_near_and_says_what_it_lacks() {
    let (printed, mean_mm) = tracked(&["--method=hppf", "--body=hppf24"]);
    for said in ["`hppf` is a search", "parts of the body walk at random, without action primitives"] {
        assert!(printed.contains(said), "{printed}");
    }
    assert!(mean_mm < 120.0, "{mean_mm:.1} mm");
}
