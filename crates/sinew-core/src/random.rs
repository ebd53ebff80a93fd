//! Random streams that depend on what they are for, never on who draws first.
//!
//! Every use of randomness has a 256-bit key and a 64-bit stream number of the counter-based generator ChaCha8:
//!
//! - key = hash of (seed, purpose), where the purpose is the path of names handed down: experiment, run, verb, layer;
//! - stream = frame << 32 | block of eight particles or chains.
//!
//! So results do not depend on the number of threads, any block can be replayed alone, and seed *n* shares nothing with seed *n* + 1.
//! A [`Stage`] is neither `Copy` nor `Clone`, and a verb takes it by value, so that no two verbs share one by mistake. Within a verb [`Stage::block`] and [`Stage::round`] borrow it: each block and each round is asked for
//! once, since the same one gives the same numbers again.
//!
//! Normal deviates are drawn in lanes by Box & Muller (1958) from 32-bit uniforms (`(k + ½) · 2⁻³²`), so no deviate exceeds 6.77 in size.
//!
//! ```
//! use sinew_core::random::Stage;
//! use sinew_core::lanes::{Block, Isa};
//! let verbs = |stage: Stage| stage.split(["predict", "resample"]);
//! let [predict, _resample] = verbs(Stage::new(7, "example").at_frame(3));
//! let mut noise = [Block::ZERO; 4];
//! predict.block(0).fill_normal(Isa::best(), &mut noise);
//! assert!(noise.iter().all(|b| b.0.iter().all(|z| z.abs() < 6.8)));
//! ```

use crate::chacha::{Key, Words};
use crate::elementary::{ln, sin_cos_turns};
use crate::lanes::{Block, Isa, Kernel, LANES, Real, Word, dispatch, dispatch_unfused, numbers};
use crate::streams::{Stream, first_blocks};
use rand::rand_core::{Infallible, TryRng};
use std::ops::Range;

/// Key and frame of one use of randomness.
#[derive(Debug)]
pub struct Stage {
    key: Key,
    frame: u32,
}

fn derive(key: Key, name: &str) -> Key {
    // FNV-1a of the name selects the stream from which the derived key is read.
    let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |h, b| (h ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3));
    let mut derived = [[Word::default(); 4]; 2];
    Stream::new(key, hash).fill(derived.as_flattened_mut());
    derived.map(|row| row.map(u32::from_le_bytes))
}

impl Stage {
    /// The root of a seed and purpose, at frame 0.
    #[must_use]
    pub fn new(seed: u64, purpose: &str) -> Self {
        let mut key = *b"sinew random stage 1 ........ ..";
        key[24..].copy_from_slice(&seed.to_le_bytes());
        let mut words = Key::default();
        for (word, bytes) in words.as_flattened_mut().iter_mut().zip(key.as_chunks().0) {
            *word = u32::from_le_bytes(*bytes);
        }
        Self { key: derive(words, purpose), frame: 0 }
    }

    /// The same purpose at another frame.
    #[must_use]
    pub fn at_frame(self, frame: u32) -> Self {
        Self { frame, ..self }
    }

    /// One stage for each of the named verbs.
    #[must_use]
    pub fn split<const N: usize>(self, verbs: [&str; N]) -> [Self; N] {
        verbs.map(|verb| Self { key: derive(self.key, verb), frame: self.frame })
    }

    /// The stage of one numbered round of a repeated verb.
    #[must_use]
    pub fn round(&self, index: usize) -> Self {
        Self { key: derive(self.key, &format!("round {index}")), frame: self.frame }
    }

    /// The generator of one block of eight particles or chains.
    #[must_use]
    pub fn block(&self, block: u32) -> BlockRng {
        BlockRng { stream: Stream::new(self.key, self.stream(block)), normals: [Block::ZERO; 2], left: 0 }
    }

    /// The generators of blocks that are asked for one after the other: the same numbers in less time.
    #[must_use]
    pub fn blocks(&self) -> BlockRngs<'_> {
        BlockRngs { stage: self, rng: self.block(0), first: [[Word::default(); 16]; 4], ahead: 0..0 }
    }

    fn stream(&self, block: u32) -> u64 {
        u64::from(self.frame) << 32 | u64::from(block)
    }

    /// The generator of a verb that is not divided into blocks.
    #[must_use]
    pub fn whole(self) -> BlockRng {
        self.block(u32::MAX)
    }
}

/// Random numbers for one block; a [`rand::Rng`].
#[derive(Clone, Debug)]
pub struct BlockRng {
    stream: Stream,
    /// Deviates for [`BlockRng::normal`], of which the first `left` have not been drawn.
    normals: [Block; 2],
    left: usize,
}

/// The generators of a stage's blocks ([`Stage::blocks`]).
#[derive(Clone, Debug)]
pub struct BlockRngs<'a> {
    stage: &'a Stage,
    rng: BlockRng,
    /// What the streams of four blocks begin with.
    first: [Words; 4],
    /// The four blocks.
    ahead: Range<u64>,
}

impl BlockRngs<'_> {
    /// What [`Stage::block`] gives.
    pub fn block(&mut self, block: u32) -> &mut BlockRng {
        if !self.ahead.contains(&u64::from(block)) {
            self.ahead = u64::from(block)..u64::from(block) + 4;
            let streams = [0, 1, 2, 3].map(|k| self.stage.stream(block.wrapping_add(k)));
            first_blocks(&self.stage.key, streams, &mut self.first);
        }
        let first = &self.first[(u64::from(block) - self.ahead.start) as usize];
        self.rng.stream.restart(self.stage.stream(block), first);
        self.rng.left = 0;
        &mut self.rng
    }
}

impl TryRng for BlockRng {
    type Error = Infallible;
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        let [word] = self.stream.next();
        Ok(u32::from_le_bytes(word))
    }
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        let [low, high] = self.stream.next().map(|word| u64::from(u32::from_le_bytes(word)));
        Ok(high << 32 | low)
    }
    fn try_fill_bytes(&mut self, dst: &mut [u8]) -> Result<(), Infallible> {
        let (words, rest) = dst.as_chunks_mut();
        self.stream.fill(words);
        if !rest.is_empty() {
            let [word] = self.stream.next();
            rest.copy_from_slice(&word[..rest.len()]);
        }
        Ok(())
    }
}

/// Blocks that are drawn together: four times what the generator makes at a time, so that words are in memory before they are read as vectors.
const AT_ONCE: usize = 32;

struct Uniform<'a> {
    words: &'a [[Word; LANES]],
    out: &'a mut [Block],
}

impl Kernel<Block> for Uniform<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        for (words, out) in self.words.iter().zip(&mut *self.out) {
            V::from_words(words).store(out);
        }
    }
}

/// Normal deviates, in pairs; the second of the last pair may be left out.
struct BoxMuller<'a> {
    words: &'a [[Word; LANES]],
    out: &'a mut [Block],
}

impl Kernel<Block> for BoxMuller<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        for ([u, v], pair) in self.words.as_chunks().0.iter().zip(self.out.chunks_mut(2)) {
            let radius = (ln(V::from_words(u)) * V::splat(-2.0)).sqrt();
            let (sin, cos) = sin_cos_turns(V::from_words(v));
            (radius * cos).store(&mut pair[0]);
            if let Some(second) = pair.get_mut(1) {
                (radius * sin).store(second);
            }
        }
    }
}

impl BlockRng {
    /// One uniform number in (0, 1).
    pub fn uniform(&mut self) -> f64 {
        ((rand::Rng::next_u64(self) >> 12) as f64 + 0.5) / (1_u64 << 52) as f64
    }

    /// One standard normal deviate; its bits do not depend on an instruction set. Sixteen are made at a time.
    pub fn normal(&mut self) -> f64 {
        if self.left == 0 {
            self.make_normals();
        }
        self.left -= 1;
        numbers(&self.normals)[self.left]
    }

    #[inline(never)]
    fn make_normals(&mut self) {
        let mut normals = [Block::ZERO; 2];
        let out = &mut normals[..];
        self.with_words(2, |words| dispatch_unfused(BoxMuller { words, out }));
        (self.normals, self.left) = (normals, 2 * LANES);
    }

    /// Fills with uniform numbers in (0, 1); their bits do not depend on an instruction set.
    pub fn fill_uniform(&mut self, out: &mut [Block]) {
        for out in out.chunks_mut(AT_ONCE) {
            self.with_words(out.len(), |words| dispatch_unfused(Uniform { words, out }));
        }
    }

    /// Fills with independent standard normal deviates.
    pub fn fill_normal(&mut self, isa: Isa, out: &mut [Block]) {
        for out in out.chunks_mut(AT_ONCE) {
            self.with_words(out.len().next_multiple_of(2), |words| dispatch(isa, BoxMuller { words, out }));
        }
    }

    /// Draws words for `count` ≤ [`AT_ONCE`] blocks.
    fn with_words(&mut self, count: usize, then: impl FnOnce(&[[Word; LANES]])) {
        match count {
            2 => {
                let words: [Word; 2 * LANES] = self.stream.next();
                then(words.as_chunks().0);
            }
            0..=8 => self.with_copied_words::<8>(count, then),
            _ => self.with_copied_words::<AT_ONCE>(count, then),
        }
    }

    fn with_copied_words<const N: usize>(&mut self, count: usize, then: impl FnOnce(&[[Word; LANES]])) {
        let mut words = [[Word::default(); LANES]; N];
        self.stream.fill(words[..count].as_flattened_mut());
        then(&words[..count]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::Rng;
    use std::collections::HashSet;

    fn prefix(rng: &mut BlockRng) -> u128 {
        let mut bytes = [0; 16];
        rng.fill_bytes(&mut bytes);
        u128::from_le_bytes(bytes)
    }

    /// 1 000 000 keys: neighbouring seeds at both ends of their range, purposes and verbs, frames and blocks as they are used. Were the prefixes random, two would agree with probability 1.5e-27.
    #[test]
    fn streams_never_share_a_prefix() {
        let seeds = [0, 1, 2, 3, 4, 5, 6, 7, u64::MAX - 1, u64::MAX];
        let purposes = ["track", "set-up", "thin", "smooth", "size"];
        let mut prefixes = Vec::with_capacity(1_000_000);
        for seed in seeds {
            for purpose in purposes {
                for frame in (0..98).chain([u32::MAX - 1, u32::MAX]) {
                    let stage = Stage::new(seed, purpose).at_frame(frame);
                    prefixes.extend((0..120).map(|block| prefix(&mut stage.block(block))));
                    for verb in stage.split(["predict", "resample", "start", "chains"]) {
                        prefixes.extend((0..19).map(|block| prefix(&mut verb.block(block))));
                        prefixes.push(prefix(&mut verb.whole()));
                    }
                }
            }
        }
        assert_eq!(prefixes.len(), 1_000_000);
        prefixes.sort_unstable();
        assert!(prefixes.windows(2).all(|pair| pair[0] != pair[1]));
    }

    /// Seed n and chain i + 1 are not seed n + 1 and chain i, nor any other two that add up alike.
    #[test]
    fn neighbouring_seeds_share_no_stream() {
        let states_of_seed = |seed: u64| -> HashSet<u128> {
            let stream = |place: u32| prefix(&mut Stage::new(seed, "track").at_frame(place / 8).block(place % 8));
            (0..64).map(stream).collect()
        };
        for seed in 0..200 {
            assert!(states_of_seed(seed).is_disjoint(&states_of_seed(seed + 1)), "{seed}");
        }
    }

    /// Bits of all words in their share of ones: a generator that gives the same number again, or none, has none or all.
    #[test]
    fn words_of_all_widths_are_random() {
        let mut rng = Stage::new(1, "words").whole();
        let mut bytes = [0; 400];
        rng.fill_bytes(&mut bytes);
        let ones = [
            (0..100).map(|_| rng.next_u32().count_ones()).sum::<u32>(),
            (0..50).map(|_| rng.next_u64().count_ones()).sum(),
            bytes.iter().map(|byte| byte.count_ones()).sum(),
        ];
        // 3200 bits: standard deviation 28.
        assert!(ones.into_iter().all(|ones| ones.abs_diff(1600) < 5 * 28), "{ones:?}");
    }

    #[test]
    fn uniform_numbers_fill_the_interval_evenly() {
        let mut out = vec![Block::splat(f64::NAN); 12_500];
        Stage::new(2, "uniform").whole().fill_uniform(&mut out);
        let mut u: Vec<f64> = out.iter().flat_map(|block| block.0).collect();
        u.sort_by(f64::total_cmp);
        assert!(u[0] > 0.0 && u[u.len() - 1] < 1.0);
        // Kolmogorov's distance of 100 000 numbers, exceeded once in a million times.
        let farthest = u.iter().enumerate().map(|(i, u)| (u - i as f64 / 1e5).abs()).fold(0.0, f64::max);
        assert!(farthest < 2.7 / 1e5_f64.sqrt(), "{farthest}");
    }

    #[test]
    fn the_same_stage_gives_the_same_numbers() {
        let draw = || prefix(&mut Stage::new(1, "x").at_frame(9).round(4).block(3));
        assert_eq!(draw(), draw());
    }

    /// In any order, again, at both ends of the numbers, whatever was drawn before.
    #[test]
    fn generators_made_together_are_those_of_their_blocks() {
        let stage = Stage::new(5, "together").at_frame(7);
        let mut rngs = stage.blocks();
        for (count, block) in [0, 1, 2, 3, 4, 9, 10, 8, 8, u32::MAX - 1, u32::MAX, 0].into_iter().enumerate() {
            let (found, expected) = (rngs.block(block), &mut stage.block(block));
            assert_eq!(found.normal(), expected.normal(), "block {block}");
            let (mut some, mut others) = ([0; 150], [0; 150]);
            found.fill_bytes(&mut some[..30 * (count % 6)]);
            expected.fill_bytes(&mut others[..30 * (count % 6)]);
            assert_eq!((some, found.uniform()), (others, expected.uniform()), "block {block}");
        }
    }

    /// One after the other they are what sixteen at a time give, from the last to the first, and a copy goes on alike.
    #[test]
    fn single_deviates_are_those_of_blocks() {
        let (mut rng, mut blocks) = (Stage::new(3, "single").block(1), [Block::ZERO; 2]);
        Stage::new(3, "single").block(1).fill_normal(Isa::baseline(), &mut blocks);
        let drawn: Vec<f64> = (0..16).map(|_| rng.normal()).collect();
        assert!(drawn.iter().rev().eq(numbers(&blocks)));
        let mut copy = rng.clone();
        assert!((0..40).all(|_| rng.normal() == copy.normal()) && (0..40).all(|_| rng.uniform() == copy.uniform()));
        let mean = (0..10_000).map(|_| rng.uniform()).sum::<f64>() / 1e4;
        assert!((mean - 0.5).abs() < 5.0 * (1.0 / 12e4_f64).sqrt(), "{mean}");
    }

    #[test]
    fn normal_deviates_have_the_moments_and_distribution_of_a_standard_normal() {
        for isa in Isa::available() {
            let mut noise = vec![Block::ZERO; 25_001];
            Stage::new(11, "normal").block(0).fill_normal(isa, &mut noise);
            let mut z: Vec<f64> = noise.iter().flat_map(|b| b.0).collect();
            let n = z.len() as f64;
            for (power, expected, variance) in [(1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0)] {
                let mean = z.iter().map(|z| z.powi(power)).sum::<f64>() / n;
                let score = (mean - expected) / (variance / n).sqrt();
                assert!(score.abs() < 4.5, "moment {power}: z = {score} on {}", isa.name());
            }
            z.sort_by(f64::total_cmp);
            let ranked = |p: f64| z[(p * n) as usize];
            for (p, quantile, density) in
                [(0.05, -1.644_853_627, 0.103_135), (0.5, 0.0, 0.398_942), (0.975, 1.959_963_985, 0.058_445)]
            {
                let score = (ranked(p) - quantile) / ((p * (1.0 - p) / n).sqrt() / density);
                assert!(score.abs() < 4.5, "quantile {p}: z = {score}");
            }
        }
    }
}
