//! A mixture of Gaussians with full covariances, fitted to draws as a proposal for [`crate::jumps`].
//!
//! The fit is by expectation and maximisation (Dempster, Laird & Rubin 1977):
//!
//! 1. Every component starts at a draw, the draws taken at equal distances, with the covariance of all.
//! 2. r_ic = share of component c in the density of draw i;
//! 3. w_c = mean of r_ic, m_c and C_c the moments of the draws weighted by r_ic, with d pseudo-draws of the covariance of all. Then 2 again, 30 times.
//!
//! Densities and draws are computed in lanes. There is no randomness in a fit.

use crate::Error;
use crate::moments::moments;
use crate::triangular::dot;
use faer::{MatRef, Side};
use sinew_core::elementary::{exp, ln};
use sinew_core::lanes::{Block, Isa, Kernel, LANES, Real, dispatch, triangle};
use sinew_core::random::BlockRng;

const ROUNDS: usize = 30;

/// N(m, L Lᵀ) with a weight.
#[derive(Clone, Debug, PartialEq)]
struct Component {
    weight: f64,
    mean: Vec<f64>,
    /// L and L⁻¹, lower triangles row after row.
    factor: Vec<f64>,
    inverse: Vec<f64>,
    /// log w − log |L| − d/2 log 2π.
    log_scale: f64,
}

impl Component {
    fn new(weight: f64, mean: Vec<f64>, covariance: &[f64]) -> Result<Self, Error> {
        let d = mean.len();
        if !(weight > 0.0 && covariance.iter().chain(&mean).all(|x| x.is_finite())) {
            return Err(Error::Metric);
        }
        let llt = MatRef::from_row_major_slice(covariance, d, d).llt(Side::Lower).map_err(|_| Error::Metric)?;
        let mut inverse = faer::Mat::<f64>::identity(d, d);
        llt.L().solve_lower_triangular_in_place(inverse.as_mut());
        let packed = |entry: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
            (0..d).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| entry(i, j)).collect()
        };
        let factor = packed(&|i, j| llt.L()[(i, j)]);
        let log_det: f64 = (0..d).map(|i| factor[triangle(i, i)].ln()).sum();
        let log_scale = weight.ln() - log_det - 0.5 * d as f64 * std::f64::consts::TAU.ln();
        Ok(Self { weight, mean, factor, inverse: packed(&|i, j| inverse[(i, j)]), log_scale })
    }
}

/// A fitted mixture.
#[derive(Clone, Debug, PartialEq)]
pub struct GaussianMixture {
    components: Vec<Component>,
    isa: Isa,
}

/// Scratch: d blocks, and one for every component.
#[derive(Clone, Debug)]
pub struct Scratch {
    state: Vec<Block>,
    components: Vec<Block>,
}

/// Rows of a packed lower triangle.
#[inline(always)]
fn rows(triangle: &[f64], d: usize) -> impl Iterator<Item = &[f64]> {
    let mut rest = triangle;
    (1..=d).map(move |length| {
        let (row, after) = rest.split_at(length);
        rest = after;
        row
    })
}

struct LogDensity<'a> {
    components: &'a [Component],
    x: &'a [Block],
    centred: &'a mut [Block],
    log_densities: &'a mut [Block],
    sum: &'a mut Block,
}

impl Kernel<Block> for LogDensity<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let d = self.x.len();
        let mut largest = V::splat(f64::MIN);
        for (component, out) in self.components.iter().zip(&mut *self.log_densities) {
            for ((y, x), &m) in self.centred.iter_mut().zip(self.x).zip(&component.mean) {
                (V::load(x) - V::splat(m)).store(y);
            }
            let mut square = V::splat(0.0);
            for row in rows(&component.inverse, d) {
                let u: V = dot(row, self.centred);
                square = u.fma(u, square);
            }
            let log_density = square.fma(V::splat(-0.5), V::splat(component.log_scale));
            log_density.store(out);
            largest = largest.max(log_density);
        }
        let mut sum = V::splat(0.0);
        for log_density in &*self.log_densities {
            sum = sum + exp(V::load(log_density) - largest);
        }
        (largest + ln(sum)).store(self.sum);
    }
}

struct Draw<'a> {
    components: &'a [Component],
    which: &'a Block,
    noise: &'a [Block],
    x: &'a mut [Block],
}

impl Kernel<Block> for Draw<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let d = self.x.len();
        let which = V::load(self.which);
        for (c, component) in self.components.iter().enumerate() {
            for ((x, row), &m) in self.x.iter_mut().zip(rows(&component.factor, d)).zip(&component.mean) {
                let drawn: V = dot::<V>(row, self.noise) + V::splat(m);
                which.select_gt(c as f64 - 0.5, drawn, V::load(x)).store(x);
            }
        }
    }
}

impl GaussianMixture {
    /// The mixture of `components` that fits the draws in `states` (whole blocks of `dim`, every lane a draw), which together are worth `effective` independent ones.
    ///
    /// # Errors
    /// [`Error::Empty`] without draws, [`Error::OutOfRange`] without components or with fewer effective draws than components, [`Error::Metric`] where a coordinate of the draws does not vary or is not finite.
    pub fn fit(isa: Isa, states: &[Block], dim: usize, components: usize, effective: f64) -> Result<Self, Error> {
        let blocks = states.len() / dim.max(1);
        let count = blocks * LANES;
        if count == 0 {
            return Err(Error::Empty { count, dim });
        }
        if effective.is_nan() || effective < components as f64 {
            let expected = "must be at least the number of components";
            return Err(Error::OutOfRange { name: "effective number of draws", value: effective, expected });
        }
        if components == 0 {
            let (name, value) = ("number of components", 0.0);
            return Err(Error::OutOfRange { name, value, expected: "must be at least 1" });
        }
        let whole = moments(isa, states, dim, &vec![1.0 / count as f64; count], effective);
        let share = 1.0 / components as f64;
        let start = |c: usize| -> Vec<f64> {
            let draw = (2 * c + 1) * count / (2 * components);
            if components == 1 {
                return whole.mean.clone();
            }
            states[draw / LANES * dim..][..dim].iter().map(|b| b.0[draw % LANES]).collect()
        };
        let started = (0..components).map(|c| Component::new(share, start(c), &whole.covariance));
        let mut mixture = Self { components: started.collect::<Result<_, _>>()?, isa };
        let mut shares = vec![vec![0.0; count]; components];
        let scratch = &mut mixture.scratch();
        for _ in 0..ROUNDS {
            mixture.share(states, &mut shares, scratch);
            let mut next = Vec::with_capacity(components);
            for shares in &mut shares {
                let sum: f64 = shares.iter().sum();
                let draws = sum / count as f64 * effective;
                // A component that has lost its draws is dropped.
                if draws < 0.5 {
                    continue;
                }
                shares.iter_mut().for_each(|r| *r /= sum);
                let own = moments(isa, states, dim, shares, f64::INFINITY);
                let pseudo = dim as f64;
                let blend = |(own, all): (&f64, &f64)| (draws * own + pseudo * all) / (draws + pseudo);
                let covariance: Vec<f64> = own.covariance.iter().zip(&whole.covariance).map(blend).collect();
                next.push(Component::new(sum / count as f64, own.mean, &covariance)?);
            }
            let total: f64 = next.iter().map(|c| c.weight).sum();
            for component in &mut next {
                component.weight /= total;
                component.log_scale -= total.ln();
            }
            shares.truncate(next.len());
            scratch.components.truncate(next.len());
            mixture.components = next;
        }
        Ok(mixture)
    }

    /// Shares r_ic of the components in the density of each draw: one series a component.
    fn share(&self, states: &[Block], shares: &mut [Vec<f64>], scratch: &mut Scratch) {
        for (block, state) in states.chunks_exact(scratch.state.len()).enumerate() {
            let density = self.log_density_block(state, scratch);
            for (shares, component) in shares.iter_mut().zip(&scratch.components) {
                for lane in 0..LANES {
                    shares[block * LANES + lane] = (component.0[lane] - density.0[lane]).exp();
                }
            }
        }
    }

    /// Scratch of the other methods.
    #[must_use]
    pub fn scratch(&self) -> Scratch {
        let d = self.components.first().map_or(0, |c| c.mean.len());
        Scratch { state: vec![Block::ZERO; d], components: vec![Block::ZERO; self.components.len()] }
    }

    /// Log densities of a block of states.
    pub fn log_density_block(&self, x: &[Block], scratch: &mut Scratch) -> Block {
        let mut log_density = Block::ZERO;
        let (components, centred) = (&self.components[..], &mut scratch.state[..]);
        let (log_densities, sum) = (&mut scratch.components[..], &mut log_density);
        dispatch(self.isa, LogDensity { components, x, centred, log_densities, sum });
        log_density
    }

    /// Draws a block of states.
    pub fn sample_block(&self, x: &mut [Block], scratch: &mut Scratch, rng: &mut BlockRng) {
        let mut which = Block::ZERO;
        rng.fill_uniform(std::slice::from_mut(&mut which));
        for u in &mut which.0 {
            let mut left = *u;
            let passed = self.components.iter().take_while(|c| {
                left -= c.weight;
                left > 0.0
            });
            *u = passed.count().min(self.components.len() - 1) as f64;
        }
        rng.fill_normal(self.isa, &mut scratch.state);
        dispatch(self.isa, Draw { components: &self.components, which: &which, noise: &scratch.state, x });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::random::Stage;

    /// Two clusters in the plane, a third and two thirds: N((−3, 0), I) and N((3, 1), [1 0.8; 0.8 1]).
    fn clusters(count: usize) -> Vec<Block> {
        let mut rng = Stage::new(2, "clusters").whole();
        let mut states = vec![Block::ZERO; count / LANES * 2];
        rng.fill_normal(Isa::best(), &mut states);
        for (i, state) in states.chunks_exact_mut(2).enumerate() {
            for lane in 0..LANES {
                let (a, b) = (state[0].0[lane], state[1].0[lane]);
                (state[0].0[lane], state[1].0[lane]) = if (i * LANES + lane).is_multiple_of(3) {
                    (a - 3.0, b)
                } else {
                    (a + 3.0, 1.0 + 0.8 * a + 0.6 * b)
                };
            }
        }
        states
    }

    #[test]
    fn clusters_are_found_and_drawn_again() {
        let count = 24_000;
        let states = clusters(count);
        let mixture = GaussianMixture::fit(Isa::best(), &states, 2, 2, count as f64).expect("two clusters");
        let mut found: Vec<_> = mixture.components.iter().map(|c| (c.mean[0], c.mean[1], c.weight)).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (found, expected) in found.iter().zip([(-3.0, 0.0, 1.0 / 3.0), (3.0, 1.0, 2.0 / 3.0)]) {
            let off = (found.0 - expected.0).abs().max((found.1 - expected.1).abs());
            assert!(off < 0.06 && (found.2 - expected.2).abs() < 0.01, "{found:?}");
        }
        let scratch = &mut mixture.scratch();
        let mut rng = Stage::new(3, "draw").whole();
        let (mut drawn, mut x) = (Vec::new(), vec![Block::ZERO; 2]);
        for _ in 0..count / LANES {
            mixture.sample_block(&mut x, scratch, &mut rng);
            drawn.extend_from_slice(&x);
        }
        let weights = vec![1.0 / count as f64; count];
        let [old, new] = [&states, &drawn].map(|s| moments(Isa::best(), s, 2, &weights, count as f64));
        for k in 0..2 {
            let z = (old.mean[k] - new.mean[k]) / (2.0 * old.covariance[3 * k] / count as f64).sqrt();
            assert!(z.abs() < 4.5, "mean {k}: z = {z}, bound 4.5");
        }
        for k in 0..4 {
            assert!((old.covariance[k] - new.covariance[k]).abs() < 0.3, "{:?} {:?}", old, new);
        }
    }

    #[test]
    fn the_density_is_the_sum_over_components_and_integrates_to_one() {
        for isa in Isa::available() {
            let mixture = GaussianMixture::fit(isa, &clusters(800), 2, 3, 800.0).expect("fits");
            let scratch = &mut mixture.scratch();
            let (mut sum, step) = (0.0, 0.1);
            for i in -80..80 {
                for block in -10..10 {
                    let y = Block(std::array::from_fn(|lane| f64::from(8 * block + lane as i32) * step));
                    let density = mixture.log_density_block(&[Block::splat(f64::from(i) * step), y], scratch);
                    sum += density.0.iter().map(|l| l.exp()).sum::<f64>() * step * step;
                }
            }
            assert!((sum - 1.0).abs() < 1e-3, "{sum} on {}", isa.name());
        }
    }

    #[test]
    fn what_cannot_be_fitted_is_refused() {
        let isa = Isa::best();
        assert!(matches!(GaussianMixture::fit(isa, &[], 2, 1, 1.0), Err(Error::Empty { count: 0, dim: 2 })));
        let states = clusters(80);
        assert!(matches!(GaussianMixture::fit(isa, &states, 2, 0, 80.0), Err(Error::OutOfRange { .. })));
        for effective in [f64::NAN, 0.0, 1.9] {
            assert!(matches!(GaussianMixture::fit(isa, &states, 2, 2, effective), Err(Error::OutOfRange { .. })));
        }
        assert!(GaussianMixture::fit(isa, &states, 2, 2, 2.0).is_ok_and(|mixture| !mixture.components.is_empty()));
        assert_eq!(GaussianMixture::fit(isa, &[Block::ZERO; 4], 2, 1, 16.0), Err(Error::Metric));
    }
}
