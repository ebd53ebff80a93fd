//! The paper's figure 4 on our data: true poses and what H-APF finds, side by side in time. A run, and martial arts that training lacks; there is no lifting.

use super::contender::{Contender, Motion, PILOTED};
use super::motions::{RATE_HZ, TEST_RUNS};
use super::study::Study;
use crate::support::chart::{Area, BLUE, GREY, finish};
use crate::support::outcome::Outcome;
use plotters::prelude::*;
use sinew_body::points::{Trajectories, points_of_states};
use std::path::Path;

/// Motions that are drawn, all with this seed.
const DRAWN: [Motion; 2] = [Motion::Run(TEST_RUNS.start), Motion::Unseen2];
const SEED: u64 = 1;
/// Figures of a motion.
const FIGURES: usize = 10;
/// Size of the picture of a motion, pixels, and pixels a metre.
const SIZE: (u32, u32) = (900, 230);
const SCALE: f64 = 85.0;

/// Lines of a figure.
const BONES: [(&str, &str); 14] = [
    ("MidHip", "Neck"),
    ("Neck", "Head"),
    ("Neck", "LShoulder"),
    ("LShoulder", "LElbow"),
    ("LElbow", "LWrist"),
    ("Neck", "RShoulder"),
    ("RShoulder", "RElbow"),
    ("RElbow", "RWrist"),
    ("MidHip", "LHip"),
    ("LHip", "LKnee"),
    ("LKnee", "LAnkle"),
    ("MidHip", "RHip"),
    ("RHip", "RKnee"),
    ("RKnee", "RAnkle"),
];

/// A figure whose pixel `centre` is at a place of the world: x to the right, z up.
fn figure(
    area: &Area<'_>,
    motion: &Trajectories,
    frame: usize,
    (centre, at): ([f64; 2], [f64; 3]),
    colour: RGBColor,
) -> Outcome<()> {
    let pixel = |point: [f64; 3]| {
        let across = centre[0] + SCALE * (point[0] - at[0]);
        (across.round() as i32, (centre[1] - SCALE * (point[2] - at[2])).round() as i32)
    };
    for (from, to) in BONES {
        if let (Some(from), Some(to)) = (motion.index(from), motion.index(to)) {
            let ends = [from, to].map(|joint| pixel(motion.frames[frame][joint]));
            area.draw(&PathElement::new(ends, colour.stroke_width(2)))?;
        }
    }
    Ok(())
}

/// Draws the figure into a folder: true poses grey, found ones blue, each where the true hips are in the middle.
pub(super) fn figure_4(study: &Study, folder: &Path) -> Outcome<()> {
    let path = folder.join("figure-4.svg");
    let root = SVGBackend::new(&path, (SIZE.0, SIZE.1 * DRAWN.len() as u32)).into_drawing_area();
    root.fill(&WHITE)?;
    for (motion, area) in DRAWN.into_iter().zip(root.split_evenly((DRAWN.len(), 1))) {
        let scene = &study.scenes[&motion];
        let found = study.poses(&Contender { method: PILOTED[0], motion }, SEED)?;
        let [truth, found] = [&scene.truth[1..], &found].map(|states| points_of_states(&scene.tree, states));
        let hips = truth.index("MidHip").ok_or("a body without hips")?;
        area.draw(&Text::new(motion.name(), (8, 8), ("sans-serif", 15)))?;
        for k in 0..FIGURES {
            let frame = k * (truth.frames.len() - 1) / (FIGURES - 1);
            let centre = [f64::from(SIZE.0) * (k as f64 + 0.5) / FIGURES as f64, 0.5 * f64::from(SIZE.1)];
            let place = (centre, truth.frames[frame][hips]);
            figure(&area, &truth, frame, place, GREY)?;
            figure(&area, &found, frame, place, BLUE)?;
            let time = format!("{:.1} s", (frame + 1) as f64 / RATE_HZ);
            area.draw(&Text::new(time, (centre[0] as i32 - 12, SIZE.1 as i32 - 20), ("sans-serif", 12)))?;
        }
    }
    finish(&root)
}
