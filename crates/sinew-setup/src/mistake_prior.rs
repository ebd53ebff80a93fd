//! How often a detector takes something for something else, before a recording is seen.
//!
//! The means are chosen, not measured: one limb in a hundred frames, one keypoint in two hundred where others are in view. They are worth little: a second of a recording outweighs them.

/// Largest probability of a mistake: a detector is right more often than not, and set-ups hold less than a half.
const MOST: f64 = 0.45;

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
    /// Mean given the probabilities that some trials succeeded, at most [`MOST`].
    pub fn given(&self, probabilities: &[f64]) -> f64 {
        let mean =
            (self.worth * self.mean + probabilities.iter().sum::<f64>()) / (self.worth + probabilities.len() as f64);
        mean.min(MOST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Without frames the prior's mean, with many their share, and never a half.
    #[test]
    fn a_recording_outweighs_the_prior() {
        assert!((EXCHANGED.given(&[]) - 0.01).abs() < 1e-12);
        let share = EXCHANGED.given(&[vec![1.0; 100], vec![0.0; 900]].concat());
        assert!((share - 0.0957).abs() < 1e-4, "{share}");
        assert!(EXCHANGED.given(&[1.0; 1000]) < 0.5 && ELSEWHERE.given(&[1.0; 1000]) < 0.5);
    }
}
