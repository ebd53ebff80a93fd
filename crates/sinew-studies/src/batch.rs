//! `cargo xtask study batch`: what many trials cost beside their tracking, and what would limit a million.
//!
//! Short trials of simulated walkers (tables of keypoints of three cameras, ten frames; each subject's trials share a set-up) go through `sinew batch plan`, `run` and `gather`. Overhead of a trial is its share of the time of two workers, from the start of the program to its end, less set-up and tracking as the ledger has them: reading, writing, waiting for
//! the disk, angles of the draws. A trial that waits for the set-up of its subject is set up meanwhile. Memory is the program's own (anonymous pages): means while 5 to 15 % and 90 to 100 % of the trials were done.

mod groups;
mod keypoint_tables;
mod queue;

use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown};
use crate::support::statistics::verdict;
use crate::support::study_options::ProgramOptions;
use crate::support::table::header;
use keypoint_tables::write_keypoints;
use serde_json::Value;
use sinew::core::random::Stage;
use sinew_simulate::adult;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_simulate::ring::Ring;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command};
use std::time::{Duration, Instant};

/// Overhead of a trial at most, milliseconds.
const MOST_MS: f64 = 20.0;
/// Trials beside each other.
const WORKERS: usize = 2;
/// Memory at the end over that at a tenth, at most.
const MOST_GROWTH: f64 = 1.05;
/// Subjects, each with a set-up.
const SUBJECTS: usize = 10;
/// Frames of a trial.
const FRAMES: usize = 10;
const RATE_HZ: f64 = 30.0;

/// What to run.
#[derive(clap::Args)]
pub struct Args {
    /// Trials, a tenth of them of each of ten subjects
    #[arg(long, default_value_t = 10_000)]
    trials: usize,
    /// Only means of angles, of this number of subjects, against the truth
    #[arg(long)]
    groups: Option<usize>,
    /// Only the same of this number of sessions with several subjects
    #[arg(long)]
    sessions: Option<usize>,
    #[command(flatten)]
    options: ProgramOptions,
    /// Only the simulated cluster, with these seconds of computing and of overhead a trial
    #[arg(long, num_args = 2, value_names = ["COMPUTING", "OVERHEAD"])]
    queue: Option<Vec<f64>>,
}

/// Runs the command.
pub fn run(root: &Path, args: &Args) -> Outcome<()> {
    if let Some([computing_s, overhead_s]) = args.queue.as_deref() {
        print!("{}", queue::table(*computing_s, *overhead_s));
        return Ok(());
    }
    let program = args.options.program(root, "batch")?;
    let folder = program.folder.clone();
    if let Some(subjects) = args.groups {
        print!("{}", groups::table(&program, &folder, subjects)?);
        return Ok(());
    }
    if let Some(sessions) = args.sessions {
        print!("{}", groups::table_of_sessions(&program, &folder, sessions)?);
        return Ok(());
    }
    let trials = folder.join("trials");
    if trials.exists() {
        fs::remove_dir_all(&trials)?;
    }
    (0..SUBJECTS).try_for_each(|subject| write_subject(&trials, subject, args.trials / SUBJECTS))?;
    print!(
        "{}",
        header(
            "| results | trials | computing a trial, ms | overhead a trial, ms | memory at a tenth, MB | at the end | plan, s | gather, s | in all, s | verdict |"
        )
    );
    for (name, flags) in [("packed", &["--pack"][..]), ("folders", &[][..])] {
        let row = study(&program, &trials, &folder.join(name), name, flags)?;
        println!("{row}");
    }
    Ok(())
}

/// Trials of one subject, cut from one walk.
fn write_subject(trials: &Path, subject: usize, count: usize) -> Outcome<()> {
    let seed = subject as u64;
    let proportions = adult::drawn(&Stage::new(seed, "walker"));
    let duration_s = 4.0;
    let ring = Ring { cameras: 3, ..Ring::default() };
    let script = Script { duration_s, rate_hz: RATE_HZ, proportions, ring, ..Script::default() };
    let walk = SyntheticRecording::new(&script, seed)?;
    let folder = trials.join(format!("S{subject:02}"));
    fs::create_dir_all(&folder)?;
    fs::write(folder.join("Calib.toml"), walk.calibration_toml())?;
    let settings = format!(
        "root = true\nsubject = \"S{subject:02}\"\ncalibration = \"Calib.toml\"\nfps = {RATE_HZ}\nthreads = 1\nmax_r_hat_share = 1.0\n"
    );
    fs::write(folder.join("sinew.toml"), settings)?;
    let frames = walk.keypoints[0].len();
    for trial in 0..count {
        let first = (7 * trial) % (frames - FRAMES);
        let own = folder.join(format!("T{trial:05}"));
        for (camera, keypoints) in walk.cameras.iter().zip(&walk.keypoints) {
            write_keypoints(&walk, camera, &keypoints[first..first + FRAMES], &own)?;
        }
    }
    Ok(())
}

/// A row of the table: a study planned, run and gathered.
fn study(program: &Program, trials: &Path, study: &Path, name: &str, flags: &[&str]) -> Outcome<String> {
    if study.exists() {
        fs::remove_dir_all(study)?;
    }
    let (trials, place) = (shown(trials), shown(study));
    let plan = [&["batch", "plan", trials.as_str(), "-o", &place], flags].concat();
    let timed = |arguments: &[&str]| -> Outcome<f64> {
        let started = Instant::now();
        program.run(&arguments.iter().map(|text| (*text).to_owned()).collect::<Vec<_>>(), &[0, 4])?;
        Ok(started.elapsed().as_secs_f64())
    };
    let plan_s = timed(&plan)?;
    let started = Instant::now();
    let child =
        Command::new(&program.path).args(["batch", "run", &place, "-q", "--threads", &WORKERS.to_string()]).spawn()?;
    let memory = watched(child, &study.join("ended/0-of-1.jsonl"))?;
    let run_s = started.elapsed().as_secs_f64();
    let gather_s = timed(&["batch", "gather", &place])?;
    let lines: Vec<Value> = fs::read_to_string(study.join("ended/0-of-1.jsonl"))?
        .lines()
        .map(serde_json::from_str)
        .collect::<Result<_, _>>()?;
    let computing_s: f64 = lines.iter().filter_map(|line| line["computing_s"].as_f64()).sum();
    let a_trial = |seconds: f64| 1e3 * seconds / lines.len() as f64;
    let overhead = a_trial(WORKERS as f64 * run_s - computing_s);
    let [tenth, last] = [[5, 15], [90, 100]].map(|between| mean_memory(&memory, lines.len(), between));
    let holds = overhead <= MOST_MS && last <= MOST_GROWTH * tenth;
    Ok(format!(
        "| {name} | {} | {:.1} | {overhead:.1} | {tenth:.0} | {last:.0} | {plan_s:.1} | {gather_s:.1} | {run_s:.0} | {} |",
        lines.len(),
        a_trial(computing_s),
        verdict(holds)
    ))
}

/// Mean memory while between two percentages of all trials were done: at one moment it depends on what is at hand.
fn mean_memory(memory: &[(usize, f64)], trials: usize, [from, to]: [usize; 2]) -> f64 {
    let is_then = |(done, _): &&(usize, f64)| (from * trials..=to * trials).contains(&(100 * done));
    let then: Vec<f64> = memory.iter().filter(is_then).map(|(_, megabytes)| *megabytes).collect();
    then.iter().sum::<f64>() / then.len() as f64
}

/// Waits for a run, and notes how many trials are done and how much memory it holds, megabytes.
fn watched(mut child: Child, ledger: &Path) -> Outcome<Vec<(usize, f64)>> {
    let status = PathBuf::from(format!("/proc/{}/status", child.id()));
    let mut noted = vec![];
    loop {
        if let Some(ended) = child.try_wait()? {
            return if matches!(ended.code(), Some(0 | 4)) { Ok(noted) } else { Err(format!("{ended}").into()) };
        }
        let held = fs::read_to_string(&status).unwrap_or_default();
        let kilobytes =
            held.lines().find_map(|line| line.strip_prefix("RssAnon:")?.split_whitespace().next()?.parse::<f64>().ok());
        let done = fs::read(ledger).map_or(0, |bytes| bytes.iter().filter(|byte| **byte == b'\n').count());
        noted.extend(kilobytes.map(|kilobytes| (done, kilobytes / 1024.0)));
        std::thread::sleep(Duration::from_millis(500));
    }
}
