//! What the program says where masks, images and starts do not fit. A person who is lost leaves results that say so.

use crate::common::{Files, Trial, files, made_once};
use sinew::formats::{mask, picture};
use sinew::observe::silhouettes::bit_image::BitImage;
use std::fs;
use std::process::Output;
use std::sync::OnceLock;

const SIZE: &str = "--size=96x72";
const FRAMES: usize = 12;

/// A recording `rec` of two cameras and twelve frames.
fn recorded() -> Trial {
    static RECORDED: OnceLock<Files> = OnceLock::new();
    made_once(&RECORDED, || {
        let trial = Trial { folder: tempfile::tempdir().unwrap() };
        simulate(&trial, "-orec", SIZE);
        trial
    })
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

/// Tracks the masks by parts of the body, whose colours are compared where there are images.
fn by_parts(trial: &Trial, more: &[&str]) -> Output {
    let usual =
        ["track", "--calibration=rec/Calib.toml", "--silhouettes=rec/masks", "--init=rec/truth.trc", "--method=hppf"];
    let small = ["--particles=16", "--draws=2", "--raster=64", "--min-ess=0", "--no-progress", "--force"];
    let rate: &[&str] = if more.iter().any(|given| given.starts_with("--fps")) { &[] } else { &["--fps=30"] };
    trial.run(&[&usual[..], &small, rate, more].concat())
}

/// A recording with a run in `colours`, whose set-up knows the person's colours.
fn coloured() -> Trial {
    static COLOURED: OnceLock<Files> = OnceLock::new();
    made_once(&COLOURED, || {
        let trial = recorded();
        let output = by_parts(&trial, &["--images=rec/images", "-ocolours"]);
        assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
        trial
    })
}

/// The row of the answer about colours.
fn row_of_colours(output: &Output) -> String {
    let answer = String::from_utf8_lossy(&output.stdout);
    answer.lines().find(|line| line.starts_with("colours ")).map(str::to_owned).unwrap_or_default()
}

#[test]
fn colours_that_are_missing_on_one_side_are_named() {
    let trial = recorded();
    let check = |name: &str, more: &[&str]| {
        let output = by_parts(&trial, more);
        insta::assert_snapshot!(name, format!("{}\n{}", trial.printed(&output), row_of_colours(&output)));
    };
    check("colours", &["--images=rec/images", "-ocolours"]);
    check("no_colours", &["-oplain"]);
    check("colours_without_images", &["--setup=colours/setup.toml", "-oout"]);
    check("images_without_colours", &["--setup=plain/setup.toml", "--images=rec/images", "-oout"]);
    for frame in (0..FRAMES).filter(|frame| ![6, 8].contains(frame)) {
        fs::remove_file(trial.path(&format!("rec/images/C1_{frame:04}.png"))).unwrap();
        fs::remove_file(trial.path(&format!("rec/images/C2_{frame:04}.png"))).unwrap();
    }
    check("no_image_in_the_first_second", &["--images=rec/images", "--fps=5", "-oout"]);
    fs::remove_file(trial.path("rec/images/C2_0008.png")).unwrap();
    check("image_missing", &["--images=rec/images", "-oout"]);
}

#[test]
fn grey_images_are_named() {
    let trial = coloured();
    for (name, bytes) in files(&trial.path("rec/images")) {
        let mut image = picture::read(&name, &bytes).unwrap();
        image.pixels.iter_mut().for_each(|pixel| *pixel = [pixel[1]; 3]);
        let mut bytes = Vec::new();
        picture::write_png(&mut bytes, &image).unwrap();
        fs::write(trial.path("rec/images").join(name), bytes).unwrap();
    }
    let check = |name: &str, more: &[&str]| {
        let tracked = by_parts(&trial, &[&["--images=rec/images", "-oout"], more].concat());
        insta::assert_snapshot!(name, trial.printed(&tracked));
    };
    check("grey_images", &[]);
    check("colours_and_grey_images", &["--setup=colours/setup.toml"]);
}

#[test]
fn colours_that_cannot_be_are_refused() {
    let trial = coloured();
    let stored = fs::read_to_string(trial.path("colours/setup.toml")).unwrap();
    let (before, colours) = stored.split_once("[colours]").expect("they are stored");
    let first = colours.lines().find(|line| line.starts_with("pixels")).expect("a part was seen");
    for (name, from, to) in [
        ("colours_of_another_version", "version = 1", "version = 2"),
        ("colours_of_another_camera", "camera = \"C2\"", "camera = \"C7\""),
        ("colours_of_another_part", "name = \"head\"", "name = \"tail\""),
        ("colours_twice", "camera = \"C2\"", "camera = \"C1\""),
        ("colours_beyond_eight", first, "pixels = [[0, 8, 0, 5]]"),
        ("colours_falling", first, "pixels = [[1, 2, 3, 4], [1, 2, 2, 4]]"),
        ("colours_without_version", "version = 1", ""),
    ] {
        let edited = colours.replace(from, to);
        assert_ne!(edited, colours, "{name}");
        fs::write(trial.path("edited.toml"), format!("{before}[colours]{edited}")).unwrap();
        insta::assert_snapshot!(name, trial.printed(&by_parts(&trial, &["--setup=edited.toml", "-oout"])));
    }
}
