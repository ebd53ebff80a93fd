//! Sine, cosine, exponential and logarithm on lanes: branch-free polynomials, the same lines for one state and for eight.
//!
//! | function | range | error | elsewhere |
//! |---|---|---|---|
//! | [`sin_cos`] | \|x\| ≤ 1e5 | ≤ 2 ulp + 1e-27 | error below 2⁻⁶² x² up to 1e9; a meaningless number beyond; NaN for ±∞ |
//! | [`sin_cos_turns`] | \|u\| ≤ 1e5 turns | ≤ 2 ulp + 1e-27 | up to 1e15 turns as exact as u; a meaningless number beyond; NaN for ±∞ |
//! | [`exp`] | −708 ≤ x ≤ 709.78 | ≤ 2 ulp | 0 below −708.1, ∞ above 709.79 |
//! | [`ln`] | positive normal numbers | ≤ 2 ulp | NaN for ∞; a meaningless finite number for 0, denormal and negative ones |
//!
//! NaN stays NaN.
//!
//! Reductions and the coefficients of sine and logarithm are FreeBSD's msun's (`k_sin.c`, `e_log.c`, after W. J. Cody and W. Waite 1980). Cosine (degree 12, |r| ≤ π/4) and exponential
//! (degree 11, |r| ≤ ln 2 / 2) are minimax polynomials by Remez exchange with largest errors 7.7e-17 and 3.6e-18. Without fused multiply-add π/2 is subtracted in three pieces, the products of k < 2²⁰
//! with the first two (33 bits each) being exact; with it in two, since k times the double next to π/2 and its difference from x are exact there; what is lost are relative digits of results below 1e-11, next to multiples of π/2.

use crate::lanes::{ROUND_MAGIC, Real};
use core::f64::consts::{FRAC_PI_2, TAU};

const PIO2: [f64; 3] = [
    f64::from_bits(0x3FF9_21FB_5440_0000),
    f64::from_bits(0x3DD0_B461_1A60_0000),
    f64::from_bits(0x3BA3_198A_2E03_7073),
];
/// π/2 less the double next to it.
const PIO2_REST: f64 = f64::from_bits(0x3C91_A626_3314_5C07);
const SIN: [f64; 6] = [
    f64::from_bits(0xBFC5_5555_5555_5549),
    f64::from_bits(0x3F81_1111_1110_F8A6),
    f64::from_bits(0xBF2A_01A0_19C1_61D5),
    f64::from_bits(0x3EC7_1DE3_57B1_FE7D),
    f64::from_bits(0xBE5A_E5E6_8A2B_9CEB),
    f64::from_bits(0x3DE5_D93A_5ACF_D57C),
];
const COS: [f64; 5] = [
    f64::from_bits(0x3FA5_5555_5555_30FC),
    f64::from_bits(0xBF56_C16C_1676_9485),
    f64::from_bits(0x3EFA_019F_AA7B_A7CC),
    f64::from_bits(0xBE92_7E02_950A_65B1),
    f64::from_bits(0x3E21_BC75_E89A_8FD3),
];
/// Of twice the exponential, so that the power of two that is left stays below 2¹⁰²⁴.
const TWICE_EXP: [f64; 12] = [
    2.0,
    2.0,
    f64::from_bits(0x3FF0_0000_0000_000A),
    f64::from_bits(0x3FD5_5555_5555_54F9),
    f64::from_bits(0x3FB5_5555_5555_083E),
    f64::from_bits(0x3F91_1111_1112_7D0E),
    f64::from_bits(0x3F66_C16C_1843_8B11),
    f64::from_bits(0x3F3A_01A0_12A0_F35C),
    f64::from_bits(0x3F0A_0199_9E26_209F),
    f64::from_bits(0x3ED7_1DF2_5B30_D420),
    f64::from_bits(0x3EA2_8AD9_B864_8615),
    f64::from_bits(0x3E6A_D7F3_EE5D_2F80),
];
const LN2: [f64; 2] = [f64::from_bits(0x3FE6_2E42_FEE0_0000), f64::from_bits(0x3DEA_39EF_3579_3C76)];
const LOG: [f64; 7] = [
    f64::from_bits(0x3FE5_5555_5555_5593),
    f64::from_bits(0x3FD9_9999_9997_FA04),
    f64::from_bits(0x3FD2_4924_9422_9359),
    f64::from_bits(0x3FCC_71C5_1D8E_78AF),
    f64::from_bits(0x3FC7_4664_96CB_03DE),
    f64::from_bits(0x3FC3_9A09_D078_C69F),
    f64::from_bits(0x3FC2_F112_DF3E_5244),
];

#[inline(always)]
fn horner<V: Real, const N: usize>(z: V, coefficients: &[f64; N]) -> V {
    let mut p = V::splat(coefficients[N - 1]);
    let mut i = N - 1;
    while i > 0 {
        i -= 1;
        p = p.fma(z, V::splat(coefficients[i]));
    }
    p
}

/// (sin x, cos x) for |x| ≤ 1e5, x in radians.
#[inline(always)]
pub fn sin_cos<V: Real>(x: V) -> (V, V) {
    let t = x.fma(V::splat(core::f64::consts::FRAC_2_PI), V::splat(ROUND_MAGIC));
    let k = t - V::splat(ROUND_MAGIC);
    let r = if V::FUSED {
        k.fnma(V::splat(PIO2_REST), k.fnma(V::splat(FRAC_PI_2), x))
    } else {
        k.fnma(V::splat(PIO2[2]), k.fnma(V::splat(PIO2[1]), k.fnma(V::splat(PIO2[0]), x)))
    };
    in_quadrant(r, t)
}

/// (sin 2πu, cos 2πu) for |u| ≤ 1e5.
#[inline(always)]
pub fn sin_cos_turns<V: Real>(u: V) -> (V, V) {
    let t = u.fma(V::splat(4.0), V::splat(ROUND_MAGIC));
    let k = t - V::splat(ROUND_MAGIC);
    in_quadrant(k.fnma(V::splat(0.25), u) * V::splat(TAU), t)
}

/// (sin, cos) of r + k π/2 for |r| ≤ π/4 and t = k + 1.5 · 2⁵².
#[inline(always)]
fn in_quadrant<V: Real>(r: V, t: V) -> (V, V) {
    let z = r * r;
    let sin = (r * z).fma(horner(z, &SIN), r);
    let cos = z.fma(z.fma(horner(z, &COS), V::splat(-0.5)), V::splat(1.0));
    (V::select_odd(t, cos, sin).negate_by_bit1(t), V::select_odd(t, sin, cos).negate_by_bit1(t + V::splat(1.0)))
}

/// eˣ: 0 below −708.1, where it is less than 3.2e-308.
#[inline(always)]
pub fn exp<V: Real>(x: V) -> V {
    // At −708.4 the power of two is 0, at 710.4 infinite. In this order NaN stays NaN.
    let x = V::splat(710.4).min(V::splat(-708.4).max(x));
    let t = x.fma(V::splat(core::f64::consts::LOG2_E), V::splat(ROUND_MAGIC));
    let k = t - V::splat(ROUND_MAGIC);
    let r = k.fnma(V::splat(LN2[0]), x);
    let r = k.fnma(V::splat(LN2[1]), r);
    horner(r, &TWICE_EXP) * V::half_pow2(t)
}

/// Natural logarithm of positive normal numbers.
#[inline(always)]
pub fn ln<V: Real>(x: V) -> V {
    let (e, m) = x.exponent_mantissa();
    let above = core::f64::consts::SQRT_2;
    let e = m.select_gt(above, e + V::splat(1.0), e);
    let m = m.select_gt(above, m * V::splat(0.5), m);
    let f = m - V::splat(1.0);
    let s = f / (f + V::splat(2.0));
    let z = s * s;
    let half_square = f * f * V::splat(0.5);
    let r = z * horner(z, &LOG);
    let low = s.fma(half_square + r, e * V::splat(LN2[1]));
    // 0 · x is NaN where x is NaN or infinite.
    x.fma(V::splat(0.0), e.fma(V::splat(LN2[0]), f - (half_square - low)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Block, Isa, Kernel, LANES, dispatch};

    #[derive(Clone, Copy)]
    enum Which {
        Sin,
        Cos,
        SinTurns,
        CosTurns,
        Exp,
        Ln,
    }
    struct Apply<'a>(Which, &'a mut Block);
    impl Kernel<Block> for Apply<'_> {
        #[inline(always)]
        fn run<V: Real<Mem = Block>>(&mut self) {
            let x = V::load(self.1);
            let y = match self.0 {
                Which::Sin => sin_cos(x).0,
                Which::Cos => sin_cos(x).1,
                Which::SinTurns => sin_cos_turns(x).0,
                Which::CosTurns => sin_cos_turns(x).1,
                Which::Exp => exp(x),
                Which::Ln => ln(x),
            };
            y.store(self.1);
        }
    }

    /// Largest error beyond 1e-27 in units of the last place of the standard library's result, over every instruction set of this machine.
    fn worst_ulp(which: Which, reference: impl Fn(f64) -> f64, arguments: impl Iterator<Item = f64> + Clone) -> f64 {
        let mut worst = 0.0_f64;
        for isa in Isa::available() {
            for x in arguments.clone() {
                let mut block = Block([x; LANES]);
                dispatch(isa, Apply(which, &mut block));
                let expected = reference(x);
                let ulp = f64::from_bits(expected.abs().max(f64::MIN_POSITIVE).to_bits() + 1)
                    - expected.abs().max(f64::MIN_POSITIVE);
                worst = worst.max(((block.0[3] - expected).abs() - 1e-27) / ulp);
            }
        }
        worst
    }

    /// Deterministic points, dense near zero and out to `end`, with neighbours of the multiples of π/2.
    fn angles(end: f64) -> impl Iterator<Item = f64> + Clone {
        let spread = (0..40_000).map(move |i| {
            let u = f64::from(i) / 40_000.0;
            let x = end * u * u * u;
            if i % 2 == 0 { x } else { -x }
        });
        let near = (0..20_000).flat_map(move |i| {
            let x = f64::from(i) * 3.183 * core::f64::consts::FRAC_PI_2;
            [x, x.floor() * core::f64::consts::FRAC_PI_2].into_iter().filter(move |x| x.abs() <= end)
        });
        spread.chain(near)
    }

    #[test]
    fn sine_and_cosine_are_within_two_ulp() {
        assert!(worst_ulp(Which::Sin, f64::sin, angles(1e5)) <= 2.0);
        assert!(worst_ulp(Which::Cos, f64::cos, angles(1e5)) <= 2.0);
    }

    /// Multiples of 2⁻¹⁶ in (−1, 1): their reduction to the nearest quarter turn is exact, and so is the reference's.
    #[test]
    fn sine_and_cosine_of_turns_are_within_two_ulp() {
        let turns = || (-65_535..65_536).map(|i| f64::from(i) / 65_536.0);
        let reference = |shift: f64| {
            move |u: f64| {
                let quarters = (4.0 * u).round();
                let (sin, cos) = (TAU * (u - quarters / 4.0)).sin_cos();
                match (quarters + shift).rem_euclid(4.0) {
                    0.0 => sin,
                    1.0 => cos,
                    2.0 => -sin,
                    _ => -cos,
                }
            }
        };
        assert!(worst_ulp(Which::SinTurns, reference(0.0), turns()) <= 2.0);
        assert!(worst_ulp(Which::CosTurns, reference(1.0), turns()) <= 2.0);
    }

    #[test]
    fn exponential_is_within_two_ulp() {
        let arguments = (0..100_000).flat_map(|i| {
            let square = (f64::from(i) / 100_000.0).powi(2);
            [-708.0 * square, 709.78 * square]
        });
        assert!(worst_ulp(Which::Exp, f64::exp, arguments) <= 2.0);
    }

    fn at(which: Which, x: f64) -> Vec<f64> {
        let run = |isa| {
            let mut block = Block([x; LANES]);
            dispatch(isa, Apply(which, &mut block));
            block.0[3]
        };
        Isa::available().into_iter().map(run).collect()
    }

    #[test]
    fn exponential_of_everything_else_is_nothing_infinite_or_nan() {
        for x in [-708.1, -709.0, -745.0, -1e3, -1e300, f64::NEG_INFINITY] {
            assert!(at(Which::Exp, x).iter().all(|&y| y == 0.0 && y.is_sign_positive()), "{x}");
        }
        for x in [709.79, 710.0, 711.0, 745.0, 1e3, 1e300, f64::INFINITY] {
            assert!(at(Which::Exp, x).iter().all(|&y| y == f64::INFINITY), "{x}");
        }
        for x in [0.0, -0.0, 5e-324, -5e-324] {
            assert!(at(Which::Exp, x).iter().all(|&y| y == 1.0), "{x}");
        }
    }

    #[test]
    fn nan_stays_nan_and_infinity_is_no_argument() {
        for nan in [f64::NAN, -f64::NAN, f64::from_bits(0x7FF8_0000_0000_0FFF)] {
            for which in [Which::Sin, Which::Cos, Which::SinTurns, Which::CosTurns, Which::Exp, Which::Ln] {
                assert!(at(which, nan).iter().all(|y| y.is_nan()));
            }
        }
        for which in [Which::Sin, Which::Cos, Which::SinTurns, Which::CosTurns] {
            assert!(at(which, f64::INFINITY).iter().chain(&at(which, f64::NEG_INFINITY)).all(|y| y.is_nan()));
        }
        assert!(at(Which::Ln, f64::INFINITY).iter().all(|y| y.is_nan()));
        let ends = [f64::MIN_POSITIVE, f64::MAX].into_iter();
        assert!(worst_ulp(Which::Ln, f64::ln, ends) <= 2.0);
    }

    /// Beyond 1e5 the pieces of π/2 lose bits as k grows; the documented bound.
    #[test]
    fn sine_and_cosine_of_large_angles_have_the_documented_error() {
        for i in 1..10_000_u32 {
            let x = 1e5 * 1e4_f64.powf(f64::from(i) / 1e4);
            let bound = x * x * 0.5_f64.powi(62) + 1e-15;
            for (which, expected) in [(Which::Sin, x.sin()), (Which::Cos, x.cos())] {
                assert!(at(which, x).iter().all(|y| (y - expected).abs() <= bound), "{x}");
            }
        }
        for x in [5e-324, -5e-324, 1e-310, -1e-310] {
            assert!(at(Which::Sin, x).iter().all(|&y| y == x) && at(Which::Cos, x).iter().all(|&y| y == 1.0), "{x}");
        }
    }

    #[test]
    fn logarithm_is_within_two_ulp() {
        let arguments = (1..100_000).flat_map(|i| {
            [f64::from(i) * 1e-5, 1.0 + f64::from(i) * 1e-6, f64::from(i).powi(40), f64::from(i).powi(-40)]
        });
        assert!(worst_ulp(Which::Ln, f64::ln, arguments) <= 2.0);
    }
}
