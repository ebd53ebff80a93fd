//! The result folder: complete, the same from run to run, never overwritten unasked.

use crate::common::{TRACK, Trial, files, trial};
use sinew_results::{LIST_NAME, RESULT_NAMES};
use std::fs;
use std::io::{BufRead as _, BufReader, Read as _};
use std::path::Path;
use std::process::Stdio;

/// What lies in a result folder, but for the list of it.
fn top(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names.retain(|name| name != LIST_NAME);
    names
}

fn check_done(trial: &Trial, more: &[&str]) {
    let output = trial.track(more);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
}

#[test]
fn everything_is_there_and_readable() {
    let trial = trial(0.3);
    check_done(&trial, &["--frames", "2..8"]);
    let out = trial.path("out");
    assert_eq!(top(&out), RESULT_NAMES);
    let text = |name: &str| fs::read_to_string(out.join(name)).unwrap();

    let header: Vec<String> = text("markers.trc").lines().take(6).map(Into::into).collect();
    insta::assert_snapshot!("trc_header", header.join("\n").replace('\t', "→"));
    let trc = sinew::formats::trc::read("markers.trc", &text("markers.trc")).unwrap();
    assert_eq!((trc.frames.len(), trc.frames[0].number, trc.warnings.len()), (6, 1, 0));
    assert_eq!(trc.frames[0].time_s, 2.0 / 30.0);

    let mot = sinew::formats::mot::read("angles.mot", &text("angles.mot")).unwrap();
    assert_eq!((mot.rows.len(), mot.in_degrees, mot.warnings.len()), (6, true, 0));
    let bvh = sinew::formats::bvh::read("motion.bvh", &text("motion.bvh")).unwrap();
    assert_eq!((bvh.frames.len(), bvh.warnings.len()), (6, 0));

    for name in ["joints.csv", "keypoints.csv", "angles.csv", "state.csv", "frames.csv", "markers_sd.csv"] {
        insta::assert_snapshot!(format!("columns_{name}"), text(name).lines().next().unwrap());
        // A diagnostic of so short a run may be undefined; an estimate may not.
        assert!(name == "frames.csv" || !text(name).contains("NaN"), "{name}");
    }
    assert_eq!(text("joints.csv").lines().count(), 1 + 6 * 26);
    assert_eq!(text("keypoints.csv").lines().count(), 1 + 6 * 25);
    assert_eq!(text("frames.csv").lines().count(), 1 + 6);

    let summary: serde_json::Value = serde_json::from_str(&text("summary.json")).unwrap();
    assert_eq!(summary["complete"], true);
    assert_eq!(summary["frames"], serde_json::json!([2, 8]));
    for joint in summary["uncertainty"]["joints"].as_array().unwrap() {
        let share = |source: &str| joint[source].as_f64().unwrap();
        let all: f64 = ["frames", "cameras", "lengths", "places", "biases", "lags"].map(share).iter().sum();
        assert!((all - 1.0).abs() < 1e-9, "{joint}");
    }
    assert_eq!(summary["settings"]["frames"], serde_json::json!({ "value": "2..8", "origin": "flag" }));
    for key in ["threads", "calibration", "keypoints", "out"] {
        assert!(summary["settings"].get(key).is_none(), "{key}");
    }
    assert!(!text("summary.json").contains(&trial.folder.path().display().to_string()));
    let zarr: serde_json::Value = serde_json::from_str(&text("posterior.zarr/zarr.json")).unwrap();
    assert_eq!(zarr["consolidated_metadata"]["kind"], "inline");
    assert!(!out.join("posterior.zarr/sample_stats/log_weight").exists());
    let observed = &zarr["consolidated_metadata"]["metadata"]["observed_data/pixel"];
    assert_eq!(observed["dimension_names"], serde_json::json!(["frame", "camera", "keypoint", "image_axis"]));
    // Six frames in a chunk; the first number is the u of the first camera's first keypoint.
    let chunk = fs::read(out.join("posterior.zarr/observed_data/pixel/c.0.0.0.0")).unwrap();
    let first = f32::from_le_bytes([chunk[0], chunk[1], chunk[2], chunk[3]]);
    assert!(first.is_nan() || (0.0..2000.0).contains(&first), "{first}");
}

/// The mean pose is the same in the markers, the skeleton and the coordinates of the state.
#[test]
fn files_agree_with_each_other() {
    let trial = trial(0.2);
    check_done(&trial, &[]);
    let read = |name: &str| fs::read_to_string(trial.path("out").join(name)).unwrap();
    let trc = sinew::formats::trc::read("markers.trc", &read("markers.trc")).unwrap();
    let bvh = sinew::formats::bvh::read("motion.bvh", &read("motion.bvh")).unwrap();
    let arms =
        [("RElbow", "r_forearm"), ("LElbow", "l_forearm"), ("RShoulder", "r_upper_arm"), ("LShoulder", "l_upper_arm")];
    let legs = [
        ("RHip", "r_thigh"),
        ("LHip", "l_thigh"),
        ("RKnee", "r_shin"),
        ("LKnee", "l_shin"),
        ("RAnkle", "r_foot"),
        ("LAnkle", "l_foot"),
    ];
    for (marker, joint) in arms.into_iter().chain(legs) {
        for frame in 0..trc.frames.len() {
            let a = trc.point_in_world(frame, trc.marker_index(marker).unwrap()).unwrap();
            let b = bvh.positions(frame).unwrap().into_iter().find(|(name, _)| name == joint).unwrap().1;
            let b = sinew::formats::bvh::world_from_bvh(b);
            for k in 0..3 {
                assert!((a[k] - b[k]).abs() < 1e-6, "{marker} frame {frame}: {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn runs_are_the_same_but_for_their_times() {
    let trial = trial(0.3);
    for (out, threads) in [("-oone", "1"), ("-otwo", "2"), ("-othree", "8")] {
        check_done(&trial, &[out, "--threads", threads]);
    }
    let [mut one, mut two, mut three] = ["one", "two", "three"].map(|name| files(&trial.path(name)));
    for all in [&mut one, &mut two, &mut three] {
        assert!(all.remove("timings.json").is_some());
    }
    assert!(one == two && one == three);
    // What a run leaves behind repeats it.
    let again =
        trial.run(&["track", "--config", "one/config.toml", "-oagain", "--setup", "one/setup.toml", "--no-progress"]);
    assert_eq!(again.status.code(), Some(0), "{}", trial.printed(&again));
    assert_eq!(fs::read(trial.path("again/joints.csv")).unwrap(), one["joints.csv"]);
}

#[test]
fn smoothed_results_say_so() {
    let trial = trial(0.3);
    check_done(&trial, &["--smooth"]);
    let text = |name: &str| fs::read_to_string(trial.path("out").join(name)).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&text("summary.json")).unwrap();
    assert_eq!(summary["kind"], "smoothed");
    assert!(text("posterior.zarr/zarr.json").contains("one draw index is one trajectory"));
    assert_eq!(top(&trial.path("out")), RESULT_NAMES);
}

#[test]
fn a_standing_trial_is_the_zero_of_angles() {
    let trial = trial(0.3);
    check_done(&trial, &["-ostanding", "--smooth"]);
    check_done(&trial, &["-ofirst", "--setup=standing/setup.toml"]);
    check_done(&trial, &["-ozeroed", "--setup=standing/setup.toml", "--static=standing"]);
    let coordinates = |out: &str| {
        let text = fs::read_to_string(trial.path(out).join("angles.mot")).unwrap();
        sinew::formats::mot::read("angles.mot", &text).unwrap()
    };
    let summary: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(trial.path("zeroed/summary.json")).unwrap()).unwrap();
    let (first, zeroed) = (coordinates("first"), coordinates("zeroed"));
    let mut moved = 0;
    for (column, name) in first.columns.iter().enumerate() {
        let zero = summary["angles"]["zero_deg"][name][0].as_f64().unwrap_or(0.0);
        for (a, b) in first.rows.iter().zip(&zeroed.rows) {
            assert!((a[column] - zero - b[column]).abs() < 1e-6, "{name}: {} - {zero} is {}", a[column], b[column]);
        }
        moved += usize::from(zero != 0.0);
    }
    // All angles but OpenSim's of the pelvis, which depend on the heading, and the ones that keypoints do not show.
    let standing: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(trial.path("standing/summary.json")).unwrap()).unwrap();
    let unseen = &standing["angles"]["unseen"];
    let has_zero = |name: &&String| {
        !name.starts_with("pelvis_") && unseen[name.as_str()].as_f64().is_none_or(|share| share <= 0.5)
    };
    let expected = first.columns.iter().filter(has_zero).count();
    assert_eq!((moved, summary["angles"]["zero_deg"].as_object().unwrap().len()), (expected, expected));
    assert!((10..28).contains(&expected), "{unseen}");
    let warnings = summary["warnings"].to_string();
    assert!(warnings.contains("standing trial: its keypoints do not show"), "{warnings}");
    let inspected = String::from_utf8(trial.run(&["inspect", "zeroed"]).stdout).unwrap();
    assert!(inspected.contains("zero of angles"), "{inspected}");
    // A trial that was zeroed itself gives the same zero, since its draws were not.
    let by = |out: &str, zero: &str| {
        check_done(&trial, &[out, "--setup=standing/setup.toml", zero]);
        let text = fs::read_to_string(trial.path(&format!("{}/summary.json", &out[2..]))).unwrap();
        serde_json::from_str::<serde_json::Value>(&text).unwrap()["angles"]["zero_deg"].clone()
    };
    assert_eq!(by("-oonce", "--static=first"), by("-otwice", "--static=zeroed"));
    insta::assert_snapshot!("standing_body", trial.track_printed(&["-onone", "--body=cf28", "--static=standing"]));
    insta::assert_snapshot!("standing_angles", trial.track_printed(&["-onone", "--angles=isb", "--static=standing"]));
    assert_eq!(summary["angles"]["convention"], "opensim");
    let refused = trial.track_printed(&["-onone", "--static=pose"]);
    assert!(refused.contains("pose") && refused.contains("summary.json"), "{refused}");
}

#[test]
fn particles_bring_their_weights() {
    let trial = trial(0.2);
    check_done(&trial, &["--method", "bootstrap", "--particles", "512", "--min-ess=0"]);
    let stats = trial.path("out/posterior.zarr/sample_stats");
    assert!(stats.join("log_weight").is_dir() && stats.join("resampled").is_dir() && !stats.join("energy").exists());
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(trial.path("out/summary.json")).unwrap()).unwrap();
    assert!(summary["diagnostics"]["r_hat"].is_null());
}

#[test]
fn results_are_not_overwritten() {
    let trial = trial(0.2);
    check_done(&trial, &[]);
    insta::assert_snapshot!("exists", trial.track_printed(&[]));
    fs::remove_file(trial.path("out/summary.json")).unwrap();
    insta::assert_snapshot!("not_empty", trial.track_printed(&[]));
    fs::write(trial.path("out/summary.json"), r#"{"complete": false}"#).unwrap();
    fs::write(trial.path("out/notes.txt"), "mine").unwrap();
    check_done(&trial, &[]);
    check_done(&trial, &["--force"]);
    assert_eq!(fs::read_to_string(trial.path("out/notes.txt")).unwrap(), "mine");
}

#[test]
fn folders_that_cannot_be_results() {
    let trial = trial(0.1);
    insta::assert_snapshot!("output_is_input", trial.track_printed(&["-opose"]));
    fs::create_dir(trial.path("old")).unwrap();
    fs::write(trial.path("old/setup.toml"), "").unwrap();
    insta::assert_snapshot!(
        "output_holds_input",
        trial.track_printed(&["-oold", "--setup", "old/setup.toml", "--force"])
    );
    fs::write(trial.path("file"), "").unwrap();
    insta::assert_snapshot!("output_is_file", trial.track_printed(&["-ofile"]));
    insta::assert_snapshot!(
        "output_below_file",
        trial.track_printed(&["-ofile/out"]).replace("Not a directory (os error 20)", "[cause]")
    );
}

#[test]
fn a_folder_in_use_is_refused() {
    let trial = trial(0.1);
    let claim = sinew_results::claim(&trial.path("out"), &[], false).unwrap();
    let printed = trial.track_printed(&[]).replace(&std::process::id().to_string(), "[pid]");
    insta::assert_snapshot!("in_use", printed);
    drop(claim);
    fs::create_dir_all(trial.path("out")).unwrap();
    fs::write(trial.path("out").join(sinew_results::LOCK_NAME), "4000000\n").unwrap();
    insta::assert_snapshot!("stale_lock", trial.track_printed(&[]));
}

/// Sends a signal once tracking has begun; gives the exit code.
#[cfg(unix)]
fn interrupted(trial: &Trial, signal: &str) -> Option<i32> {
    let arguments: Vec<&str> = TRACK.iter().copied().filter(|argument| *argument != "--no-progress").collect();
    let mut child = trial
        .command(&arguments)
        .args(["--setup-frames=0..5", "-oout"])
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    assert!(lines.any(|line| line.unwrap().starts_with("tracking: 10 %")));
    let id = child.id().to_string();
    assert!(std::process::Command::new("kill").args([signal, &id]).status().unwrap().success());
    let code = child.wait().unwrap().code();
    let rest: Vec<String> = lines.map_while(Result::ok).collect();
    assert!(rest.iter().any(|line| line.starts_with("interrupted; what was done is written")), "{rest:?}");
    code
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_what_was_done() {
    let trial = trial(6.0);
    for signal in ["-INT", "-TERM"] {
        assert_eq!(interrupted(&trial, signal), Some(75));
        let text = |name: &str| fs::read_to_string(trial.path("out").join(name)).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&text("summary.json")).unwrap();
        assert_eq!(summary["complete"], false);
        let frames = usize::try_from(summary["frame_count"].as_u64().unwrap()).unwrap();
        assert!((1..180).contains(&frames), "{frames}");
        assert_eq!(text("frames.csv").lines().count(), 1 + frames);
        let trc = sinew::formats::trc::read("markers.trc", &text("markers.trc")).unwrap();
        assert_eq!((trc.frames.len(), trc.warnings.len()), (frames, 0));
        // What is needed to resume stays.
        let kept = ["checkpoint.bin", "chunks.partial", "diagnostics.partial"];
        let results: Vec<String> =
            top(&trial.path("out")).into_iter().filter(|name| !kept.contains(&name.as_str())).collect();
        assert_eq!(
            (results.len() + kept.len(), &results[..]),
            (top(&trial.path("out")).len(), &RESULT_NAMES.map(String::from)[..])
        );
        fs::remove_dir_all(trial.path("out")).unwrap();
    }
}

#[cfg(unix)]
#[test]
fn a_second_interrupt_ends_at_once() {
    let trial = trial(1.0);
    check_done(&trial, &["-oquick", "--frames", "0..2"]);
    let mut child = trial
        .command(&[&TRACK[..9], &["--setup=quick/setup.toml", "--chains=512", "--updates=2000", "-oout"]].concat())
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let id = child.id().to_string();
    let interrupt = || assert!(std::process::Command::new("kill").args(["-INT", &id]).status().unwrap().success());
    while !trial.path("out/joints.csv.partial").exists() {
        std::thread::sleep(std::time::Duration::from_millis(5));
        assert!(child.try_wait().unwrap().is_none());
    }
    interrupt();
    assert!(lines.any(|line| line.unwrap().starts_with("interrupted: finishing the frame")));
    interrupt();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(!trial.path("out/summary.json").exists());
}

#[cfg(target_os = "linux")]
#[test]
fn places_that_cannot_be_written_are_named() {
    use std::os::unix::fs::PermissionsExt as _;
    let trial = trial(0.1);
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = trial.command(&["body", "h32"]).stdout(full).output().unwrap();
    let printed = trial.printed(&output);
    assert!(printed.starts_with("exit 5") && printed.contains("standard output"), "{printed}");
    let locked = trial.path("locked");
    fs::create_dir(&locked).unwrap();
    fs::set_permissions(&locked, fs::Permissions::from_mode(0o555)).unwrap();
    // Those who may do anything are not stopped by permissions.
    if fs::write(locked.join("probe"), "").is_err() {
        let printed = trial.track_printed(&["-olocked/out"]);
        assert!(printed.starts_with("exit 5") && printed.contains("locked/out"), "{printed}");
    }
}

#[test]
fn a_particle_filter_that_failed_says_so_after_smoothing_too() {
    let trial = trial(0.3);
    for smooth in [&[][..], &["--smooth"]] {
        let method = ["--method=bootstrap", "--particles=32", "-oout", "--force"];
        let printed = trial.printed(&trial.run(&[&TRACK[..], &method, smooth].concat()));
        assert!(printed.starts_with("exit 4\n"), "{printed}");
        assert!(printed.contains("diagnostic failed: the median effective sample size is "), "{printed}");
    }
}

/// Run with the Python named by `SINEW_PYTHON`, or `python3`, as far as it has the wheels.
#[test]
fn the_loader_opens_the_results() {
    let trial = trial(0.2);
    check_done(&trial, &[]);
    let python = |arguments: &[&str]| {
        let python = std::env::var_os("SINEW_PYTHON").unwrap_or_else(|| "python3".into());
        let run = std::process::Command::new(python).current_dir(trial.path("out")).args(arguments).output();
        run.ok().map(|output| (output.status.success(), String::from_utf8_lossy(&output.stdout).into_owned()))
    };
    let has = |module: &str| python(&["-c", &format!("import {module}")]).is_some_and(|(is_there, _)| is_there);
    if !["numpy", "pandas", "xarray"].into_iter().all(has) {
        sinew_tests::data::skipped("no Python with numpy, pandas and xarray");
        return;
    }
    let (is_done, shown) = python(&["load.py", "3"]).unwrap();
    assert!(is_done && shown.contains("RKnee") && shown.contains("marker_position"), "{shown}");
    // With the wheel zarr and without it, the values are the same.
    let both = "import load, xarray as xr; t = load.tree(); g = {p.parent.name: load.dataset(p.parent) for p in load.here.glob('posterior.zarr/*/zarr.json')}; [xr.testing.assert_identical(t[n].to_dataset().load().drop_attrs(), d.drop_attrs()) for n, d in g.items()]; print(len(g))";
    assert_eq!(python(&["-c", both]), Some((true, "4\n".into())));
    if has("arviz") {
        let summary = "import load, arviz as az; d = load.inference_data().posterior; d = d.to_dataset() if hasattr(d, 'to_dataset') else d; print(len(az.summary(d.isel(frame=3), var_names=['root'])))";
        assert_eq!(python(&["-W", "ignore", "-c", summary]), Some((true, "3\n".into())));
    }
}

/// What programs draw as bones: each ends where all its children begin, and has a length.
#[test]
fn bones_are_joined() {
    let trial = trial(0.1);
    for body in ["h32", "cf28"] {
        check_done(&trial, &["--force", "--body", body]);
        let text = fs::read_to_string(trial.path("out/motion.bvh")).unwrap();
        let bvh = sinew::formats::bvh::read("motion.bvh", &text).unwrap();
        for (index, joint) in bvh.joints.iter().enumerate() {
            let children = bvh.joints.iter().filter(|child| child.parent == Some(index)).map(|child| child.offset);
            let ends: Vec<[f64; 3]> = children.chain(joint.end_site).collect();
            let length = ends.first().map_or(0.0, |[x, y, z]| x.hypot(*y).hypot(*z));
            assert!(length > 1e-3 && ends.iter().all(|end| *end == ends[0]), "{}: {ends:?}", joint.name);
        }
    }
}

#[test]
fn a_run_that_was_stopped_is_not_replaced_unasked() {
    let trial = trial(0.3);
    check_done(&trial, &["-owhole"]);
    let setup = "--setup=whole/setup.toml";
    fs::create_dir(trial.path("out")).unwrap();
    fs::write(trial.path("out").join(sinew_results::problem::NAME), "").unwrap();
    fs::write(trial.path("out/joints.csv.partial"), "").unwrap();
    fs::write(trial.path("out").join(LIST_NAME), r#"{"sinew_wrote": ["checkpoint.bin", "joints.csv.partial"]}"#)
        .unwrap();
    insta::assert_snapshot!("stopped_run", trial.track_printed(&[setup]));
    assert_eq!(fs::read(trial.path("out").join(sinew_results::problem::NAME)).unwrap(), b"");
    check_done(&trial, &[setup, "--force"]);
    assert_eq!(top(&trial.path("out")), RESULT_NAMES);
}

#[test]
fn a_failed_run_leaves_no_folder() {
    let trial = trial(0.1);
    for camera in 1..=4 {
        for frame in 0..3 {
            fs::write(trial.keypoints(camera, frame), r#"{"people": []}"#).unwrap();
        }
    }
    let printed = trial.track_printed(&["-onew/out"]);
    assert!(printed.starts_with("exit 3\n"), "{printed}");
    assert!(!trial.path("new").exists());
    fs::create_dir(trial.path("mine")).unwrap();
    assert!(trial.track_printed(&["-omine/out"]).starts_with("exit 3\n"));
    assert_eq!(top(&trial.path("mine")), Vec::<String>::new());
}

#[test]
fn mistakes_in_flags_are_said_before_what_exists() {
    let trial = trial(0.1);
    check_done(&trial, &[]);
    assert!(trial.track_printed(&[]).starts_with("exit 5\nerror: `out` exists and holds results"));
    for (flag, said) in [
        ("--cameras=C1,nobody", "nobody"),
        ("--setup-frames=900..901", "set-up frames 900..901 were requested"),
        ("--setup=none.toml", "none.toml"),
        ("--body=h33", "h33"),
        ("--frames=50..60", "50..60"),
    ] {
        let printed = trial.track_printed(&[flag]);
        assert!(
            !printed.contains("exists") && printed.contains(said) && !printed.starts_with("exit 5\nerror: `out`"),
            "{printed}"
        );
    }
}

#[test]
fn quiet_keeps_warnings_and_twice_keeps_errors_only() {
    let trial = trial(0.1);
    let printed = |quiet: &[&str]| trial.track_printed(&[&["--force", "--particles=9"], quiet].concat());
    let lines = |text: &str, kind: &str| text.lines().filter(|line| line.starts_with(kind)).count();
    let all = printed(&[]);
    assert!(lines(&all, "warning") > 0);
    assert_eq!(lines(&printed(&["-q"]), "warning"), lines(&all, "warning"));
    assert_eq!(lines(&printed(&["-qq"]), "warning"), 0);
    let failed = printed(&["-qq", "--cameras=nobody"]);
    assert_eq!((lines(&failed, "error"), lines(&failed, "help")), (1, 1), "{failed}");
}

#[test]
fn a_closed_pipe_is_no_error() {
    let trial = trial(0.1);
    let mut child = trial.command(&["man"]).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let mut printed = String::new();
    child.stderr.take().unwrap().read_to_string(&mut printed).unwrap();
    assert_eq!((child.wait().unwrap().code(), printed.as_str()), (Some(0), ""));
}

#[test]
fn the_demo_prints_its_error_and_can_be_repeated() {
    let trial = trial(0.1);
    let output = trial.run(&["demo", "--no-progress"]);
    let printed = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    for word in [
        "simulated",
        "mean error",
        "coverage",
        "ms per frame",
        "results",
        "sinew track --calibration sinew-out/demo/Calib.toml",
        "sinew-out/demo/report.html",
    ] {
        assert!(printed.contains(word), "{word} in {printed}");
    }
    assert!(
        ["keypoints/C1_json", "Calib.toml", "truth.trc", "report.html"]
            .iter()
            .all(|name| trial.path("sinew-out/demo").join(name).exists())
    );
    let json = trial.run(&["demo", "--json", "-q"]);
    let answer: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert!(answer["mean_error_mm"].as_f64().unwrap() < 60.0, "{answer}");
    // Warnings are kept, progress and notes are not.
    let printed = String::from_utf8_lossy(&json.stderr).into_owned();
    let is_kept = |line: &str| ["diagnostic failed", "warning"].iter().any(|kind| line.starts_with(kind));
    assert!(printed.lines().all(is_kept), "{printed}");
}
