//! A log density with its gradient, written for one state at a time: what the samplers ask of a user.
//!
//! Everything that implements [`GradLogDensity`] is a [`Density`] too, so that what is written for blocks of lanes is sampled by the same functions, eight states a call.

use crate::Error;
use sinew_core::density::{GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, LANES, get_lane};

/// A log density on ℝᵈ, up to a constant that does not depend on the state, and its gradient.
///
/// ```
/// use sinew_samplers::density::Density;
///
/// /// N(3, 2²).
/// struct Normal;
///
/// impl Density for Normal {
///     fn dim(&self) -> usize {
///         1
///     }
///     fn log_density(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
///         let z = (x[0] - 3.0) / 2.0;
///         gradient[0] = -z / 2.0;
///         -0.5 * z * z
///     }
/// }
/// ```
pub trait Density: Sync {
    /// Dimension d of the state.
    fn dim(&self) -> usize;

    /// Log density of a state of length d; its gradient is written to `gradient` (length d). −∞ is a state that cannot be, and NaN and +∞ count as such. The same state must give the same bits.
    fn log_density(&self, x: &[f64], gradient: &mut [f64]) -> f64;

    /// Names of the coordinates in summaries.
    fn names(&self) -> Vec<String> {
        (0..self.dim()).map(|j| format!("x[{j}]")).collect()
    }

    /// The density by blocks of eight states, where it is written so.
    fn by_blocks(&self) -> Option<&dyn GradLogDensity> {
        None
    }
}

impl<T: GradLogDensity> Density for T {
    fn dim(&self) -> usize {
        LogDensity::dim(self)
    }
    fn log_density(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        self.log_density_grad(x, gradient)
    }
    fn by_blocks(&self) -> Option<&dyn GradLogDensity> {
        Some(self)
    }
}

/// A density of single states by blocks. Only the first `lanes` states of a block are evaluated; the others repeat what the first one has.
pub(crate) struct OneByOne<'a> {
    pub(crate) density: &'a dyn Density,
    pub(crate) lanes: usize,
}

impl LogDensity for OneByOne<'_> {
    fn dim(&self) -> usize {
        self.density.dim()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut vec![0.0; x.len()])
    }
    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        self.log_density_grad_block(x, &mut vec![Block::ZERO; x.len()], ws)
    }
}

impl GradLogDensity for OneByOne<'_> {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let value = self.density.log_density(x, grad);
        if value < f64::INFINITY { value } else { f64::NEG_INFINITY }
    }
    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], _ws: &mut [Block]) -> Block {
        let mut scratch = vec![0.0; 2 * x.len()];
        let (state, gradient) = scratch.split_at_mut(x.len());
        let mut values = Block::ZERO;
        for lane in 0..self.lanes {
            get_lane(x, lane, state);
            values.0[lane] = self.log_density_grad(state, gradient);
            grad.iter_mut().zip(&*gradient).for_each(|(block, &g)| block.0[lane] = g);
        }
        for lane in self.lanes..LANES {
            values.0[lane] = values.0[0];
            grad.iter_mut().for_each(|block| block.0[lane] = block.0[0]);
        }
        values
    }
}

/// Compares every entry of a density's gradient at `x` with a difference of the density: (8 (f(x + h) − f(x − h)) − (f(x + 2h) − f(x − 2h))) / 12 h with h = 10⁻⁴ max(1, |x|).
///
/// An entry may be wrong by 10⁻⁴ of itself, by 10⁻⁷ of the largest one, and by what rounding leaves of the difference. Try several states, and none where the density has an edge.
///
/// # Errors
/// [`Error::Gradient`] for the worst entry; [`Error::Length`] for an `x` of another length; [`Error::BadStart`] where the density vanishes at `x`.
pub fn check_gradient(density: &dyn Density, x: &[f64]) -> Result<(), Error> {
    let d = density.dim();
    if x.len() != d {
        return Err(Error::Length { what: "the state", found: x.len(), expected: d });
    }
    let (mut gradient, mut unused) = (vec![0.0; d], vec![0.0; d]);
    let value = density.log_density(x, &mut gradient);
    if !value.is_finite() {
        return Err(Error::BadStart { lane: 0, value });
    }
    let largest = gradient.iter().fold(0.0, |a: f64, g| a.max(g.abs()));
    let mut worst = (1.0, Ok(()));
    for (coordinate, &found) in gradient.iter().enumerate() {
        let h = 1e-4 * x[coordinate].abs().max(1.0);
        let mut at = |step: f64| {
            let mut x = x.to_vec();
            x[coordinate] += step;
            density.log_density(&x, &mut unused)
        };
        let difference = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
        let allowed = 1e-4 * difference.abs() + 1e-7 * largest + 1e-14 * (1.0 + value.abs()) / h;
        let error = (found - difference).abs() / allowed;
        if error > worst.0 || (error.is_nan() && worst.1.is_ok()) {
            worst = (error, Err(Error::Gradient { coordinate, found, difference }));
        }
    }
    worst.1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// exp(−x⁴ / 4 − 10⁶ (y − 1)² / 2), with one entry of the gradient multiplied by `factor`.
    struct Quartic {
        factor: f64,
    }

    impl Density for Quartic {
        fn dim(&self) -> usize {
            2
        }
        fn log_density(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
            gradient[0] = -x[0].powi(3) * self.factor;
            gradient[1] = -1e6 * (x[1] - 1.0);
            if x[0] > 9.0 { f64::NAN } else { -x[0].powi(4) / 4.0 - 5e5 * (x[1] - 1.0).powi(2) }
        }
    }

    #[test]
    fn a_gradient_is_compared_with_differences() {
        for x in [[0.7, 1.0], [-3.0, 0.2], [1e-3, 1.0 + 1e-6]] {
            assert_eq!(check_gradient(&Quartic { factor: 1.0 }, &x), Ok(()), "{x:?}");
        }
        for factor in [1.01, -1.0, f64::NAN] {
            let refused = check_gradient(&Quartic { factor }, &[0.7, 1.0]);
            assert!(
                matches!(refused, Err(Error::Gradient { coordinate: 0, difference, .. }) if (difference + 0.343).abs() < 1e-6),
                "{refused:?}"
            );
        }
        let short = check_gradient(&Quartic { factor: 1.0 }, &[0.7]);
        assert_eq!(short, Err(Error::Length { what: "the state", found: 1, expected: 2 }));
        assert!(matches!(check_gradient(&Quartic { factor: 1.0 }, &[10.0, 1.0]), Err(Error::BadStart { .. })));
    }

    #[test]
    fn blocks_hold_the_states_one_by_one() {
        let density = &Quartic { factor: 1.0 };
        let x = [Block(std::array::from_fn(|lane| lane as f64 + 2.5)), Block::splat(1.5)];
        let mut grad = [Block::ZERO; 2];
        let all = OneByOne { density, lanes: LANES }.log_density_grad_block(&x, &mut grad, &mut []);
        assert_eq!((all.0[1], grad[0].0[1]), (-3.5_f64.powi(4) / 4.0 - 125_000.0, -3.5_f64.powi(3)));
        assert_eq!(all.0[7], f64::NEG_INFINITY, "NaN is a state that cannot be");
        let first = OneByOne { density, lanes: 1 }.log_density_grad_block(&x, &mut grad, &mut []);
        assert_eq!((first, grad[0]), (Block::splat(all.0[0]), Block::splat(-2.5_f64.powi(3))));
    }
}
