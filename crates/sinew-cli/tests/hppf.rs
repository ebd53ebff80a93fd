//! The hierarchical partitioned particle filter on simulated masks, with the body of its paper.

mod common;

use common::Trial;

/// Clean masks of a person who stands and then walks, two seconds, without a motion model. Stated before the run: 120 mm, where the product over parts had 107 to 125 mm in partitioned sampling.
#[test]
fn limbs_stay_with_clean_masks() {
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
    let tracked = trial.run(&[
        "track",
        "--no-progress",
        "-oout",
        "--calibration=rec/Calib.toml",
        "--silhouettes=rec/masks",
        "--init=rec/truth.trc",
        "--method=hppf",
        "--body=hppf24",
        "--fps=15",
    ]);
    let printed = trial.printed(&tracked);
    assert!(tracked.status.success(), "{printed}");
    for said in ["`hppf` is a search", "parts of the body walk at random, without action primitives"] {
        assert!(printed.contains(said), "{printed}");
    }
    let mean_mm = common::limb_error_mm(&trial, "rec/truth.trc", "out/markers.trc");
    println!("{mean_mm:.1} mm");
    assert!(mean_mm < 120.0, "{mean_mm:.1} mm");
}
