//! Numbers of a summary against those of ArviZ for stored chains (`tests/data/summary_by_arviz.py` made both), and its words.

use serde_json::Value;
use sinew_samplers::Run;
use sinew_samplers::summary::RunWarning;

fn numbers(value: &Value) -> Vec<f64> {
    let number = |x: &Value| x.as_f64().map_or_else(|| numbers(x), |x| vec![x]);
    value.as_array().expect("array").iter().flat_map(number).collect()
}

fn stored() -> (Value, Run) {
    let stored: Value = serde_json::from_str(include_str!("data/summary_by_arviz.json")).expect("JSON");
    let names = vec!["slow".into(), "skew".into()];
    let mut run = Run::from_chains(names, 3, numbers(&stored["chains"])).expect("three chains of 60 draws");
    run.stats.iter_mut().zip(numbers(&stored["energy"])).for_each(|(stat, energy)| stat.energy = energy);
    (stored, run)
}

#[test]
fn a_summary_has_the_numbers_of_arviz() {
    let (stored, run) = stored();
    let summary = run.summary();
    let near = |what: &str, found: f64, expected: &Value| {
        let expected = expected.as_f64().expect("number");
        assert!((found / expected - 1.0).abs() < 1e-6, "{what}: {found}, ArviZ has {expected}");
    };
    for row in &summary.rows {
        let expected = &stored["summary"][&row.name];
        for (column, found) in [
            ("mean", row.mean),
            ("sd", row.sd),
            ("mcse_mean", row.mcse),
            ("ess_bulk", row.bulk_ess),
            ("ess_tail", row.tail_ess),
            ("r_hat", row.r_hat),
        ] {
            near(&format!("{column} of {}", row.name), found, &expected[column]);
        }
    }
    for (found, expected) in summary.energy_fraction.iter().zip(stored["bfmi"].as_array().expect("array")) {
        near("E-BFMI", *found, expected);
    }
}

#[test]
fn draws_that_disagree_are_warned_of() {
    let (_, mut run) = stored();
    run.stats.iter_mut().step_by(2).for_each(|stat| stat.divergent = true);
    run.stats[0].depth = 10;
    run.max_depth = 10;
    let summary = run.summary();
    assert!(!summary.holds());
    assert_eq!(summary.warnings.len(), 5, "{summary}");
    assert_eq!(summary.warnings[0], RunWarning::Divergences { count: 90, draws: 180 });
    assert_eq!(summary.warnings[1], RunWarning::GreatestDepth { count: 1, draws: 180 });
    assert!(matches!(&summary.warnings[3], RunWarning::RHat { name, .. } if name == "slow"));
    let text = summary.to_string();
    for words in [
        "          mean        sd      mcse  bulk ESS  tail ESS     R-hat",
        "slow   -0.0541     1.582    0.4734        11        43     1.226",
        "skew     111.2     60.10     4.803       170       167     1.004",
        "3 chains of 60 draws, acceptance 1.00, 0 gradients, 90 divergences, E-BFMI at least 0.12",
        "does not hold: 90 of 180 trajectories diverged (50.0 %)",
        "does not hold: slow has 11 effective draws, and 300 are needed",
    ] {
        assert!(text.contains(words), "{words:?} is missing in\n{text}");
    }
}

/// Chains that stand still have no R̂; that is no agreement.
#[test]
fn chains_that_never_move_do_not_hold() {
    let summary = Run::from_chains(vec!["x".into()], 2, vec![1.0; 100]).expect("two chains").summary();
    assert!(matches!(&summary.warnings[..], [RunWarning::RHat { value, .. }, ..] if value.is_nan()), "{summary}");
}
