//! `cargo xtask study accuracy`: the experiments of docs/evidence/accuracy.md, printed as its tables.
//!
//! Data are sought in `SINEW_DATA`, else in `shared/data` beside the workspace.

mod effort;
mod virtual_cameras;

use crate::support::outcome::Outcome;
use crate::support::statistics::{median, quantile};
use crate::support::table::{header, row};
use sinew::config::settings::Settings;
use sinew::formats::trc;
use sinew::input::recording::{Recording, RecordingOptions};
use sinew::methods::{bootstrap, hmc};
use sinew::observe::Noise;
use sinew::observe::association::Person;
use sinew_body::points::Trajectories;
use sinew_tests::evaluation::{self, LIMB_JOINTS, LeftOut, PixelErrors, Run, Track};
use std::path::{Path, PathBuf};
use virtual_cameras::{motions, recorded_motion};

/// Frames for set-up and all choices, and frames that judge.
const CHOSEN: std::ops::Range<usize> = 0..60;
const JUDGED: std::ops::Range<usize> = 60..100;
const RATE_HZ: f64 = 60.0;
const CUTOFF_HZ: f64 = 6.0;

/// An experiment.
#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Part {
    /// The real recording against its reference.
    Reference,
    /// The real recording against cameras that were left out.
    LeaveOut,
    /// The density of a keypoint, chosen on the first frames.
    Noise,
    /// Recorded motion in virtual cameras.
    Cmu,
    /// The same by chains and updates, and by the prior between frames: what the defaults of `hmc` rest on.
    Effort,
}

/// What to run.
#[derive(clap::Args)]
pub struct Args {
    /// Only these experiments; `effort` runs only where it is named.
    #[arg(long, value_delimiter = ',')]
    only: Vec<Part>,
    /// Seeds of the experiments with virtual cameras.
    #[arg(long, default_value_t = 10)]
    seeds: u64,
}

/// Runs the experiments.
pub fn run(root: &Path, args: &Args) -> Outcome<()> {
    let data = std::env::var_os("SINEW_DATA").map_or_else(|| root.join("../shared/data"), PathBuf::from);
    if !data.is_dir() {
        println!("skipped: no data");
        return Ok(());
    }
    let wanted = |part| args.only.is_empty() || args.only.contains(&part);
    if wanted(Part::Reference) {
        reference(&data)?;
    }
    if wanted(Part::LeaveOut) {
        leave_out(&data)?;
    }
    if wanted(Part::Noise) {
        noise(&data)?;
    }
    if wanted(Part::Cmu) {
        recorded_motion(&motions(&data)?, args.seeds)?;
    }
    if args.only.contains(&Part::Effort) {
        effort::run(&motions(&data)?, args.seeds, &root.join("docs/evidence/images/effort.svg"))?;
    }
    Ok(())
}

fn open(data: &Path, folder: &str, cameras: Option<Vec<String>>) -> Outcome<Recording> {
    let data = data.join("pose2sim_single");
    let options = RecordingOptions { layout: Some("BODY_25B".into()), cameras, ..RecordingOptions::default() };
    Ok(Recording::open(&data.join("Calib.toml"), &data.join("T01_BalancingTrial").join(folder), &options)?)
}

fn settings() -> Settings {
    Settings { fps: RATE_HZ, ..Settings::default() }
}

fn track(recording: &mut Recording, settings: &Settings) -> Outcome<Run> {
    Ok(evaluation::run(recording, 0..CHOSEN.end as u64, 0..JUDGED.end as u64, settings, None)?)
}

/// The filtered reference of the real recording.
pub(crate) fn butterworth(data: &Path) -> Outcome<Track> {
    let name = "S00_P00_T01_BalancingTrial_0-100_filt_butterworth.trc";
    let path = data.join("pose2sim_single/T01_BalancingTrial/pose-3d").join(name);
    let file = trc::read(name, &std::fs::read_to_string(path)?)?;
    let frame = |f| LIMB_JOINTS.iter().map(|joint| file.point_in_world(f, file.marker_index(joint)?)).collect();
    Ok((0..file.frames.len()).map(frame).collect())
}

fn reference(data: &Path) -> Outcome<()> {
    let reference = butterworth(data)?;
    let columns =
        "| folder | method | frames 0–59, mm | frames 60–99, mm | mean spread, mm | split R-hat, median / 95 % |";
    print!("\n{}", header(columns));
    for folder in ["pose", "pose-associated"] {
        for about in [&hmc::ABOUT, &bootstrap::ABOUT] {
            let mut recording = open(data, folder, None)?;
            let run = track(&mut recording, &Settings { method: about.usual(), ..settings() })?;
            let r_hat = mixing(&run);
            for (name, estimates) in [("", &run.filtered), (" --smooth", &run.smoothed)] {
                let track = evaluation::positions(&run.tree, estimates, &LIMB_JOINTS);
                let mm = |frames| 1e3 * evaluation::mean_distance(&track, &reference, frames);
                let sd = 1e3 * evaluation::mean_spread(&run.tree, &estimates[JUDGED], &LIMB_JOINTS);
                let (early, late) = (mm(CHOSEN), mm(JUDGED));
                println!("| {folder} | {}{name} | {early:.1} | {late:.1} | {sd:.1} | {r_hat} |", about.name);
            }
        }
    }
    Ok(())
}

fn mixing(run: &Run) -> String {
    let all: Vec<f64> = run.filtered.iter().filter_map(|e| e.r_hat).collect();
    quantile(&all, 0.95).map_or("–".into(), |high| format!("{:.3} / {high:.3}", median(&all)))
}

/// What the person shows in each frame and camera.
fn sightings(data: &Path) -> Outcome<Vec<Vec<Person>>> {
    let mut recording = open(data, "pose-associated", None)?;
    let first = |people: Vec<Vec<Person>>| people.into_iter().map(|p| p.into_iter().next().unwrap_or_default());
    (0..JUDGED.end as u64).map(|f| Ok(first(recording.people(f)?).collect())).collect()
}

const CONTENDERS: [&str; 5] = ["raw recipe", "causal Butterworth", "zero-phase Butterworth", "hmc", "hmc --smooth"];

/// Every choice of `size` of the cameras.
fn subsets(cameras: usize, size: u32) -> Vec<Vec<usize>> {
    let chosen = (0_u32..1 << cameras).filter(|bits| bits.count_ones() == size);
    chosen.map(|bits| (0..cameras).filter(|c| bits >> c & 1 == 1).collect()).collect()
}

fn leave_out(data: &Path) -> Outcome<()> {
    let seen = sightings(data)?;
    let reference = butterworth(data)?;
    let whole = open(data, "pose-associated", None)?;
    let (cameras, layout) = (whole.cameras().to_vec(), whole.layout().clone());
    let points = |frame: &Vec<Option<[f64; 3]>>| frame.iter().map(|p| p.unwrap_or([f64::NAN; 3])).collect();
    let known =
        Trajectories { names: LIMB_JOINTS.map(Into::into).into(), frames: reference.iter().map(points).collect() };
    let mut growth = vec![];
    for size in [4, 3, 2, 1] {
        let subsets = subsets(cameras.len(), size);
        let mut pixels: Vec<Vec<(usize, PixelErrors)>> = vec![vec![]; CONTENDERS.len()];
        let mut errors = [vec![], vec![]];
        for used in &subsets {
            let names = used.iter().map(|&c| cameras[c].name.clone()).collect();
            let run = track(&mut open(data, "pose-associated", Some(names))?, &settings())?;
            let chosen: Vec<_> = used.iter().map(|&c| cameras[c].clone()).collect();
            let views: Vec<Vec<Person>> =
                seen.iter().map(|frame| used.iter().map(|&c| frame[c].clone()).collect()).collect();
            let points = evaluation::triangulated(&chosen, &layout, &views, &LIMB_JOINTS);
            let tracks = [
                evaluation::filled(&points),
                evaluation::causal(&points, RATE_HZ, CUTOFF_HZ),
                evaluation::zero_phase(&points, RATE_HZ, CUTOFF_HZ),
                evaluation::positions(&run.tree, &run.filtered, &LIMB_JOINTS),
                evaluation::positions(&run.tree, &run.smoothed, &LIMB_JOINTS),
            ];
            for (i, estimates) in [&run.filtered, &run.smoothed].into_iter().enumerate() {
                let error = 1e3 * evaluation::mean_distance(&tracks[3 + i], &reference, JUDGED);
                let spread = 1e3 * evaluation::mean_spread(&run.tree, &estimates[JUDGED], &LIMB_JOINTS);
                let inside = evaluation::covered(&run.tree, &estimates[JUDGED], &known, &LIMB_JOINTS);
                let share = inside.iter().flatten().sum::<f64>() / (inside.len() * LIMB_JOINTS.len()) as f64;
                errors[i].push([error, spread, 100.0 * share]);
            }
            for other in (0..cameras.len()).filter(|c| !used.contains(c)) {
                let keypoints = seen.iter().map(|frame| &frame[other]).collect();
                let left_out = LeftOut { camera: &cameras[other], keypoints, least_confidence: 0.3 };
                for (track, out) in tracks.iter().zip(&mut pixels) {
                    let found = evaluation::pixel_errors(&left_out, &layout, track, &LIMB_JOINTS, CHOSEN, JUDGED);
                    out.push((other, found));
                }
            }
        }
        if size == 3 || size == 2 {
            print_pixels(size, cameras.len(), &pixels);
        }
        let mean = |all: &[[f64; 3]], i: usize| all.iter().map(|x| x[i]).sum::<f64>() / all.len() as f64;
        growth.push((size, [0, 1].map(|m: usize| [0, 1, 2].map(|i| mean(&errors[m], i)))));
    }
    let columns = "| cameras | method | error, mm | mean spread, mm | reference inside the 90 % intervals, % |";
    print!("\n{}", header(columns));
    for (size, methods) in growth {
        for (name, [error, spread, share]) in ["hmc", "hmc --smooth"].into_iter().zip(methods) {
            println!("| {size} | {name} | {error:.1} | {spread:.1} | {share:.0} |");
        }
    }
    Ok(())
}

fn print_pixels(size: u32, cameras: usize, pixels: &[Vec<(usize, PixelErrors)>]) {
    println!("\nTracked with {size} cameras; median / 90th percentile, px, in each camera that was left out:\n");
    let each = (0..cameras).map(|c| format!("cam {}", c + 1)).collect::<Vec<_>>().join(" | ");
    let mut table = header(&format!("| contender | {each} | mean |"));
    for (name, found) in CONTENDERS.iter().zip(pixels) {
        let mean = |of: &[&PixelErrors]| {
            let n = of.len() as f64;
            let [median, p90] = [|e: &PixelErrors| e.median, |e: &PixelErrors| e.p90]
                .map(|value| of.iter().map(|e| value(e)).sum::<f64>() / n);
            format!("{median:.1} / {p90:.1}")
        };
        let own = |camera| mean(&found.iter().filter(|(c, _)| *c == camera).map(|(_, e)| e).collect::<Vec<_>>());
        let (each, all) = ((0..cameras).map(own).collect::<Vec<_>>(), found.iter().map(|(_, e)| e).collect::<Vec<_>>());
        row!(table, "{name} | {} | {}", each.join(" | "), mean(&all));
    }
    print!("{table}");
}

fn noise(data: &Path) -> Outcome<()> {
    let seen = sightings(data)?;
    let whole = open(data, "pose-associated", None)?;
    let (cameras, layout) = (whole.cameras().to_vec(), whole.layout().clone());
    println!("\nLeave one camera out, frames 0–59 only; median / 90th percentile, px, mean over cameras:\n");
    print!("{}", header("| density | hmc | hmc --smooth | split R-hat, median / 95 %, each run |"));
    let choices = [
        ("outlier floor 0.02", Noise::OutlierFloor { outlier: 0.02 }),
        ("Student-t, 4 degrees", Noise::StudentT { degrees: 4.0 }),
    ];
    for (name, noise) in choices {
        let mut sums = [[0.0; 2]; 2];
        let mut mixed = vec![];
        for (left, camera) in cameras.iter().enumerate() {
            let names = cameras.iter().filter(|c| c.name != camera.name).map(|c| c.name.clone()).collect();
            let settings = Settings { noise, ..settings() };
            let chosen = 0..CHOSEN.end as u64;
            let mut recording = open(data, "pose-associated", Some(names))?;
            let run = evaluation::run(&mut recording, chosen.clone(), chosen, &settings, None)?;
            let keypoints = seen.iter().map(|frame| &frame[left]).collect();
            let left_out = LeftOut { camera, keypoints, least_confidence: 0.3 };
            for (sum, estimates) in sums.iter_mut().zip([&run.filtered, &run.smoothed]) {
                let track = evaluation::positions(&run.tree, estimates, &LIMB_JOINTS);
                let e = evaluation::pixel_errors(&left_out, &layout, &track, &LIMB_JOINTS, CHOSEN, CHOSEN);
                sum[0] += e.median / cameras.len() as f64;
                sum[1] += e.p90 / cameras.len() as f64;
            }
            mixed.push(mixing(&run));
        }
        let [[a, b], [c, d]] = sums;
        println!("| {name} | {a:.1} / {b:.1} | {c:.1} / {d:.1} | {} |", mixed.join("; "));
    }
    Ok(())
}
