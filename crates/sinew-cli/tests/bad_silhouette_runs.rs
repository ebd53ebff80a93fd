//! What the program says where masks, images and starts do not fit. A person who is lost leaves results that say so.

mod common;

use common::{Trial, files};
use sinew::formats::mask;
use sinew::observe::bit_image::BitImage;
use std::fs;

const SIZE: &str = "--size=96x72";
const FRAMES: usize = 12;

/// A recording `rec` of two cameras and twelve frames.
fn recorded() -> Trial {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    simulate(&trial, "-orec", SIZE);
    trial
}

fn simulate(trial: &Trial, out: &str, size: &str) {
    let arguments = ["simulate", out, size, "--duration=0.4", "--cameras=2", "--segmentation=clean", "--images=1"];
    let output = trial.run(&[&arguments[..], &["--no-progress"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
}

/// What tracking says; the first arguments may be replaced by `more`.
fn printed(trial: &Trial, more: &[&str]) -> String {
    let usual =
        ["--calibration=rec/Calib.toml", "--silhouettes=rec/masks", "--init=rec/truth.trc", "--method=annealed"];
    let small =
        ["--particles=16", "--layers=2", "--draws=2", "--raster=64", "--fps=30", "--no-progress", "-oout", "--force"];
    let mut arguments = vec!["track"];
    let replaced = |flag: &str| more.iter().any(|given| given.split('=').next() == flag.split('=').next());
    arguments.extend(usual.into_iter().filter(|flag| !replaced(flag)));
    arguments.extend(small);
    arguments.extend(more.iter().filter(|argument| argument.contains('=')));
    trial.printed(&trial.run(&arguments))
}

#[test]
fn what_does_not_fit_is_refused() {
    let trial = recorded();
    simulate(&trial, "-osmall", "--size=48x36");
    let check = |name: &str, more: &[&str]| insta::assert_snapshot!(name, printed(&trial, more));
    check("hmc", &["--method=hmc"]);
    check("no_start", &["--init"]);
    check("other_size", &["--silhouettes=small/masks"]);
    check("images_of_other_size", &["--images=small/images"]);
    check("init_keypoints_without_keypoints", &["--init=keypoints"]);
    let truth = fs::read_to_string(trial.path("rec/truth.trc")).unwrap();
    fs::write(trial.path("hipless.trc"), truth.replace("LHip", "LeftHip")).unwrap();
    check("points_that_are_needed", &["--init=hipless.trc"]);
    check("no_masks_there", &["--silhouettes=rec/keypoints"]);
}

/// Quality of each frame in `frames.csv`, and whether every number of the tables is finite.
fn qualities(trial: &Trial) -> Vec<String> {
    let text = |name: &str| fs::read_to_string(trial.path("out").join(name)).unwrap();
    assert!(["joints.csv", "angles.csv"].iter().all(|name| !text(name).contains("NaN") && !text(name).contains("inf")));
    text("frames.csv").lines().skip(1).map(|line| line.split(',').nth(3).unwrap().to_owned()).collect()
}

#[test]
fn views_that_are_missing_are_dropped_and_counted() {
    let trial = recorded();
    for frame in 3..6 {
        fs::remove_file(trial.path(&format!("rec/masks/C2_{frame:04}.png"))).unwrap();
    }
    insta::assert_snapshot!("missing_views", printed(&trial, &[]));
    let expected: Vec<&str> = (0..FRAMES).map(|frame| if (3..6).contains(&frame) { "1" } else { "2" }).collect();
    assert_eq!(qualities(&trial), expected);
    for camera in 1..3 {
        fs::remove_file(trial.path(&format!("rec/masks/C{camera}_0008.png"))).unwrap();
    }
    printed(&trial, &[]);
    assert_eq!(qualities(&trial)[8], "0");
}

/// Nobody in any mask: the motion model continues, frames are flagged, and warnings say so.
#[test]
fn a_person_who_leaves_all_views_is_flagged() {
    let trial = recorded();
    let mut empty = Vec::new();
    mask::write(&mut empty, &BitImage::new(96, 72)).unwrap();
    let masks: Vec<String> = files(&trial.path("rec/masks")).into_keys().collect();
    for name in
        masks.iter().filter(|name| name.as_str() >= "C1_0007" && !name.starts_with("C2") || name.as_str() >= "C2_0007")
    {
        fs::write(trial.path("rec/masks").join(name), &empty).unwrap();
    }
    insta::assert_snapshot!("nobody_in_view", printed(&trial, &[]));
    let expected: Vec<&str> = (0..FRAMES).map(|frame| if frame < 7 { "2" } else { "0" }).collect();
    assert_eq!(qualities(&trial), expected);
}
