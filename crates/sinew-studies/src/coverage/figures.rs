//! Rank histograms, and coverage found against coverage promised.

use super::found::{BINS, Found};
use super::scene::{PARTICLES, Scene, Sizes, Tracker, Wrong};
use crate::support::chart::{self, BLUE, GREEN, GREY, Line, Names, ORANGE, PURPLE, Panel, bare, with_bar};
use crate::support::outcome::Outcome;
use plotters::prelude::*;
use sinew_tests::evaluation::ranks::LEVELS;
use std::path::Path;

fn title(scene: &Scene) -> String {
    let what = match scene {
        Scene::Person { .. } => "people",
        Scene::OwnModel { .. } => "the model's own motion",
    };
    format!("{}, {what}", scene.tracker().name())
}

/// Draws both pictures.
pub(super) fn draw(series: &[(Scene, Found)], ranked: &[Scene], folder: &Path) -> Outcome<()> {
    histograms(series, ranked, &folder.join("ranks.svg"))?;
    curves(series, &folder.join("coverage.svg"))
}

fn level_line(y: f64, last: f64) -> Line {
    Line { name: "uniform".into(), colour: GREY, points: vec![bare(0.0, y), bare(last, y)] }
}

fn histograms(series: &[(Scene, Found)], ranked: &[Scene], path: &Path) -> Outcome<()> {
    let panel = |scene: &Scene| {
        let found = series.iter().find(|(known, _)| known == scene).map(|(_, found)| found.histogram());
        // Each bin is a step with its bar of two standard errors in the middle.
        let mut steps = vec![];
        for (bin, [share, error]) in found.iter().flatten().copied().enumerate() {
            let (left, right) = (bin as f64 / BINS as f64, (bin + 1) as f64 / BINS as f64);
            steps.extend([bare(left, share), with_bar(0.5 * (left + right), [share, error]), bare(right, share)]);
        }
        let own = Line { name: "found".into(), colour: BLUE, points: steps };
        let lines = if found.is_some() { vec![level_line(1.0, 1.0), level_line(0.0, 1.0), own] } else { vec![] };
        let axes = ["rank of the truth among the draws", "relative frequency"];
        Panel { title: title(scene), axes, lines, in_decades: [false; 2], names: Names::None }
    };
    chart::draw(path, (1000, 560), (2, 2), &ranked.iter().map(panel).collect::<Vec<_>>())
}

fn curve(name: &str, colour: RGBColor, series: &[(Scene, Found)], wanted: Scene) -> Option<Line> {
    let (_, found) = series.iter().find(|(scene, _)| *scene == wanted)?;
    let point = |(level, share): (&f64, [f64; 2])| with_bar(*level, share).map(|x| 100.0 * x);
    Some(Line { name: name.into(), colour, points: LEVELS.iter().zip(found.pooled()).map(point).collect() })
}

/// A name beside a line, its colour, and the scene that it is of.
type Curve = (&'static str, RGBColor, Scene);

fn curves(series: &[(Scene, Found)], path: &Path) -> Outcome<()> {
    let person = |cameras, tracker, sizes, wrong| Scene::Person { cameras, tracker, sizes, wrong };
    let right = |cameras, tracker| person(cameras, tracker, Sizes::Fitted, Wrong::Right);
    let sized = |sizes| person(4, Tracker::Hmc, sizes, Wrong::Right);
    let otherwise = |wrong| person(4, Tracker::Hmc, Sizes::Fitted, wrong);
    let panels: [(&str, Vec<Curve>); 3] = [
        (
            "noise as assumed",
            vec![
                ("hmc, 4 cameras", BLUE, right(4, Tracker::Hmc)),
                ("hmc, 2", GREEN, right(2, Tracker::Hmc)),
                ("hmc, 1", PURPLE, right(1, Tracker::Hmc)),
                ("bootstrap, 4", ORANGE, right(4, PARTICLES)),
            ],
        ),
        (
            "sizes, hmc, 4 cameras",
            vec![
                ("known", GREEN, sized(Sizes::Known)),
                ("set-up", BLUE, sized(Sizes::Fitted)),
                ("limbs +3 %", PURPLE, sized(Sizes::Limbs)),
                ("another's", ORANGE, sized(Sizes::Other)),
            ],
        ),
        (
            "keypoints otherwise, hmc, 4 cameras",
            vec![
                ("outliers", GREEN, otherwise(Wrong::Outliers(0.02))),
                ("1.5 × noise", BLUE, otherwise(Wrong::Understated)),
                ("correlated", PURPLE, otherwise(Wrong::Persistent)),
                ("moved 6 px", ORANGE, otherwise(Wrong::Moved(6.0))),
            ],
        ),
    ];
    let panel = |(title, scenes): (&str, Vec<Curve>)| {
        let lines = scenes.into_iter().filter_map(|(name, colour, scene)| curve(name, colour, series, scene));
        let points = LEVELS.map(|level| [100.0 * level; 4]).to_vec();
        let lines = lines.chain([Line { name: "promised".into(), colour: GREY, points }]).collect();
        let (title, axes) = (title.into(), ["promised, %", "found, %"]);
        Panel { title, axes, lines, in_decades: [false; 2], names: Names::Beside(104) }
    };
    chart::draw(path, (1260, 380), (1, 3), &panels.into_iter().map(panel).collect::<Vec<_>>())
}
