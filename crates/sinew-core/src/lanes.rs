//! Eight states at once: one scalar-like trait, five types behind it, the instruction set chosen at run time.
//!
//! A kernel is written once, generic over [`Real`], and implements [`Kernel`]. [`dispatch`] runs it on the registers that the processor has:
//!
//! | type | processor | memory |
//! |---|---|---|
//! | one `__m512d` | AVX-512 (F, DQ, VL, BW) | [`Block`] |
//! | one `__m256d`, for half of the block and then for the other half | AVX2 and FMA | [`Block`], or `[f64; 4]` ([`map_block`]) |
//! | `[f64; 8]` or `[f64; 4]`, vectorised by the compiler | any (SSE2, NEON, wasm) | [`Block`], or `[f64; 4]` ([`map_block`]) |
//! | one `f64` with or without fused multiply-add | as above | `f64` |
//!
//! Every function from [`Kernel::run`] down carries `#[inline(always)]`, which [`inlined!`](crate::inlined) writes: one that stays outside the entry point is compiled without the
//! instruction set, and each of its operations becomes a call. For the same reason kernels use plain loops, never `array::from_fn` or `map` on arrays.
//!
//! This is the only file of the workspace with `unsafe`: loads and stores of aligned blocks, blocks seen as numbers, intrinsics (each needs only the
//! feature of its entry point) and the calls into the entry points (guarded by detection, since [`Isa`] can be made in no other way).
//!
//! The fused multiply-add rounds once, the baseline's multiply-then-add twice. So the same set gives the same bits, and two sets agree to rounding only.
//!
//! ```
//! use sinew_core::lanes::{Block, Isa, Kernel, Real, dispatch};
//! struct Square<'a>(&'a mut Block);
//! impl Kernel<Block> for Square<'_> {
//!     #[inline(always)]
//!     fn run<V: Real<Mem = Block>>(&mut self) {
//!         let x = V::load(self.0);
//!         (x * x).store(self.0);
//!     }
//! }
//! let mut x = Block([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
//! dispatch(Isa::best(), Square(&mut x));
//! assert_eq!(x.0[7], 64.0);
//! ```
#![allow(unsafe_code)]

use crate::chacha;
use crate::groups::{Group, in_groups, one_in_a_group};
use core::marker::PhantomData;
use core::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::OnceLock;

/// States in a block, on every instruction set.
pub const LANES: usize = 8;

/// One coordinate of [`LANES`] states. A block of states of dimension `d` is `[Block; d]`, dimension-major.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Block(pub [f64; LANES]);

impl Block {
    /// All lanes zero.
    pub const ZERO: Self = Self([0.0; LANES]);

    /// All lanes equal.
    #[must_use]
    pub const fn splat(x: f64) -> Self {
        Self([x; LANES])
    }
}

/// A little-endian 32-bit number, as a generator of random bits writes it.
pub type Word = [u8; 4];

/// Copies one state into a lane of a block of states.
pub fn set_lane(block: &mut [Block], lane: usize, state: &[f64]) {
    for (b, &x) in block.iter_mut().zip(state) {
        b.0[lane] = x;
    }
}

/// Copies a lane of a block of states out.
pub fn get_lane(block: &[Block], lane: usize, state: &mut [f64]) {
    for (x, b) in state.iter_mut().zip(block) {
        *x = b.0[lane];
    }
}

/// One state in every lane of a block of states.
#[must_use]
pub fn splat(state: &[f64]) -> Vec<Block> {
    state.iter().map(|&x| Block::splat(x)).collect()
}

/// Calls a function of one state for the states of a block, lane after lane; it writes what goes into the same lane of `out`.
pub fn each_lane(x: &[Block], out: &mut [Block], mut of_one: impl FnMut(&[f64], &mut [f64])) {
    let (mut state, mut written) = (vec![0.0; x.len()], vec![0.0; out.len()]);
    for lane in 0..LANES {
        get_lane(x, lane, &mut state);
        of_one(&state, &mut written);
        set_lane(out, lane, &written);
    }
}

/// Blocks as the numbers that they hold, one block after the other.
#[must_use]
pub const fn numbers(blocks: &[Block]) -> &[f64] {
    // SAFETY: a block is eight numbers and nothing else (`repr(C)`, 64 bytes), and aligned more strictly than they are.
    unsafe { core::slice::from_raw_parts(blocks.as_ptr().cast(), blocks.len() * LANES) }
}

/// As [`numbers`], to be written.
#[must_use]
pub const fn numbers_mut(blocks: &mut [Block]) -> &mut [f64] {
    // SAFETY: as in `numbers`; every bit pattern of the numbers is one of a block.
    unsafe { core::slice::from_raw_parts_mut(blocks.as_mut_ptr().cast(), blocks.len() * LANES) }
}

/// Place of row i, column j ≤ i in a packed lower triangle.
#[inline(always)]
#[must_use]
pub const fn triangle(i: usize, j: usize) -> usize {
    i * (i + 1) / 2 + j
}

/// Instruction set for lane kernels. Only detection makes one, so holding it proves that the processor has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Isa(Kind);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    #[cfg(target_arch = "x86_64")]
    Avx512,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    Baseline,
}

impl Isa {
    /// The best set of this processor.
    #[must_use]
    pub fn best() -> Self {
        static BEST: OnceLock<Isa> = OnceLock::new();
        *BEST.get_or_init(|| Self::available()[0])
    }

    /// What any processor of the target architecture runs.
    #[must_use]
    pub const fn baseline() -> Self {
        Self(Kind::Baseline)
    }

    /// Every set of this processor, best first.
    #[must_use]
    pub fn available() -> Vec<Self> {
        let mut sets = Vec::with_capacity(3);
        #[cfg(target_arch = "x86_64")]
        {
            let avx2 = is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("fma")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2")
                && is_x86_feature_detected!("popcnt");
            if avx2
                && is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512bw")
            {
                sets.push(Self(Kind::Avx512));
            }
            if avx2 {
                sets.push(Self(Kind::Avx2));
            }
        }
        sets.push(Self(Kind::Baseline));
        sets
    }

    /// `avx512`, `avx2` or `baseline`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self.0 {
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => "avx512",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => "avx2",
            Kind::Baseline => "baseline",
        }
    }

    /// The set of that name, if this processor has it.
    #[must_use]
    pub fn by_name(name: &str) -> Option<Self> {
        Self::available().into_iter().find(|isa| isa.name() == name)
    }
}

/// A real number for each state of a block, or one real number: what a kernel computes with.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// How it lies in memory: [`Block`] for lanes, `f64` for one state, an array for a group of states.
    type Mem: Copy;
    /// Whether [`Real::fma`] rounds once.
    const FUSED: bool;
    /// The same value in every lane.
    fn splat(x: f64) -> Self;
    /// Reads from memory.
    fn load(m: &Self::Mem) -> Self;
    /// Writes to memory.
    fn store(self, m: &mut Self::Mem);
    /// `(k + ½) · 2⁻³²` of the little-endian 32-bit number k of each lane (of the first ones, for one state or a group).
    fn from_words(words: &[Word; LANES]) -> Self;
    /// `self · b + c`, fused where the set has it.
    fn fma(self, b: Self, c: Self) -> Self;
    /// `c − self · b`, fused where the set has it.
    fn fnma(self, b: Self, c: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// The larger of two; `other` where either is NaN.
    fn max(self, other: Self) -> Self;
    /// The smaller of two; `other` where either is NaN.
    fn min(self, other: Self) -> Self;
    /// `yes` where `self > limit`, else `no`; a NaN lane takes `no`.
    fn select_gt(self, limit: f64, yes: Self, no: Self) -> Self;
    /// For `t = k + 1.5 · 2⁵²` with integer `k`: `yes` where `k` is odd, else `no`.
    fn select_odd(t: Self, yes: Self, no: Self) -> Self;
    /// For `t` as in [`Real::select_odd`]: `self` negated where bit 1 of `k` is set.
    fn negate_by_bit1(self, t: Self) -> Self;
    /// For `t` as in [`Real::select_odd`] and −1022 ≤ `k` ≤ 1025: `2ᵏ⁻¹`, 0 for the least `k` and ∞ for the largest.
    fn half_pow2(t: Self) -> Self;
    /// For positive normal numbers `m · 2ᵉ`: (`e`, `m` in [1, 2)).
    fn exponent_mantissa(self) -> (Self, Self);
}

/// `1.5 · 2⁵²`: added to a small number it leaves the nearest integer in the low bits of the mantissa.
pub const ROUND_MAGIC: f64 = 6_755_399_441_055_744.0;
const SIGN: u64 = 1 << 63;
const MANTISSA: u64 = (1 << 52) - 1;
const ONE_BITS: u64 = 0x3FF0_0000_0000_0000;
const HALF_BITS: u64 = 0x3FE0_0000_0000_0000;
/// Bits of 2⁵²: or-ed onto a small integer they make the double `2⁵² + integer`.
const TWO52_BITS: u64 = 0x4330_0000_0000_0000;
/// 1 − ½ · 2⁻³²: what the double with the bits of 1.0 and a word in the upper mantissa has too much.
const WORD_SHIFT: f64 = 1.0 - 0.5 / 4_294_967_296.0;
const TWO52_PLUS_BIAS: f64 = 4_503_599_627_370_496.0 + 1023.0;

/// Work to be run on lanes (`M` = [`Block`]) or on one state (`M` = `f64`).
pub trait Kernel<M> {
    /// The work; must be `#[inline(always)]`, like everything that it calls.
    ///
    /// It may be run for some lanes after the others: what it writes must depend on the same lanes of what it reads, and on nothing that it changed otherwise.
    fn run<V: Real<Mem = M>>(&mut self);
}

/// Runs a kernel over a block of states with the given instruction set.
#[inline]
pub fn dispatch<K: Kernel<Block>>(isa: Isa, mut kernel: K) {
    match isa.0 {
        // SAFETY: an `Isa` of this kind exists only after its features were detected.
        #[cfg(target_arch = "x86_64")]
        Kind::Avx512 => unsafe { x86::on_avx512(&mut kernel) },
        // SAFETY: as above.
        #[cfg(target_arch = "x86_64")]
        Kind::Avx2 => unsafe { x86::on_avx2(&mut kernel) },
        Kind::Baseline => kernel.run::<A8>(),
    }
}

/// Runs a kernel over a block of states so that its bits do not depend on the instruction set: multiply, then add, in the largest registers that the processor has.
#[inline]
pub fn dispatch_unfused<K: Kernel<Block>>(mut kernel: K) {
    match Isa::best().0 {
        // SAFETY: as in `dispatch`.
        #[cfg(target_arch = "x86_64")]
        Kind::Avx512 => unsafe { x86::unfused_on_avx512(&mut kernel) },
        // SAFETY: as in `dispatch`.
        #[cfg(target_arch = "x86_64")]
        Kind::Avx2 => unsafe { x86::unfused_on_avx2(&mut kernel) },
        Kind::Baseline => kernel.run::<A8>(),
    }
}

/// [`chacha::blocks`] by the best instructions of the processor.
pub(crate) fn chacha_blocks(key: &chacha::Key, places: &chacha::Places, out: &mut [chacha::Words; 4]) {
    match Isa::best().0 {
        // SAFETY: as in `dispatch`.
        #[cfg(target_arch = "x86_64")]
        Kind::Avx512 | Kind::Avx2 => unsafe { x86::chacha_blocks(key, places, out) },
        Kind::Baseline => chacha::blocks(key, places, out),
    }
}

/// Runs a kernel on one state, with fused multiply-add where the instruction set has it.
#[inline]
pub fn dispatch_one<K: Kernel<f64>>(isa: Isa, mut kernel: K) {
    match isa.0 {
        // SAFETY: both kinds exist only after AVX2 and FMA were detected.
        #[cfg(target_arch = "x86_64")]
        Kind::Avx512 | Kind::Avx2 => unsafe { x86::one_on_fma(&mut kernel) },
        Kind::Baseline => kernel.run::<One>(),
    }
}

/// Work that reads `I` arrays and writes `O` others: what takes long to compile or to run. It is compiled once for each instruction set, and not again for one state.
pub trait LaneMap<const I: usize, const O: usize> {
    /// The work; must be `#[inline(always)]`, like everything that it calls. Every entry of `output` is written, and none is read before. `ws` is at least as long as the caller's.
    fn run<V: Real>(&self, input: [&[V::Mem]; I], output: [&mut [V::Mem]; O], ws: &mut [V::Mem]);
}

/// Runs work over a block of states. Where registers are narrower than a block, groups of states are copied out: code for a group is compiled once, and its values stay in registers.
pub fn map_block<const I: usize, const O: usize, F: LaneMap<I, O>>(
    isa: Isa,
    map: &F,
    input: [&[Block]; I],
    output: [&mut [Block]; O],
    ws: &mut [Block],
) {
    match isa.0 {
        // SAFETY: as in `dispatch`.
        #[cfg(target_arch = "x86_64")]
        Kind::Avx512 => unsafe { x86::map_on_avx512(map, input, output, ws) },
        #[cfg(target_arch = "x86_64")]
        Kind::Avx2 => in_groups(input, output, numbers_mut(ws).as_chunks_mut().0, |input, output, ws| {
            // SAFETY: as in `dispatch`.
            unsafe { x86::map_on_avx2(map, input, output, ws) }
        }),
        Kind::Baseline => in_groups(input, output, numbers_mut(ws).as_chunks_mut().0, |input, output, ws| {
            map_on_baseline(map, input, output, ws);
        }),
    }
}

/// Runs work on one state, with `workspace` numbers of scratch.
pub fn map_one<const I: usize, const O: usize, F: LaneMap<I, O>>(
    isa: Isa,
    map: &F,
    input: [&[f64]; I],
    output: [&mut [f64]; O],
    workspace: usize,
) {
    match isa.0 {
        #[cfg(target_arch = "x86_64")]
        Kind::Avx512 | Kind::Avx2 => one_in_a_group(input, output, workspace, |input, output, ws| {
            // SAFETY: as in `dispatch`.
            unsafe { x86::map_on_avx2(map, input, output, ws) }
        }),
        Kind::Baseline => {
            one_in_a_group(input, output, workspace, |input, output, ws| map_on_baseline(map, input, output, ws));
        }
    }
}

#[inline(never)]
fn map_on_baseline<const I: usize, const O: usize, F: LaneMap<I, O>>(
    map: &F,
    input: [&[Group]; I],
    output: [&mut [Group]; O],
    ws: &mut [Group],
) {
    map.run::<A4>(input, output, ws);
}

/// What states lie in.
trait Memory: Copy + AsRef<[f64]> + AsMut<[f64]> {}
impl Memory for Block {}
impl Memory for Group {}

impl AsRef<[f64]> for Block {
    #[inline(always)]
    fn as_ref(&self) -> &[f64] {
        &self.0
    }
}

impl AsMut<[f64]> for Block {
    #[inline(always)]
    fn as_mut(&mut self) -> &mut [f64] {
        &mut self.0
    }
}

/// One state, multiply then add: what runs over lanes, for a number by itself.
#[derive(Clone, Copy)]
pub struct One(pub f64);

/// Eight states in an array, for the compiler to vectorise.
#[derive(Clone, Copy)]
struct A8([f64; LANES]);

/// A group of states, likewise.
#[derive(Clone, Copy)]
struct A4(Group);

#[inline(always)]
fn from_word(word: Word) -> f64 {
    f64::from_bits(u64::from(u32::from_le_bytes(word)) << 20 | ONE_BITS) - WORD_SHIFT
}

#[inline(always)]
fn odd(t: f64) -> bool {
    t.to_bits() & 1 == 1
}

#[inline(always)]
fn negate_by_bit1(x: f64, t: f64) -> f64 {
    f64::from_bits(x.to_bits() ^ ((t.to_bits() << 62) & SIGN))
}

#[inline(always)]
fn half_pow2(t: f64) -> f64 {
    f64::from_bits((t.to_bits() << 52).wrapping_add(HALF_BITS))
}

#[inline(always)]
fn exponent(x: f64) -> f64 {
    f64::from_bits((x.to_bits() >> 52) | TWO52_BITS) - TWO52_PLUS_BIAS
}

#[inline(always)]
fn mantissa(x: f64) -> f64 {
    f64::from_bits((x.to_bits() & MANTISSA) | ONE_BITS)
}

macro_rules! one_state {
    ($name:ident, $fused:expr, $fma:expr) => {
        impl Add for $name {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self {
                Self(self.0 + o.0)
            }
        }
        impl Sub for $name {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self {
                Self(self.0 - o.0)
            }
        }
        impl Mul for $name {
            type Output = Self;
            #[inline(always)]
            fn mul(self, o: Self) -> Self {
                Self(self.0 * o.0)
            }
        }
        impl Div for $name {
            type Output = Self;
            #[inline(always)]
            fn div(self, o: Self) -> Self {
                Self(self.0 / o.0)
            }
        }
        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }
        impl Real for $name {
            type Mem = f64;
            const FUSED: bool = $fused;
            #[inline(always)]
            fn splat(x: f64) -> Self {
                Self(x)
            }
            #[inline(always)]
            fn load(m: &f64) -> Self {
                Self(*m)
            }
            #[inline(always)]
            fn store(self, m: &mut f64) {
                *m = self.0;
            }
            #[inline(always)]
            fn from_words(words: &[Word; LANES]) -> Self {
                Self(from_word(words[0]))
            }
            #[inline(always)]
            fn fma(self, b: Self, c: Self) -> Self {
                Self($fma(self.0, b.0, c.0))
            }
            #[inline(always)]
            fn fnma(self, b: Self, c: Self) -> Self {
                Self($fma(-self.0, b.0, c.0))
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self(self.0.sqrt())
            }
            #[inline(always)]
            fn max(self, o: Self) -> Self {
                Self(if self.0 > o.0 { self.0 } else { o.0 })
            }
            #[inline(always)]
            fn min(self, o: Self) -> Self {
                Self(if self.0 < o.0 { self.0 } else { o.0 })
            }
            #[inline(always)]
            fn select_gt(self, limit: f64, yes: Self, no: Self) -> Self {
                if self.0 > limit { yes } else { no }
            }
            #[inline(always)]
            fn select_odd(t: Self, yes: Self, no: Self) -> Self {
                if odd(t.0) { yes } else { no }
            }
            #[inline(always)]
            fn negate_by_bit1(self, t: Self) -> Self {
                Self(negate_by_bit1(self.0, t.0))
            }
            #[inline(always)]
            fn half_pow2(t: Self) -> Self {
                Self(half_pow2(t.0))
            }
            #[inline(always)]
            fn exponent_mantissa(self) -> (Self, Self) {
                (Self(exponent(self.0)), Self(mantissa(self.0)))
            }
        }
    };
}

one_state!(One, false, |a: f64, b: f64, c: f64| a * b + c);

// Written out: loops over lanes, some for each operation, take the compiler as long as all the rest.
macro_rules! array_of_lanes {
    ($name:ident, $memory:ty, [$($k:literal)*]) => {
        impl Add for $name {
            type Output = Self;
            #[inline(always)]
            fn add(self, o: Self) -> Self {
                Self([$(self.0[$k] + o.0[$k]),*])
            }
        }
        impl Sub for $name {
            type Output = Self;
            #[inline(always)]
            fn sub(self, o: Self) -> Self {
                Self([$(self.0[$k] - o.0[$k]),*])
            }
        }
        impl Mul for $name {
            type Output = Self;
            #[inline(always)]
            fn mul(self, o: Self) -> Self {
                Self([$(self.0[$k] * o.0[$k]),*])
            }
        }
        impl Div for $name {
            type Output = Self;
            #[inline(always)]
            fn div(self, o: Self) -> Self {
                Self([$(self.0[$k] / o.0[$k]),*])
            }
        }
        impl Neg for $name {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self([$(-self.0[$k]),*])
            }
        }
        impl Real for $name {
            type Mem = $memory;
            const FUSED: bool = false;
            #[inline(always)]
            fn splat(x: f64) -> Self {
                Self([x; [$($k),*].len()])
            }
            #[inline(always)]
            fn load(m: &$memory) -> Self {
                let m = m.as_ref();
                Self([$(m[$k]),*])
            }
            #[inline(always)]
            fn store(self, m: &mut $memory) {
                let m = m.as_mut();
                $(m[$k] = self.0[$k];)*
            }
            #[inline(always)]
            fn from_words(words: &[Word; LANES]) -> Self {
                Self([$(from_word(words[$k])),*])
            }
            #[inline(always)]
            fn fma(self, b: Self, c: Self) -> Self {
                Self([$(self.0[$k] * b.0[$k] + c.0[$k]),*])
            }
            #[inline(always)]
            fn fnma(self, b: Self, c: Self) -> Self {
                Self([$(c.0[$k] - self.0[$k] * b.0[$k]),*])
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                Self([$(self.0[$k].sqrt()),*])
            }
            #[inline(always)]
            fn max(self, o: Self) -> Self {
                Self([$(if self.0[$k] > o.0[$k] { self.0[$k] } else { o.0[$k] }),*])
            }
            #[inline(always)]
            fn min(self, o: Self) -> Self {
                Self([$(if self.0[$k] < o.0[$k] { self.0[$k] } else { o.0[$k] }),*])
            }
            #[inline(always)]
            fn select_gt(self, limit: f64, yes: Self, no: Self) -> Self {
                Self([$(if self.0[$k] > limit { yes.0[$k] } else { no.0[$k] }),*])
            }
            #[inline(always)]
            fn select_odd(t: Self, yes: Self, no: Self) -> Self {
                Self([$(if odd(t.0[$k]) { yes.0[$k] } else { no.0[$k] }),*])
            }
            #[inline(always)]
            fn negate_by_bit1(self, t: Self) -> Self {
                Self([$(negate_by_bit1(self.0[$k], t.0[$k])),*])
            }
            #[inline(always)]
            fn half_pow2(t: Self) -> Self {
                Self([$(half_pow2(t.0[$k])),*])
            }
            #[inline(always)]
            fn exponent_mantissa(self) -> (Self, Self) {
                (Self([$(exponent(self.0[$k])),*]), Self([$(mantissa(self.0[$k])),*]))
            }
        }
    };
}
array_of_lanes!(A8, Block, [0 1 2 3 4 5 6 7]);
array_of_lanes!(A4, Group, [0 1 2 3]);

#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::{
        Add, Block, Div, Group, HALF_BITS, Kernel, LANES, LaneMap, MANTISSA, Memory, Mul, Neg, ONE_BITS, PhantomData,
        Real, SIGN, Sub, TWO52_BITS, TWO52_PLUS_BIAS, WORD_SHIFT, Word, chacha, exponent, from_word, half_pow2,
        mantissa, negate_by_bit1, odd,
    };
    use core::arch::x86_64::*;

    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,avx2,fma,bmi1,bmi2,popcnt")]
    pub(super) fn on_avx512<K: Kernel<Block>>(kernel: &mut K) {
        kernel.run::<Z8<true>>();
    }

    /// Half after half: with both at once, sixteen registers do not hold what a kernel works on.
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
    pub(super) fn on_avx2<K: Kernel<Block>>(kernel: &mut K) {
        kernel.run::<Y4<0, true>>();
        kernel.run::<Y4<4, true>>();
    }

    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,avx2,fma,bmi1,bmi2,popcnt")]
    pub(super) fn unfused_on_avx512<K: Kernel<Block>>(kernel: &mut K) {
        kernel.run::<Z8<false>>();
    }

    #[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
    pub(super) fn unfused_on_avx2<K: Kernel<Block>>(kernel: &mut K) {
        kernel.run::<Y4<0, false>>();
        kernel.run::<Y4<4, false>>();
    }

    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,avx2,fma,bmi1,bmi2,popcnt")]
    pub(super) fn map_on_avx512<const I: usize, const O: usize, F: LaneMap<I, O>>(
        map: &F,
        input: [&[Block]; I],
        output: [&mut [Block]; O],
        ws: &mut [Block],
    ) {
        map.run::<Z8<true>>(input, output, ws);
    }

    #[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
    pub(super) fn map_on_avx2<const I: usize, const O: usize, F: LaneMap<I, O>>(
        map: &F,
        input: [&[Group]; I],
        output: [&mut [Group]; O],
        ws: &mut [Group],
    ) {
        map.run::<Y4<0, true, Group>>(input, output, ws);
    }

    #[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
    pub(super) fn one_on_fma<K: Kernel<f64>>(kernel: &mut K) {
        kernel.run::<OneFused>();
    }

    /// One state with fused multiply-add.
    #[derive(Clone, Copy)]
    pub(super) struct OneFused(f64);
    one_state!(OneFused, true, f64::mul_add);

    /// Eight states in one register.
    #[derive(Clone, Copy)]
    pub(super) struct Z8<const FUSED: bool>(__m512d);

    /// Four states in one register: of a block those from lane `AT` on, or a group of four (`AT` is 0).
    #[derive(Clone, Copy)]
    pub(super) struct Y4<const AT: usize, const FUSED: bool, M = Block>(__m256d, PhantomData<M>);

    // SAFETY of all intrinsics below: these types are private to this module and constructed only inside the entry points
    // above, which enable every feature named by the intrinsics. Blocks are 64-byte aligned by their type; four numbers are
    // read and written unaligned, from slices that hold them; `AT` is 0 or 4.

    macro_rules! z8_operator {
        ($trait:ident, $fn:ident, $intrinsic:ident) => {
            impl<const FUSED: bool> $trait for Z8<FUSED> {
                type Output = Self;
                #[inline(always)]
                fn $fn(self, o: Self) -> Self {
                    Self(unsafe { $intrinsic(self.0, o.0) })
                }
            }
        };
    }
    z8_operator!(Add, add, _mm512_add_pd);
    z8_operator!(Sub, sub, _mm512_sub_pd);
    z8_operator!(Mul, mul, _mm512_mul_pd);
    z8_operator!(Div, div, _mm512_div_pd);
    impl<const FUSED: bool> Neg for Z8<FUSED> {
        type Output = Self;
        #[inline(always)]
        fn neg(self) -> Self {
            Self(unsafe { _mm512_xor_pd(self.0, _mm512_set1_pd(-0.0)) })
        }
    }
    impl<const FUSED: bool> Real for Z8<FUSED> {
        type Mem = Block;
        const FUSED: bool = FUSED;
        #[inline(always)]
        fn splat(x: f64) -> Self {
            Self(unsafe { _mm512_set1_pd(x) })
        }
        #[inline(always)]
        fn load(m: &Block) -> Self {
            Self(unsafe { _mm512_load_pd(m.0.as_ptr()) })
        }
        #[inline(always)]
        fn store(self, m: &mut Block) {
            unsafe { _mm512_store_pd(m.0.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn from_words(words: &[Word; LANES]) -> Self {
            Self(unsafe {
                let k = _mm512_cvtepu32_epi64(_mm256_loadu_si256(words.as_ptr().cast()));
                let bits = _mm512_or_si512(_mm512_slli_epi64::<20>(k), _mm512_set1_epi64(ONE_BITS.cast_signed()));
                _mm512_sub_pd(_mm512_castsi512_pd(bits), _mm512_set1_pd(WORD_SHIFT))
            })
        }
        #[inline(always)]
        fn fma(self, b: Self, c: Self) -> Self {
            if FUSED { Self(unsafe { _mm512_fmadd_pd(self.0, b.0, c.0) }) } else { self * b + c }
        }
        #[inline(always)]
        fn fnma(self, b: Self, c: Self) -> Self {
            if FUSED { Self(unsafe { _mm512_fnmadd_pd(self.0, b.0, c.0) }) } else { c - self * b }
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(unsafe { _mm512_sqrt_pd(self.0) })
        }
        #[inline(always)]
        fn max(self, o: Self) -> Self {
            Self(unsafe { _mm512_max_pd(self.0, o.0) })
        }
        #[inline(always)]
        fn min(self, o: Self) -> Self {
            Self(unsafe { _mm512_min_pd(self.0, o.0) })
        }
        #[inline(always)]
        fn select_gt(self, limit: f64, yes: Self, no: Self) -> Self {
            Self(unsafe {
                let mask = _mm512_cmp_pd_mask::<_CMP_GT_OQ>(self.0, _mm512_set1_pd(limit));
                _mm512_mask_blend_pd(mask, no.0, yes.0)
            })
        }
        #[inline(always)]
        fn select_odd(t: Self, yes: Self, no: Self) -> Self {
            Self(unsafe {
                let mask = _mm512_test_epi64_mask(_mm512_castpd_si512(t.0), _mm512_set1_epi64(1));
                _mm512_mask_blend_pd(mask, no.0, yes.0)
            })
        }
        #[inline(always)]
        fn negate_by_bit1(self, t: Self) -> Self {
            Self(unsafe {
                let sign = _mm512_and_si512(
                    _mm512_slli_epi64::<62>(_mm512_castpd_si512(t.0)),
                    _mm512_set1_epi64(SIGN.cast_signed()),
                );
                _mm512_xor_pd(self.0, _mm512_castsi512_pd(sign))
            })
        }
        #[inline(always)]
        fn half_pow2(t: Self) -> Self {
            Self(unsafe {
                let k = _mm512_slli_epi64::<52>(_mm512_castpd_si512(t.0));
                _mm512_castsi512_pd(_mm512_add_epi64(k, _mm512_set1_epi64(HALF_BITS.cast_signed())))
            })
        }
        #[inline(always)]
        fn exponent_mantissa(self) -> (Self, Self) {
            unsafe {
                let bits = _mm512_castpd_si512(self.0);
                let e = _mm512_or_si512(_mm512_srli_epi64::<52>(bits), _mm512_set1_epi64(TWO52_BITS.cast_signed()));
                let m = _mm512_or_si512(
                    _mm512_and_si512(bits, _mm512_set1_epi64(MANTISSA.cast_signed())),
                    _mm512_set1_epi64(ONE_BITS.cast_signed()),
                );
                (
                    Self(_mm512_sub_pd(_mm512_castsi512_pd(e), _mm512_set1_pd(TWO52_PLUS_BIAS))),
                    Self(_mm512_castsi512_pd(m)),
                )
            }
        }
    }

    macro_rules! y4_operator {
        ($trait:ident, $fn:ident, $intrinsic:ident) => {
            impl<const AT: usize, const FUSED: bool, M> $trait for Y4<AT, FUSED, M> {
                type Output = Self;
                #[inline(always)]
                fn $fn(self, o: Self) -> Self {
                    Self(unsafe { $intrinsic(self.0, o.0) }, PhantomData)
                }
            }
        };
    }
    y4_operator!(Add, add, _mm256_add_pd);
    y4_operator!(Sub, sub, _mm256_sub_pd);
    y4_operator!(Mul, mul, _mm256_mul_pd);
    y4_operator!(Div, div, _mm256_div_pd);
    impl<const AT: usize, const FUSED: bool, M> Neg for Y4<AT, FUSED, M> {
        type Output = Self;
        #[inline(always)]
        fn neg(self) -> Self {
            Self(unsafe { _mm256_xor_pd(self.0, _mm256_set1_pd(-0.0)) }, PhantomData)
        }
    }
    impl<const AT: usize, const FUSED: bool, M: Memory> Real for Y4<AT, FUSED, M> {
        type Mem = M;
        const FUSED: bool = FUSED;
        #[inline(always)]
        fn splat(x: f64) -> Self {
            Self(unsafe { _mm256_set1_pd(x) }, PhantomData)
        }
        #[inline(always)]
        fn load(m: &M) -> Self {
            Self(unsafe { _mm256_loadu_pd(m.as_ref()[AT..AT + 4].as_ptr()) }, PhantomData)
        }
        #[inline(always)]
        fn store(self, m: &mut M) {
            unsafe { _mm256_storeu_pd(m.as_mut()[AT..AT + 4].as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn from_words(words: &[Word; LANES]) -> Self {
            Self(
                unsafe {
                    let k = _mm256_cvtepu32_epi64(_mm_loadu_si128(words.as_ptr().add(AT).cast()));
                    let bits = _mm256_or_si256(_mm256_slli_epi64::<20>(k), _mm256_set1_epi64x(ONE_BITS.cast_signed()));
                    _mm256_sub_pd(_mm256_castsi256_pd(bits), _mm256_set1_pd(WORD_SHIFT))
                },
                PhantomData,
            )
        }
        #[inline(always)]
        fn fma(self, b: Self, c: Self) -> Self {
            if FUSED { Self(unsafe { _mm256_fmadd_pd(self.0, b.0, c.0) }, PhantomData) } else { self * b + c }
        }
        #[inline(always)]
        fn fnma(self, b: Self, c: Self) -> Self {
            if FUSED { Self(unsafe { _mm256_fnmadd_pd(self.0, b.0, c.0) }, PhantomData) } else { c - self * b }
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(unsafe { _mm256_sqrt_pd(self.0) }, PhantomData)
        }
        #[inline(always)]
        fn max(self, o: Self) -> Self {
            Self(unsafe { _mm256_max_pd(self.0, o.0) }, PhantomData)
        }
        #[inline(always)]
        fn min(self, o: Self) -> Self {
            Self(unsafe { _mm256_min_pd(self.0, o.0) }, PhantomData)
        }
        #[inline(always)]
        fn select_gt(self, limit: f64, yes: Self, no: Self) -> Self {
            Self(
                unsafe {
                    let mask = _mm256_cmp_pd::<_CMP_GT_OQ>(self.0, _mm256_set1_pd(limit));
                    _mm256_blendv_pd(no.0, yes.0, mask)
                },
                PhantomData,
            )
        }
        #[inline(always)]
        fn select_odd(t: Self, yes: Self, no: Self) -> Self {
            Self(
                unsafe {
                    let mask = _mm256_slli_epi64::<63>(_mm256_castpd_si256(t.0));
                    _mm256_blendv_pd(no.0, yes.0, _mm256_castsi256_pd(mask))
                },
                PhantomData,
            )
        }
        #[inline(always)]
        fn negate_by_bit1(self, t: Self) -> Self {
            Self(
                unsafe {
                    let sign = _mm256_and_si256(
                        _mm256_slli_epi64::<62>(_mm256_castpd_si256(t.0)),
                        _mm256_set1_epi64x(SIGN.cast_signed()),
                    );
                    _mm256_xor_pd(self.0, _mm256_castsi256_pd(sign))
                },
                PhantomData,
            )
        }
        #[inline(always)]
        fn half_pow2(t: Self) -> Self {
            Self(
                unsafe {
                    let k = _mm256_slli_epi64::<52>(_mm256_castpd_si256(t.0));
                    _mm256_castsi256_pd(_mm256_add_epi64(k, _mm256_set1_epi64x(HALF_BITS.cast_signed())))
                },
                PhantomData,
            )
        }
        #[inline(always)]
        fn exponent_mantissa(self) -> (Self, Self) {
            unsafe {
                let bits = _mm256_castpd_si256(self.0);
                let e = _mm256_or_si256(_mm256_srli_epi64::<52>(bits), _mm256_set1_epi64x(TWO52_BITS.cast_signed()));
                let m = _mm256_or_si256(
                    _mm256_and_si256(bits, _mm256_set1_epi64x(MANTISSA.cast_signed())),
                    _mm256_set1_epi64x(ONE_BITS.cast_signed()),
                );
                (
                    Self(_mm256_sub_pd(_mm256_castsi256_pd(e), _mm256_set1_pd(TWO52_PLUS_BIAS)), PhantomData),
                    Self(_mm256_castsi256_pd(m), PhantomData),
                )
            }
        }
    }

    /// [`chacha::blocks`] with a row of two blocks in a register, and two such pairs beside each other.
    #[target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt")]
    pub(super) fn chacha_blocks(key: &chacha::Key, places: &chacha::Places, out: &mut [chacha::Words; 4]) {
        // SAFETY: a row is four numbers, the places of two blocks are eight.
        let row = |row: &[u32; 4]| unsafe { [_mm256_broadcastsi128_si256(_mm_loadu_si128(row.as_ptr().cast())); 2] };
        let two = |at: usize| unsafe { _mm256_loadu_si256(places[at..at + 2].as_ptr().cast()) };
        let before = [row(&chacha::CONSTANTS), row(&key[0]), row(&key[1]), [two(0), two(2)]];
        let [mut a, mut b, mut c, mut d] = before;
        macro_rules! mixed {
            ($a:ident, $b:ident, $d:ident, $by:literal) => {
                for k in 0..2 {
                    $a[k] = _mm256_add_epi32($a[k], $b[k]);
                    $d[k] = _mm256_xor_si256($d[k], $a[k]);
                    $d[k] = _mm256_or_si256(_mm256_slli_epi32::<$by>($d[k]), _mm256_srli_epi32::<{ 32 - $by }>($d[k]));
                }
            };
        }
        macro_rules! round {
            ($b:literal, $c:literal, $d:literal) => {
                mixed!(a, b, d, 16);
                mixed!(c, d, b, 12);
                mixed!(a, b, d, 8);
                mixed!(c, d, b, 7);
                for k in 0..2 {
                    b[k] = _mm256_shuffle_epi32::<$b>(b[k]);
                    c[k] = _mm256_shuffle_epi32::<$c>(c[k]);
                    d[k] = _mm256_shuffle_epi32::<$d>(d[k]);
                }
            };
        }
        for _ in 0..4 {
            round!(0x39, 0x4e, 0x93);
            round!(0x93, 0x4e, 0x39);
        }
        for k in 0..2 {
            let [a, b] = [_mm256_add_epi32(a[k], before[0][k]), _mm256_add_epi32(b[k], before[1][k])];
            let [c, d] = [_mm256_add_epi32(c[k], before[2][k]), _mm256_add_epi32(d[k], before[3][k])];
            let of_first = [_mm256_permute2x128_si256::<0x20>(a, b), _mm256_permute2x128_si256::<0x20>(c, d)];
            let of_second = [_mm256_permute2x128_si256::<0x31>(a, b), _mm256_permute2x128_si256::<0x31>(c, d)];
            for (block, halves) in [(2 * k, of_first), (2 * k + 1, of_second)] {
                for (words, half) in out[block].as_chunks_mut::<8>().0.iter_mut().zip(halves) {
                    // SAFETY: eight words are as long as the register.
                    unsafe { _mm256_storeu_si256(words.as_mut_ptr().cast(), half) }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Everything<'a> {
        x: &'a [Block],
        out: &'a mut [Block],
    }
    impl Kernel<Block> for Everything<'_> {
        #[inline(always)]
        fn run<V: Real<Mem = Block>>(&mut self) {
            let (a, b) = (V::load(&self.x[0]), V::load(&self.x[1]));
            let t = a + V::splat(ROUND_MAGIC);
            let (e, m) = b.exponent_mantissa();
            let words = [0, 1, 2, 3, 1 << 31, u32::MAX, 77, 1 << 30].map(u32::to_le_bytes);
            let all = [
                V::from_words(&words),
                a + b,
                a - b,
                a * b,
                a / b,
                -a,
                b.sqrt(),
                a.max(b),
                a.min(b),
                a.select_gt(0.5, a, b),
                V::select_odd(t, a, b),
                a.negate_by_bit1(t),
                V::half_pow2(t),
                e,
                m,
            ];
            for (o, v) in self.out.iter_mut().zip(all) {
                v.store(o);
            }
        }
    }

    #[test]
    fn every_set_gives_the_same_bits_where_nothing_is_fused() {
        let x =
            [Block([0.0, 1.0, -1.0, 2.0, -2.5, 3.0, 7.0, -8.0]), Block([1.0, 0.3, 2.0, 4.5, 1e-300, 1e300, 0.1, 3.0])];
        let run = |isa| {
            let mut out = [Block::ZERO; 15];
            dispatch(isa, Everything { x: &x, out: &mut out });
            out
        };
        let baseline = run(Isa::baseline());
        assert_eq!((baseline[0].0[0], baseline[0].0[4]), (0.5_f64.powi(33), 0.5 + 0.5_f64.powi(33)));
        assert_eq!((baseline[7].0[1], baseline[8].0[1]), (1.0, 0.3));
        assert_eq!(baseline[10].0[1], 1.0);
        assert_eq!(baseline[11].0[3], -2.0);
        assert_eq!(baseline[12].0[7], 1.0 / 512.0);
        assert_eq!((baseline[13].0[3], baseline[14].0[3]), (2.0, 1.125));
        for isa in Isa::available() {
            assert_eq!(run(isa), baseline, "{}", isa.name());
        }
    }

    /// a b + 1 + a, and a b + 1.
    struct Both;
    impl LaneMap<2, 2> for Both {
        #[inline(always)]
        fn run<V: Real>(&self, [a, b]: [&[V::Mem]; 2], [sums, products]: [&mut [V::Mem]; 2], ws: &mut [V::Mem]) {
            for ((a, b), scratch) in a.iter().zip(b).zip(&mut *ws) {
                V::load(a).fma(V::load(b), V::splat(1.0)).store(scratch);
            }
            for (((scratch, a), sum), product) in ws.iter().zip(a).zip(sums).zip(products) {
                (V::load(scratch) + V::load(a)).store(sum);
                V::load(scratch).store(product);
            }
        }
    }

    #[test]
    fn maps_are_the_same_for_each_state_of_a_block_and_for_one() {
        let a: Vec<Block> =
            (0..3).map(|k| Block([0, 1, 2, 3, 4, 5, 6, 7].map(|lane| f64::from(8 * k + lane)))).collect();
        let b: Vec<Block> = a.iter().map(|block| Block(block.0.map(|x| 0.5 - x))).collect();
        for isa in Isa::available() {
            let (mut sums, mut products) = ([Block::ZERO; 3], [Block::ZERO; 3]);
            map_block(isa, &Both, [&a, &b], [&mut sums, &mut products], &mut [Block::ZERO; 3]);
            for lane in 0..LANES {
                let one = |blocks: &[Block]| blocks.iter().map(|block| block.0[lane]).collect::<Vec<f64>>();
                let (mut sum, mut product) = ([0.0; 3], [0.0; 3]);
                map_one(isa, &Both, [&one(&a), &one(&b)], [&mut sum, &mut product], 3);
                assert_eq!((one(&sums), one(&products)), (sum.to_vec(), product.to_vec()), "{}", isa.name());
                for (k, (sum, product)) in sum.into_iter().zip(product).enumerate() {
                    let x = (8 * k + lane) as f64;
                    assert_eq!((sum, product), (x * (0.5 - x) + 1.0 + x, x * (0.5 - x) + 1.0));
                }
            }
        }
    }

    struct Products<'a>([&'a Block; 3], &'a mut [Block; 2]);
    impl Kernel<Block> for Products<'_> {
        #[inline(always)]
        fn run<V: Real<Mem = Block>>(&mut self) {
            let [a, b, c] = [V::load(self.0[0]), V::load(self.0[1]), V::load(self.0[2])];
            assert!(!V::FUSED);
            a.fma(b, c).store(&mut self.1[0]);
            a.fnma(b, c).store(&mut self.1[1]);
        }
    }

    #[test]
    fn unfused_kernels_have_the_bits_of_the_baseline() {
        let [a, b] = [0.1, 0.7].map(|x| Block([1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0].map(|k| k * x)));
        let c = Block([0.0, -0.0, 1.0, 1e-17, 1e17, -1.26, f64::INFINITY, 3.0]);
        let (mut found, mut expected) = ([Block::ZERO; 2], [Block::ZERO; 2]);
        dispatch_unfused(Products([&a, &b, &c], &mut found));
        dispatch(Isa::baseline(), Products([&a, &b, &c], &mut expected));
        let bits = |blocks: &[Block]| numbers(blocks).iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&found), bits(&expected));
    }

    #[test]
    fn sets_are_found_by_name() {
        assert_eq!(Isa::by_name("baseline"), Some(Isa::baseline()));
        assert_eq!(Isa::by_name(Isa::best().name()), Some(Isa::best()));
        assert_eq!(Isa::by_name("mmx"), None);
    }
}
