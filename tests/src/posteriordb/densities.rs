//! Log densities of posteriordb's models on unconstrained states, up to a constant, with their gradients.

use sinew::dynamics::factor::{cholesky, inverse_lower};

/// −½ Σ t_j² − ½ Σ ((y_j − μ − τ t_j) / s_j)² − μ² / 50 − ln(1 + τ² / 25) + ln τ.
pub(super) fn eight_schools(y: &[f64], sigma: &[f64], u: &[f64], grad: &mut [f64]) -> f64 {
    let (mu, tau) = (u[8], u[9].exp());
    let mut value = -mu * mu / 50.0 - (tau * tau / 25.0).ln_1p() + u[9];
    (grad[8], grad[9]) = (-mu / 25.0, 1.0 - 2.0 * tau * tau / (25.0 + tau * tau));
    for j in 0..8 {
        let error = (y[j] - mu - tau * u[j]) / sigma[j];
        value -= 0.5 * (u[j] * u[j] + error * error);
        let pull = error / sigma[j];
        grad[j] = tau * pull - u[j];
        grad[8] += pull;
        grad[9] += tau * u[j] * pull;
    }
    value
}

/// −β·β / 200 − σ² / 200 − |y − X β|² / (2 σ²) − N ln σ + ln σ.
pub(super) fn regression(y: &[f64], x: &[Vec<f64>], u: &[f64], grad: &mut [f64]) -> f64 {
    let (beta, log_sigma) = (&u[..5], u[5]);
    let variance = (2.0 * log_sigma).exp();
    let (mut value, mut square) = (0.0, 0.0);
    for (g, b) in grad.iter_mut().zip(beta) {
        *g = -b / 100.0;
        value -= b * b / 200.0;
    }
    for (y, row) in y.iter().zip(x) {
        let error = y - row.iter().zip(beta).map(|(x, b)| x * b).sum::<f64>();
        square += error * error;
        for (g, x) in grad.iter_mut().zip(row) {
            *g += error * x / variance;
        }
    }
    let n = y.len() as f64;
    grad[5] = -variance / 100.0 + square / variance - n + 1.0;
    value - variance / 200.0 - 0.5 * square / variance + (1.0 - n) * log_sigma
}

/// −½ yᵀ K⁻¹ y − ½ ln det K + 24 ln ρ − 4 ρ − α² / 8 − σ² / 2 + Σ u, with K_ij = α² exp(−(x_i − x_j)² / 2 ρ²) + σ [i = j].
pub(super) fn gaussian_process(y: &[f64], x: &[f64], u: &[f64], grad: &mut [f64]) -> f64 {
    let [rho, alpha, sigma] = [u[0].exp(), u[1].exp(), u[2].exp()];
    let n = x.len();
    let distance = |e: usize| ((x[e / n] - x[e % n]) / rho).powi(2);
    let signal: Vec<f64> = (0..n * n).map(|e| alpha * alpha * (-0.5 * distance(e)).exp()).collect();
    let mut k = signal.clone();
    (0..n).for_each(|i| k[i * (n + 1)] += sigma);
    let Ok(factor) = cholesky("K", &k, n) else { return f64::NEG_INFINITY };
    if factor.jitter > 0.0 {
        return f64::NEG_INFINITY;
    }
    let whitening = inverse_lower(&factor.lower, n);
    let inverse: Vec<f64> =
        (0..n * n).map(|e| (0..n).map(|l| whitening[l * n + e / n] * whitening[l * n + e % n]).sum()).collect();
    let weights: Vec<f64> = inverse.chunks(n).map(|row| row.iter().zip(y).map(|(a, y)| a * y).sum()).collect();
    // ½ wᵀ D w − ½ tr(K⁻¹ D) for a derivative D of K.
    let by = |derivative: &dyn Fn(usize) -> f64| -> f64 {
        (0..n * n).map(|e| 0.5 * (weights[e / n] * weights[e % n] - inverse[e]) * derivative(e)).sum()
    };
    grad[0] = by(&|e| signal[e] * distance(e)) + 24.0 - 4.0 * rho + 1.0;
    grad[1] = by(&|e| 2.0 * signal[e]) - 0.25 * alpha * alpha + 1.0;
    grad[2] = by(&|e| if e / n == e % n { sigma } else { 0.0 }) - sigma * sigma + 1.0;
    let log_det: f64 = (0..n).map(|i| 2.0 * factor.lower[i * (n + 1)].ln()).sum();
    let fit: f64 = weights.iter().zip(y).map(|(w, y)| w * y).sum();
    -0.5 * fit - 0.5 * log_det + 24.0 * u[0] - 4.0 * rho - alpha * alpha / 8.0 - 0.5 * sigma * sigma
        + u.iter().sum::<f64>()
}

/// −μ² / 200 − φ² / 8 − θ² / 8 − ln(1 + σ² / 2.5²) − Σ e_t² / (2 σ²) + (1 − T) ln σ, with e_1 = y_1 − μ − φ μ and e_t = y_t − μ − φ y_{t−1} − θ e_{t−1}.
pub(super) fn moving_average(y: &[f64], u: &[f64], grad: &mut [f64]) -> f64 {
    let [mu, phi, theta, log_sigma] = [u[0], u[1], u[2], u[3]];
    let variance = (2.0 * log_sigma).exp();
    let mut error = y[0] - mu - phi * mu;
    let mut slopes = [-1.0 - phi, -mu, 0.0];
    let (mut square, mut sums) = (error * error, slopes.map(|slope| error * slope));
    for pair in y.windows(2) {
        slopes = [-1.0 - theta * slopes[0], -pair[0] - theta * slopes[1], -error - theta * slopes[2]];
        error = pair[1] - mu - phi * pair[0] - theta * error;
        square += error * error;
        sums.iter_mut().zip(slopes).for_each(|(sum, slope)| *sum += error * slope);
    }
    for ((g, sum), (x, width)) in grad.iter_mut().zip(sums).zip([(mu, 100.0), (phi, 4.0), (theta, 4.0)]) {
        *g = -x / width - sum / variance;
    }
    let count = y.len() as f64;
    let scaled = variance / 6.25;
    grad[3] = -2.0 * scaled / (1.0 + scaled) + square / variance - count + 1.0;
    -mu * mu / 200.0 - phi * phi / 8.0 - theta * theta / 8.0 - scaled.ln_1p() - 0.5 * square / variance
        + (1.0 - count) * log_sigma
}

/// A latent Gaussian process at its places.
pub(super) struct Latent {
    /// ((x_i − x_j) / ρ)².
    distances: Vec<f64>,
    /// α² exp(−½ distance).
    signal: Vec<f64>,
    /// Cholesky factor L of the signal + 10⁻¹⁰ [i = j].
    lower: Vec<f64>,
    /// Function values f = L f̃.
    pub(super) f: Vec<f64>,
}

impl Latent {
    /// The process at u = (ln ρ, ln α, f̃); none where its covariance has no factor.
    pub(super) fn new(x: &[f64], u: &[f64]) -> Option<Self> {
        let n = x.len();
        let [rho, variance] = [u[0].exp(), (2.0 * u[1]).exp()];
        let distances: Vec<f64> = (0..n * n).map(|e| ((x[e / n] - x[e % n]) / rho).powi(2)).collect();
        let signal: Vec<f64> = distances.iter().map(|distance| variance * (-0.5 * distance).exp()).collect();
        let mut k = signal.clone();
        (0..n).for_each(|i| k[i * (n + 1)] += 1e-10);
        let lower = cholesky("K", &k, n).ok().filter(|factor| factor.jitter == 0.0)?.lower;
        let f = lower.chunks(n).map(|row| row.iter().zip(&u[2..]).map(|(l, f)| l * f).sum()).collect();
        Some(Self { distances, signal, lower, f })
    }

    /// back · Φ(L⁻¹ D L⁻ᵀ) f̃ for the change D = signal · `weight` of the squared distance: Φ takes the lower triangle with half the diagonal, and the derivative of L along D is L Φ(L⁻¹ D L⁻ᵀ).
    fn along(&self, weight: impl Fn(f64) -> f64, inverse: &[f64], back: &[f64], white: &[f64]) -> f64 {
        let n = back.len();
        let change: Vec<f64> = self.signal.iter().zip(&self.distances).map(|(s, d)| s * weight(*d)).collect();
        let mut sum = 0.0;
        let mut left = vec![0.0; n];
        for i in 0..n {
            left.fill(0.0);
            for (entry, row) in inverse[i * n..][..=i].iter().zip(change.chunks(n)) {
                left.iter_mut().zip(row).for_each(|(left, change)| *left += entry * change);
            }
            for j in 0..=i {
                let entry: f64 = left.iter().zip(&inverse[j * n..][..=j]).map(|(a, b)| a * b).sum();
                sum += if i == j { 0.5 } else { 1.0 } * back[i] * entry * white[j];
            }
        }
        sum
    }
}

/// Σ (k_i f_i − exp f_i) − ½ f̃·f̃ + 25 ln ρ − 4 ρ − α² / 8 + ln α, with f of [`Latent`].
pub(super) fn poisson_process(counts: &[f64], x: &[f64], u: &[f64], grad: &mut [f64]) -> f64 {
    let n = x.len();
    let [rho, alpha] = [u[0].exp(), u[1].exp()];
    let Some(latent) = Latent::new(x, u) else { return f64::NEG_INFINITY };
    let (f, white) = (&latent.f, &u[2..]);
    let pull: Vec<f64> = counts.iter().zip(f).map(|(k, f)| k - f.exp()).collect();
    let back: Vec<f64> = (0..n).map(|j| (j..n).map(|i| latent.lower[i * n + j] * pull[i]).sum()).collect();
    grad[2..].iter_mut().zip(&back).zip(white).for_each(|((g, b), w)| *g = b - w);
    let inverse = inverse_lower(&latent.lower, n);
    grad[0] = latent.along(|distance| distance, &inverse, &back, white) + 25.0 - 4.0 * rho;
    grad[1] = latent.along(|_| 2.0, &inverse, &back, white) - 0.25 * alpha * alpha + 1.0;
    let likelihood: f64 = counts.iter().zip(f).map(|(k, f)| k * f - f.exp()).sum();
    likelihood - 0.5 * white.iter().map(|w| w * w).sum::<f64>() + 25.0 * u[0] - 4.0 * rho - alpha * alpha / 8.0 + u[1]
}
