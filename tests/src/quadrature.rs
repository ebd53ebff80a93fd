//! Exact references by quadrature: static posteriors in one to three dimensions, and a filter on a line.
//!
//! An axis is cut into panels with eight Gauss–Legendre nodes each: exact for polynomials of degree 15 within a panel, so that a smooth density that fits into some panels, and indicators whose ends are ends of panels, come out to
//! rounding. The filter on a line uses equal steps, the trapezoidal rule, which converges exponentially for densities that vanish at both ends.

use sinew::core::density::LogDensity;
use sinew::core::lanes::{Block, LANES};
use sinew::core::transition::Moments;
use std::f64::consts::PI;

/// Nodes with weights on an interval.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Where the density is evaluated.
    pub nodes: Vec<f64>,
    /// What each node counts.
    pub weights: Vec<f64>,
}

const ORDER: usize = 8;

/// Nodes and weights on (−1, 1): roots of the Legendre polynomial by Newton's method.
fn legendre() -> [(f64, f64); ORDER] {
    let n = ORDER as f64;
    std::array::from_fn(|i| {
        let mut x = (PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut slope = 1.0;
        for _ in 0..50 {
            let (mut last, mut this) = (1.0, x);
            for k in 2..=ORDER {
                let k = k as f64;
                (last, this) = (this, ((2.0 * k - 1.0) * x * this - (k - 1.0) * last) / k);
            }
            slope = n * (x * this - last) / (x * x - 1.0);
            x -= this / slope;
        }
        (x, 2.0 / ((1.0 - x * x) * slope * slope))
    })
}

impl Axis {
    /// Panels between consecutive `ends`, each divided into `parts`.
    #[must_use]
    pub fn new(ends: &[f64], parts: usize) -> Self {
        let rule = legendre();
        let (mut nodes, mut weights) = (vec![], vec![]);
        for ends in ends.windows(2) {
            let half = 0.5 * (ends[1] - ends[0]) / parts as f64;
            for part in 0..parts {
                let middle = ends[0] + half * (2 * part + 1) as f64;
                nodes.extend(rule.iter().map(|(x, _)| middle + half * x));
                weights.extend(rule.iter().map(|(_, w)| half * w));
            }
        }
        Self { nodes, weights }
    }
}

/// What quadrature says of a density.
#[derive(Clone, Debug, PartialEq)]
pub struct Exact {
    /// Logarithm of the integral.
    pub log_evidence: f64,
    /// Mean and covariance.
    pub moments: Moments,
    /// Probability of each region.
    pub masses: Vec<f64>,
}

/// Integrates a density over a box of one axis a coordinate, and its mass in each of `regions` regions, to which `region` assigns the nodes.
///
/// # Panics
/// Without axes.
#[must_use]
pub fn integrate(density: &impl LogDensity, axes: &[Axis], regions: usize, region: impl Fn(&[f64]) -> usize) -> Exact {
    let d = axes.len();
    assert!(d > 0 && d == density.dim(), "one axis a coordinate");
    let count: usize = axes.iter().map(|axis| axis.nodes.len()).product();
    let at = |index: usize, x: &mut [f64]| {
        let (mut index, mut weight) = (index, 1.0);
        for (x, axis) in x.iter_mut().zip(axes).rev() {
            let k = index % axis.nodes.len();
            index /= axis.nodes.len();
            *x = axis.nodes[k];
            weight *= axis.weights[k];
        }
        weight
    };
    let (mut block, mut ws) = (vec![Block::ZERO; d], vec![Block::ZERO; density.workspace()]);
    let mut state = vec![0.0; d];
    let mut values = Vec::with_capacity(count);
    for first in (0..count).step_by(LANES) {
        for lane in 0..LANES {
            at((first + lane).min(count - 1), &mut state);
            block.iter_mut().zip(&state).for_each(|(b, x)| b.0[lane] = *x);
        }
        values.extend(density.log_density_block(&block, &mut ws).0);
    }
    values.truncate(count);
    let peak = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (mut total, mut mean, mut masses) = (0.0, vec![0.0; d], vec![0.0; regions]);
    let mut square = vec![0.0; d * d];
    let mut centre = vec![0.0; d];
    for pass in 0..2 {
        for (index, value) in values.iter().enumerate() {
            let weight = at(index, &mut state) * (value - peak).exp();
            if pass == 0 {
                total += weight;
                masses[region(&state)] += weight;
                mean.iter_mut().zip(&state).for_each(|(m, x)| *m += weight * x);
            } else {
                for (e, entry) in square.iter_mut().enumerate() {
                    *entry += weight * (state[e / d] - centre[e / d]) * (state[e % d] - centre[e % d]);
                }
            }
        }
        if pass == 0 {
            centre = mean.iter().map(|m| m / total).collect();
        }
    }
    Exact {
        log_evidence: peak + total.ln(),
        moments: Moments { mean: centre, covariance: square.iter().map(|s| s / total).collect() },
        masses: masses.iter().map(|m| m / total).collect(),
    }
}

/// What is known of a frame on a line.
#[derive(Clone, Debug, PartialEq)]
pub struct OnLine {
    /// log p(z_t | earlier).
    pub log_likelihood: f64,
    /// Mean.
    pub mean: f64,
    /// Variance.
    pub variance: f64,
    /// P(x > 0); half of what lies on 0 counts.
    pub positive: f64,
    /// The filtered probability of each node.
    pub masses: Vec<f64>,
}

/// The exact filter of a state on a line, on `points` equal steps from `low` to `high`: `start` is the log density of the first frame's state, `step` of (frame, from, to), `seen` of (frame, state).
#[must_use]
pub fn line_filter(
    [low, high]: [f64; 2],
    points: usize,
    frames: usize,
    start: impl Fn(f64) -> f64,
    step: impl Fn(usize, f64, f64) -> f64,
    seen: impl Fn(usize, f64) -> f64,
) -> Vec<OnLine> {
    let width = (high - low) / (points - 1) as f64;
    let nodes: Vec<f64> = (0..points).map(|i| low + width * i as f64).collect();
    let mut before: Vec<f64> = nodes.iter().map(|&x| start(x).exp() * width).collect();
    let mut out = Vec::with_capacity(frames);
    for frame in 0..frames {
        if frame > 0 {
            let mut moved = vec![0.0; points];
            for (from, mass) in nodes.iter().zip(&before).filter(|(_, mass)| **mass > 1e-300) {
                for (to, sum) in nodes.iter().zip(&mut moved) {
                    *sum += mass * step(frame, *from, *to).exp() * width;
                }
            }
            before = moved;
        }
        let values: Vec<f64> = nodes.iter().map(|&x| seen(frame, x)).collect();
        let peak = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        before.iter_mut().zip(&values).for_each(|(p, l)| *p *= (l - peak).exp());
        let total: f64 = before.iter().sum();
        before.iter_mut().for_each(|p| *p /= total);
        let expected = |f: &dyn Fn(f64) -> f64| nodes.iter().zip(&before).map(|(&x, p)| p * f(x)).sum::<f64>();
        let mean = expected(&|x| x);
        let side = |x: f64| if x.abs() < 1e-9 * width { 0.5 } else { f64::from(u8::from(x > 0.0)) };
        out.push(OnLine {
            log_likelihood: peak + total.ln(),
            mean,
            variance: expected(&|x| (x - mean) * (x - mean)),
            positive: expected(&side),
            masses: before.clone(),
        });
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::core::density::Lanes;
    use sinew::core::lanes::Isa;
    use sinew::dynamics::gaussian::Gaussian;

    /// A correlated Gaussian in three dimensions: integral, moments, mass of an orthant (Sheppard's formula).
    #[test]
    fn a_gaussian_has_its_moments_and_orthants() {
        let covariance = [2.0, 0.6, 0.3, 0.6, 1.0, -0.2, 0.3, -0.2, 0.5];
        let leaf = Gaussian::new(vec![0.0; 3], &covariance).expect("valid");
        let density = Lanes { leaf, isa: Isa::best() };
        let axis = |sd: f64| Axis::new(&[-9.0 * sd, 0.0, 9.0 * sd], 6);
        let axes = [axis(2.0_f64.sqrt()), axis(1.0), axis(0.5_f64.sqrt())];
        let all_positive = |x: &[f64]| usize::from(x.iter().all(|x| *x > 0.0));
        let exact = integrate(&density, &axes, 2, all_positive);
        assert!(exact.log_evidence.abs() < 1e-12, "{}", exact.log_evidence);
        assert!(exact.moments.mean.iter().all(|m| m.abs() < 1e-12));
        for (found, c) in exact.moments.covariance.iter().zip(&covariance) {
            assert!((found - c).abs() < 1e-10, "{found} against {c}");
        }
        let angle =
            |i: usize, j: usize| (covariance[3 * i + j] / (covariance[4 * i] * covariance[4 * j]).sqrt()).asin();
        let orthant = 0.125 + (angle(0, 1) + angle(0, 2) + angle(1, 2)) / (4.0 * PI);
        assert!((exact.masses[1] - orthant).abs() < 1e-10, "{} against {orthant}", exact.masses[1]);
    }

    /// An exponential cut off at 0 and a Cauchy density's core: neither is Gaussian, both have closed forms.
    #[test]
    fn what_is_not_gaussian_is_exact_too() {
        struct OneSided;
        impl LogDensity for OneSided {
            fn dim(&self) -> usize {
                1
            }
            fn log_density(&self, x: &[f64]) -> f64 {
                -2.0 * x[0]
            }
        }
        let exact = integrate(&OneSided, &[Axis::new(&[0.0, 20.0], 20)], 1, |_| 0);
        assert!((exact.log_evidence + 2.0_f64.ln()).abs() < 1e-13);
        assert!((exact.moments.mean[0] - 0.5).abs() < 1e-13 && (exact.moments.covariance[0] - 0.25).abs() < 1e-12);
        struct Cauchy;
        impl LogDensity for Cauchy {
            fn dim(&self) -> usize {
                1
            }
            fn log_density(&self, x: &[f64]) -> f64 {
                -(x[0] * x[0]).ln_1p()
            }
        }
        let exact = integrate(&Cauchy, &[Axis::new(&[-3.0, 1.0, 3.0], 10)], 2, |x| usize::from(x[0] > 1.0));
        let whole = 2.0 * 3.0_f64.atan();
        assert!((exact.log_evidence - whole.ln()).abs() < 1e-13);
        assert!((exact.masses[1] - (3.0_f64.atan() - 1.0_f64.atan()) / whole).abs() < 1e-13);
    }

    /// A scalar Kalman filter.
    #[test]
    fn the_filter_on_a_line_agrees_with_a_closed_form() {
        let normal = |x: f64, variance: f64| -0.5 * x * x / variance - 0.5 * (2.0 * PI * variance).ln();
        let z = [0.4, 1.7, -0.3, 2.2];
        let found = line_filter(
            [-15.0, 15.0],
            301,
            4,
            |x| normal(x - 0.5, 2.0),
            |_, from, to| normal(to - 0.9 * from, 0.3),
            |frame, x| normal(z[frame] - x, 0.5),
        );
        let (mut mean, mut variance) = (0.5, 2.0);
        for (frame, z) in z.iter().enumerate() {
            if frame > 0 {
                (mean, variance) = (0.9 * mean, 0.81 * variance + 0.3);
            }
            let log = normal(z - mean, variance + 0.5);
            let gain = variance / (variance + 0.5);
            (mean, variance) = (mean + gain * (z - mean), (1.0 - gain) * variance);
            let at = &found[frame];
            assert!((at.log_likelihood - log).abs() < 1e-12, "{} against {log}", at.log_likelihood);
            assert!((at.mean - mean).abs() < 1e-12 && (at.variance - variance).abs() < 1e-12);
        }
    }
}
