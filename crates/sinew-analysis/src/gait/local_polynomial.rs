//! Value, slope and curvature of a series at any time, by a polynomial fitted to the frames near it.
//!
//! ```text
//! minimise Σ_k K((t_k − t)/h) (x_k − Σ_j β_j (t_k − t)^j)²        j = 0 … 3,  K(u) = (1 − |u|³)³
//! value β₀, slope β₁, curvature 2 β₂
//! ```
//!
//! Fan & Gijbels, *Local Polynomial Modelling and Its Applications* (1996), section 3.1; with equal weights on a grid it is the filter of Savitzky & Golay, Anal. Chem. 36 (1964) 1627. All three are linear in x, so that a fit is a set of weights of the frames: it serves the mean and every draw. Polynomials up to the third degree come back exactly.

use nalgebra::{Matrix4, Vector4};

/// Frames that a fit needs: one more than it has coefficients.
const LEAST_FRAMES: usize = 5;

/// Weights of frames in the value, the slope (per second) and the curvature (per second²) of a series at a time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LocalFit {
    /// First frame of the weights.
    first: usize,
    weights: [Vec<f64>; 3],
}

impl LocalFit {
    /// The fit at a time, of rising times in seconds; `None` where too few frames are near.
    pub(super) fn at(times_s: &[f64], time_s: f64, half_width_s: f64) -> Option<Self> {
        let first = times_s.partition_point(|t| *t <= time_s - half_width_s);
        let end = times_s.partition_point(|t| *t < time_s + half_width_s);
        if end.saturating_sub(first) < LEAST_FRAMES {
            return None;
        }
        let near: Vec<(f64, Vector4<f64>)> = times_s[first..end]
            .iter()
            .map(|t| {
                let u = (t - time_s) / half_width_s;
                ((1.0 - u.abs().powi(3)).powi(3), Vector4::new(1.0, u, u * u, u * u * u))
            })
            .collect();
        let normal: Matrix4<f64> = near.iter().map(|(weight, powers)| *weight * powers * powers.transpose()).sum();
        let inverse = normal.try_inverse()?;
        let scales = [1.0, half_width_s.recip(), 2.0 * half_width_s.powi(-2)];
        let weights = [0, 1, 2].map(|j: usize| {
            let row = inverse.row(j);
            near.iter().map(|(weight, powers)| scales[j] * weight * (row * powers)[0]).collect()
        });
        Some(Self { first, weights })
    }

    fn sum(&self, order: usize, series: impl Fn(usize) -> f64) -> f64 {
        (self.first..).zip(&self.weights[order]).map(|(frame, weight)| weight * series(frame)).sum()
    }

    /// Value of a series, given by frame.
    pub(super) fn value(&self, series: impl Fn(usize) -> f64) -> f64 {
        self.sum(0, series)
    }

    /// Slope, per second.
    pub(super) fn slope(&self, series: impl Fn(usize) -> f64) -> f64 {
        self.sum(1, series)
    }

    /// Curvature, per second².
    pub(super) fn curvature(&self, series: impl Fn(usize) -> f64) -> f64 {
        self.sum(2, series)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cubics_come_back_exactly_also_with_frames_missing() {
        let cubic = |t: f64| 2.0 - 3.0 * t + 0.5 * t * t + 4.0 * t * t * t;
        let times: Vec<f64> = (0..30).filter(|k| ![9, 12].contains(k)).map(|k| f64::from(k) / 30.0).collect();
        for time in [0.31, 0.4, 0.511] {
            let fit = LocalFit::at(&times, time, 0.15).unwrap();
            let of = |frame: usize| cubic(times[frame]);
            let expected = [cubic(time), -3.0 + time + 12.0 * time * time, 1.0 + 24.0 * time];
            let found = [fit.value(of), fit.slope(of), fit.curvature(of)];
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{time}: {found:?} {expected:?}");
        }
    }

    #[test]
    fn a_fit_needs_frames_near_it() {
        let times: Vec<f64> = (0..10).map(|k| f64::from(k) / 10.0).collect();
        assert!(LocalFit::at(&times, 0.45, 0.15).is_none());
        assert!(LocalFit::at(&times, 0.5, 0.3).is_some());
        assert!(LocalFit::at(&times, 3.0, 0.3).is_none());
        assert!(LocalFit::at(&[], 0.0, 1.0).is_none());
    }
}
