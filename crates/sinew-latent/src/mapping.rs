//! From a latent to what its node generates: mean and variance of Gaussian processes, and derivatives.
//!
//! ```text
//! μ(x) = Yᵀ K⁻¹ k(x),   dμ/dx = −g Σ_n A_n v e_n(x) (x − x_n) + a Xᵀ A,   A = K⁻¹ Y,  e_n = exp(−(g/2) ‖x − x_n‖²)
//! s²(x) = k(x, x) − k(x)ᵀ K⁻¹ k(x),   ds²/dx = dk(x, x)/dx − 2 (dk/dx)ᵀ K⁻¹ k(x)
//! ```
//!
//! μ is in the units of the data (of the children's latents for an inner node); s² is that of each output before it is scaled, without white noise. A is kept in panels of eight outputs, L⁻¹ in panels of four rows, so that a block of states
//! streams through both once.

use crate::Error;
use crate::columns::{Columns, count_rows};
use crate::covariance::Covariance;
use crate::model::{LatentModel, Outputs};
use crate::process::Process;
use sinew_core::elementary::exp;
use sinew_core::lanes::{Block, Isa, LaneMap, Real, map_block, map_one};

/// Outputs of a panel of A, and of the last where few are left.
const WIDE: usize = 8;
const NARROW: usize = 4;
/// Rows of a panel of L⁻¹.
const ROWS: usize = 4;

/// The Gaussian processes of one node, ready to be evaluated.
#[derive(Clone, Debug)]
pub struct Mapping {
    covariance: Covariance,
    dim: usize,
    outputs: usize,
    /// Latents that were learned from, rows of q.
    latents: Vec<f64>,
    /// v A in units of the outputs: panels of eight or four outputs, each with one row a latent.
    panels: Vec<f64>,
    /// The same, one row a latent.
    rows: Vec<f64>,
    /// a Xᵀ A, a row of q an output.
    linear: Vec<f64>,
    /// Mean of each output, with what the bias adds.
    constant: Vec<f64>,
    /// L⁻¹ by panels of four rows: row of the panel within column, columns up to the diagonal of the last.
    inverse: Vec<f64>,
    /// What a unit of an output is before it is scaled: √ of the factor of s².
    scale: Vec<f64>,
    jitter: f64,
}

impl Mapping {
    /// Of a node of a model, by its place among [`LatentModel::nodes`].
    ///
    /// # Errors
    /// [`Error::Shape`] for a node that is not there, [`Error::Singular`].
    pub fn new(model: &LatentModel, node: usize) -> Result<Self, Error> {
        if node >= model.nodes.len() {
            return Err(Error::Shape { name: "nodes of a model", found: model.nodes.len(), expected: node + 1 });
        }
        let own = &model.nodes[node];
        let outputs = model.output_count(node);
        let (scale, mean): (Vec<f64>, Vec<f64>) = match &own.outputs {
            Outputs::Columns(columns) => {
                let scaled = columns.iter().zip(&own.weights);
                scaled.map(|(&j, w)| (model.standard.scale[j] / w, model.standard.mean[j])).unzip()
            }
            Outputs::Nodes(_) => (vec![1.0; outputs], vec![0.0; outputs]),
        };
        Self::fit(own.covariance, &own.latents, own.dim, &model.weighed(node), scale, mean)
    }

    /// Of inputs (rows of `dim`) and outputs (rows as long as `scale` and `mean`, which lead from outputs to the units that are wanted).
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`], [`Error::Singular`].
    pub fn fit(
        covariance: Covariance,
        inputs: &[f64],
        dim: usize,
        outputs: &[f64],
        scale: Vec<f64>,
        mean: Vec<f64>,
    ) -> Result<Self, Error> {
        let width = scale.len();
        let count = count_rows("inputs", inputs, dim)?;
        for (name, found, expected) in [("outputs", outputs.len(), count * width), ("means", mean.len(), width)] {
            if found != expected || expected == 0 {
                return Err(Error::Shape { name, found, expected: expected.max(1) });
            }
        }
        let mut process = Process::new(count, dim, width, Isa::baseline());
        process.evaluate(&covariance, inputs, &Columns::from_rows(outputs, width))?;
        let Covariance { variance, linear, bias, .. } = covariance;
        let weight = |n: usize, d: usize| process.weights().at(n, d) * scale[d];
        let rows: Vec<f64> = (0..count * width).map(|k| variance * weight(k / width, k % width)).collect();
        let along = |d: usize, j: usize| (0..count).map(|n| inputs[n * dim + j] * weight(n, d)).sum::<f64>();
        let sum = |d: usize| (0..count).map(|n| weight(n, d)).sum::<f64>();
        Ok(Self {
            covariance,
            dim,
            outputs: width,
            latents: inputs.to_vec(),
            panels: panels(&rows, width),
            linear: (0..width * dim).map(|k| linear * along(k / dim, k % dim)).collect(),
            constant: (0..width).map(|d| mean[d] + bias * sum(d)).collect(),
            inverse: triangle_panels(process.factors().1),
            jitter: process.jitter(),
            rows,
            scale,
        })
    }

    /// Coordinates q of a latent.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// Number of outputs.
    #[must_use]
    pub fn outputs(&self) -> usize {
        self.outputs
    }

    /// Number of latents that were learned from.
    #[must_use]
    pub fn count(&self) -> usize {
        self.latents.len() / self.dim
    }

    /// Latents that were learned from, rows of q.
    #[must_use]
    pub fn latents(&self) -> &[f64] {
        &self.latents
    }

    /// The covariance of the processes.
    #[must_use]
    pub fn covariance(&self) -> &Covariance {
        &self.covariance
    }

    /// Factor from √s² to the standard deviation of each output.
    #[must_use]
    pub fn scale(&self) -> &[f64] {
        &self.scale
    }

    /// Variance of the white noise, with what had to be added to the diagonal.
    #[must_use]
    pub fn noise(&self) -> f64 {
        self.covariance.white + self.jitter
    }

    /// Length of the scratch of all kernels below.
    #[must_use]
    pub fn workspace(&self) -> usize {
        self.count() * (self.dim + 2) + self.outputs
    }

    /// μ of one latent.
    #[must_use]
    pub fn mean_at(&self, x: &[f64]) -> Vec<f64> {
        let mut mean = vec![0.0; self.outputs];
        map_one(Isa::baseline(), &Mean(self), [x], [&mut mean], self.workspace());
        mean
    }

    /// s² of one latent.
    #[must_use]
    pub fn variance_at(&self, x: &[f64]) -> f64 {
        let mut variance = [0.0];
        map_one(Isa::baseline(), &Variance(self), [x], [&mut variance], self.workspace());
        variance[0]
    }

    /// s² of a block of latents.
    #[must_use]
    pub fn variance_block(&self, x: &[Block], isa: Isa, ws: &mut [Block]) -> Block {
        let mut variance = [Block::ZERO];
        map_block(isa, &Variance(self), [x], [&mut variance], ws);
        variance[0]
    }

    /// μ of a block of latents.
    pub fn mean_block(&self, x: &[Block], isa: Isa, out: &mut [Block], ws: &mut [Block]) {
        map_block(isa, &Mean(self), [x], [out], ws);
    }

    /// e_n(x) of all latents.
    #[inline(always)]
    fn similarities<V: Real>(&self, x: &[V::Mem], out: &mut [V::Mem]) {
        let exponent = V::splat(-0.5 * self.covariance.inverse_width);
        for (known, e) in self.latents.chunks_exact(self.dim).zip(out) {
            let mut square = V::splat(0.0);
            for (&c, x) in known.iter().zip(x) {
                let difference = V::load(x) - V::splat(c);
                square = difference.fma(difference, square);
            }
            exp(square * exponent).store(e);
        }
    }

    /// μ(x); `ws` as long as [`Mapping::workspace`] says.
    #[inline(always)]
    pub fn mean<V: Real>(&self, x: &[V::Mem], out: &mut [V::Mem], ws: &mut [V::Mem]) {
        let similarities = &mut ws[..self.count()];
        self.similarities::<V>(x, similarities);
        self.product::<V>(similarities, out, 1);
        for ((y, &constant), slopes) in out.iter_mut().zip(&self.constant).zip(self.linear.chunks_exact(self.dim)) {
            let mut sum = V::load(y) + V::splat(constant);
            for (&slope, x) in slopes.iter().zip(x) {
                sum = V::load(x).fma(V::splat(slope), sum);
            }
            sum.store(y);
        }
    }

    /// Σ_n e_n A_n to every `stride`-th entry of `out`.
    #[inline(always)]
    fn product<V: Real>(&self, e: &[V::Mem], out: &mut [V::Mem], stride: usize) {
        let (count, mut panels) = (e.len(), &self.panels[..]);
        let mut output = 0;
        while output < self.outputs {
            let width = panel_width(self.outputs - output);
            let (panel, rest) = panels.split_at(count * width);
            let sums = &mut out[output * stride..];
            if width == WIDE {
                panel_product::<V, WIDE>(panel, e, sums, stride);
            } else {
                panel_product::<V, NARROW>(panel, e, sums, stride);
            }
            (panels, output) = (rest, output + width);
        }
    }

    /// dμ/dx, a row of q an output.
    #[inline(always)]
    pub fn jacobian<V: Real>(&self, x: &[V::Mem], jacobian: &mut [V::Mem], ws: &mut [V::Mem]) {
        let (similarities, rest) = ws.split_at_mut(self.count());
        let moved = &mut rest[..self.count()];
        self.similarities::<V>(x, similarities);
        let width = V::splat(-self.covariance.inverse_width);
        for (j, x) in x.iter().enumerate() {
            for ((known, e), m) in self.latents.chunks_exact(self.dim).zip(&*similarities).zip(moved.iter_mut()) {
                ((V::load(x) - V::splat(known[j])) * (V::load(e) * width)).store(m);
            }
            self.product::<V>(moved, &mut jacobian[j..], self.dim);
        }
        for (entry, &slope) in jacobian.iter_mut().zip(&self.linear) {
            (V::load(entry) + V::splat(slope)).store(entry);
        }
    }

    /// (dμ/dx)ᵀ g for gradients g with respect to the outputs.
    #[inline(always)]
    pub fn pullback<V: Real>(&self, x: &[V::Mem], grad_out: &[V::Mem], grad: &mut [V::Mem], ws: &mut [V::Mem]) {
        let similarities = &mut ws[..self.count()];
        self.similarities::<V>(x, similarities);
        for (j, g) in grad.iter_mut().enumerate() {
            let mut sum = V::splat(0.0);
            for (slopes, o) in self.linear.chunks_exact(self.dim).zip(grad_out) {
                sum = V::load(o).fma(V::splat(slopes[j]), sum);
            }
            sum.store(g);
        }
        let width = V::splat(-self.covariance.inverse_width);
        for ((row, known), e) in
            self.rows.chunks_exact(self.outputs).zip(self.latents.chunks_exact(self.dim)).zip(&*similarities)
        {
            // Four sums, so that one need not wait for the other.
            let mut sums = [V::splat(0.0); ROWS];
            for (row, grad_out) in row.chunks(ROWS).zip(grad_out.chunks(ROWS)) {
                for ((&a, o), sum) in row.iter().zip(grad_out).zip(&mut sums) {
                    *sum = V::load(o).fma(V::splat(a), *sum);
                }
            }
            let pull = ((sums[0] + sums[1]) + (sums[2] + sums[3])) * (V::load(e) * width);
            for ((g, x), &c) in grad.iter_mut().zip(x).zip(known) {
                (V::load(x) - V::splat(c)).fma(pull, V::load(g)).store(g);
            }
        }
    }

    /// s²(x), not below 0; with `GRAD` its derivative is written to `grad`.
    #[inline(always)]
    pub fn variance<V: Real, const GRAD: bool>(&self, x: &[V::Mem], grad: &mut [V::Mem], ws: &mut [V::Mem]) -> V {
        let Covariance { variance, inverse_width, linear, bias, .. } = self.covariance;
        let (similarities, rest) = ws.split_at_mut(self.count());
        let (covariances, rest) = rest.split_at_mut(self.count());
        let solved = &mut rest[..self.count()];
        self.similarities::<V>(x, similarities);
        let mut size = V::splat(0.0);
        for x in x {
            size = V::load(x).fma(V::load(x), size);
        }
        let prior = size.fma(V::splat(linear), V::splat(variance + bias));
        for ((known, e), k) in self.latents.chunks_exact(self.dim).zip(&*similarities).zip(covariances.iter_mut()) {
            let mut product = V::splat(0.0);
            for (&c, x) in known.iter().zip(x) {
                product = V::load(x).fma(V::splat(c), product);
            }
            let radial = V::load(e).fma(V::splat(variance), V::splat(bias));
            product.fma(V::splat(linear), radial).store(k);
        }
        let explained = self.explained::<V, GRAD>(covariances, solved);
        if GRAD {
            for (g, x) in grad.iter_mut().zip(x) {
                (V::load(x) * V::splat(2.0 * linear)).store(g);
            }
            for ((known, e), u) in self.latents.chunks_exact(self.dim).zip(&*similarities).zip(&*solved) {
                let twice = V::load(u) * V::splat(-2.0);
                let pull = twice * (V::load(e) * V::splat(-inverse_width * variance));
                let along = twice * V::splat(linear);
                for ((g, x), &c) in grad.iter_mut().zip(x).zip(known) {
                    let sum = (V::load(x) - V::splat(c)).fma(pull, V::load(g));
                    along.fma(V::splat(c), sum).store(g);
                }
            }
        }
        (prior - explained).max(V::splat(0.0))
    }

    /// k(x, x), the variance where nothing is known; with the squared size of x.
    #[must_use]
    pub fn prior_variance(&self, x: &[f64]) -> f64 {
        self.covariance.at(x)
    }

    /// ‖L⁻¹ k‖²; with `SOLVE` K⁻¹ k is written to `solved`.
    #[inline(always)]
    fn explained<V: Real, const SOLVE: bool>(&self, k: &[V::Mem], solved: &mut [V::Mem]) -> V {
        let count = k.len();
        if SOLVE {
            for u in solved.iter_mut() {
                V::splat(0.0).store(u);
            }
        }
        let (mut total, mut panels) = (V::splat(0.0), &self.inverse[..]);
        for first in (0..count).step_by(ROWS) {
            let columns = (first + ROWS).min(count);
            let (panel, rest) = panels.split_at(columns * ROWS);
            let mut sums = [V::splat(0.0); ROWS];
            for (column, k) in panel.as_chunks::<ROWS>().0.iter().zip(k) {
                for (&a, sum) in column.iter().zip(&mut sums) {
                    *sum = V::load(k).fma(V::splat(a), *sum);
                }
            }
            for sum in sums {
                total = sum.fma(sum, total);
            }
            if SOLVE {
                for (column, u) in panel.as_chunks::<ROWS>().0.iter().zip(solved.iter_mut()) {
                    let mut value = V::load(u);
                    for (&a, sum) in column.iter().zip(&sums) {
                        value = sum.fma(V::splat(a), value);
                    }
                    value.store(u);
                }
            }
            panels = rest;
        }
        total
    }
}

struct Mean<'a>(&'a Mapping);

impl LaneMap<1, 1> for Mean<'_> {
    #[inline(always)]
    fn run<V: Real>(&self, [x]: [&[V::Mem]; 1], [out]: [&mut [V::Mem]; 1], ws: &mut [V::Mem]) {
        self.0.mean::<V>(x, out, ws);
    }
}

struct Variance<'a>(&'a Mapping);

impl LaneMap<1, 1> for Variance<'_> {
    #[inline(always)]
    fn run<V: Real>(&self, [x]: [&[V::Mem]; 1], [out]: [&mut [V::Mem]; 1], ws: &mut [V::Mem]) {
        self.0.variance::<V, false>(x, &mut [], ws).store(&mut out[0]);
    }
}

/// Σ_n e_n panel_n: one output a column of the panel, written with a stride.
#[inline(always)]
fn panel_product<V: Real, const N: usize>(panel: &[f64], e: &[V::Mem], out: &mut [V::Mem], stride: usize) {
    let mut sums = [V::splat(0.0); N];
    for (row, e) in panel.as_chunks::<N>().0.iter().zip(e) {
        for (&a, sum) in row.iter().zip(&mut sums) {
            *sum = V::load(e).fma(V::splat(a), *sum);
        }
    }
    for (sum, out) in sums.iter().zip(out.iter_mut().step_by(stride)) {
        sum.store(out);
    }
}

/// Width of the next panel where this number of outputs is left: eight, or four at the end, of which some may stand for none.
#[inline(always)]
const fn panel_width(left: usize) -> usize {
    if left > NARROW { WIDE } else { NARROW }
}

/// Rows by panels of columns, filled up with zeros.
fn panels(rows: &[f64], columns: usize) -> Vec<f64> {
    let mut panels = Vec::with_capacity(rows.len());
    let mut column = 0;
    while column < columns {
        let width = panel_width(columns - column);
        for row in rows.chunks_exact(columns) {
            panels.extend((column..column + width).map(|j| row.get(j).copied().unwrap_or(0.0)));
        }
        column += width;
    }
    panels
}

/// A lower triangle by panels of four rows.
fn triangle_panels(triangle: &Columns) -> Vec<f64> {
    let count = triangle.rows();
    let mut panels = Vec::new();
    for first in (0..count).step_by(ROWS) {
        for j in 0..(first + ROWS).min(count) {
            panels.extend((first..first + ROWS).map(|i| if i < count && j <= i { triangle.at(i, j) } else { 0.0 }));
        }
    }
    panels
}
