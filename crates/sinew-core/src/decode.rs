//! Decoders: maps from the sampled state to the state that a density understands.

/// A differentiable map. Law: [`Decode::pullback`] is the transposed derivative of [`Decode::decode`].
pub trait Decode: Sync {
    /// Dimension of the sampled state.
    fn source_dim(&self) -> usize;
    /// Dimension of the decoded state.
    fn target_dim(&self) -> usize;
    /// Writes the decoded state.
    fn decode(&self, x: &[f64], out: &mut [f64]);
    /// Given the gradient with respect to the decoded state, writes the gradient with respect to `x`.
    fn pullback(&self, x: &[f64], grad_out: &[f64], grad: &mut [f64]);
}

/// A linear decoder `y = A x`; with the identity matrix it is pose space itself.
#[derive(Clone, Debug, PartialEq)]
pub struct Linear {
    /// Rows of A, all of one length.
    pub rows: Vec<Vec<f64>>,
}

impl Decode for Linear {
    fn source_dim(&self) -> usize {
        self.rows.first().map_or(0, Vec::len)
    }
    fn target_dim(&self) -> usize {
        self.rows.len()
    }
    fn decode(&self, x: &[f64], out: &mut [f64]) {
        for (y, row) in out.iter_mut().zip(&self.rows) {
            *y = row.iter().zip(x).map(|(a, x)| a * x).sum();
        }
    }
    fn pullback(&self, _x: &[f64], grad_out: &[f64], grad: &mut [f64]) {
        for (j, g) in grad.iter_mut().enumerate() {
            *g = self.rows.iter().zip(grad_out).map(|(row, o)| row[j] * o).sum();
        }
    }
}
