//! `sinew simulate`: what it writes, that others read it, and what it refuses.

use crate::common::{Trial, files};
use sinew::input::recording::{Recording, RecordingOptions};
use std::fs;

fn folder() -> Trial {
    Trial { folder: tempfile::tempdir().unwrap() }
}

/// Runs the command for 0.4 s at 20 frames per second, with a picture of every fourth, unless `more` says otherwise.
fn simulate(trial: &Trial, out: &str, more: &[&str]) -> String {
    let out = format!("-o{out}");
    let mut arguments = vec!["simulate", "--no-progress", &out];
    for usual in ["--duration=0.4", "--fps=20", "--images=4"] {
        let flag = usual.split_once('=').map_or(usual, |(flag, _)| flag);
        arguments.extend((!more.iter().any(|given| given.starts_with(flag))).then_some(usual));
    }
    arguments.extend(more);
    trial.printed(&trial.run(&arguments))
}

#[test]
fn a_recording_is_whole_and_its_readers_take_it() {
    let trial = folder();
    assert_eq!(simulate(&trial, "out", &["--segmentation=clean", "--cameras=3", "--size=160x120"]), "exit 0\n");
    let written = files(&trial.path("out"));
    let count = |start: &str| written.keys().filter(|name| name.starts_with(start)).count();
    assert_eq!([count("keypoints/C2_json/"), count("masks/"), count("images/")], [8, 24, 6]);
    for name in ["Calib.toml", "truth.trc", "README.txt", "masks/C3_0007.png", "images/C1_0004.png"] {
        assert!(written.contains_key(name), "{name}");
    }
    assert_eq!(written.len(), 3 * 8 + 24 + 6 + 3 + 1);
    let options = RecordingOptions { layout: Some("BODY_25B".into()), ..RecordingOptions::default() };
    let mut recording = Recording::open(&trial.path("out/Calib.toml"), &trial.path("out/keypoints"), &options).unwrap();
    assert_eq!((recording.cameras().len(), recording.frames()), (3, 0..8));
    assert_eq!(recording.cameras()[0].image_size_px, [160.0, 120.0]);
    assert!(recording.frame(3).unwrap().iter().all(|people| people.len() == 1));
    // Keypoints lie on the person, give or take the detector's errors.
    let people = recording.frame(7).unwrap();
    let mask = gray(&written["masks/C1_0007.png"]);
    let seen: Vec<_> = people[0][0].keypoints.iter().flatten().collect();
    let near = |x: f64, y: f64| {
        (-3..=3).any(|dy| (-3..=3).any(|dx| mask.get(&(x as i64 + dx, y as i64 + dy)).is_some_and(|v| *v == 255)))
    };
    let on = seen.iter().filter(|point| near(point.x, point.y)).count();
    assert!(on * 10 > seen.len() * 8, "{on} of {} on the person", seen.len());
    assert!(mask.values().all(|value| [0, 255].contains(value)));
}

/// Values of a grey picture by column and row.
fn gray(file: &[u8]) -> std::collections::BTreeMap<(i64, i64), u8> {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(file));
    decoder.set_transformations(png::Transformations::EXPAND);
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    assert_eq!(info.color_type, png::ColorType::Grayscale);
    let width = i64::from(info.width);
    (0..).zip(bytes).map(|(i, value)| ((i % width, i / width), value)).collect()
}

#[test]
fn a_seed_gives_the_same_bytes_on_any_number_of_threads() {
    let trial = folder();
    for (out, more) in [("a", "--threads=1"), ("b", "--threads=3"), ("c", "--seed=2")] {
        assert_eq!(simulate(&trial, out, &[more, "--segmentation=hard"]), "exit 0\n");
    }
    let [mut a, mut b, mut c] = ["a", "b", "c"].map(|out| files(&trial.path(out)));
    // It names the folder.
    for files in [&mut a, &mut b, &mut c] {
        files.remove("README.txt");
    }
    assert!(a == b);
    assert_eq!(a["Calib.toml"], c["Calib.toml"]);
    assert!(a["masks/C1_0000.png"] != c["masks/C1_0000.png"]);
    assert!(a["images/C1_0000.png"] != c["images/C1_0000.png"]);
}

#[test]
fn nothing_is_overwritten_unless_requested() {
    let trial = folder();
    assert_eq!(simulate(&trial, "out", &[]), "exit 0\n");
    let first = files(&trial.path("out"));
    fs::write(trial.path("out/notes.txt"), "mine").unwrap();
    let printed = simulate(&trial, "out", &["--seed=3"]);
    assert_eq!(
        printed,
        "exit 5\nerror: `out` exists and is not empty\nhelp: choose another folder with `-o`, or replace what is there with `--force`"
    );
    assert_eq!(simulate(&trial, "out", &["--duration=0.2", "--force", "--images=none"]), "exit 0\n");
    let second = files(&trial.path("out"));
    assert_eq!(second["notes.txt"], b"mine");
    assert_eq!(first["masks/C4_0003.png"], second["masks/C4_0003.png"]);
    assert!(!second.contains_key("masks/C4_0004.png") && !second.keys().any(|name| name.starts_with("images/")));
}

#[test]
fn a_motion_file_is_taken_as_it_is() {
    let trial = folder();
    assert_eq!(simulate(&trial, "walk", &[]), "exit 0\n");
    let again =
        ["simulate", "--motion=walk/truth.trc", "--fps=20", "--images=none", "--no-progress", "-oagain", "--json"];
    let output = trial.run(&again);
    assert_eq!(trial.printed(&output), "exit 0\n");
    let answer: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&answer["frames"], &answer["cameras"], &answer["out"]), (&8.into(), &4.into(), &"again".into()));
    let [first, again] = ["walk", "again"].map(|out| files(&trial.path(out)));
    assert_eq!(first["Calib.toml"], again["Calib.toml"]);
    let inside = simulate(&trial, "walk", &["--motion=walk/truth.trc", "--force"]);
    assert!(inside.contains("error: the output folder `walk` is also the input"), "{inside}");
    assert!(trial.path("walk/truth.trc").exists());
}

/// A walk turns before the walls of its room; a motion from a file goes where it goes.
#[test]
fn a_motion_too_long_for_the_cameras_is_warned_of() {
    let trial = folder();
    let simulate = |rest: &[&str]| {
        trial.printed(&trial.run(&[&["simulate", "--fps=2", "--images=none", "--no-progress"], rest].concat()))
    };
    let printed = simulate(&["--duration=61", "-olong"]);
    assert!(printed.starts_with("exit 0") && !printed.contains("warning"), "{printed}");
    trial.edit(&trial.path("long/truth.trc"), |text| {
        let (head, frames) = text.split_at(text.match_indices('\n').nth(5).unwrap().0 + 1);
        let moved = frames.lines().enumerate().map(|(frame, line)| {
            let cell = |(column, cell): (usize, &str)| match cell.parse::<f64>() {
                Ok(x) if column > 1 && column % 3 == 2 => format!("{}", x + 0.6 * frame as f64),
                _ => cell.to_owned(),
            };
            line.split('\t').enumerate().map(cell).collect::<Vec<_>>().join("\t") + "\n"
        });
        head.to_owned() + &moved.collect::<String>()
    });
    let printed = simulate(&["--motion=long/truth.trc", "-ofar"]);
    assert!(printed.starts_with("exit 0\nwarning: the motion covers 7"), "{printed}");
}

#[test]
fn mistakes_are_reported() {
    let trial = folder();
    fs::write(trial.path("a.trc"), "nonsense").unwrap();
    fs::write(trial.path("a.csv"), "time_s,Nose_x_m,Nose_y_m,Nose_z_m\n0,1,2,3\n0.1,1,2,3\n").unwrap();
    let cases: [(&[&str], &str); 12] = [
        (&["--segmentation=soft"], "exit 2\nerror: invalid value 'soft' for '--segmentation <LEVEL>'"),
        (&["--size=320"], "exit 2\nerror: invalid value '320' for '--size <WxH>': expected WIDTHxHEIGHT"),
        (&["--cameras=0"], "exit 2\nerror: invalid value '0' for '--cameras <N>'"),
        (&["--images=0"], "exit 2\nerror: invalid value '0' for '--images <N>'"),
        (&["--fps=-1"], "exit 2\nerror: `--fps` is -1; it must be greater than 0"),
        (&["--duration=nan"], "exit 2\nerror: `--duration` is NaN; it must be greater than 0"),
        (&["--duration=1e-9"], "exit 2\nerror: no frame in that time"),
        (&["--duration=1e9"], "exit 2\nerror: more than 1000000 frames"),
        (&["--skeleton=a.asf"], "exit 2\nerror: the walk needs no skeleton"),
        (&["--motion=none.trc"], "exit 5\nerror: cannot read `none.trc`"),
        (&["--motion=a.amc"], "exit 5\nerror: cannot read `a.amc`"),
        (&["--motion=a.csv"], "exit 3\nerror: a.csv: no joint is known as Neck, LShoulder"),
    ];
    for (more, expected) in cases {
        let printed = trial.printed(&trial.run(&[&["simulate", "--no-progress", "-oout"], more].concat()));
        assert!(printed.starts_with(expected), "{printed}");
    }
    assert!(simulate(&trial, "out", &["--motion=a.trc"]).starts_with("exit 3\nerror: a.trc"));
    assert!(!trial.path("out").exists());
}

#[test]
fn the_readme_of_a_crowd_lists_the_truth_of_everybody() {
    let trial = folder();
    let output = trial.run(&["simulate", "--no-progress", "-oout", "--people=2", "--cameras=1", "--duration=0.4"]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    let readme = fs::read_to_string(trial.path("out/README.txt")).unwrap();
    for name in files(&trial.path("out")).keys().filter(|name| name.starts_with("truth_")) {
        assert!(readme.contains(name.as_str()), "{name}: {readme}");
    }
    let printed = String::from_utf8(output.stdout).unwrap();
    for text in [&readme, &printed] {
        assert!(text.contains("1 camera") && !text.contains("1 cameras") && text.contains("--people 1"), "{text}");
    }
}
