//! Sequential tests with a stated rate of false alarms.
//!
//! Gandy & Scott 2020, "Unit testing for MCMC and other Monte Carlo methods", algorithm 3.
//!
//! One stage with threshold 10⁻⁶ has little power, one with threshold 10⁻² cries wolf. So a test that is neither clearly passed nor clearly failed continues with more draws. With α the rate of false alarms of the
//! whole, K stages, β = α / K and γ = β^(1/K), in each stage:
//!
//! 1. q = d · min p over the d statistics (Bonferroni);
//! 2. q ≤ β: the test fails. q > γ + β: it holds;
//! 3. otherwise β ← β / γ, the number of draws grows by a factor, and the next stage begins. After stage K the test holds.
//!
//! A stage is reached by a right sampler with probability at most γ for each before it, which pays for the larger β: every stage costs α / K.

use crate::detectable::{Detectable, OneSigma, Wrong, root_n_distance, z_score};
use crate::report::{Bound, Report, Statistic};
use std::cell::LazyCell;

/// How much evidence a verdict needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Probability α that a right sampler fails the test.
    pub false_alarm_rate: f64,
    /// Most stages K, at least 1.
    pub stages: usize,
    /// Factor by which the number of draws grows after each stage that did not decide.
    pub growth: usize,
}

impl Default for Control {
    fn default() -> Self {
        Self { false_alarm_rate: 1e-6, stages: 3, growth: 4 }
    }
}

/// A statistic with its p-value, before the stage's threshold is known.
pub(crate) struct Measured {
    pub name: String,
    pub value: f64,
    pub p: f64,
    /// The error that moves it by one standard error, where that can be said: then the report says what size would have been seen.
    pub one_sigma: Option<(String, OneSigma)>,
}

/// What decides in one stage, of q = d · min p.
pub(crate) struct Threshold {
    /// β: the test fails at this q and below.
    pub fails: f64,
    /// γ + β: at this q and below it does not hold yet.
    pub doubtful: f64,
    /// Draws, in those of the first stage.
    pub growth: usize,
    gamma: f64,
    stages_left: usize,
    by: usize,
}

impl Threshold {
    pub fn first(control: &Control) -> Self {
        let stages = control.stages.max(1);
        let fails = control.false_alarm_rate / stages as f64;
        let gamma = fails.powf(1.0 / stages as f64);
        Self { fails, doubtful: gamma + fails, growth: 1, gamma, stages_left: stages - 1, by: control.growth.max(1) }
    }

    pub fn is_last(&self) -> bool {
        self.stages_left == 0
    }

    pub fn next(&self) -> Self {
        let fails = self.fails / self.gamma;
        let (growth, stages_left) = (self.growth * self.by, self.stages_left - 1);
        Self { fails, doubtful: self.gamma + fails, growth, stages_left, ..*self }
    }
}

/// What does not change from stage to stage.
pub(crate) struct About<'a> {
    pub test: &'static str,
    pub would_show: &'static str,
    pub seed: u64,
    pub measured: &'a dyn Fn(usize) -> String,
}

/// Runs stages of `measure(draws, stage)` from `draws` on until one decides.
pub(crate) fn run(
    control: &Control,
    about: &About<'_>,
    draws: usize,
    mut measure: impl FnMut(usize, usize) -> Vec<Measured>,
) -> Report {
    let mut threshold = Threshold::first(control);
    let mut stage = 1;
    loop {
        let found = measure(draws * threshold.growth, stage);
        let count = found.len() as f64;
        // A p-value that is NaN is a failure, and decides at once.
        let least = found.iter().map(|m| if m.p.is_nan() { 0.0 } else { m.p }).fold(f64::INFINITY, f64::min) * count;
        let undecided = least > threshold.fails && least <= threshold.doubtful;
        if undecided && !threshold.is_last() {
            threshold = threshold.next();
            stage += 1;
            continue;
        }
        let above = threshold.fails / count;
        return Report {
            test: about.test,
            measured: (about.measured)(draws * threshold.growth),
            would_show: about.would_show,
            detectable: detectable(control, &found, threshold.growth),
            statistics: found
                .into_iter()
                .map(|m| Statistic { name: m.name, value: m.value, bound: Bound::Probability { p: m.p, above } })
                .collect(),
            false_alarm_rate: control.false_alarm_rate,
            stages: stage,
            seed: Some(about.seed),
        };
    }
}

/// The sizes of errors that the test sees. Standard errors are those of a stage with `growth` times the draws of the first.
fn detectable(control: &Control, found: &[Measured], growth: usize) -> Vec<Detectable> {
    let z = LazyCell::new(|| z_score(control, found.len()));
    let distance = LazyCell::new(|| root_n_distance(control, found.len()));
    let to_first = (growth as f64).sqrt();
    let size = |(of, (what, one)): &(String, OneSigma)| {
        let sigmas = if *what == Wrong::Distribution { *distance } else { *z };
        Detectable { of: of.clone(), what: *what, size: one * sigmas * to_first }
    };
    found.iter().filter_map(|m| m.one_sigma.as_ref()).map(size).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::random::Stage;

    fn about() -> About<'static> {
        About { test: "uniform p", would_show: "nothing", seed: 0, measured: &|draws| format!("{draws} draws") }
    }

    /// With α = 0.1 and uniform p-values, 20 000 tests of three statistics fail at a rate of at most α (|z| < 4.5) and not much below it.
    #[test]
    fn false_alarms_come_at_the_stated_rate() {
        let control = Control { false_alarm_rate: 0.1, stages: 3, growth: 2 };
        let mut rng = Stage::new(1, "sequential").whole();
        let (runs, mut failed, mut stages) = (20_000, 0.0, 0);
        for _ in 0..runs {
            let report = run(&control, &about(), 1, |_, _| {
                let p = crate::draws::uniforms(3, &mut rng);
                p.into_iter().map(|p| Measured { name: String::new(), value: 0.0, p, one_sigma: None }).collect()
            });
            failed += f64::from(u8::from(!report.holds()));
            stages = stages.max(report.stages);
        }
        let (rate, error) = (failed / f64::from(runs), (0.1 * 0.9 / f64::from(runs)).sqrt());
        assert!(rate < 0.1 + 4.5 * error && rate > 0.07, "{rate}");
        assert_eq!(stages, 3);
    }

    #[test]
    fn doubt_is_settled_with_more_draws() {
        let mut sizes = vec![];
        let report = run(&Control::default(), &about(), 10, |draws, _| {
            sizes.push(draws);
            vec![Measured { name: "p".into(), value: 4.0, p: if draws < 100 { 1e-4 } else { 1e-9 }, one_sigma: None }]
        });
        assert_eq!(sizes, [10, 40, 160]);
        assert!(!report.holds() && report.measured == "160 draws");
    }

    #[test]
    fn nan_fails_at_once() {
        let report = run(&Control::default(), &about(), 1, |_, _| {
            vec![Measured { name: "p".into(), value: f64::NAN, p: f64::NAN, one_sigma: None }]
        });
        assert!(!report.holds() && report.stages == 1);
    }
}
