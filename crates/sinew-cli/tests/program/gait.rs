//! `sinew gait`: events, strides and cycles of a walker, and what is refused.

use crate::common::{Trial, column, trial};
use std::fs;

fn printed(trial: &Trial, arguments: &[&str]) -> String {
    trial.printed(&trial.run(arguments))
}

fn numbers(table: &[u8], name: &str) -> Vec<f64> {
    column(table, name).iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()
}

const NAMES: [&str; 4] = ["gait_events.csv", "gait_parameters.csv", "gait_cycles.csv", "gait.svg"];

/// The walker of 1.1 s a stride stands for a second and strikes first with the right foot.
#[test]
fn a_walker_has_events_strides_and_cycles() {
    let trial = trial(4.0);
    let tracked = trial.track(&["--smooth"]);
    assert!(tracked.status.success(), "{}", trial.printed(&tracked));
    let read = |name: &str| fs::read(trial.path(&format!("out/{name}"))).unwrap();
    let found = trial.run(&["gait", "out", "--json"]);
    assert!(found.status.success(), "{}", trial.printed(&found));
    let answer: serde_json::Value = serde_json::from_slice(&found.stdout).unwrap();
    let stride = answer["parameters"]["both"]["stride_time_s"]["mean"].as_f64().unwrap();
    assert!((stride - 1.1).abs() < 0.03, "{answer:#}");

    let events = read("gait_events.csv");
    let (sides, kinds) = (column(&events, "side"), column(&events, "event"));
    let strikes: Vec<&String> =
        sides.iter().zip(&kinds).filter(|(_, kind)| *kind == "heel_strike").map(|(side, _)| side).collect();
    assert_eq!(strikes[..3], ["right", "left", "right"]);
    let [low, time, high] = ["time_q05_s", "time_s", "time_q95_s"].map(|name| numbers(&events, name));
    assert!((0..time.len()).all(|k| low[k] < time[k] && time[k] < high[k] && high[k] - low[k] < 0.2));
    let frames = numbers(&events, "frame");
    assert!(frames.iter().zip(&time).all(|(frame, time)| (frame - 30.0 * time).abs() < 1e-3));

    // What a time is stands beside it, and at the end of the answer.
    for (kind, definition) in kinds.iter().zip(column(&events, "definition")) {
        let way = if kind == "heel_strike" { "ahead of" } else { "behind" };
        assert_eq!(definition, format!("point farthest {way} the pelvis (not contact)"));
    }
    let shown = trial.run(&["gait", "out", "-oshown"]);
    let last = String::from_utf8_lossy(&shown.stdout).lines().last().unwrap().to_owned();
    assert!(last.contains("not contact") && last.contains("force plates"), "{last}");

    let parameters = read("gait_parameters.csv");
    let rows = column(&parameters, "row");
    let mean = rows.iter().zip(column(&parameters, "side")).position(|(row, side)| row == "mean" && side == "both");
    let mean = mean.unwrap();
    let [length, low, high] =
        ["step_length_m", "step_length_q05_m", "step_length_q95_m"].map(|name| numbers(&parameters, name)[mean]);
    assert!((0.6..0.8).contains(&length) && low < length && length < high, "{low} {length} {high}");
    assert!((0.55..0.75).contains(&numbers(&parameters, "stance_share")[mean]));

    let cycles = read("gait_cycles.csv");
    let sides = column(&cycles, "side");
    let knees: Vec<f64> = column(&cycles, "angle")
        .iter()
        .zip(numbers(&cycles, "mean_deg"))
        .zip(&sides)
        .filter(|((angle, _), side)| *angle == "knee_angle_r" && *side == "right")
        .map(|((_, mean), _)| mean)
        .collect();
    assert_eq!(knees.len(), 101);
    let bent = (0..101).max_by(|a, b| knees[*a].total_cmp(&knees[*b])).unwrap();
    assert!((60..85).contains(&bent) && knees[bent] > 45.0, "{bent}: {}", knees[bent]);
    let svg = String::from_utf8(read("gait.svg")).unwrap();
    assert!(svg.contains("knee, flexion") && svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
    assert!(svg.lines().all(|line| line.starts_with('<') && line.ends_with('>')), "{svg}");

    for (name, words) in [
        ("gait_events.csv", "heel strikes and toe offs"),
        ("gait_parameters.csv", "strides of a walk"),
        ("gait_cycles.csv", "angles over the gait cycle"),
    ] {
        let said = trial.run(&["inspect", &format!("out/{name}")]);
        assert!(String::from_utf8_lossy(&said.stdout).contains(words), "{}", trial.printed(&said));
    }

    // Written files are kept, unless they may be replaced, and then by the same bytes.
    insta::assert_snapshot!("occupied", printed(&trial, &["gait", "out"]));
    let before = NAMES.map(read);
    assert!(trial.run(&["gait", "out", "--force"]).status.success());
    assert!(before == NAMES.map(read));
    assert!(trial.run(&["gait", "out", "-oelsewhere"]).status.success());
    assert!(fs::read(trial.path("elsewhere/gait_events.csv")).unwrap() == events);
    insta::assert_snapshot!("out_is_a_file", printed(&trial, &["gait", "out", "-oCalib.toml"]));

    // Without heels and toes in the layout, ankles stand for them.
    trial.edit(&trial.path("out/keypoints.csv"), |text| text.replace("Heel", "Ear"));
    let ankles = trial.run(&["gait", "out", "--force"]);
    assert!(trial.printed(&ankles).contains("are of the ankles"), "{}", trial.printed(&ankles));
    assert!(column(&read("gait_events.csv"), "point").iter().all(|point| point.ends_with("Ankle")));

    // Intervals of angles are laid over the cycle.
    let ends = |angle: &str| {
        let cycles = read("gait_cycles.csv");
        let rows = column(&cycles, "angle").into_iter().zip(column(&cycles, "q05_deg"));
        rows.filter(|(own, _)| own == angle).map(|(_, low)| low).collect::<Vec<_>>()
    };
    for angle in ["knee_angle_r", "hip_flexion_r", "pelvic_tilt", "pelvic_obliquity", "pelvic_rotation"] {
        assert!(!ends(angle).is_empty() && !ends(angle).iter().any(String::is_empty), "{angle}");
    }
    trial.edit(&trial.path("out/angles.csv"), |text| text.replace(",knee_angle_r,", ",another_angle,"));
    assert!(trial.run(&["gait", "out", "--force"]).status.success());
    assert!(ends("knee_angle_r").iter().all(String::is_empty) && !ends("hip_flexion_r").iter().any(String::is_empty));

    // Without draws there are no intervals.
    fs::remove_dir_all(trial.path("out/posterior.zarr")).unwrap();
    let without = trial.run(&["gait", "out", "--force"]);
    assert!(without.status.success() && trial.printed(&without).contains("there are no intervals"));
    assert!(column(&read("gait_events.csv"), "time_q05_s").iter().all(String::is_empty));

    // A run into the folder takes the gait of the old results away.
    assert!(trial.track(&["--force"]).status.success());
    assert!(NAMES.iter().all(|name| !trial.path(&format!("out/{name}")).exists()));
}

#[test]
fn results_without_gait_are_refused_by_what_is_wrong() {
    let trial = trial(0.8);
    assert!(trial.track(&[]).status.success());
    let stands = printed(&trial, &["gait", "out"]);
    assert!(stands.starts_with("exit 3\nerror: out: nobody walks: no heel strike was found"), "{stands}");
    insta::assert_snapshot!("no_results", printed(&trial, &["gait", "pose"]));
    insta::assert_snapshot!("no_folder", printed(&trial, &["gait", "none"]));
    let joints = trial.path("out/joints.csv");
    let whole = fs::read_to_string(&joints).unwrap();
    let refused = |name: &str| insta::assert_snapshot!(name, printed(&trial, &["gait", "out"]));
    fs::remove_dir_all(trial.path("out/posterior.zarr/posterior/marker_position")).unwrap();
    let heel = whole.lines().position(|line| line.contains(",RHeel,")).unwrap();
    let without_number = |line: (usize, &str)| {
        let mut cells: Vec<&str> = line.1.split(',').collect();
        cells[4] = if line.0 == heel { "NaN" } else { cells[4] };
        cells.join(",")
    };
    let nan: Vec<String> = whole.lines().enumerate().map(without_number).collect();
    fs::write(&joints, nan.join("\n")).unwrap();
    refused("no_number");
    fs::write(&joints, whole.replace(",LHip,", ",Hip,")).unwrap();
    assert!(printed(&trial, &["gait", "out"]).contains("no LHip; the body has"));
    fs::write(&joints, whole.lines().next().unwrap()).unwrap();
    refused("empty_joints");
    fs::write(&joints, &whole).unwrap();
    let frames = trial.path("out/frames.csv");
    trial.edit(&frames, |text| text.lines().next().unwrap().to_owned());
    refused("no_frames");
    fs::remove_file(&joints).unwrap();
    fs::remove_file(&frames).unwrap();
    refused("no_table");
    fs::write(trial.path("out/people.csv"), "person,folder\n1,people/01\n").unwrap();
    refused("several_people");
}
