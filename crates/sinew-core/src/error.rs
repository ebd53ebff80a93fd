//! What this crate refuses.

/// Everything that can be wrong with parts of a state and with matrices.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A part needs at least one coordinate.
    #[error("a part of a state needs at least one index")]
    EmptyPart,
    /// A coordinate does not exist.
    #[error("index {index} is outside a state of dimension {dim}")]
    IndexOutOfRange {
        /// Index found.
        index: usize,
        /// Dimension of the state.
        dim: usize,
    },
    /// A coordinate occurs twice.
    #[error("index {index} occurs twice")]
    DuplicateIndex {
        /// Index found.
        index: usize,
    },
    /// A partition leaves a coordinate out.
    #[error("index {index} belongs to no part")]
    Uncovered {
        /// Missing index.
        index: usize,
    },
    /// A tree needs one parent entry for each part.
    #[error("{parents} parents for {parts} parts")]
    ParentCount {
        /// Number of parts.
        parts: usize,
        /// Number of parent entries.
        parents: usize,
    },
    /// A matrix has rows of one length.
    #[error("{entries} entries are no rows of {columns}")]
    Rows {
        /// Number of entries.
        entries: usize,
        /// Length of a row.
        columns: usize,
    },
    /// Parents come before their children.
    #[error("the parent of part {part} does not come before it")]
    ParentNotBefore {
        /// Part at fault.
        part: usize,
    },
    /// A decoder has another dimension than what is made of it.
    #[error("the {name} has {found} coordinates; expected {expected}")]
    Dimension {
        /// What.
        name: &'static str,
        /// Coordinates found.
        found: usize,
        /// Coordinates expected.
        expected: usize,
    },
    /// A probability is outside 0 to 1.
    #[error("the probability {value} is not in [0, 1]")]
    Probability {
        /// Value found.
        value: f64,
    },
    /// The first node of a hierarchy is its root, and no other.
    #[error("node {node} should be the root, or has no parent and is not the first")]
    Root {
        /// Node at fault.
        node: usize,
    },
    /// A node of a hierarchy does not fit the others, or its own coordinates.
    #[error("node {node}: {name} is {found}; expected {expected}")]
    NodeDimension {
        /// Node at fault.
        node: usize,
        /// What of it.
        name: &'static str,
        /// Number found.
        found: usize,
        /// Number expected.
        expected: usize,
    },
    /// A node of a hierarchy covers what its children cover.
    #[error("node {node} has other coordinates than its children together")]
    NodeCoordinates {
        /// Node at fault.
        node: usize,
    },
}
