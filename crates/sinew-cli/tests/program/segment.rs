//! `sinew segment` on a synthetic scene whose masks are known, and what the user reads about bad images.

use crate::common::{Trial, files};
use sinew::formats::picture;
use sinew::input::silhouettes::{ImageFolderOptions, Silhouettes};
use sinew::observe::silhouettes::bit_image::{BitImage, overlap};
use sinew::observe::{Camera, RgbImage};
use std::fs;
use std::path::Path;

const SIZE: [usize; 2] = [160, 120];
const CAMERAS: [&str; 2] = ["left", "right_02"];

/// Numbers in [0, 1) from a multiplicative congruential generator.
struct Dice(u64);

impl Dice {
    fn throw(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Mean 0, standard deviation 1.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.throw()).sum::<f64>() - 6.0
    }
}

/// A person of a head, a trunk and two legs, somewhere.
fn person(frame: u64) -> BitImage {
    let middle = 40.0 + 15.0 * frame as f64;
    BitImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let (x, y) = (x as f64 - middle, y as f64);
        let head = (x / 6.0).powi(2) + ((y - 22.0) / 8.0).powi(2) <= 1.0;
        let trunk = (x / 12.0).powi(2) + ((y - 50.0) / 24.0).powi(2) <= 1.0;
        let legs = (60.0..104.0).contains(&y) && (x.abs() - 6.0).abs() <= 4.0;
        head || trunk || legs
    })
}

/// A floor and a striped wall with noise of 4 of 255, and perhaps a person in a blue shirt with a shadow of 70 % on the floor.
fn image(seed: u64, frame: Option<u64>) -> RgbImage {
    let mut dice = Dice(seed);
    let shape = frame.map(person);
    let pixels = (0..SIZE[0] * SIZE[1]).map(|i| {
        let (x, y) = (i % SIZE[0], i / SIZE[0]);
        let mut color = if y < 90 { [180.0, 170.0 + 20.0 * ((x / 8) % 2) as f64, 150.0] } else { [120.0, 100.0, 80.0] };
        if let (Some(frame), Some(shape)) = (frame, &shape) {
            let off = x as f64 - 40.0 - 15.0 * frame as f64;
            if shape.get(x, y) {
                color = if y < 30 { [210.0, 150.0, 120.0] } else { [40.0, 60.0, 140.0] };
            } else if (off / 30.0).powi(2) + ((y as f64 - 106.0) / 8.0).powi(2) < 1.0 && y >= 90 {
                color = color.map(|value| 0.7 * value);
            }
        }
        color.map(|value: f64| (value + 4.0 * dice.normal()).round().clamp(0.0, 255.0) as u8)
    });
    RgbImage { width: SIZE[0], height: SIZE[1], pixels: pixels.collect() }
}

fn write(path: &Path, image: &RgbImage) {
    let mut bytes = Vec::new();
    picture::write_png(&mut bytes, image).unwrap();
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, bytes).unwrap();
}

/// Eight images of the background and five with the person, of two cameras.
fn trial() -> Trial {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    for (index, camera) in CAMERAS.iter().enumerate() {
        for number in 0..8 {
            let seed = 1000 * index as u64 + number;
            write(&trial.path(&format!("empty/{camera}/{number}.png")), &image(seed, None));
        }
        for number in 0..5 {
            let seed = 1000 * index as u64 + 500 + number;
            write(&trial.path(&format!("images/{camera}_{:04}.png", 8 + number)), &image(seed, Some(number)));
        }
    }
    trial
}

const SEGMENT: [&str; 7] = ["segment", "--background", "empty", "--images", "images", "-omasks", "--no-progress"];

fn run(trial: &Trial, more: &[&str]) -> std::process::Output {
    trial.run(&[&SEGMENT[..], more].concat())
}

/// Least intersection over union of the masks with the truth.
fn least_iou(trial: &Trial) -> f64 {
    let camera = |name: &str| {
        Camera::look_at(name, SIZE.map(|size| size as f64), 200.0, [-3.0, -4.0, 2.0], [0.0, 0.0, 1.0]).unwrap()
    };
    let cameras = CAMERAS.map(camera);
    let mut silhouettes = Silhouettes::open(&trial.path("masks"), &cameras, &ImageFolderOptions::default()).unwrap();
    assert_eq!(silhouettes.frames(), 8..13);
    let mut least = 1.0_f64;
    for number in silhouettes.frames() {
        for mask in silhouettes.frame(number).unwrap() {
            let counts = overlap(&mask.unwrap(), &person(number - 8), 0..SIZE[1]);
            least = least.min(counts.both as f64 / (counts.both + counts.first_only + counts.second_only) as f64);
        }
    }
    assert_eq!(silhouettes.warnings(), Vec::<String>::new());
    least
}

#[test]
fn masks_match_the_person() {
    let trial = trial();
    let output = run(&trial, &["--shadow", "0.5"]);
    assert_eq!(trial.printed(&output), "exit 0\n");
    let iou = least_iou(&trial);
    println!("least intersection over union, shadows allowed: {iou:.4}");
    assert!(iou > 0.98, "{iou}");
    insta::assert_snapshot!("answer", String::from_utf8(output.stdout).unwrap());
    let first = files(&trial.path("masks"));
    assert_eq!(first.len(), 11, "{:?}", first.keys());

    let without = run(&trial, &["--force"]);
    assert_eq!(trial.printed(&without), "exit 0\n");
    let iou = least_iou(&trial);
    println!("least intersection over union, the shadow taken for the person: {iou:.4}");
    assert!(iou < 0.95, "{iou}");

    let again = run(&trial, &["--force", "--shadow", "0.5", "--json"]);
    assert_eq!(files(&trial.path("masks")), first);
    let answer: serde_json::Value = serde_json::from_slice(&again.stdout).unwrap();
    assert_eq!(answer["cameras"][1]["name"], "right_02");
    assert_eq!(answer["cameras"][1]["masks"], 5);
}

#[test]
fn several_recordings_of_the_background_are_one() {
    let whole = trial();
    assert_eq!(run(&whole, &[]).status.code(), Some(0));
    let split = trial();
    for camera in CAMERAS {
        fs::create_dir_all(split.path(&format!("later/{camera}"))).unwrap();
        for number in 4..8 {
            let [from, to] = ["empty", "later"].map(|folder| split.path(&format!("{folder}/{camera}/{number}.png")));
            fs::rename(from, to).unwrap();
        }
    }
    assert_eq!(run(&split, &["--background", "later"]).status.code(), Some(0));
    assert_eq!(files(&split.path("masks")), files(&whole.path("masks")));
}

#[test]
fn progress_is_reported_in_tenths() {
    let trial = trial();
    let output = trial.run(&SEGMENT[..6]);
    let printed = trial.printed(&output);
    assert!(
        printed.contains("segment: 10 % (3 of 26 frames)") && printed.contains("100 % (26 of 26 frames)"),
        "{printed}"
    );
}

#[test]
fn masks_of_before_go_with_force_alone() {
    let trial = trial();
    assert_eq!(run(&trial, &[]).status.code(), Some(0));
    insta::assert_snapshot!("exists", trial.printed(&run(&trial, &[])));
    fs::remove_file(trial.path("images/left_0012.png")).unwrap();
    assert_eq!(run(&trial, &["--force"]).status.code(), Some(0));
    assert_eq!(files(&trial.path("masks")).len(), 10);
}

#[test]
fn masks_of_the_user_stay() {
    let trial = trial();
    assert_eq!(run(&trial, &[]).status.code(), Some(0));
    fs::write(trial.path("masks/left/000500.png"), "mine").unwrap();
    assert_eq!(run(&trial, &["--force"]).status.code(), Some(0));
    assert_eq!(fs::read_to_string(trial.path("masks/left/000500.png")).unwrap(), "mine");
    fs::remove_dir_all(trial.path("masks")).unwrap();
    let first = trial.path("masks/left/000012.png");
    fs::create_dir_all(first.parent().unwrap()).unwrap();
    fs::write(&first, "mine").unwrap();
    let printed = trial.printed(&run(&trial, &["--force"]));
    assert!(printed.starts_with("exit 5") && printed.contains("000012.png` is in the way"), "{printed}");
    assert_eq!(fs::read_to_string(&first).unwrap(), "mine");
}

fn check(name: &str, harm: impl FnOnce(&Trial), arguments: &[&str]) {
    let trial = trial();
    harm(&trial);
    insta::assert_snapshot!(name, trial.printed(&run(&trial, arguments)));
}

#[test]
fn images_that_do_not_fit() {
    let small = RgbImage { width: 4, height: 3, pixels: vec![[7; 3]; 12] };
    check("image_of_another_size", |trial| write(&trial.path("images/left_0010.png"), &small), &[]);
    check("background_of_another_size", |trial| write(&trial.path("empty/left/3.png"), &small), &[]);
    check("no_background", |trial| fs::remove_dir_all(trial.path("empty/left")).unwrap(), &[]);
    check(
        "no_images",
        |trial| {
            fs::remove_dir_all(trial.path("images")).unwrap();
            fs::create_dir(trial.path("images")).unwrap();
        },
        &[],
    );
    check("no_folder", |trial| fs::remove_dir_all(trial.path("images")).unwrap(), &[]);
    check("unreadable", |trial| fs::write(trial.path("images/left_0010.png"), "GIF89a").unwrap(), &[]);
    let cut = |trial: &Trial| {
        let path = trial.path("images/right_02_0011.png");
        let bytes = fs::read(&path).unwrap();
        fs::write(path, &bytes[..bytes.len() / 2]).unwrap();
    };
    check("cut", cut, &[]);
    check(
        "few_images",
        |trial| (2..8).for_each(|n| fs::remove_file(trial.path(&format!("empty/left/{n}.png"))).unwrap()),
        &[],
    );
    check(
        "another_light",
        |trial| {
            (8..13).for_each(|number| {
                let mut bright = image(number, None);
                bright.pixels.iter_mut().flatten().for_each(|value| *value = value.saturating_add(70));
                write(&trial.path(&format!("images/left_{number:04}.png")), &bright);
            })
        },
        &[],
    );
    check("nobody", |trial| write(&trial.path("images/left_0008.png"), &image(77, None)), &[]);
}

#[test]
fn requests_that_cannot_be_met() {
    check("threshold", |_| {}, &["--threshold", "-1"]);
    check("shadow", |_| {}, &["--shadow", "1.5"]);
    check("least_part", |_| {}, &["--least-part", "2"]);
    let trial = trial();
    let printed = |arguments: &[&str]| trial.printed(&trial.run(arguments));
    insta::assert_snapshot!("no_output", printed(&["segment", "--background", "empty", "--images", "images"]));
    let into = ["segment", "--background", "empty", "--images", "images", "-o"];
    insta::assert_snapshot!("output_is_input", printed(&[&into[..], &["images"]].concat()));
    insta::assert_snapshot!("no_flags", printed(&["segment"]));
    let help = trial.run(&["segment", "--help"]);
    insta::assert_snapshot!("help", String::from_utf8(help.stdout).unwrap());
}
