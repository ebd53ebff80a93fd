//! Rank histograms, and coverage found against coverage promised.

use super::found::{BINS, Found};
use super::scene::{PARTICLES, Scene, Sizes, Tracker, Wrong};
use crate::support::chart::{BLUE, GREEN, GREY, Line, Names, ORANGE, PURPLE, finish, panel_with};
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
    Line { name: "uniform".into(), colour: GREY, points: vec![[0.0, y, y, y], [last, y, y, y]] }
}

fn histograms(series: &[(Scene, Found)], ranked: &[Scene], path: &Path) -> Outcome<()> {
    let root = SVGBackend::new(path, (1000, 560)).into_drawing_area();
    root.fill(&WHITE).map_err(|error| error.to_string())?;
    let areas = root.split_evenly((2, 2));
    for (area, scene) in areas.iter().zip(ranked) {
        let Some((_, found)) = series.iter().find(|(known, _)| known == scene) else { continue };
        // Each bin is a step with its bar of two standard errors in the middle.
        let mut steps = vec![];
        for (bin, [share, error]) in found.histogram().into_iter().enumerate() {
            let (left, right) = (bin as f64 / BINS as f64, (bin + 1) as f64 / BINS as f64);
            steps.push([left, share, share, share]);
            steps.push([0.5 * (left + right), share, share - 2.0 * error, share + 2.0 * error]);
            steps.push([right, share, share, share]);
        }
        let lines =
            [level_line(1.0, 1.0), level_line(0.0, 1.0), Line { name: "found".into(), colour: BLUE, points: steps }];
        let names = ["rank of the truth among the draws", "relative frequency"];
        panel_with(area, &title(scene), names, &lines, [false, false], Names::None)?;
    }
    finish(&root)
}

fn curve(name: &str, colour: RGBColor, series: &[(Scene, Found)], wanted: Scene) -> Option<Line> {
    let (_, found) = series.iter().find(|(scene, _)| *scene == wanted)?;
    let point = |(level, [share, error]): (&f64, [f64; 2])| {
        [*level, share, share - 2.0 * error, share + 2.0 * error].map(|x| 100.0 * x)
    };
    Some(Line { name: name.into(), colour, points: LEVELS.iter().zip(found.pooled()).map(point).collect() })
}

/// A name beside a line, its colour, and the scene that it is of.
type Curve = (&'static str, RGBColor, Scene);

fn curves(series: &[(Scene, Found)], path: &Path) -> Outcome<()> {
    let root = SVGBackend::new(path, (1260, 380)).into_drawing_area();
    root.fill(&WHITE).map_err(|error| error.to_string())?;
    let areas = root.split_evenly((1, 3));
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
    let mut drawn: Vec<(&str, Vec<Line>)> = panels
        .into_iter()
        .map(|(title, scenes)| {
            let lines = scenes.into_iter().filter_map(|(name, colour, scene)| curve(name, colour, series, scene));
            (title, lines.collect())
        })
        .collect();
    let promised = LEVELS.map(|level| [100.0 * level; 4]).to_vec();
    for (area, (title, lines)) in areas.iter().zip(&mut drawn) {
        lines.push(Line { name: "promised".into(), colour: GREY, points: promised.clone() });
        panel_with(area, title, ["promised, %", "found, %"], lines, [false, false], Names::Beside(104))?;
    }
    finish(&root)
}
