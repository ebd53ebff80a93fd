//! Vocabulary.
pub mod elementary;
pub mod lanes;
