//! How often a detector takes something for something else, before a recording is seen.
//!
//! The means are chosen, not measured: one limb in a hundred frames, one keypoint in two hundred where others are in view. They are worth little: a second of a recording outweighs them.

/// A Beta distribution by its mean and how many trials it is worth.
pub(super) struct Beta {
    mean: f64,
    worth: f64,
}

/// Exchanged sides of a pair of limbs in a frame.
pub(super) const EXCHANGED: Beta = Beta { mean: 0.01, worth: 50.0 };
/// A keypoint of somebody else, in a frame that shows others.
pub(super) const ELSEWHERE: Beta = Beta { mean: 0.005, worth: 200.0 };

/// Probability of exchanged sides where none was measured.
pub(super) const fn usual_exchanged() -> f64 {
    EXCHANGED.mean
}

/// Probability of somebody else's keypoint where none was measured.
pub(super) const fn usual_elsewhere() -> f64 {
    ELSEWHERE.mean
}

impl Beta {
    /// Mean given the probabilities that some trials succeeded.
    pub fn given(&self, probabilities: &[f64]) -> f64 {
        (self.worth * self.mean + probabilities.iter().sum::<f64>()) / (self.worth + probabilities.len() as f64)
    }
}
