//! Figure 4: the log likelihood of the estimates frame by frame; beside it their recall.

use super::claims::LEVEL;
use super::contender::{Contender, Reading};
use super::results::Estimate;
use crate::papers::seed_results::Results;
use crate::support::chart::{self, BLUE, GREEN, GREY, Line, Names, ORANGE, PURPLE, Panel, bare};
use crate::support::outcome::Outcome;
use plotters::prelude::*;
use std::path::Path;

/// Frames that a point of a line stands for.
const AVERAGED: usize = 5;

/// Means over seeds of a quantity, every [`AVERAGED`] frames.
fn line(results: &Results<'_>, of: &Contender, name: &str, colour: RGBColor) -> Outcome<Line> {
    let runs = results.estimated(LEVEL, of, Estimate::Second, name)?;
    let frames = runs.first().map_or(0, Vec::len);
    let point = |start: usize| {
        let end = (start + AVERAGED).min(frames);
        let sum: f64 = runs.iter().flat_map(|run| &run[start..end]).sum();
        bare(0.5 * (start + end + 1) as f64, sum / (runs.len() * (end - start)) as f64)
    };
    Ok(Line { name: of.name(), colour, points: (0..frames).step_by(AVERAGED).map(point).collect() })
}

/// Draws the figure of a reading.
pub(super) fn draw(results: &Results<'_>, reading: &Reading, path: &Path) -> Outcome<()> {
    let (settings, opponent) = (reading.settings(), reading.pairs()[2].1);
    let contenders = settings.iter().chain([&opponent]).zip([BLUE, GREEN, PURPLE, GREY, ORANGE]);
    let panels = [("log_likelihood", "log likelihood of the estimate"), ("recall", "recall, %")];
    let panel = |(name, words)| {
        let lines = contenders.clone().map(|(of, colour)| line(results, of, name, colour)).collect::<Outcome<_>>()?;
        let names = Names::Beside(140);
        Ok(Panel { title: String::new(), axes: ["frame", words], lines, in_decades: [false; 2], names })
    };
    chart::draw(path, (1000, 760), (2, 1), &panels.into_iter().map(panel).collect::<Outcome<Vec<_>>>()?)
}
