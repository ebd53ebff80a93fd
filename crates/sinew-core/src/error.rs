//! What this crate refuses.

/// Everything that can be wrong with parts of a state and with matrices.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
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
}
