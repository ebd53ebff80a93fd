//! Resampling and weights: expectations, bounds, variances and independence of threads.
//!
//! Resampling: mean counts (R1), their bounds (R2) and variance (R3), the share that survives (R5), permutations (R7); edge cases of weights (R4) are tested beside the code. Also hard weights, what resampling leaves, weights far down in log space.

use sinew::core::density::LogDensity;
use sinew::core::lanes::{Block, Isa};
use sinew::core::random::{BlockRng, Stage};
use sinew::core::transition::{MotionModel, Transition};
use sinew::samplers::particles::{Particles, aggregate, predict, resample, reweight, start};
use sinew::samplers::resample::{Scheme, keep_once_refill};
use sinew::samplers::weights::normalise;

const SCHEMES: [Scheme; 4] = [Scheme::Multinomial, Scheme::Residual, Scheme::Stratified, Scheme::Systematic];

/// Multiples of 2⁻⁵² in (0, 1).
fn uniform(rng: &mut BlockRng) -> f64 {
    let mut block = [sinew::core::lanes::Block::ZERO];
    rng.fill_uniform(&mut block);
    block[0].0[0]
}

fn normal(rng: &mut BlockRng) -> f64 {
    let mut block = [sinew::core::lanes::Block::ZERO];
    rng.fill_normal(sinew::core::lanes::Isa::best(), &mut block);
    block[0].0[0]
}

/// Gamma(0.7) by Marsaglia & Tsang (2000), boosted from 1.7; normalised, a Dirichlet(0.7).
fn dirichlet(count: usize, rng: &mut BlockRng) -> Vec<f64> {
    let d = 1.7 - 1.0 / 3.0;
    let gamma: Vec<f64> = (0..count)
        .map(|_| {
            let g = loop {
                let x = normal(rng);
                let v = (1.0 + x / (9.0_f64 * d).sqrt()).powi(3);
                if v > 0.0 && uniform(rng).ln() < 0.5 * x * x + d * (1.0 - v + v.ln()) {
                    break d * v;
                }
            };
            g * uniform(rng).powf(1.0 / 0.7)
        })
        .collect();
    let sum: f64 = gamma.iter().sum();
    gamma.iter().map(|g| g / sum).collect()
}

fn counts(scheme: Scheme, weights: &[f64], n: usize, rng: &mut BlockRng) -> Vec<f64> {
    let mut counts = vec![0.0; weights.len()];
    let ancestors = scheme.ancestors(weights, n, rng);
    assert_eq!(ancestors.len(), n);
    ancestors.iter().for_each(|&a| counts[a] += 1.0);
    counts
}

/// Mean (R1), bounds (R2) and variance (R3) of counts on the same replicates. 4 × 30 statistics at |z| < 4.5: false alarm 1e-3.
#[test]
fn counts_have_the_expected_mean_bounds_and_variance() {
    let (k, n, replicates) = (30, 47, 20_000);
    let mut rng = Stage::new(1, "R1").whole();
    let weights = dirichlet(k, &mut rng);
    let mut total_variance = vec![];
    for scheme in SCHEMES {
        let (mut sum, mut square) = (vec![0.0; k], vec![0.0; k]);
        for _ in 0..replicates {
            for (i, c) in counts(scheme, &weights, n, &mut rng).into_iter().enumerate() {
                let expected = n as f64 * weights[i];
                match scheme {
                    Scheme::Systematic => assert!(c >= expected.floor() && c <= expected.ceil()),
                    Scheme::Residual => assert!(c >= expected.floor()),
                    _ => {}
                }
                sum[i] += c - expected;
                square[i] += (c - expected) * (c - expected);
            }
        }
        let r = f64::from(replicates);
        let mut variances = 0.0;
        for i in 0..k {
            let (mean, variance) = (sum[i] / r, square[i] / r - (sum[i] / r).powi(2));
            let z = mean / (variance / r).sqrt();
            assert!(z.abs() < 4.5, "{scheme:?}, weight {i} = {}: z = {z}, bound 4.5, seed 1", weights[i]);
            variances += variance;
        }
        total_variance.push(variances);
    }
    let [multinomial, residual, stratified, systematic] = total_variance[..] else { unreachable!("four schemes") };
    assert!(systematic <= stratified && stratified <= multinomial && residual <= multinomial, "{total_variance:?}");
}

/// The highest share survives unchanged (R5).
#[test]
fn keep_once_refill_keeps_eighty_percent_in_place() {
    let mut rng = Stage::new(5, "R5").whole();
    for n in [1, 2, 5, 9, 10, 37, 100, 1001] {
        let weights = dirichlet(n, &mut rng);
        let ancestors = keep_once_refill(&weights, 0.8, &mut rng);
        let survivors = (4 * n).div_ceil(5);
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|&a, &b| weights[b].total_cmp(&weights[a]));
        assert!(order[..survivors].iter().all(|&i| ancestors[i] == i), "survivors stay, n = {n}");
        assert!(ancestors.iter().all(|a| order[..survivors].contains(a)), "refilled from survivors, n = {n}");
    }
}

/// Permutations (R7): the same stream gives the same ancestors, and a permutation of the weights permutes what is not random.
#[test]
fn the_stream_alone_decides() {
    let weights = dirichlet(300, &mut Stage::new(7, "R7").whole());
    for scheme in SCHEMES {
        let draw = |seed| scheme.ancestors(&weights, 300, &mut Stage::new(seed, "R7 draw").whole());
        let here = draw(1);
        let threads: Vec<_> = (0..8).map(|_| (weights.clone(), scheme)).collect();
        std::thread::scope(|scope| {
            for (weights, scheme) in threads {
                let here = &here;
                scope.spawn(move || {
                    let there = scheme.ancestors(&weights, 300, &mut Stage::new(1, "R7 draw").whole());
                    assert_eq!(&there, here);
                });
            }
        });
        assert_ne!(draw(2), here);
        let reversed: Vec<f64> = weights.iter().rev().copied().collect();
        let (mut rng, mut forward, mut backward) = (Stage::new(3, "R7 law").whole(), vec![0.0; 300], vec![0.0; 300]);
        for _ in 0..400 {
            for (i, c) in counts(scheme, &weights, 300, &mut rng).into_iter().enumerate() {
                forward[i] += c;
            }
            for (i, c) in counts(scheme, &reversed, 300, &mut rng).into_iter().enumerate() {
                backward[299 - i] += c;
            }
        }
        for i in 0..300 {
            // Each sum of 400 counts has at most the binomial variance.
            let z = (forward[i] - backward[i]) / (2.0 * 400.0 * 300.0 * weights[i]).sqrt().max(1.0);
            assert!(z.abs() < 4.5, "{scheme:?}, weight {i}: z = {z}");
        }
    }
}

/// A walk in one dimension.
struct Walk;

impl MotionModel for Walk {
    fn dim(&self) -> usize {
        1
    }
}

impl Transition for Walk {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        rng.fill_normal(Isa::best(), next);
        next[0].0.iter_mut().zip(previous[0].0).for_each(|(n, p)| *n += p);
    }
    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        -0.5 * (next[0] - previous[0]).powi(2)
    }
}

/// slope · x + shift.
struct Slope(f64, f64);

impl LogDensity for Slope {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.0 * x[0] + self.1
    }
}

fn started(count: usize) -> Particles {
    let mut particles = Particles::new(&[0.0], count).expect("not empty");
    start(&mut particles, &Walk, &[0.0], Stage::new(1, "start"));
    particles
}

/// `after-resample`: weights are equal, ancestors in range, and nothing is added to the evidence by the act.
#[test]
fn resampling_leaves_equal_weights_and_the_evidence_as_it_was() {
    for scheme in SCHEMES {
        for count in [1, 7, 100] {
            let mut particles = started(count);
            reweight(&mut particles, &Slope(1.3, -4.0)).expect("finite");
            let ancestors = resample(&particles, scheme, Stage::new(2, "resample"));
            assert!(ancestors.len() == count && ancestors.iter().all(|&a| a < count));
            predict(&mut particles, Some(ancestors), &Walk, Stage::new(3, "predict"));
            assert!(particles.weights().iter().all(|&w| w == 1.0 / count as f64), "{scheme:?}");
            assert!((particles.effective_sample_size() - count as f64).abs() < 1e-9 * count as f64);
            let nothing = reweight(&mut particles, &Slope(0.0, 0.0)).expect("finite");
            assert!(nothing.abs() < 1e-12, "{scheme:?}: {nothing}");
            let shift = reweight(&mut particles, &Slope(0.0, -2.5)).expect("finite");
            assert!((shift + 2.5).abs() < 1e-12, "{scheme:?}: {shift}");
        }
    }
}

/// `after-resample`: where draws are exchangeable (multinomial, and what residual leaves to it) the variance of a resampled mean does not depend on the order of the particles; where they are not, it stays below the multinomial one.
#[test]
fn the_variance_of_a_resampled_mean_by_order() {
    let weights = dirichlet(40, &mut Stage::new(8, "order").whole());
    let values: Vec<f64> = (0..40).map(|i| f64::from((i * 17) % 40)).collect();
    let mut order: Vec<usize> = (0..40).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let repeats = 4000;
    let variance = |scheme: Scheme, order: &[usize], rng: &mut BlockRng| {
        let own: Vec<f64> = order.iter().map(|&i| weights[i]).collect();
        let means: Vec<f64> = (0..repeats)
            .map(|_| scheme.ancestors(&own, 40, rng).iter().map(|&a| values[order[a]] / 40.0).sum())
            .collect();
        let mean = means.iter().sum::<f64>() / f64::from(repeats);
        means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / f64::from(repeats)
    };
    let mut rng = Stage::new(8, "order draws").whole();
    let natural: Vec<usize> = (0..40).collect();
    let multinomial = variance(Scheme::Multinomial, &natural, &mut rng);
    // A ratio of two variances of 4000 draws scatters by √(4 / 4000) = 3 %.
    for scheme in [Scheme::Multinomial, Scheme::Residual] {
        let ratio = variance(scheme, &order, &mut rng) / variance(scheme, &natural, &mut rng);
        assert!((ratio - 1.0).abs() < 0.15, "{scheme:?}: {ratio}, bound 0.15, seed 8");
    }
    for scheme in [Scheme::Stratified, Scheme::Systematic] {
        let sorted = variance(scheme, &order, &mut rng) / multinomial;
        assert!(sorted < 0.5, "{scheme:?}: {sorted} of the multinomial variance in sorted order");
    }
}

/// Weights around e^{−100 000} with a spread of 10 000: no NaN, the same as after a shift, to 1e-12. All numbers are multiples of 2⁻²⁰, so that the shift itself rounds nothing.
#[test]
fn log_weights_far_down_are_as_good_as_any() {
    let mut rng = Stage::new(9, "log space").whole();
    let log_weights: Vec<f64> =
        (0..200).map(|i| if i % 3 == 0 { -10_000.0 } else { -8.0 } * uniform(&mut rng)).collect();
    let log_weights: Vec<f64> = log_weights.iter().map(|l| (l * 1_048_576.0).round() / 1_048_576.0).collect();
    let shifted: Vec<f64> = log_weights.iter().map(|l| l - 100_000.0).collect();
    let (mut a, mut b) = (vec![], vec![]);
    let sums = [normalise(&log_weights, &mut a).expect("finite"), normalise(&shifted, &mut b).expect("finite")];
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() <= 1e-12 && b.is_finite()));
    assert!((sums[0] - sums[1] - 100_000.0).abs() < 1e-10, "{sums:?}");
    let draw = |w: &[f64]| Scheme::Systematic.ancestors(w, 200, &mut Stage::new(9, "log space draw").whole());
    assert_eq!(draw(&a), draw(&b));
}

/// A particle whose weight has come to 0 in linear space is back when the next observation speaks for it: weights are carried as logarithms.
#[test]
fn a_weight_of_zero_can_recover() {
    let mut particles = started(50);
    let evidence = reweight(&mut particles, &Slope(3000.0, 0.0)).expect("finite");
    assert!(particles.weights().iter().filter(|w| **w == 0.0).count() > 20);
    let back = reweight(&mut particles, &Slope(-3000.0, 0.0)).expect("finite");
    assert!(particles.weights().iter().all(|w| (w - 0.02).abs() < 1e-9), "{:?}", particles.weights());
    assert!((evidence + back).abs() < 1e-8);
}

/// `filter-invariance`: an update in two halves is the whole update, to 1e-12.
#[test]
fn two_half_updates_are_one() {
    let (mut whole, mut halves) = (started(101), started(101));
    let once = reweight(&mut whole, &Slope(2.0, -7.0)).expect("finite");
    let twice: f64 = (0..2).map(|_| reweight(&mut halves, &Slope(1.0, -3.5)).expect("finite")).sum();
    assert!((once - twice).abs() < 1e-12, "{once} against {twice}");
    assert!(whole.weights().iter().zip(halves.weights()).all(|(a, b)| (a - b).abs() < 1e-12));
    assert!((aggregate(&whole)[0] - aggregate(&halves)[0]).abs() < 1e-12);
}
