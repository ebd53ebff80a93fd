//! How long errors of keypoints last, and how many of them recordings share, from the residuals of frames.

use super::lasting_errors::LASTING_SHARE;
use sinew_core::estimators::mean;
use sinew_observe::lasting::lasting_errors::{FrameResidual, LinearisedFrame};

/// Residuals of each camera, point and axis, frame after frame, in standard deviations of the detector's noise, less their mean; NaN where there is none, and for gross errors, which do not last.
pub(super) struct Residuals(Vec<Vec<f64>>);

impl Residuals {
    pub(super) fn new(frames: &[LinearisedFrame], cameras: usize, points: usize) -> Self {
        const GROSS: f64 = 4.0;
        let mut series = vec![vec![f64::NAN; frames.len()]; 2 * cameras * points];
        for (f, frame) in frames.iter().enumerate() {
            for &FrameResidual { camera, point, residual_px, noise_px2, .. } in &frame.residuals {
                for (axis, px) in residual_px.into_iter().enumerate() {
                    let scaled = px / noise_px2.sqrt();
                    let kept = if scaled.abs() < GROSS { scaled } else { f64::NAN };
                    series[2 * (camera * points + point) + axis][f] = kept;
                }
            }
        }
        for series in &mut series {
            let known: Vec<f64> = series.iter().copied().filter(|r| r.is_finite()).collect();
            let mean = mean(&known);
            series.iter_mut().for_each(|r| *r -= mean);
        }
        Self(series)
    }

    /// Correlation of the residuals of pairs of frames, and how many pairs of residuals it is of.
    fn correlation(&self, pairs: &[(usize, usize)]) -> (f64, f64) {
        let (mut product, mut square, mut count) = (0.0, 0.0, 0.0);
        for series in &self.0 {
            let both = pairs.iter().map(|&(one, other)| (series[one], series[other]));
            for (one, other) in both.filter(|(one, other)| one.is_finite() && other.is_finite()) {
                product += one * other;
                square += 0.5 * (one.powi(2) + other.powi(2));
                count += 1.0;
            }
        }
        (product / square, count)
    }

    /// Correlation of the residuals of successive frames of a stretch, and how many pairs it is of; `stretches` says in which stretch each frame is.
    pub(super) fn successive_correlation(&self, stretches: &[usize]) -> (f64, f64) {
        let pairs = (1..stretches.len()).map(|frame| (frame - 1, frame));
        self.correlation(&pairs.filter(|&(one, other)| stretches[one] == stretches[other]).collect::<Vec<_>>())
    }

    /// How many times over the stretches tell the same: 1 + (n − 1) ρ for n stretches, with ρ the correlation of the residuals of each frame with those of the frame of every other stretch in which the person's points, `bodies`, are most alike. Errors of a detector come from what it sees. Of n copies of a recording it is n where ρ is 1; 1 where errors of alike frames have nothing in common.
    pub(super) fn redundancy(&self, stretches: &[usize], bodies: &[Vec<f64>]) -> f64 {
        let apart = |one: usize, other: usize| -> f64 {
            bodies[one].iter().zip(&bodies[other]).map(|(a, b)| (a - b).powi(2)).sum()
        };
        let of_stretch: Vec<Vec<usize>> = (0..stretches.len())
            .collect::<Vec<_>>()
            .chunk_by(|&a, &b| stretches[a] == stretches[b])
            .map(<[_]>::to_vec)
            .collect();
        let alike = |frame: usize| {
            let others = of_stretch.iter().filter(move |own| stretches[own[0]] != stretches[frame]);
            others
                .filter_map(move |own| own.iter().copied().min_by(|&a, &b| apart(frame, a).total_cmp(&apart(frame, b))))
        };
        let pairs: Vec<(usize, usize)> =
            (0..stretches.len()).flat_map(|frame| alike(frame).map(move |other| (frame, other))).collect();
        let (shared, count) = self.correlation(&pairs);
        if count > 0.0 { 1.0 + (of_stretch.len() as f64 - 1.0) * shared.max(0.0) } else { 1.0 }
    }
}

/// The time constant τ of errors whose correlation after some seconds is `found`, of as many independent `pairs`: the most probable with ln τ ~ N(ln 0.1, 1) and Fisher's variance (1 − ρ²)²/n. The prior without pairs.
pub(super) fn persistence_s(found: f64, pairs: f64, seconds: f64) -> f64 {
    const USUAL_S: f64 = 0.1;
    const CELLS: i32 = 400;
    const REACH: f64 = 5.0;
    let log = |z: f64| {
        let expected = LASTING_SHARE * (-seconds / (USUAL_S * z.exp())).exp();
        let said = if pairs > 0.0 { pairs * ((found - expected) / (1.0 - expected * expected)).powi(2) } else { 0.0 };
        -0.5 * (said + z * z)
    };
    let cells = (-CELLS..=CELLS).map(|cell| REACH * f64::from(cell) / f64::from(CELLS));
    USUAL_S * cells.max_by(|a, b| log(*a).total_cmp(&log(*b))).map_or(1.0, f64::exp)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_constant_is_that_of_the_correlation_where_there_are_many_pairs() {
        let after = |seconds: f64, tau: f64| LASTING_SHARE * (-seconds / tau).exp();
        for (seconds, tau) in [(1.0 / 60.0, 0.1), (0.1, 0.3), (1.0 / 60.0, 0.02)] {
            let found = persistence_s(after(seconds, tau), 1e5, seconds);
            assert!((found / tau).ln().abs() < 0.02, "{found} for {tau}");
        }
        assert_eq!(persistence_s(f64::NAN, 0.0, 0.1), 0.1);
        let white = persistence_s(0.0, 1e4, 1.0 / 60.0);
        assert!(after(1.0 / 60.0, white) < 0.03, "{white}");
    }

    /// How many times over four stretches of 20 frames tell the same, where the error in frame `at` of a stretch is `error(stretch, at)` for each of 50 points, and what the frames show is at `place(stretch, at)`.
    fn redundancy_of_four(error: impl Fn(usize, usize, usize) -> f64, place: impl Fn(usize, usize) -> f64) -> f64 {
        let places: Vec<(usize, usize)> = (0..4).flat_map(|stretch| (0..20).map(move |at| (stretch, at))).collect();
        let frame = |&(stretch, at): &(usize, usize)| {
            let residual = |point| {
                let residual_px = [error(stretch, at, point), error(stretch, at, point + 50)];
                FrameResidual { camera: 0, point, residual_px, noise_px2: 1.0, by_model_error: 0.0 }
            };
            LinearisedFrame { residuals: (0..50).map(residual).collect(), ..LinearisedFrame::default() }
        };
        let frames: Vec<LinearisedFrame> = places.iter().map(frame).collect();
        let stretches: Vec<usize> = places.iter().map(|(stretch, _)| *stretch).collect();
        let bodies: Vec<Vec<f64>> = places.iter().map(|&(stretch, at)| vec![place(stretch, at), 0.0, 0.0]).collect();
        Residuals::new(&frames, 1, 50).redundancy(&stretches, &bodies)
    }

    /// Numbers without order, of variance 1.
    fn scattered(a: usize, b: usize) -> f64 {
        let x = ((a * 7919 + b * 104_729 + 13) as f64 * 12.9898).sin() * 43_758.545_3;
        ((x - x.floor()) - 0.5) * 12_f64.sqrt()
    }

    #[test]
    fn copies_tell_nothing_new_and_recordings_with_errors_of_their_own_do() {
        let along = |_: usize, at: usize| at as f64;
        let copies = redundancy_of_four(|_, at, point| scattered(at, point), along);
        assert!((copies - 4.0).abs() < 1e-9, "{copies}");
        let own = |stretch: usize, at: usize, point: usize| scattered(20 * stretch + at, point);
        let different = redundancy_of_four(own, along);
        assert!(different < 1.1, "{different}");
        // Half of the variance of the errors comes from what is seen: 1 + 3 · ½.
        let half =
            redundancy_of_four(|s, at, point| (scattered(at, point) + own(s + 4, at, point)) * 0.5_f64.sqrt(), along);
        assert!((half - 2.5).abs() < 0.15, "{half}");
        // The same errors, but of other poses: nothing alike is seen.
        let elsewhere =
            redundancy_of_four(|_, at, point| scattered(at, point), |stretch, at| ((at + 5 * stretch) % 20) as f64);
        assert!(elsewhere < 1.1, "{elsewhere}");
        assert_eq!(Residuals::new(&[], 1, 50).redundancy(&[], &[]), 1.0);
    }
}
