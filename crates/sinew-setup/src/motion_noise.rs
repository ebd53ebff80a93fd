//! Motion noise of a body: how far each degree of freedom moves in a square-root second.
//!
//! The prior between frames is a random walk. Its noise is measured at set-up ([`measured_sd`]) from the poses fitted to consecutive frames: with differences `d = x_{t+1} − x_t`
//! and second differences `e = x_{t+1} − 2 x_t + x_{t−1}` of a smooth motion x seen with white errors of variance n, `E d² = v² + 2n` and `E e² = 6n` (but for
//! the acceleration), so that the step to be expected is `v² = E d² − E e²/3`. At least half of `E d²` is taken for motion: where limbs swing fast, e is acceleration and not error.

use sinew_body::{Joint, KinematicTree};

/// Least noise, metres and radians per square-root second.
const LEAST: [f64; 2] = [0.1, 0.3];

/// Noise of a recording without a measurement: that of brisk walking, metres and radians per square-root second.
const BRISK: [f64; 2] = [0.25, 0.8];

/// Uncertainty of a fitted first pose, metres and radians. What keypoints do not show, as the turn of the spine about itself, keeps this spread for many frames.
const INITIAL: [f64; 2] = [0.05, 0.12];

fn by_kind(tree: &KinematicTree, [metres, radians]: [f64; 2]) -> Vec<f64> {
    let value = |(_, joint)| if matches!(joint, Joint::Translate(_)) { metres } else { radians };
    tree.joints().map(value).collect()
}

/// Motion noise where nothing was measured.
#[must_use]
pub fn default_sd(tree: &KinematicTree) -> Vec<f64> {
    by_kind(tree, BRISK)
}

/// Spread of the first frame about its fitted pose.
#[must_use]
pub fn initial_sd(tree: &KinematicTree) -> Vec<f64> {
    by_kind(tree, INITIAL)
}

/// Motion noise measured from poses of consecutive frames, `None` where there was none.
#[must_use]
pub fn measured_sd(tree: &KinematicTree, poses: &[Option<Vec<f64>>], fps: f64) -> Vec<f64> {
    let least = by_kind(tree, LEAST);
    let mut sums = vec![(0.0, 0.0); tree.dof()];
    let mut count = 0.0;
    for window in poses.windows(3) {
        let [Some(a), Some(b), Some(c)] = window else { continue };
        count += 1.0;
        for (j, (first, second)) in sums.iter_mut().enumerate() {
            *first += 0.5 * ((c[j] - b[j]).powi(2) + (b[j] - a[j]).powi(2));
            *second += (c[j] - 2.0 * b[j] + a[j]).powi(2);
        }
    }
    if count < 10.0 {
        return default_sd(tree);
    }
    let own: Vec<f64> =
        sums.iter().map(|(first, second)| ((first - second / 3.0).max(0.5 * first) / count * fps).sqrt()).collect();
    own.into_iter().zip(least).map(|(sd, least)| sd.max(least)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::Proportions;
    use sinew_body::standard::h32;

    #[test]
    fn the_step_of_a_smooth_motion_is_separated_from_white_errors() {
        let tree = h32(&Proportions::default());
        let poses: Vec<_> = (0..200)
            .map(|t| {
                let error = if t % 2 == 0 { 0.01 } else { -0.01 } * if t % 3 == 0 { 1.0 } else { 0.6 };
                Some(vec![2.0 * f64::from(t) / 50.0 + error; tree.dof()])
            })
            .collect();
        // A step of 0.04 in each 1/50 s is a noise of 0.04 · √50 per square-root second.
        for sd in measured_sd(&tree, &poses, 50.0) {
            assert!((sd - 0.04 * 50.0_f64.sqrt()).abs() < 0.02, "{sd}");
        }
        assert_eq!(measured_sd(&tree, &poses[..5], 50.0), default_sd(&tree));
    }
}
