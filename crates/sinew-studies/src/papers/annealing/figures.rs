//! Figures: coverage against what was promised, particles against parts, errors on the film along the sweeps.

use super::coverage::SHOWN;
use super::expectations::errors;
use super::film::{LAYERS, Method, SCORES, SURVIVALS, annealed};
use super::study::{Part, Study};
use crate::papers::interval_tally::LEVELS;
use crate::support::chart::{BLUE, GREEN, GREY, Line, Names, ORANGE, PURPLE, finish, panel_with};
use crate::support::outcome::Outcome;
use plotters::prelude::*;
use sinew_tests::finding::mean_and_error;
use std::path::Path;

/// Share of the truth inside against the nominal level: a panel a dimension.
fn coverage(study: &Study, path: &Path) -> Outcome<()> {
    let root = SVGBackend::new(path, (420 * study.size.dims.len() as u32, 380)).into_drawing_area();
    root.fill(&WHITE)?;
    let colours = [BLUE, GREEN, ORANGE, PURPLE, RGBColor(86, 180, 233), RGBColor(230, 159, 0)];
    for (&dim, area) in study.size.dims.iter().zip(root.split_evenly((1, study.size.dims.len()))) {
        let promised = LEVELS.map(|p| [100.0 * p; 4]).to_vec();
        let mut lines = vec![Line { name: "as promised".into(), colour: GREY, points: promised }];
        for ((name, _), colour) in study.contenders()[..SHOWN].iter().zip(colours) {
            let found = study.covered(name, dim)?;
            let point = |(p, [share, error]): (&f64, &[f64; 2])| {
                [*p, *share, share - 2.0 * error, share + 2.0 * error].map(|x| 100.0 * x)
            };
            let name = if name.starts_with("annealed") { name.replace("annealed, ", "") } else { name.clone() };
            lines.push(Line { name, colour, points: LEVELS.iter().zip(&found).map(point).collect() });
        }
        let axes = ["nominal level, %", "truth inside, %"];
        panel_with(&area, &format!("{dim} dimensions"), axes, &lines, [false; 2], Names::Beside(120))?;
    }
    finish(&root)
}

/// Particles for 200 survivors against the number of parts: a panel a survival rate.
fn partitions(study: &Study, path: &Path) -> Outcome<()> {
    let rates = study.rates();
    let root = SVGBackend::new(path, (460 * rates.len() as u32, 360)).into_drawing_area();
    root.fill(&WHITE)?;
    for (&(rate, most), area) in rates.iter().zip(root.split_evenly((1, rates.len()))) {
        let law = |d: usize| {
            let y = (super::partitions::WANTED * rate.powi(-(d as i32))).log10();
            [d as f64, y, y, y]
        };
        let mut lines =
            vec![Line { name: "law α^(−d)".into(), colour: GREY, points: (1..=most).map(law).collect() }];
        for (how, name, colour) in [("at_once", "all at once", ORANGE), ("apart", "part by part", BLUE)] {
            let needed = study.needed(rate, most, how)?;
            let point = |(k, [particles, _]): (usize, &[f64; 2])| {
                let y = particles.log10();
                [k as f64 + 1.0, y, y, y]
            };
            lines.push(Line { name: name.into(), colour, points: needed.iter().enumerate().map(point).collect() });
        }
        let title = format!("survival rate of a part {rate}");
        let axes = ["number of parts", "particles for 200 survivors"];
        panel_with(&area, &title, axes, &lines, [false, true], Names::Beside(90))?;
    }
    finish(&root)
}

/// Errors from the pelvis along the sweeps of survival rates and layers.
fn film(study: &Study, path: &Path) -> Outcome<()> {
    let root = SVGBackend::new(path, (960, 360)).into_drawing_area();
    root.fill(&WHITE)?;
    let survivals: Vec<(f64, Method)> =
        SURVIVALS.iter().map(|&a| (a, Method::Annealed(annealed(10, 200, a)))).collect();
    let layers: Vec<(f64, Method)> =
        LAYERS.iter().map(|&(n, particles)| (n as f64, Method::Annealed(annealed(n, particles, 0.5)))).collect();
    let panels = [
        ("10 layers × 200", "survival rate α", survivals, &SCORES[1..]),
        ("1000 evaluations a frame, α = 0.5", "layers", layers, &SCORES[..]),
    ];
    for ((title, x, settings, scores), area) in panels.iter().zip(root.split_evenly((1, 2))) {
        let mut lines = vec![];
        for (score, _) in *scores {
            let point = |(x, method): &(f64, Method)| {
                let [y, error] = mean_and_error(&errors(study, score, method, "relative")?);
                Ok([*x, y, y - 2.0 * error, y + 2.0 * error])
            };
            let points = settings.iter().map(point).collect::<Outcome<_>>()?;
            let colour = if *score == SCORES[1].0 { BLUE } else { ORANGE };
            lines.push(Line { name: (*score).into(), colour, points });
        }
        panel_with(&area, title, [x, "error from the pelvis, mm"], &lines, [false; 2], Names::Beside(90))?;
    }
    finish(&root)
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
