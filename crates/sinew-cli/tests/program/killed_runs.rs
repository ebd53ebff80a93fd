//! A program that was killed or interrupted is resumed, or says why it cannot be.

use crate::common::synthetic::Whole;
use crate::common::{Files, QUICK, TRACK, Trial, crc32, files, made_once, trial};
use sinew::core::random::Stage;
use sinew::track::checkpoint::{self, Checkpoint};
use sinew_results::problem;
use std::collections::BTreeSet;
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, Output, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// A trial with a set-up, so that runs are short.
fn prepared() -> Trial {
    static SET_UP: OnceLock<Files> = OnceLock::new();
    let trial = made_once(&SET_UP, || {
        let trial = trial(1.0);
        let output = trial.track(&["-omade", "--frames=0..10"]);
        assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
        fs::rename(trial.path("made/setup.toml"), trial.path("setup.toml")).unwrap();
        fs::remove_dir_all(trial.path("made")).unwrap();
        trial
    });
    let output = trial.track(&["-owhole", SETUP]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    trial
}

const SETUP: &str = "--setup=setup.toml";

/// A run of the program into `out` with checkpoints after every frame.
fn started(trial: &Trial, more: &[&str]) -> Child {
    let arguments = [&TRACK[..], &QUICK, &["-oout", "--checkpoint-every=0", SETUP], more].concat();
    trial.command(&arguments).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap()
}

fn finished(child: Child) -> Output {
    child.wait_with_output().unwrap()
}

/// Says which files differ.
fn check_same_results(trial: &Trial, out: &str) {
    let [mut whole, mut other] = ["whole", out].map(|name| files(&trial.path(name)));
    // Who was killed after all else was done leaves its lock file.
    other.remove(sinew_results::LOCK_NAME);
    assert!(whole.remove("timings.json").is_some() && other.remove("timings.json").is_some());
    let differ = |name: &&String| whole.get(*name) != other.get(*name);
    let different = whole.keys().chain(other.keys()).filter(differ).collect::<BTreeSet<_>>();
    assert!(different.is_empty(), "{different:?} of {out} differ from those of a whole run");
}

/// What has its final name is whole, at any moment; the list of files grows on the way.
fn check_final_names(trial: &Trial) {
    let whole = files(&trial.path("whole"));
    for (name, bytes) in files(&trial.path("out")) {
        let is_final = !name.contains(".partial")
            && whole.contains_key(&name)
            && !["timings.json", "sinew.files"].contains(&name.as_str());
        assert!(!is_final || whole[&name] == bytes, "{name}");
    }
}

/// Fifty times, at seeded moments spread over a run of half a second; a killed run is resumed, and killed again.
#[test]
fn a_run_killed_at_any_moment_resumes() {
    const FRAMES: &str = "--frames=0..15";
    let trial = prepared();
    let output = trial.track(&["-owhole", "--force", SETUP, FRAMES]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    let clock = Instant::now();
    let output = finished(started(&trial, &[FRAMES]));
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    let mut whole_s = clock.elapsed().as_secs_f64();
    fs::remove_dir_all(trial.path("out")).unwrap();
    let (mut kills, mut completed) = (0, 0);
    let mut rng = Stage::new(31, "kill").whole();
    let mut moments = [sinew::core::lanes::Block::ZERO; 64];
    rng.fill_uniform(&mut moments);
    let mut moments = moments.into_iter().flat_map(|block| block.0);
    while kills < 50 {
        let Some(moment) = moments.next() else { break };
        let more: &[&str] = match trial.path("out").join(problem::NAME).exists() {
            true => &[FRAMES, "--resume", "--threads=2"],
            false => &[FRAMES, "--threads=1"],
        };
        let mut child = started(&trial, more);
        let begun = Instant::now();
        let mut has_ended = false;
        while !has_ended && begun.elapsed().as_secs_f64() < whole_s * moment {
            std::thread::sleep(Duration::from_millis(1));
            has_ended = child.try_wait().unwrap().is_some();
        }
        // The machine may have been busy with other things when the first run was timed.
        whole_s = if has_ended && more.len() == 2 { whole_s.min(begun.elapsed().as_secs_f64()) } else { whole_s };
        let _ = child.kill();
        let output = finished(child);
        if has_ended {
            assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
            check_same_results(&trial, "out");
            fs::remove_dir_all(trial.path("out")).unwrap();
            completed += 1;
        } else {
            kills += 1;
            if trial.path("out").exists() {
                check_final_names(&trial);
            }
            // Killed when all was done, perhaps before the list of files forgot what was removed.
            if trial.path("out/summary.json").exists() && !trial.path("out").join(problem::NAME).exists() {
                let output = finished(started(&trial, &[FRAMES, "--resume"]));
                assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
                check_same_results(&trial, "out");
                fs::remove_dir_all(trial.path("out")).unwrap();
            }
        }
    }
    println!("{kills} kills, {completed} runs completed in between, {whole_s:.2} s a whole run");
    assert_eq!(kills, 50);
    if trial.path("out").join(problem::NAME).exists() {
        let output = finished(started(&trial, &[FRAMES, "--resume"]));
        assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
        check_same_results(&trial, "out");
    }
}

/// Killed while it smooths: the backward pass is done again, and gives the files of a whole run.
#[test]
fn a_run_killed_while_smoothing_resumes() {
    let trial = prepared();
    fs::remove_dir_all(trial.path("whole")).unwrap();
    let output = trial.track(&["-owhole", SETUP, "--smooth"]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    let mut killed = 0;
    for _ in 0..4 {
        let mut child = started(&trial, &["--smooth", "--threads=1"]);
        // The backward pass creates the file of trajectories; it is gone at the end.
        while !trial.path("out/trajectories.partial").exists() && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        let _ = child.kill();
        finished(child);
        if !trial.path("out/summary.json").exists() {
            let from = checkpoint::read(&trial.path("out")).unwrap();
            assert!(from.done == from.frames.end && from.spool.is_some());
            killed += 1;
            let output = finished(started(&trial, &["--smooth", "--resume", "--threads=2"]));
            let printed = trial.printed(&output);
            assert_eq!(output.status.code(), Some(0), "{printed}");
            let note = "left its lock in out; it is gone, the lock is taken over";
            assert!(printed.lines().any(|line| line.starts_with("process ") && line.ends_with(note)), "{printed}");
        }
        check_same_results(&trial, "out");
        fs::remove_dir_all(trial.path("out")).unwrap();
    }
    assert!(killed > 0);
}

/// Killed before its first frame, a run has nothing to resume from, and that is said; it starts again without `--force`.
#[test]
fn a_run_killed_in_its_set_up_starts_again() {
    let trial = trial(1.0);
    let arguments: Vec<&str> = TRACK.iter().copied().filter(|argument| *argument != "--no-progress").collect();
    let mut child = trial
        .command(&[&arguments[..], &QUICK, &["-oout"]].concat())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    assert!(lines.any(|line| line.unwrap().starts_with("set-up: 10 %")));
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!trial.path("out").join(problem::NAME).exists());
    let output = trial.track(&["--resume"]);
    let printed = trial.printed(&output);
    let lines: Vec<&str> = printed.lines().filter(|line| !line.contains("left its lock in")).collect();
    insta::assert_snapshot!("killed_in_set_up", lines.join("\n"));
    let output = trial.track(&[]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
}

/// Complete results are left alone only if they belong to the settings and data that are given.
#[test]
fn complete_results_are_compared() {
    let trial = prepared();
    let before = files(&trial.path("whole"));
    let output = trial.track(&["-owhole", SETUP, "--resume"]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(printed, "nothing to do: the results in whole are complete, of these settings and data\n");
    // A setting that changes no number.
    assert!(printed_for(&trial, &["--checkpoint-every=3"]).starts_with("exit 0"));
    assert!(printed_for(&trial, &["--frames=0..20"]).contains("`frames` was not set and is \"0..20\""));
    let last = trial.keypoints(1, 29);
    let text = fs::read_to_string(&last).unwrap();
    fs::write(&last, format!("{text}\n")).unwrap();
    insta::assert_snapshot!("complete_of_other_data", printed_for(&trial, &[]));
    fs::write(&last, text).unwrap();
    trial.edit(&trial.path("setup.toml"), |text| format!("{text}\n# a remark\n"));
    assert!(printed_for(&trial, &[]).contains("holds a run on other data: the content of `setup` has changed"));
    assert!(files(&trial.path("whole")) == before);
}

/// What `--resume` says of the complete results of [`prepared`].
fn printed_for(trial: &Trial, more: &[&str]) -> String {
    printed(trial, &[&["-owhole"], more].concat())
}

/// Four times each at seeded moments: ends within two seconds with code 75, and what is there holds the frames that were done and nothing else.
#[cfg(unix)]
#[test]
fn a_run_interrupted_at_any_moment_resumes() {
    let trial = prepared();
    let mut moments = [sinew::core::lanes::Block::ZERO; 1];
    Stage::new(32, "interrupt").whole().fill_uniform(&mut moments);
    let mut interrupted = 0;
    for (i, moment) in moments[0].0.into_iter().enumerate() {
        let child = started(&trial, &[]);
        while !trial.path("out").join(problem::NAME).exists() {
            std::thread::sleep(Duration::from_millis(2));
        }
        std::thread::sleep(Duration::from_secs_f64(0.3 * moment));
        let signal = ["-INT", "-TERM"][i % 2];
        let sent = Instant::now();
        let _ = std::process::Command::new("kill").args([signal, &child.id().to_string()]).status();
        let output = finished(child);
        if output.status.code() != Some(0) {
            interrupted += 1;
            assert_eq!(output.status.code(), Some(75), "{}", trial.printed(&output));
            assert!(sent.elapsed() < Duration::from_secs(2), "{:?}", sent.elapsed());
            assert!(trial.printed(&output).contains("the same command with `--resume` continues from there"));
            let text = |name: &str| fs::read_to_string(trial.path("out").join(name)).unwrap();
            let summary: serde_json::Value = serde_json::from_str(&text("summary.json")).unwrap();
            assert_eq!(summary["complete"], false);
            let done = summary["frame_count"].as_u64().unwrap() as usize;
            assert_eq!(text("frames.csv").lines().count(), 1 + done);
            assert!(!text("joints.csv").contains("NaN") && !text("markers.trc").contains("NaN"));
            let array: serde_json::Value =
                serde_json::from_str(&text("posterior.zarr/posterior/angle/zarr.json")).unwrap();
            assert_eq!(array["shape"][2], done);
            let output = finished(started(&trial, &["--resume"]));
            assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
        }
        check_same_results(&trial, "out");
        fs::remove_dir_all(trial.path("out")).unwrap();
    }
    assert!(interrupted >= 2, "{interrupted} of 8 were interrupted before their end");
}

/// A run that was killed in the middle of its frames, and what `--resume` says of it.
fn printed(trial: &Trial, more: &[&str]) -> String {
    let output = trial.track(&[&[SETUP, "--resume"], more].concat());
    let pids = trial.printed(&output);
    pids.lines().filter(|line| !line.contains("left its lock in")).collect::<Vec<_>>().join("\n")
}

#[cfg(unix)]
#[test]
fn what_cannot_resume_says_why() {
    let trial = prepared();
    insta::assert_snapshot!("no_folder", printed(&trial, &["-onowhere"]));
    fs::create_dir(trial.path("empty")).unwrap();
    insta::assert_snapshot!("no_checkpoint", printed(&trial, &["-oempty"]));
    insta::assert_snapshot!("complete", printed(&trial, &["-owhole"]));
    insta::assert_snapshot!("complete_of_others", printed(&trial, &["-owhole", "--seed=2"]));
    insta::assert_snapshot!("resume_and_force", printed(&trial, &["-oempty", "--force"]));

    let mut child = started(&trial, &[]);
    while checkpoint::read(&trial.path("out")).map_or(0, |checkpoint| checkpoint.done) < 3 {
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let path = trial.path("out").join(problem::NAME);
    let bytes = fs::read(&path).unwrap();
    insta::assert_snapshot!("other_settings", printed(&trial, &["--seed=2", "--least-confidence=0.2"]));
    insta::assert_snapshot!("other_frames", printed(&trial, &["--frames=0..20"]));
    let set = Checkpoint::decode(&bytes).unwrap().isa;
    if set != "baseline" {
        assert!(
            printed(&trial, &["--simd=baseline"]).contains(&format!("the instruction set was {set} and is baseline"))
        );
    }

    let keypoints = trial.keypoints(2, 5);
    let text = fs::read_to_string(&keypoints).unwrap();
    fs::write(&keypoints, text.replacen("0.", "0.1", 1)).unwrap();
    insta::assert_snapshot!("other_data", printed(&trial, &[]));
    fs::write(&keypoints, text).unwrap();
    trial.edit(&trial.path("setup.toml"), |text| format!("{text}\n# a remark\n"));
    insta::assert_snapshot!("other_set_up", printed(&trial, &[]));
    trial.edit(&trial.path("setup.toml"), |text| text.replace("\n# a remark\n", ""));

    let with = |bytes: &[u8]| {
        fs::write(&path, bytes).unwrap();
        let printed = printed(&trial, &[]);
        assert!(!trial.path("out/summary.json").exists(), "{printed}");
        printed
    };
    assert!(with(&bytes[..bytes.len() / 2]).contains("was cut or is damaged"));
    let mut flipped = bytes.clone();
    flipped[100] ^= 4;
    assert!(with(&flipped).contains("holds a damaged `checkpoint.bin`: its checksum is"));
    insta::assert_snapshot!("foreign", with(b"something else altogether"));
    let older = Checkpoint { program: "0.0.1".into(), ..Checkpoint::decode(&bytes).unwrap() };
    insta::assert_snapshot!("other_version", with(&older.encode().unwrap()));
    let mut newer = bytes[..bytes.len() - 4].to_vec();
    newer[16] += 1;
    newer.extend(crc32(&newer).to_le_bytes());
    insta::assert_snapshot!("other_format", with(&newer));
    fs::write(&path, &bytes).unwrap();

    let joints = trial.path("out/joints.csv.partial");
    let table = fs::read_to_string(&joints).unwrap();
    fs::write(&joints, table.replacen("RKnee", "LKnee", 1)).unwrap();
    insta::assert_snapshot!("changed_file", printed(&trial, &[]));
    fs::write(&joints, &table[..table.len() / 4]).unwrap();
    assert!(printed(&trial, &[]).contains("`out/joints.csv.partial` was changed or cut"));
    fs::write(&joints, table).unwrap();

    // And with everything as it was, it does resume.
    let printed = printed(&trial, &[]);
    assert!(printed.starts_with("exit 0"), "{printed}");
    check_same_results(&trial, "out");
}

/// Without `--resume` a run that was stopped is kept, whatever it was stopped by.
#[test]
fn a_stopped_run_is_kept_until_force_is_given() {
    let whole = Whole::new(&[]);
    let trial = trial(0.2);
    whole.run(&trial.path("out"), 1, Some(3), None).unwrap();
    let before = files(&trial.path("out"));
    let printed = trial.track_printed(&[]);
    assert!(printed.starts_with("exit 5\nerror: `out` exists and holds a run that was stopped\n"), "{printed}");
    assert!(printed.contains("`--resume`") && printed.contains("`--force`") && files(&trial.path("out")) == before);
    let printed = trial.track_printed(&["--force"]);
    assert!(printed.starts_with("exit 0\n"), "{printed}");
}

/// What is compared is what the run read: all masks and images, keypoints of the set-up frames only.
#[test]
fn complete_results_from_silhouettes_are_compared() {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let simulate =
        ["simulate", "-orec", "--size=96x72", "--duration=0.4", "--cameras=2", "--images=3", "--no-progress"];
    assert_eq!(trial.run(&simulate).status.code(), Some(0));
    let track = |more: &[&str]| {
        let inputs = ["track", "--calibration=rec/Calib.toml", "--keypoints=rec/keypoints", "--layout=BODY_25B"];
        let start = ["--silhouettes=rec/masks", "--images=rec/images", "--init=keypoints", "--setup-frames=0..6"];
        let small = ["--method=annealed", "--particles=16", "--layers=2", "--draws=2", "--raster=64", "--fps=30"];
        let rest = ["--no-progress", "-oout"];
        trial.run(&[&inputs[..], &start, &small, &rest, more].concat())
    };
    let output = track(&[]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    let said = |output: &Output| String::from_utf8_lossy(&output.stdout).into_owned();
    let nothing = "nothing to do: the results in out are complete, of these settings and data\n";
    let output = track(&["--resume"]);
    assert_eq!(said(&output), nothing, "{}", trial.printed(&output));
    let changed = |path: &str| {
        let path = trial.path(path);
        let bytes = fs::read(&path).unwrap();
        let is_image = path.extension().is_some_and(|extension| extension == "png");
        let other = path.with_file_name(if is_image { "C1_0003.png" } else { "C2.0003.json" });
        fs::write(&path, fs::read(other).unwrap()).unwrap();
        let output = track(&["--resume"]);
        fs::write(&path, bytes).unwrap();
        (said(&output), trial.printed(&output))
    };
    assert!(changed("rec/masks/C2_0011.png").1.contains("the content of `silhouettes` has changed"));
    assert!(changed("rec/images/C2_0009.png").1.contains("the content of `images` has changed"));
    assert!(changed("rec/keypoints/C2_json/C2.0002.json").1.contains("the content of `keypoints` has changed"));
    // A frame that nobody looked at.
    assert_eq!(changed("rec/keypoints/C2_json/C2.0010.json").0, nothing);
}

#[test]
fn one_of_two_runs_in_one_folder_is_refused() {
    let trial = prepared();
    let both = [started(&trial, &[]), started(&trial, &["--force"])];
    let printed = both.map(|child| trial.printed(&finished(child)));
    let refused: Vec<&String> = printed.iter().filter(|printed| printed.starts_with("exit 5")).collect();
    let done = printed.iter().filter(|printed| printed.starts_with("exit 0")).count();
    // The second may also come when the first is done, if the machine is busy with other things: it then replaces the results.
    assert!(done + refused.len() == 2 && done >= 1, "{printed:?}");
    assert!(refused.iter().all(|printed| printed.contains("is in use by another run")), "{printed:?}");
    check_same_results(&trial, "out");
}

/// Nothing is computed for a place that cannot be written.
#[cfg(target_os = "linux")]
#[test]
fn a_place_that_cannot_be_written_is_reported_before_computing() {
    let trial = trial(0.2);
    let arguments: Vec<&str> = TRACK.iter().copied().filter(|argument| *argument != "--no-progress").collect();
    let output = trial.command(&arguments).arg("-o/proc/no-such-place/out").output().unwrap();
    let printed = trial.printed(&output);
    assert!(printed.starts_with("exit 5\nerror: cannot create `/proc/no-such-place/out`"), "{printed}");
    assert!(!printed.contains("set-up") && !printed.contains("tracking"), "{printed}");
}

#[test]
fn a_reader_that_leaves_is_no_panic() {
    let trial = prepared();
    let arguments = [&TRACK[..], &QUICK, &["-oout", SETUP]].concat();
    let mut child = trial.command(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = finished(child);
    let printed = trial.printed(&output);
    assert!(printed.starts_with("exit 0") && !printed.contains("panic"), "{printed}");
    assert!(Path::new(&trial.path("out/summary.json")).exists());
}
