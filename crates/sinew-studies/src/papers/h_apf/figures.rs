//! The paper's figures on our data: errors over time, means over seeds. Figure 1: a walk in a circle at 15 frames a second, with 100 particles and with 1000. Figure 3: GPAPF and H-APF on longer sequences, with 1000.

use super::contender::{Contender, Method, Motion, OTHERS, PILOTED, PRINTED};
use super::motions::RATE_HZ;
use crate::papers::seed_results::Results;
use crate::support::chart::{self, BLUE, GREEN, GREY, Line, Names, ORANGE, Panel, bare};
use crate::support::outcome::Outcome;
use plotters::prelude::*;
use std::path::Path;

/// The walk that is drawn.
const DRAWN: Motion = Motion::Walk(1);
/// Width of the margin for names, pixels.
const MARGIN: u32 = 150;

fn line(results: &Results<'_>, method: Method, motion: Motion, colour: RGBColor) -> Outcome<Line> {
    let runs = results.series(&Contender { method, motion }, "/absolute")?;
    let frames = runs.first().map_or(0, Vec::len);
    let point = |frame: usize| {
        bare((frame + 1) as f64 / RATE_HZ, runs.iter().map(|run| run[frame]).sum::<f64>() / runs.len() as f64)
    };
    Ok(Line { name: method.name(), colour, points: (0..frames).map(point).collect() })
}

/// A motion with the methods that are drawn on it.
type Drawn = (Motion, Vec<(Method, RGBColor)>);

fn draw(results: &Results<'_>, all: &[Drawn], path: &Path) -> Outcome<()> {
    let panel = |(motion, methods): &Drawn| {
        let lines = methods.iter().map(|&(method, colour)| line(results, method, *motion, colour));
        Ok(Panel {
            title: motion.name(),
            axes: ["time, s", "absolute error, mm"],
            lines: lines.collect::<Outcome<_>>()?,
            in_decades: [false; 2],
            names: Names::Beside(MARGIN),
        })
    };
    let panels = all.iter().map(panel).collect::<Outcome<Vec<_>>>()?;
    chart::draw(path, (900, 320 * panels.len() as u32), (panels.len(), 1), &panels)
}

/// Draws figure 1 of one motion and some methods into a folder.
pub(super) fn walk(results: &Results<'_>, (motion, of): (Motion, &[Contender]), folder: &Path) -> Outcome<()> {
    let methods = of.iter().map(|contender| contender.method).zip([BLUE, ORANGE, GREY]).collect();
    draw(results, &[(motion, methods)], &folder.join("figure-1.svg"))
}

/// Draws both figures into a folder.
pub(super) fn all(results: &Results<'_>, folder: &Path) -> Outcome<()> {
    let mean_pose = (Method::MeanPose, GREY);
    let panel = |motion, methods: &[Method]| -> Drawn {
        let coloured = methods.iter().copied().zip([BLUE, ORANGE, GREEN]).chain([mean_pose]);
        (motion, coloured.collect())
    };
    let walk = [panel(DRAWN, &PRINTED[..3]), panel(DRAWN, &PILOTED)];
    draw(results, &walk, &folder.join("figure-1.svg"))?;
    draw(results, &OTHERS.map(|motion| panel(motion, &PILOTED[..2])), &folder.join("figure-3.svg"))
}
