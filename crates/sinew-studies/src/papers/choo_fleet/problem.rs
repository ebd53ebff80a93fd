//! The inference problem of one frame: a part of CF28, its likelihood and its prior.

use super::scene::Frame;
use crate::support::outcome::Outcome;
use sinew::core::combinators::{OnPart, Sum};
use sinew::core::density::GaussNewton;
use sinew::core::lanes::Isa;
use sinew::core::part::Part;
use sinew::core::transition::Predict as _;
use sinew::dynamics::prior::Prior;
use sinew::dynamics::random_walk::{Between, RandomWalk};

/// A part of the body with the settings of Table 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Model {
    /// What sets it apart from another part of as many degrees of freedom; empty for the paper's parts.
    set: &'static str,
    pub(super) dim: usize,
    /// First of its consecutive degrees of freedom in CF28.
    first: usize,
    /// Chains M.
    pub(super) chains: usize,
    /// Leapfrog steps L of the paper.
    pub(super) steps: usize,
    /// Particles at equal cost with R = 8.
    pub(super) particles: usize,
}

/// The right arm, the lower body and the whole body.
pub(super) const MODELS: [Model; 3] = [
    Model { set: "", dim: 4, first: 14, chains: 4, steps: 2, particles: 320 },
    Model { set: "", dim: 10, first: 18, chains: 8, steps: 20, particles: 5700 },
    Model { set: "", dim: 28, first: 0, chains: 10, steps: 40, particles: 27_000 },
];

/// The last degrees of freedom of the body, from one knee and hip to all: for the dimension in which hmc overtakes particles.
pub(super) fn nested() -> Vec<Model> {
    let of = |dim| Model { set: "last ", dim, first: 28 - dim, chains: 8, steps: 10, particles: 1000 };
    [2, 4, 6, 8, 10, 14, 18, 22, 28].map(of).to_vec()
}

impl Model {
    /// Name in the keys of cells.
    pub(super) fn name(&self) -> String {
        format!("{}{}", self.set, self.dim)
    }

    /// Whether it is one of the paper's.
    pub(super) fn is_of_paper(&self) -> bool {
        self.set.is_empty()
    }

    /// Those coordinates of a state that are free.
    pub(super) fn part(&self, state: &[f64]) -> Vec<f64> {
        state[self.first..][..self.dim].to_vec()
    }

    /// A state whose free coordinates are given.
    pub(super) fn complete(&self, truth: &[f64], part: &[f64]) -> Vec<f64> {
        let mut whole = truth.to_vec();
        whole[self.first..][..self.dim].copy_from_slice(part);
        whole
    }

    /// The random walk of its coordinates, 0.015 m and 0.15 rad a frame.
    pub(super) fn walk(&self, isa: Isa) -> Outcome<RandomWalk> {
        let whole = RandomWalk::choo_fleet(28, 1.0 / 30.0, Between::Mixture, isa)?;
        let rate = 30.0_f64.sqrt();
        let sd: Vec<f64> = self.part(whole.sd()).iter().map(|sd| rate * sd).collect();
        Ok(RandomWalk::new(&sd, 1.0 / 30.0, Between::Mixture, isa)?)
    }

    /// The likelihood of its coordinates; the others are clamped to their true values.
    pub(super) fn likelihood(&self, whole: Whole, truth: &[f64]) -> Outcome<Likelihood> {
        let part = Part::new((self.first..self.first + self.dim).collect(), truth.len())?;
        Ok(OnPart { target: whole, part, fixed: truth.to_vec() })
    }
}

/// Calls that are timed together, and how often: the machine may be busy for tens of milliseconds.
const CALLS: usize = 100;
const REPETITIONS: usize = 5000;

/// Likelihood of the whole body, from whatever cameras.
pub(super) type Whole = Box<dyn GaussNewton>;

/// Likelihood of a part.
pub(super) type Likelihood = OnPart<Whole>;

/// A frame of a part.
pub(super) struct Problem {
    pub(super) model: Model,
    pub(super) walk: RandomWalk,
    pub(super) likelihood: Likelihood,
    pub(super) prior: Prior,
    pub(super) previous: Vec<f64>,
    pub(super) truth: Vec<f64>,
    pub(super) isa: Isa,
}

impl Problem {
    pub(super) fn new(model: Model, frame: &Frame, whole: Whole, isa: Isa) -> Outcome<Self> {
        let walk = model.walk(isa)?;
        let previous = model.part(&frame.previous);
        let prior = walk.initial(&previous)?;
        let likelihood = model.likelihood(whole, &frame.truth)?;
        Ok(Self { model, walk, likelihood, prior, previous, truth: model.part(&frame.truth), isa })
    }

    /// Prior times likelihood.
    pub(super) fn target(&self) -> Sum<&Likelihood, &Prior> {
        Sum(&self.likelihood, &self.prior)
    }

    /// Gradient units c_g: what log density and gradient of the target cost over the likelihood alone, the least of many repetitions.
    pub(super) fn gradient_factor(&self) -> f64 {
        use sinew::core::density::{GradLogDensity as _, LogDensity as _};
        use sinew::core::lanes::Block;
        use std::hint::black_box;
        let x: Vec<Block> = self.truth.iter().map(|&x| Block::splat(x)).collect();
        let target = self.target();
        let mut gradient = x.clone();
        let mut ws = vec![Block::ZERO; target.workspace().max(self.likelihood.workspace())];
        let mut time = |call: &mut dyn FnMut(&mut [Block])| {
            let clock = std::time::Instant::now();
            (0..CALLS).for_each(|_| call(&mut ws));
            clock.elapsed().as_secs_f64()
        };
        let (mut value, mut with_gradient) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..REPETITIONS {
            value = value.min(time(&mut |ws| {
                black_box(self.likelihood.log_density_block(black_box(&x), ws));
            }));
            with_gradient = with_gradient.min(time(&mut |ws| {
                black_box(target.log_density_grad_block(black_box(&x), &mut gradient, ws));
            }));
        }
        with_gradient / value
    }
}
