//! `cargo xtask study people`: are several people found, kept apart, and known again? The tables of docs/evidence/people.md.
//!
//! Crowds of [`sinew_simulate::crowd`], with their truth; beside the tracker's own association ([`sinew::observe::association::identities`]) the usual recipe ([`sinew_tests::evaluation::ray_association`]). Both get the same detections, and points are triangulated alike. Speeds are the program's, from files.

mod recorded;

use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown, write_recording};
use crate::support::statistics::with_error;
use crate::support::study_options::ProgramOptions;
use crate::support::table::{header, row};
use sinew::formats::calib_toml;
use sinew::formats::openpose::Keypoint;
use sinew::input::limbs::{limbs, paired_limbs};
use sinew::input::roll::LEAST_S;
use sinew::observe::Detection;
use sinew::observe::association::identities::{Identities, Named};
use sinew::observe::association::{Config, Person, triangulated};
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::crowd::{Crowd, CrowdNoise, CrowdRecording};
use sinew_simulate::crowd_absence::Absences;
use sinew_simulate::ring::Ring;
use sinew_tests::evaluation::ray_association;
use sinew_tests::evaluation::returns::{Returns, returns};
use sinew_tests::evaluation::several_people::{self, Counts, Track};
use std::ops::Range;
use std::path::Path;
use std::time::Instant;

/// What to run.
#[derive(clap::Args)]
pub struct Args {
    /// Crowds of each size
    #[arg(long, default_value_t = 10)]
    seeds: u64,
    /// Seed of the first; crowds 1 to 60 were looked at before
    #[arg(long, default_value_t = 101)]
    first: u64,
    #[command(flatten)]
    options: ProgramOptions,
    /// Tables to make
    #[arg(long, value_enum, value_delimiter = ',', default_values_t = [Part::Crowds, Part::Real, Part::Speed])]
    only: Vec<Part>,
    /// Runs of the real recording, seeds from 1 on
    #[arg(long, default_value_t = 5)]
    real: u64,
}

/// A part of the study.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Part {
    /// Crowds, and crowds whose people leave and come back.
    Crowds,
    /// The two people of a real recording, against another program's tables.
    Real,
    /// Frames a second.
    Speed,
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
    let mut identities = Identities::new(cameras, paired_limbs(&recording.layout), recording.rate_hz, config);
    let stays: Vec<Named> = frames.iter().map(|people| identities.name(people)).collect();
    let people = identities.people();
    let person = |k: usize, named: &[Option<usize>]| {
        named.iter().position(|stay| stay.is_some_and(|stay| people[stay].person == k))
    };
    let track = |k: usize| -> Track {
        let at = |(named, people): (&Named, &Vec<Vec<Person>>)| {
            let members: Vec<Option<usize>> = named.iter().map(|view| person(k, view)).collect();
            let points = triangulated(cameras, people, &members, &config);
            (points.iter().flatten().count() >= config.least_keypoints).then_some(points)
        };
        stays.iter().zip(frames).map(at).collect()
    };
    (0..people.iter().map(|naming| naming.person + 1).max().unwrap_or(0)).map(track).collect()
}

/// Tracks that last a quarter of a second, of both methods.
fn lasting(tracks: Vec<Track>, rate_hz: f64) -> Vec<Track> {
    let least = (LEAST_S * rate_hz).ceil() as usize;
    tracks.into_iter().filter(|track| track.iter().flatten().count() >= least).collect()
}

/// True tracks in the order of the layout.
fn truth(recording: &CrowdRecording) -> Vec<Track> {
    let points = |person: &sinew_body::points::Trajectories, frame: &Vec<[f64; 3]>| {
        let place = |name: &Option<String>| name.as_deref().and_then(|name| person.index(name)).map(|k| frame[k]);
        recording.layout.points.iter().map(place).collect()
    };
    let track = |(person, away): (&sinew_body::points::Trajectories, &Range<usize>)| {
        let at = |(number, frame)| (!away.contains(&number)).then(|| points(person, frame));
        person.frames.iter().enumerate().map(at).collect()
    };
    recording.truth.iter().zip(&recording.away).map(track).collect()
}

/// What was counted of a crowd.
struct Counted {
    counts: Counts,
    returns: Returns,
}

/// Our own association and the usual recipe on a crowd.
fn counted(recording: &CrowdRecording) -> [Counted; 2] {
    let (frames, truth) = (frames(recording), truth(recording));
    let found = [own(recording, &frames), ray_association::tracks(&recording.cameras, &frames)];
    let limbs = limbs(&recording.layout);
    found.map(|tracks| {
        let tracks = lasting(tracks, recording.rate_hz);
        Counted { counts: several_people::counted(&truth, &tracks, &limbs), returns: returns(&truth, &tracks) }
    })
}

/// Seconds of a crowd.
const DURATION_S: f64 = 5.0;
/// Seconds of a crowd that comes and goes.
const RETURNING_S: f64 = 8.0;

/// Names of the two associations.
const NAMES: [&str; 2] = ["ours", "usual recipe"];

/// Mean over crowds with its standard error.
fn mean(all: &[[Counted; 2]], method: usize, value: &dyn Fn(&Counts) -> f64) -> String {
    let values: Vec<f64> = all.iter().map(|found| value(&found[method].counts)).collect();
    with_error(&values, 1)
}

fn share(part: usize, counts: &Counts) -> f64 {
    100.0 * part as f64 / counts.people as f64
}

/// Crowds in which everybody is there all the time.
fn quality(seeds: Range<u64>) -> Outcome<String> {
    let mut text = header(
        "| people | association | switches a minute | misses, % | false people, % | MOTA, % | IDF1, % | PCP, % |",
    );
    for people in SIZES {
        let one = |seed| Ok(counted(&CrowdRecording::new(&crowd(people, DURATION_S), seed)?));
        let all = seeds.clone().map(one).collect::<Outcome<Vec<_>>>()?;
        for (method, name) in NAMES.into_iter().enumerate() {
            row!(
                text,
                "{people} | {name} | {} | {} | {} | {} | {} | {}",
                mean(&all, method, &|c| c.switches as f64 * 60.0 / DURATION_S),
                mean(&all, method, &|c| share(c.misses, c)),
                mean(&all, method, &|c| share(c.false_people, c)),
                mean(&all, method, &|c| 100.0 * c.mota()),
                mean(&all, method, &|c| 100.0 * c.idf1()),
                mean(&all, method, &|c| 100.0 * c.pcp()),
            );
        }
    }
    Ok(text)
}

/// Crowds that come and go.
fn returning(seeds: Range<u64>) -> Outcome<String> {
    let mut text = header(
        "| people | association | known again | new name | another's name | missed | newcomers with another's name | switches a minute | MOTA, % | IDF1, % |",
    );
    for people in SIZES {
        let crowd = crowd(people, RETURNING_S);
        let one = |seed| Ok(counted(&CrowdRecording::with_absences(&crowd, Some(&Absences::USUAL), seed)?));
        let all = seeds.clone().map(one).collect::<Outcome<Vec<_>>>()?;
        for (method, name) in NAMES.into_iter().enumerate() {
            let sum =
                |value: fn(&Returns) -> usize| all.iter().map(|found| value(&found[method].returns)).sum::<usize>();
            row!(
                text,
                "{people} | {name} | {} | {} | {} | {} | {} of {} | {} | {} | {}",
                sum(|r| r.known),
                sum(|r| r.new),
                sum(|r| r.mistaken),
                sum(|r| r.missed),
                sum(|r| r.newcomers_mistaken),
                sum(|r| r.newcomers),
                mean(&all, method, &|c| c.switches as f64 * 60.0 / RETURNING_S),
                mean(&all, method, &|c| 100.0 * c.mota()),
                mean(&all, method, &|c| 100.0 * c.idf1()),
            );
        }
    }
    Ok(text)
}

fn speed(program: &Program) -> Outcome<String> {
    let mut text = header("| people | frames a second, one thread | two threads |");
    for people in TIMED {
        let recording = CrowdRecording::new(&crowd(people, DURATION_S), 1)?;
        let folder = program.folder.join(format!("crowd-{people}"));
        let calibration = calib_toml::write(&recording.cameras);
        write_recording(&folder, &calibration, "keypoints", recording.keypoint_files())?;
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
        row!(text, "{people} | {:.0} | {:.0}", timed(1)?, timed(2)?);
    }
    Ok(text)
}

/// Runs the command.
pub fn run(root: &Path, args: &Args) -> Outcome<()> {
    let folder = args.options.folder(root, "people")?;
    let mut texts = vec![];
    if args.only.contains(&Part::Crowds) {
        let seeds = args.first..args.first + args.seeds;
        texts.extend([quality(seeds.clone())?, returning(seeds)?]);
    }
    if args.only != [Part::Crowds] {
        let program = args.options.program(root, "people")?;
        let data = args.options.data(root).join("pose2sim_two_people");
        if args.only.contains(&Part::Real) {
            texts.push(recorded::table(&program, &data, args.real)?);
        }
        if args.only.contains(&Part::Speed) {
            texts.push(speed(&program)?);
        }
    }
    let text = texts.join("\n");
    println!("{text}");
    Ok(std::fs::write(folder.join("tables.md"), text)?)
}
