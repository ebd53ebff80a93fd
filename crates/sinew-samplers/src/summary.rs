//! Summary of a run: mean, deviation, effective sample sizes and R̂ of every coordinate, and what speaks against the draws.
//!
//! The numbers are ArviZ's ([`crate::diagnostics`]). What is warned of are Stan's rules: divergences, trees at their greatest depth, E-BFMI below 0.3, R̂ above 1.01, effective sample sizes below 100 a chain.

use crate::chains::ChainStat;
use crate::diagnostics::{bulk_ess, energy_fraction, mcse_of_mean, rank_r_hat, tail_ess};
use crate::run::Run;
use std::fmt;

/// Largest R̂ of chains that agree.
pub const MOST_R_HAT: f64 = 1.01;
/// Smallest effective sample size a chain.
pub const LEAST_ESS: f64 = 100.0;
/// Smallest E-BFMI of a chain.
pub const LEAST_ENERGY_FRACTION: f64 = 0.3;

/// One coordinate.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Row {
    /// Its name.
    pub name: String,
    /// Mean of all draws.
    pub mean: f64,
    /// Standard deviation of all draws, with N − 1.
    pub sd: f64,
    /// Monte Carlo standard error of the mean.
    pub mcse: f64,
    /// Effective sample size of the bulk.
    pub bulk_ess: f64,
    /// Effective sample size of the tails.
    pub tail_ess: f64,
    /// Rank-normalised split R̂.
    pub r_hat: f64,
}

/// Something that speaks against the draws.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// Trajectories diverged: where the density bends too strongly for the step size, draws are missing.
    Divergences {
        /// How many.
        count: usize,
        /// Of how many draws.
        draws: usize,
    },
    /// Trees were cut at their greatest depth: slow, not wrong.
    GreatestDepth {
        /// How many.
        count: usize,
        /// Of how many draws.
        draws: usize,
    },
    /// Momenta explore the energies slowly: tails may be missing.
    EnergyFraction {
        /// The lowest E-BFMI of a chain.
        least: f64,
    },
    /// Chains do not agree.
    RHat {
        /// The coordinate with the largest R̂.
        name: String,
        /// That R̂; NaN where chains do not move.
        value: f64,
    },
    /// Too few effective draws.
    EffectiveSampleSize {
        /// The coordinate with the smallest.
        name: String,
        /// The smaller one of bulk and tail.
        value: f64,
        /// How many are needed.
        needed: f64,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let percent = |count: usize, draws: usize| 100.0 * count as f64 / draws as f64;
        match self {
            Self::Divergences { count, draws } => write!(
                f,
                "{count} of {draws} trajectories diverged ({:.1} %): draws are missing where the density bends; raise `acceptance` or write the density in other coordinates",
                percent(*count, *draws)
            ),
            Self::GreatestDepth { count, draws } => write!(
                f,
                "{count} of {draws} trees reached the greatest depth ({:.1} %): raise `max_depth` or write the density in other coordinates",
                percent(*count, *draws)
            ),
            Self::EnergyFraction { least } => {
                write!(f, "E-BFMI is {least:.2} in one chain, below {LEAST_ENERGY_FRACTION}: tails may be missing")
            }
            Self::RHat { name, value } => {
                write!(f, "R-hat of {name} is {value:.3}, and at most {MOST_R_HAT} is needed: the chains do not agree")
            }
            Self::EffectiveSampleSize { name, value, needed } => {
                write!(f, "{name} has {value:.0} effective draws, and {needed:.0} are needed: draw more")
            }
        }
    }
}

/// A run in numbers; printed as a table.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Summary {
    /// One row a coordinate.
    pub rows: Vec<Row>,
    /// Number of chains.
    pub chains: usize,
    /// Draws of one chain.
    pub draws: usize,
    /// Divergent trajectories.
    pub divergences: usize,
    /// Trees at their greatest depth.
    pub at_greatest_depth: usize,
    /// E-BFMI of each chain; NaN where there are no energies.
    pub energy_fraction: Vec<f64>,
    /// Mean acceptance probability.
    pub acceptance: f64,
    /// Gradients of all kept draws.
    pub gradients: usize,
    /// Mean of the evidence's estimates, as a logarithm, and the standard deviation of their logarithms; of tempered sequential Monte Carlo.
    pub log_evidence: Option<(f64, f64)>,
    /// What speaks against the draws; empty if nothing does.
    pub warnings: Vec<Warning>,
}

fn row(run: &Run, coordinate: usize) -> Row {
    let chains = run.series(coordinate);
    let n = run.stats.len() as f64;
    let mean = chains.iter().flatten().map(|x| x / n).sum::<f64>();
    let square = chains.iter().flatten().map(|x| (x - mean) * (x - mean)).sum::<f64>();
    Row {
        name: run.names[coordinate].clone(),
        mean,
        sd: (square / (n - 1.0)).sqrt(),
        mcse: mcse_of_mean(&chains),
        bulk_ess: bulk_ess(&chains),
        tail_ess: tail_ess(&chains),
        r_hat: rank_r_hat(&chains),
    }
}

/// Logarithm of the mean of exponentials, and the standard deviation of the logarithms.
fn evidence(logs: &[f64]) -> Option<(f64, f64)> {
    let n = logs.len() as f64;
    let largest = logs.iter().copied().reduce(f64::max)?;
    let mean = largest + (logs.iter().map(|l| (l - largest).exp()).sum::<f64>() / n).ln();
    let middle = logs.iter().sum::<f64>() / n;
    Some((mean, (logs.iter().map(|l| (l - middle).powi(2)).sum::<f64>() / (n - 1.0)).sqrt()))
}

impl Summary {
    pub(crate) fn of(run: &Run) -> Self {
        let rows: Vec<Row> = (0..run.dim()).map(|j| row(run, j)).collect();
        let energies = |chain| run.chain_stats(chain).iter().map(|stat| stat.energy).collect::<Vec<_>>();
        let count = |of: &dyn Fn(&ChainStat) -> bool| run.stats.iter().filter(|stat| of(stat)).count();
        let mut summary = Self {
            rows,
            chains: run.chains,
            draws: run.draws(),
            divergences: count(&|stat| stat.divergent),
            at_greatest_depth: count(&|stat| run.max_depth > 0 && stat.depth as usize == run.max_depth),
            energy_fraction: (0..run.chains).map(|chain| energy_fraction(&energies(chain))).collect(),
            acceptance: run.stats.iter().map(|stat| stat.acceptance).sum::<f64>() / run.stats.len() as f64,
            gradients: run.stats.iter().map(|stat| stat.leapfrog_steps as usize).sum(),
            log_evidence: evidence(&run.log_evidence),
            warnings: vec![],
        };
        summary.warnings = summary.doubts();
        summary
    }

    /// Whether nothing speaks against the draws.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.warnings.is_empty()
    }

    fn doubts(&self) -> Vec<Warning> {
        let draws = self.chains * self.draws;
        let mut warnings = vec![];
        if self.divergences > 0 {
            warnings.push(Warning::Divergences { count: self.divergences, draws });
        }
        if self.at_greatest_depth > 0 {
            warnings.push(Warning::GreatestDepth { count: self.at_greatest_depth, draws });
        }
        let least = self.energy_fraction.iter().copied().fold(f64::INFINITY, f64::min);
        if least < LEAST_ENERGY_FRACTION {
            warnings.push(Warning::EnergyFraction { least });
        }
        let ranked = |r_hat: f64| if r_hat.is_nan() { f64::INFINITY } else { r_hat };
        if let Some(worst) = self.rows.iter().max_by(|a, b| ranked(a.r_hat).total_cmp(&ranked(b.r_hat)))
            && ranked(worst.r_hat) > MOST_R_HAT
        {
            warnings.push(Warning::RHat { name: worst.name.clone(), value: worst.r_hat });
        }
        let worth = |row: &Row| if row.tail_ess.is_nan() { 0.0 } else { row.bulk_ess.min(row.tail_ess) };
        let needed = LEAST_ESS * self.chains as f64;
        if let Some(worst) = self.rows.iter().min_by(|a, b| worth(a).total_cmp(&worth(b)))
            && worth(worst) < needed
        {
            warnings.push(Warning::EffectiveSampleSize { name: worst.name.clone(), value: worth(worst), needed });
        }
        warnings
    }
}

/// Four significant digits, in as few places as they need.
fn digits(x: f64) -> String {
    let size = x.abs();
    if x != 0.0 && !(1e-3..1e6).contains(&size) {
        return format!("{x:.2e}");
    }
    let places = if size >= 1000.0 { 0 } else { (3 - size.max(0.1).log10().floor() as i32).clamp(0, 4) };
    format!("{x:.*}", places as usize)
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.rows.iter().map(|row| row.name.chars().count()).max().unwrap_or(0).max(4);
        let header = ["mean", "sd", "mcse", "bulk ESS", "tail ESS", "R-hat"];
        write!(f, "{:width$}", "")?;
        header.iter().try_for_each(|column| write!(f, " {column:>9}"))?;
        for row in &self.rows {
            write!(f, "\n{:width$}", row.name)?;
            for cell in [digits(row.mean), digits(row.sd), digits(row.mcse)] {
                write!(f, " {cell:>9}")?;
            }
            write!(f, " {:>9.0} {:>9.0} {:>9.3}", row.bulk_ess, row.tail_ess, row.r_hat)?;
        }
        let plural = |count: usize, word: &str| format!("{count} {word}{}", if count == 1 { "" } else { "s" });
        write!(
            f,
            "\n{} of {}, acceptance {:.2}, {} gradients, {}",
            plural(self.chains, "chain"),
            plural(self.draws, "draw"),
            self.acceptance,
            self.gradients,
            plural(self.divergences, "divergence"),
        )?;
        let least = self.energy_fraction.iter().copied().fold(f64::NAN, f64::min);
        if !least.is_nan() {
            write!(f, ", E-BFMI at least {least:.2}")?;
        }
        if let Some((mean, sd)) = self.log_evidence {
            write!(f, ", log evidence {mean:.3} (sd {sd:.3})")?;
        }
        self.warnings.iter().try_for_each(|warning| write!(f, "\ndoes not hold: {warning}"))
    }
}
