//! What to do about doubts that do not say it themselves, by words that they have.
//!
//! The words and the advice are rows of the guide's page on warnings; a test holds them together.

/// Words of doubts with what to do.
const ADVICE: [(&str, &str); 6] = [
    ("one camera: depth comes from the prior only", "use two cameras for measurements"),
    (
        "errors of the keypoints persist from frame to frame",
        "expected on real recordings; with a set-up that does not know of it read intervals as lower bounds",
    ),
    ("more than three times the noise of", "`sinew inspect Calib.toml pose`"),
    (
        "split R-hat is above",
        "`--updates 96`; with one or two cameras the posterior is curved, and some frames stay doubtful",
    ),
    (
        "trajectories diverged",
        "run without `--setup`, so that the step size is measured on this recording; or `--updates 64`",
    ),
    (
        "the median effective sample size is",
        "a particle method with too few particles: `--particles` more, or `--method hmc`",
    ),
];

/// What to do, where the guide says more than the doubt.
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
        assert_eq!(advice("split R-hat is above 1.05 in 9 frames"), Some(ADVICE[3].1));
        assert_eq!(advice("something else"), None);
    }
}
