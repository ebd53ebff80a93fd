//! Partitioned sampling on simulated masks: how near it stays to the person.

mod common;

use common::Trial;
use sinew::formats::trc;
use std::collections::BTreeMap;
use std::fs;

/// Joints of the limbs.
const JOINTS: [&str; 12] = [
    "RShoulder",
    "RElbow",
    "RWrist",
    "RHip",
    "RKnee",
    "RAnkle",
    "LShoulder",
    "LElbow",
    "LWrist",
    "LHip",
    "LKnee",
    "LAnkle",
];

/// Clean masks of a person who stands and then walks, two seconds. Stated before the run: 60 mm; product over parts had 107 to 125 mm there.
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
        "--method=partitioned",
        "--particles=200",
        "--min-ess=1",
        "--fps=15",
    ]);
    assert!(tracked.status.success(), "{}", trial.printed(&tracked));
    let positions = |name: &str| {
        let file = trc::read(name, &fs::read_to_string(trial.path(name)).unwrap()).unwrap();
        let path = |joint: &&'static str| {
            let marker = file.marker_index(joint).unwrap();
            let place = |frame| file.point_in_world(frame, marker).unwrap();
            (*joint, (0..file.frames.len()).map(place).collect::<Vec<_>>())
        };
        JOINTS.iter().map(path).collect::<BTreeMap<_, _>>()
    };
    let (truth, found) = (positions("rec/truth.trc"), positions("out/markers.trc"));
    let distances: Vec<f64> = JOINTS
        .iter()
        .flat_map(|joint| truth[joint].iter().zip(&found[joint]))
        .map(|(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt())
        .collect();
    assert_eq!(distances.len(), 30 * 12);
    let mean_mm = 1e3 * distances.iter().sum::<f64>() / distances.len() as f64;
    println!("{mean_mm:.1} mm");
    assert!(mean_mm < 60.0, "{mean_mm:.1} mm");
}
