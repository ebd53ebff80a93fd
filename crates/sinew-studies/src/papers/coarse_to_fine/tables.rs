//! The paper's two tables and those beside them as Markdown and JSON.

use super::contender::{Contender, Method, Reading};
use super::results::Estimate;
use super::scene::Scene;
use super::study::Group;
use crate::papers::seed_results::{Mean, Results};
use crate::support::outcome::Outcome;
use crate::support::table::{header, row};
use serde_json::json;
use sinew::observe::silhouettes::girth::Girth;
use sinew_simulate::segmentation_noise::Level;

/// Quantities of a frame with the decimals that tables show.
const QUANTITIES: [(&str, usize); 8] = [
    ("precision", 1),
    ("recall", 1),
    ("clean_precision", 1),
    ("clean_recall", 1),
    ("log_likelihood", 2),
    ("parts", 1),
    ("error_mm", 0),
    ("second_difference", 4),
];

/// Table 1: precision and recall of the coarse level and of both levels, percent.
pub(super) fn levels(results: &Results<'_>, reading: &Reading, level: Level) -> Outcome<String> {
    let mut out = header("| | precision, coarse | coarse + fine | recall, coarse | coarse + fine |");
    for setting in &reading.settings() {
        let cell = |name, estimate| Ok(Mean::of(&results.means(level, setting, estimate, name)?).shown(1));
        let both =
            ["precision", "recall"].into_iter().flat_map(|n| [Estimate::First, Estimate::Second].map(|e| cell(n, e)));
        row!(out, "{} | {}", setting.name(), both.collect::<Outcome<Vec<String>>>()?.join(" | "));
    }
    Ok(out)
}

/// Table 2: pairs of a setting and its opponent.
pub(super) fn pairs(results: &Results<'_>, pairs: &[(Contender, Contender)], level: Level) -> Outcome<String> {
    let mut out = header("| c2f | condensation | precision, c2f | condensation | recall, c2f | condensation |");
    for (c2f, opponent) in pairs {
        let counts = [c2f, opponent].map(|of| of.name().split([' ', ',']).nth(1).unwrap_or_default().to_owned());
        let cell = |name, of| Ok(Mean::of(&results.means(level, of, Estimate::Second, name)?).shown(1));
        let both = ["precision", "recall"].into_iter().flat_map(|name| [c2f, opponent].map(|of| cell(name, of)));
        row!(out, "{} | {}", counts.join(" | "), both.collect::<Outcome<Vec<String>>>()?.join(" | "));
    }
    Ok(out)
}

/// Everything of some contenders; the first estimate has rows of its own where it is another state.
pub(super) fn all(results: &Results<'_>, level: Level, contenders: &[Contender]) -> Outcome<String> {
    let mut out = header(
        "| | precision | recall | precision, clean | recall, clean | log likelihood | of the parts | error, mm | second difference | evaluations | ms a frame |",
    );
    for of in contenders {
        let cost = Mean::of(&results.numbers(level, of, "evaluations")?).value;
        let ms = Mean::of(&results.numbers(level, of, "ms")?).value;
        let both = [(Estimate::First, first_name(of)), (Estimate::Second, "")];
        for (estimate, what) in both.into_iter().skip(usize::from(of.is_reference())) {
            let cell = |(name, decimals)| Ok(Mean::of(&results.means(level, of, estimate, name)?).shown(decimals));
            let cells = QUANTITIES.into_iter().map(cell).collect::<Outcome<Vec<String>>>()?.join(" | ");
            row!(out, "{}{what} | {cells} | {cost:.0} | {ms:.1}", of.name());
        }
    }
    Ok(out)
}

const fn first_name(of: &Contender) -> &'static str {
    match of.method {
        Method::CoarseToFine { .. } | Method::OwnContours { .. } => ", coarse",
        _ => ", best particle",
    }
}

/// What was run, as JSON.
pub(super) fn json(configuration: &str, scene: &Scene, runs: &[Group]) -> serde_json::Value {
    let girth = |of: Girth| json!({ "trunk": of.trunk, "arms": of.arms, "legs": of.legs });
    let names = scene.tree.dof_names();
    let grid = scene.ranges.iter().zip(&names).map(|(range, name)| {
        json!({ "coordinate": name, "low": range.low, "high": range.high, "delta": range.width, "partitions": range.axis.count() })
    });
    json!({
        "configuration": configuration,
        "sequence": scene.name,
        "frames": scene.truth.len(),
        "phases": scene.phases,
        "runs": runs.iter().map(|run| json!({ "what": run.title(), "seeds": (1..=run.seeds).collect::<Vec<_>>() })).collect::<Vec<_>>(),
        "scale": scene.scale,
        "fit_mm": scene.fit_error_m.map(|error| 1e3 * error),
        "training_frames": scene.training_frames,
        "truth_within_ranges": scene.within(),
        "grid": grid.collect::<Vec<_>>(),
        "girth": {
            "printed": girth(scene.girths.printed),
            "fitted": girth(scene.girths.fitted),
            "area_ratio_before": scene.girths.ratio,
            "iou_before_and_fitted": scene.girths.iou,
        },
    })
}
