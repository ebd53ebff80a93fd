//! Everybody in view is tracked in one run, each into a folder of their own.

use crate::common::{Files, QUICK, TRACK, Trial, files, made_once, write_files};
use sinew::formats::{calib_toml, picture, trc};
use sinew_results::LOCK_NAME;
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::crowd::{Crowd, CrowdNoise, CrowdRecording};
use sinew_simulate::ring::Ring;
use std::fs;
use std::sync::OnceLock;

/// Two people who cross, before three cameras.
fn crossing() -> (Trial, CrowdRecording) {
    let crowd = Crowd {
        people: 2,
        duration_s: 1.0,
        rate_hz: 30.0,
        ring: Ring { cameras: 3, ..Ring::default() },
        calibration: CalibrationError::NONE,
        noise: CrowdNoise::DETECTOR_LIKE,
    };
    let recording = CrowdRecording::new(&crowd, 3).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in recording.keypoint_files() {
        let path = folder.path().join("pose").join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    fs::write(folder.path().join("Calib.toml"), calib_toml::write(&recording.cameras)).unwrap();
    (Trial { folder }, recording)
}

/// The same with results of both in `whole`; what they name is a folder that is gone.
fn tracked() -> Trial {
    static WHOLE: OnceLock<Files> = OnceLock::new();
    made_once(&WHOLE, || {
        let (trial, _) = crossing();
        let output = trial.track(&["-owhole"]);
        assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
        trial
    })
}

/// Mean distance of the hips of a result from each person's, metres.
fn away(trial: &Trial, folder: &str, recording: &CrowdRecording) -> Vec<f64> {
    let text = fs::read_to_string(trial.path(folder).join("markers.trc")).unwrap();
    let found = trc::read("markers.trc", &text).unwrap();
    let marker = found.marker_index("RHip").unwrap();
    let distance = |person: &sinew::body::points::Trajectories| {
        let hip = person.index("RHip").unwrap();
        let apart = |frame: usize| {
            let (at, true_at) = (found.point_in_world(frame, marker).unwrap(), person.frames[frame][hip]);
            (0..3).map(|axis| (at[axis] - true_at[axis]).powi(2)).sum::<f64>().sqrt()
        };
        (0..found.frames.len()).map(apart).sum::<f64>() / found.frames.len() as f64
    };
    recording.truth.iter().map(distance).collect()
}

#[test]
fn each_of_two_people_gets_a_folder_and_a_stopped_run_resumes_to_the_same_files() {
    let (trial, recording) = crossing();
    let output = trial.track(&["-owhole"]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    let near: Vec<Vec<f64>> =
        ["whole/people/01", "whole/people/02"].map(|folder| away(&trial, folder, &recording)).into();
    let swapped = near[0][0] > near[0][1];
    let own = |person: usize| near[person][usize::from(swapped) ^ person];
    assert!(own(0) < 0.08 && own(1) < 0.08, "{near:?}");
    let table = fs::read_to_string(trial.path("whole/people.csv")).unwrap();
    assert_eq!(table.lines().count(), 3, "{table}");

    // As if it had been stopped when the first person was done.
    let mut left = files(&trial.path("whole"));
    left.retain(|name, _| !name.starts_with("people/02"));
    write_files(&trial.path("out"), &left);
    let without_times = |folder: &str| {
        let mut all = files(&trial.path(folder));
        all.retain(|name, _| !name.ends_with("timings.json"));
        all
    };
    let resumed_is_whole = || {
        let output = trial.track(&["--resume"]);
        assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
        let [whole, resumed] = ["whole", "out"].map(without_times);
        assert_eq!(whole.keys().collect::<Vec<_>>(), resumed.keys().collect::<Vec<_>>());
        assert!(whole == resumed);
    };
    resumed_is_whole();

    // As if it had been killed in the set-up of the second person.
    fs::remove_dir_all(trial.path("out/people/02")).unwrap();
    fs::create_dir_all(trial.path("out/people/02")).unwrap();
    fs::write(trial.path("out/people/02").join(LOCK_NAME), "999999999\n").unwrap();
    let summary = |change: &dyn Fn(String) -> String| trial.edit(&trial.path("out/summary.json"), change);
    summary(&|text| text.replacen("\"complete\": true", "\"complete\": false", 1));
    let inspected = String::from_utf8(trial.run(&["inspect", "out"]).stdout).unwrap();
    let says = |words: &str| assert!(inspected.contains(words), "{words}: {inspected}");
    ["; tracked\n", "; not tracked yet\n", "--resume` continues it", "(1.0 s), by two cameras in "]
        .into_iter()
        .for_each(says);
    resumed_is_whole();
}

#[test]
fn results_of_one_person_and_of_several_replace_each_other_only_if_forced() {
    let trial = tracked();
    // Finished results are not replaced unasked, and one person alone is tracked on request.
    let output = trial.track(&["-owhole"]);
    assert_eq!(output.status.code(), Some(5), "{}", trial.printed(&output));
    let output = trial.track(&["-oone", "--people=1"]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    assert!(trial.path("one/markers.trc").is_file() && !trial.path("one/people").exists());

    // Neither leaves the other's files beside its own.
    let output = trial.track(&["-oone", "--force"]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    assert!(trial.path("one/people/02/markers.trc").is_file() && !trial.path("one/markers.trc").exists());
    let output = trial.track(&["-oone", "--force", "--people=1"]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    let left = |name: &str| trial.path(name).exists();
    assert!(left("one/markers.trc") && !left("one/people") && !left("one/people.csv"));
}

/// `--person 2` is who lies in `people/02`, with the same results; commands that take one person say so of the folder of several.
#[test]
fn a_number_chooses_the_person_of_the_folder_of_that_number() {
    let (trial, _) = crossing();
    let output = trial.track(&["-owhole", "--report"]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    let output = trial.track(&["-otwo", "--person=2"]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    for name in ["joints.csv", "state.csv", "setup.toml", "frames.csv"] {
        let [own, from_all] = ["two", "whole/people/02"].map(|folder| fs::read(trial.path(folder).join(name)).unwrap());
        assert!(own == from_all, "{name}");
    }
    let setup = "--setup=whole/people/02/setup.toml";
    let refused = |arguments: &[&str], code: i32, words: &[&str]| {
        let output = trial.run(arguments);
        let printed = trial.printed(&output);
        assert_eq!(output.status.code(), Some(code), "{printed}");
        words.iter().for_each(|words| assert!(printed.contains(words), "{words}: {printed}"));
    };
    let track = |more: &[&'static str]| [&TRACK[..], &QUICK, more].concat();
    refused(&track(&["-othree", "--person=3"]), 3, &["person 3 was chosen; two cameras see 2 people"]);
    refused(&track(&["-othree", "--people=2"]), 2, &["`--person 2`"]);
    refused(&track(&["-owhole", "--people=1", "--resume"]), 2, &["a run of several people; this is one of one person"]);
    refused(&track(&["-otwo", "--resume"]), 2, &["a run of one person; this is one of several people"]);
    refused(&track(&["-ogiven", setup]), 0, &["`--setup` is of one person; `--person N` says which"]);
    refused(&track(&["-othird", setup, "--person=2"]), 0, &[]);
    refused(
        &track(&["-oshort", "--frames=0..6", "--any-size"]),
        0,
        &["6 frames are less than a quarter of a second, too few"],
    );
    let each =
        ["results of several people, each in a folder of their own", "give one of them, for example `whole/people/01`"];
    refused(&["gait", "whole"], 2, &each);
    refused(&["predict", "whole", "--calibration=Calib.toml", "--camera=C1", "-op.csv"], 2, &each);
    refused(&["convert", "whole", "whole.bvh"], 2, &each);
    refused(&["report", "whole", "-oall.html"], 2, &each);
    let output = trial.run(&["report", "whole"]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    assert!(["01", "02"].iter().all(|number| trial.path(&format!("whole/people/{number}/report.html")).is_file()));
}

/// Both people lie in the pictures of one call, each in their colour.
#[test]
fn everybody_is_drawn_in_one_picture() {
    let trial = tracked();
    let output =
        trial.run(&["overlay", "whole", "--calibration=Calib.toml", "--frames=10..12", "-oall", "--no-progress"]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    assert!(String::from_utf8_lossy(&output.stdout).starts_with("6 pictures"), "{}", trial.printed(&output));
    for (name, bytes) in files(&trial.path("all")).iter().filter(|(name, _)| name.ends_with(".png")) {
        let image = picture::read(name, bytes).unwrap();
        let count = |colour: [u8; 3]| image.pixels.iter().filter(|pixel| **pixel == colour).count();
        assert!(count([230, 159, 0]) > 50 && count([86, 180, 233]) > 50, "{name}");
    }
}

/// A shin that no body has: nobody can be set up, and the run ends as that of one person does.
#[test]
fn a_run_in_which_nobody_can_be_set_up_has_wrong_input() {
    let (trial, _) = crossing();
    let path = trial.path("Calib.toml");
    let mut cameras = calib_toml::read("Calib.toml", &fs::read_to_string(&path).unwrap()).unwrap().cameras;
    for camera in &mut cameras {
        camera.translation = camera.translation.map(|x| 3.0 * x);
    }
    fs::write(&path, calib_toml::write(&cameras)).unwrap();
    let several = trial.track(&["-oall"]);
    let one = trial.track(&["-oone", "--people=1"]);
    assert_eq!((one.status.code(), several.status.code()), (Some(3), Some(3)), "{}", trial.printed(&several));
    let summary = fs::read_to_string(trial.path("all/summary.json")).unwrap();
    assert_eq!(summary.matches("\"failed\"").count(), 2, "{summary}");
}
