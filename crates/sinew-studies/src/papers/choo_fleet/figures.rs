//! The figures of the study.
//!
//! Variance against cost (Figs 2 and 3), log likelihoods and log priors over frames (Figs 4 and 5), mean poses (Fig. 6); beyond the paper the crossover, the opponents and the cameras.

use super::chains::Variant;
use super::crossover::Crossover;
use super::curves::curve;
use super::multi::SHOWN_FRAME;
use super::problem::MODELS;
use super::scene::Source;
use super::study::{MULTI, Study, filters, frame_name, multi_key, reference_key, series};
use crate::support::chart::{self, BLUE, GREEN, GREY, Line, Names, ORANGE, PURPLE, Panel, bare, finish, with_bar};
use crate::support::outcome::Outcome;
use crate::support::store::Store;
use plotters::prelude::*;
use sinew::core::random::Stage;
use sinew_tests::evaluation::equal_variance::{Axis, Cell};
use std::f64::consts::LN_10;
use std::path::Path;

fn colour(of: Option<Variant>) -> RGBColor {
    match of {
        None => ORANGE,
        Some(Variant::Paper) => BLUE,
        Some(Variant::Best) => GREEN,
        Some(Variant::Dense) => PURPLE,
    }
}

/// A logarithm in base ten with its ends at two standard errors.
fn decades(x: f64, natural_log: f64, error: f64) -> [f64; 4] {
    let [_, y, low, high] = with_bar(x, [natural_log, error]).map(|v| v / LN_10);
    [x, y, low, high]
}

fn contenders(study: &Study) -> Vec<(String, Option<Variant>)> {
    let variants = study.size.variants.iter().map(|v| (v.name().to_owned(), Some(*v)));
    std::iter::once(("particle filter".to_owned(), None)).chain(variants).collect()
}

/// Geometric mean of the variances against cost: a row a model, a column a frame.
fn variances(study: &Study, store: &Store, path: &Path) -> Outcome<()> {
    let stage = Stage::new(study.seed, "choo-fleet bootstrap");
    let columns = study.size.frames.len();
    let mut panels = vec![];
    for model in &MODELS {
        for &frame in &study.size.frames {
            let mut lines = vec![];
            for (name, of) in contenders(study) {
                let cells = curve(study, store, Source::Recorded, frame, model, of)?;
                let point = |c: &Cell| decades(c.cost(Axis::Units).log10(), c.log_mean(), c.log_mean_error(&stage));
                lines.push(Line { name, colour: colour(of), points: cells.iter().map(point).collect() });
            }
            let title = format!("{}-D, {}", model.dim, frame_name(frame));
            let axes = ["cost, likelihoods", "variance (geometric mean)"];
            panels.push(Panel { title, axes, lines, in_decades: [true; 2], names: Names::Inside });
        }
    }
    chart::draw(path, (300 * columns as u32, 840), (MODELS.len(), columns), &panels)
}

/// Variance of every variable against cost in the tuning frame, particle filter and the paper's chains: a column a model.
fn variables(study: &Study, store: &Store, path: &Path) -> Outcome<()> {
    let mut panels = vec![];
    for model in &MODELS {
        let mut lines = vec![];
        for (name, of) in [("particle filter", None), ("hmc, paper's L", Some(Variant::Paper))] {
            let cells = curve(study, store, Source::Recorded, study.size.frames[0], model, of)?;
            for k in 0..model.dim {
                let point = |c: &Cell| {
                    let [variance, error] = c.variances()[k];
                    decades(c.cost(Axis::Units).log10(), variance.ln(), error / variance)
                };
                let name = if k == 0 { name } else { "" };
                lines.push(Line { name: name.into(), colour: colour(of), points: cells.iter().map(point).collect() });
            }
        }
        let title = format!("{}-D, {}, each variable", model.dim, frame_name(study.size.frames[0]));
        let axes = ["cost, likelihoods", "variance"];
        panels.push(Panel { title, axes, lines, in_decades: [true; 2], names: Names::Inside });
    }
    chart::draw(path, (1200, 420), (1, MODELS.len()), &panels)
}

/// Log likelihood of the mean and log prior of the truth over frames.
fn frames(study: &Study, store: &Store, path: &Path) -> Outcome<()> {
    let mut panels = vec![];
    for (name, words) in [("log_likelihood", "log likelihood of the mean"), ("log_prior", "log prior of the truth")] {
        for (index, (model, _)) in MULTI.iter().enumerate() {
            let both = series(study, store, Source::Recorded, index, name)?;
            let line = |(runs, (name, of)): (&Vec<Vec<f64>>, (&str, Option<Variant>))| {
                let n = runs.len() as f64;
                let point = |frame: usize| {
                    let mean = runs.iter().map(|run| run[frame]).sum::<f64>() / n;
                    let variance = runs.iter().map(|run| (run[frame] - mean).powi(2)).sum::<f64>() / (n - 1.0);
                    with_bar(frame as f64 + 1.0, [mean, (variance / n).sqrt()])
                };
                let points = (0..runs.first().map_or(0, Vec::len)).map(point).collect();
                Line { name: name.into(), colour: colour(of), points }
            };
            let names = [("hmc, R = 32", Some(Variant::Paper)), ("particle filter", None)];
            let (title, lines) = (format!("{}-D", MODELS[*model].dim), both.iter().zip(names).map(line).collect());
            let (axes, names) = (["frame", words], Names::Inside);
            panels.push(Panel { title, axes, lines, in_decades: [false; 2], names });
        }
    }
    chart::draw(path, (1000, 760), (2, MULTI.len()), &panels)
}

/// Cost of particles over that of chains against the number of degrees of freedom.
pub(super) fn crossover(found: &[Crossover], path: &Path) -> Outcome<()> {
    let mut lines = vec![];
    for variant in [Variant::Best, Variant::Dense] {
        let of = found.iter().filter(|c| c.variant == variant);
        let point = |c: &Crossover| {
            let [middle, low, high] = c.ratio.map(f64::log10);
            [c.dim as f64, middle, low, high]
        };
        lines.push(Line {
            name: variant.name().into(),
            colour: colour(Some(variant)),
            points: of.map(point).collect(),
        });
    }
    let even = [2.0, 28.0].map(|dim| bare(dim, 0.0)).to_vec();
    lines.push(Line { name: "equal cost".into(), colour: GREY, points: even });
    let title = "Cost of the particle filter over that of hmc at equal variance".into();
    let axes = ["degrees of freedom", "ratio"];
    let panel = Panel { title, axes, lines, in_decades: [false, true], names: Names::Inside };
    chart::draw(path, (640, 420), (1, 1), &[panel])
}

/// A title and the curves of its contenders.
pub(super) type Curves = (String, Vec<(&'static str, Vec<Cell>)>);

/// Geometric mean of the variances against cost, hybrid Monte Carlo and its opponents: a row a frame, a column a model. Panels come model by model.
pub(super) fn opponents(all: &[Curves], rows: usize, stage: &Stage, path: &Path) -> Outcome<()> {
    const COLOURS: [RGBColor; 6] = [ORANGE, BLUE, GREEN, BLACK, GREY, PURPLE];
    let columns = all.len() / rows;
    let panel = |(title, curves): &Curves| {
        let line = |((name, cells), colour): (&(&str, Vec<Cell>), RGBColor)| {
            let point = |c: &Cell| decades(c.cost(Axis::Units).log10(), c.log_mean(), c.log_mean_error(stage));
            Line { name: (*name).into(), colour, points: cells.iter().map(point).collect() }
        };
        let (title, lines) = (title.clone(), curves.iter().zip(COLOURS).map(line).collect());
        let axes = ["cost, likelihoods", "variance, geometric mean, rad² and m²"];
        Panel { title, axes, lines, in_decades: [true; 2], names: Names::Beside(130) }
    };
    let places = (0..rows).flat_map(|row| (0..columns).map(move |column| column * rows + row));
    let panels: Vec<Panel<'_>> = places.map(|place| panel(&all[place])).collect();
    chart::draw(path, (440 * columns as u32, 270 * rows as u32), (rows, columns), &panels)
}

/// Cost of particles over that of chains with a number of cameras and an error.
pub(super) struct CameraPoint {
    pub(super) dim: usize,
    pub(super) cameras: usize,
    pub(super) sigma: f64,
    pub(super) variant: Variant,
    pub(super) ratio: [f64; 3],
}

/// Cost of particles over that of chains against the error of the images, one line a number of cameras: a row a metric, a column a model.
pub(super) fn cameras(found: &[CameraPoint], path: &Path) -> Outcome<()> {
    let mut panels = vec![];
    for variant in [Variant::Best, Variant::Dense] {
        for dim in [10, 28] {
            let line = |(cameras, colour): (usize, RGBColor)| {
                let of = found.iter().filter(|p| (p.dim, p.variant, p.cameras) == (dim, variant, cameras));
                let point = |p: &CameraPoint| {
                    let [middle, low, high] = p.ratio.map(f64::log10);
                    [p.sigma.log10(), middle, low, high]
                };
                let name = if cameras == 1 { "1 camera".into() } else { format!("{cameras} cameras") };
                Line { name, colour, points: of.map(point).collect() }
            };
            let lines = [(1, BLUE), (2, GREEN), (4, ORANGE)].into_iter().map(line).collect();
            let (title, names) = (format!("{dim}-D, {}", variant.name()), Names::Beside(75));
            let axes = ["error, focal lengths", "cost of pf over cost of hmc"];
            panels.push(Panel { title, axes, lines, in_decades: [true; 2], names });
        }
    }
    chart::draw(path, (960, 760), (2, 2), &panels)
}

/// Bones of CF28 by the names of its points.
const BONES: [[&str; 2]; 16] = [
    ["Head", "Neck"],
    ["Head", "Nose"],
    ["Neck", "Spine"],
    ["Spine", "MidHip"],
    ["LShoulder", "RShoulder"],
    ["LShoulder", "LElbow"],
    ["LElbow", "LWrist"],
    ["RShoulder", "RElbow"],
    ["RElbow", "RWrist"],
    ["LHip", "RHip"],
    ["LHip", "LKnee"],
    ["LKnee", "LAnkle"],
    ["RHip", "RKnee"],
    ["RKnee", "RAnkle"],
    ["Neck", "LShoulder"],
    ["Neck", "RShoulder"],
];
/// Runs whose mean poses are shown.
const RUNS_SHOWN: usize = 6;

/// Mean poses at one frame, seen from the side, so that what the camera does not show is seen: a row a filter, a column a run, the true pose in grey.
fn poses(study: &Study, store: &Store, path: &Path) -> Outcome<()> {
    let motion = &study.motions["07_01"];
    let truth = motion.frame(SHOWN_FRAME, Source::Fitted)?.markers;
    let points = motion.tree.points();
    let index = |name: &str| points.iter().position(|point| point.name == name).ok_or(format!("CF28 has no {name}"));
    let middle = truth[index("MidHip")?];
    let (across, down) = ((middle[1] - 0.9)..(middle[1] + 0.9), (middle[2] - 1.2)..(middle[2] + 0.9));
    let root = SVGBackend::new(path, (190 * RUNS_SHOWN as u32, 2 * 250)).into_drawing_area();
    root.fill(&WHITE)?;
    let areas = root.split_evenly((2, RUNS_SHOWN));
    let both = series(study, store, Source::Recorded, 1, "shown")?;
    for (row, (runs, (name, of))) in
        both.iter().zip([("hmc", Some(Variant::Paper)), ("particle filter", None)]).enumerate()
    {
        for (run, pose) in runs.iter().take(RUNS_SHOWN).enumerate() {
            let mut chart = ChartBuilder::on(&areas[row * RUNS_SHOWN + run])
                .caption(format!("{name}, run {}", run + 1), ("sans-serif", 13))
                .margin(4)
                .build_cartesian_2d(across.clone(), down.clone())?;
            let found: Vec<[f64; 3]> = pose.chunks(3).map(|p| [p[0], p[1], p[2]]).collect();
            for (at, style) in [(&truth, RGBColor(170, 170, 170)), (&found, colour(of))] {
                for [a, b] in BONES {
                    let (a, b) = (at[index(a)?], at[index(b)?]);
                    let line = PathElement::new(vec![(a[1], a[2]), (b[1], b[2])], style.stroke_width(2));
                    chart.draw_series(std::iter::once(line))?;
                }
            }
        }
    }
    finish(&root)
}

/// Draws the figures of what was run into a folder.
pub(super) fn draw(study: &Study, store: &Store, folder: &Path) -> Outcome<()> {
    if store.get(&reference_key(Source::Recorded, study.size.frames[0], &MODELS[0])).is_some() {
        variances(study, store, &folder.join("variances.svg"))?;
        variables(study, store, &folder.join("variables.svg"))?;
    }
    let (model, both) = filters(store, 0)?;
    if study.size.noises > 0 && store.get(&multi_key(Source::Recorded, &model, &both[0], 0)).is_some() {
        frames(study, store, &folder.join("frames.svg"))?;
        poses(study, store, &folder.join("poses.svg"))?;
    }
    Ok(())
}
