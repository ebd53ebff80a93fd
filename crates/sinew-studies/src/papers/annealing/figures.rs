//! Figures: coverage against what was promised, particles against parts, errors on the film along the sweeps.

use super::coverage::SHOWN;
use super::expectations::errors;
use super::film::{LAYERS, Method, SCORES, SURVIVALS, annealed};
use super::study::{Part, Study};
use crate::papers::interval_tally::LEVELS;
use crate::support::chart::{self, BLUE, GREEN, GREY, Line, Names, ORANGE, PURPLE, Panel, bare, with_bar};
use crate::support::outcome::Outcome;
use plotters::prelude::*;
use sinew_tests::finding::mean_and_error;
use std::path::Path;

/// Share of the truth inside against the nominal level: a panel a dimension.
fn coverage(study: &Study, path: &Path) -> Outcome<()> {
    let (columns, mut panels) = (study.size.dims.len(), vec![]);
    let colours = [BLUE, GREEN, ORANGE, PURPLE, RGBColor(86, 180, 233), RGBColor(230, 159, 0)];
    for &dim in &study.size.dims {
        let promised = LEVELS.map(|p| [100.0 * p; 4]).to_vec();
        let mut lines = vec![Line { name: "as promised".into(), colour: GREY, points: promised }];
        for ((name, _), colour) in study.contenders()[..SHOWN].iter().zip(colours) {
            let found = study.covered(name, dim)?;
            let point = |(p, share): (&f64, &[f64; 2])| with_bar(*p, *share).map(|x| 100.0 * x);
            let name = if name.starts_with("annealed") { name.replace("annealed, ", "") } else { name.clone() };
            lines.push(Line { name, colour, points: LEVELS.iter().zip(&found).map(point).collect() });
        }
        let (title, axes) = (format!("{dim} dimensions"), ["nominal level, %", "truth inside, %"]);
        panels.push(Panel { title, axes, lines, in_decades: [false; 2], names: Names::Beside(120) });
    }
    chart::draw(path, (420 * columns as u32, 380), (1, columns), &panels)
}

/// Particles for 200 survivors against the number of parts: a panel a survival rate.
fn partitions(study: &Study, path: &Path) -> Outcome<()> {
    let (rates, mut panels) = (study.rates(), vec![]);
    for &(rate, most) in &rates {
        let law = |d: usize| bare(d as f64, (super::partitions::WANTED * rate.powi(-(d as i32))).log10());
        let mut lines =
            vec![Line { name: "law α^(−d)".into(), colour: GREY, points: (1..=most).map(law).collect() }];
        for (how, name, colour) in [("at_once", "all at once", ORANGE), ("apart", "part by part", BLUE)] {
            let needed = study.needed(rate, most, how)?;
            let point = |(k, [particles, _]): (usize, &[f64; 2])| bare(k as f64 + 1.0, particles.log10());
            lines.push(Line { name: name.into(), colour, points: needed.iter().enumerate().map(point).collect() });
        }
        let title = format!("survival rate of a part {rate}");
        let axes = ["number of parts", "particles for 200 survivors"];
        panels.push(Panel { title, axes, lines, in_decades: [false, true], names: Names::Beside(90) });
    }
    chart::draw(path, (460 * rates.len() as u32, 360), (1, rates.len()), &panels)
}

/// Errors from the pelvis along the sweeps of survival rates and layers.
fn film(study: &Study, path: &Path) -> Outcome<()> {
    let survivals: Vec<(f64, Method)> =
        SURVIVALS.iter().map(|&a| (a, Method::Annealed(annealed(10, 200, a)))).collect();
    let layers: Vec<(f64, Method)> =
        LAYERS.iter().map(|&(n, particles)| (n as f64, Method::Annealed(annealed(n, particles, 0.5)))).collect();
    let shown = [
        ("10 layers × 200", "survival rate α", survivals, &SCORES[1..]),
        ("1000 evaluations a frame, α = 0.5", "layers", layers, &SCORES[..]),
    ];
    let mut panels = vec![];
    for (title, x, settings, scores) in &shown {
        let mut lines = vec![];
        for (score, _) in *scores {
            let point = |(x, method): &(f64, Method)| {
                Ok(with_bar(*x, mean_and_error(&errors(study, score, method, "relative")?)))
            };
            let points = settings.iter().map(point).collect::<Outcome<_>>()?;
            let colour = if *score == SCORES[1].0 { BLUE } else { ORANGE };
            lines.push(Line { name: (*score).into(), colour, points });
        }
        let (title, axes) = ((*title).into(), [*x, "error from the pelvis, mm"]);
        panels.push(Panel { title, axes, lines, in_decades: [false; 2], names: Names::Beside(90) });
    }
    chart::draw(path, (960, 360), (1, 2), &panels)
}

/// Draws what was run.
pub(super) fn draw(study: &Study, folder: &Path) -> Outcome<()> {
    if study.wanted(Part::Coverage) {
        coverage(study, &folder.join("coverage.svg"))?;
    }
    if study.wanted(Part::Partitions) {
        partitions(study, &folder.join("partitions.svg"))?;
    }
    if study.wanted(Part::Film) && study.size.sweeps.len() > 1 {
        film(study, &folder.join("film.svg"))?;
    }
    Ok(())
}
