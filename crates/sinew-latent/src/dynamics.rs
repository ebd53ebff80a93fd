//! The prior of latents in time: a Gaussian process from each point to the one after it.
//!
//! Wang, Fleet & Hertzmann (2008): with the inputs X_in (all points with a successor in their sequence) and X_out the successors, −log p(X) = (q/2) log|K_X| + ½ tr(K_X⁻¹ X_out X_outᵀ) + (n q/2) log 2π, and the first point of each sequence is N(0, I).

use crate::Error;
use crate::columns::Columns;
use crate::covariance::{Covariance, PARAMETERS};
use crate::process::Process;
use sinew_core::lanes::Isa;

/// Rows with a successor, and first rows, of sequences that follow each other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Successors {
    pub(crate) before: Vec<usize>,
    pub(crate) first: Vec<usize>,
}

impl Successors {
    /// Of sequences of these lengths, which must add up to `rows`.
    pub(crate) fn new(lengths: &[usize], rows: usize) -> Result<Self, Error> {
        let total: usize = lengths.iter().sum();
        if total != rows {
            return Err(Error::Shape { name: "all sequences together", found: total, expected: rows });
        }
        if let Some(&found) = lengths.iter().find(|&&length| length < 2) {
            return Err(Error::Shape { name: "a sequence", found, expected: 2 });
        }
        let (mut before, mut first, mut start) = (Vec::new(), Vec::new(), 0);
        for length in lengths {
            first.push(start);
            before.extend(start..start + length - 1);
            start += length;
        }
        Ok(Self { before, first })
    }
}

/// The prior's value and gradient.
pub(crate) struct Dynamics {
    pub(crate) successors: Successors,
    process: Process,
    inputs: Vec<f64>,
    outputs: Columns,
    dim: usize,
}

impl Dynamics {
    pub(crate) fn new(successors: Successors, dim: usize, isa: Isa) -> Self {
        let count = successors.before.len();
        let (process, outputs) = (Process::new(count, dim, dim, isa), Columns::zeros(count, dim));
        Self { successors, process, inputs: vec![0.0; count * dim], outputs, dim }
    }

    /// −log p(X); `weight` times its gradient is added to `gradient` (rows of q), and `weight` times that of the log parameters is returned.
    pub(crate) fn evaluate(
        &mut self,
        covariance: &Covariance,
        x: &[f64],
        weight: f64,
        gradient: &mut [f64],
    ) -> Result<(f64, [f64; PARAMETERS]), Error> {
        let dim = self.dim;
        for (k, &i) in self.successors.before.iter().enumerate() {
            self.inputs[k * dim..][..dim].copy_from_slice(&x[i * dim..][..dim]);
            (0..dim).for_each(|j| self.outputs.set(k, j, x[(i + 1) * dim + j]));
        }
        let mut value = -self.process.evaluate(covariance, &self.inputs, &self.outputs)?;
        let (points, weights) = (self.process.points(), self.process.weights());
        for (k, &i) in self.successors.before.iter().enumerate() {
            for j in 0..dim {
                gradient[i * dim + j] -= weight * points.at(k, j);
                gradient[(i + 1) * dim + j] += weight * weights.at(k, j);
            }
        }
        for &i in &self.successors.first {
            for j in i * dim..(i + 1) * dim {
                value += 0.5 * x[j] * x[j];
                gradient[j] += weight * x[j];
            }
        }
        Ok((value, self.process.parameters().map(|slope| -weight * slope)))
    }
}
