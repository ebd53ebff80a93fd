//! Why a result cannot be held against a reference.

use std::path::PathBuf;

/// A result and a reference that cannot be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// A name of the mapping that is not there.
    #[error("`{name}` of the mapping is no point of the {whose}{}", suggested(nearest))]
    NoSuchName {
        /// The name.
        name: String,
        /// Of which side.
        whose: &'static str,
        /// A name that is there and may be meant.
        nearest: Option<String>,
    },
    /// Names that have nothing in common.
    #[error("{}: {found} of its {what} are {what} of the result; {needed} are needed. It has {}", reference.display(), shown(names))]
    TooFewNames {
        /// Reference.
        reference: PathBuf,
        /// `points` or `angles`.
        what: &'static str,
        /// How many are.
        found: usize,
        /// How many are needed.
        needed: usize,
        /// Names of the reference.
        names: Vec<String>,
    },
    /// A reference that never has a value where the result has one.
    #[error("{}: {found} frames of the result have a value of it beside them; {needed} are needed", reference.display())]
    TooFewFrames {
        /// Reference.
        reference: PathBuf,
        /// Frames with a value.
        found: usize,
        /// Frames that are needed.
        needed: usize,
    },
    /// Points that leave the turn between two worlds open.
    #[error("{}: its points lie on a line, which leaves the turn of its world open", .0.display())]
    OnALine(PathBuf),
    /// Times of a reference that do not rise.
    #[error("{}: its times do not rise", .0.display())]
    Times(PathBuf),
    /// A scale or a space for angles.
    #[error("{} holds angles, which have neither place nor size", .0.display())]
    SpaceOfAngles(PathBuf),
}

fn suggested(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or_else(String::new, |name| format!("; did you mean `{name}`?"))
}

/// Names that are listed in a message, at most.
const SHOWN: usize = 12;

fn shown(names: &[String]) -> String {
    let listed = names.iter().take(SHOWN).map(String::as_str).collect::<Vec<_>>().join(", ");
    if names.len() > SHOWN { format!("{listed} and {} more", names.len() - SHOWN) } else { listed }
}
