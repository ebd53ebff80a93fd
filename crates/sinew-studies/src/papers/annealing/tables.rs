//! What was found, as Markdown and CSV.

use super::expectations::{Expectation, errors};
use super::film::SCORES;
use super::schemes::{CASES, SCHEMES, over_multinomial};
use super::study::{Part, Study};
use crate::papers::interval_tally::LEVELS;
use crate::support::outcome::Outcome;
use crate::support::statistics::verdict;
use crate::support::store::numbers;
use crate::support::table::{header, row};
use serde_json::Value;
use sinew_tests::finding::mean_and_error;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// The expectations as a table.
pub(super) fn expectations(all: &[Expectation]) -> String {
    let mut out = header("| | expected | criterion | found | |");
    for Expectation { id, what, criterion, ours, holds } in all {
        row!(out, "{id} | {what} | {criterion} | {ours} | {}", verdict(*holds));
    }
    out
}

fn coverage(study: &Study) -> Outcome<String> {
    let mut out = String::from("dim,contender,level,covered,covered_se,sd_over_exact,mean_off_exact_sds\n");
    for &dim in &study.size.dims {
        for (name, _) in study.contenders() {
            let found = study.covered(&name, dim)?;
            for (level, [share, error]) in LEVELS.iter().zip(&found) {
                let name = name.replace(',', "");
                let _ =
                    writeln!(out, "{dim},{name},{level},{share:.4},{error:.4},{:.3},{:.3}", found[4][0], found[5][0]);
            }
        }
    }
    Ok(out)
}

fn partitions(study: &Study) -> Outcome<String> {
    let mut out = String::from(
        "alpha,parts,particles_at_once,parts_evaluated_at_once,particles_apart,parts_evaluated_apart,law\n",
    );
    for (rate, most) in study.rates() {
        let [at_once, apart] = ["at_once", "apart"].map(|how| study.needed(rate, most, how));
        for (k, ([a, b], [c, d])) in at_once?.into_iter().zip(apart?).enumerate() {
            let law = super::partitions::WANTED * rate.powi(-(k as i32 + 1));
            let _ = writeln!(out, "{rate},{},{a:.0},{b:.0},{c:.0},{d:.0},{law:.0}", k + 1);
        }
    }
    Ok(out)
}

fn schemes(study: &Study) -> Outcome<String> {
    let mut out = String::from("case,scheme,variance_over_multinomial,se\n");
    for (case, name) in CASES.iter().enumerate() {
        for (scheme, [value, error]) in SCHEMES.iter().zip(over_multinomial(&study.scheme_rows(case)?)) {
            let _ = writeln!(out, "{},{scheme:?},{value:.4},{error:.4}", name.replace(',', ""));
        }
    }
    Ok(out)
}

/// Mean of a number of the cells.
fn average(cells: &[&Value], of: impl Fn(&Value) -> f64) -> f64 {
    cells.iter().map(|cell| of(cell)).sum::<f64>() / cells.len() as f64
}

fn film(study: &Study) -> Outcome<String> {
    let mut out = String::from(
        "score,sweep,setting,evaluations,part_evaluations,relative_mm,relative_se,absolute_mm,absolute_se,largest_seed_mm,frames_beyond_250_mm,last_exponent,least_survivors,ms_a_frame\n",
    );
    for (score, _) in SCORES {
        for row in study.rows.iter().filter(|row| row.is_run_with(score)) {
            let relative = errors(study, score, &row.method, "relative")?;
            let [[r, r_error], [a, a_error]] =
                [mean_and_error(&relative), mean_and_error(&errors(study, score, &row.method, "absolute")?)];
            let cells = study.filmed(score, &row.method)?;
            let number = |name: &str| average(&cells, |cell| cell[name].as_f64().unwrap_or(f64::NAN));
            let lost = |cell: &Value| {
                let all = numbers(&cell["relative"]);
                all.iter().filter(|error| **error > 250.0).count() as f64 / all.len() as f64
            };
            let last = |cell: &Value| numbers(&cell["exponents"]).last().copied().unwrap_or(f64::NAN);
            let least = |cell: &Value| numbers(&cell["survivors"]).into_iter().fold(f64::NAN, f64::min);
            let _ = writeln!(
                out,
                "{score},{},{},{:.0},{:.0},{r:.2},{r_error:.2},{a:.2},{a_error:.2},{:.2},{:.3},{:.1},{:.1},{:.1}",
                row.sweep,
                row.name.replace(',', ""),
                number("evaluations"),
                number("part_evaluations"),
                relative.iter().copied().fold(0.0, f64::max),
                average(&cells, lost),
                average(&cells, last),
                average(&cells, least),
                1e3 * number("seconds"),
            );
        }
    }
    Ok(out)
}

/// Writes the tables of what was run; others stay as they are.
pub(super) fn write(study: &Study, judged: &[Expectation], folder: &Path) -> Outcome<()> {
    type Table = fn(&Study) -> Outcome<String>;
    let tables: [(Part, &str, Table); 4] = [
        (Part::Coverage, "coverage.csv", coverage),
        (Part::Partitions, "partitions.csv", partitions),
        (Part::Schemes, "schemes.csv", schemes),
        (Part::Film, "film.csv", film),
    ];
    for (part, name, table) in tables {
        if study.wanted(part) {
            fs::write(folder.join(name), table(study)?)?;
        }
    }
    fs::write(folder.join("expectations.md"), expectations(judged))?;
    Ok(())
}
