//! Resampling: from weights to the ancestors of `n` new states.
//!
//! | scheme | rule | counts |
//! |---|---|---|
//! | [`multinomial`] | u_k independent uniforms | binomial(n, W_i) |
//! | [`residual`] | ⌊n W_i⌋ copies, the rest multinomial on what remains (Liu & Chen 1998) | ≥ ⌊n W_i⌋ |
//! | [`stratified`] | u_k = (k + U_k) / n (Kitagawa 1996) | mean n W_i |
//! | [`systematic`] | u_k = (k + U) / n, one U (Carpenter, Clifford & Fearnhead 1999) | ⌊n W_i⌋ or ⌈n W_i⌉ |
//!
//! The ancestor of u is the least j with W_1 + … + W_j ≥ u. All four keep `E[count_i] = n W_i`. Ancestors come *sorted*, so that a gather walks through memory: the multinomial ones by drawing sorted uniforms
//! from exponential spacings (Devroye 1986, V.3.1). Where two independently resampled sub-vectors are later paired by index, permute one of them.
//!
//! [`Truncation`] (Husz, Wallace & Green 2007: "only the highest 80 % survive") is biased on purpose, in both readings.
//!
//! Weights need not be normalised; they must be finite, not negative and not all zero, as [`crate::weights::normalise`] makes them. A weight of zero has no offspring.
//!
//! ```
//! use sinew_core::random::Stage;
//! use sinew_samplers::resample::systematic;
//! let ancestors = systematic(&[0.5, 0.25, 0.25], 4, &mut Stage::new(1, "example").whole());
//! assert_eq!(ancestors, [0, 0, 1, 2]);
//! ```

use crate::weights::sum;
use rand::Rng;
use sinew_core::elementary::ln;
use sinew_core::lanes::{Block, Kernel, LANES, Real, dispatch_unfused};

/// Indices of the states from which the new ones come.
pub type Ancestors = Vec<usize>;

/// Choice of an unbiased scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Scheme {
    /// [`multinomial`], what all four papers use.
    #[default]
    Multinomial,
    /// [`residual`].
    Residual,
    /// [`stratified`].
    Stratified,
    /// [`systematic`].
    Systematic,
}

impl Scheme {
    /// Draws `n` ancestors by this scheme.
    pub fn ancestors(self, weights: &[f64], n: usize, rng: &mut impl Rng) -> Ancestors {
        let mut ancestors = vec![];
        self.fill(weights, n, rng, &mut ancestors, &mut Room::default());
        ancestors
    }

    /// [`Scheme::ancestors`] into a vector and with scratch that are used again: nothing is allocated when they are large enough.
    pub fn fill(self, weights: &[f64], n: usize, rng: &mut impl Rng, ancestors: &mut Ancestors, room: &mut Room) {
        match self {
            Self::Multinomial => fill_multinomial(weights, n, rng, ancestors, room),
            Self::Residual => *ancestors = residual(weights, n, rng),
            Self::Stratified => fill_stratified(weights, n, rng, ancestors, room),
            Self::Systematic => fill_systematic(weights, n, rng, ancestors),
        }
    }
}

/// Scratch of [`Scheme::fill`]; what it holds between two calls means nothing.
#[derive(Clone, Debug, Default)]
pub struct Room {
    uniforms: Vec<f64>,
    ends: Vec<u64>,
    positions: Vec<u64>,
}

/// Appends `n` uniforms in (0, 1), never an end.
fn uniforms(n: usize, rng: &mut impl Rng, out: &mut Vec<f64>) {
    let mut bytes = [[0; 8]; 32];
    out.clear();
    out.reserve(n + bytes.len());
    while out.len() < n {
        rng.fill_bytes(bytes.as_flattened_mut());
        out.extend(bytes.map(|b| ((u64::from_le_bytes(b) >> 12) as f64 + 0.5) / (1_u64 << 52) as f64));
    }
    out.truncate(n);
}

/// Parts of a whole as whole numbers, in the ratio of some numbers: of n slots each is 2ᵇ of them, n · 2ᵇ at most 2⁶². Their running sums are exact.
#[derive(Clone, Copy)]
struct Shares {
    bits: u32,
    factors: [f64; 2],
}

impl Shares {
    fn new(of: &[f64], n: usize) -> Self {
        let bits = 62 - (usize::BITS - n.leading_zeros());
        let (total, whole) = (sum(of), n as f64 * (1_u64 << bits) as f64);
        // Of numbers so small that the factor has no finite value they are taken larger first.
        let larger = if (whole / total).is_finite() { 1.0 } else { 2.0_f64.powi(600) };
        Self { bits, factors: [larger, whole / (total * larger)] }
    }

    fn of(self, part: f64) -> u64 {
        ((part * self.factors[0] * self.factors[1] + 0.5) as i64).cast_unsigned()
    }

    /// A place in a slot, 1 to 2ᵇ: never its start, which belongs to the slot before.
    fn place(self, uniform: f64) -> u64 {
        ((uniform * (1_u64 << self.bits) as f64) as i64).cast_unsigned() + 1
    }
}

/// The weights up to the last that is not zero, which gets what rounding has left over.
fn not_zero(weights: &[f64]) -> &[f64] {
    &weights[..weights.iter().rposition(|&w| w > 0.0).map_or(0, |last| last + 1)]
}

/// Ancestors of `n` slots where `passed` says how many positions a running sum has passed. Each state writes its index where its slots begin, so that the next overwrites it if it has none; then each slot takes the largest index so far. No step depends on how many slots a state has: a branch would be mispredicted for every second one.
fn fill_slots(
    weights: &[f64],
    n: usize,
    shares: Shares,
    start: u64,
    passed: impl Fn(u64) -> usize,
    ancestors: &mut Ancestors,
) {
    ancestors.clear();
    ancestors.resize(n + 1, 0);
    let (mut sum, mut first) = (start, 0);
    for (state, &weight) in not_zero(weights).iter().enumerate() {
        ancestors[first] = state;
        sum = sum.wrapping_add(shares.of(weight));
        first = passed(sum).min(n);
    }
    ancestors.truncate(n);
    let mut largest = 0;
    for ancestor in ancestors {
        largest = largest.max(*ancestor);
        *ancestor = largest;
    }
}

fn fill_systematic(weights: &[f64], n: usize, rng: &mut impl Rng, ancestors: &mut Ancestors) {
    let mut offset = vec![];
    uniforms(1, rng, &mut offset);
    let shares = Shares::new(weights, n);
    // Slot k has the position k 2ᵇ + u, which the sum S has passed where k ≤ (S − u) / 2ᵇ.
    let start = (1 << shares.bits) - shares.place(offset[0]);
    fill_slots(weights, n, shares, start, |sum| (sum >> shares.bits) as usize, ancestors);
}

fn fill_stratified(weights: &[f64], n: usize, rng: &mut impl Rng, ancestors: &mut Ancestors, room: &mut Room) {
    uniforms(n + 1, rng, &mut room.uniforms);
    let shares = Shares::new(weights, n);
    let passed = |sum: u64| {
        let slot = (sum >> shares.bits) as usize;
        let inside = sum & ((1 << shares.bits) - 1);
        slot + usize::from(shares.place(room.uniforms[slot.min(n)]) <= inside)
    };
    fill_slots(weights, n, shares, 0, passed, ancestors);
}

/// Walks that are made at the same time: each step waits for the one before it, and not for those of other walks.
const WALKS: usize = 4;

/// The point of a merge of ascending positions into ascending ends after `steps` steps: how many positions and how many ends are passed.
fn merged(ends: &[u64], positions: &[u64], steps: usize) -> [usize; 2] {
    let (mut low, mut high) = (steps.saturating_sub(ends.len()), steps.min(positions.len()));
    while low < high {
        let middle = usize::midpoint(low, high);
        if positions[middle] <= ends[steps - middle - 1] { low = middle + 1 } else { high = middle }
    }
    [low, steps - low]
}

/// Ancestors of ascending positions among ascending ends, of which the last is beyond all positions. One step passes a position or an end, chosen without a branch.
fn walk(ends: &[u64], positions: &[u64], ancestors: &mut Ancestors) {
    let (n, steps) = (positions.len(), ends.len() + positions.len());
    ancestors.clear();
    ancestors.resize(n + 1, 0);
    let mut walks: [_; WALKS] = core::array::from_fn(|i| merged(ends, positions, steps * i / WALKS));
    let step = |[position, end]: &mut [usize; 2], ancestors: &mut [usize]| {
        let inside = positions.get(*position).is_some_and(|p| ends.get(*end).is_some_and(|e| p <= e));
        // What is no position yet is written behind the last.
        ancestors[if inside { *position } else { n }] = *end;
        *position += usize::from(inside);
        *end += usize::from(!inside);
    };
    let common = steps / WALKS;
    for _ in 0..common {
        walks.iter_mut().for_each(|walk| step(walk, ancestors));
    }
    for (i, walk) in walks.iter_mut().enumerate() {
        (common..steps * (i + 1) / WALKS - steps * i / WALKS).for_each(|_| step(walk, ancestors));
    }
    ancestors.truncate(n);
}

/// Turns uniforms into exponential deviates.
struct Exponentials<'a>(&'a mut [[f64; LANES]]);

impl Kernel<Block> for Exponentials<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        for eight in &mut *self.0 {
            let mut block = Block(*eight);
            (-ln(V::load(&block))).store(&mut block);
            *eight = block.0;
        }
    }
}

/// Ascending running sums of shares, from 1.
fn running(of: &[f64], shares: Shares, out: &mut Vec<u64>) {
    out.clear();
    let mut sum = 0_u64;
    out.extend(of.iter().map(|part| {
        sum = sum.wrapping_add(shares.of(*part));
        sum.max(1)
    }));
}

fn fill_multinomial(weights: &[f64], n: usize, rng: &mut impl Rng, ancestors: &mut Ancestors, room: &mut Room) {
    let Room { uniforms: spacings, ends, positions } = room;
    uniforms((n + 1).next_multiple_of(LANES), rng, spacings);
    // Their bits do not depend on the instruction set.
    dispatch_unfused(Exponentials(spacings.as_chunks_mut().0));
    spacings.truncate(n + 1);
    running(&spacings[..n], Shares::new(spacings, n), positions);
    running(not_zero(weights), Shares::new(weights, n), ends);
    if let Some(last) = ends.last_mut() {
        *last = u64::MAX;
    }
    walk(ends, positions, ancestors);
}

/// Independent draws with probabilities proportional to the weights.
pub fn multinomial(weights: &[f64], n: usize, rng: &mut impl Rng) -> Ancestors {
    Scheme::Multinomial.ancestors(weights, n, rng)
}

/// Puts ancestors in random order, each order as probable as any other (Fisher & Yates; R. Durstenfeld 1964), for pairing them with others.
pub fn shuffle(ancestors: &mut [usize], rng: &mut impl Rng) {
    for last in (1..ancestors.len()).rev() {
        ancestors.swap(last, below(last + 1, rng));
    }
}

/// A whole number below `n`; no number is more probable than another by more than n / 2⁶⁴.
pub(crate) fn below(n: usize, rng: &mut impl Rng) -> usize {
    ((u128::from(rng.next_u64()) * n as u128) >> 64) as usize
}

/// One draw from each of `n` equal strata.
pub fn stratified(weights: &[f64], n: usize, rng: &mut impl Rng) -> Ancestors {
    Scheme::Stratified.ancestors(weights, n, rng)
}

/// A comb of `n` equal teeth with one random offset.
pub fn systematic(weights: &[f64], n: usize, rng: &mut impl Rng) -> Ancestors {
    Scheme::Systematic.ancestors(weights, n, rng)
}

/// The whole part of each expected count, the rest at random.
pub fn residual(weights: &[f64], n: usize, rng: &mut impl Rng) -> Ancestors {
    let total: f64 = weights.iter().sum();
    let expected = |w: f64| w / total * n as f64;
    // The factor keeps an expected count that is whole but for rounding whole.
    let copies = |w: f64| (expected(w) * (1.0 + 1e-13)).floor();
    let rest: Vec<f64> = weights.iter().map(|&w| (expected(w) - copies(w)).max(0.0)).collect();
    let mut ancestors: Ancestors =
        weights.iter().enumerate().flat_map(|(i, &w)| std::iter::repeat_n(i, copies(w) as usize)).take(n).collect();
    let missing = n - ancestors.len();
    if missing > 0 {
        ancestors.extend(multinomial(&rest, missing, rng));
        ancestors.sort_unstable();
    }
    ancestors
}

/// The highest `surviving` share of the states (rounded up; of equals the lower index) keep their slots once; the freed slots are refilled from the survivors, systematically by weight.
/// The new states have equal weights. Not unbiased: it keeps variety. Not sorted: survivors stay where they are.
pub fn keep_once_refill(weights: &[f64], surviving: f64, rng: &mut impl Rng) -> Ancestors {
    let (kept, slots) = truncated(weights, surviving);
    let mut ancestors: Ancestors = (0..weights.len()).collect();
    for (slot, ancestor) in slots.iter().zip(systematic(&kept, slots.len(), rng)) {
        ancestors[*slot] = ancestor;
    }
    ancestors
}

/// The highest `surviving` share of the states (rounded up; of equals the lower index) are resampled systematically by weight; the others have no offspring. Not unbiased: it concentrates. Sorted.
pub fn truncate_then_systematic(weights: &[f64], surviving: f64, rng: &mut impl Rng) -> Ancestors {
    let (kept, _) = truncated(weights, surviving);
    systematic(&kept, weights.len(), rng)
}

/// The weights of the highest share of the states, 0 for the others; and the slots of these, ascending.
fn truncated(weights: &[f64], surviving: f64) -> (Vec<f64>, Vec<usize>) {
    let n = weights.len();
    let survivors = ((surviving * n as f64 - 1e-9).ceil() as usize).clamp(n.min(1), n);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| weights[b].total_cmp(&weights[a]));
    let mut freed = order.split_off(survivors);
    freed.sort_unstable();
    let mut kept = weights.to_vec();
    freed.iter().for_each(|&slot| kept[slot] = 0.0);
    (kept, freed)
}

/// Choice of what "only the highest 80 % survive" means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Truncation {
    /// [`keep_once_refill`].
    #[default]
    KeepOnceRefill,
    /// [`truncate_then_systematic`].
    TruncateThenSystematic,
}

impl Truncation {
    /// Draws as many ancestors as there are weights, of which the highest `surviving` share has offspring.
    pub fn ancestors(self, weights: &[f64], surviving: f64, rng: &mut impl Rng) -> Ancestors {
        match self {
            Self::KeepOnceRefill => keep_once_refill(weights, surviving, rng),
            Self::TruncateThenSystematic => truncate_then_systematic(weights, surviving, rng),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::random::Stage;

    const SCHEMES: [Scheme; 4] = [Scheme::Multinomial, Scheme::Residual, Scheme::Stratified, Scheme::Systematic];

    /// Edge cases of the weights (R4).
    #[test]
    fn zeros_single_weights_and_equal_weights() {
        let mut rng = Stage::new(4, "R4").whole();
        for scheme in SCHEMES {
            assert_eq!(scheme.ancestors(&[0.0, 1.0, 0.0], 5, &mut rng), [1; 5]);
            assert_eq!(scheme.ancestors(&[0.3], 3, &mut rng), [0; 3]);
            assert_eq!(scheme.ancestors(&[0.2, 0.8], 1, &mut rng).len(), 1);
            assert!(scheme.ancestors(&[0.2, 0.8], 0, &mut rng).is_empty());
            for n in [1, 7, 49, 1000, 100_000] {
                let ancestors = scheme.ancestors(&vec![1.0 / n as f64; n], n, &mut rng);
                assert_eq!(ancestors.len(), n);
                if matches!(scheme, Scheme::Systematic | Scheme::Stratified | Scheme::Residual) {
                    assert!(ancestors.iter().copied().eq(0..n), "{scheme:?}, {n} equal weights");
                }
            }
        }
    }

    /// Weights that vanish beside the first one add up all the same.
    #[test]
    fn running_sums_lose_nothing() {
        let mut weights = vec![2.0_f64.powi(-54); 1 << 20];
        weights[0] = 1.0;
        let (shares, mut ends) = (Shares::new(&weights, 1), vec![]);
        running(&weights, shares, &mut ends);
        let rest = (ends[weights.len() - 1] - ends[0]) as f64 / ends[0] as f64;
        assert!((rest / ((2.0_f64.powi(20) - 1.0) * 2.0_f64.powi(-54)) - 1.0).abs() < 1e-9, "{rest}");
    }

    /// Several walks at once are one walk, of any numbers of positions and ends.
    #[test]
    fn walks_meet() {
        let mut rng = Stage::new(8, "walks").whole();
        for [states, n] in [[1, 1], [1, 9], [9, 1], [5, 3], [40, 40], [7, 1000], [1000, 7], [0, 3], [3, 0]] {
            let mut sorted = |count: usize| {
                let mut numbers: Vec<u64> = (0..count).map(|_| below(50, &mut rng) as u64 + 1).collect();
                numbers.sort_unstable();
                numbers
            };
            let (mut ends, positions, mut ancestors) = (sorted(states), sorted(n), vec![]);
            ends.iter_mut().last().into_iter().for_each(|last| *last = u64::MAX);
            walk(&ends, &positions, &mut ancestors);
            let expected = positions.iter().map(|p| ends.iter().position(|e| p <= e).unwrap_or(0));
            assert!(ancestors.iter().copied().eq(expected), "{states} states, {n} positions");
        }
    }

    /// Of weights as small as numbers get, and as large, each state has its share.
    #[test]
    fn weights_need_not_be_normalised() {
        let rng = &mut Stage::new(9, "scale").whole();
        for scheme in SCHEMES {
            for unit in [5e-324, 1e-300, 1.0, 1e300] {
                let ancestors = scheme.ancestors(&[unit, 0.0, 3.0 * unit], 4000, rng);
                let first = ancestors.iter().filter(|a| **a == 0).count();
                // Binomial at most: standard deviation 27.
                assert!(first.abs_diff(1000) < 5 * 28 && !ancestors.contains(&1), "{scheme:?} {unit}: {first}");
            }
        }
    }

    /// Of weights that differ little the lowest would be drawn now and then: 20 slots in 100 rounds.
    #[test]
    fn the_lowest_have_no_offspring_however_little_they_lack() {
        let weights: Vec<f64> = (0..100).map(|i| 1.0 + 1e-3 * i as f64).collect();
        let rng = &mut Stage::new(6, "lowest").whole();
        for truncation in [Truncation::KeepOnceRefill, Truncation::TruncateThenSystematic] {
            for _ in 0..100 {
                let ancestors = truncation.ancestors(&weights, 0.8, rng);
                assert!(ancestors.len() == 100 && ancestors.iter().all(|ancestor| *ancestor >= 20), "{truncation:?}");
            }
        }
    }

    /// The highest share survives unchanged (R5).
    #[test]
    fn keep_once_refill_keeps_the_highest_share_in_place() {
        let weights = [0.05, 0.3, 0.01, 0.2, 0.02, 0.1, 0.05, 0.2, 0.02, 0.05];
        let ancestors = keep_once_refill(&weights, 0.8, &mut Stage::new(5, "R5").whole());
        // The two lowest are 2 (0.01) and, of the two with 0.02, the one of higher index.
        for i in (0..10).filter(|i| ![2, 8].contains(i)) {
            assert_eq!(ancestors[i], i);
        }
        assert!(ancestors.iter().all(|a| ![2, 8].contains(a)));
        let drawn = truncate_then_systematic(&weights, 0.8, &mut Stage::new(5, "R5").whole());
        assert!(drawn.is_sorted() && drawn.len() == 10 && drawn.iter().all(|a| ![2, 8].contains(a)));
        // 0.97 is what survives: each has the whole part of its share, or one more.
        for (i, w) in weights.iter().enumerate().filter(|(i, _)| ![2, 8].contains(i)) {
            let (count, share) = (drawn.iter().filter(|a| **a == i).count() as f64, 10.0 * w / 0.97);
            assert!((share.floor()..=share.ceil()).contains(&count), "{count} of {share}");
        }
        assert_eq!(
            Truncation::TruncateThenSystematic.ancestors(&[0.0, 1.0, 0.0], 0.1, &mut Stage::new(5, "R5").whole()),
            [1; 3]
        );
    }
}
