//! The log likelihood of Gaussian processes on shared points, one process a column of outputs, and its gradient.
//!
//! With K the covariance of N points and Y the outputs (N × D),
//!
//! ```text
//! L = −(D/2) log|K| − ½ tr(K⁻¹ Y Yᵀ) − (N D/2) log 2π,   A = K⁻¹ Y,   G = dL/dK = ½ (A Aᵀ − D K⁻¹),   dL/dY = −A.
//! ```
//!
//! K⁻¹ = L⁻ᵀ L⁻¹ is made in chunks of columns, each of them used up (A Aᵀ subtracted, sums over the kernel's derivatives taken) before the next: chunks are what threads share, and they are the same on any number of threads.

use crate::Error;
use crate::columns::{Columns, view_mut};
use crate::covariance::{Covariance, PARAMETERS};
use crate::gram::{Fill, Gather};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::{LltRegularization, cholesky_in_place, cholesky_in_place_scratch};
use faer::linalg::matmul::{matmul, triangular};
use faer::linalg::triangular_solve::{solve_lower_triangular_in_place, solve_upper_triangular_in_place};
use faer::{Accum, Par, Spec};
use rayon::prelude::*;
use sinew_core::lanes::{Block, Isa, dispatch};
use std::f64::consts::TAU;

/// Columns that one task takes.
const CHUNK: usize = 64;
/// Columns of outputs that one task solves for.
const OUTPUTS: usize = 32;

/// Scratch of N points of q coordinates with D outputs each; the gradient after [`Process::evaluate`].
pub(crate) struct Process {
    x: Columns,
    /// A = K⁻¹ Y.
    weights: Columns,
    radial: Columns,
    factor: Columns,
    inverse_factor: Columns,
    /// dL/dX.
    points: Columns,
    /// dL/d log of v, g, a, b, w.
    parameters: [f64; PARAMETERS],
    /// What was added to the diagonal so that the factor exists.
    jitter: f64,
    isa: Isa,
}

/// What one chunk of columns adds to the gradient.
struct Share {
    sums: [Block; PARAMETERS - 1],
    rows: Vec<Block>,
    cols: Vec<Block>,
    /// Σ G over the diagonal.
    trace: f64,
}

impl Process {
    pub(crate) fn new(rows: usize, dim: usize, outputs: usize, isa: Isa) -> Self {
        let square = || Columns::zeros(rows, rows);
        let (x, points, weights) =
            (Columns::zeros(rows, dim), Columns::zeros(rows, dim), Columns::zeros(rows, outputs));
        let (radial, factor, inverse_factor) = (square(), square(), square());
        Self { x, weights, radial, factor, inverse_factor, points, parameters: [0.0; PARAMETERS], jitter: 0.0, isa }
    }

    /// L at points (rows of q, one after the other) and outputs (N × D); leaves the gradient.
    ///
    /// # Errors
    /// [`Error::Singular`].
    pub(crate) fn evaluate(&mut self, covariance: &Covariance, x: &[f64], y: &Columns) -> Result<f64, Error> {
        self.x.copy_from_rows(x);
        self.factorise(covariance)?;
        self.solve(y);
        let (rows, outputs) = (y.rows(), y.cols());
        let log_determinant: f64 = (0..rows).map(|i| 2.0 * self.factor.at(i, i).ln()).sum();
        let fit: f64 = (0..outputs).map(|d| self.fit(y, d)).sum();
        self.differentiate(covariance, outputs as f64);
        Ok(-0.5 * (outputs as f64 * log_determinant + fit + (rows * outputs) as f64 * TAU.ln()))
    }

    /// dL/dX.
    pub(crate) fn points(&self) -> &Columns {
        &self.points
    }

    /// dL/d log of v, g, a, b, w; 0 where the parameter is 0.
    pub(crate) fn parameters(&self) -> &[f64; PARAMETERS] {
        &self.parameters
    }

    /// A = K⁻¹ Y = −dL/dY.
    pub(crate) fn weights(&self) -> &Columns {
        &self.weights
    }

    /// yᵀ K⁻¹ y of one column of the outputs of the last evaluation.
    pub(crate) fn fit(&self, y: &Columns, column: usize) -> f64 {
        product(y.column(column), self.weights.column(column))
    }

    /// The lower factor of K and its inverse: lower triangles, zeros above.
    pub(crate) fn factors(&self) -> (&Columns, &Columns) {
        (&self.factor, &self.inverse_factor)
    }

    /// What was added to the diagonal so that the factor exists; 0 if nothing had to be.
    pub(crate) fn jitter(&self) -> f64 {
        self.jitter
    }

    fn fill(&mut self, covariance: &Covariance) {
        let (covariance, x, isa) = (*covariance, &self.x, self.isa);
        let length = CHUNK * x.height();
        let chunks =
            self.radial.blocks_mut().par_chunks_mut(length).zip(self.factor.blocks_mut().par_chunks_mut(length));
        chunks.enumerate().for_each(|(c, (radial, gram))| {
            dispatch(isa, Fill { covariance, x, first: c * CHUNK, radial, gram });
        });
    }

    /// Lower Cholesky factor of K, with 1e-10 of its mean diagonal added where there is none, times 10 up to six tries.
    fn factorise(&mut self, covariance: &Covariance) -> Result<(), Error> {
        let rows = self.x.rows();
        let mut stack = MemBuffer::new(cholesky_in_place_scratch::<f64>(rows, Par::Seq, Spec::default()));
        self.jitter = 0.0;
        for attempt in 0..=6 {
            self.fill(covariance);
            let mean = (0..rows).map(|i| self.factor.at(i, i)).sum::<f64>() / rows as f64 + covariance.white;
            for i in 0..rows {
                self.factor.set(i, i, self.factor.at(i, i) + (covariance.white + self.jitter));
            }
            let (none, stack) = (LltRegularization::default(), MemStack::new(&mut stack));
            let factor = self.factor.view_mut();
            if mean.is_finite() && cholesky_in_place(factor, none, Par::Seq, stack, Spec::default()).is_ok() {
                return Ok(());
            }
            self.jitter = 1e-10 * mean * 10.0_f64.powi(attempt);
        }
        Err(Error::Singular { rows, jitter: self.jitter })
    }

    /// A = L⁻ᵀ L⁻¹ Y.
    fn solve(&mut self, y: &Columns) {
        self.weights.copy_from(y);
        let (factor, rows, height) = (self.factor.view(), y.rows(), y.height());
        self.weights.blocks_mut().par_chunks_mut(OUTPUTS * height).for_each(|chunk| {
            let mut columns = view_mut(chunk, rows, chunk.len() / height);
            solve_lower_triangular_in_place(factor, columns.as_mut(), Par::Seq);
            solve_upper_triangular_in_place(factor.transpose(), columns, Par::Seq);
        });
    }

    /// L⁻¹, whose chunks of columns need nothing of each other.
    fn invert_factor(&mut self) {
        let (factor, rows, height) = (self.factor.view(), self.x.rows(), self.x.height());
        self.inverse_factor.blocks_mut().par_chunks_mut(CHUNK * height).enumerate().for_each(|(c, chunk)| {
            let (first, width) = (c * CHUNK, chunk.len() / height);
            chunk.fill(Block::ZERO);
            let mut columns = view_mut(chunk, rows, width).subrows_mut(first, rows - first);
            (0..width).for_each(|i| columns[(i, i)] = 1.0);
            let below = factor.submatrix(first, first, rows - first, rows - first);
            solve_lower_triangular_in_place(below, columns, Par::Seq);
        });
    }

    fn differentiate(&mut self, covariance: &Covariance, outputs: f64) {
        self.invert_factor();
        let rows = self.x.rows();
        let chunks = rows.div_ceil(CHUNK);
        let shares: Vec<Share> =
            (0..chunks).into_par_iter().map(|c| self.share(covariance, outputs, c * CHUNK)).collect();
        self.points.blocks_mut().fill(Block::ZERO);
        let (mut sums, mut trace) = ([0.0; PARAMETERS - 1], 0.0);
        let dim = self.x.cols();
        for (c, share) in shares.iter().enumerate() {
            trace += share.trace;
            sums.iter_mut().zip(&share.sums).for_each(|(sum, lanes)| *sum += lanes.0.iter().sum::<f64>());
            for (total, block) in self.points.blocks_mut().iter_mut().zip(&share.rows) {
                total.0.iter_mut().zip(block.0).for_each(|(a, b)| *a += b);
            }
            for (j, lanes) in share.cols.iter().enumerate() {
                let (i, k) = (c * CHUNK + j / dim, j % dim);
                self.points.set(i, k, self.points.at(i, k) + lanes.0.iter().sum::<f64>());
            }
        }
        let [radial, distances, products, all] = sums;
        let Covariance { inverse_width, linear, bias, white, .. } = *covariance;
        self.parameters = [radial, -0.5 * inverse_width * distances, linear * products, bias * all, white * trace];
    }

    /// K⁻¹ − A Aᵀ / D in the columns from `first`, from the first of them down, and what it adds to the gradient.
    fn share(&self, covariance: &Covariance, outputs: f64, first: usize) -> Share {
        let (rows, height, dim) = (self.x.rows(), self.x.height(), self.x.cols());
        let width = CHUNK.min(rows - first);
        let mut slope = vec![Block::ZERO; width * height];
        let mut columns = view_mut(&mut slope, rows, width).subrows_mut(first, rows - first);
        let inverse = self.inverse_factor.view().submatrix(first, first, rows - first, rows - first);
        let (full, upper) = (triangular::BlockStructure::Rectangular, triangular::BlockStructure::TriangularUpper);
        let (left, right) = (inverse.transpose(), inverse.subcols(0, width));
        triangular::matmul(columns.as_mut(), full, Accum::Replace, left, upper, right, full, 1.0, Par::Seq);
        let weights = self.weights.view().subrows(first, rows - first);
        let right = weights.subrows(0, width).transpose();
        matmul(columns.as_mut(), Accum::Add, weights, right, -1.0 / outputs, Par::Seq);
        let factor = -0.5 * outputs;
        let trace = (0..width).map(|i| factor * columns[(i, i)]).sum();
        let (rows, cols) = (vec![Block::ZERO; dim * height], vec![Block::ZERO; dim * width]);
        let mut share = Share { sums: [Block::ZERO; PARAMETERS - 1], rows, cols, trace };
        let Share { sums, rows, cols, .. } = &mut share;
        let radial = &self.radial.blocks()[first * height..][..width * height];
        let (covariance, x) = (*covariance, &self.x);
        dispatch(self.isa, Gather { covariance, x, first, radial, slope: &slope, factor, sums, rows, cols });
        share
    }
}

/// Sum of products of two columns.
fn product(a: &[Block], b: &[Block]) -> f64 {
    let mut lanes = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        lanes.iter_mut().zip(a.0.iter().zip(&b.0)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    lanes.iter().sum()
}
