//! Figure 4: the log likelihood of the estimates frame by frame; beside it their recall.

use super::claims::LEVEL;
use super::contender::{Contender, Reading};
use super::results::{Estimate, Results};
use crate::support::chart::{BLUE, GREEN, GREY, Line, Names, ORANGE, PURPLE, finish, panel_with};
use crate::support::outcome::Outcome;
use plotters::prelude::*;
use std::path::Path;

/// Frames that a point of a line stands for.
const AVERAGED: usize = 5;

/// Means over seeds of a quantity, every [`AVERAGED`] frames.
fn line(results: &Results<'_>, of: &Contender, name: &str, colour: RGBColor) -> Outcome<Line> {
    let runs = results.series(LEVEL, of, Estimate::Second, name)?;
    let frames = runs.first().map_or(0, Vec::len);
    let point = |start: usize| {
        let end = (start + AVERAGED).min(frames);
        let sum: f64 = runs.iter().flat_map(|run| &run[start..end]).sum();
        let value = sum / (runs.len() * (end - start)) as f64;
        [0.5 * (start + end + 1) as f64, value, value, value]
    };
    Ok(Line { name: of.name(), colour, points: (0..frames).step_by(AVERAGED).map(point).collect() })
}

/// Draws the figure of a reading.
pub(super) fn draw(results: &Results<'_>, reading: &Reading, path: &Path) -> Outcome<()> {
    let root = SVGBackend::new(path, (1000, 760)).into_drawing_area();
    root.fill(&WHITE)?;
    let (settings, opponent) = (reading.settings(), reading.pairs()[2].1);
    let contenders = settings.iter().chain([&opponent]).zip([BLUE, GREEN, PURPLE, GREY, ORANGE]);
    let panels = [("log_likelihood", "log likelihood of the estimate"), ("recall", "recall, %")];
    for ((name, words), area) in panels.into_iter().zip(root.split_evenly((2, 1))) {
        let lines = contenders.clone().map(|(of, colour)| line(results, of, name, colour));
        let lines = lines.collect::<Outcome<Vec<Line>>>()?;
        panel_with(&area, "", ["frame", words], &lines, [false; 2], Names::Beside(140))?;
    }
    finish(&root)
}
