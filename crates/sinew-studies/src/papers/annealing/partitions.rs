//! How many particles a survival diagnostic needs as the number of parts grows.
//!
//! All parts at once against one after the other.
//!
//! Prior N(0, 1) and posterior N(0, σ²) in each of d coordinates, σ² = 1 − √(1 − α²), so that a part's survival rate is α = [∫ p'² / p]⁻¹. All at once N particles leave D ≈ α^d N, part by part D ≈ α N in each part
//! (MacCormick & Isard 2000). In a body of one part a fifth of the particles survives; wanted here is the same number of survivors whatever d: D = 20 % of 1000. N is searched for by doubling, with the mean of D over
//! runs interpolated between the two sizes on either side.

use crate::support::outcome::Outcome;
use serde_json::{Value, json};
use sinew::core::density::{LogDensity, PartLogDensity};
use sinew::core::lanes::{Block, Isa};
use sinew::core::part::{Part, PartTree, Partition};
use sinew::core::random::Stage;
use sinew::dynamics::random_walk::{Between, RandomWalk};
use sinew::tracking::Tracker;
use sinew::tracking::bootstrap::{self, Bootstrap};
use sinew::tracking::partitioned::{self, Partitioned};

/// Survivors that are wanted: 20 % of 1000.
pub(super) const WANTED: f64 = 200.0;
/// Survival rates of a part, each with the largest number of parts.
pub(super) const RATES: [(f64, usize); 2] = [(0.4, 8), (0.2, 5)];

/// log N(0; x, precision⁻¹) for each coordinate, up to constants.
struct Peak {
    dim: usize,
    precision: f64,
}

impl Peak {
    fn at(&self, x: &Block) -> Block {
        Block(x.0.map(|x| -0.5 * self.precision * x * x))
    }
}

impl LogDensity for Peak {
    fn dim(&self) -> usize {
        self.dim
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        x.iter().map(|x| -0.5 * self.precision * x * x).sum()
    }
    fn log_density_block(&self, x: &[Block], _ws: &mut [Block]) -> Block {
        let mut sum = Block::ZERO;
        for x in x {
            sum.0.iter_mut().zip(self.at(x).0).for_each(|(sum, value)| *sum += value);
        }
        sum
    }
}

impl PartLogDensity for Peak {
    fn parts(&self) -> usize {
        self.dim
    }
    fn is_product(&self) -> bool {
        true
    }
    fn log_density_parts_block(&self, parts: &[usize], x: &[Block], out: &mut [Block], _ws: &mut [Block]) {
        parts.iter().zip(out).for_each(|(&k, out)| *out = self.at(&x[k]));
    }
}

fn tree(dim: usize) -> Outcome<PartTree> {
    let parts = (0..dim).map(|j| Part::new(vec![j], dim)).collect::<Result<Vec<_>, _>>()?;
    Ok(PartTree::new(Partition::new(parts, dim)?, (0..dim).map(|k| k.checked_sub(1)).collect())?)
}

/// Particles that are needed for [`WANTED`] survivors, by a function from their number to the mean of D.
fn needed(mut survivors: impl FnMut(usize) -> Outcome<f64>) -> Outcome<f64> {
    let mut before: Option<[f64; 2]> = None;
    for doubling in 0.. {
        let count = 400_usize << doubling;
        let here = [count as f64, survivors(count)?].map(f64::ln);
        if here[1] >= WANTED.ln() {
            let Some(low) = before else { return Ok(here[0].exp()) };
            let part = (WANTED.ln() - low[1]) / (here[1] - low[1]);
            return Ok((low[0] + part * (here[0] - low[0])).exp());
        }
        before = Some(here);
        if count > 1 << 23 {
            break;
        }
    }
    Err("too many particles are needed".into())
}

/// One number of parts at a rate: particles and evaluations of parts that are needed, at once and part by part.
pub(super) fn cell(rate: f64, dim: usize, runs: usize, stage: &Stage) -> Outcome<Value> {
    let variance = 1.0 - (1.0 - rate * rate).sqrt();
    let peak = Peak { dim, precision: 1.0 / variance - 1.0 };
    let walk = RandomWalk::new(&vec![1.0; dim], 1.0, Between::Mixture, Isa::best())?;
    let tree = tree(dim)?;
    let mean = |of: &dyn Fn(Stage) -> Outcome<f64>| -> Outcome<f64> {
        let all: Vec<f64> = (0..runs).map(|run| of(stage.round(run))).collect::<Outcome<_>>()?;
        Ok(all.iter().sum::<f64>() / runs as f64)
    };
    let at_once = needed(|particles| {
        mean(&|stage| {
            let config = bootstrap::Config { particles, ..bootstrap::Config::default() };
            Ok(Bootstrap::new(config, walk.clone(), vec![0.0; dim])?.step(&peak, stage)?.ess)
        })
    })?;
    let apart = needed(|particles| {
        mean(&|stage| {
            let config = partitioned::Config { particles, ..partitioned::Config::default() };
            let mut filter = Partitioned::new(config, walk.clone(), tree.clone(), vec![0.0; dim])?;
            let info = filter.step(&peak, stage)?;
            Ok(info.survivors.into_iter().fold(f64::INFINITY, f64::min))
        })
    })?;
    let parts = dim as f64;
    Ok(json!({ "at_once": [at_once, parts * at_once], "apart": [apart, parts * apart] }))
}

/// Slope of log N over the number of parts, in units of −log α: 1 is the law, 0 is flat.
pub(super) fn slope(rate: f64, needed: &[f64]) -> f64 {
    let middle = 0.5 * (needed.len() as f64 + 1.0);
    let across: Vec<f64> = (1..=needed.len()).map(|d| d as f64 - middle).collect();
    let top: f64 = across.iter().zip(needed).map(|(d, n)| d * n.ln()).sum();
    top / across.iter().map(|d| d * d).sum::<f64>() / -rate.ln()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_search_finds_what_a_law_needs_and_the_slope_is_the_laws() {
        let law = |d: i32| needed(|n| Ok(n as f64 * 0.3_f64.powi(d))).unwrap();
        let all: Vec<f64> = (1..5).map(law).collect();
        assert!((all[2] - WANTED / 0.027).abs() < 1e-6 * all[2], "{all:?}");
        assert!((slope(0.3, &all) - 1.0).abs() < 1e-9);
        assert!(slope(0.3, &[7.0; 5]).abs() < 1e-12);
    }
}
