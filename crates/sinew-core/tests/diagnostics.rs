//! Diagnostics of stored chains against the numbers of ArviZ (`tests/data/chains_by_arviz.py` made both).

use serde_json::Value;
use sinew_core::diagnostics::{
    bulk_ess, effective_sample_size, energy_fraction, mcse_of_mean, rank_r_hat, split_r_hat, tail_ess,
};

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

#[test]
fn diagnostics_match_arviz() {
    let cases: Value = serde_json::from_str(include_str!("data/chains_by_arviz.json")).unwrap();
    let cases = cases.as_array().unwrap();
    assert_eq!(cases.len(), 9);
    for case in cases {
        let chains: Vec<Vec<f64>> = case["chains"].as_array().unwrap().iter().map(numbers).collect();
        let name = case["name"].as_str().unwrap();
        let all = chains.concat();
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        let variance = all.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (all.len() - 1) as f64;
        // ArviZ's standard error is √(variance / effective sample size of the mean).
        let worth = variance / case["mcse_of_mean"].as_f64().unwrap().powi(2);
        let found = effective_sample_size(&chains);
        assert!((found / worth - 1.0).abs() < 1e-6, "{name}, effective sample size: {found}, ArviZ has {worth}");
        for (what, found) in [
            ("rank_r_hat", rank_r_hat(&chains)),
            ("split_r_hat", split_r_hat(&chains)),
            ("bulk_ess", bulk_ess(&chains)),
            ("tail_ess", tail_ess(&chains)),
            ("mcse_of_mean", mcse_of_mean(&chains)),
        ] {
            let Some(expected) = case[what].as_f64() else {
                assert_eq!(
                    (chains.len(), found.is_finite()),
                    (1, true),
                    "ArviZ gives no R-hat of one chain, ours is that of its halves"
                );
                continue;
            };
            assert!((found / expected - 1.0).abs() < 1e-6, "{name}, {what}: {found}, ArviZ has {expected}");
        }
        for (chain, expected) in chains.iter().zip(numbers(&case["energy_fraction"])) {
            let found = energy_fraction(chain);
            assert!((found / expected - 1.0).abs() < 1e-6, "{name}, E-BFMI: {found}, ArviZ has {expected}");
        }
    }
}
