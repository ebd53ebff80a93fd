//! The pilot on training motion that no model learned from: is the person kept at all.
//!
//! A walk in a circle, 15 frames a second, four cameras, clean masks, 1000 particles a layer or node. For each way to compare images and each tracker: errors, and the mean log weights of the true pose, of the mean pose at the true place and of the estimate.

use super::contender::{Lesson, Method, Motion, VIEW};
use super::lessons::Taught;
use super::study::scene;
use super::tables;
use super::trackers::{Spaces, TUNING, Tuning};
use crate::papers::masked_scene::{Scene, Seen, View};
use crate::papers::worth::{Errors, errors, kept, mean_poses};
use crate::support::outcome::Outcome;
use crate::support::processor_time::thread_seconds;
use crate::support::statistics::mean;
use crate::support::store::{Store, Task, run_all};
use crate::support::table::{header, row};
use serde_json::{Value, json};
use sinew::core::density::LogDensity as _;
use sinew::core::lanes::Isa;
use sinew::core::random::Stage;
use sinew::latent::space::INVERSE_STEPS;
use sinew::observe::silhouettes::image_score::ImageScore;
use sinew_simulate::segmentation_noise::Level;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::path::Path;

const SEEDS: u64 = 3;
/// Coordinate of the heading.
const HEADING: usize = 3;

/// Ways to compare images and to move latents, with the trackers that are tried: with 1000 particles, and as the paper has them. The factor of the likelihood matters to CONDENSATION alone.
const TRIED: [(&str, ImageScore, Tuning, &[Method]); 8] = [
    (
        "both directions",
        VIEW.score,
        TUNING,
        &[
            Method::Bootstrap(1000),
            Method::Annealed(1000),
            Method::Gpapf(1000),
            Method::HApf(1000),
            Method::Bootstrap(500),
            Method::Annealed(100),
            Method::Gpapf(100),
            Method::HApf(100),
            Method::Annealed(360),
            Method::Gpapf(360),
        ],
    ),
    (
        "both directions, factor 100",
        ImageScore::DeutscherReid { kappa: 100.0, bidirectional: Some(0.5) },
        TUNING,
        &[Method::Bootstrap(1000), Method::Bootstrap(500)],
    ),
    ("latent noise 1/2", VIEW.score, noise(0.5), &PRINTED_LATENT),
    ("latent noise 1/4", VIEW.score, noise(0.25), &PRINTED_LATENT),
    ("latent noise 1/8", VIEW.score, noise(0.125), &PRINTED_LATENT),
    ("three steps of inverse maps", VIEW.score, Tuning { steps: INVERSE_STEPS, ..TUNING }, &[Method::HApf(100)]),
    ("silhouette one way", ImageScore::DeutscherReid { kappa: 10.0, bidirectional: None }, TUNING, &LATENT),
    ("parts", ImageScore::Parts, TUNING, &LATENT),
];
const LATENT: [Method; 3] = [Method::Annealed(1000), Method::Gpapf(1000), Method::HApf(100)];
const PRINTED_LATENT: [Method; 3] = [Method::Gpapf(100), Method::HApf(100), Method::Gpapf(1000)];

/// Less noise of latents.
const fn noise(noise: f64) -> Tuning {
    Tuning { noise, ..TUNING }
}

/// Errors of some runs as a row.
fn row(runs: &[Errors], mean_pose: &Errors) -> String {
    let found: Vec<(f64, f64, bool)> = runs.iter().map(|errors| kept(errors, mean_pose)).collect();
    let over = |of: &dyn Fn(usize) -> f64| mean((0..runs.len()).map(of).collect::<Vec<_>>());
    let (absolute, relative) = (over(&|k| mean(&runs[k].absolute)), over(&|k| mean(&runs[k].relative)));
    let (ratio, near) = (over(&|k| found[k].1), over(&|k| 100.0 * found[k].0));
    let kept = found.iter().filter(|(.., is_kept)| *is_kept).count();
    format!("{absolute:.0} | {relative:.0} | {ratio:.2} | {near:.0} | {kept} of {}", runs.len())
}

/// What a run found.
struct Run {
    errors: Errors,
    /// Mean log weights of true pose, mean pose and estimate.
    worth: [f64; 3],
    /// Mean distance of the heading to the true one, degrees.
    turned_deg: f64,
}

/// One run of a tracker.
fn run(method: Method, (scene, seen): (&Scene, &Seen), spaces: &Spaces, means: &[Vec<f64>], seed: u64) -> Outcome<Run> {
    let mut tracker = spaces.tracker(method, &scene.truth[0])?.ok_or("no tracker")?;
    let (mut estimates, mut worth, mut turned_deg) = (vec![], [0.0; 3], 0.0);
    let share = ((scene.truth.len() - 1) as f64).recip();
    for (frame, (truth, mean)) in scene.truth.iter().zip(means).enumerate().skip(1) {
        let observed = seen.bind(frame);
        let info = tracker.step(&observed, Stage::new(seed, "h-apf pilot").at_frame(frame as u32))?;
        for (sum, state) in worth.iter_mut().zip([truth, mean, &info.mean]) {
            *sum += share * observed.log_density(state);
        }
        let turned = info.mean[HEADING] - truth[HEADING];
        turned_deg += share * (turned - TAU * (turned / TAU).round()).abs().to_degrees();
        estimates.push(info.mean);
    }
    Ok(Run { errors: errors(scene, &estimates, 1), worth, turned_deg })
}

/// A row of the report: three seeds of a tracker.
fn cell(
    (score, tuning, method): (ImageScore, Tuning, Method),
    scene: &Scene,
    taught: &Taught,
    means: &[Vec<f64>],
) -> Outcome<Value> {
    let isa = Isa::best();
    let (spaces, view) = (Spaces::new(taught, tuning, isa)?, View { level: Level::Clean, score, ..VIEW });
    let (mut runs, mut worth, mut turned, mut seconds) = (vec![], [0.0; 3], vec![], 0.0);
    for seed in 1..=SEEDS {
        let seen = Seen::new(scene, &view, 0, seed, isa)?;
        let before = thread_seconds();
        let found = run(method, (scene, &seen), &spaces, means, seed)?;
        seconds += thread_seconds() - before;
        worth.iter_mut().zip(found.worth).for_each(|(sum, x)| *sum += x / SEEDS as f64);
        turned.push(format!("{:.0}", found.turned_deg));
        runs.push(found.errors);
    }
    let worth = worth.map(|x| format!("{x:.1}")).join(" | ");
    let ms = 1e3 * seconds / (SEEDS as usize * (means.len() - 1)) as f64;
    Ok(json!(format!("{} | {} | {worth} | {ms:.0}", row(&runs, &errors(scene, &means[1..], 1)), turned.join(", "))))
}

/// Runs what is not done yet of the pilot; its report.
pub(super) fn pilot(data: &Path, folder: &Path, threads: usize) -> Outcome<String> {
    let taught = Taught::new(data, folder, Lesson::Walks)?;
    let scene = scene(data, Motion::Pilot)?;
    let means = mean_poses(&scene, &taught.mean_pose);
    let mean_pose = errors(&scene, &means[1..], 1);
    let frozen = errors(&scene, &vec![scene.truth[0].clone(); means.len() - 1], 1);
    let mut text = tables::models([(Lesson::Walks, &taught)])?;
    let _ = writeln!(text, "\n{}", tables::noise([(Lesson::Walks, &taught)]));
    let _ = writeln!(text, "{} frames, fit {:.1} mm\n", scene.truth.len(), 1e3 * scene.fit_error_m);
    text += &header(
        "| | absolute, mm | relative, mm | limb ratio | frames below 150 mm, % | kept | heading off by seed, ° | log weight of true pose | of mean pose | of estimate | processor time a frame, ms |",
    );
    for (name, found) in [("mean pose", &mean_pose), ("first pose", &frozen)] {
        row!(text, "{name} | {} | | | | |", row(std::slice::from_ref(found), &mean_pose));
    }
    let all = TRIED.iter().flat_map(|&(compared, score, tuning, methods)| {
        methods.iter().map(move |&method| (format!("{}, {compared}", method.name()), (score, tuning, method)))
    });
    let all: Vec<_> = all.collect();
    let taught = &taught;
    let tasks = all.iter().map(|(name, tried)| -> Task<'_> {
        let (scene, means) = (&scene, &means);
        let work = move || cell(*tried, scene, taught, means);
        (name.clone(), tried.2.evaluations() as f64, Box::new(work))
    });
    let mut store =
        Store::open(&folder.join("pilot"), &format!("{VIEW:?}, {TUNING:?}, {:?}", taught.hierarchy.objective))?;
    run_all(&mut store, "pilot", tasks.collect(), threads)?;
    for (name, _) in &all {
        row!(text, "{name} | {}", store.get(name).and_then(Value::as_str).unwrap_or_default());
    }
    Ok(text)
}
