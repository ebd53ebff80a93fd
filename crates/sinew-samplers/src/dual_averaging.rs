//! Dual averaging of a step size towards a given acceptance (Nesterov 2009; Hoffman & Gelman 2014, §3.2).
//!
//! After transition t with acceptance α_t, of which δ is wanted, with γ = 0.05, t₀ = 10, κ = 0.75 and μ = log 10 ε₀ for the first step size ε₀:
//!
//! ```text
//! H_t = (1 − 1 / (t + t₀)) H_{t−1} + (δ − α_t) / (t + t₀)
//! log ε_t = μ − √t / γ · H_t
//! log ε̄_t = t^−κ log ε_t + (1 − t^−κ) log ε̄_{t−1}
//! ```
//!
//! ε_t is the step size to try next, and ε̄_t the one to keep.

const GAMMA: f64 = 0.05;
const T0: f64 = 10.0;
const KAPPA: f64 = 0.75;

/// The search of one chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DualAveraging {
    wanted: f64,
    mu: f64,
    count: f64,
    error: f64,
    log_step: f64,
    log_average: f64,
}

impl DualAveraging {
    /// A search for the step size of this acceptance, from a first one.
    #[must_use]
    pub fn new(first_step_size: f64, acceptance: f64) -> Self {
        let log_step = first_step_size.ln();
        let mu = log_step + 10.0_f64.ln();
        Self { wanted: acceptance, mu, count: 0.0, error: 0.0, log_step, log_average: log_step }
    }

    /// Takes in the acceptance of a transition with the step size of [`DualAveraging::step_size`].
    pub fn update(&mut self, acceptance: f64) {
        self.count += 1.0;
        let weight = 1.0 / (self.count + T0);
        self.error += weight * (self.wanted - acceptance - self.error);
        self.log_step = self.mu - self.count.sqrt() / GAMMA * self.error;
        let share = self.count.powf(-KAPPA);
        self.log_average += share * (self.log_step - self.log_average);
    }

    /// Step size of the next transition.
    #[must_use]
    pub fn step_size(&self) -> f64 {
        self.log_step.exp()
    }

    /// Average step size, the later ones counting more.
    #[must_use]
    pub fn average(&self) -> f64 {
        self.log_average.exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Acceptance 1 / (1 + ε²) is 0.8 at ε = ½, from whichever side and however far the search begins.
    #[test]
    fn the_wanted_acceptance_is_reached() {
        for first in [1e-6, 0.3, 1e4] {
            let mut search = DualAveraging::new(first, 0.8);
            for _ in 0..2000 {
                search.update(1.0 / (1.0 + search.step_size().powi(2)));
            }
            assert!((search.average() - 0.5).abs() < 0.02, "{first}: {}", search.average());
        }
    }

    #[test]
    fn two_updates_follow_the_formula() {
        let mut search = DualAveraging::new(0.5, 0.8);
        assert!((search.step_size() - 0.5).abs() < 1e-15 && (search.average() - 0.5).abs() < 1e-15);
        search.update(0.2);
        let first = 5.0_f64.ln() - 20.0 * 0.6 / 11.0;
        assert!((search.step_size().ln() - first).abs() < 1e-12 && (search.average().ln() - first).abs() < 1e-12);
        search.update(1.0);
        let error = (1.0 - 1.0 / 12.0) * 0.6 / 11.0 - 0.2 / 12.0;
        let second = 5.0_f64.ln() - 20.0 * 2.0_f64.sqrt() * error;
        let share = 2.0_f64.powf(-0.75);
        assert!((search.step_size().ln() - second).abs() < 1e-12);
        assert!((search.average().ln() - (share * second + (1.0 - share) * first)).abs() < 1e-12);
    }
}
