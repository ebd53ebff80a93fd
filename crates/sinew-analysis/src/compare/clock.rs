//! Where in time a reference belongs: the offset of least misfit.
//! All offsets are searched that leave half of the shorter recording in common.

/// Step of the first search, seconds; people move by less than 5 Hz.
const STEP_S: f64 = 0.04;

/// Offsets at least so far from the best are other answers, seconds.
const APART_S: f64 = 0.3;

/// Misfit of another offset over that of the best, root mean square, from which on it is no rival.
const RIVAL: f64 = 1.15;

/// Accuracy of the offset, seconds.
const FINE_S: f64 = 1e-6;

/// Another offset that fits nearly as well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RivalOffset {
    /// Offset, seconds.
    pub offset_s: f64,
    /// Its misfit over that of the best, root mean square.
    pub ratio: f64,
}

/// The offset of least misfit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BestOffset {
    pub(super) offset_s: f64,
    pub(super) rival: Option<RivalOffset>,
}

/// Offsets (time of the reference less that of the result) at which half of the shorter recording overlaps.
pub(super) fn possible(ours_s: [f64; 2], reference_s: [f64; 2]) -> [f64; 2] {
    let least = 0.5 * (ours_s[1] - ours_s[0]).min(reference_s[1] - reference_s[0]);
    [reference_s[0] - ours_s[1] + least, reference_s[1] - ours_s[0] - least]
}

/// The offset of least misfit between two, by `coarse` on a grid and by `fine` within its step; both are mean squares, `None` where nothing can be compared.
pub(super) fn best_offset(
    [from, to]: [f64; 2],
    coarse: impl Fn(f64) -> Option<f64>,
    fine: impl Fn(f64) -> Option<f64>,
) -> Option<BestOffset> {
    let steps = ((to - from) / STEP_S).ceil().max(1.0);
    let offset = |k: usize| from + (to - from) * k as f64 / steps;
    let misfits: Vec<f64> = (0..=steps as usize).map(|k| coarse(offset(k)).unwrap_or(f64::INFINITY)).collect();
    let (best, least) = misfits.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1))?;
    if !least.is_finite() {
        return None;
    }
    let value = |k: usize| misfits.get(k).copied().unwrap_or(f64::INFINITY);
    let is_low = |k: &usize| value(*k) <= value(k + 1) && (*k == 0 || value(*k) <= value(k - 1));
    let others = (0..misfits.len()).filter(is_low).filter(|k| (offset(*k) - offset(best)).abs() >= APART_S);
    let rival = others
        .min_by(|a, b| value(*a).total_cmp(&value(*b)))
        .map(|k| RivalOffset { offset_s: offset(k), ratio: (value(k) / least).sqrt() });
    let step = (to - from) / steps;
    let bounds = [(offset(best) - step).max(from), (offset(best) + step).min(to)];
    let offset_s = golden(bounds, |offset| fine(offset).unwrap_or(f64::INFINITY));
    Some(BestOffset { offset_s, rival: rival.filter(|rival| rival.ratio < RIVAL) })
}

/// The least of a function with one minimum (golden section).
fn golden([mut low, mut high]: [f64; 2], value: impl Fn(f64) -> f64) -> f64 {
    let share = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut left, mut right) = (high - share * (high - low), low + share * (high - low));
    let (mut at_left, mut at_right) = (value(left), value(right));
    while high - low > FINE_S {
        if at_left <= at_right {
            (high, right, at_right) = (right, left, at_left);
            left = high - share * (high - low);
            at_left = value(left);
        } else {
            (low, left, at_left) = (left, right, at_right);
            right = low + share * (high - low);
            at_right = value(right);
        }
    }
    0.5 * (low + high)
}

/// Frames, evenly spaced, `most` of them at most.
pub(super) fn thinned(frames: usize, most: usize) -> impl Iterator<Item = usize> + Clone {
    (0..frames).step_by(frames.div_ceil(most).max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_shorter_recording_overlaps() {
        assert_eq!(possible([0.0, 10.0], [100.0, 104.0]), [92.0, 102.0]);
        assert_eq!(possible([0.0, 4.0], [0.0, 4.0]), [-2.0, 2.0]);
    }

    #[test]
    fn the_least_of_several_minima_is_found_and_a_near_one_named() {
        let waves = |depth: f64| move |x: f64| Some(1.0 + depth * (x - 1.234).abs() - (6.0 * (x - 1.234)).cos());
        let found = best_offset([-5.0, 5.0], waves(0.2), waves(0.2)).unwrap();
        assert!((found.offset_s - 1.234).abs() < 1e-5 && found.rival.is_none(), "{found:?}");
        let flat = |x: f64| Some(1.0 + 0.01 * (x - 1.234).abs() - 0.5 * (6.0 * (x - 1.234)).cos());
        let found = best_offset([-5.0, 5.0], flat, flat).unwrap();
        let rival = found.rival.unwrap();
        assert!((found.offset_s - 1.234).abs() < 1e-3, "{found:?}");
        assert!(((rival.offset_s - 1.234).abs() - 1.047).abs() < 0.05 && rival.ratio < 1.1, "{rival:?}");
        assert!(best_offset([0.0, 1.0], |_| None, |_| None).is_none());
    }

    #[test]
    fn frames_are_thinned_evenly() {
        assert_eq!(thinned(10, 4).collect::<Vec<_>>(), [0, 3, 6, 9]);
        assert_eq!(thinned(3, 100).count(), 3);
        assert_eq!(thinned(0, 100).count(), 0);
    }
}
