//! `cargo xtask study soak`: a long recording through the whole program, to see that nothing grows, slows or drifts.
//!
//! A synthetic walker of 1000 frames is played forwards and backwards until there are enough, the tracker running on through the turns, and a result folder is written as `sinew track` does. Judged, for each method:
//!
//! - memory of the process's own (anonymous pages, swapped ones included; pages of files come and go as the system likes) at the end against that after frame 20 000, or the middle of a shorter run: at most 5 % more. Before that the allocator's heaps fill: each thread comes to hold an array of the particles;
//! - processor time of the last whole window of 1000 frames against that of frames 1000 to 2000: at most 1.1 times (wall time says more about what else the machine does; its medians of some windows are printed);
//! - open files: as many at the end as after frame 1000;
//! - root mean square error over root mean square standard deviation of the points of `joints.csv`, last 1000 frames against the first: at most 1.2 times.

use crate::support::outcome::Outcome;
use crate::support::statistics::{median, verdict};
use sinew::Error;
use sinew::config::{Sources, resolve};
use sinew::formats::Layout;
use sinew::input::in_memory::InMemory;
use sinew::input::source::FrameSource;
use sinew::observe::Camera;
use sinew::observe::association::Person;
use sinew::track::job;
use sinew::track::job::{RunPhase, Watch};
use sinew_body::points::Trajectories;
use sinew_input::Error as InputError;
use sinew_results::claim;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::simulated_source::source;
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Frames of the walk, and of a window that is judged.
const WINDOW: u64 = 1000;
/// Frames until memory is judged.
const WARM_UP: u64 = 20_000;
const SEED: u64 = 20;

/// What to run.
#[derive(clap::Args)]
pub struct Args {
    /// Frames to track, three windows of 1000 at least.
    #[arg(long, default_value_t = 100_000, value_parser = clap::value_parser!(u64).range(3 * WINDOW..))]
    frames: u64,
    /// Only this method.
    #[arg(long, value_parser = ["hmc", "bootstrap"])]
    method: Option<String>,
    /// Folder for the results, some 15 kB a frame; removed at the end.
    #[arg(long, default_value = "sinew-out/soak")]
    out: PathBuf,
}

/// A walk to and fro.
struct ToAndFro {
    walk: InMemory,
    truth: Trajectories,
    frames: u64,
}

impl ToAndFro {
    /// Frame of the walk that is played.
    fn played(&self, number: u64) -> u64 {
        let last = self.walk.frames().end - 1;
        let place = number % (2 * last);
        place.min(2 * last - place)
    }
}

impl FrameSource for ToAndFro {
    fn cameras(&self) -> &[Camera] {
        &self.walk.cameras
    }
    fn layout(&self) -> &Layout {
        &self.walk.layout
    }
    fn frames(&self) -> Range<u64> {
        0..self.frames
    }
    fn people(&mut self, number: u64) -> Result<Vec<Vec<Person>>, InputError> {
        self.walk.people(self.played(number))
    }
}

/// What is seen of the process while it tracks.
#[derive(Default)]
struct Seen {
    /// Milliseconds of each frame of the window at hand, and the medians of those before.
    window: Vec<f64>,
    medians: Vec<f64>,
    /// Processor milliseconds a frame of each whole window, and the ticks at the end of the last one.
    processor: Vec<f64>,
    ticks: u64,
    /// Own memory after each whole window.
    own_kb: Vec<u64>,
    open_files: [usize; 2],
}

/// Runs the command.
pub fn run(args: &Args) -> Outcome<ExitCode> {
    let methods = args.method.as_deref().map_or(vec!["hmc", "bootstrap"], |method| vec![method]);
    let mut passed = true;
    for method in methods {
        passed &= soak(method, args)?;
    }
    Ok(if passed { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

fn soak(method: &str, args: &Args) -> Outcome<bool> {
    let script = Script { duration_s: WINDOW as f64 / 30.0, ..Script::default() };
    let walk = SyntheticRecording::new(&script, SEED)?;
    let mut source = ToAndFro { walk: source(&walk), truth: walk.truth, frames: args.frames };
    let out = args.out.join(method);
    let settings = [
        ("method", method),
        ("out", &out.to_string_lossy()),
        ("fps", "30"),
        ("chains", "8"),
        ("updates", "6"),
        ("burn_in", "2"),
        ("particles", "1024"),
        ("draws", "4"),
    ];
    let flags = settings.map(|(key, value)| (key, value.to_owned())).into();
    let resolved = resolve(&Sources { flags, ..Sources::default() })?;
    let claim = claim(&out, &[], true)?;
    let mut seen = Seen::default();
    let mut before = Instant::now();
    let mut progress = |pass: RunPhase, done: u64, _: u64| {
        let now = Instant::now();
        if pass == RunPhase::Track {
            seen.frame(done, args.frames, 1e3 * (now - before).as_secs_f64());
        }
        before = now;
    };
    let stop = AtomicBool::new(false);
    let started = Instant::now();
    let mut watch = Watch { progress: &mut progress, stop: &stop };
    job::track(&mut source, 0..300, &resolved, claim, &mut watch, None)?;
    let wall_s = started.elapsed().as_secs_f64();
    let [first, last] = errors(&out.join("joints.csv"), &source)?;
    fs::remove_dir_all(&out).map_err(Error::io("remove", &out))?;
    println!("{method}: {} frames in {wall_s:.0} s", args.frames);
    Ok(seen.judge(first, last))
}

impl Seen {
    fn frame(&mut self, done: u64, frames: u64, ms: f64) {
        self.window.push(ms);
        if done.is_multiple_of(WINDOW) || done == frames {
            if self.window.len() as u64 == WINDOW {
                self.medians.push(median(&self.window));
                let ticks = processor_ticks();
                self.processor.push((ticks - self.ticks) as f64 * TICK_MS / WINDOW as f64);
                self.ticks = ticks;
                self.own_kb.push(own_kb());
            }
            self.window.clear();
        }
        let at = match done {
            WINDOW => 0,
            _ if done == frames => 1,
            _ => return,
        };
        self.open_files[at] = fs::read_dir("/proc/self/fd").map_or(0, Iterator::count);
    }

    /// Prints what was measured and whether it is as it must be.
    fn judge(&self, first: f64, last: f64) -> bool {
        let mut all = true;
        let mut row = |what: &str, from: f64, to: f64, unit: &str, most: f64| {
            let ratio = to / from;
            let passed = ratio <= most;
            all &= passed;
            println!(
                "  {what:<34} {from:>9.3} -> {to:>9.3} {unit:<6} ratio {ratio:.3}, at most {most}: {}",
                verdict(passed)
            );
        };
        let warm = (WARM_UP / WINDOW).min(self.own_kb.len() as u64 / 2) as usize;
        let [from, to] = [self.own_kb.get(warm.saturating_sub(1)), self.own_kb.last()]
            .map(|kb| kb.map_or(f64::NAN, |&kb| kb as f64 / 1024.0));
        row(&format!("own memory, frame {} to end", warm as u64 * WINDOW), from, to, "MiB", 1.05);
        let time = |at: usize| self.processor.get(at).copied().unwrap_or(f64::NAN);
        row("processor time, 2nd window to last", time(1), time(self.processor.len().saturating_sub(1)), "ms", 1.1);
        let [from, to] = self.open_files.map(|count| count as f64);
        row("open files, frame 1000 to end", from, to, "", 1.0);
        row("error / sd, first window to last", first, last, "", 1.2);
        let stride = self.medians.len().div_ceil(10);
        let some: Vec<String> = self.medians.iter().step_by(stride).map(|ms| format!("{ms:.2}")).collect();
        println!("  median wall ms a frame by window: {}", some.join(" "));
        let some: Vec<String> =
            self.own_kb.iter().step_by(stride).map(|&kb| format!("{:.2}", kb as f64 / 1024.0)).collect();
        println!("  own memory, MiB, by window: {}", some.join(" "));
        all
    }
}

/// Milliseconds of a tick, on every Linux there is.
const TICK_MS: f64 = 10.0;

/// Processor time of this process, user and system, all threads.
fn processor_ticks() -> u64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = stat.rsplit_once(')').map_or("", |(_, rest)| rest);
    after_name.split_whitespace().skip(11).take(2).filter_map(|ticks| ticks.parse::<u64>().ok()).sum()
}

/// Anonymous memory of this process, resident or swapped.
fn own_kb() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let own = status.lines().filter(|line| line.starts_with("RssAnon:") || line.starts_with("VmSwap:"));
    own.filter_map(|line| line.split_whitespace().nth(1)?.parse::<u64>().ok()).sum()
}

/// Root mean square error over root mean square standard deviation, all points and axes, in the first window and in the last.
fn errors(joints: &Path, source: &ToAndFro) -> Result<[f64; 2], Error> {
    let file = fs::File::open(joints).map_err(Error::io("read", joints))?;
    let mut lines = BufReader::new(file).lines();
    let header = lines.next().transpose().map_err(Error::io("read", joints))?.unwrap_or_default();
    let column = |name: &str| header.split(',').position(|column| column == name).unwrap_or(usize::MAX);
    let (frame, joint) = (column("frame"), column("joint"));
    let axes = ["x", "y", "z"].map(|axis| [column(&format!("{axis}_mean_m")), column(&format!("{axis}_sd_m"))]);
    let truth = &source.truth;
    let mut sums = [[0.0, 0.0]; 2];
    for line in lines {
        let line = line.map_err(Error::io("read", joints))?;
        let cells: Vec<&str> = line.split(',').collect();
        let cell = |column: usize| cells.get(column).copied().unwrap_or_default();
        let number: u64 = cell(frame).parse().unwrap_or(u64::MAX);
        let window = match number {
            _ if number < WINDOW => 0,
            _ if number >= source.frames - WINDOW => 1,
            _ => continue,
        };
        let Some(place) = truth.index(cell(joint)) else { continue };
        let at = truth.frames[source.played(number) as usize][place];
        for ([mean, sd], truth) in axes.iter().zip(at) {
            let value = |column: usize| cell(column).parse::<f64>().unwrap_or(f64::NAN);
            sums[window][0] += (value(*mean) - truth).powi(2);
            sums[window][1] += value(*sd).powi(2);
        }
    }
    Ok(sums.map(|[error, variance]: [f64; 2]| (error / variance).sqrt()))
}
