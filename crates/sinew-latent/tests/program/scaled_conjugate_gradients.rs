//! Scaled conjugate gradients, as a reference beside L-BFGS.
//!
//! Møller, *A scaled conjugate gradient algorithm for fast supervised learning*, Neural Networks 6 (1993), 525–533; the numbers in the comments are the steps of the algorithm box. Instead of a line search, the curvature δ along the
//! direction p is a difference of gradients, made positive by a trust parameter λ that grows where the quadratic model fails.

use sinew_core::lbfgs::Objective;

/// What a minimisation reached.
pub struct Reached {
    pub x: Vec<f64>,
    pub value: f64,
    pub evaluations: usize,
}

/// From `x` until the gradient vanishes, λ passes all bounds or the evaluations are used up.
pub fn minimise(objective: &mut impl Objective, mut x: Vec<f64>, evaluations: usize) -> Reached {
    let n = x.len();
    let mut gradient = vec![0.0; n];
    let mut value = objective.evaluate(&x, &mut gradient);
    let mut used = 1;
    // 1: λ₁ = 10⁻⁶, λ̄ = 0, p = r = −∇f.
    let mut residual: Vec<f64> = gradient.iter().map(|g| -g).collect();
    let mut direction = residual.clone();
    let (mut scale, mut scale_before, mut success, mut curvature) = (1e-6_f64, 0.0, true, 0.0);
    let mut probe = vec![0.0; n];
    for k in 1.. {
        let square = dot(&direction, &direction);
        if used + 2 > evaluations || square == 0.0 || scale.is_nan() || scale > 1e100 {
            break;
        }
        if success {
            // 2: δ = pᵀ (∇f(x + σ p) − ∇f(x)) / σ with σ = 10⁻⁴ / |p|.
            let sigma = 1e-4 / square.sqrt();
            objective.evaluate(&along(&x, &direction, sigma), &mut probe);
            used += 1;
            curvature = (dot(&direction, &probe) + dot(&direction, &residual)) / sigma;
        }
        // 3, 4: scaled, and made positive.
        curvature += (scale - scale_before) * square;
        if curvature <= 0.0 {
            scale_before = 2.0 * (scale - curvature / square);
            curvature = -curvature + scale * square;
            scale = scale_before;
        }
        // 5, 6: length of the step, and how much of the decrease that the model promises comes true.
        let slope = dot(&direction, &residual);
        let length = slope / curvature;
        let there = along(&x, &direction, length);
        let value_there = objective.evaluate(&there, &mut gradient);
        used += 1;
        let comparison = 2.0 * curvature * (value - value_there) / (slope * slope);
        // 7: the step is taken where the value falls; every n steps the direction is the steepest again.
        success = comparison >= 0.0;
        if success {
            let before = std::mem::replace(&mut residual, gradient.iter().map(|g| -g).collect());
            (x, value, scale_before) = (there, value_there, 0.0);
            let beta = if k % n == 0 { 0.0 } else { (dot(&residual, &residual) - dot(&residual, &before)) / slope };
            direction = along(&residual, &direction, beta);
            if comparison >= 0.75 {
                scale *= 0.25;
            }
        } else {
            scale_before = scale;
        }
        // 8: more trust in the gradient where the model failed.
        let is_trusted = comparison >= 0.25;
        if !is_trusted {
            let miss = if comparison.is_finite() { 1.0 - comparison } else { 1.0 };
            scale += curvature * miss / square;
        }
    }
    Reached { x, value, evaluations: used }
}

fn along(from: &[f64], direction: &[f64], length: f64) -> Vec<f64> {
    from.iter().zip(direction).map(|(x, d)| length.mul_add(*d, *x)).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
