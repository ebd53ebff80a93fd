//! Recorded motion in virtual cameras: error and coverage of each joint, tallied over seeds.

use crate::support::outcome::Outcome;
use crate::support::statistics::mean;
use crate::support::table::{header, row, with_spread};
use sinew::body::standard::EVALUATION_JOINTS;
use sinew::config::settings::Settings;
use sinew::input::in_memory::InMemory;
use sinew_body::points::Trajectories;
use sinew_motion::retarget::{Retargeted, retarget};
use sinew_results::estimate::FrameEstimate;
use sinew_simulate::detector::DetectorNoise;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::evaluation::{self, Run, Track};
use sinew_tests::recorded_motion::recorded;
use sinew_tests::simulated_source::source;
use std::path::Path;

pub(super) const CMU_RATE_HZ: f64 = 30.0;
/// Error of the virtual cameras' keypoints.
const SIGMA_PX: f64 = 3.0;
/// Length of a bootstrap block, frames.
const BLOCK: usize = 15;

/// Results of one kind of experiment with virtual cameras.
#[derive(Default)]
pub(super) struct Tally {
    /// For each run and frame, the share of coordinates covered for each joint.
    pub(super) covered: Vec<Vec<Vec<f64>>>,
    pub(super) millimetres: Vec<f64>,
    pub(super) model_error_mm: Vec<f64>,
    pub(super) sigma_px: Vec<f64>,
}

/// A recorded motion, and our body on it.
pub(super) struct Motion {
    pub(super) name: &'static str,
    pub(super) recorded: Trajectories,
    pub(super) fitted: Retargeted,
}

pub(super) fn motions(data: &Path) -> Outcome<Vec<Motion>> {
    let data = data.join("cmu_amc");
    ["07_01", "09_06", "131_04"]
        .into_iter()
        .map(|name| {
            let subject = name.split('_').next().unwrap_or(name);
            let [motion, skeleton] = [format!("{name}.amc"), format!("{subject}.asf")].map(|file| data.join(file));
            let recorded = recorded(&motion, &skeleton, CMU_RATE_HZ)?;
            let fitted = retarget(&recorded).ok_or("no pose in the first frame")?;
            Ok(Motion { name, recorded, fitted })
        })
        .collect()
}

/// A motion in four virtual cameras with keypoints of `truth`, and its frames.
pub(super) fn film(motion: &Motion, truth: &Trajectories, seed: u64) -> Outcome<(InMemory, std::ops::Range<u64>)> {
    let noise = DetectorNoise::stated_gaussian(SIGMA_PX);
    let script = Script { noise, rate_hz: CMU_RATE_HZ, ..Script::default() };
    let (body, states) = (motion.fitted.body.clone(), motion.fitted.states.clone());
    let film = SyntheticRecording::from_motion(body, states, truth.clone(), &script, seed)?;
    Ok((source(&film), 0..truth.frames.len() as u64))
}

impl Tally {
    pub(super) fn add(&mut self, run: &Run, estimates: &[FrameEstimate], truth: &Trajectories) {
        let target = truth.select(&EVALUATION_JOINTS);
        let target: Track = target.frames.into_iter().map(|frame| frame.into_iter().map(Some).collect()).collect();
        let track = evaluation::positions(&run.tree, estimates, &EVALUATION_JOINTS);
        self.millimetres.push(1e3 * evaluation::mean_distance(&track, &target, 0..target.len()));
        self.covered.push(evaluation::covered(&run.tree, estimates, truth, &EVALUATION_JOINTS));
        self.model_error_mm.push(1e3 * run.setup.model_error_m);
        self.sigma_px.push(mean(run.setup.camera.iter().map(|c| c.sigma_px).collect::<Vec<_>>()));
    }
}

/// Prints the tables of all motions.
pub(super) fn recorded_motion(motions: &[Motion], seeds: u64) -> Outcome<()> {
    println!("\nFour virtual cameras, Gaussian noise of {SIGMA_PX} px, {seeds} seeds, 30 frames/s.\n");
    print!(
        "{}",
        header(
            "| motion | keypoints from | proportions | method | error, mm | coverage, % | model error, mm | sigma, px |"
        )
    );
    let mut pooled: Vec<(String, Vec<Vec<Vec<f64>>>)> = vec![];
    for motion in motions {
        let Motion { name, recorded, fitted } = motion;
        let kinds = [
            ("fitted body", "set-up", &fitted.points, None),
            ("fitted body", "known", &fitted.points, Some(&fitted.proportions)),
            ("recorded joints", "set-up", recorded, None),
        ];
        for (from, sizes, truth, known) in kinds {
            let mut tallies = [Tally::default(), Tally::default()];
            for seed in 1..=seeds {
                let (mut film, frames) = film(motion, truth, seed)?;
                let settings = Settings { seed, fps: CMU_RATE_HZ, ..Settings::default() };
                let run = evaluation::run(&mut film, frames.clone(), frames, &settings, known)?;
                for (tally, estimates) in tallies.iter_mut().zip([&run.filtered, &run.smoothed]) {
                    tally.add(&run, estimates, truth);
                }
            }
            for (method, tally) in ["hmc", "hmc --smooth"].into_iter().zip(tallies) {
                let (error, model, sigma) =
                    (mean(&tally.millimetres), mean(&tally.model_error_mm), mean(&tally.sigma_px));
                let share = coverage(&tally.covered, 0..EVALUATION_JOINTS.len());
                println!("| {name} | {from} | {sizes} | {method} | {error:.1} | {share} | {model:.1} | {sigma:.2} |");
                let kind = format!("{from}, {sizes}, {method}");
                match pooled.iter_mut().find(|(known, _)| *known == kind) {
                    Some((_, all)) => all.extend(tally.covered),
                    None => pooled.push((kind, tally.covered)),
                }
            }
        }
    }
    println!("\nAll motions; coverage in % ± standard error of a bootstrap of blocks of {BLOCK} frames:\n");
    let joints = EVALUATION_JOINTS.len();
    let mut table = header(&format!("| keypoints, proportions, method | pooled | {} |", EVALUATION_JOINTS.join(" | ")));
    for (kind, all) in &pooled {
        let each = (0..joints).map(|j| coverage(all, j..j + 1)).collect::<Vec<_>>().join(" | ");
        row!(table, "{kind} | {} | {each}", coverage(all, 0..joints));
    }
    print!("{table}");
    Ok(())
}

/// Coverage of some joints in per cent with its standard error.
fn coverage(runs: &[Vec<Vec<f64>>], joints: std::ops::Range<usize>) -> String {
    with_spread(share(runs, joints), 1)
}

/// Coverage of some joints in per cent and its standard error.
pub(super) fn share(runs: &[Vec<Vec<f64>>], joints: std::ops::Range<usize>) -> [f64; 2] {
    let frame = |frame: &Vec<f64>| mean(&frame[joints.clone()]);
    let series: Vec<Vec<f64>> = runs.iter().map(|run| run.iter().map(frame).collect()).collect();
    let count = series.iter().map(Vec::len).sum::<usize>() as f64;
    [series.iter().flatten().sum::<f64>() / count, evaluation::block_bootstrap(&series, BLOCK, 500, 1)]
        .map(|x| 100.0 * x)
}
