//! Doubts about a run, in words: which camera or limb, what was found and expected, what to do.

use sinew_input::flag::{flag, typed};

/// A doubt about the assumed noise, calibration or sizes.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Doubt {
    /// A camera's keypoints have a constant offset from where they are expected.
    Offset {
        /// Camera.
        camera: String,
        /// Mean residual, pixels.
        offset_px: [f64; 2],
        /// Frames.
        frames: u64,
        /// Standard error of the mean, pixels.
        usual_px: f64,
    },
    /// A camera's keypoints scatter more than assumed.
    Scatter {
        /// Camera.
        camera: String,
        /// Found over assumed.
        ratio: f64,
    },
    /// A camera has more gross errors than assumed.
    Outliers {
        /// Camera.
        camera: String,
        /// Share found, 0 to 1.
        share: f64,
        /// Share assumed.
        expected: f64,
    },
    /// Errors are not independent from frame to frame.
    Persistent {
        /// Cameras and their correlations.
        cameras: Vec<(String, f64)>,
        /// Correlation that the intervals have been widened for; 0 where none.
        held: f64,
    },
    /// The set-up found constant offsets of cameras that are large against their noise: the calibrations of the cameras disagree.
    Calibration {
        /// Cameras and their offsets, pixels.
        cameras: Vec<(String, [f64; 2])>,
        /// Standard deviation per axis of the shift of the world that such offsets hide, metres.
        shift_m: f64,
        /// Whether the intervals of the results include this shift.
        is_in_intervals: bool,
        /// What the other checks of the run say of lengths.
        lengths: Lengths,
    },
    /// A limb's length between the keypoints differs from its length in the body.
    Limb {
        /// Which.
        name: &'static str,
        /// Length between the keypoints over that of the body.
        ratio: f64,
        /// Length in the body, metres.
        body_m: f64,
    },
}

/// What a run's checks found about the lengths of the body's limbs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lengths {
    /// No limb was measured in enough frames.
    Unchecked,
    /// So many kinds of limbs (left and right count once) were measured in enough frames; no limb has a wrong length, and no camera has an offset.
    Undoubted(usize),
    /// There is a [`Doubt::Limb`] or a [`Doubt::Offset`].
    Doubted,
}

/// Where a run has its set-up, its body and its person from: the advice against a doubt depends on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Origins {
    /// Whether the set-up is that of an earlier run.
    pub setup_is_given: bool,
    /// Whether the body was read from a body file; then the set-up does not change its sizes.
    pub body_is_file: bool,
    /// Number of the tracked person, where the run chose one of several by number.
    pub person: Option<usize>,
    /// Whether the density of a keypoint has a share of gross errors, so that the setting `outlier` counts.
    pub has_outlier_share: bool,
}

impl Default for Origins {
    /// Everything was measured in the run itself.
    fn default() -> Self {
        Self { setup_is_given: false, body_is_file: false, person: None, has_outlier_share: true }
    }
}

impl Origins {
    fn offset_advice(self) -> String {
        match self.setup_is_given {
            true => format!(
                "leave {} out, so that this recording is set up itself, or check this camera's calibration",
                flag("setup")
            ),
            false => format!(
                "check this camera's calibration, or whether it was moved; {} chooses the frames that the set-up looks at",
                flag("setup_frames")
            ),
        }
    }

    fn scatter_advice(self) -> String {
        if self.setup_is_given {
            return format!(
                "leave {} out, so that this recording is set up itself, or raise `sigma_px` of the camera in the file given",
                flag("setup")
            );
        }
        let choice = self.person.map(|number| format!("{} {number} ", typed("person"))).unwrap_or_default();
        format!(
            "raise `sigma_px` of the camera in the setup.toml of this run, and give that file with `{choice}{}`",
            typed("setup")
        )
    }

    fn limb_advice(self) -> String {
        match (self.setup_is_given, self.body_is_file) {
            (true, _) => format!("leave {} out, so that sizes are measured again", flag("setup")),
            (false, true) => "leave the body file out, so that sizes are measured, or correct its lengths".into(),
            (false, false) => format!(
                "choose frames for the set-up that show the person better ({}), or give a body file with these lengths ({})",
                flag("setup_frames"),
                flag("body")
            ),
        }
    }
}

/// Correlations that differ by less than this give intervals of nearly the same width.
const NEARLY: f64 = 0.1;

impl Doubt {
    /// The kind in a word.
    #[must_use]
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::Offset { .. } => "offset",
            Self::Scatter { .. } => "scatter",
            Self::Outliers { .. } => "outliers",
            Self::Persistent { .. } => "persistence",
            Self::Calibration { .. } => "calibration",
            Self::Limb { .. } => "limbs",
        }
    }
}

impl Doubt {
    /// The doubt in words, with advice for a run of these origins.
    #[must_use]
    pub fn describe(&self, origins: Origins) -> String {
        match self {
            Self::Offset { camera, offset_px: [u, v], frames, usual_px } => format!(
                "{camera}: keypoints lie {u:+.1} {v:+.1} px from where the tracked body projects, on average over {frames} frames; chance explains {usual_px:.1} px. The intervals do not know of it and hold the truth less often than they promise: {}",
                origins.offset_advice()
            ),
            Self::Scatter { camera, ratio } => format!(
                "{camera}: keypoints scatter {ratio:.1} times as much as the assumed noise. The intervals may be too narrow, by up to that factor (`sinew validate` shows what they hold): {}",
                origins.scatter_advice()
            ),
            Self::Outliers { camera, share, expected } => {
                let advice = match origins.has_outlier_share {
                    true => format!("raise `outlier` to about {share:.2}"),
                    false => "lower `degrees`".into(),
                };
                format!(
                    "{camera}: {:.1} % of the keypoints are gross errors, {:.1} % are assumed. The intervals of the frames that have them may be wrong: {advice}, or leave the camera out",
                    100.0 * share,
                    100.0 * expected,
                )
            }
            Self::Persistent { cameras, held } => {
                let listed: Vec<String> = cameras.iter().map(|(name, r)| format!("{name} {r:.2}")).collect();
                let words = if *held + NEARLY > cameras.iter().map(|(_, r)| *r).fold(0.0, f64::max) {
                    format!(
                        "The intervals are wider for a correlation of {held:.2}, which the set-up found; estimates of successive frames are wrong alike"
                    )
                } else if *held > 0.0 {
                    format!(
                        "The intervals are wider for a correlation of {held:.2}, which the set-up found, and still too narrow: frames repeat what others said, or the body does not fit the person"
                    )
                } else {
                    "The intervals are too narrow, since they take errors as independent: frames repeat what others said, or the body does not fit the person".into()
                };
                format!(
                    "errors of the keypoints persist from frame to frame (correlation {}). {words}",
                    listed.join(", ")
                )
            }
            Self::Calibration { cameras, shift_m, is_in_intervals, lengths } => {
                let listed: Vec<String> =
                    cameras.iter().map(|(name, [u, v])| format!("{name} {u:+.1} {v:+.1} px")).collect();
                format!(
                    "the set-up found cameras that see everything aside of the others ({}). This is taken away, but for the shift of the whole world that it hides: everything may lie some {:.0} mm aside along each axis, all the time, {}. {}",
                    listed.join(", "),
                    1e3 * shift_m,
                    if *is_in_intervals { "which the intervals hold" } else { "and no interval knows of it" },
                    lengths.words()
                )
            }
            Self::Limb { name, ratio, body_m } => format!(
                "{name}: {:.1} % {} between the keypoints than in the body ({:.0} mm, left and right together). The intervals do not know of it and hold the truth less often than they promise: {}",
                100.0 * (ratio - 1.0).abs(),
                if *ratio > 1.0 { "longer" } else { "shorter" },
                1e3 * body_m,
                origins.limb_advice()
            ),
        }
    }
}

impl Lengths {
    fn words(self) -> String {
        match self {
            Self::Undoubted(limbs) => format!(
                "Lengths were checked: {limbs} kinds of limbs are as long between the keypoints as in the body, but for 2 % or chance. Where places matter, calibrate these cameras again"
            ),
            Self::Unchecked => {
                "Too few frames show limbs to check their lengths; calibrate these cameras again before lengths, angles or places are used".into()
            }
            Self::Doubted => {
                "Other checks doubt the lengths or a camera, too (see those warnings): calibrate these cameras again".into()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limb(origins: Origins) -> String {
        Doubt::Limb { name: "thighs", ratio: 1.03, body_m: 0.43 }.describe(origins)
    }

    #[test]
    fn advice_speaks_of_what_the_run_was_given() {
        let measured = Origins::default();
        let given = Origins { setup_is_given: true, ..measured };
        let file = Origins { body_is_file: true, ..measured };
        assert!(limb(given).ends_with("leave `--setup` out, so that sizes are measured again"));
        assert!(limb(file).ends_with("leave the body file out, so that sizes are measured, or correct its lengths"));
        let offset = Doubt::Offset { camera: "C1".into(), offset_px: [1.0, 2.0], frames: 20, usual_px: 0.1 };
        let scatter = Doubt::Scatter { camera: "C1".into(), ratio: 1.5 };
        for words in [limb(measured), offset.describe(measured), scatter.describe(measured)] {
            assert!(!words.contains("leave") && !words.contains("measured again"), "{words}");
        }
        assert!([&offset, &scatter].iter().all(|doubt| doubt.describe(given).contains("leave `--setup` out")));
        let second = Origins { person: Some(2), ..measured };
        assert!(scatter.describe(second).ends_with("give that file with `--person 2 --setup`"));
        let outliers = Doubt::Outliers { camera: "C1".into(), share: 0.1, expected: 0.02 };
        assert!(outliers.describe(measured).contains("raise `outlier` to about 0.10"));
        let student = Origins { has_outlier_share: false, ..measured };
        assert!(!outliers.describe(student).contains("`outlier`"));
    }

    #[test]
    fn lengths_are_called_right_only_where_they_were_checked() {
        let words = |lengths| {
            let cameras = vec![("C1".to_owned(), [3.0, -4.0])];
            Doubt::Calibration { cameras, shift_m: 0.012, is_in_intervals: true, lengths }.describe(Origins::default())
        };
        let all = [Lengths::Unchecked, Lengths::Undoubted(4), Lengths::Doubted].map(words);
        assert_eq!(all.iter().filter(|words| words.contains("as long between the keypoints")).count(), 1);
        assert!(all.iter().all(|words| !words.contains("angles are right") && words.contains("calibrate")));
    }
}
