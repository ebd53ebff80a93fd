//! Resampling: expectations, bounds, variances and independence of threads (R1, R2, R3, R5, R7; R4 is beside the code).

use sinew::core::random::{BlockRng, Stage};
use sinew::samplers::resample::{Scheme, keep_once_refill};

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

/// R1, R2 and R3 on the same replicates. 4 × 30 statistics at |z| < 4.5: false alarm 1e-3.
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

/// R5.
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

/// R7: the same stream gives the same ancestors, and a permutation of the weights permutes what is not random.
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
