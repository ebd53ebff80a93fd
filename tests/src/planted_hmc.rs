//! Hamiltonian Monte Carlo in scalars with bugs on request: negative controls for tests of samplers. Never a sampler to use.

use sinew::core::random::BlockRng;
use sinew_invariance::draws::{normals, uniform};

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bug {
    /// Nothing.
    None,
    /// The first entry of the gradient has the wrong sign: slow, but right.
    WrongGradient,
    /// The last half of a kick is left out.
    MissingHalfKick,
    /// Every proposal is taken.
    NoAcceptStep,
    /// The step depends on where the trajectory is.
    StepByPosition,
    /// The momentum is drawn 2 % too small.
    SmallMomentum,
}

/// Settings of one update.
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    /// Step size.
    pub size: f64,
    /// Leapfrog steps.
    pub count: usize,
    /// What is wrong.
    pub bug: Bug,
}

/// One update; `log_density_grad` writes the gradient.
pub fn update(
    log_density_grad: impl Fn(&[f64], &mut [f64]) -> f64,
    steps: Steps,
    x: &[f64],
    rng: &mut BlockRng,
) -> Vec<f64> {
    let Steps { size, count, bug } = steps;
    let gradient = |x: &[f64], g: &mut [f64]| {
        let value = log_density_grad(x, g);
        if bug == Bug::WrongGradient {
            g[0] = -g[0];
        }
        value
    };
    let (mut q, mut p, mut g) = (x.to_vec(), normals(x.len(), rng), vec![0.0; x.len()]);
    let kinetic = |p: &[f64]| 0.5 * p.iter().map(|p| p * p).sum::<f64>();
    if bug == Bug::SmallMomentum {
        p.iter_mut().for_each(|p| *p *= 0.98);
    }
    let before = kinetic(&p) - gradient(&q, &mut g);
    let mut value = 0.0;
    for step in 0..count {
        let h = if bug == Bug::StepByPosition { size / (1.0 + q[0] * q[0]).sqrt() } else { size };
        p.iter_mut().zip(&g).for_each(|(p, g)| *p += 0.5 * h * g);
        q.iter_mut().zip(&p).for_each(|(q, p)| *q += h * p);
        value = gradient(&q, &mut g);
        if !(bug == Bug::MissingHalfKick && step + 1 == count) {
            p.iter_mut().zip(&g).for_each(|(p, g)| *p += 0.5 * h * g);
        }
    }
    let after = kinetic(&p) - value;
    let accepted = uniform(rng).ln() < before - after;
    if accepted || bug == Bug::NoAcceptStep { q } else { x.to_vec() }
}
