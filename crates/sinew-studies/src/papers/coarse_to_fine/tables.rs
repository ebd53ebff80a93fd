//! The paper's two tables and those beside them as Markdown, CSV and JSON.

use super::contender::{Contender, Method, Reading};
use super::results::{Estimate, Mean, Results, level_name, mean};
use super::scene::Scene;
use super::study::Group;
use crate::papers::claim::Claim;
use crate::support::outcome::Outcome;
use serde_json::json;
use sinew::observe::silhouettes::girth::Girth;
use sinew_simulate::segmentation_noise::Level;
use std::fmt::Write as _;

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

fn shown(of: Mean, decimals: usize) -> String {
    format!("{:.decimals$} ± {:.decimals$}", of.value, of.error)
}

/// Table 1: precision and recall of the coarse level and of both levels, percent.
pub(super) fn levels(results: &Results<'_>, reading: &Reading, level: Level) -> Outcome<String> {
    let mut out = String::from(
        "| | precision, coarse | coarse + fine | recall, coarse | coarse + fine |\n|---|---|---|---|---|\n",
    );
    for setting in &reading.settings() {
        let mut row = format!("| {} |", setting.name());
        for name in ["precision", "recall"] {
            for estimate in [Estimate::First, Estimate::Second] {
                let _ = write!(row, " {} |", shown(mean(&results.means(level, setting, estimate, name)?), 1));
            }
        }
        let _ = writeln!(out, "{row}");
    }
    Ok(out)
}

/// Table 2: pairs of a setting and its opponent.
pub(super) fn pairs(results: &Results<'_>, pairs: &[(Contender, Contender)], level: Level) -> Outcome<String> {
    let mut out = String::from(
        "| c2f | condensation | precision, c2f | condensation | recall, c2f | condensation |\n|---|---|---|---|---|---|\n",
    );
    for (c2f, opponent) in pairs {
        let counts = [c2f, opponent].map(|of| of.name().split([' ', ',']).nth(1).unwrap_or_default().to_owned());
        let mut row = format!("| {} | {} |", counts[0], counts[1]);
        for name in ["precision", "recall"] {
            for of in [c2f, opponent] {
                let _ = write!(row, " {} |", shown(mean(&results.means(level, of, Estimate::Second, name)?), 1));
            }
        }
        let _ = writeln!(out, "{row}");
    }
    Ok(out)
}

/// Everything of some contenders; the first estimate has rows of its own where it is another state.
pub(super) fn all(results: &Results<'_>, level: Level, contenders: &[Contender]) -> Outcome<String> {
    let mut out = String::from(
        "| | precision | recall | precision, clean | recall, clean | log likelihood | of the parts | error, mm | second difference | evaluations | ms a frame |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for of in contenders {
        let cost = mean(&results.numbers(level, of, "evaluations")?).value;
        let ms = mean(&results.numbers(level, of, "ms")?).value;
        let both = [(Estimate::First, first_name(of)), (Estimate::Second, "")];
        for (estimate, what) in both.into_iter().skip(usize::from(of.is_reference())) {
            let mut row = format!("| {}{what} |", of.name());
            for (name, decimals) in QUANTITIES {
                let _ = write!(row, " {} |", shown(mean(&results.means(level, of, estimate, name)?), decimals));
            }
            let _ = writeln!(out, "{row} {cost:.0} | {ms:.1} |");
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

/// First line of the CSV.
pub(super) const CSV: &str = "level,contender,estimate,quantity,mean,se,seeds\n";

/// The same as CSV.
pub(super) fn csv(results: &Results<'_>, level: Level, contenders: &[Contender]) -> Outcome<String> {
    let mut out = String::new();
    for of in contenders {
        for estimate in [Estimate::First, Estimate::Second] {
            for (name, _) in QUANTITIES {
                let Mean { value, error } = mean(&results.means(level, of, estimate, name)?);
                let (level, seeds) = (level_name(level), results.seeds.len());
                let _ = writeln!(out, "{level},\"{}\",{estimate:?},{name},{value:.5},{error:.5},{seeds}", of.name());
            }
        }
    }
    Ok(out)
}

/// What was run, and the claims, as JSON.
pub(super) fn json(
    configuration: &str,
    scene: &Scene,
    claims: &[(Reading, Vec<Claim>)],
    runs: &[Group],
) -> serde_json::Value {
    let girth = |of: Girth| json!({ "trunk": of.trunk, "arms": of.arms, "legs": of.legs });
    let claim =
        |c: &Claim| json!({ "id": c.id, "paper": c.paper, "ours": c.ours, "criterion": c.criterion, "pass": c.pass });
    let judged = |(reading, claims): &(Reading, Vec<Claim>)| json!({ "reading": reading.title(), "claims": claims.iter().map(claim).collect::<Vec<_>>() });
    let names = scene.tree.dof_names();
    let grid = scene.ranges.iter().zip(&names).map(|(range, name)| {
        json!({ "coordinate": name, "low": range.low, "high": range.high, "delta": range.width, "partitions": range.axis.count() })
    });
    json!({
        "configuration": configuration,
        "sequence": scene.name,
        "frames": scene.truth.len(),
        "phases": scene.phases,
        "runs": runs.iter().map(|run| json!({ "what": run.title(), "seeds": run.seeds })).collect::<Vec<_>>(),
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
        "claims": claims.iter().map(judged).collect::<Vec<_>>(),
    })
}
