//! A Gaussian mixture over rows: missing columns have its mean given the others.
//!
//! Columns are standardised. With m and S of component k split into those that are there (o) and those that are missing (m),
//!
//! ```text
//! E[y_m | y_o] = Σ_k r_k (m_m + S_mo S_oo⁻¹ (y_o − m_o)),   r_k ∝ π_k N(y_o; m_o, S_oo)
//! ```

use super::task::{COLUMNS, Outcome, Row, Task};
use sinew::core::random::Stage;
use sinew::dynamics::factor::{cholesky, inverse_lower};
use sinew::dynamics::mixture_em::{self, Component};

/// Share of a column's variance that is added to the diagonal of each covariance: walks of one person hardly fill 59 columns.
const RIDGE: f64 = 1e-2;

/// A component given columns that are there.
struct Conditional {
    log_weight: f64,
    mean: Row,
    /// L⁻¹ of S_oo = L Lᵀ, row after row.
    inverse: Vec<f64>,
    /// S_mo, a row a missing column.
    cross: Vec<Row>,
    missing_mean: Row,
}

impl Conditional {
    fn new(component: &Component, task: &Task<'_>) -> Outcome<Self> {
        let observed = task.observed();
        let entry = |i: usize, j: usize| component.covariance[i * COLUMNS + j];
        let block: Vec<f64> = observed.iter().flat_map(|&i| observed.iter().map(move |&j| entry(i, j))).collect();
        let factor = cholesky("covariance of what is there", &block, observed.len())?;
        let diagonal = factor.lower.iter().step_by(observed.len() + 1);
        Ok(Self {
            log_weight: component.weight.ln() - diagonal.map(|x| x.ln()).sum::<f64>(),
            mean: observed.iter().map(|&j| component.mean[j]).collect(),
            inverse: inverse_lower(&factor.lower, observed.len()),
            cross: task.missing.clone().map(|i| observed.iter().map(|&j| entry(i, j)).collect()).collect(),
            missing_mean: component.mean[task.missing.clone()].to_vec(),
        })
    }

    /// log r_k without a constant, and the mean of what is missing.
    fn given(&self, row: &Row) -> (f64, Row) {
        let count = row.len();
        let away: Row = row.iter().zip(&self.mean).map(|(y, m)| y - m).collect();
        let whitened: Row =
            self.inverse.chunks_exact(count).map(|l| l.iter().zip(&away).map(|(l, y)| l * y).sum()).collect();
        let solved: Row =
            (0..count).map(|j| (j..count).map(|i| self.inverse[i * count + j] * whitened[i]).sum()).collect();
        let square: f64 = whitened.iter().map(|z| z * z).sum();
        let regress = |(cross, mean): (&Row, &f64)| mean + cross.iter().zip(&solved).map(|(c, s)| c * s).sum::<f64>();
        (self.log_weight - 0.5 * square, self.cross.iter().zip(&self.missing_mean).map(regress).collect())
    }
}

/// The judged rows, filled in by a mixture of this number of components.
///
/// # Errors
/// A covariance without a factor.
pub fn fill(task: &Task<'_>, components: usize) -> Outcome<Vec<Row>> {
    let (scales, observed) = (task.scales(), task.observed());
    let standard = |row: &Row| -> Row { (0..COLUMNS).map(|j| scales.apply(row, j)).collect() };
    let rows: Vec<f64> = task.training.iter().copied().flatten().flat_map(standard).collect();
    let config = mixture_em::Config { components, ridge: RIDGE, max_iterations: 30, ..Default::default() };
    let start = mixture_em::start(&rows, COLUMNS, &config, Stage::new(1, "missing limbs, mixture"))?;
    let learned = mixture_em::run(&rows, COLUMNS, start, &config, &mut |_| {})?;
    let conditionals = learned.components.iter().map(|c| Conditional::new(c, task)).collect::<Outcome<Vec<_>>>()?;
    Ok(task.with(|row| {
        let there: Row = observed.iter().map(|&j| scales.apply(row, j)).collect();
        let given: Vec<(f64, Row)> = conditionals.iter().map(|c| c.given(&there)).collect();
        let largest = given.iter().map(|(log, _)| *log).fold(f64::NEG_INFINITY, f64::max);
        let total: f64 = given.iter().map(|(log, _)| (log - largest).exp()).sum();
        let mean = |k: usize| given.iter().map(|(log, mean)| (log - largest).exp() * mean[k]).sum::<f64>() / total;
        task.missing.clone().enumerate().map(|(k, j)| scales.restore(j, mean(k))).collect()
    }))
}
