//! What this crate refuses.

/// Everything that can be wrong with weights, sizes and step sizes.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A set of particles or chains needs at least one member and one coordinate.
    #[error("{count} states of dimension {dim}; both must be at least 1")]
    Empty {
        /// Number of states.
        count: usize,
        /// Dimension of the state.
        dim: usize,
    },
    /// Numbers that are to be states of one dimension, one after the other.
    #[error("{numbers} numbers are no states of dimension {dim}")]
    Uneven {
        /// Numbers found.
        numbers: usize,
        /// Dimension of the state.
        dim: usize,
    },
    /// No state explains the observation.
    #[error("all {count} weights are zero")]
    AllWeightsZero {
        /// Number of weights.
        count: usize,
    },
    /// A log weight is NaN or +∞.
    #[error("log weight {index} is {value}")]
    BadWeight {
        /// Place of the weight.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A step size, curvature, jitter or length is outside its range.
    #[error("{name} is {value}; {expected}")]
    OutOfRange {
        /// What.
        name: &'static str,
        /// Value found.
        value: f64,
        /// What is allowed.
        expected: &'static str,
    },
    /// A chain starts where the log density is not finite.
    #[error("chain {lane} starts at a log density of {value}")]
    BadStart {
        /// Lane of the chain.
        lane: usize,
        /// The log density.
        value: f64,
    },
    /// A state, or a number of states, of another length than is needed.
    #[error("{what} has the length {found}; expected {expected}")]
    Length {
        /// What.
        what: &'static str,
        /// Length found.
        found: usize,
        /// Length needed.
        expected: usize,
    },
    /// A gradient is not that of its density.
    #[error(
        "entry {coordinate} of the gradient is {found}, and the difference of the density there is {difference}; check the derivative"
    )]
    Gradient {
        /// Place of the entry.
        coordinate: usize,
        /// The gradient's entry.
        found: f64,
        /// Difference of the log density.
        difference: f64,
    },
    /// No step size has the wanted acceptance.
    #[error(
        "no step size accepts {target} of the trajectories: at {step_size} after {tried} halvings or doublings it is {acceptance}"
    )]
    StepSizeNotFound {
        /// Acceptance wanted.
        target: f64,
        /// Last step size.
        step_size: f64,
        /// Its acceptance.
        acceptance: f64,
        /// Halvings or doublings done.
        tried: usize,
    },
    /// A metric must be a finite, positive definite matrix.
    #[error("the metric is not a finite, positive definite matrix; is the prior or an observation without bounds?")]
    Metric,
    /// Tempering does not get from the prior to the posterior.
    #[error("after {count} temperatures the exponent of the likelihood is {beta} and not 1")]
    TooManyTemperatures {
        /// Temperatures so far.
        count: usize,
        /// The last exponent.
        beta: f64,
    },
}
