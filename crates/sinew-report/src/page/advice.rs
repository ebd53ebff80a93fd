//! What to do about doubts that do not say it themselves, by words that they have.
//!
//! The words and the advice are rows of the guide's page on warnings; a test holds them together.

use sinew_input::flag::{flag, flag_with};

/// Words of doubts with what to do.
fn rows() -> [(&'static str, String); 6] {
    [
        ("one camera: depth comes from the prior only", "use two cameras for measurements".into()),
        (
            "errors of the keypoints persist from frame to frame",
            "expected on real recordings; with a set-up that does not know of it read intervals as lower bounds".into(),
        ),
        ("more than three times the noise of", "`sinew inspect Calib.toml pose`".into()),
        (
            "split R-hat is above",
            format!(
                "{}; with one or two cameras the posterior is curved, and some frames stay doubtful",
                flag_with("updates", 96)
            ),
        ),
        (
            "trajectories diverged",
            format!(
                "run without {}, so that the step size is measured on this recording; or {}",
                flag("setup"),
                flag_with("updates", 64)
            ),
        ),
        (
            "the median effective sample size is",
            format!(
                "a particle method with too few particles: {} more, or {}",
                flag("particles"),
                flag_with("method", "hmc")
            ),
        ),
    ]
}

/// What to do, where the guide says more than the doubt.
pub(super) fn advice(warning: &str) -> Option<String> {
    rows().into_iter().find(|(words, _)| warning.contains(words)).map(|(_, advice)| advice)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_stands_in_the_guide() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/guide/warnings.md");
        let page = std::fs::read_to_string(page).expect("the page").replace('\n', " ");
        for (words, advice) in rows() {
            assert!(page.contains(words), "{words}");
            assert!(page.contains(&advice), "{advice}");
        }
    }

    #[test]
    fn warnings_find_their_advice() {
        assert_eq!(advice("split R-hat is above 1.05 in 9 frames"), Some(rows()[3].1.clone()));
        assert_eq!(advice("something else"), None);
    }
}
