//! What stored cells say: curves of variance against cost, and volumes of posteriors.

use super::chains::Variant;
use super::problem::Model;
use super::scene::Source;
use super::single::Setting;
use super::study::{Study, cell_key, factor_key, reference_key};
use crate::support::outcome::Outcome;
use crate::support::statistics::{mean as average, median};
use crate::support::store::{Store, numbers, rows};
use serde_json::Value;
use sinew_tests::evaluation::equal_variance::Cell;
use sinew_tests::evaluation::volumes::log10_volume_ratios;

/// A cell from what was stored, the mean of the reference, and the cost of a gradient in likelihoods.
fn cell(value: &Value, mean: &[f64], factor: f64) -> Cell {
    let number = |name: &str| value[name].as_f64().unwrap_or(f64::NAN);
    let square = |run: &Vec<f64>| run.iter().zip(mean).map(|(a, b)| (a - b).powi(2)).collect();
    Cell {
        seconds: number("seconds"),
        units: number("likelihoods") + factor * number("gradients"),
        squares: rows(&value["means"]).iter().map(square).collect(),
        effective: median(numbers(&value["effective"])),
        acceptance: average(numbers(&value["acceptance"])),
    }
}

/// Stored cells by their keys; the reference and the cost of a gradient are kept in `base`.
pub(super) fn cells(
    [base, store]: [&Store; 2],
    [reference, factor]: [&str; 2],
    keys: impl Iterator<Item = String>,
) -> Outcome<Vec<Cell>> {
    let mean = numbers(&base.get(reference).ok_or("a reference is missing")?["mean"]);
    let factor = base.get(factor).and_then(Value::as_f64).ok_or("a gradient factor is missing")?;
    let of = |key: String| Ok(cell(store.get(&key).ok_or(format!("the cell {key} is missing"))?, &mean, factor));
    keys.map(of).collect()
}

/// The cells of one contender in one frame, by rising cost.
pub(super) fn curve(
    study: &Study,
    store: &Store,
    source: Source,
    frame: usize,
    model: &Model,
    of: Option<Variant>,
) -> Outcome<Vec<Cell>> {
    let belongs = |setting: &Setting| match setting {
        Setting::Particles(_) => of.is_none(),
        Setting::Updates(variant, _) => of == Some(*variant),
    };
    let keys = study.settings(model).into_iter().filter(belongs).map(|of| cell_key(source, frame, model, &of));
    cells([store; 2], [&reference_key(source, frame, model), &factor_key(model)], keys)
}

/// Slope of log variance against log R from R = 32 on.
pub(super) fn slope(study: &Study, cells: &[Cell]) -> f64 {
    let points: Vec<(f64, f64)> = study
        .size
        .doublings
        .iter()
        .zip(cells)
        .filter(|(doubling, _)| **doubling >= 2)
        .map(|(doubling, cell)| (f64::from(*doubling) * std::f64::consts::LN_2, cell.log_mean()))
        .collect();
    let n = points.len() as f64;
    let [x, y] = [points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n];
    points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

/// Base-ten logarithms of the volume ratio of prior and posterior: by marginal standard deviations and by determinants.
pub(super) fn volumes(
    store: &Store,
    source: Source,
    frame: usize,
    model: &Model,
    prior_sd: &[f64],
) -> Outcome<[f64; 2]> {
    let reference = store.get(&reference_key(source, frame, model)).ok_or("a reference is missing")?;
    Ok(volumes_of(reference, prior_sd))
}

/// The same of a reference.
pub(super) fn volumes_of(reference: &Value, prior_sd: &[f64]) -> [f64; 2] {
    log10_volume_ratios(&numbers(&reference["covariance"]), prior_sd)
}
