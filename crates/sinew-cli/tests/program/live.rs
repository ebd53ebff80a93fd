//! Frames that come while they are tracked: the same results as from files, and an answer for whatever comes.

use crate::common::{QUICK, Trial, column, files, trial};
use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};
use std::time::Duration;

const LIVE: [&str; 6] = ["track", "--calibration", "Calib.toml", "--layout", "BODY_25B", "--no-progress"];

/// A recording with a set-up in `setup.toml`.
fn set_up(duration_s: f64) -> Trial {
    let trial = trial(duration_s);
    let made = trial.track(&["-omade"]);
    assert!(made.status.success(), "{}", trial.printed(&made));
    fs::copy(trial.path("made/setup.toml"), trial.path("setup.toml")).unwrap();
    trial
}

/// The line of a frame.
fn line(trial: &Trial, frame: usize) -> String {
    let camera = |camera: usize| {
        let text = fs::read_to_string(trial.keypoints(camera, frame)).unwrap();
        format!("\"C{camera}\":{}", text.trim_end())
    };
    let cameras: Vec<String> = (1..=4).map(camera).collect();
    format!("{{\"frame\":{frame},\"cameras\":{{{}}}}}", cameras.join(","))
}

/// A run whose frames come from this process.
struct Running {
    child: Child,
    frames: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

impl Running {
    fn begun(trial: &Trial, more: &[&str]) -> Self {
        let mut command = trial.command(&[&LIVE[..], &QUICK, &["--fps", "30", "--live", "-"], more].concat());
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let (frames, answers) = (child.stdin.take(), BufReader::new(child.stdout.take().unwrap()));
        Self { child, frames, answers }
    }

    fn send(&mut self, line: &str) {
        writeln!(self.frames.as_mut().unwrap(), "{line}").unwrap();
    }

    /// The next answer, but for the first, which has the names.
    fn answer(&mut self) -> Value {
        let mut text = String::new();
        self.answers.read_line(&mut text).unwrap();
        let answer: Value = serde_json::from_str(&text).unwrap_or_else(|_| panic!("{text:?}"));
        if answer["begin"].is_null() { answer } else { self.answer() }
    }

    /// Sends a frame and takes its answer.
    fn exchange(&mut self, trial: &Trial, frame: usize) -> Value {
        self.send(&line(trial, frame));
        let answer = self.answer();
        assert_eq!(answer["frame"], frame, "{answer}");
        answer
    }

    /// Ends the input; the answers that are left, the exit code and what stands on stderr.
    fn ended(mut self) -> (Vec<Value>, i32, String) {
        drop(self.frames.take());
        self.finished()
    }

    fn finished(mut self) -> (Vec<Value>, i32, String) {
        let answers = self.answers.lines().map(|line| serde_json::from_str(&line.unwrap()).unwrap()).collect();
        let mut printed = String::new();
        self.child.stderr.take().unwrap().read_to_string(&mut printed).unwrap();
        (answers, self.child.wait().unwrap().code().unwrap(), printed)
    }
}

/// What must be the same as from files: all but where frames came from.
fn results(trial: &Trial, out: &str) -> Vec<(String, Vec<u8>)> {
    let mut found = files(&trial.path(out));
    for own in ["timings.json", "config.toml"] {
        assert!(found.remove(own).is_some(), "{own}");
    }
    let mut summary: Value = serde_json::from_slice(&found.remove("summary.json").unwrap()).unwrap();
    for own in ["settings", "settings_hash", "input_hashes", "warnings"] {
        assert!(summary.as_object_mut().unwrap().remove(own).is_some(), "{own} of {summary}");
    }
    found.insert("summary.json".into(), summary.to_string().into_bytes());
    found.into_iter().collect()
}

fn check_same(trial: &Trial, expected: &str, found: &str) {
    let [expected, found] = [expected, found].map(|out| results(trial, out));
    let names = |files: &[(String, Vec<u8>)]| files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&expected), names(&found));
    let differing: Vec<_> = expected.iter().zip(&found).filter(|(a, b)| a != b).map(|((name, _), _)| name).collect();
    assert!(differing.is_empty(), "{differing:?}");
}

#[test]
fn live_results_are_those_from_files() {
    let trial = set_up(0.4);
    for lag in [0, 3] {
        let lag_frames = format!("--lag-frames={lag}");
        let (from_files, live) = (format!("files{lag}"), format!("live{lag}"));
        // The patience of live runs.
        let same = ["--setup", "setup.toml", "--patience=1", lag_frames.as_str(), "-o"];
        assert!(trial.track(&[&same[..], &[from_files.as_str()]].concat()).status.success());
        let mut running = Running::begun(&trial, &[&same[..], &[live.as_str()]].concat());
        let mut answered = vec![];
        for frame in 0..12 {
            running.send(&line(&trial, frame));
            if frame >= lag {
                answered.push(running.answer());
            } else {
                // Nothing says when a frame was taken that is answered later.
                std::thread::sleep(Duration::from_millis(150));
            }
        }
        let (rest, code, printed) = running.ended();
        assert_eq!(code, 0, "{printed}");
        answered.extend(rest);
        let end = answered.pop().unwrap();
        assert_eq!((&end["end"]["frames"], &end["end"]["skipped"]), (&12.into(), &0.into()), "{end}");
        assert!(answered.iter().map(|answer| answer["frame"].as_u64()).eq((0..12).map(Some)));
        check_same(&trial, &from_files, &live);
        // An answer says what the files say, rounded.
        let means = column(&fs::read(trial.path(&live).join("joints.csv")).unwrap(), "x_mean_m");
        let answered = answered[4]["points"]["mean"][0][0].as_f64().unwrap();
        assert!((means[4 * means.len() / 12].parse::<f64>().unwrap() - answered).abs() < 1e-5);
    }
}

#[test]
fn a_set_up_of_the_first_frames_is_that_of_the_same_frames_in_files() {
    let trial = trial(1.0);
    let from_files = trial.track(&["--setup-frames", "0..24", "--frames", "24..30", "--patience=1", "-ofiles"]);
    assert!(from_files.status.success(), "{}", trial.printed(&from_files));
    let mut running = Running::begun(&trial, &["--setup-seconds", "0.8", "-olive"]);
    let lines: Vec<String> = (0..30).map(|frame| line(&trial, frame)).collect();
    running.send(&lines.join("\n"));
    let (_, code, printed) = running.ended();
    assert_eq!(code, 0, "{printed}");
    assert!(printed.contains("set-up from frames 0..24"), "{printed}");
    check_same(&trial, "files", "live");
}

#[test]
fn a_line_that_is_no_next_frame_is_refused_and_the_run_continues() {
    let trial = set_up(0.3);
    let mut running = Running::begun(&trial, &["--setup", "setup.toml", "-olive"]);
    running.exchange(&trial, 2);
    let unknown = line(&trial, 3).replace("\"C4\"", "\"C9\"");
    let refused = [
        ("{\"frame\": 3, \"cameras\": {".to_owned(), None, "ends inside"),
        ("no JSON".to_owned(), None, "line 3"),
        (unknown, Some(3), "no calibration for `C9`"),
        (line(&trial, 2), Some(2), "frame 2 came before"),
        (line(&trial, 1), Some(1), "frame 1 came after frame 2"),
        (line(&trial, 3).replacen("3", "99999", 1), Some(99999), "frame 99999 came after frame 2; at most 1800"),
        (line(&trial, 3).replace("\"people\"", "\"persons\""), Some(3), "`people` is missing"),
    ];
    for (line, frame, expected) in &refused {
        running.send(line);
        let answer = running.answer();
        assert!(answer["refused"].as_str().unwrap().contains(expected), "{answer}");
        assert_eq!(answer["frame"].as_u64(), *frame, "{answer}");
    }
    // An empty line is nothing; a camera may send nothing.
    running.send("");
    running.send(&line(&trial, 3).replace("\"C4\":{", "\"C4\":null,\"other\":{"));
    let answer = running.answer();
    assert!(answer["refused"].as_str().unwrap().contains("no calibration for `other`"), "{answer}");
    let mut without: Value = serde_json::from_str(&line(&trial, 4)).unwrap();
    without["cameras"]["C4"] = Value::Null;
    without["cameras"].as_object_mut().unwrap().remove("C3");
    running.send(&without.to_string());
    let numbers: Vec<Value> = (0..2).map(|_| running.answer()["frame"].clone()).collect();
    assert_eq!(numbers, [3, 4]);
    let (_, code, printed) = running.ended();
    assert_eq!(code, 0, "{printed}");
    let joints = fs::read(trial.path("live/frames.csv")).unwrap();
    assert_eq!(column(&joints, "observed"), ["1", "0", "1"]);
    for said in ["C3 sent nothing in 1 frames", "1 frames never came", "5 lines could not be read"] {
        assert!(printed.contains(said), "{said}: {printed}");
    }
    assert_eq!(printed.matches("warning: refused: ").count(), 4, "{printed}");
}

/// A recording that is sent at once, as a pipe or a file sends it, is tracked whole.
#[test]
fn frames_of_a_burst_wait() {
    let trial = set_up(1.0);
    let same = ["--setup", "setup.toml", "--patience=1"];
    assert!(trial.track(&[&same[..], &["-ofiles"]].concat()).status.success());
    let mut running = Running::begun(&trial, &[&same[..], &["-olive"]].concat());
    let lines: Vec<String> = (0..30).map(|frame| line(&trial, frame)).collect();
    running.send(&lines.join("\n"));
    let (answers, code, printed) = running.ended();
    assert_eq!(code, 0, "{printed}");
    let end = &answers.last().unwrap()["end"];
    assert_eq!((&end["skipped"], &end["frames"], &end["complete"]), (&0.into(), &30.into(), &true.into()), "{end}");
    check_same(&trial, "files", "live");
}

#[test]
fn frames_of_a_burst_are_skipped_where_that_is_asked_for_and_the_run_is_not_complete() {
    let trial = set_up(1.0);
    let mut running = Running::begun(&trial, &["--setup", "setup.toml", "--skip", "-olive"]);
    running.exchange(&trial, 0);
    let burst: Vec<String> = (1..30).map(|frame| line(&trial, frame)).collect();
    running.send(&burst.join("\n"));
    let (answers, code, printed) = running.ended();
    assert_eq!(code, 0, "{printed}");
    let end = &answers.last().unwrap()["end"];
    let skipped = end["skipped"].as_u64().unwrap() as usize;
    let observed = column(&fs::read(trial.path("live/frames.csv")).unwrap(), "observed");
    assert!(skipped > 5 && observed.len() == 30 && end["complete"] == false, "{end}");
    let summary: Value = serde_json::from_slice(&fs::read(trial.path("live/summary.json")).unwrap()).unwrap();
    assert_eq!(summary["complete"], false);
    assert_eq!(observed.iter().filter(|observed| *observed == "0").count(), skipped);
    assert!(printed.contains(&format!("{skipped} frames came faster than they could be tracked")), "{printed}");
}

#[test]
fn nobody_need_read_the_answers() {
    let trial = set_up(0.5);
    // Far more than a pipe holds is never read; then the reader goes away.
    for goes_away in [false, true] {
        let mut running = Running::begun(&trial, &["--setup", "setup.toml", "-olive", "--force"]);
        let (answers, mut child) = (running.answers, running.child);
        let mut answers = Some(answers);
        if goes_away {
            answers = None;
        }
        for frame in 0..15 {
            writeln!(running.frames.as_mut().unwrap(), "{}", line(&trial, frame)).unwrap();
            std::thread::sleep(Duration::from_millis(60));
        }
        drop(running.frames.take());
        let mut printed = String::new();
        child.stderr.take().unwrap().read_to_string(&mut printed).unwrap();
        assert!(child.wait().unwrap().success(), "{printed}");
        assert_eq!(printed.contains("nobody reads the answers"), goes_away, "{printed}");
        let summary: Value = serde_json::from_slice(&fs::read(trial.path("live/summary.json")).unwrap()).unwrap();
        assert_eq!((&summary["complete"], &summary["frame_count"]), (&true.into(), &15.into()));
        drop(answers);
    }
}

#[test]
fn no_frame_is_an_error_and_leaves_nothing() {
    let trial = set_up(0.3);
    for (more, expected) in [
        (&["--setup", "setup.toml", "-olive"][..], "no frame came"),
        (&["-olive"], "no frame came"),
        (&["-olive", "--smooth"], "`smooth` has no use where frames come live"),
        (&["-olive", "--keypoints", "pose"], "`keypoints` has no use where frames come live"),
    ] {
        let (answers, code, printed) = Running::begun(&trial, more).ended();
        assert!(answers.is_empty() && printed.contains(expected), "{code}: {printed}");
        assert!(!trial.path("live/summary.json").exists());
    }
    let mut running = Running::begun(&trial, &["-olive"]);
    running.send(&line(&trial, 0));
    let (_, code, printed) = running.ended();
    assert!(code == 3 && printed.contains("the frames ended after 1 of 150 for the set-up"), "{code}: {printed}");
}

#[cfg(unix)]
#[test]
fn an_interrupt_completes_the_results() {
    let trial = set_up(0.3);
    let mut running = Running::begun(&trial, &["--setup", "setup.toml", "-olive"]);
    (0..4).for_each(|frame| drop(running.exchange(&trial, frame)));
    let process = running.child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &process]).status().unwrap().success());
    let held = running.frames.take();
    let (answers, code, printed) = running.finished();
    drop(held);
    assert_eq!((code, &answers.last().unwrap()["end"]["frames"]), (0, &4.into()), "{printed}");
}

/// A gap of a minute at 30 frames a second, and a camera whose name is as long as a line may be.
#[cfg(unix)]
#[test]
fn an_interrupt_ends_a_run_in_a_gap() {
    let trial = set_up(0.3);
    let mut running = Running::begun(&trial, &["--setup", "setup.toml", "-olive"]);
    (0..2).for_each(|frame| drop(running.exchange(&trial, frame)));
    running.send(&format!("{{\"frame\":2,\"cameras\":{{\"{}\":null}}}}", "x".repeat(8 << 20)));
    let refused = running.answer()["refused"].as_str().unwrap().to_owned();
    assert!(refused.starts_with("no calibration for `xxx") && refused.len() <= 500, "{} bytes", refused.len());
    running.send(&line(&trial, 2).replace("\"frame\":2", "\"frame\":1700"));
    assert_eq!(running.answer()["frame"], 2);
    let process = running.child.id().to_string();
    assert!(std::process::Command::new("kill").args(["-INT", &process]).status().unwrap().success());
    let held = running.frames.take();
    let (answers, code, printed) = running.finished();
    drop(held);
    let frames = answers.last().unwrap()["end"]["frames"].as_u64().unwrap();
    assert!(code == 0 && (3..1000).contains(&frames), "{code}, {frames}: {printed}");
    assert!(printed.contains(&format!("{} frames never came; the motion prior bridges them", frames - 2)), "{printed}");
}

#[test]
fn a_socket_answers_who_connects() {
    let trial = set_up(0.3);
    let mut command = trial.command(&[&LIVE[..], &QUICK, &["--fps=30", "--setup=setup.toml", "-olive"]].concat());
    let mut child = command.args(["--live", "tcp:127.0.0.1:0"]).stderr(Stdio::piped()).spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap()).lines();
    let place = said.find_map(|line| line.unwrap().strip_prefix("listening on tcp:").map(str::to_owned)).unwrap();
    let mut frames = TcpStream::connect(place).unwrap();
    let mut answers = BufReader::new(frames.try_clone().unwrap()).lines();
    assert!(frames.write_all(format!("{}\n", line(&trial, 0)).as_bytes()).is_ok());
    assert!(answers.next().unwrap().unwrap().starts_with("{\"begin\""));
    assert!(answers.next().unwrap().unwrap().starts_with("{\"frame\":0,"));
    frames.shutdown(std::net::Shutdown::Write).unwrap();
    assert!(answers.next().unwrap().unwrap().starts_with("{\"end\""));
    assert!(child.wait().unwrap().success());
    let elsewhere = trial.run(&[&LIVE[..], &["--live=tcp:0.0.0.0:7"]].concat());
    assert_eq!(elsewhere.status.code(), Some(2));
}
