//! The pilot on training motion that no model learned from: is the person kept at all, and what would have to be true for it.
//!
//! A walk in a circle, 15 frames a second, four cameras, clean masks, 1000 particles a layer or node. For each way to compare images and each tracker: errors, and the mean log weights of the true pose, of the mean pose at the true place and of the estimate.

use super::contender::{Lesson, Method, Motion, VIEW};
use super::lessons::Taught;
use super::study::scene;
use super::tables;
use super::trackers::Spaces;
use crate::outcome::Outcome;
use crate::reproduce::masked_scene::{Scene, Seen, View};
use crate::reproduce::worth::{Errors, errors, kept, mean, mean_poses};
use sinew::core::density::LogDensity as _;
use sinew::core::lanes::Isa;
use sinew::core::random::Stage;
use sinew::observe::image_score::ImageScore;
use sinew_simulate::segmentation_noise::Level;
use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

/// Ways to compare images.
const SCORES: [(&str, ImageScore); 3] = [
    ("both directions", ImageScore::DeutscherReid { kappa: 100.0, bidirectional: Some(0.5) }),
    ("silhouette one way", ImageScore::DeutscherReid { kappa: 100.0, bidirectional: None }),
    ("parts", ImageScore::Parts),
];

/// Trackers: with 1000 particles, and as the paper has them.
const METHODS: [Method; 8] = [
    Method::Bootstrap(1000),
    Method::Annealed(1000),
    Method::Gpapf(1000),
    Method::HApf(1000),
    Method::Bootstrap(500),
    Method::Annealed(100),
    Method::Gpapf(100),
    Method::HApf(100),
];

/// Errors as a row.
fn row(found: &Errors, mean_pose: &Errors) -> String {
    let (near, ratio, is_kept) = kept(found, mean_pose);
    let kept = if is_kept { "kept" } else { "no" };
    let [absolute, relative] = [&found.absolute, &found.relative].map(|all| mean(all));
    format!("{absolute:.0} | {relative:.0} | {ratio:.2} | {:.0} | {kept}", 100.0 * near)
}

/// One run: its errors, and mean log weights of true pose, mean pose and estimate.
fn run(
    method: Method,
    (scene, seen): (&Scene, &Seen),
    spaces: &Spaces,
    means: &[Vec<f64>],
) -> Outcome<(Errors, [f64; 3])> {
    let mut tracker = spaces.tracker(method, &scene.truth[0])?.ok_or("no tracker")?;
    let (mut estimates, mut worth) = (vec![], [0.0; 3]);
    for frame in 1..scene.truth.len() {
        let observed = seen.bind(frame);
        let info = tracker.step(&observed, Stage::new(1, "h-apf pilot").at_frame(frame as u32))?;
        for (sum, state) in worth.iter_mut().zip([&scene.truth[frame], &means[frame], &info.mean]) {
            *sum += observed.log_density(state) / (scene.truth.len() - 1) as f64;
        }
        estimates.push(info.mean);
    }
    Ok((errors(scene, &estimates, 1), worth))
}

/// Runs the pilot; its report.
pub(super) fn pilot(data: &Path, folder: &Path, only: Option<&str>) -> Outcome<String> {
    let (taught, isa) = (Taught::new(data, folder, Lesson::Walks)?, Isa::best());
    let (spaces, scene) = (Spaces::new(&taught, isa)?, scene(data, Motion::Pilot)?);
    let means = mean_poses(&scene, &taught.mean_pose);
    let mean_pose = errors(&scene, &means[1..], 1);
    let frozen = errors(&scene, &vec![scene.truth[0].clone(); means.len() - 1], 1);
    let mut text = tables::models([(Lesson::Walks, &taught, &spaces)])?;
    let _ = writeln!(text, "\n{}", tables::noise([(Lesson::Walks, &taught)]));
    let _ = writeln!(text, "{} frames, fit {:.1} mm\n", scene.truth.len(), 1e3 * scene.fit_error_m);
    text += "| | absolute, mm | relative, mm | limb ratio | frames below 150 mm, % | | log weight of true pose | of mean pose | of estimate | s |\n|---|---|---|---|---|---|---|---|---|---|\n";
    for (name, found) in [("mean pose", &mean_pose), ("first pose", &frozen)] {
        let _ = writeln!(text, "| {name} | {} | | | | |", row(found, &mean_pose));
    }
    println!("{text}");
    for (name, score) in SCORES {
        let seen = Seen::new(&scene, &View { level: Level::Clean, score, ..VIEW }, 0, 1, isa)?;
        for method in METHODS {
            let name = format!("{}, {name}", method.name());
            if only.is_some_and(|only| !name.contains(only)) {
                continue;
            }
            let clock = Instant::now();
            let (found, worth) = run(method, (&scene, &seen), &spaces, &means)?;
            let worth = worth.map(|x| format!("{x:.2}")).join(" | ");
            let seconds = clock.elapsed().as_secs_f64();
            let line = format!("| {name} | {} | {worth} | {seconds:.0} |", row(&found, &mean_pose));
            println!("{line}");
            let _ = writeln!(text, "{line}");
        }
    }
    Ok(text)
}
