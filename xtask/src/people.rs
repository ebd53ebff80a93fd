//! `cargo xtask people`: are several people found and kept apart? The tables of docs/evidence/people.md.
//!
//! Crowds of [`sinew_simulate::crowd`], with their truth; beside the tracker's own association ([`sinew::observe::identities`]) the usual recipe ([`sinew_tests::evaluation::ray_association`]). Both get the same detections, and points are triangulated alike. Speeds are the program's, from files.

use crate::outcome::{Outcome, exit_code};
use crate::program::{self, Program, shown};
use sinew::formats::calib_toml;
use sinew::formats::openpose::Keypoint;
use sinew::input::limbs::{LIMBS, limbs};
use sinew::input::roll::LEAST_S;
use sinew::observe::Detection;
use sinew::observe::association::{Config, Person, triangulated};
use sinew::observe::identities::Identities;
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::crowd::{Crowd, CrowdNoise, CrowdRecording};
use sinew_simulate::ring::Ring;
use sinew_tests::evaluation::ray_association;
use sinew_tests::evaluation::several_people::{Counts, Track, counted};
use std::fmt::Write as _;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// What to run.
#[derive(clap::Args)]
pub struct Args {
    /// Crowds of each size
    #[arg(long, default_value_t = 10)]
    seeds: u64,
    /// Seed of the first; crowds from 1 on were looked at before
    #[arg(long, default_value_t = 101)]
    first: u64,
    /// The program `sinew`, whose speed is measured [default: it is built]
    #[arg(long)]
    program: Option<PathBuf>,
    /// Leave the speeds out
    #[arg(long)]
    no_speed: bool,
    /// Folder of the tables [default: target/people]
    #[arg(long)]
    out: Option<PathBuf>,
}

/// Sizes of crowds.
const SIZES: [usize; 3] = [2, 3, 4];
/// Sizes of crowds of which speed is measured.
const TIMED: [usize; 4] = [1, 2, 4, 8];

/// A crowd of some people before four cameras.
fn crowd(people: usize, duration_s: f64) -> Crowd {
    Crowd {
        people,
        duration_s,
        rate_hz: 30.0,
        ring: Ring::default(),
        calibration: CalibrationError::USUAL,
        noise: CrowdNoise::DETECTOR_LIKE,
    }
}

fn detections(found: &[Option<Keypoint>]) -> Person {
    found.iter().map(|k| k.map(|k| Detection::new([k.x, k.y], k.confidence))).collect()
}

/// People of each frame and camera.
fn frames(recording: &CrowdRecording) -> Vec<Vec<Vec<Person>>> {
    let count = recording.keypoints.first().map_or(0, Vec::len);
    let frame = |f: usize| {
        recording.keypoints.iter().map(|camera| camera[f].iter().map(|found| detections(found)).collect()).collect()
    };
    (0..count).map(frame).collect()
}

/// Tracks of our own association.
fn own(recording: &CrowdRecording, frames: &[Vec<Vec<Person>>]) -> Vec<Track> {
    let config = Config::default();
    let cameras = &recording.cameras;
    let mut identities = Identities::new(cameras, limbs(&recording.layout), recording.rate_hz, config);
    let mut tracks: Vec<Track> = vec![];
    for (frame, people) in frames.iter().enumerate() {
        let named = identities.name(people);
        let count = named.iter().flatten().flatten().map(|k| k + 1).max().unwrap_or(0).max(tracks.len());
        tracks.resize(count, vec![None; frame]);
        for (k, track) in tracks.iter_mut().enumerate() {
            let member = |view: &Vec<Option<usize>>| view.iter().position(|name| *name == Some(k));
            let members: Vec<Option<usize>> = named.iter().map(member).collect();
            let points = triangulated(cameras, people, &members, &config);
            track.push((points.iter().flatten().count() >= config.least_keypoints).then_some(points));
        }
    }
    tracks
}

/// Tracks that last a quarter of a second, of both methods.
fn lasting(tracks: Vec<Track>, rate_hz: f64) -> Vec<Track> {
    let least = (LEAST_S * rate_hz).ceil() as usize;
    tracks.into_iter().filter(|track| track.iter().flatten().count() >= least).collect()
}

/// True tracks in the order of the layout, and its limbs.
fn truth(recording: &CrowdRecording) -> Vec<Track> {
    let points = |person: &sinew_motion::points::Trajectories, frame: &Vec<[f64; 3]>| {
        let place = |name: &Option<String>| name.as_deref().and_then(|name| person.index(name)).map(|k| frame[k]);
        Some(recording.layout.points.iter().map(place).collect())
    };
    recording.truth.iter().map(|person| person.frames.iter().map(|frame| points(person, frame)).collect()).collect()
}

fn counts(people: usize, seed: u64, duration_s: f64) -> Outcome<[Counts; 2]> {
    let recording = CrowdRecording::new(&crowd(people, duration_s), seed)?;
    let (frames, truth) = (frames(&recording), truth(&recording));
    let found = [own(&recording, &frames), ray_association::tracks(&recording.cameras, &frames)];
    let limbs: Vec<(usize, usize)> = LIMBS
        .iter()
        .filter_map(|ends| Some((recording.layout.index(ends[0])?, recording.layout.index(ends[1])?)))
        .collect();
    Ok(found.map(|tracks| counted(&truth, &lasting(tracks, recording.rate_hz), &limbs)))
}

/// Seconds of a crowd.
const DURATION_S: f64 = 5.0;

fn quality(seeds: Range<u64>) -> Outcome<String> {
    let mut text = String::from(
        "| people | association | switches a minute | misses, % | false people, % | MOTA, % | IDF1, % | PCP, % |\n|---|---|---|---|---|---|---|---|\n",
    );
    for people in SIZES {
        let all = seeds.clone().map(|seed| counts(people, seed, DURATION_S)).collect::<Outcome<Vec<_>>>()?;
        for (method, name) in ["ours", "usual recipe"].into_iter().enumerate() {
            let of = |value: &dyn Fn(&Counts) -> f64| {
                let values: Vec<f64> = all.iter().map(|found| value(&found[method])).collect();
                let mean = values.iter().sum::<f64>() / values.len() as f64;
                let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
                format!(
                    "{mean:.1} ± {:.1}",
                    (square / (values.len() as f64 - 1.0).max(1.0) / values.len() as f64).sqrt()
                )
            };
            let share = |part: usize, counts: &Counts| 100.0 * part as f64 / counts.people as f64;
            let _ = writeln!(
                text,
                "| {people} | {name} | {} | {} | {} | {} | {} | {} |",
                of(&|c| c.switches as f64 * 60.0 / DURATION_S),
                of(&|c| share(c.misses, c)),
                of(&|c| share(c.false_people, c)),
                of(&|c| 100.0 * c.mota()),
                of(&|c| 100.0 * c.idf1()),
                of(&|c| 100.0 * c.pcp()),
            );
        }
    }
    Ok(text)
}

/// Writes a crowd as files.
fn write(recording: &CrowdRecording, folder: &Path) -> Outcome<()> {
    for camera in &recording.cameras {
        std::fs::create_dir_all(folder.join(format!("keypoints/{}_json", camera.name)))?;
    }
    for (name, text) in recording.keypoint_files() {
        std::fs::write(folder.join("keypoints").join(name), text)?;
    }
    Ok(std::fs::write(folder.join("Calib.toml"), calib_toml::write(&recording.cameras))?)
}

fn speed(program: &Program) -> Outcome<String> {
    let mut text = String::from("| people | frames a second, one thread | two threads |\n|---|---|---|\n");
    for people in TIMED {
        let recording = CrowdRecording::new(&crowd(people, DURATION_S), 1)?;
        let folder = program.folder.join(format!("crowd-{people}"));
        write(&recording, &folder)?;
        let frames = recording.truth[0].frames.len() as f64;
        let timed = |threads: usize| -> Outcome<f64> {
            let paths = ["Calib.toml", "keypoints", "out"].map(|name| shown(&folder.join(name)));
            let threads = threads.to_string();
            let flags = ["--calibration", &paths[0], "--keypoints", &paths[1], "--layout", "BODY_25B", "--fps", "30"];
            let rest = ["--people", "all", "--force", "--no-progress", "--threads", &threads];
            let start = Instant::now();
            program
                .track(&flags.into_iter().chain(rest).map(str::to_owned).collect::<Vec<_>>(), Path::new(&paths[2]))?;
            Ok(frames / start.elapsed().as_secs_f64())
        };
        let _ = writeln!(text, "| {people} | {:.0} | {:.0} |", timed(1)?, timed(2)?);
    }
    Ok(text)
}

fn all(root: &Path, args: &Args) -> Outcome<()> {
    let folder = args.out.clone().unwrap_or_else(|| root.join("target/people"));
    std::fs::create_dir_all(&folder)?;
    let mut text = quality(args.first..args.first + args.seeds)?;
    if !args.no_speed {
        let path = match &args.program {
            Some(path) => path.clone(),
            None => program::built(root)?,
        };
        text += &format!("\n{}", speed(&Program { path, folder: folder.clone() })?);
    }
    println!("{text}");
    Ok(std::fs::write(folder.join("tables.md"), text)?)
}

/// Runs the command.
pub fn run(root: &Path, args: &Args) -> ExitCode {
    exit_code(all(root, args))
}
