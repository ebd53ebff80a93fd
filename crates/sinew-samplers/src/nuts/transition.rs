//! The settings of a transition of the no-U-turn sampler, and what one reports.

use crate::Error;
use crate::integrator::{Leapfrog, check_jitter};
use crate::metric::Metric;
use sinew_core::lanes::Isa;

/// Greatest depth by default, as in Stan.
pub const MAX_DEPTH: usize = 10;

/// Steps of the integrator; fixed while chains run.
#[derive(Clone, Debug, PartialEq)]
pub struct Nuts {
    pub(super) leapfrog: Leapfrog,
    pub(super) max_depth: usize,
    pub(super) jitter: f64,
}

impl Nuts {
    /// Steps η A for a metric. A trajectory has at most 2^`max_depth` states.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless the step size and each curvature are positive and finite, 1 ≤ `max_depth` ≤ 30, and 0 ≤ jitter < 1.
    pub fn with_metric(
        step_size: f64,
        metric: &Metric,
        max_depth: usize,
        jitter: f64,
        isa: Isa,
    ) -> Result<Self, Error> {
        let leapfrog = Leapfrog::new(step_size, metric, isa)?;
        check_jitter(jitter)?;
        if !(1..=30).contains(&max_depth) {
            let (name, value) = ("greatest depth", max_depth as f64);
            return Err(Error::OutOfRange { name, value, expected: "must be from 1 to 30" });
        }
        Ok(Self { leapfrog, max_depth, jitter })
    }
}

/// A completed transition of one chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TreeTransition {
    /// Mean over the new states of min(1, exp(H₀ − H)).
    pub acceptance: f64,
    /// Doublings that were kept.
    pub depth: usize,
    /// Gradients it took.
    pub leapfrog_steps: usize,
    /// Whether it met a divergence.
    pub divergent: bool,
    /// Whether it ended in another state than it began.
    pub moved: bool,
    /// Hamiltonian of the resulting state.
    pub energy: f64,
    /// Factor of the step size (jitter).
    pub factor: f64,
}
