//! What is known of a linear Gaussian recording, in the files of the mean pose, in diagnostics, in live answers and after a kill.

use crate::common::Trial;
use crate::common::known_answers::{DEGREES, DRAWS, Said, run};
use crate::common::linear_world::{FPS, GAUSSIAN, LINEAR, POINTS, Script, World, numbers};
use crate::common::path_posterior::DIM;
use crate::common::tally::Tally;
use serde_json::Value;
use sinew_results::problem;
use std::fs;
use std::io::{BufRead as _, BufReader, Write as _};
use std::process::Stdio;
use std::time::Duration;

/// Numbers of the rows of a table of tabs below a heading, by the name of the column.
fn tabbed(text: &str, heading: usize, rows: usize, name: &str, offset: usize) -> Vec<f64> {
    let lines: Vec<&str> = text.lines().collect();
    let at = lines[heading].split('\t').position(|cell| cell == name).unwrap() + offset;
    lines[rows..].iter().map(|line| line.split('\t').nth(at).unwrap().parse().unwrap()).collect()
}

#[test]
fn files_of_the_mean_pose_and_diagnostics_are_exact() {
    let mut tally = Tally::default();
    for seed in 1..=4 {
        let world = World::new(Script { seed, ..Script::default() });
        let trial = world.write();
        run(&world, &trial, "out", &[]);
        tally.begin_run();
        let text = |file: &str| fs::read_to_string(trial.path(&format!("out/{file}"))).unwrap();
        let (trc, mot) = (text("markers.trc"), text("angles.mot"));
        let of_frames = |name: &str| numbers(&trial, "out/frames.csv", name);
        let evidence = of_frames("log_evidence");
        let mut before = 0.0;
        assert_eq!(evidence.len(), world.script.frames);
        for (frame, evidence) in evidence.iter().enumerate() {
            let said = Said::new(&world, frame);
            let time = frame as f64 / FPS;
            for (file, heading, rows, column) in [(&trc, 3, 6, "Time"), (&mot, 7, 8, "time")] {
                assert!((tabbed(file, heading, rows, column, 0)[frame] - time).abs() < 1e-12);
            }
            assert_eq!(tabbed(&trc, 3, 6, "Frame#", 0)[frame], frame as f64 + 1.0);
            for (point, (name, ..)) in POINTS.iter().enumerate() {
                let exact = [0, 1, 2].map(|axis| said.point(frame, point, axis, |_| 0.0));
                // Y up: z, x, y of the world are Y, Z, X of the file.
                for (axis, offset) in [(0, 2), (1, 0), (2, 1)] {
                    let found = tabbed(&trc, 3, 6, name, offset)[frame];
                    tally.place("markers.trc", found, exact[axis].mean(), exact[axis].sd(), DRAWS);
                }
                let found = numbers(&trial, "out/markers_sd.csv", &format!("{name}_sd_m"))[frame];
                tally.sd("markers_sd.csv", found, (exact.iter().map(|x| x.variance).sum::<f64>() / 3.0).sqrt(), DRAWS);
            }
            for (number, name) in ["trunk_tx", "trunk_ty", "trunk_tz", "arm_rz"].into_iter().enumerate() {
                let (exact, scale) = (said.number(frame, number), if number == 3 { DEGREES } else { 1.0 });
                let found = tabbed(&mot, 7, 8, name, 0)[frame] / scale;
                tally.place("angles.mot", found, exact.mean(), exact.sd(), DRAWS);
            }
            let exact = said.path.log_evidence - before;
            before = said.path.log_evidence;
            assert!((evidence - exact).abs() < 0.15, "frame {frame}: {evidence} for {exact}");
            let residuals = [0, 1].map(|camera| residual_px(&world, &said, frame, camera));
            let squares: Vec<f64> = residuals.iter().flatten().map(|x| x * x).collect();
            let all = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
            let expected =
                [("residual_A_px", residuals[0]), ("residual_B_px", residuals[1]), ("residual_px", Some(all))];
            for (name, exact) in expected {
                let (found, exact) = (of_frames(name)[frame], exact.filter(|x| x.is_finite()));
                assert!(exact.map_or(found.is_nan(), |x| (found - x).abs() < 0.05), "{name}: {found} for {exact:?}");
            }
            let cameras = residuals.iter().flatten().count() as f64;
            assert_eq!((of_frames("quality")[frame], of_frames("observed")[frame]), (cameras, cameras.min(1.0)));
            assert_eq!(of_frames("restarted")[frame], if frame == 0 { 1.0 } else { 0.0 });
            assert_eq!((of_frames("frame")[frame], of_frames("divergences")[frame]), (frame as f64, 0.0));
            assert!((of_frames("time_s")[frame] - time).abs() < 1e-12);
        }
        let summary: serde_json::Value = serde_json::from_str(&text("summary.json")).unwrap();
        let whole = summary["diagnostics"]["log_evidence"].as_f64().unwrap();
        assert!((whole - before).abs() < 0.3, "{whole} for {before}");
        let counts = ["frame_count", "observed_frames", "restarted_frames", "degrees_of_freedom"]
            .map(|key| summary[key].as_u64());
        assert_eq!(counts, [10, 8, 0, 4].map(Some));
    }
    tally.check();
}

/// The median distance of what a camera shows from the mean pose over √(2 ln 2), pixels.
fn residual_px(world: &World, said: &Said<'_>, frame: usize, camera: usize) -> Option<f64> {
    let off = |point: usize, image_axis: usize| {
        let of = (camera * POINTS.len() + point) * 2 + image_axis;
        let row = world.rows.iter().find(|row| row.frame == frame && row.of == of)?;
        Some(row.value - said.of(&[(frame, row.by_state)], |_| 0.0).mean())
    };
    let distance = |point: usize| Some(off(point, 0)?.hypot(off(point, 1)?));
    let mut distances: Vec<f64> = (0..POINTS.len()).filter_map(distance).collect();
    distances.sort_by(f64::total_cmp);
    let n = distances.len();
    (n > 0).then(|| 0.5 * (distances[(n - 1) / 2] + distances[n / 2]) / (2.0 * std::f64::consts::LN_2).sqrt())
}

/// Answers of a live run, each taken before the next frame is sent.
fn answers(world: &World, trial: &Trial) -> Vec<Value> {
    let seed = format!("--seed={}", world.script.seed);
    let more = ["--updates=200", "-olive", "--live=-", &seed];
    let mut command = trial.command(&[&LINEAR[..], &GAUSSIAN, &more].concat());
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
    let (mut frames, mut lines) = (child.stdin.take().unwrap(), BufReader::new(child.stdout.take().unwrap()).lines());
    let mut next = || serde_json::from_str::<Value>(&lines.next().unwrap().unwrap()).unwrap();
    let mut answers = vec![];
    for frame in 0..world.script.frames {
        writeln!(frames, "{}", world.line(frame)).unwrap();
        let answer = next();
        answers.push(if answer["begin"].is_null() { answer } else { next() });
    }
    drop(frames);
    assert!(!next()["end"].is_null() && child.wait().unwrap().success());
    answers
}

#[test]
fn live_answers_are_exact() {
    let mut tally = Tally::default();
    for seed in 1..=10 {
        let world = World::new(Script { seed, ..Script::default() });
        let trial = world.write();
        tally.begin_run();
        for (frame, answer) in answers(&world, &trial).iter().enumerate() {
            let said = Said::new(&world, frame);
            assert_eq!(answer["frame"], frame);
            for point in 0..POINTS.len() {
                for axis in 0..3 {
                    let of = |what: &str| answer["points"][what][point][axis].as_f64().unwrap();
                    let exact = said.point(frame, point, axis, |_| 0.0);
                    tally.place("live, points: mean", of("mean"), exact.mean(), exact.sd(), DRAWS);
                    tally.sd("live, points: sd", of("sd"), exact.sd(), DRAWS);
                    tally.interval("live, points: q05 to q95", [of("q05"), of("q95")], exact.interval(), DRAWS);
                }
            }
            let exact = said.number(frame, 3);
            let of = |what: &str| answer["angles"][what][0].as_f64().unwrap();
            // Of five decimals.
            tally.place("live, angles: mean", of("mean"), exact.mean(), exact.sd(), DRAWS);
            tally.interval("live, angles: q05 to q95", [of("q05"), of("q95")], exact.interval(), DRAWS);
        }
    }
    tally.check();
}

/// The tables of a run that was killed and resumed are those of `filtered_numbers_are_exact`, but for their number of updates.
#[test]
fn a_run_that_was_killed_and_resumed_is_exact() {
    let world = World::new(Script::default());
    let trial = world.write();
    let arguments = [
        &LINEAR[..],
        &GAUSSIAN,
        &["--keypoints=pose", "--updates=1500", "--checkpoint-every=0", "--threads=1", "-oout"],
    ]
    .concat();
    let killed = (0..20).any(|_| {
        let _ = fs::remove_dir_all(trial.path("out"));
        let mut child = trial.command(&arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        while child.try_wait().unwrap().is_none() && !trial.path("out").join(problem::NAME).exists() {
            std::thread::sleep(Duration::from_millis(1));
        }
        let _ = child.kill();
        let _ = child.wait();
        trial.path("out").join(problem::NAME).exists() && !trial.path("out/summary.json").exists()
    });
    assert!(killed);
    let resumed = trial.run(&[&arguments[..], &["--resume"]].concat());
    assert!(resumed.status.success(), "{}", trial.printed(&resumed));
    let joints = numbers(&trial, "out/joints.csv", "x_mean_m");
    let sds = numbers(&trial, "out/joints.csv", "x_sd_m");
    let state = numbers(&trial, "out/state.csv", "mean");
    for frame in 0..world.script.frames {
        let said = Said::new(&world, frame);
        for point in 0..POINTS.len() {
            let (k, exact) = (POINTS.len() * frame + point, said.point(frame, point, 0, |_| 0.0));
            assert!((joints[k] - exact.mean()).abs() < 0.05 * exact.sd(), "{} for {}", joints[k], exact.mean());
            // Six standard errors of the sd of 22,000 draws.
            assert!((sds[k] / exact.sd() - 1.0).abs() < 0.029, "{} for {}", sds[k], exact.sd());
        }
        for (number, found) in state[DIM * frame..][..3].iter().enumerate() {
            let exact = said.number(frame, number);
            assert!((found - exact.mean()).abs() < 0.05 * exact.sd(), "{found} for {}", exact.mean());
        }
    }
}
