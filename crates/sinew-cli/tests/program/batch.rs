//! Many trials: shards, what is missing, trials that fail, packed results, one set-up for a subject.

use crate::common::{Trial, correlation, files, trial};
use sinew::core::estimators::median;
use sinew::setup::Setup;
use sinew::setup::lasting_errors::DrawnNumber;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

/// Settings that make a trial short.
const SETTINGS: &str = "root = true\ncalibration = \"Calib.toml\"\nlayout = \"BODY_25B\"\nfps = 30\nupdates = 4\nburn_in = 1\nchains = 8\nmax_r_hat = 1e9\nmax_r_hat_share = 1.0\nmax_divergent_share = 1.0\ndraws = 8\ncameras = [\"C1\", \"C2\", \"C3\"]\n";

/// Two trials of anna, which share a set-up, and one of nobody in particular; each of a third of a second.
fn recordings() -> Trial {
    let trial = trial(1.0);
    let root = trial.path("recordings");
    for (place, name) in ["anna/run", "anna/walk", "other/walk"].iter().enumerate() {
        for camera in fs::read_dir(trial.path("pose")).unwrap() {
            let camera = camera.unwrap();
            let to = root.join(name).join("pose").join(camera.file_name());
            fs::create_dir_all(&to).unwrap();
            let mut frames: Vec<_> = fs::read_dir(camera.path()).unwrap().map(|frame| frame.unwrap()).collect();
            frames.sort_by_key(fs::DirEntry::file_name);
            for frame in &frames[10 * place..10 * (place + 1)] {
                fs::copy(frame.path(), to.join(frame.file_name())).unwrap();
            }
        }
    }
    fs::copy(trial.path("Calib.toml"), root.join("Calib.toml")).unwrap();
    fs::write(root.join("sinew.toml"), SETTINGS).unwrap();
    fs::write(root.join("anna/sinew.toml"), "subject = \"anna\"\n").unwrap();
    trial
}

fn batch(trial: &Trial, arguments: &[&str]) -> Output {
    trial.run(&[&["batch"], arguments, &["--no-progress"]].concat())
}

/// Everything that a run wrote but its times.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    files(folder).into_iter().filter(|(name, _)| !name.ends_with("timings.json")).collect()
}

fn answer(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Plans and runs a study by the given commands, and moves it: what a study holds names its folder.
fn study(trial: &Trial, moved_to: &str, plan: &[&str], runs: &[&[&str]]) {
    let planned = batch(trial, &[&["plan", "recordings", "-o", "study"], plan].concat());
    assert_eq!(planned.status.code(), Some(0), "{}", trial.printed(&planned));
    assert!(answer(&planned).contains("2 trials share 1 set-ups"), "{}", answer(&planned));
    for run in runs {
        let output = batch(trial, &[&["run", "study"], *run].concat());
        assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    }
    let output = batch(trial, &["gather", "study"]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    fs::rename(trial.path("study"), trial.path(moved_to)).unwrap();
}

/// Begins a run of the study and kills it once a trial is done.
fn killed(trial: &Trial, arguments: &[&str], ledger: &str) {
    let mut child = trial.command(&[&["batch", "run", "study", "-q"], arguments].concat()).spawn().unwrap();
    let ledger = trial.path("study/ended").join(ledger);
    while fs::metadata(&ledger).map_or(0, |file| file.len()) == 0 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    child.kill().unwrap();
    child.wait().unwrap();
}

#[test]
fn shards_archives_and_a_killed_shard_hold_the_files_of_a_run_in_one_piece() {
    let trial = recordings();
    study(&trial, "whole", &[], &[&["--threads=2"]]);
    assert_eq!(batch(&trial, &["plan", "recordings", "-o", "study"]).status.code(), Some(0));
    killed(&trial, &["--shard=0/2", "--threads=1"], "0-of-2.jsonl");
    study(&trial, "parts", &["--force"], &[&["--shard=1/2", "--threads=1"], &["--shard=0/2", "--threads=1"]]);
    study(&trial, "packed", &["--pack"], &[&["--threads=2"]]);
    let whole = results(&trial.path("whole/results"));
    assert!(whole.len() > 100 && whole == results(&trial.path("parts/results")));
    for name in ["anna/run", "anna/walk", "other/walk"] {
        let out = format!("unpacked/{name}");
        let output = batch(&trial, &["unpack", "packed", name, "-o", &out]);
        assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
        assert!(results(&trial.path(&out)) == results(&trial.path(&format!("whole/results/{name}"))), "{name}");
    }
    assert_eq!(fs::read_dir(trial.path("packed/results")).unwrap().count(), 1);
    for table in ["summary.csv", "groups.csv"] {
        let of = |study: &str| fs::read_to_string(trial.path(&format!("{study}/{table}"))).unwrap();
        assert!(of("whole").lines().count() >= 4 && of("whole") == of("parts") && of("whole") == of("packed"));
    }
    // Trials of one subject have one set-up, and with it the same draws of what is constant.
    let setup = |name: &str| fs::read(trial.path(&format!("whole/results/{name}/setup.toml"))).unwrap();
    assert!(setup("anna/run") == setup("anna/walk") && setup("anna/run") != setup("other/walk"));
}

/// What is constant, in each draw of a trial's set-up, by name.
fn constants(trial: &Trial, results: &str) -> BTreeMap<String, Vec<f64>> {
    let text = fs::read_to_string(trial.path(results).join("setup.toml")).unwrap();
    let known = Setup::from_toml("setup.toml", &text).unwrap().lasting.unwrap();
    let draws = |number: &DrawnNumber| number.draws.iter().map(|draw| number.value + draw).collect();
    known.number.iter().map(|number| (number.name.clone(), draws(number))).collect()
}

/// Whether all draws of all numbers of cameras are the same in two trials, to the digits that are stored.
fn has_same_cameras(trial: &Trial, study: &str) -> bool {
    let [anna, bob] = ["anna/run", "other/walk"].map(|name| constants(trial, &format!("{study}/results/{name}")));
    assert!(anna["body.thigh_m"] != bob["body.thigh_m"]);
    let is_of_camera = |name: &&String| {
        let (of, name) = name.split_once('.').unwrap();
        of != "body" && !name.contains("bias") && !name.contains("lag")
    };
    let names: Vec<&String> = anna.keys().filter(is_of_camera).collect();
    assert_eq!(names.len() % 10, 0, "{names:?}");
    assert!(names.len() >= 20, "{names:?}");
    let largest = |draws: &[f64]| draws.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    names.iter().all(|name| {
        let (a, b) = (&anna[*name], &bob[*name]);
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4 * largest(&anna[*name]))
    })
}

#[test]
fn subjects_of_a_session_share_its_cameras() {
    let trial = recordings();
    fs::write(trial.path("recordings/other/sinew.toml"), "subject = \"bob\"\n").unwrap();
    let run = |study: &str, share: &str, runs: &[&str]| {
        assert_eq!(batch(&trial, &["plan", "recordings", "-o", "study", "--share", share]).status.code(), Some(0));
        for shard in runs {
            let output = batch(&trial, &["run", "study", "--shard", shard]);
            assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
        }
        fs::rename(trial.path("study"), trial.path(study)).unwrap();
    };
    run("session", "session", &["0/1"]);
    run("parts", "session", &["1/2", "0/2"]);
    run("subject", "subject", &["0/1"]);
    assert!(results(&trial.path("session/results")) == results(&trial.path("parts/results")));
    assert!(has_same_cameras(&trial, "session") && !has_same_cameras(&trial, "subject"));
    // What they do not share is drawn apart: a mean over them is not stated too wide, nor a difference too narrow.
    let [anna, bob] = ["anna/run", "other/walk"].map(|name| constants(&trial, &format!("subject/results/{name}")));
    let mut found: Vec<f64> = anna.iter().map(|(name, draws)| correlation(draws, &bob[name])).collect();
    let (count, typical) = (anna["body.thigh_m"].len() as f64, median(&mut found));
    assert!(count > 100.0 && typical.abs() < 2.0 / count.sqrt(), "{typical}");
    let refused = batch(&trial, &["plan", "recordings", "-o", "study", "--share", "cameras"]);
    assert!(trial.printed(&refused).contains("session, subject, nothing"), "{}", trial.printed(&refused));
}

#[test]
fn a_bad_trial_fails_alone_and_only_what_is_missing_is_run_again() {
    let trial = recordings();
    let first = first_frame(&trial, "other/walk");
    let text = fs::read_to_string(&first).unwrap();
    fs::write(&first, "{\"people\": 3}").unwrap();
    assert_eq!(batch(&trial, &["plan", "recordings", "-o", "study"]).status.code(), Some(0));
    // A folder that cannot be made is what a full disk is: of one trial.
    fs::create_dir_all(trial.path("study/results/anna")).unwrap();
    fs::write(trial.path("study/results/anna/run"), "").unwrap();
    let output = batch(&trial, &["run", "study"]);
    let printed = trial.printed(&output);
    assert_eq!(output.status.code(), Some(1), "{printed}");
    assert!(answer(&output).contains("1 done, of which 0 doubtful; 2 failed"), "{printed}");
    assert!(printed.contains("warning: other/walk: ") && printed.contains("warning: anna/run: "), "{printed}");
    let gathered = batch(&trial, &["gather", "study", "--json"]);
    let gathered: serde_json::Value = serde_json::from_slice(&gathered.stdout).unwrap();
    assert_eq!((&gathered["done"], &gathered["failed"]), (&1.into(), &2.into()), "{gathered}");
    let page = fs::read_to_string(trial.path("study/report.html")).unwrap();
    assert!(page.contains("other/walk") && page.contains("failed"));

    fs::write(&first, text).unwrap();
    fs::remove_file(trial.path("study/results/anna/run")).unwrap();
    // The plan knows another hash of what was mended, and the same of the rest.
    let refused = batch(&trial, &["plan", "recordings", "-o", "study"]);
    assert_eq!(refused.status.code(), Some(5), "{}", trial.printed(&refused));
    assert_eq!(batch(&trial, &["plan", "recordings", "-o", "study", "--force"]).status.code(), Some(0));
    let again = batch(&trial, &["run", "study"]);
    assert_eq!(again.status.code(), Some(0), "{}", trial.printed(&again));
    assert!(answer(&again).contains("1 were done") && answer(&again).contains("2 done"), "{}", answer(&again));
    let nothing = answer(&batch(&trial, &["run", "study"]));
    assert!(nothing.contains("3 were done") && nothing.contains("now     0 done"), "{nothing}");
}

/// The file of the first frame of a camera.
fn first_frame(trial: &Trial, name: &str) -> PathBuf {
    let folder = trial.path(&format!("recordings/{name}/pose/C1_json"));
    fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).min().unwrap()
}

#[test]
fn a_subject_is_set_up_without_a_trial_that_cannot_be_read() {
    let trial = recordings();
    fs::write(first_frame(&trial, "anna/run"), "{\"people\": 3}").unwrap();
    assert_eq!(batch(&trial, &["plan", "recordings", "-o", "study"]).status.code(), Some(0));
    let output = batch(&trial, &["run", "study"]);
    let printed = trial.printed(&output);
    assert_eq!(output.status.code(), Some(1), "{printed}");
    assert!(answer(&output).contains("2 done, of which 0 doubtful; 1 failed"), "{printed}");
    assert!(printed.contains("set up without anna/run: ") && printed.contains("warning: anna/run: "), "{printed}");
}

/// Two of the trials have the same frames.
#[test]
fn packed_results_that_are_gone_are_missed_and_made_again() {
    let trial = recordings();
    let copied = files(&trial.path("recordings/other/walk"));
    for (name, bytes) in copied {
        let path = trial.path("recordings/other/copy").join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
    let said = |arguments: &[&str], code: i32, words: &str| {
        let output = batch(&trial, arguments);
        let printed = trial.printed(&output) + &answer(&output);
        assert!(output.status.code() == Some(code) && printed.contains(words), "{printed}");
    };
    said(&["plan", "recordings", "-o", "study", "--pack"], 0, "trials   4");
    said(&["run", "study", "--threads=2"], 0, "4 done");
    said(&["gather", "study"], 0, "4");
    let archive = trial.path("study/results/0-of-1.tar");
    let table = || fs::read_to_string(trial.path("study/summary.csv")).unwrap();
    let (whole, length) = (table(), fs::metadata(&archive).unwrap().len());
    fs::File::options().write(true).open(&archive).unwrap().set_len(length / 3).unwrap();
    said(&["gather", "study"], 1, "1 done, 0 doubtful, 0 failed, 3 missing");
    assert!(table().contains("its results are gone or damaged: run the study again"), "{}", table());
    let trials = ["anna/run", "anna/walk", "other/copy", "other/walk"];
    let unpacked =
        |out: &str| trials.map(|name| batch(&trial, &["unpack", "study", name, "-o", &format!("{out}/{name}")]));
    let ended: Vec<Option<i32>> = unpacked("cut").iter().map(|output| output.status.code()).collect();
    assert_eq!(ended.iter().filter(|code| **code == Some(0)).count(), 1, "{ended:?}");
    said(&["run", "study"], 0, "1 were done");
    said(&["gather", "study"], 0, "4");
    assert!(table() == whole && unpacked("whole").iter().all(|output| output.status.success()));
}

#[test]
fn folders_that_are_no_studies_are_refused_in_words() {
    let trial = recordings();
    fs::create_dir(trial.path("empty")).unwrap();
    let said = |arguments: &[&str], code: i32, words: &str| {
        let output = batch(&trial, arguments);
        let printed = trial.printed(&output);
        assert!(output.status.code() == Some(code) && printed.contains(words), "{printed}");
    };
    said(&["plan", "empty", "-o", "study"], 3, "holds no trial");
    said(&["plan", "recordings"], 2, "no folder for the study was given");
    said(&["run", "recordings"], 2, "is not a study");
    said(&["unpack", "recordings", "anna/run", "-o", "out"], 2, "is not a study");
    said(&["run", "recordings", "--shard=2/2"], 2, "counted from 0");
    said(&["gather", "recordings", "--by", "person"], 2, "folder, name, subject, all");
    fs::create_dir(trial.path("study")).unwrap();
    fs::write(trial.path("study/plan.json"), "{").unwrap();
    fs::write(trial.path("study/tasks.jsonl"), "").unwrap();
    said(&["run", "study"], 2, "plan.json, line 1");
}
