//! What this crate refuses.

/// Everything that can be wrong with a latent model.
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
    /// A number is outside its range.
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
    /// A covariance has no Cholesky factor, whatever is added to its diagonal.
    #[error("the covariance of {rows} rows has no Cholesky factor, even with {jitter} added to its diagonal")]
    Singular {
        /// Side of the matrix.
        rows: usize,
        /// Last jitter tried.
        jitter: f64,
    },
    /// The objective overflows.
    #[error("the objective of the model is not finite; expected finite latents and parameters of moderate size")]
    NotFinite,
    /// A model whose latents have no dynamics.
    #[error("the model has no dynamics; expected one of kind gpdm or hgplvm")]
    NoDynamics,
    /// A model with several roots, where one is needed.
    #[error("the model has {found} roots, one a motion; expected one root over all motions")]
    Roots {
        /// Roots found.
        found: usize,
    },
    /// Nodes that make no tree of latent spaces.
    #[error(transparent)]
    Tree(#[from] sinew_core::Error),
    /// More of something than a model from a file may have.
    #[error("{found} {name}; expected at most {most}")]
    TooMany {
        /// What.
        name: &'static str,
        /// Number found.
        found: usize,
        /// Number allowed.
        most: usize,
    },
    /// What a file says of its model cannot be.
    #[error("`{key}` is {found}; expected {expected}")]
    Head {
        /// Where it says so.
        key: &'static str,
        /// What it says.
        found: String,
        /// What is allowed.
        expected: &'static str,
    },
    /// A file that calls a model what it is not.
    #[error("`kind` is {kind}, which does not fit a model of {nodes} {} {} dynamics", if *nodes == 1 { "node" } else { "nodes" }, if *has_dynamics { "with" } else { "without" })]
    Kind {
        /// Kind that the file names.
        kind: &'static str,
        /// Nodes of the model.
        nodes: usize,
        /// Whether its latents have dynamics.
        has_dynamics: bool,
    },
    /// Principal components do not exist.
    #[error(transparent)]
    Principal(#[from] sinew_dynamics::Error),
}
