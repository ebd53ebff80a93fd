//! Equally weighted Gaussian mixture with one diagonal covariance: the prior between frames of Choo & Fleet (2001, eq. 9).
//!
//! log p(s) = −log M − Σ_j log(√(2π) σ_j) + logsumexp_i a_i, a_i = −½ Σ_j ((s_j − μ_ij) / σ_j)²; with responsibilities ρ_i = exp(a_i − logsumexp a) the gradient is
//! Σ⁻¹ (Σ_i ρ_i μ_i − s).
//!
//! With y = s − μ_1 and b_i = Σ⁻¹ (μ_i − μ_1) this is a_i = −½ y·Σ⁻¹y + y·b_i − ½ (μ_i − μ_1)·b_i and the gradient Σ_i ρ_i b_i − Σ⁻¹ y: one fused multiply-add a coordinate and component but the first, whose b
//! is zero, in each of two passes over one table. Sums are held in registers, for up to nine components at a time. No component is left out.

use crate::Error;
use core::f64::consts::TAU;
use sinew_core::density::LaneDensity;
use sinew_core::elementary::{exp, ln};
use sinew_core::lanes::Real;

/// Components whose sums are held in registers together.
const WIDEST: usize = 9;

/// The mixture.
#[derive(Clone, Debug)]
pub struct Mixture {
    means: Vec<Vec<f64>>,
    sd: Vec<f64>,
    precision: Vec<f64>,
    /// Number of components in each chunk of those after the first; chunk after chunk, `pulls` holds b_i with the components of one coordinate side by side.
    widths: Vec<usize>,
    pulls: Vec<f64>,
    /// −½ (μ_i − μ_1)·b_i.
    bias: Vec<f64>,
    log_norm: f64,
}

impl Mixture {
    /// A mixture of components at `means`, all with the standard deviations `sd`.
    ///
    /// # Errors
    /// [`Error::Shape`] or [`Error::OutOfRange`].
    pub fn new(means: Vec<Vec<f64>>, sd: &[f64]) -> Result<Self, Error> {
        let dim = sd.len();
        if dim == 0 || means.is_empty() {
            return Err(Error::Shape { name: "mixture", found: 0, expected: 1 });
        }
        for (index, &value) in sd.iter().enumerate() {
            if !(value > 0.0 && value.is_finite()) {
                let expected = "must be positive and finite";
                return Err(Error::OutOfRange { name: "standard deviation", index, value, expected });
            }
        }
        for mean in &means {
            if mean.len() != dim {
                return Err(Error::Shape { name: "mean", found: mean.len(), expected: dim });
            }
            if let Some(index) = mean.iter().position(|x| !x.is_finite()) {
                return Err(Error::OutOfRange { name: "mean", index, value: mean[index], expected: "must be finite" });
            }
        }
        let precision: Vec<f64> = sd.iter().map(|s| 1.0 / (s * s)).collect();
        let (first, others) = (&means[0], &means[1..]);
        let pull = |mean: &Vec<f64>, j: usize| (mean[j] - first[j]) * precision[j];
        let chunks = others.len().div_ceil(WIDEST).max(1);
        let widths: Vec<usize> =
            (0..chunks).map(|c| others.len() / chunks + usize::from(c < others.len() % chunks)).collect();
        let mut pulls = Vec::with_capacity(others.len() * dim);
        let mut rest = others;
        for &width in &widths {
            let (chunk, after) = rest.split_at(width);
            for j in 0..dim {
                pulls.extend(chunk.iter().map(|m| pull(m, j)));
            }
            rest = after;
        }
        let half_square = |m: &Vec<f64>| 0.5 * (0..dim).map(|j| pull(m, j) * (m[j] - first[j])).sum::<f64>();
        let bias = others.iter().map(|m| -half_square(m)).collect();
        Ok(Self {
            sd: sd.to_vec(),
            log_norm: -(means.len() as f64).ln() - sd.iter().map(|s| 0.5 * TAU.ln() + s.ln()).sum::<f64>(),
            precision,
            widths,
            pulls,
            bias,
            means,
        })
    }

    /// Means of the components.
    #[must_use]
    pub fn means(&self) -> &[Vec<f64>] {
        &self.means
    }

    /// Standard deviations of every component.
    #[must_use]
    pub fn sd(&self) -> &[f64] {
        &self.sd
    }

    /// Inverse variances: an upper bound of the mixture's curvature.
    #[must_use]
    pub fn precision(&self) -> &[f64] {
        &self.precision
    }
}

/// Writes a_i + ½ y·Σ⁻¹y of `N` components. Of the `FIRST` chunk it also returns y·Σ⁻¹y and, with `GRAD`, writes −Σ⁻¹ y.
#[inline(always)]
fn exponents<V: Real, const N: usize, const FIRST: bool, const GRAD: bool>(
    mixture: &Mixture,
    x: &[V::Mem],
    (pulls, bias): (&[f64], &[f64]),
    out: &mut [V::Mem],
    grad: &mut [V::Mem],
) -> V {
    let d = x.len();
    let (centre, precision) = (&mixture.means[0][..d], &mixture.precision[..d]);
    let pulls = if N > 0 { &pulls.as_chunks::<N>().0[..d] } else { &[] };
    let grad = if FIRST && GRAD { &mut grad[..d] } else { grad };
    let mut square = V::splat(0.0);
    let mut sum = [V::splat(0.0); N];
    for (sum, &bias) in sum.iter_mut().zip(bias) {
        *sum = V::splat(bias);
    }
    for j in 0..d {
        let y = V::load(&x[j]) - V::splat(centre[j]);
        if FIRST {
            let scaled = y * V::splat(precision[j]);
            square = y.fma(scaled, square);
            if GRAD {
                (-scaled).store(&mut grad[j]);
            }
        }
        if N > 0 {
            let b = &pulls[j];
            let mut i = 0;
            while i < N {
                sum[i] = y.fma(V::splat(b[i]), sum[i]);
                i += 1;
            }
        }
    }
    for (sum, out) in sum.iter().zip(out) {
        sum.store(out);
    }
    square
}

/// Adds Σ weight_i b_i of `N` components to `out`.
#[inline(always)]
fn add_pulls<V: Real, const N: usize>(weights: &[V::Mem], pulls: &[f64], out: &mut [V::Mem]) {
    if N == 0 {
        return;
    }
    let mut weight = [V::splat(0.0); N];
    for (w, m) in weight.iter_mut().zip(weights) {
        *w = V::load(m);
    }
    for (out, b) in out.iter_mut().zip(pulls.as_chunks::<N>().0) {
        let mut sum = V::load(out);
        let mut i = 0;
        while i < N {
            sum = weight[i].fma(V::splat(b[i]), sum);
            i += 1;
        }
        sum.store(out);
    }
}

/// Calls a function of a width in 0..=9 with the width, and what else is given in brackets, as constants.
macro_rules! by_width {
    ($width:expr, $function:ident$([$($constant:tt),*])?, $($argument:expr),*) => {
        match $width {
            0 => $function::<V, 0, $($($constant),*)?>($($argument),*),
            1 => $function::<V, 1, $($($constant),*)?>($($argument),*),
            2 => $function::<V, 2, $($($constant),*)?>($($argument),*),
            3 => $function::<V, 3, $($($constant),*)?>($($argument),*),
            4 => $function::<V, 4, $($($constant),*)?>($($argument),*),
            5 => $function::<V, 5, $($($constant),*)?>($($argument),*),
            6 => $function::<V, 6, $($($constant),*)?>($($argument),*),
            7 => $function::<V, 7, $($($constant),*)?>($($argument),*),
            8 => $function::<V, 8, $($($constant),*)?>($($argument),*),
            _ => $function::<V, 9, $($($constant),*)?>($($argument),*),
        }
    };
}

impl LaneDensity for Mixture {
    fn dim(&self) -> usize {
        self.sd.len()
    }
    fn workspace(&self) -> usize {
        self.bias.len()
    }
    #[inline(always)]
    fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], ws: &mut [V::Mem]) -> V {
        let d = self.sd.len();
        let (x, a) = (&x[..d], &mut ws[..self.bias.len()]);
        let mut square = V::splat(0.0);
        let mut done = 0;
        for &width in &self.widths {
            let range = done..done + width;
            let table = (&self.pulls[done * d..(done + width) * d], &self.bias[range.clone()]);
            if done == 0 {
                square = by_width!(width, exponents[true, GRAD], self, x, table, &mut a[range], grad);
            } else {
                by_width!(width, exponents[false, GRAD], self, x, table, &mut a[range], grad);
            }
            done += width;
        }
        let mut max = V::splat(0.0);
        for a in a.iter() {
            max = max.max(V::load(a));
        }
        let mut sum = exp(-max);
        for a in a.iter_mut() {
            let weight = exp(V::load(a) - max);
            sum = sum + weight;
            weight.store(a);
        }
        let log_density = square.fma(V::splat(-0.5), max + ln(sum)) + V::splat(self.log_norm);
        if GRAD {
            let share = V::splat(1.0) / sum;
            for a in a.iter_mut() {
                (V::load(a) * share).store(a);
            }
            let mut done = 0;
            for &width in &self.widths {
                let pulls = &self.pulls[done * d..(done + width) * d];
                by_width!(width, add_pulls, &a[done..done + width], pulls, grad);
                done += width;
            }
        }
        // Far beyond every component the squares overflow.
        log_density.select_gt(f64::MIN, log_density, V::splat(f64::NEG_INFINITY))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::density::{GradLogDensity, Lanes, LogDensity};
    use sinew_core::lanes::{Block, Isa};

    /// Deterministic numbers in (−1, 1).
    fn number(seed: usize) -> f64 {
        ((seed as f64 * 12.9898).sin() * 43758.5453).fract()
    }

    fn mixture(count: usize, dim: usize) -> Mixture {
        let means = (0..count).map(|i| (0..dim).map(|j| number(i * 31 + j)).collect()).collect();
        let sd: Vec<f64> = (0..dim).map(|j| 0.3 + 0.2 * number(j + 999).abs()).collect();
        Mixture::new(means, &sd).expect("valid")
    }

    fn literal(m: &Mixture, x: &[f64]) -> f64 {
        let a: Vec<f64> = (m.means.iter())
            .map(|mean| {
                let terms = x.iter().zip(mean).zip(&m.sd);
                terms.map(|((x, m), s)| -0.5 * ((x - m) / s).powi(2) - (TAU.sqrt() * s).ln()).sum()
            })
            .collect();
        let max = a.iter().copied().fold(f64::MIN, f64::max);
        max + a.iter().map(|a| (a - max).exp()).sum::<f64>().ln() - (a.len() as f64).ln()
    }

    #[test]
    fn value_and_gradient_match_the_formula_written_out() {
        for count in (1..=10).chain([16, 23, 64]) {
            for isa in Isa::available() {
                let density = Lanes { leaf: mixture(count, 5), isa };
                let x: Vec<f64> = (0..5).map(|j| 1.2 * number(j + 77 * count)).collect();
                let mut grad = vec![0.0; 5];
                let value = density.log_density_grad(&x, &mut grad);
                assert!((value - literal(&density.leaf, &x)).abs() < 1e-12 * value.abs().max(1.0));
                assert_eq!(value, density.log_density(&x));
                for j in 0..5 {
                    let at = |h: f64| {
                        let mut x = x.clone();
                        x[j] += h;
                        literal(&density.leaf, &x)
                    };
                    let numeric = (at(1e-5) - at(-1e-5)) / 2e-5;
                    assert!((numeric - grad[j]).abs() < 1e-7, "{count}: {numeric} against {}", grad[j]);
                }
                let block: Vec<Block> = x.iter().map(|&x| Block::splat(x)).collect();
                let mut ws = vec![Block::ZERO; density.workspace()];
                let mut grad_block = vec![Block::ZERO; 5];
                let values = density.log_density_grad_block(&block, &mut grad_block, &mut ws);
                assert!((values.0[6] - value).abs() <= 1e-12 * value.abs().max(1.0));
                assert!((grad_block[3].0[1] - grad[3]).abs() < 1e-12);
            }
        }
    }

    /// A mixture of equal components against one Gaussian (K7).
    #[test]
    fn equal_components_are_one_gaussian_and_a_far_one_has_no_effect() {
        let isa = Isa::best();
        let sd = [0.015, 0.15, 0.3];
        let one = Lanes { leaf: Mixture::new(vec![vec![0.1, -0.7, 1e3]], &sd).expect("valid"), isa };
        let equal = Lanes { leaf: Mixture::new(vec![vec![0.1, -0.7, 1e3]; 7], &sd).expect("valid"), isa };
        let far =
            Lanes { leaf: Mixture::new(vec![vec![0.1, -0.7, 1e3], vec![3.0, 9.0, 1e3]], &sd).expect("valid"), isa };
        let x = [0.11, -0.9, 1000.2];
        let (mut a, mut b, mut c) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        let alone = one.log_density_grad(&x, &mut a);
        assert!((equal.log_density_grad(&x, &mut b) - alone).abs() < 1e-12 * alone.abs().max(1.0));
        let with_far = far.log_density_grad(&x, &mut c) + 2.0_f64.ln();
        // The far component is 190 standard deviations away: the expansion about the centre rounds at 1e-16 · 190².
        assert!((with_far - alone).abs() < 1e-11, "{with_far} against {alone}");
        for j in 0..3 {
            assert!((a[j] - b[j]).abs() < 1e-12 * a[j].abs() && (a[j] - c[j]).abs() < 1e-11 * a[j].abs().max(1.0));
        }
    }

    #[test]
    fn extreme_states_are_minus_infinity_and_bad_input_is_refused() {
        let density = Lanes { leaf: mixture(10, 4), isa: Isa::best() };
        assert_eq!(density.log_density(&[1e200, 0.0, 0.0, 0.0]), f64::NEG_INFINITY);
        assert!(density.log_density(&[1e9, -1e9, 0.0, 0.0]).is_finite());
        assert!(Mixture::new(vec![], &[1.0]).is_err() && Mixture::new(vec![vec![0.0]], &[]).is_err());
        assert!(Mixture::new(vec![vec![0.0]], &[0.0]).is_err() && Mixture::new(vec![vec![0.0]], &[f64::NAN]).is_err());
        assert!(Mixture::new(vec![vec![f64::NAN]], &[1.0]).is_err() && Mixture::new(vec![vec![]], &[1.0]).is_err());
    }
}
