//! What this crate refuses.

/// Everything that can be wrong with a motion prior.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Sizes do not fit together.
    #[error("{name} has {found} entries; expected {expected}")]
    Shape {
        /// What.
        name: &'static str,
        /// Entries found.
        found: usize,
        /// Entries expected.
        expected: usize,
    },
    /// A standard deviation, time step or entry is outside its range.
    #[error("{name} {index} is {value}; {expected}")]
    OutOfRange {
        /// What.
        name: &'static str,
        /// Place.
        index: usize,
        /// Value found.
        value: f64,
        /// What is allowed.
        expected: &'static str,
    },
    /// A matrix is no covariance.
    #[error("{name} is indefinite: its smallest eigenvalue is {smallest}")]
    Indefinite {
        /// What.
        name: &'static str,
        /// Smallest eigenvalue.
        smallest: f64,
    },
    /// A covariance has no density, whatever is added to its diagonal.
    #[error("{name} has no Cholesky factor, even with {jitter} added to its diagonal")]
    Singular {
        /// What.
        name: &'static str,
        /// Last jitter tried.
        jitter: f64,
    },
    /// A part of a state is none.
    #[error(transparent)]
    Part(#[from] sinew_core::Error),
    /// Two feature vectors have one name.
    #[error("two feature vectors are called \"{name}\"")]
    Duplicate {
        /// The name.
        name: String,
    },
    /// A model has no feature vector of that name.
    #[error("no feature vector is called \"{name}\"; there are: {}", known.join(", "))]
    Unknown {
        /// Name sought.
        name: String,
        /// Names that there are.
        known: Vec<String>,
    },
}
