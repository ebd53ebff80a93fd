//! Problems of unconstrained minimisation with their standard starts and published minima.
//!
//! Moré, Garbow & Hillstrom, *Testing unconstrained optimization software*, ACM Transactions on Mathematical Software 7 (1981), 17–41; the numbers in the names are the paper's. Each problem is a sum of squares
//!
//! ```text
//! f(x) = Σᵢ rᵢ(x)²,   ∇f(x) = 2 Σᵢ rᵢ(x) ∇rᵢ(x).
//! ```

mod any_dimension;
mod fixed_dimension;
pub mod reached_by_scipy;

use sinew_core::lbfgs::Objective;

/// Gives residual i (from 0) at x and writes its gradient to the row, which holds zeros before.
pub type Residual = fn(usize, &[f64], &mut [f64]) -> f64;

/// A sum of squares with what is published about it.
pub struct Problem {
    /// Number in the paper, name and dimension.
    pub name: String,
    /// Standard start.
    pub start: Vec<f64>,
    /// The least value, to six published digits.
    pub minimum: f64,
    terms: usize,
    residual: Residual,
}

impl Problem {
    fn new(name: &str, start: &[f64], terms: usize, residual: Residual, minimum: f64) -> Self {
        Self { name: format!("{name}, n = {}", start.len()), start: start.to_vec(), minimum, terms, residual }
    }
}

impl Objective for &Problem {
    fn evaluate(&mut self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let (mut value, mut row) = (0.0, vec![0.0; x.len()]);
        gradient.fill(0.0);
        for i in 0..self.terms {
            row.fill(0.0);
            let residual = (self.residual)(i, x, &mut row);
            value += residual * residual;
            gradient.iter_mut().zip(&row).for_each(|(g, d)| *g += 2.0 * residual * d);
        }
        value
    }
}

/// All problems, in the order of the paper.
pub fn all() -> Vec<Problem> {
    let mut problems = fixed_dimension::problems();
    problems.extend(any_dimension::problems());
    problems
}
