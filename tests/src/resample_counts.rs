//! Counts of resampling for weights that hurt: zeros, denormals, one that is nearly all (`resample-unbiased`).

use crate::finding::Finding;
use sinew::core::random::Stage;
use sinew::samplers::resample::Scheme;

/// Names and weights.
#[must_use]
pub fn hard_weights() -> Vec<(&'static str, Vec<f64>)> {
    let mut nearly_one = vec![1e-16 / 7.0; 8];
    nearly_one[3] = 1.0 - 1e-16;
    let falling: Vec<f64> = (0..40).map(|i| 0.5_f64.powi(i)).collect();
    let mut zeros = vec![0.0; 30];
    (0..30).step_by(3).for_each(|i| zeros[i] = 1.0 + i as f64);
    vec![
        ("zeros between", zeros),
        ("one nearly all", nearly_one),
        ("denormals among ordinary ones", vec![5e-324, 0.25, 1e-310, 0.0, 0.75, -0.0, 5e-324]),
        ("falling over twelve decades", falling),
        ("huge", vec![1e300, 3e300, 0.0, 2e300]),
        ("one alone", vec![0.4]),
    ]
}

/// Mean counts over `repeats` draws of `n` ancestors against n W_i, largest |z|; sums of counts, zero weights and the bounds of each scheme are exact.
#[must_use]
pub fn counts(scheme: Scheme, name: &str, weights: &[f64], n: usize, repeats: usize, seed: u64) -> [Finding; 2] {
    let largest = weights.iter().copied().fold(0.0, f64::max);
    let total: f64 = weights.iter().map(|w| w / largest).sum();
    let expected: Vec<f64> = weights.iter().map(|w| w / largest / total * n as f64).collect();
    let what = format!("{scheme:?}, {name}, n = {n}");
    let mut rng = Stage::new(seed, &what).whole();
    let (mut sums, mut squares) = (vec![0.0; weights.len()], vec![0.0; weights.len()]);
    let mut broken = 0;
    let mut count = vec![0.0; weights.len()];
    for _ in 0..repeats {
        count.fill(0.0);
        let ancestors = scheme.ancestors(weights, n, &mut rng);
        broken += usize::from(ancestors.len() != n);
        ancestors.iter().for_each(|&a| count[a] += 1.0);
        for (i, &c) in count.iter().enumerate() {
            let off = c - expected[i];
            let slack = 1e-9 * n as f64;
            broken += usize::from(weights[i] == 0.0 && c > 0.0);
            broken += usize::from(scheme == Scheme::Systematic && off.abs() > 1.0 + slack);
            broken += usize::from(scheme == Scheme::Residual && c < (expected[i] - slack).floor());
            sums[i] += off;
            squares[i] += off * off;
        }
    }
    let r = repeats as f64;
    let (mut worst, mut rare, mut expected_rare) = (0.0_f64, 0.0, 0.0);
    for i in 0..weights.len() {
        // No law of whole counts has less variance than this.
        let part = expected[i].fract();
        let least = part * (1.0 - part);
        if least * r < 25.0 && expected[i] < 0.5 {
            rare += sums[i] + r * expected[i];
            expected_rare += r * expected[i];
            continue;
        }
        let mean = sums[i] / r;
        let variance = (squares[i] / r - mean * mean).max(least).max(1e-18 * (n * n) as f64);
        let z = mean / (variance / r).sqrt();
        if z.abs() > worst.abs() {
            worst = z;
        }
    }
    // Weights too small for a normal law are counted together, to far beyond what a Poisson law allows.
    broken += usize::from(rare > expected_rare + 10.0 * expected_rare.sqrt() + 10.0);
    let detail = format!("largest of {} weights, {repeats} repeats, seed {seed}", weights.len());
    [
        Finding::at_most(format!("{what}: broken laws"), broken as f64, 0.0, "sums, zero weights, floors and ceilings"),
        Finding::score(format!("{what}: mean counts"), worst, 4.5, detail),
    ]
}

/// All schemes, weights and sizes.
#[must_use]
pub fn all_counts(repeats: usize, seed: u64) -> Vec<Finding> {
    let mut findings = vec![];
    for scheme in crate::evidence::SCHEMES {
        for (name, weights) in hard_weights() {
            for n in [1, 13, 1000] {
                let repeats = if n == 1000 { repeats / 20 } else { repeats };
                findings.extend(counts(scheme, name, &weights, n, repeats.max(200), seed));
            }
        }
    }
    findings
}
