//! What to do about a warning, by words that it has.
//!
//! The words and the advice are rows of the guide's page on warnings; a test holds them together.

/// Parts of warnings with what to do. `…` stands for what differs.
const ADVICE: [(&str, &str); 12] = [
    ("fit when the calibrations of", "swap the two names in `Calib.toml`, or the two folders"),
    ("one camera: depth comes from the prior only", "use two cameras for measurements"),
    ("keypoints lie", "run without `--setup`, or check the camera"),
    ("keypoints scatter", "run without `--setup`, or raise `sigma_px` in `setup.toml`"),
    ("of the keypoints are gross errors", "raise `--outlier` to the value that is named"),
    (
        "errors of the keypoints persist from frame to frame",
        "expected on real recordings; with a set-up that does not know of it read intervals as lower bounds",
    ),
    ("between the keypoints than in the body", "run without `--setup` and `--body`"),
    ("records", "resample the keypoints to one rate"),
    ("more than three times the noise of", "`sinew inspect Calib.toml pose`, then as above"),
    ("split R-hat is above", "`--updates 96`; with one or two cameras the posterior is curved, and some frames stay doubtful"),
    ("trajectories diverged", "run without `--setup`, so that the step size is measured on this recording; or `--updates 64`"),
    ("the median effective sample size is", "a particle method with too few particles: `--particles` more, or `--method hmc`"),
];

/// What to do, if the guide says more than the warning.
pub(super) fn advice(warning: &str) -> Option<&'static str> {
    ADVICE.iter().find(|(words, _)| warning.contains(words)).map(|(_, advice)| *advice)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_stands_in_the_guide() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/guide/warnings.md");
        let page = std::fs::read_to_string(page).expect("the page").replace('\n', " ");
        for (words, advice) in ADVICE {
            assert!(page.contains(words), "{words}");
            assert!(page.contains(advice), "{advice}");
        }
    }

    #[test]
    fn warnings_find_their_advice() {
        assert_eq!(advice("cam_01: keypoints scatter 1.3 times as much"), Some(ADVICE[3].1));
        assert_eq!(advice("something else"), None);
    }
}
