//! `sinew compare` and `sinew export opensim` on a tracked walker, C3D to C3D, and what is refused.

use crate::common::{Trial, column, trial};
use sinew::formats::{c3d, osim_model, trc};
use std::fs;

/// A tracked walker, and its points as a laboratory would have them.
/// Its clock is 1.5 s late, its world turned by a right angle.
fn tracked() -> Trial {
    let trial = trial(3.0);
    let made = trial.track(&[]);
    assert!(made.status.success(), "{}", trial.printed(&made));
    // What the demo's recordings have as truth.trc is the reference: here the result itself, moved by a known amount.
    let own = fs::read_to_string(trial.path("out/markers.trc")).unwrap();
    let own = trc::read("markers.trc", &own).unwrap();
    let header = c3d::C3dHeader { first_frame: 46, ..c3d::C3dHeader::new(30.0, own.header.markers.clone()) };
    let turned = |[x, y, z]: [f64; 3]| [z + 0.5, y + 0.1, -x];
    let frames: Vec<Vec<_>> =
        own.frames.iter().map(|frame| frame.points.iter().map(|point| point.map(turned)).collect()).collect();
    let mut bytes = vec![];
    c3d::write(&mut bytes, &header, &frames).unwrap();
    fs::write(trial.path("lab.c3d"), bytes).unwrap();
    trial
}

#[test]
fn a_walker_is_held_against_a_laboratory() {
    let trial = tracked();
    let found = trial.run(&["compare", "out", "lab.c3d", "--json"]);
    assert!(found.status.success(), "{}", trial.printed(&found));
    let answer: serde_json::Value = serde_json::from_slice(&found.stdout).unwrap();
    let alignment = &answer["alignment"];
    assert!((alignment["offset_s"].as_f64().unwrap() - 1.5).abs() < 2e-3, "{alignment:#}");
    let [_, heading] = [0, 1].map(|k: usize| alignment["worlds"]["tilt_and_heading_deg"][k].as_f64().unwrap());
    assert!((heading.abs() - 90.0).abs() < 0.1, "{alignment:#}");
    // The reference is the mean pose: it lies near the means, and inside the intervals.
    assert!(answer["mean_distance_m"].as_f64().unwrap() < 0.02, "{answer:#}");
    let table = fs::read(trial.path("out/comparison.csv")).unwrap();
    let names = column(&table, "name");
    assert!(names.iter().any(|name| name == "RKnee") && names[names.len() - 3..].iter().all(|name| name == "all"));
    let inside: f64 = column(&table, "inside_within_90").last().unwrap().parse().unwrap();
    assert!(inside > 0.9, "{inside}");
    let svg = fs::read_to_string(trial.path("out/bland_altman.svg")).unwrap();
    assert!(svg.contains("RKnee") && svg.ends_with("</svg>\n") && !svg.contains("NaN"));
    let said = trial.run(&["inspect", "out/comparison.csv"]);
    assert!(String::from_utf8_lossy(&said.stdout).contains("agreement with a reference"), "{}", trial.printed(&said));

    // The report shows it, a mapping chooses points, and a new run forgets it.
    assert!(trial.run(&["report", "out"]).status.success());
    let page = fs::read_to_string(trial.path("out/report.html")).unwrap();
    assert!(page.contains("Beside a reference") && page.contains("data:image/svg+xml;base64,"));
    fs::write(trial.path("names.toml"), "[points]\nRHip = 'RHip'\nLHip = 'LHip'\nRKnee = ['RKnee', 'RKnee']\n")
        .unwrap();
    let mapped = trial.run(&["compare", "out", "lab.c3d", "--names", "names.toml", "-obeside", "--align", "both"]);
    assert!(mapped.status.success(), "{}", trial.printed(&mapped));
    let rows = column(&fs::read(trial.path("beside/comparison.csv")).unwrap(), "name");
    assert_eq!(rows.iter().filter(|name| *name == "RKnee").count(), 3);
    assert_eq!(rows.len(), 12);
    // Angles of another program.
    let angles = trial.run(&["compare", "out", "out/angles.mot", "-oangles", "--json"]);
    let answer: serde_json::Value = serde_json::from_slice(&angles.stdout).unwrap();
    assert!(answer["alignment"]["offset_s"].as_f64().unwrap().abs() < 2e-3, "{answer:#}");
    assert_eq!(answer["unit"], "deg");

    insta::assert_snapshot!("occupied", trial.printed(&trial.run(&["compare", "out", "lab.c3d"])));
    insta::assert_snapshot!(
        "no_mapping",
        trial.printed(&trial.run(&["compare", "out", "lab.c3d", "--force", "--names", "wrong.toml"]))
    );
    fs::write(trial.path("wrong.toml"), "[points]\nRHips = 'RHip'\n").unwrap();
    insta::assert_snapshot!(
        "wrong_name",
        trial.printed(&trial.run(&["compare", "out", "lab.c3d", "--force", "--names", "wrong.toml"]))
    );
    insta::assert_snapshot!(
        "scale_alone",
        trial.printed(&trial.run(&["compare", "out", "lab.c3d", "--align", "time", "--scale"]))
    );
    fs::write(trial.path("few.csv"), "time_s,RHip_x_m,RHip_y_m,RHip_z_m\n0,0,0,0\n0.1,0,0,0\n").unwrap();
    insta::assert_snapshot!("too_few", trial.printed(&trial.run(&["compare", "out", "few.csv", "--force"])));
    let markers = fs::read_to_string(trial.path("out/markers.trc")).unwrap();
    let head: Vec<&str> = markers.lines().take(6).collect();
    fs::write(trial.path("no_frames.trc"), head.join("\n") + "\n").unwrap();
    let none = trial.printed(&trial.run(&["compare", "out", "no_frames.trc", "--force"]));
    assert!(none.contains("no_frames.trc: 0 frames of the result have a value of it beside them"), "{none}");
    assert!(trial.track(&["--force"]).status.success());
    assert!(!trial.path("out/comparison.csv").exists() && !trial.path("out/comparison.json").exists());
}

const MODEL: &str = "<?xml version=\"1.0\"?><OpenSimDocument Version=\"40000\"><Model name=\"m\"><BodySet><objects>";

#[test]
fn a_result_becomes_input_of_opensim() {
    let trial = tracked();
    let made = trial.run(&["export", "opensim", "out"]);
    assert!(made.status.success(), "{}", trial.printed(&made));
    let read = |name: &str| fs::read_to_string(trial.path(name)).unwrap();
    assert_eq!(read("out/opensim/markers.trc"), read("out/markers.trc"));
    let (set, ik, scale) =
        (read("out/opensim/marker_set.xml"), read("out/opensim/ik.xml"), read("out/opensim/scale.xml"));
    assert!(set.contains("<Marker name=\"RKnee\">") && set.contains("/bodyset/tibia_r"));
    assert!(scale.contains("<model_file>model.osim</model_file>") && !scale.contains("{{") && !ik.contains("{{"));
    let (markers, held) = ik.split_once("<IKCoordinateTask").unwrap();
    assert!(!held.contains("<apply>true</apply>"), "no coordinate applies to a model that is not known: {held}");
    let weights: Vec<f64> = markers
        .split("<weight>")
        .skip(1)
        .map(|rest| rest.split("</weight>").next().unwrap().parse().unwrap())
        .collect();
    assert_eq!(weights.len(), set.matches("<Marker ").count());
    assert!((weights.iter().sum::<f64>() / weights.len() as f64 - 1.0).abs() < 1e-3, "{weights:?}");

    // A model without a head has no place for its points.
    let bodies = ["pelvis", "femur_r", "tibia_r", "talus_r", "femur_l", "tibia_l", "talus_l", "humerus_r", "humerus_l"];
    let model = MODEL.to_owned()
        + &bodies.map(|body| format!("<Body name=\"{body}\"/>")).concat()
        + "</objects></BodySet><JointSet><Coordinate name=\"L5_S1_Flex_Ext\"/></JointSet></Model></OpenSimDocument>";
    assert_eq!(osim_model::read("m", &model).unwrap().bodies, bodies);
    fs::write(trial.path("legs.osim"), &model).unwrap();
    let made = trial.run(&["export", "opensim", "out", "--model", "legs.osim", "-olegs", "--json"]);
    let answer: serde_json::Value = serde_json::from_slice(&made.stdout).unwrap();
    assert!(answer["left_out"].as_array().unwrap().iter().any(|name| name == "Nose"), "{answer:#}");
    assert!(read("legs/ik.xml").contains("<IKCoordinateTask name=\"L5_S1_Flex_Ext\"><apply>true</apply>"));
    assert!(
        read("legs/scale.xml").contains("legs.osim</model_file>") && !read("legs/scale.xml").contains("\"ulna_r\"")
    );

    insta::assert_snapshot!("export_occupied", trial.printed(&trial.run(&["export", "opensim", "out"])));
    fs::write(trial.path("bad.osim"), model.replace("femur_r", "thigh_r")).unwrap();
    let refused = trial.run(&["export", "opensim", "out", "--force", "--model", "bad.osim"]);
    insta::assert_snapshot!("export_other_model", trial.printed(&refused));
    insta::assert_snapshot!(
        "export_no_model",
        trial.printed(&trial.run(&["export", "opensim", "out", "--force", "--model", "Calib.toml"]))
    );
}

#[test]
fn bones_are_renamed_and_c3d_files_are_kept_whole() {
    let trial = tracked();
    let renamed = trial.run(&["convert", "out/motion.bvh", "hero.bvh", "--bones", "mixamo"]);
    assert!(renamed.status.success(), "{}", trial.printed(&renamed));
    let hero = fs::read_to_string(trial.path("hero.bvh")).unwrap();
    assert!(hero.contains("ROOT Hips") && hero.contains("JOINT LeftForeArm"));
    insta::assert_snapshot!(
        "other_bones",
        trial.printed(&trial.run(&["convert", "out/markers.trc", "a.bvh", "--bones", "mixamo"]))
    );
    let again = trial.run(&["convert", "lab.c3d", "again.c3d"]);
    assert!(again.status.success(), "{}", trial.printed(&again));
    let read = |name: &str| c3d::read(name, &fs::read(trial.path(name)).unwrap()).unwrap();
    assert!(read("again.c3d") == read("lab.c3d"));
}
