//! Gaussian with a dense covariance.
//!
//! As a prior between frames it is N(m, C + Σ) of all draws, instead of a mixture over the chains' last states.
//!
//! With C = L Lᵀ and W = L⁻¹ (both lower triangular), y = W (s − m): log p(s) = −½ |y|² − Σ log L_ii − d/2 log 2π, gradient −Wᵀ y. A draw is m + L z.

use crate::Error;
use crate::factor::{cholesky, inverse_lower};
use core::f64::consts::TAU;
use sinew_core::density::{LaneDensity, LaneGaussNewton};
use sinew_core::lanes::{Block, Isa, Kernel, Real, dispatch, triangle};
use sinew_core::random::BlockRng;
use sinew_core::transition::Moments;

/// Rows of W whose sums are held in registers together.
const ROWS: usize = 4;

/// The Gaussian.
#[derive(Clone, Debug)]
pub struct Gaussian {
    mean: Vec<f64>,
    lower: Vec<f64>,
    /// W in groups of [`ROWS`] rows; within a group column after column up to the last that is not zero.
    whitening: Vec<f64>,
    precision: Vec<f64>,
    precision_diagonal: Vec<f64>,
    log_norm: f64,
    jitter: f64,
}

impl Gaussian {
    /// N(m, C + Σ) of some moments and a diagonal Σ of standard deviations `sd`: where a random walk leads.
    ///
    /// # Errors
    /// As [`cholesky`].
    pub fn widened(moments: &Moments, sd: &[f64]) -> Result<Self, Error> {
        let mut covariance = moments.covariance.clone();
        for (j, sd) in sd.iter().enumerate() {
            covariance[j * (moments.mean.len() + 1)] += sd * sd;
        }
        Self::new(moments.mean.clone(), &covariance)
    }

    /// N(`mean`, `covariance`), the latter row after row.
    ///
    /// # Errors
    /// As [`cholesky`].
    pub fn new(mean: Vec<f64>, covariance: &[f64]) -> Result<Self, Error> {
        let d = mean.len();
        if d == 0 {
            return Err(Error::Shape { name: "mean", found: 0, expected: 1 });
        }
        if let Some(index) = mean.iter().position(|x| !x.is_finite()) {
            return Err(Error::OutOfRange { name: "mean", index, value: mean[index], expected: "must be finite" });
        }
        let factor = cholesky("covariance", covariance, d)?;
        let inverse = inverse_lower(&factor.lower, d);
        let mut whitening = Vec::with_capacity(d * (d + ROWS) / 2 + ROWS);
        for first in (0..d).step_by(ROWS) {
            for j in 0..(first + ROWS).min(d) {
                whitening.extend((first..first + ROWS).map(|i| if i < d { inverse[i * d + j] } else { 0.0 }));
            }
        }
        let mut precision = vec![0.0; d * d];
        for row in inverse.chunks_exact(d) {
            for (out, a) in precision.chunks_exact_mut(d).zip(row) {
                for (out, b) in out.iter_mut().zip(row) {
                    *out += a * b;
                }
            }
        }
        let precision_diagonal = (0..d).map(|j| precision[j * (d + 1)]).collect();
        let log_norm = -0.5 * d as f64 * TAU.ln() - (0..d).map(|i| factor.lower[i * d + i].ln()).sum::<f64>();
        Ok(Self {
            mean,
            lower: factor.lower,
            whitening,
            precision,
            precision_diagonal,
            log_norm,
            jitter: factor.jitter,
        })
    }

    /// The mean.
    #[must_use]
    pub fn mean(&self) -> &[f64] {
        &self.mean
    }

    /// Inverse covariance, row after row.
    #[must_use]
    pub fn precision(&self) -> &[f64] {
        &self.precision
    }

    /// Diagonal of the inverse covariance.
    #[must_use]
    pub fn precision_diagonal(&self) -> &[f64] {
        &self.precision_diagonal
    }

    /// What had to be added to the covariance's diagonal to factor it.
    #[must_use]
    pub fn jitter(&self) -> f64 {
        self.jitter
    }

    /// Draws eight independent states.
    pub fn sample_block(&self, isa: Isa, out: &mut [Block], rng: &mut BlockRng) {
        let mut noise = vec![Block::ZERO; self.mean.len()];
        rng.fill_normal(isa, &mut noise);
        dispatch(isa, Colour { mean: &self.mean, lower: &self.lower, noise: &noise, out });
    }
}

/// m + L z.
struct Colour<'a> {
    mean: &'a [f64],
    lower: &'a [f64],
    noise: &'a [Block],
    out: &'a mut [Block],
}

impl Kernel<Block> for Colour<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let d = self.mean.len();
        for i in 0..d {
            let mut sum = V::splat(self.mean[i]);
            for (z, &l) in self.noise[..=i].iter().zip(&self.lower[i * d..]) {
                sum = V::load(z).fma(V::splat(l), sum);
            }
            sum.store(&mut self.out[i]);
        }
    }
}

impl LaneDensity for Gaussian {
    fn dim(&self) -> usize {
        self.mean.len()
    }
    fn workspace(&self) -> usize {
        self.mean.len()
    }
    #[inline(always)]
    fn eval<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], ws: &mut [V::Mem]) -> V {
        let d = self.mean.len();
        let (x, mean, e) = (&x[..d], &self.mean[..d], &mut ws[..d]);
        for j in 0..d {
            (V::load(&x[j]) - V::splat(mean[j])).store(&mut e[j]);
        }
        if GRAD {
            for g in &mut grad[..d] {
                V::splat(0.0).store(g);
            }
        }
        let mut square = V::splat(0.0);
        let mut rest = &self.whitening[..];
        let mut first = 0;
        while first < d {
            let columns = if first + ROWS < d { first + ROWS } else { d };
            let (group, after) = rest.split_at(columns * ROWS);
            rest = after;
            let mut y = [V::splat(0.0); ROWS];
            for (e, w) in e.iter().zip(group.chunks_exact(ROWS)) {
                let e = V::load(e);
                let mut i = 0;
                while i < ROWS {
                    y[i] = e.fma(V::splat(w[i]), y[i]);
                    i += 1;
                }
            }
            let mut i = 0;
            while i < ROWS {
                square = y[i].fma(y[i], square);
                i += 1;
            }
            if GRAD {
                for (g, w) in grad.iter_mut().zip(group.chunks_exact(ROWS)) {
                    let mut sum = V::load(g);
                    let mut i = 0;
                    while i < ROWS {
                        sum = y[i].fnma(V::splat(w[i]), sum);
                        i += 1;
                    }
                    sum.store(g);
                }
            }
            first += ROWS;
        }
        let value = square.fma(V::splat(-0.5), V::splat(self.log_norm));
        value.select_gt(f64::MIN, value, V::splat(f64::NEG_INFINITY))
    }
}

impl LaneGaussNewton for Gaussian {
    #[inline(always)]
    fn gauss_newton_diagonal<V: Real>(&self, _x: &[V::Mem], diagonal: &mut [V::Mem], _ws: &mut [V::Mem]) {
        for (d, &precision) in diagonal.iter_mut().zip(&self.precision_diagonal) {
            V::splat(precision).store(d);
        }
    }

    #[inline(always)]
    fn gauss_newton<V: Real>(&self, _x: &[V::Mem], matrix: &mut [V::Mem], _ws: &mut [V::Mem]) {
        let d = self.mean.len();
        for i in 0..d {
            for j in 0..=i {
                V::splat(self.precision[i * d + j]).store(&mut matrix[triangle(i, j)]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::density::{GradLogDensity, Lanes, LogDensity};
    use sinew_core::random::Stage;

    fn covariance(d: usize) -> Vec<f64> {
        (0..d * d).map(|k| (-0.4 * (k as f64 / d as f64).floor().mul_add(1.0, -((k % d) as f64)).abs()).exp()).collect()
    }

    #[test]
    fn density_of_two_coordinates_is_the_closed_form() {
        let g = Gaussian::new(vec![1.0, -2.0], &[2.0, 0.6, 0.6, 1.0]).expect("valid");
        let density = Lanes { leaf: g, isa: Isa::best() };
        let det = 2.0 - 0.36;
        let (x, y) = (0.5_f64, 0.7_f64);
        let exact = -0.5 * (x * x - 1.2 * x * y + 2.0 * y * y) / det - TAU.ln() - 0.5 * det.ln();
        assert!((density.log_density(&[1.5, -1.3]) - exact).abs() < 1e-14);
        assert!((density.leaf.precision_diagonal()[0] - 1.0 / det).abs() < 1e-14);
    }

    #[test]
    fn gradient_matches_differences_and_blocks_match_single_states() {
        for d in [1, 3, 4, 5, 8, 11] {
            for isa in Isa::available() {
                let mean: Vec<f64> = (0..d).map(|j| j as f64 * 0.3).collect();
                let density = Lanes { leaf: Gaussian::new(mean, &covariance(d)).expect("valid"), isa };
                let x: Vec<f64> = (0..d).map(|j| (j as f64 * 1.7).sin()).collect();
                let mut grad = vec![0.0; d];
                let value = density.log_density_grad(&x, &mut grad);
                for j in 0..d {
                    let at = |h: f64| {
                        let mut x = x.clone();
                        x[j] += h;
                        density.log_density(&x)
                    };
                    assert!(((at(1e-5) - at(-1e-5)) / 2e-5 - grad[j]).abs() < 1e-8);
                }
                let block: Vec<Block> = x.iter().map(|&x| Block::splat(x)).collect();
                let mut grads = vec![Block::ZERO; d];
                let values = density.log_density_grad_block(&block, &mut grads, &mut vec![Block::ZERO; d]);
                assert!((values.0[2] - value).abs() < 1e-12 * value.abs().max(1.0));
                assert!((grads[d - 1].0[7] - grad[d - 1]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn draws_have_the_covariance() {
        let c = covariance(3);
        let g = Gaussian::new(vec![5.0, 0.0, -5.0], &c).expect("valid");
        let mut rng = Stage::new(6, "gaussian").whole();
        let (mut block, mut sums, n) = (vec![Block::ZERO; 3], [0.0; 9], 40_000.0);
        for _ in 0..5000 {
            g.sample_block(Isa::best(), &mut block, &mut rng);
            for (k, sum) in sums.iter_mut().enumerate() {
                let (i, j) = (k / 3, k % 3);
                *sum += (0..8).map(|l| (block[i].0[l] - g.mean[i]) * (block[j].0[l] - g.mean[j])).sum::<f64>() / n;
            }
        }
        for (k, (sum, exact)) in sums.iter().zip(&c).enumerate() {
            let z = (sum - exact) / ((1.0 + exact * exact) / n).sqrt();
            assert!(z.abs() < 4.5, "entry {k}: {sum} against {exact}, z = {z}");
        }
    }
}
