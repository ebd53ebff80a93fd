//! Nothing of the user's is lost, and nothing is written outside: what is promised in `docs/reference/files.md`.

use crate::common::{QUICK, Trial, files, trial};
use std::collections::BTreeMap;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::Stdio;

const MINE: &str = "mine";

/// Puts a file of the user somewhere.
fn put(trial: &Trial, name: &str) {
    let path = trial.path(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, MINE).unwrap();
}

fn is_mine(trial: &Trial, name: &str) -> bool {
    fs::read_to_string(trial.path(name)).is_ok_and(|text| text == MINE)
}

fn all(trial: &Trial) -> BTreeMap<String, Vec<u8>> {
    files(trial.folder.path())
}

/// Runs a command that must end with a code, saying some words.
fn said(trial: &Trial, arguments: &[&str], code: i32, words: &str) {
    let output = trial.run(arguments);
    let printed = trial.printed(&output);
    assert!(output.status.code() == Some(code) && printed.contains(words), "{arguments:?}: {printed}");
}

/// Tracks into `out` what must end with a code, saying some words.
fn tracked(trial: &Trial, more: &[&str], code: i32, words: &str) {
    let output = trial.track(more);
    let printed = trial.printed(&output);
    assert!(output.status.code() == Some(code) && printed.contains(words), "{more:?}: {printed}");
}

/// A folder with results of people, as a run of several would leave them, and with files of the user.
fn with_people(trial: &Trial) {
    tracked(trial, &["-oout/people/01"], 0, "");
    put(trial, "out/people/anna/notes.txt");
    put(trial, "out/people/01/notes.txt");
    fs::write(trial.path("out/people.csv"), "person\n").unwrap();
    fs::write(trial.path("out/summary.json"), "{\"complete\": true}").unwrap();
    fs::write(trial.path("out/sinew.files"), "{\"sinew_wrote\": [\"people.csv\", \"summary.json\"]}").unwrap();
}

#[test]
fn people_of_a_run_before_stay_until_new_results_are_whole() {
    let trial = trial(0.4);
    with_people(&trial);
    let before = files(&trial.path("out"));
    // A live stream without a frame.
    let live = ["track", "--calibration=Calib.toml", "--layout=BODY_25B", "--fps=30", "--no-progress", "--live=-"];
    let mut child = trial
        .command(&[&live[..], &QUICK, &["-oout", "--force"]].concat())
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    drop(child.stdin.take());
    assert!(!child.wait().unwrap().success());
    assert!(files(&trial.path("out")) == before);
    // Keypoints that cannot be read.
    let frame = trial.keypoints(2, 9);
    let text = fs::read_to_string(&frame).unwrap();
    fs::write(&frame, "{\"people\": 3}").unwrap();
    assert_eq!(trial.track(&["--force"]).status.code(), Some(3));
    let after = files(&trial.path("out"));
    assert!(before.iter().all(|(name, bytes)| name == "sinew.files" || after[name] == *bytes), "{:?}", after.keys());
    fs::write(&frame, text).unwrap();
    // Whole new results replace what was listed, and nothing else.
    tracked(&trial, &["--force"], 0, "");
    assert!(trial.path("out/joints.csv").exists() && !trial.path("out/people.csv").exists());
    let left = files(&trial.path("out/people"));
    assert_eq!(left.keys().collect::<Vec<_>>(), ["01/notes.txt", "anna/notes.txt"]);
}

#[test]
fn files_of_others_in_the_way_are_named_and_stay() {
    let trial = trial(0.2);
    for name in ["joints.csv", "config.toml", "markers.trc.partial", "smooth.partial", "posterior.zarr/notes.txt"] {
        put(&trial, &format!("{name}-folder/{name}"));
        let before = all(&trial);
        tracked(&trial, &[&format!("-o{name}-folder"), "--force"], 5, &format!("{name}` is in the way"));
        assert!(all(&trial) == before, "{name}");
    }
    // Somebody else's files among results.
    tracked(&trial, &["-oout", "--report"], 0, "");
    for name in ["notes.txt", "posterior.zarr/posterior/mine/0", "gait_events.csv", "x.partial"] {
        put(&trial, &format!("out/{name}"));
    }
    let before = all(&trial);
    tracked(&trial, &["-oout", "--force"], 5, "posterior.zarr/posterior/mine/0` is in the way");
    assert!(all(&trial) == before);
    fs::remove_dir_all(trial.path("out/posterior.zarr/posterior/mine")).unwrap();
    tracked(&trial, &["-oout", "--force", "--seed=2"], 0, "");
    assert!(["notes.txt", "gait_events.csv", "x.partial"].iter().all(|name| is_mine(&trial, &format!("out/{name}"))));
    // What was made of results that are gone is no longer true.
    assert!(!trial.path("out/report.html").exists());
}

const SMALL: [&str; 6] = ["simulate", "-orec", "--duration=0.2", "--fps=20", "--size=96x72", "--no-progress"];

#[test]
fn a_new_recording_replaces_what_the_one_before_wrote() {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let simulate = |more: &[&str], code: i32, words: &str| said(&trial, &[&SMALL[..], more].concat(), code, words);
    simulate(&["--images=2"], 0, "");
    put(&trial, "rec/masks/mine.png");
    put(&trial, "rec/truth_mine.txt");
    put(&trial, "rec/keypoints/notes.txt");
    simulate(&["--force", "--seed=2", "--cameras=2", "--images=none"], 0, "");
    let kept = ["rec/masks/mine.png", "rec/truth_mine.txt", "rec/keypoints/notes.txt"];
    assert!(kept.iter().all(|name| is_mine(&trial, name)));
    assert!(!trial.path("rec/masks/C4_0000.png").exists() && !trial.path("rec/images").exists());
    // In the way.
    fs::remove_dir_all(trial.path("rec")).unwrap();
    put(&trial, "rec/masks/C2_0003.png");
    put(&trial, "rec/Calib.toml");
    let before = all(&trial);
    simulate(&["--force"], 5, "` is in the way");
    assert!(all(&trial) == before);
}

#[test]
fn a_truth_of_the_user_is_no_former_demo() {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    put(&trial, "out/truth.trc");
    put(&trial, "out/keypoints/C1_json/mine.json");
    let before = all(&trial);
    said(&trial, &["demo", "-oout", "--no-progress"], 5, "`out` exists and is not empty");
    said(&trial, &["demo", "-oout", "--no-progress", "--force"], 5, "truth.trc` is in the way");
    assert!(all(&trial) == before);
}

/// Cameras whose names lead elsewhere.
#[test]
fn pictures_of_cameras_with_strange_names_stay_in_their_folder() {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    said(&trial, &SMALL, 0, "");
    let input = ["--calibration=rec/Calib.toml", "--keypoints=rec/keypoints", "--layout=BODY_25B", "--fps=20"];
    said(&trial, &[&["track", "-oout", "--no-progress", "--any-size"], &input[..], &QUICK].concat(), 0, "");
    for path in ["rec/Calib.toml", "out/setup.toml"] {
        trial.edit(&trial.path(path), |text| text.replace("\"C1\"", "\"../../x\"").replace("[C1]", "[\"../../x\"]"));
    }
    let draw = ["overlay", "out", "--calibration=rec/Calib.toml", "--no-progress", "-oa/b/pictures"];
    let before = all(&trial);
    said(&trial, &draw, 3, "`../../x_000000.png` leads out of the output folder `a/b/pictures`");
    assert!(all(&trial) == before && !trial.path("a").exists());
}

#[cfg(unix)]
#[test]
fn links_are_not_written_through() {
    use std::os::unix::fs::symlink;
    let trial = trial(0.2);
    put(&trial, "elsewhere/file");
    fs::create_dir(trial.path("out")).unwrap();
    // A lock, a provisional name and a list that lead elsewhere.
    for name in ["sinew.lock", "markers.trc.partial", "sinew.files", "sinew.files.partial"] {
        symlink(trial.path("elsewhere/file"), trial.path("out").join(name)).unwrap();
        let printed = trial.track_printed(&["--force"]);
        assert!(is_mine(&trial, "elsewhere/file"), "{name}: {printed}");
        assert!(
            name == "sinew.files.partial" || printed.starts_with("exit 5\n") && printed.contains(name),
            "{printed}"
        );
        let _ = fs::remove_file(trial.path("out").join(name));
    }
    put(&trial, "out/sinew.lock");
    tracked(&trial, &["--force"], 5, "sinew.lock` is in the way");
    assert!(is_mine(&trial, "out/sinew.lock"));
    // Files that are written alone.
    symlink(trial.path("elsewhere/file"), trial.path("new.toml.partial")).unwrap();
    said(&trial, &["convert", "Calib.toml", "new.toml"], 0, "");
    assert!(is_mine(&trial, "elsewhere/file") && trial.path("new.toml").is_file());
}

#[test]
fn a_file_that_is_written_alone_leaves_the_partial_of_others_and_its_own_input() {
    let trial = trial(0.2);
    put(&trial, "new.toml.partial");
    said(&trial, &["convert", "Calib.toml", "new.toml"], 0, "");
    assert!(is_mine(&trial, "new.toml.partial") && !trial.path("new.toml.2.partial").exists());
    tracked(&trial, &[], 0, "");
    let before = all(&trial);
    said(&trial, &["convert", "Calib.toml", "new.toml"], 5, "`new.toml` exists");
    said(&trial, &["convert", "Calib.toml", "./Calib.toml", "--force"], 2, "Calib.toml");
    fs::write(trial.path("walk.amc"), "").unwrap();
    fs::write(trial.path("body.csv"), "").unwrap();
    said(&trial, &["convert", "walk.amc", "body.csv", "--skeleton=body.csv", "--force"], 2, "body.csv");
    ["walk.amc", "body.csv"].iter().for_each(|name| fs::remove_file(trial.path(name)).unwrap());
    put(&trial, "page.html");
    said(&trial, &["report", "out", "-opage.html"], 5, "`page.html` exists");
    fs::remove_file(trial.path("page.html")).unwrap();
    let with = "--calibration=Calib.toml";
    said(&trial, &["report", "out", with, "-oCalib.toml", "--force"], 2, "Calib.toml");
    said(&trial, &["report", "out", "-oout/joints.csv", "--force"], 2, "joints.csv");
    assert!(all(&trial) == before);
}

/// A study of one trial, planned.
fn study(plan: &[&str]) -> Trial {
    let trial = trial(0.2);
    fs::create_dir_all(trial.path("recordings/walk")).unwrap();
    fs::rename(trial.path("pose"), trial.path("recordings/walk/pose")).unwrap();
    fs::rename(trial.path("Calib.toml"), trial.path("recordings/Calib.toml")).unwrap();
    let settings = "root = true\ncalibration = \"Calib.toml\"\nlayout = \"BODY_25B\"\nfps = 30\nupdates = 4\nburn_in = 1\nchains = 8\nmax_r_hat = 1e9\nmax_r_hat_share = 1.0\nmax_divergent_share = 1.0\ndraws = 8\nany_size = true\n";
    fs::write(trial.path("recordings/sinew.toml"), settings).unwrap();
    said(&trial, &[&["batch", "plan", "recordings", "-ostudy"], plan].concat(), 0, "");
    trial
}

#[test]
fn a_study_replaces_its_own_files_and_no_others() {
    let trial = study(&[]);
    let before = all(&trial);
    said(&trial, &["batch", "plan", "recordings", "-ostudy"], 5, "plan.json");
    for name in ["Snakefile", "submit.sh"] {
        put(&trial, &format!("other/{name}"));
        said(&trial, &["batch", "plan", "recordings", "-oother"], 5, name);
        assert!(is_mine(&trial, &format!("other/{name}")));
        fs::remove_dir_all(trial.path("other")).unwrap();
    }
    assert!(all(&trial) == before);
    // `batch run` forces always.
    put(&trial, "study/results/walk/joints.csv");
    said(&trial, &["batch", "run", "study", "--no-progress"], 1, "joints.csv` is in the way");
    assert!(is_mine(&trial, "study/results/walk/joints.csv"));
    fs::remove_file(trial.path("study/results/walk/joints.csv")).unwrap();
    put(&trial, "study/results/walk/notes.txt");
    said(&trial, &["batch", "run", "study", "--no-progress"], 0, "");
    assert!(is_mine(&trial, "study/results/walk/notes.txt"));
    for name in ["summary.csv", "report.html"] {
        put(&trial, &format!("study/{name}"));
        said(&trial, &["batch", "gather", "study"], 5, &format!("{name}` exists"));
        assert!(is_mine(&trial, &format!("study/{name}")));
        fs::remove_file(trial.path(&format!("study/{name}"))).unwrap();
    }
    said(&trial, &["batch", "gather", "study"], 0, "");
    said(&trial, &["batch", "gather", "study"], 0, "");
    put(&trial, "study/groups.csv");
    said(&trial, &["batch", "gather", "study", "--force"], 0, "");
    assert!(!is_mine(&trial, "study/groups.csv"));
}

#[test]
fn an_edited_plan_writes_nothing_outside_of_the_study() {
    let trial = study(&[]);
    let tasks = trial.path("study/tasks.jsonl");
    let planned = fs::read_to_string(&tasks).unwrap();
    let absolute = trial.path("absolute").display().to_string();
    for name in ["../../outside", &absolute, "walk/../../x"] {
        let task = planned.replace("\"trial\":\"walk\"", &format!("\"trial\":{name:?}"));
        assert_ne!(task, planned);
        fs::write(&tasks, task).unwrap();
        let before: Vec<String> = top(&trial);
        said(&trial, &["batch", "run", "study", "--no-progress"], 1, "leads out of the output folder `study/results`");
        assert_eq!(top(&trial), before);
        assert!(!trial.path("study/x").exists());
    }
    let pooled = planned.replace("\"session\":", "\"pool\":\"../../pool\",\"session\":");
    fs::write(&tasks, pooled).unwrap();
    said(&trial, &["batch", "run", "study", "--no-progress"], 1, "leads out of");
    assert!(!trial.path("pool.toml").exists());
    #[cfg(unix)]
    {
        fs::write(&tasks, planned).unwrap();
        put(&trial, "elsewhere/file");
        let ledger = trial.path("study/ended/0-of-1.jsonl");
        let _ = fs::remove_file(&ledger);
        std::os::unix::fs::symlink(trial.path("elsewhere/file"), &ledger).unwrap();
        said(&trial, &["batch", "run", "study", "--no-progress"], 5, "0-of-1.jsonl` is a link");
        fs::remove_file(ledger).unwrap();
        fs::remove_dir_all(trial.path("study/results")).unwrap_or_default();
        fs::create_dir(trial.path("study/results")).unwrap();
        std::os::unix::fs::symlink(trial.path("elsewhere"), trial.path("study/results/walk")).unwrap();
        said(&trial, &["batch", "run", "study", "--no-progress"], 1, "is a link");
        assert_eq!(files(&trial.path("elsewhere")).len(), 1);
        assert!(is_mine(&trial, "elsewhere/file"));
    }
}

fn top(trial: &Trial) -> Vec<String> {
    let names = fs::read_dir(trial.folder.path()).unwrap().map(|entry| entry.unwrap().file_name());
    let mut names: Vec<String> = names.map(|name| name.to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// A tar file with one file of that name, as somebody may make it who means harm; the header is written by hand, since no library writes such names.
fn archive(path: &Path, name: &str, kind: u8, link: &str) -> u64 {
    let mut header = [0_u8; 512];
    header[..name.len()].copy_from_slice(name.as_bytes());
    header[100..108].copy_from_slice(b"0000644\0");
    header[124..136].copy_from_slice(b"00000000003\0");
    header[156] = kind;
    header[157..157 + link.len()].copy_from_slice(link.as_bytes());
    header[257..263].copy_from_slice(b"ustar\0");
    header[148..156].copy_from_slice(b"        ");
    let sum: u32 = header.iter().map(|byte| u32::from(*byte)).sum();
    header[148..156].copy_from_slice(format!("{sum:06o}\0 ").as_bytes());
    let mut file = fs::File::create(path).unwrap();
    file.write_all(&header).unwrap();
    let mut content = [0_u8; 512];
    content[..3].copy_from_slice(b"bad");
    file.write_all(&content).unwrap();
    1024
}

#[test]
fn an_archive_writes_only_below_the_folder_that_is_named() {
    let trial = study(&["--pack"]);
    fs::create_dir_all(trial.path("study/results")).unwrap();
    fs::create_dir_all(trial.path("study/ended")).unwrap();
    let absolute = trial.path("absolute.csv").display().to_string();
    let unpack = ["batch", "unpack", "study", "walk", "-odeep/er/out", "--force"];
    let prepare = |name: &str, kind: u8, link: &str| {
        let length = archive(&trial.path("study/results/0-of-1.tar"), name, kind, link);
        let line = format!(
            "{{\"trial\":\"walk\",\"hash\":\"\",\"ended\":\"done\",\"code\":0,\"seconds\":1,\"computing_s\":1,\"at_unix_s\":1,\"packed\":{{\"archive\":\"results/0-of-1.tar\",\"offset\":0,\"length\":{length}}}}}\n"
        );
        fs::write(trial.path("study/ended/0-of-1.jsonl"), line).unwrap();
    };
    for name in ["walk/../../../outside.csv", "../outside.csv", &absolute] {
        prepare(name, b'0', "");
        let before = all(&trial);
        said(&trial, &unpack, 3, "leads out of the output folder");
        assert!(all(&trial) == before, "{name}");
    }
    // A file of the user, and what is a link in an archive.
    put(&trial, "deep/er/out/joints.csv");
    prepare("walk/joints.csv", b'0', "");
    said(&trial, &unpack, 5, "joints.csv` is in the way");
    assert!(is_mine(&trial, "deep/er/out/joints.csv"));
    fs::remove_file(trial.path("deep/er/out/joints.csv")).unwrap();
    #[cfg(unix)]
    {
        put(&trial, "elsewhere/file");
        std::os::unix::fs::symlink(trial.path("elsewhere"), trial.path("deep/er/out/link")).unwrap();
        prepare("walk/link/file", b'0', "");
        said(&trial, &unpack, 5, "link` is a link");
        assert!(is_mine(&trial, "elsewhere/file"));
        prepare("walk/made", b'2', "../../../elsewhere/file");
        let _ = trial.run(&unpack);
        assert!(!trial.path("deep/er/out/made").is_symlink() && is_mine(&trial, "elsewhere/file"));
    }
    prepare("walk/joints.csv", b'0', "");
    said(&trial, &unpack, 0, "");
    assert_eq!(fs::read_to_string(trial.path("deep/er/out/joints.csv")).unwrap(), "bad");
}
