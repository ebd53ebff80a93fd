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

use rand::Rng;
use sinew_core::elementary::ln;
use sinew_core::lanes::{Block, Isa, Kernel, LANES, Real, dispatch};

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
        match self {
            Self::Multinomial => multinomial(weights, n, rng),
            Self::Residual => residual(weights, n, rng),
            Self::Stratified => stratified(weights, n, rng),
            Self::Systematic => systematic(weights, n, rng),
        }
    }
}

/// Uniforms in (0, 1), never an end.
fn uniforms(n: usize, rng: &mut impl Rng) -> Vec<f64> {
    let mut bytes = [[0; 8]; 32];
    let mut out = Vec::with_capacity(n + bytes.len());
    while out.len() < n {
        rng.fill_bytes(bytes.as_flattened_mut());
        out.extend(bytes.map(|b| ((u64::from_le_bytes(b) >> 12) as f64 + 0.5) / (1_u64 << 52) as f64));
    }
    out.truncate(n);
    out
}

/// Ends of the parts of (0, n) that the states cover: state i has n W_i. What rounding takes from the running sum is summed apart (D. E. Knuth's exact sum of two), so that its error does not grow with it.
fn ends(weights: &[f64], n: usize) -> Vec<f64> {
    let (total, n) = (weights.iter().sum::<f64>(), n as f64);
    let (mut sum, mut lost) = (0.0, 0.0);
    let end = |weight: &f64| {
        let part = weight / total * n;
        let next = sum + part;
        let added = next - sum;
        lost += (sum - (next - added)) + (part - added);
        sum = next;
        sum + lost
    };
    weights.iter().map(end).collect()
}

/// Ancestors of ascending positions in (0, n). One step passes a position or a state, chosen without a branch: the counts are random, so a branch would be mispredicted for every second state.
fn walk(weights: &[f64], positions: &[f64]) -> Ancestors {
    let ends = ends(weights, positions.len());
    let mut ancestors = vec![0; positions.len()];
    let (mut state, mut k) = (0, 0);
    while k < positions.len() && state < ends.len() {
        ancestors[k] = state;
        let inside = positions[k] <= ends[state];
        let step = usize::from(inside);
        k += step;
        state += 1 - step;
    }
    // Positions that rounding left beyond the last end.
    let last = weights.iter().rposition(|&w| w > 0.0).unwrap_or(0);
    ancestors[k..].fill(last);
    ancestors
}

/// Turns uniforms into exponential deviates.
struct Exponentials<'a>(&'a mut [Block]);

impl Kernel<Block> for Exponentials<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        for block in &mut *self.0 {
            (-ln(V::load(block))).store(block);
        }
    }
}

/// Exponential deviates; their bits do not depend on the instruction set.
fn exponentials(n: usize, rng: &mut impl Rng) -> Vec<f64> {
    let uniforms = uniforms(n.next_multiple_of(LANES), rng);
    let mut blocks: Vec<Block> = uniforms.as_chunks::<LANES>().0.iter().map(|u| Block(*u)).collect();
    dispatch(Isa::baseline(), Exponentials(&mut blocks));
    blocks.iter().flat_map(|block| block.0).take(n).collect()
}

/// Independent draws with probabilities proportional to the weights.
pub fn multinomial(weights: &[f64], n: usize, rng: &mut impl Rng) -> Ancestors {
    let spacings = exponentials(n + 1, rng);
    let scale = n as f64 / spacings.iter().sum::<f64>();
    let mut sum = 0.0;
    let position = |spacing: &f64| {
        sum += spacing;
        sum * scale
    };
    walk(weights, &spacings[..n].iter().map(position).collect::<Vec<_>>())
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
    let offsets = uniforms(n, rng);
    walk(weights, &offsets.iter().enumerate().map(|(k, u)| k as f64 + u).collect::<Vec<_>>())
}

/// A comb of `n` equal teeth with one random offset.
pub fn systematic(weights: &[f64], n: usize, rng: &mut impl Rng) -> Ancestors {
    let offset = uniforms(1, rng)[0];
    walk(weights, &(0..n).map(|k| k as f64 + offset).collect::<Vec<_>>())
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

    /// R4.
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
        let last = *ends(&weights, 1).last().expect("not empty");
        assert_eq!(last, 1.0 + (2.0_f64.powi(20) - 1.0) * 2.0_f64.powi(-54));
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

    /// R5.
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
