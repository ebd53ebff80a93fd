//! What was expected before anything was run, and what came: criteria are not moved after a run.
//!
//! Sweeps on the film are judged on the bidirectional score by the error from the pelvis, paired by seeds; a difference holds where it is beyond a number of its standard errors over the seeds.

use super::coverage::{SEARCHES, SHOWN};
use super::film::{Method, SCORES, annealed};
use super::partitions;
use super::schemes::{CASES, SCHEMES};
use super::study::{Part, Study};
use crate::support::outcome::Outcome;
use crate::support::statistics::mean;
use crate::support::store::numbers;
use sinew::samplers::annealed_search;
use sinew::tracking::annealed::Config;
use sinew_tests::finding::{mean_and_error, ratio_of_means};
use std::fmt::Write as _;

/// An expectation and what became of it.
pub(super) struct Expectation {
    pub(super) id: &'static str,
    pub(super) what: &'static str,
    pub(super) criterion: &'static str,
    pub(super) ours: String,
    pub(super) holds: bool,
}

/// Errors of a method on the film, the mean over the frames of each seed, millimetres.
pub(super) fn errors(study: &Study, score: &str, method: &Method, which: &str) -> Outcome<Vec<f64>> {
    Ok(study.filmed(score, method)?.into_iter().map(|value| mean(numbers(&value[which]))).collect())
}

/// Errors from the pelvis beyond which the walk is not tracked in a reduced run, millimetres.
const TRACKED_MM: f64 = 150.0;

/// What a reduced run asserts and does not find: expectation E3, looser forms of E1 and E2 since its series are few, and that every setting tracks the walk.
pub(super) fn reduced(study: &Study, judged: &[Expectation]) -> Outcome<Vec<String>> {
    let asserted = judged.iter().filter(|e| e.id == "E3" && !e.holds);
    let mut failed: Vec<String> = asserted.map(|e| format!("{}: {}", e.id, e.what)).collect();
    if study.wanted(Part::Coverage) {
        let (ours, shares) = coverage(study, SEARCHES..SHOWN)?;
        if !shares.iter().all(|share| *share < 0.8) {
            failed.push(format!("annealed sets below 80 %: {ours}"));
        }
        let (ours, shares) = coverage(study, 0..SEARCHES)?;
        if !shares.iter().all(|share| (0.8..=0.98).contains(share)) {
            failed.push(format!("filters within 80–98 %: {ours}"));
        }
    }
    if study.wanted(Part::Film) {
        for (score, _) in SCORES {
            for row in study.rows.iter().filter(|row| row.is_run_with(score)) {
                let found = errors(study, score, &row.method, "relative")?;
                if !found.iter().all(|error| *error < TRACKED_MM) {
                    failed.push(format!("{} {score} within {TRACKED_MM} mm: {found:.0?}", row.name));
                }
            }
        }
    }
    Ok(failed)
}

/// Coverage of the nominal 90 % intervals of contenders, by dimension.
fn coverage(study: &Study, of: std::ops::Range<usize>) -> Outcome<(String, Vec<f64>)> {
    let (mut text, mut all) = (String::new(), vec![]);
    for (name, _) in &study.contenders()[of] {
        let shares = study.size.dims.iter().map(|&dim| Ok(study.covered(name, dim)?[2][0]));
        let shares: Vec<f64> = shares.collect::<Outcome<_>>()?;
        let shown: Vec<String> = shares.iter().map(|share| format!("{:.0}", 100.0 * share)).collect();
        let _ = write!(text, "{}{name}: {} %", if text.is_empty() { "" } else { "; " }, shown.join(", "));
        all.extend(shares);
    }
    Ok((text, all))
}

fn judge_coverage(study: &Study, out: &mut Vec<Expectation>) -> Outcome<()> {
    let (ours, shares) = coverage(study, SEARCHES..SHOWN)?;
    out.push(Expectation {
        id: "E1",
        what: "the weighted set of an annealed search is too narrow",
        criterion: "nominal 90 % intervals hold the truth in less than 70 %, four settings, every dimension",
        holds: shares.iter().all(|share| *share < 0.7),
        ours,
    });
    let (ours, shares) = coverage(study, 0..SEARCHES)?;
    out.push(Expectation {
        id: "E2",
        what: "the sets of filters are not",
        criterion: "nominal 90 % intervals hold the truth in 87–93 %, both filters, every dimension",
        holds: shares.iter().all(|share| (0.87..=0.93).contains(share)),
        ours,
    });
    Ok(())
}

fn judge_partitions(study: &Study, out: &mut Vec<Expectation>) -> Outcome<()> {
    let (mut ours, mut holds) = (String::new(), true);
    for (rate, most) in study.rates() {
        let slope = |how: &str| -> Outcome<f64> {
            let needed: Vec<f64> = study.needed(rate, most, how)?.into_iter().map(|[particles, _]| particles).collect();
            Ok(partitions::slope(rate, &needed))
        };
        let (at_once, apart) = (slope("at_once")?, slope("apart")?);
        holds &= (0.9..=1.1).contains(&at_once) && apart.abs() <= 0.1;
        let join = if ours.is_empty() { "" } else { "; " };
        let _ = write!(ours, "{join}α = {rate}: {at_once:.3} at once, {apart:.3} part by part");
    }
    out.push(Expectation {
        id: "E3",
        what: "all at once particles grow as α^(−d) with the number of parts, part by part not at all",
        criterion: "slope of log N over d in units of −log α: 0.9–1.1 at once, within 0.1 of 0 part by part",
        ours,
        holds,
    });
    Ok(())
}

fn judge_schemes(study: &Study, out: &mut Vec<Expectation>) -> Outcome<()> {
    let (mut ours, mut holds) = (String::new(), true);
    for (case, name) in CASES.iter().enumerate() {
        let rows = study.scheme_rows(case)?;
        let _ = write!(ours, "{}{name}: ", if case == 0 { "" } else { "; " });
        for (top, bottom) in [(0, 1), (1, 3), (2, 3)] {
            let [value, error] = ratio_of_means(&rows, top, bottom);
            holds &= value <= 1.0 + 2.0 * error;
            let [top, bottom] = [top, bottom].map(|k| format!("{:?}", SCHEMES[k]).to_lowercase());
            let _ = write!(ours, "{top}/{bottom} {value:.3} ± {error:.3}, ");
        }
        ours.truncate(ours.len() - 2);
    }
    out.push(Expectation {
        id: "E4",
        what: "variances are ordered: systematic ≤ stratified ≤ multinomial, residual ≤ multinomial",
        criterion: "each ratio at most 1 + 2 SE, all three cases",
        ours,
        holds,
    });
    Ok(())
}

/// Pairs of settings with the allowed excess of the first over the second, in standard errors: 1 forgives, −2 demands.
type Pairs = Vec<(&'static str, Method, &'static str, Method)>;

fn compared(study: &Study, pairs: Pairs, slack: f64) -> Outcome<(String, bool)> {
    let (mut ours, mut holds) = (String::new(), true);
    for (a_name, a, b_name, b) in pairs {
        let [a, b] = [a, b].map(|method| errors(study, "bidirectional", &method, "relative"));
        let (a, b) = (a?, b?);
        let [difference, error] = mean_and_error(&a.iter().zip(&b).map(|(a, b)| a - b).collect::<Vec<_>>());
        holds &= difference <= slack * error;
        let join = if ours.is_empty() { "" } else { "; " };
        let _ =
            write!(ours, "{join}{a_name} {:.1}, {b_name} {:.1}: {difference:+.1} ± {error:.1} mm", mean(&a), mean(&b));
    }
    Ok((ours, holds))
}

fn judge_film(study: &Study, out: &mut Vec<Expectation>) -> Outcome<()> {
    let of = |layers, particles, survival| Method::Annealed(annealed(layers, particles, survival));
    let variant = |adaptive: bool, crossover: f64| {
        let plain = Config::default();
        Method::Annealed(Config { layers: annealed_search::Config { adaptive, crossover, ..plain.layers }, ..plain })
    };
    let plain = || Method::Annealed(Config::default());
    let mut add = |id, what, criterion, pairs: Pairs, slack: f64| -> Outcome<()> {
        let (ours, holds) = compared(study, pairs, slack)?;
        out.push(Expectation { id, what, criterion, ours, holds });
        Ok(())
    };
    let one = || of(1, 1000, 0.5);
    add(
        "E5",
        "at 1000 evaluations layers are better than one",
        "error lower by more than 2 SE, both",
        vec![("5 × 200", of(5, 200, 0.5), "1 × 1000", one()), ("10 × 100", of(10, 100, 0.5), "1 × 1000", one())],
        -2.0,
    )?;
    let half = || of(10, 200, 0.5);
    add(
        "E6",
        "a survival rate of ½ is no worse than the ends of the sweep",
        "error not higher by more than 1 SE, both",
        vec![("α = 0.5", half(), "α = 0.2", of(10, 200, 0.2)), ("α = 0.5", half(), "α = 0.8", of(10, 200, 0.8))],
        1.0,
    )?;
    add(
        "E7",
        "soft partitions, crossover and both do not harm",
        "error not higher than that of plain layers by more than 1 SE, all three",
        vec![
            ("crossover", variant(false, 0.5), "plain", plain()),
            ("soft partitions", variant(true, 0.0), "plain", plain()),
            ("both", variant(true, 0.5), "plain", plain()),
        ],
        1.0,
    )?;
    let [balan, raskin] = [Config::balan(), Config::raskin()].map(Method::Annealed);
    add(
        "E8",
        "more evaluations are no worse: 10 × 200, 5 × 200, 5 × 100",
        "error not higher than the next's by more than 1 SE, both",
        vec![("10 × 200", plain(), "5 × 200", balan.clone()), ("5 × 200", balan, "5 × 100", raskin)],
        1.0,
    )?;
    add(
        "E9",
        "annealing is better than a bootstrap filter of as many evaluations",
        "error lower by more than 2 SE",
        vec![("10 × 200", plain(), "bootstrap", Method::Bootstrap(2000))],
        -2.0,
    )?;
    out.push(both_directions(study, &plain())?);
    Ok(())
}

/// Expectation E10: silhouettes compared in both directions against one.
fn both_directions(study: &Study, plain: &Method) -> Outcome<Expectation> {
    let [one, two] = ["one-sided", "bidirectional"].map(|score| errors(study, score, plain, "relative"));
    let (one, two) = (one?, two?);
    let [difference, error] = mean_and_error(&two.iter().zip(&one).map(|(a, b)| a - b).collect::<Vec<_>>());
    Ok(Expectation {
        id: "E10",
        what: "silhouettes compared in both directions are better than in one",
        criterion: "error of 10 × 200 lower by more than 2 SE",
        ours: format!("bidirectional {:.1}, one-sided {:.1}: {difference:+.1} ± {error:.1} mm", mean(&two), mean(&one)),
        holds: difference <= -2.0 * error,
    })
}

/// Judges what was run.
pub(super) fn judge(study: &Study) -> Outcome<Vec<Expectation>> {
    let mut out = vec![];
    if study.wanted(Part::Coverage) {
        judge_coverage(study, &mut out)?;
    }
    if study.wanted(Part::Partitions) {
        judge_partitions(study, &mut out)?;
    }
    if study.wanted(Part::Schemes) {
        judge_schemes(study, &mut out)?;
    }
    if study.wanted(Part::Film) && study.size.sweeps.len() > 1 {
        judge_film(study, &mut out)?;
    }
    Ok(out)
}
