//! One keypoint in one camera: its density, how strongly it pulls, and how much of that is left.
//!
//! [`KeypointModel`](crate::KeypointModel) has the formulas.

use crate::cameras::camera::MIN_DEPTH_M;
use sinew_core::elementary::exp;
use sinew_core::lanes::{One, Real};

/// Shape of a sighting's density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Noise {
    /// A Gaussian core; with probability `outlier` the detection lies anywhere in the image.
    OutlierFloor {
        /// Probability of a gross outlier, in (0, 1).
        outlier: f64,
    },
    /// A Student t distribution in two dimensions.
    StudentT {
        /// Degrees of freedom ν.
        degrees: f64,
    },
}

/// One keypoint in one camera.
#[derive(Clone, Debug)]
pub(crate) struct Sighting {
    pub camera: usize,
    /// Detection minus bias minus principal point, pixels.
    pub pixel: [f64; 2],
    /// 1/s².
    pub information: f64,
    /// Outlier floor relative to the core's peak; with Student t, 1/(ν s²).
    pub shape: f64,
}

impl Noise {
    /// A factor of the likelihood, which to the power [`Noise::exponent`] is a sighting's density over its peak; and how strongly it pulls, 1/s² at its centre.
    #[inline(always)]
    pub(crate) fn factor<V: Real>(self, sighting: &Sighting, [r0, r1]: [V; 2], depth: V) -> (V, V) {
        let s = |x: f64| V::splat(x);
        let square = r1.fma(r1, r0 * r0);
        match self {
            Self::OutlierFloor { .. } => {
                let core = exp(square * s(-0.5 * sighting.information));
                let core = depth.select_gt(MIN_DEPTH_M, core, s(0.0));
                let total = core + s(sighting.shape);
                (total, core / total * s(sighting.information))
            }
            Self::StudentT { degrees } => {
                let spread = square.fma(s(sighting.shape), s(1.0));
                let spread = depth.select_gt(MIN_DEPTH_M, spread, s(1e6 / degrees));
                let strength = s((degrees + 2.0) * sighting.shape) / spread;
                (spread, depth.select_gt(MIN_DEPTH_M, strength, s(0.0)))
            }
        }
    }

    /// Log density of a sighting over its peak, and its share, at a distance in pixels; `None` where its point is not seen.
    pub(crate) fn at(self, sighting: &Sighting, offset: Option<[f64; 2]>) -> (f64, f64) {
        let depth = One(if offset.is_some() { f64::INFINITY } else { 0.0 });
        let offset = offset.unwrap_or_default().map(One);
        let (factor, _) = self.factor(sighting, offset, depth);
        (self.exponent() * factor.0.ln(), self.share(sighting, offset, depth).0)
    }

    /// Power of a product of factors that is a density.
    #[inline(always)]
    pub(crate) const fn exponent(self) -> f64 {
        match self {
            Self::OutlierFloor { .. } => 1.0,
            Self::StudentT { degrees } => -0.5 * (degrees + 2.0),
        }
    }

    /// How much of a sighting's pull is left: 1 at its centre, 0 where it counts as an outlier.
    #[inline(always)]
    pub(crate) fn share<V: Real>(self, sighting: &Sighting, [r0, r1]: [V; 2], depth: V) -> V {
        let square = r1.fma(r1, r0 * r0);
        let share = match self {
            Self::OutlierFloor { .. } => {
                let core = exp(square * V::splat(-0.5 * sighting.information));
                core / (core + V::splat(sighting.shape))
            }
            Self::StudentT { degrees } => {
                V::splat((degrees + 2.0) / degrees) / square.fma(V::splat(sighting.shape), V::splat(1.0))
            }
        };
        depth.select_gt(MIN_DEPTH_M, share, V::splat(0.0))
    }

    /// A sighting with errors that are `factor` times as large; its floor keeps its height.
    pub(crate) fn broaden(self, sighting: &mut Sighting, factor: f64) {
        let square = factor * factor;
        sighting.information /= square;
        match self {
            Self::OutlierFloor { .. } => sighting.shape *= square,
            Self::StudentT { .. } => sighting.shape /= square,
        }
    }
}
