//! How much a set of Markov chains is worth.
//! Autocorrelation, integrated autocorrelation time, effective sample size, split R̂ and E-BFMI.
//!
//! With ρ_k the autocovariance at lag k over the variance, both over all chains with the pooled mean, the integrated autocorrelation time is τ = 1 + 2 Σ_{k≥1} ρ_k, and n draws
//! are worth n / τ independent ones. The sum is cut
//!
//! - [`Window::Geyer`]: by the initial monotone sequence (Geyer 1992): Γ_k = ρ_{2k} + ρ_{2k+1} while positive, forced to fall, τ = −1 + 2 Σ Γ_k;
//! - [`Window::Sokal`]: at the least W with W ≥ 5 τ(W) (Sokal 1989), which is about 5 % low for first-order chains.
//!
//! Split R̂ (Gelman et al. 2013, §11.4) halves each chain: with W the mean variance within the halves of length n and B / n the variance of their means,
//! R̂ = √(((n − 1) / n · W + B / n) / W). E-BFMI (Betancourt 2016) = Σ (E_t − E_{t−1})² / Σ (E_t − Ē)².
//!
//! Where a quantity does not exist the answer is defined:
//!
//! | input | τ | effective sample size | R̂ |
//! |---|---|---|---|
//! | constant draws | NaN | 0 | NaN |
//! | one constant chain of several that differ | as computed | as computed | as computed, large |
//! | a value that is not finite | NaN | 0 | NaN |
//! | fewer than 4 draws a chain | as computed from 2 on, else NaN | ≤ number of draws | NaN |
//! | one chain | as computed | as computed | of its two halves |
//!
//! The effective sample size never exceeds the number of draws.
//!
//! ```
//! use sinew_core::diagnostics::{Window, effective_sample_size, integrated_time};
//! let draws = [0.3, -0.2, 0.9, -1.0, 0.1, 0.4, -0.6, 0.2];
//! let tau = integrated_time(&[draws], Window::Geyer);
//! assert_eq!(effective_sample_size(&[draws]), (8.0 / tau).min(8.0));
//! ```

use crate::lanes::LANES;

/// Where the sum of autocorrelations is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// Geyer's initial positive monotone sequence.
    Geyer,
    /// Sokal's automatic window.
    Sokal,
}

/// Chains cut to a common length, one after the other, centred on their pooled mean.
struct Centred {
    values: Vec<f64>,
    length: usize,
    variance: f64,
}

/// Sum over the pairs of two series of one length, eight of them side by side.
fn sum(a: &[f64], b: &[f64], of: impl Fn(f64, f64) -> f64) -> f64 {
    let ((a, rest_a), (b, rest_b)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += of(*a, *b));
    }
    sums.iter().sum::<f64>() + rest_a.iter().zip(rest_b).map(|(a, b)| of(*a, *b)).sum::<f64>()
}

/// Mean, without a sum that could overflow.
fn mean(values: &[f64]) -> f64 {
    let share = 1.0 / values.len() as f64;
    sum(values, values, |x, _| x * share)
}

impl Centred {
    /// `None` unless there are at least two draws, all finite, that are not all equal.
    fn new<C: AsRef<[f64]>>(chains: &[C]) -> Option<Self> {
        let length = chains.iter().map(|c| c.as_ref().len()).min()?;
        if length < 2 {
            return None;
        }
        let mut values = Vec::with_capacity(length * chains.len());
        chains.iter().for_each(|c| values.extend_from_slice(&c.as_ref()[..length]));
        if values.iter().any(|x| !x.is_finite()) || values.iter().all(|x| *x == values[0]) {
            return None;
        }
        let mean = mean(&values);
        values.iter_mut().for_each(|x| *x -= mean);
        let share = 1.0 / values.len() as f64;
        let variance = sum(&values, &values, |x, y| x * y * share);
        (variance > 0.0 && variance.is_finite()).then_some(Self { values, length, variance })
    }

    fn autocorrelation(&self, lag: usize) -> f64 {
        let ahead = self.length - lag;
        let products: f64 =
            self.values.chunks_exact(self.length).map(|c| sum(&c[..ahead], &c[lag..], |x, y| x * y)).sum();
        products / (self.values.len() as f64 * self.variance)
    }

    fn integrated_time(&self, window: Window) -> f64 {
        match window {
            Window::Sokal => {
                let mut tau = 1.0;
                for lag in 1..self.length {
                    tau += 2.0 * self.autocorrelation(lag);
                    if lag as f64 >= 5.0 * tau {
                        break;
                    }
                }
                tau
            }
            Window::Geyer => {
                let mut tau = -1.0;
                let mut previous = f64::INFINITY;
                for lag in (0..self.length - 1).step_by(2) {
                    let pair = self.autocorrelation(lag) + self.autocorrelation(lag + 1);
                    if pair <= 0.0 {
                        break;
                    }
                    previous = pair.min(previous);
                    tau += 2.0 * previous;
                }
                tau
            }
        }
    }
}

/// Autocorrelations ρ_0 … ρ_{max_lag} over all chains with the pooled mean; empty where they do not exist.
#[must_use]
pub fn autocorrelation<C: AsRef<[f64]>>(chains: &[C], max_lag: usize) -> Vec<f64> {
    Centred::new(chains)
        .map_or_else(Vec::new, |c| (0..=max_lag.min(c.length - 1)).map(|lag| c.autocorrelation(lag)).collect())
}

/// Integrated autocorrelation time τ (spec of the estimators in the module text); NaN where it does not exist.
#[must_use]
pub fn integrated_time<C: AsRef<[f64]>>(chains: &[C], window: Window) -> f64 {
    Centred::new(chains).map_or(f64::NAN, |c| c.integrated_time(window))
}

/// Number of independent draws that all draws together are worth (Geyer's window): between 0 and their number.
#[must_use]
pub fn effective_sample_size<C: AsRef<[f64]>>(chains: &[C]) -> f64 {
    Centred::new(chains).map_or(0.0, |c| {
        let draws = c.values.len() as f64;
        let tau = c.integrated_time(Window::Geyer);
        if tau > 1.0 { draws / tau } else { draws }
    })
}

/// Split R̂ of the halves of all chains; NaN where it does not exist.
#[must_use]
pub fn split_r_hat<C: AsRef<[f64]>>(chains: &[C]) -> f64 {
    let Some(half) = chains.iter().map(|c| c.as_ref().len() / 2).min().filter(|&half| half >= 2) else {
        return f64::NAN;
    };
    if chains.iter().any(|c| c.as_ref().iter().any(|x| !x.is_finite())) {
        return f64::NAN;
    }
    let n = half as f64;
    let halves = chains.iter().flat_map(|c| {
        let c = c.as_ref();
        [&c[..half], &c[c.len() - half..]]
    });
    let moments: Vec<(f64, f64)> = halves
        .map(|h| {
            if h.iter().all(|&x| x == h[0]) {
                return (h[0], 0.0);
            }
            let mean = mean(h);
            (mean, sum(h, h, |x, y| (x - mean) * (y - mean)) / (n - 1.0))
        })
        .collect();
    let m = moments.len() as f64;
    let mean = moments.iter().map(|(mean, _)| mean / m).sum::<f64>();
    let between = moments.iter().map(|(x, _)| (x - mean) * (x - mean)).sum::<f64>() / (m - 1.0);
    let within = moments.iter().map(|(_, variance)| variance / m).sum::<f64>();
    if moments.iter().all(|&half| half == (moments[0].0, 0.0)) {
        return f64::NAN;
    }
    (((n - 1.0) / n * within + between) / within).sqrt()
}

/// Energy Bayesian fraction of missing information of the energies of one chain; below about 0.3 the momenta explore the energies slowly. NaN where it does not exist.
#[must_use]
pub fn energy_fraction(energy: &[f64]) -> f64 {
    let n = energy.len() as f64;
    let mean = energy.iter().map(|e| e / n).sum::<f64>();
    let steps: f64 = energy.windows(2).map(|e| (e[1] - e[0]) * (e[1] - e[0])).sum();
    steps / energy.iter().map(|e| (e - mean) * (e - mean)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Block, Isa};
    use crate::random::Stage;

    /// A stationary first-order chain x' = φ x + √(1 − φ²) e.
    fn ar1(phi: f64, length: usize, stage: Stage) -> Vec<f64> {
        let mut noise = vec![Block::ZERO; length.div_ceil(8)];
        stage.whole().fill_normal(Isa::best(), &mut noise);
        let mut x = 0.0;
        let fresh = (1.0 - phi * phi).sqrt();
        noise
            .iter()
            .flat_map(|b| b.0)
            .take(length)
            .enumerate()
            .map(|(i, e)| {
                x = if i == 0 { e } else { phi * x + fresh * e };
                x
            })
            .collect()
    }

    /// H11.
    #[test]
    fn integrated_time_of_first_order_chains() {
        for (phi, seed) in [(0.0, 1), (0.5, 2), (0.9, 3)] {
            let chain = [ar1(phi, 2_000_000, Stage::new(seed, "H11"))];
            let exact = (1.0 + phi) / (1.0 - phi);
            for window in [Window::Geyer, Window::Sokal] {
                let tau = integrated_time(&chain, window);
                assert!((tau / exact - 1.0).abs() < 0.1, "phi {phi}, {window:?}: {tau} against {exact} ± 10 %");
            }
            let rho = autocorrelation(&chain, 2);
            assert!((rho[1] - phi).abs() < 0.01 && (rho[0] - 1.0).abs() < 1e-12, "rho_1 = {} against {phi}", rho[1]);
        }
    }

    #[test]
    fn chains_of_one_distribution_have_r_hat_near_one_and_shifted_ones_do_not() {
        let root = Stage::new(5, "r hat");
        let mut chains: Vec<Vec<f64>> = (0..4).map(|i| ar1(0.3, 2000, root.round(i))).collect();
        let together = split_r_hat(&chains);
        assert!((together - 1.0).abs() < 0.01, "{together}");
        chains[2].iter_mut().for_each(|x| *x += 1.0);
        assert!(split_r_hat(&chains) > 1.05);
        let constant = vec![0.1; 2000];
        assert!(split_r_hat(&[chains[0].clone(), chains[1].clone(), chains[3].clone(), constant]) > 1.0);
    }

    #[test]
    fn r_hat_matches_its_formula_by_hand() {
        // Halves (0, 2), (1, 3): means 1, 2; W = 2; B / n = 0.5; n = 2.
        assert!((split_r_hat(&[[0.0, 2.0, 1.0, 3.0]]) - ((0.5 * 2.0 + 0.5) / 2.0_f64).sqrt()).abs() < 1e-15);
    }

    #[test]
    fn answers_are_defined_where_the_quantity_is_not() {
        let constant = [[1.5; 100]];
        assert_eq!(effective_sample_size(&constant), 0.0);
        assert!(integrated_time(&constant, Window::Geyer).is_nan() && split_r_hat(&constant).is_nan());
        assert!(split_r_hat(&[[1.0; 8], [2.0; 8]]).is_infinite());
        let broken = [[1.0, f64::INFINITY, 2.0, 3.0, 4.0]];
        assert_eq!(effective_sample_size(&broken), 0.0);
        assert!(split_r_hat(&broken).is_nan() && autocorrelation(&broken, 3).is_empty());
        let short = [[1.0, 2.0, 4.0]];
        assert!(split_r_hat(&short).is_nan());
        assert!(effective_sample_size(&short) <= 3.0 && effective_sample_size(&short) > 0.0);
        assert!(split_r_hat::<[f64; 4]>(&[]).is_nan() && effective_sample_size::<[f64; 4]>(&[]) == 0.0);
        // ρ = 1, −2/3, 1/6: one pair, and the last lag has no partner.
        assert!((integrated_time(&[[1.0, -2.0, 1.0]], Window::Geyer) + 1.0 / 3.0).abs() < 1e-12);
        let alternating: Vec<f64> = (0..100).map(|i| f64::from(i % 2)).collect();
        assert_eq!(effective_sample_size(&[alternating]), 100.0);
    }

    #[test]
    fn energy_fraction_of_independent_energies_is_two() {
        let fraction = energy_fraction(&ar1(0.0, 100_000, Stage::new(8, "energy")));
        assert!((fraction - 2.0).abs() < 0.05, "{fraction}");
        assert!(energy_fraction(&[]).is_nan());
    }
}
