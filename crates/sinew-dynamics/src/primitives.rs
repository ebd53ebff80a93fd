//! Motion by action primitives (Husz, Wallace & Green 2007): clusters of short pieces of recorded motion.
pub mod check;
pub mod density;
pub mod file;
pub mod learning;
#[cfg(test)]
pub(crate) mod made_up;
mod matched;
pub mod matching;
pub mod model;
pub mod motion;
mod places;
pub mod summary;
pub mod switching;
pub mod windows;
