//! Fisheye lenses: the radius in the image is a polynomial of the angle from the axis. OpenCV's, with four coefficients:
//!
//! ```text
//! θ = atan r        θ_d = θ (1 + k1 θ² + k2 θ⁴ + k3 θ⁶ + k4 θ⁸)        (x_d, y_d) = θ_d/r · (x, y)
//! ```
//!
//! Its domain ends where θ_d stops growing, at the first zero of `1 + 3 k1 s + 5 k2 s² + 7 k3 s³ + 9 k4 s⁴` in s = θ², and at a right angle in any case: what is not in front of the camera is not seen.
//! J. Kannala and S. S. Brandt, "A generic camera model and calibration method for conventional, wide-angle, and fish-eye lenses", IEEE TPAMI 28 (2006), in OpenCV's form.

use super::model::{Distort, DistortionModel, Image};
use super::polynomial::{positive_up_to, value};

use core::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use sinew_core::lanes::Real;

/// Square of the radius below which a point is taken to be on the axis.
const AXIS: f64 = 1e-30;

/// Coefficients of a fisheye lens (all zero: equidistant).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fisheye {
    /// k1, k2, k3 and k4: of θ³, θ⁵, θ⁷ and θ⁹.
    pub k: [f64; 4],
}

impl DistortionModel for Fisheye {
    const IS_FISHEYE: bool = true;
    const COEFFICIENTS: &'static str = "4 numbers: k1, k2, k3, k4 of a fisheye lens";

    fn from_coefficients(coefficients: &[f64]) -> Option<Self> {
        coefficients.try_into().ok().map(|k| Self { k })
    }

    fn coefficients(&self) -> Vec<f64> {
        self.k.to_vec()
    }

    fn valid_radius(&self) -> f64 {
        let [k1, k2, k3, k4] = self.k;
        let angle = positive_up_to(&[1.0, 3.0 * k1, 5.0 * k2, 7.0 * k3, 9.0 * k4]).sqrt();
        if angle < FRAC_PI_2 { angle.tan() } else { f64::INFINITY }
    }

    fn radius_after(&self, radius: f64) -> f64 {
        let angle = radius.atan();
        let [k1, k2, k3, k4] = self.k;
        angle * value(&[1.0, k1, k2, k3, k4], angle * angle)
    }
}

impl Distort for Fisheye {
    #[inline(always)]
    fn image<V: Real, const DERIVATIVE: bool>(&self, [x, y]: [V; 2], square: V) -> Image<V> {
        let s = |x: f64| V::splat(x);
        let [k1, k2, k3, k4] = &self.k;
        let square = square.max(s(AXIS));
        let radius = square.sqrt();
        let angle = arctangent(radius);
        let t = angle * angle;
        let polynomial = t.fma(t.fma(t.fma(t.fma(s(*k4), s(*k3)), s(*k2)), s(*k1)), s(1.0));
        let gain = angle * polynomial / radius;
        let at = [x * gain, y * gain];
        if !DERIVATIVE {
            return Image { at, derivative: [[s(0.0); 2]; 2] };
        }
        let slope = t.fma(t.fma(t.fma(t.fma(s(9.0 * *k4), s(7.0 * *k3)), s(5.0 * *k2)), s(3.0 * *k1)), s(1.0))
            / (square + s(1.0));
        // Along the radius the derivative is that of θ_d, across it the gain.
        let growth = (slope - gain) / square;
        let cross = x * y * growth;
        Image { at, derivative: [[(x * x).fma(growth, gain), cross], [cross, (y * y).fma(growth, gain)]] }
    }
}

/// tan π/8 and tan 3π/8 divide the half-line into the ranges of [`arctangent`].
const TAN_PI_8: f64 = 0.414_213_562_373_095_05;
const TAN_3_PI_8: f64 = 2.414_213_562_373_095;
/// Numerator and denominator of (atan t − t)/t³ in t² for |t| ≤ 0.66 (S. Moshier, Cephes, `atan.c`).
const P: [f64; 5] = [
    -6.485_021_904_942_025e1,
    -1.228_866_684_490_136_2e2,
    -7.500_855_792_314_705e1,
    -1.615_753_718_733_365e1,
    -8.750_608_600_031_904e-1,
];
const Q: [f64; 6] = [
    1.945_506_571_482_614e2,
    4.853_903_996_359_137e2,
    4.328_810_604_912_903e2,
    1.650_270_098_316_988_6e2,
    2.485_846_490_142_306_3e1,
    1.0,
];

#[inline(always)]
fn horner<V: Real, const N: usize>(z: V, coefficients: &[f64; N]) -> V {
    let mut sum = V::splat(coefficients[N - 1]);
    let mut k = N - 1;
    while k > 0 {
        k -= 1;
        sum = sum.fma(z, V::splat(coefficients[k]));
    }
    sum
}

/// Arctangent of r ≥ 0, to a few units in the last place: atan r = π/4 + atan((r − 1)/(r + 1)) = π/2 + atan(−1/r).
#[inline(always)]
fn arctangent<V: Real>(r: V) -> V {
    let (zero, one) = (V::splat(0.0), V::splat(1.0));
    let upper = r.select_gt(TAN_PI_8, r - one, r);
    let lower = r.select_gt(TAN_PI_8, r + one, one);
    let base = r.select_gt(TAN_PI_8, V::splat(FRAC_PI_4), zero);
    let t = r.select_gt(TAN_3_PI_8, -one, upper) / r.select_gt(TAN_3_PI_8, r, lower);
    let base = r.select_gt(TAN_3_PI_8, V::splat(FRAC_PI_2), base);
    let z = t * t;
    base + (t * z).fma(horner(z, &P) / horner(z, &Q), t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::lanes::{Block, Isa, Kernel, LANES, dispatch};

    struct Arctangents<'a>(&'a mut [Block]);
    impl Kernel<Block> for Arctangents<'_> {
        #[inline(always)]
        fn run<V: Real<Mem = Block>>(&mut self) {
            for x in &mut *self.0 {
                arctangent(V::load(x)).store(x);
            }
        }
    }

    #[test]
    fn arctangents_match_the_library() {
        let at: Vec<f64> = (0..4000).map(|k| 10.0_f64.powf(f64::from(k) / 400.0 - 5.0)).chain([0.0; LANES]).collect();
        for isa in Isa::available() {
            let mut blocks: Vec<Block> = at.as_chunks::<LANES>().0.iter().map(|x| Block(*x)).collect();
            dispatch(isa, Arctangents(&mut blocks));
            for (x, found) in at.iter().zip(blocks.iter().flat_map(|block| block.0)) {
                assert!((found - x.atan()).abs() <= 3.0 * f64::EPSILON * x.atan(), "{}: {x}: {found}", isa.name());
            }
        }
    }

    #[test]
    fn the_domain_ends_where_the_angle_stops_growing() {
        assert_eq!(Fisheye::default().valid_radius(), f64::INFINITY);
        // 1 − 3 · 0.2 θ² = 0.
        let found = Fisheye { k: [-0.2, 0.0, 0.0, 0.0] }.valid_radius();
        assert!((found - (1.0_f64 / 0.6).sqrt().tan()).abs() < 1e-9, "{found}");
        assert_eq!(Fisheye { k: [-0.1, 0.0, 0.0, 0.0] }.valid_radius(), f64::INFINITY);
    }
}
