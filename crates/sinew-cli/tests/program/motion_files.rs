//! `sinew convert` and `sinew inspect`: what becomes of motion files, and what is said about files.

use crate::common::{Trial, trial};
use std::fs;

const TRC: &str = "PathFileType\t4\t(X/Y/Z)\ta.trc\n\
    DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n\
    60\t60\t2\t2\tmm\t60\t5\t2\n\
    Frame#\tTime\tRHip\t\t\tNose\t\t\n\
    \t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\
    \n\
    1\t0.0\t100\t900\t300\t50\t1600\t310\n\
    2\t0.016667\t101\t901\t301\t\t\t\n";

const BVH: &str = "HIERARCHY\nROOT Hips\n{\n  OFFSET 0.0 0.0 0.0\n  CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation\n  JOINT Knee\n  {\n    OFFSET 0.0 -0.43 0.0\n    CHANNELS 3 Zrotation Yrotation Xrotation\n    End Site\n    {\n      OFFSET 0.0 -0.42 0.0\n    }\n  }\n}\nMOTION\nFrames: 1\nFrame Time: 0.0333333\n0 0.95 0 0 0 90 0 0 0\n";

fn with(files: &[(&str, &str)]) -> Trial {
    let trial = trial(0.1);
    for (name, text) in files {
        fs::write(trial.path(name), text).unwrap();
    }
    trial
}

fn check(trial: &Trial, arguments: &[&str]) {
    let output = trial.run(&[&["convert"], arguments].concat());
    assert!(output.status.success(), "{arguments:?}: {}", trial.printed(&output));
}

#[test]
fn markers_become_a_table_and_back() {
    let trial = with(&[("a.trc", TRC)]);
    check(&trial, &["a.trc", "a.csv"]);
    let table = fs::read_to_string(trial.path("a.csv")).unwrap();
    insta::assert_snapshot!("trc_as_csv", table);
    check(&trial, &["a.csv", "b.trc"]);
    check(&trial, &["b.trc", "b.csv"]);
    assert_eq!(fs::read_to_string(trial.path("b.csv")).unwrap(), table);
}

/// Positions in millimetres whose metres are numbers of four bytes: nothing is rounded on the way.
const EXACT: [(&str, &str); 4] = [
    ("100\t900\t300", "125\t875\t500"),
    ("50\t1600\t310", "-250\t1625\t375"),
    ("101\t901\t301", "0\t1000\t62.5"),
    ("60\t5\t2", "60\t1\t2"),
];

#[test]
fn markers_become_a_file_of_laboratories_and_back() {
    let exact = EXACT.iter().fold(TRC.to_owned(), |text, (from, to)| text.replace(from, to));
    let later = exact.replace("1\t0.0\t", "1\t1.5\t").replace("2\t0.016667", "2\t1.516667");
    let trial = with(&[("a.trc", &later)]);
    check(&trial, &["a.trc", "a.csv"]);
    check(&trial, &["a.trc", "a.c3d"]);
    check(&trial, &["a.c3d", "b.trc"]);
    check(&trial, &["b.trc", "b.c3d"]);
    assert_eq!(fs::read(trial.path("b.c3d")).unwrap(), fs::read(trial.path("a.c3d")).unwrap());
    let [before, after] = ["a.csv", "b.trc"]
        .map(|name| sinew_motion::convert::read(&trial.path(name), None, None).unwrap().points().unwrap());
    assert_eq!((&after.names, &after.frames), (&before.names, &before.frames));
    assert_eq!(after.time_s, [1.5, 91.0 / 60.0]);
    let inspected = String::from_utf8(trial.run(&["inspect", "a.c3d"]).stdout).unwrap();
    insta::assert_snapshot!("inspect_c3d", inspected);
    fs::write(trial.path("cut.c3d"), &fs::read(trial.path("a.c3d")).unwrap()[..1030]).unwrap();
    let output = trial.run(&["convert", "cut.c3d", "c.trc"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(trial.printed(&output).contains("cut.c3d: file claims 2 frames, holds 1 kB"), "{}", trial.printed(&output));
    fs::write(trial.path("uneven.csv"), "time_s,a_x_m,a_y_m,a_z_m\n0,1,2,3\n0.1,1,2,3\n0.5,1,2,3\n").unwrap();
    let output = trial.run(&["convert", "uneven.csv", "c.c3d"]);
    insta::assert_snapshot!("uneven_times", trial.printed(&output));
}

#[test]
fn a_skeleton_becomes_points_and_channels() {
    let trial = with(&[("a.bvh", BVH)]);
    check(&trial, &["a.bvh", "a.csv"]);
    let motion = sinew_motion::convert::read(&trial.path("a.csv"), None, None).unwrap();
    let points = motion.points().unwrap();
    assert_eq!(points.names, ["Hips", "Knee", "Knee_End"]);
    // The hips are turned by 90 degrees about the file's x: the leg points along −z there, which is y of the world.
    let tip = points.frames[0][2].unwrap();
    assert!(tip.iter().zip([0.0, 0.85, 0.95]).all(|(a, b)| (a - b).abs() < 1e-12), "{tip:?}");
    check(&trial, &["a.bvh", "a.glb"]);
    assert!(fs::read(trial.path("a.glb")).unwrap().starts_with(b"glTF"));
    check(&trial, &["a.bvh", "a.mot"]);
    check(&trial, &["a.mot", "coordinates.csv"]);
    let header = fs::read_to_string(trial.path("coordinates.csv")).unwrap().lines().next().unwrap().to_owned();
    assert_eq!(
        header,
        "time_s,Hips_tx_m,Hips_ty_m,Hips_tz_m,Hips_rz_deg,Hips_ry_deg,Hips_rx_deg,Knee_rz_deg,Knee_ry_deg,Knee_rx_deg"
    );
    check(&trial, &["coordinates.csv", "again.mot"]);
    assert_eq!(fs::read(trial.path("again.mot")).unwrap(), fs::read(trial.path("a.mot")).unwrap());
}

/// Tables of a result folder, cut short.
const TABLES: [(&str, &str); 4] = [
    (
        "joints.csv",
        "frame,time_s,person,joint,x_mean_m,y_mean_m,z_mean_m,x_sd_m,y_sd_m,z_sd_m,observed,quality\n\
         7,0.1,0,Nose,1,2,1.6,0.01,0.01,0.01,1,2\n7,0.1,0,RHip,1,2,0.9,0.01,0.01,0.01,1,2\n\
         8,0.2,0,Nose,1,2,1.6,0.01,0.01,0.01,1,2\n8,0.2,0,RHip,1,2,0.9,0.01,0.01,0.01,1,2\n",
    ),
    (
        "angles.csv",
        "frame,time_s,person,name,mean_deg,q05_deg,q95_deg\n7,0.1,0,knee_angle_r,1,0,2\n8,0.2,0,knee_angle_r,1,0,2\n",
    ),
    (
        "frames.csv",
        "frame,time_s,observed,quality,restarted,ess,residual_px\n7,0.1,1,2,0,300,4.5\n8,0.2,1,2,0,310,4.5\n",
    ),
    ("markers_sd.csv", "frame,time_s,RHip_sd_m,Nose_sd_m\n7,0.1,0.01,0.02\n8,0.2,0.01,0.02\n"),
];

#[test]
fn tables_of_results_are_described() {
    let trial = with(&TABLES);
    let output = trial.run(&["inspect", "joints.csv", "angles.csv", "frames.csv", "markers_sd.csv"]);
    insta::assert_snapshot!("inspect_tables", String::from_utf8(output.stdout).unwrap());
}

const ACTIONS: &str = "frame,time_s,person,part,cluster,model,share\n\
    0,0,0,torso,,walk,1\n1,0.05,0,torso,4,next,0.5\n1,0.05,0,torso,4,walk,0.25\n1,0.05,0,torso,7,step,0.25\n";

#[test]
fn actions_of_a_run_are_described_and_drawn_beside_its_errors() {
    let trial = with(&[("actions.csv", ACTIONS), ("markers.trc", TRC), ("true points.trc", TRC)]);
    let alone = trial.run(&["inspect", "actions.csv", "-o", "a.svg"]);
    let with_truth = trial.run(&["inspect", "actions.csv", "true points.trc", "-o", "b.svg"]);
    for output in [&alone, &with_truth] {
        assert!(output.status.success(), "{}", trial.printed(output));
    }
    insta::assert_snapshot!("inspect_actions", String::from_utf8(alone.stdout).unwrap());
    let has_errors = |name: &str| fs::read_to_string(trial.path(name)).unwrap().contains("joint error");
    assert!(!has_errors("a.svg") && has_errors("b.svg"));
    fs::write(trial.path("actions.csv"), ACTIONS.replace("step,0.25", "step,0.5")).unwrap();
    let printed = [&["inspect", "actions.csv"][..], &["inspect", "actions.csv", "-o", "actions.csv", "--force"]]
        .map(|arguments| trial.printed(&trial.run(arguments)));
    insta::assert_snapshot!("inspect_actions_refused", printed.concat());
}

const ASF: &str = ":units\n length 0.45\n angle deg\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n position 0 0 0\n orientation 0 0 0\n\
    :bonedata\n begin\n name thigh\n direction 0 -1 0\n length 7\n axis 0 0 20 XYZ\n dof rx ry\n end\n\
    begin\n name shin\n direction 0 -1 0\n length 7\n axis 0 0 20 XYZ\n dof rx\n end\n\
    :hierarchy\n begin\n root thigh\n thigh shin\n end\n";

const AMC: &str = ":FULLY-SPECIFIED\n:DEGREES\n5\nroot 0 16 0 10 20 30\nthigh 30 10\nshin 15\n6\nroot 0 16 1 0 0 0\nthigh 0 5\nshin 20\n";

#[test]
fn an_acclaim_motion_becomes_what_its_skeleton_becomes() {
    let trial = with(&[("a.asf", ASF), ("a.amc", AMC)]);
    check(&trial, &["a.amc", "a.mot", "--skeleton", "a.asf"]);
    check(&trial, &["a.amc", "a.bvh", "--skeleton", "a.asf"]);
    check(&trial, &["a.bvh", "b.mot"]);
    let read = |name: &str| sinew::formats::mot::read(name, &fs::read_to_string(trial.path(name)).unwrap()).unwrap();
    let (direct, by_bvh) = (read("a.mot"), read("b.mot"));
    assert_eq!(direct.columns, by_bvh.columns);
    assert_eq!(direct.columns.len(), 6 + 3 + 3);
    for (a, b) in direct.rows.concat().iter().zip(by_bvh.rows.concat()) {
        assert!((a - b).abs() < 1e-5, "{a} {b}");
    }
}

#[test]
fn acclaim_files_are_described() {
    let trial = with(&[("a.asf", ASF), ("b.asf", ASF), ("a.amc", AMC), ("empty.amc", "")]);
    let shown = |arguments: &[&str]| {
        let output = trial.run(&[&["inspect"], arguments].concat());
        format!("{}{}", String::from_utf8_lossy(&output.stdout), trial.printed(&output))
    };
    insta::assert_snapshot!("inspect_asf", shown(&["a.asf"]));
    insta::assert_snapshot!("inspect_amc", shown(&["a.amc", "empty.amc"]));
    insta::assert_snapshot!("inspect_asf_and_amc", shown(&["a.amc", "a.asf"]));
    insta::assert_snapshot!("inspect_two_skeletons", shown(&["a.asf", "b.asf", "a.amc"]));
}

#[test]
fn what_cannot_be_is_said() {
    let files = [("a.trc", TRC), ("a.bvh", BVH), ("a.amc", AMC), ("a.xyz", "")];
    let trial = with(&[&files[..], &TABLES].concat());
    check(&trial, &["a.bvh", "a.mot"]);
    let printed: Vec<String> = [
        &["a.trc", "b.bvh"][..],
        &["a.trc", "b.mot"],
        &["a.mot", "b.glb"],
        &["a.glb", "b.trc"],
        &["a.mot", "b.trc"],
        &["a.mot", "b.bvh"],
        &["a.amc", "b.bvh"],
        &["a.trc", "b.amc"],
        &["a.xyz", "b.trc"],
        &["a.trc", "a.trc"],
        &["a.trc", "a.bvh", "--skeleton", "a.asf"],
        &["none.trc", "b.csv"],
        &["a.trc", "a.mot"],
        &["joints.csv", "b.trc"],
        &["angles.csv", "b.mot"],
        &["frames.csv", "b.trc"],
        &["markers_sd.csv", "b.mot"],
    ]
    .iter()
    .map(|arguments| {
        format!("convert {}\n{}", arguments.join(" "), trial.printed(&trial.run(&[&["convert"], *arguments].concat())))
    })
    .collect();
    insta::assert_snapshot!("impossible", printed.join("\n\n"));
}

#[test]
fn files_are_described() {
    let trial = with(&[("a.trc", &TRC.replace("\t2\tmm", "\t3\tmm")), ("a.bvh", BVH), ("notes.txt", "")]);
    let shown = |arguments: &[&str]| String::from_utf8(trial.run(&[&["inspect"], arguments].concat()).stdout).unwrap();
    insta::assert_snapshot!("inspect_motion", shown(&["a.trc", "a.bvh"]));
    trial.edit(&trial.path("Calib.toml"), |text| text.replace("translation = ", "translation = [9000.0, 0.0, 0.0] # "));
    let calibration = shown(&["Calib.toml"]);
    assert!(calibration.starts_with("Calib.toml: calibration of 4 cameras (Pose2Sim)\n  C1"), "{calibration}");
    assert!(calibration.contains("are translations in millimetres?"), "{calibration}");
    insta::assert_snapshot!("inspect_nothing", trial.printed(&trial.run(&["inspect", "notes.txt"])));
    let json: serde_json::Value = serde_json::from_slice(&trial.run(&["inspect", "a.bvh", "--json"]).stdout).unwrap();
    assert_eq!(json[0]["facts"]["frames"], "1 at 30 per second, 0.03 s");
}

#[test]
fn calibration_and_keypoints_are_compared() {
    let trial = trial(1.5);
    let shown =
        || String::from_utf8(trial.run(&["inspect", "Calib.toml", "pose", "--layout", "BODY_25B"]).stdout).unwrap();
    let fitting = shown();
    assert!(
        fitting.contains("fit of calibration and keypoints, frames 0..45") && fitting.contains("lag unknown"),
        "{fitting}"
    );
    // Two cameras take each other's place.
    trial.edit(&trial.path("Calib.toml"), |text| text.replace("C1", "CX").replace("C2", "C1").replace("CX", "C2"));
    let swapped = shown();
    assert!(swapped.contains("odd: ") && swapped.contains("look at what is odd"), "{swapped}");
}
