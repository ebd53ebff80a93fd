//! The growth model: a state on a line that is seen through its square (`exact/growth_a.json`).
//!
//! The filter often has two modes.
//!
//! x_0 ~ N(0, p₀²); x_t = x_{t−1} / 2 + c x_{t−1} / (1 + x_{t−1}²) + 8 cos(w t) + N(0, q²); y_t = x_t² / 20 + N(0, r²).

use crate::finding::Finding;
use crate::quadrature::{OnLine, line_filter};
use crate::stored::{number, numbers, stored};
use sinew::core::density::{GaussNewton, GradLogDensity, Lanes, LogDensity};
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::core::random::{BlockRng, Stage};
use sinew::core::transition::{Cloud, MotionModel, Predict, Transition};
use sinew::dynamics::gaussian::Gaussian;
use sinew::dynamics::mixture::Mixture;
use sinew::dynamics::prior::Prior;
use sinew::dynamics::random_walk::Between;
use sinew::tracking::Tracker;
use sinew::tracking::bootstrap::{self, Bootstrap};
use sinew::tracking::hmc_filter::{self, HmcFilter};
use std::f64::consts::TAU;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// The model with its observations and the stored exact filter.
#[derive(Clone, Debug)]
pub struct Growth {
    /// p₀, q, r, c, w.
    pub parameters: [f64; 5],
    /// y_t.
    pub y: Vec<f64>,
    /// Log evidence.
    pub log_likelihood: f64,
    /// P(x_t > 0).
    pub positive: Vec<f64>,
    /// Mean and variance of each frame.
    pub moments: Vec<[f64; 2]>,
}

fn normal(x: f64, sd: f64) -> f64 {
    -0.5 * (x / sd).powi(2) - 0.5 * TAU.ln() - sd.ln()
}

impl Growth {
    /// The stored series; `None`, with a note, where the data folder is missing.
    #[must_use]
    pub fn stored() -> Option<Self> {
        let v = stored("exact/growth_a.json")?;
        let moments = numbers(&v["filtered_mean"]).into_iter().zip(numbers(&v["filtered_var"]));
        Some(Self {
            parameters: ["p0", "q", "r", "c", "w"].map(|name| number(&v[name])),
            y: numbers(&v["y"]),
            log_likelihood: number(&v["log_likelihood"]),
            positive: numbers(&v["prob_x_positive"]),
            moments: moments.map(|(m, v)| [m, v]).collect(),
        })
    }

    fn moved(&self, frame: usize, x: f64) -> f64 {
        let [.., c, w] = self.parameters;
        0.5 * x + c * x / (1.0 + x * x) + 8.0 * (w * frame as f64).cos()
    }

    /// The exact filter on `points` steps of [−50, 50].
    #[must_use]
    pub fn exact(&self, points: usize) -> Vec<OnLine> {
        let [p0, q, r, ..] = self.parameters;
        line_filter(
            [-50.0, 50.0],
            points,
            self.y.len(),
            |x| normal(x, p0),
            |frame, from, to| normal(to - self.moved(frame, from), q),
            |frame, x| normal(self.y[frame] - x * x / 20.0, r),
        )
    }

    /// The motion with a clock that says which frame comes next.
    #[must_use]
    pub fn motion(&self, between: Between) -> Motion {
        Motion { growth: self.clone(), between, frame: Arc::new(AtomicU32::new(0)) }
    }

    /// A frame's observation.
    #[must_use]
    pub fn sight(&self, frame: usize) -> Sight {
        Sight { y: self.y[frame], r: self.parameters[2] }
    }
}

/// The motion into the frame to which its clock is set. As prior between frames it is a mixture of one component for each last state, or the Gaussian with the mean and variance of that mixture.
#[derive(Clone, Debug)]
pub struct Motion {
    growth: Growth,
    between: Between,
    frame: Arc<AtomicU32>,
}

impl Motion {
    /// The clock, to be set before each step.
    #[must_use]
    pub fn clock(&self) -> Arc<AtomicU32> {
        Arc::clone(&self.frame)
    }

    fn moved(&self, x: f64) -> f64 {
        self.growth.moved(self.frame.load(Ordering::Relaxed) as usize, x)
    }

    fn gaussian(mean: f64, variance: f64) -> Result<Prior, sinew::dynamics::Error> {
        Ok(Prior::Gaussian(Lanes { leaf: Gaussian::new(vec![mean], &[variance])?, isa: Isa::best() }))
    }
}

impl MotionModel for Motion {
    fn dim(&self) -> usize {
        1
    }
}

impl Transition for Motion {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        rng.fill_normal(Isa::best(), next);
        for (next, previous) in next[0].0.iter_mut().zip(previous[0].0) {
            *next = self.moved(previous) + self.growth.parameters[1] * *next;
        }
    }

    fn sample_initial_block(&self, centre: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        rng.fill_normal(Isa::best(), next);
        next[0].0.iter_mut().for_each(|x| *x = centre[0] + self.growth.parameters[0] * *x);
    }

    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        normal(next[0] - self.moved(previous[0]), self.growth.parameters[1])
    }
}

impl Predict for Motion {
    type Prior = Prior;
    type Error = sinew::dynamics::Error;

    fn predict(&self, cloud: Cloud<'_>) -> Result<Prior, Self::Error> {
        let q = self.growth.parameters[1];
        let moved: Vec<f64> = (0..cloud.count).map(|i| self.moved(cloud.last[i / LANES].0[i % LANES])).collect();
        match self.between {
            Between::Mixture => {
                let leaf = Mixture::new(moved.into_iter().map(|m| vec![m]).collect(), &[q])?;
                Ok(Prior::Mixture(Lanes { leaf, isa: Isa::best() }))
            }
            Between::Gaussian => {
                let n = moved.len() as f64;
                let mean = moved.iter().sum::<f64>() / n;
                let variance = moved.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0).max(1.0);
                Self::gaussian(mean, variance + q * q)
            }
        }
    }

    fn initial(&self, centre: &[f64]) -> Result<Prior, Self::Error> {
        Self::gaussian(centre[0], self.growth.parameters[0].powi(2))
    }
}

/// One observation as a density of the state.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    y: f64,
    r: f64,
}

impl LogDensity for Sight {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        normal(self.y - x[0] * x[0] / 20.0, self.r)
    }
}

impl GradLogDensity for Sight {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad[0] = (self.y - x[0] * x[0] / 20.0) * x[0] / (10.0 * self.r * self.r);
        self.log_density(x)
    }
}

impl GaussNewton for Sight {
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], _ws: &mut [Block]) {
        diagonal[0] = Block(x[0].0.map(|x| (x / (10.0 * self.r)).powi(2)));
    }
}

/// What a filter made of the growth model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed {
    /// log Ẑ − log Z.
    pub log_evidence: f64,
    /// Mean over frames of |P(x > 0) − exact|.
    pub sign: f64,
    /// Largest of them.
    pub worst_sign: f64,
}

/// Follows the series with a tracker that uses `clock`.
///
/// # Panics
/// Where a frame has no posterior.
pub fn follow(growth: &Growth, tracker: &mut impl Tracker<Sight>, clock: &AtomicU32, stage: &Stage) -> Followed {
    let (mut log_evidence, mut sign, mut worst_sign) = (-growth.log_likelihood, 0.0, 0.0_f64);
    for (frame, exact) in growth.positive.iter().enumerate() {
        clock.store(frame as u32, Ordering::Relaxed);
        let info = tracker.step(&growth.sight(frame), stage.round(frame)).expect("posterior");
        log_evidence += info.log_evidence.unwrap_or(f64::NAN);
        let posterior = tracker.posterior();
        let positive = |(i, w): (usize, &f64)| if posterior.states[i / LANES].0[i % LANES] > 0.0 { *w } else { 0.0 };
        let found: f64 = posterior.weights.iter().enumerate().map(positive).sum();
        sign += (found - exact).abs() / growth.y.len() as f64;
        worst_sign = worst_sign.max((found - exact).abs());
    }
    Followed { log_evidence, sign, worst_sign }
}

/// One run of the bootstrap filter.
#[must_use]
pub fn by_particles(growth: &Growth, particles: usize, stage: &Stage) -> Followed {
    let motion = growth.motion(Between::Mixture);
    let clock = motion.clock();
    let config = bootstrap::Config { particles, ..bootstrap::Config::default() };
    let mut filter = Bootstrap::new(config, motion, vec![0.0]).expect("valid");
    follow(growth, &mut filter, &clock, stage)
}

/// One run of the HMC filter.
#[must_use]
pub fn by_chains(growth: &Growth, between: Between, chains: usize, stage: &Stage) -> Followed {
    let motion = growth.motion(between);
    let clock = motion.clock();
    let config = hmc_filter::Config {
        chains,
        updates: 10,
        burn_in: 3,
        step_size: 0.5,
        leapfrog_steps: 5,
        jitter: 0.2,
        ..hmc_filter::Config::default()
    };
    let mut filter = HmcFilter::new(config, motion, vec![0.0], Isa::best()).expect("valid");
    follow(growth, &mut filter, &clock, stage)
}

/// Two modes of the growth model (E6): the bootstrap filter with `particles`, and the HMC filter with the mixture prior and `chains` chains. Bounds are those for 5000 draws, the sign's growing as the root of the number that are missing.
#[must_use]
pub fn two_modes(growth: &Growth, particles: usize, chains: usize, runs: usize, seed: u64) -> Vec<Finding> {
    let root = Stage::new(seed, "growth model");
    let mut findings = vec![];
    for run in 0..runs {
        let [first, second] = root.round(run).split(["particles", "chains"]);
        for (what, count, found) in [
            ("bootstrap", particles, by_particles(growth, particles, &first)),
            ("hmc, mixture prior", chains, by_chains(growth, Between::Mixture, chains, &second)),
        ] {
            let wider = (5000.0 / count as f64).max(1.0).sqrt();
            let of = format!("growth model, {what}, {count} draws carried on, run {run}");
            let detail = format!("largest {:.3}, seed {seed}", found.worst_sign);
            findings.push(Finding::at_most(format!("{of}: error of P(x > 0)"), found.sign, 0.015 * wider, detail));
            findings.push(Finding::at_most(
                format!("{of}: error of log Z"),
                found.log_evidence.abs(),
                wider,
                String::new(),
            ));
        }
    }
    findings
}
