//! What the pilot found, contender by contender, and which latent model it chooses.

use super::contenders::{LATENT, Latent, REFERENCES};
use crate::support::outcome::Outcome;
use crate::support::store::{Store, numbers};
use serde_json::{Value, json};
use sinew_tests::missing_limbs::latent::Rows;
use sinew_tests::missing_limbs::{BODY, LEG};
use std::ops::Range;

/// Training sequences that are left out together: three walks and a run each.
pub(super) const FOLDS: [[usize; 4]; 2] = [[3, 9, 27, 18], [1, 13, 30, 22]];

/// The limbs.
pub(super) const LIMBS: [(&str, Range<usize>); 2] = [("leg", LEG), ("body", BODY)];

/// How one contender did on one sequence and limb.
#[derive(Clone, Debug)]
pub(super) struct Score {
    pub(super) cumulative: f64,
    pub(super) rms_deg: f64,
    /// Shares of the truth within intervals; none of a reference that gives no intervals.
    pub(super) covered: Vec<f64>,
}

impl Score {
    pub(super) fn to_json(&self) -> Value {
        json!([[self.cumulative, self.rms_deg], self.covered])
    }

    pub(super) fn from_json(value: &Value) -> Self {
        let errors = numbers(&value[0]);
        let at = |k: usize| errors.get(k).copied().unwrap_or(f64::NAN);
        Self { cumulative: at(0), rms_deg: at(1), covered: numbers(&value[1]) }
    }
}

/// Scores of one contender by fold: sequences of the fold, and of each the limbs.
pub(super) type Scores = Vec<Vec<[Score; 2]>>;

pub(super) fn key(fold: usize, name: &str) -> String {
    format!("{fold}/{name}")
}

fn scores(value: &Value) -> Vec<[Score; 2]> {
    let sequences = value.as_array().into_iter().flatten();
    sequences.map(|limbs| [0, 1].map(|k| Score::from_json(&limbs[k]))).collect()
}

/// Names of all contenders with their scores, references first, then latent models.
pub(super) struct Pilot {
    pub(super) references: Vec<(&'static str, Scores)>,
    pub(super) latent: Vec<(&'static Latent, Rows, Scores)>,
}

impl Pilot {
    pub(super) fn read(store: &Store) -> Self {
        let of = |name: &str, within: &dyn Fn(&Value) -> Value| -> Scores {
            let cells = (0..FOLDS.len()).filter_map(|f| store.get(&key(f, name)));
            cells.map(|cell| scores(&within(cell))).collect()
        };
        let references = REFERENCES.iter().map(|c| (c.name(), of(c.name(), &Value::clone))).collect();
        let ways = LATENT.iter().flat_map(|model| model.ways.iter().enumerate().map(move |way| (model, way)));
        let latent = ways.map(|(model, (k, &rows))| (model, rows, of(model.name, &|cell| cell[k].clone()))).collect();
        Self { references, latent }
    }

    /// Mean over sequences and limbs of the error divided by the error of scaled nearest neighbours.
    pub(super) fn ratio(&self, scores: &Scores) -> f64 {
        let neighbours = &self.references[1].1;
        let pairs = scores.iter().flatten().flatten().zip(neighbours.iter().flatten().flatten());
        let ratios: Vec<f64> = pairs.map(|(own, near)| own.rms_deg / near.rms_deg).collect();
        ratios.iter().sum::<f64>() / ratios.len() as f64
    }

    /// The latent model with the least ratio.
    pub(super) fn chosen(&self) -> Outcome<(&'static Latent, Rows)> {
        let better =
            |a: &&(&Latent, Rows, Scores), b: &&(&Latent, Rows, Scores)| self.ratio(&a.2).total_cmp(&self.ratio(&b.2));
        let chosen = self.latent.iter().min_by(better).ok_or("no latent model")?;
        Ok((chosen.0, chosen.1))
    }
}
