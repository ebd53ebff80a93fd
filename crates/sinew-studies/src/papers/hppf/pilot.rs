//! The pilot on training motion: is the person kept at all, and if not, which stage loses them.
//!
//! P = 1000, four cameras, clean masks, three seeds, a walk, a run, and both with half of balancing joined as in CMB, none of which the model has seen. For each variant: errors, limb ratio, and what the true pose, the mean pose and the estimate are worth to the parts' likelihood and to the global
//! alignment, averaged over the frames.

use super::contender::Method;
use super::models::Training;
use super::motions::{PILOT, RATE_HZ, pilot_training};
use super::track::level_walk;
use crate::papers::masked_scene::{Scene, Seen, View};
use crate::papers::recorded_trials::joined;
use crate::papers::worth::{Errors, errors, kept, mean_poses};
use crate::support::outcome::Outcome;
use crate::support::statistics::mean;
use crate::support::table::{header, row, with_spread};
use sinew::core::density::PartLogDensity as _;
use sinew::core::lanes::{Block, Isa};
use sinew::core::random::Stage;
use sinew::dynamics::level_walk::LevelPrimitives;
use sinew::dynamics::primitives::model::PrimitiveModel;
use sinew::observe::silhouettes::image_likelihood::ImageLikelihood;
use sinew::tracking::Tracker as _;
use sinew::tracking::hppf::{self, Hppf};
use sinew_motion::follow::NamedBody;
use sinew_simulate::segmentation_noise::Level;
use sinew_tests::combo::{JOIN_S, Phase};
use sinew_tests::finding::mean_and_error;
use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

const SEEDS: u64 = 3;
const VIEW: View = View { level: Level::Clean, ..View::USUAL };
/// Action primitives of the pilot: the paper's usual D and C.
const LENGTH: usize = 3;
const CLUSTERS: usize = 80;

/// What is tried.
struct Variant {
    name: &'static str,
    particles: usize,
    /// Action primitives, or a random walk alone.
    primitives: Option<LevelPrimitives>,
    /// Factor on the model's steps.
    steps: f64,
}

const VARIANTS: [Variant; 6] = [
    Variant { name: "nested primitives", particles: 1000, primitives: Some(LevelPrimitives::Nested), steps: 1.0 },
    Variant { name: "own-parts primitives", particles: 1000, primitives: Some(LevelPrimitives::OwnParts), steps: 1.0 },
    Variant { name: "random walk", particles: 1000, primitives: None, steps: 1.0 },
    Variant { name: "nested, half steps", particles: 1000, primitives: Some(LevelPrimitives::Nested), steps: 0.5 },
    Variant { name: "nested, P = 200", particles: 200, primitives: Some(LevelPrimitives::Nested), steps: 1.0 },
    Variant { name: "random walk, half steps", particles: 1000, primitives: None, steps: 0.5 },
];

/// Sum of the parts' log likelihoods of a state, and that of its alignment.
fn stages(observed: &ImageLikelihood, state: &[f64]) -> [f64; 2] {
    let block: Vec<Block> = state.iter().map(|&x| Block::splat(x)).collect();
    let count = observed.parts();
    let (mut parts, all) = (vec![Block::ZERO; count], (0..count).collect::<Vec<_>>());
    observed.log_density_parts_block(&all, &block, &mut parts, &mut []);
    [parts.iter().map(|part| part.0[0]).sum(), observed.global_block(&block, &mut []).log_likelihood.0[0]]
}

/// One run: its estimates, and sums over frames of what true pose, mean pose and estimate are worth.
struct Run {
    errors: Errors,
    worth: [[f64; 2]; 3],
    similar: f64,
    astray: f64,
}

fn run(
    variant: &Variant,
    model: &PrimitiveModel,
    scene: &Scene,
    seen: &Seen,
    means: &[Vec<f64>],
    seed: u64,
) -> Outcome<Run> {
    let particles = variant.particles;
    let method = match variant.primitives {
        Some(which) => Method::Primitives { particles, length: LENGTH, clusters: CLUSTERS, which },
        None => Method::Walk(particles),
    };
    let walk = level_walk(seen, model, method, variant.steps, &[])?;
    let config = hppf::Config { particles, ..hppf::Config::default() };
    let mut tracker = Hppf::new(config, walk, &seen.parts, scene.truth[0].clone())?;
    let (mut estimates, mut worth, mut similar, mut astray) = (vec![], [[0.0; 2]; 3], 0.0, 0.0);
    let frames = scene.truth.len();
    for (frame, (truth, mean_pose)) in scene.truth.iter().zip(means).enumerate() {
        let observed = seen.bind(frame);
        let info = tracker.step(&observed, Stage::new(seed, "hppf pilot").at_frame(frame as u32))?;
        for (sum, state) in worth.iter_mut().zip([truth, mean_pose, &info.mean]) {
            let found = stages(&observed, state);
            sum.iter_mut().zip(found).for_each(|(sum, x)| *sum += x / frames as f64);
        }
        if let Some(found) = tracker.found() {
            similar += found.similar.len() as f64 / frames as f64;
            astray += found.astray as f64 / (variant.particles * frames) as f64;
        }
        estimates.push(info.mean);
    }
    Ok(Run { errors: errors(scene, &estimates, 0), worth, similar, astray })
}

/// Root mean squares of the changes of a motion from frame to frame, position and largest angle, beside the model's steps.
fn speeds(scene: &Scene, model: &PrimitiveModel, frames: &Range<usize>) -> String {
    let rms = |j: usize| {
        let squares: Vec<f64> =
            scene.truth[frames.clone()].windows(2).map(|pair| (pair[1][j] - pair[0][j]).powi(2)).collect();
        mean(&squares).sqrt()
    };
    let names = scene.tree.dof_names();
    let each = (0..names.len()).map(|j| format!("{} {:.3} ({:.3})", names[j], rms(j), model.noise_sd[j]));
    each.collect::<Vec<_>>().join(", ")
}

/// Mean over seeds with its standard error; a single one has none.
fn shown(values: impl Iterator<Item = f64>, decimals: usize) -> String {
    let all: Vec<f64> = values.collect();
    match mean_and_error(&all) {
        [value, _] if all.len() == 1 => format!("{value:.decimals$}"),
        both => with_spread(both, decimals),
    }
}

/// Errors of some seeds: absolute, relative, limb ratio, share of near frames, and how many keep the person.
fn row(runs: &[Errors], mean_pose: &Errors) -> String {
    let found: Vec<(f64, f64, bool)> = runs.iter().map(|errors| kept(errors, mean_pose)).collect();
    let all = found.iter().filter(|(.., is_kept)| *is_kept).count();
    let cells = [
        shown(runs.iter().map(|errors| mean(&errors.absolute)), 0),
        shown(runs.iter().map(|errors| mean(&errors.relative)), 0),
        shown(found.iter().map(|(_, ratio, _)| *ratio), 2),
        shown(found.iter().map(|(near, ..)| 100.0 * near), 0),
        format!("{all} of {}", runs.len()),
    ];
    cells.join(" | ")
}

/// What is tracked, and the phases of what was joined.
fn scenes(data: &Path) -> Outcome<Vec<(Scene, Vec<Phase>)>> {
    let single = PILOT
        .iter()
        .take(2)
        .map(|trial| Ok((Scene::new(trial.name, NamedBody::Hppf24, trial.joints(data, RATE_HZ)?, RATE_HZ)?, vec![])));
    let whole = joined(&PILOT, data, RATE_HZ)?;
    let phases = whole.phases.iter().enumerate().flat_map(|(k, phase)| with_join(phase, k > 0)).collect();
    single
        .chain([Scene::new(&whole.name, NamedBody::Hppf24, whole.motion, RATE_HZ).map(|scene| (scene, phases))])
        .collect()
}

/// A phase, and by itself the join that leads to it.
fn with_join(phase: &Phase, has_join: bool) -> Vec<Phase> {
    let Range { start, end } = phase.frames;
    let middle = if has_join { start + (JOIN_S * RATE_HZ) as usize - 1 } else { start };
    let join = Phase { name: format!("joining to {}", phase.name), frames: start..middle };
    let rest = Phase { name: phase.name.clone(), frames: middle..end };
    if has_join { vec![join, rest] } else { vec![rest] }
}

/// Errors of some seeds in a phase, as a row.
fn in_phase(variant: &str, phase: &Phase, runs: &[Errors]) -> String {
    let of = |errors: &[f64]| mean(&errors[phase.frames.clone()]);
    let absolute = shown(runs.iter().map(|errors| of(&errors.absolute)), 0);
    let relative = shown(runs.iter().map(|errors| of(&errors.relative)), 0);
    format!("| {variant} | {} | {absolute} | {relative} |\n", phase.name)
}

/// Runs the pilot; its report.
pub(super) fn pilot(data: &Path, folder: &Path) -> Outcome<String> {
    let training = Training::new(data, &pilot_training())?;
    let model = training.model(folder, LENGTH, CLUSTERS)?;
    let fits = training.errors_m.iter().map(|(name, error)| format!("{name} {:.0}", 1e3 * error));
    let mut text = format!("fit of the body to training, mm: {}\n\n", fits.collect::<Vec<_>>().join(", "));
    for (scene, phases) in scenes(data)? {
        let means = mean_poses(&scene, &training.mean_pose);
        let mean_pose = errors(&scene, &means, 0);
        let frozen = errors(&scene, &vec![scene.truth[0].clone(); scene.truth.len()], 0);
        let frames = scene.truth.len();
        let _ = writeln!(text, "## {}, {frames} frames, fit {:.1} mm\n", scene.name, 1e3 * scene.fit_error_m);
        let whole = [Phase { name: "whole".into(), frames: 0..frames }];
        for phase in whole.iter().chain(&phases) {
            let line = speeds(&scene, &model, &phase.frames);
            let _ = writeln!(text, "{}: root mean square of changes (step of the model): {line}\n", phase.name);
        }
        text += &header(
            "| | absolute, mm | relative, mm | limb ratio | frames below 150 mm, % | kept | true pose: parts, alignment | mean pose | estimate | similar | astray, % |",
        );
        for (name, found) in [("mean pose", &mean_pose), ("first pose", &frozen)] {
            row!(text, "{name} | {} | | | | |", row(std::slice::from_ref(found), &mean_pose));
        }
        let mut by_phase = String::new();
        if !phases.is_empty() {
            by_phase += &header("| | phase | absolute, mm | relative, mm |");
            let mean_pose = std::slice::from_ref(&mean_pose);
            by_phase += &phases.iter().map(|phase| in_phase("mean pose", phase, mean_pose)).collect::<String>();
        }
        let seen = (1..=SEEDS).map(|seed| Seen::new(&scene, &VIEW, 0, seed, Isa::best()));
        let seen = seen.collect::<Outcome<Vec<_>>>()?;
        for seen in &seen {
            println!("{}: {:?}", scene.name, seen.girth);
        }
        for variant in &VARIANTS {
            let runs = seen.iter().zip(1..).map(|(seen, seed)| run(variant, &model, &scene, seen, &means, seed));
            let runs = runs.collect::<Outcome<Vec<Run>>>()?;
            let of = |k: usize, stage: usize| shown(runs.iter().map(|run| run.worth[k][stage]), 1);
            let worth: Vec<String> = (0..3).map(|k| format!("{}, {}", of(k, 0), of(k, 1))).collect();
            let (similar, astray) = (runs.iter().map(|run| run.similar), runs.iter().map(|run| 100.0 * run.astray));
            let [similar, astray] = [shown(similar, 0), shown(astray, 1)];
            let errors: Vec<Errors> = runs.into_iter().map(|run| run.errors).collect();
            let line = format!(
                "| {} | {} | {} | {similar} | {astray} |",
                variant.name,
                row(&errors, &mean_pose),
                worth.join(" | ")
            );
            println!("{line}");
            let _ = writeln!(text, "{line}");
            by_phase += &phases.iter().map(|phase| in_phase(variant.name, phase, &errors)).collect::<String>();
        }
        println!("{by_phase}");
        let _ = writeln!(text, "\n{by_phase}");
    }
    Ok(text)
}
