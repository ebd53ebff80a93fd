//! Matrices by columns, each padded with zeros to whole blocks of eight rows.

use crate::Error;
use faer::{MatMut, MatRef};
use sinew_core::lanes::{Block, LANES, numbers, numbers_mut};

/// A matrix of n rows. Rows from n on, up to whole blocks, hold zeros.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Columns {
    blocks: Vec<Block>,
    rows: usize,
    cols: usize,
}

impl Columns {
    pub(crate) fn zeros(rows: usize, cols: usize) -> Self {
        Self { blocks: vec![Block::ZERO; rows.div_ceil(LANES) * cols], rows, cols }
    }

    /// From rows of length `cols`, one after the other.
    pub(crate) fn from_rows(values: &[f64], cols: usize) -> Self {
        let mut matrix = Self::zeros(values.len() / cols, cols);
        matrix.copy_from_rows(values);
        matrix
    }

    pub(crate) fn copy_from_rows(&mut self, values: &[f64]) {
        let stride = self.height();
        for (i, row) in values.chunks_exact(self.cols).enumerate() {
            for (j, &x) in row.iter().enumerate() {
                self.blocks[j * stride + i / LANES].0[i % LANES] = x;
            }
        }
    }

    /// Adds the entries to rows of length `cols`, one after the other.
    pub(crate) fn add_to_rows(&self, factor: f64, values: &mut [f64]) {
        for (i, row) in values.chunks_exact_mut(self.cols).enumerate() {
            for (j, x) in row.iter_mut().enumerate() {
                *x += factor * self.at(i, j);
            }
        }
    }

    #[inline(always)]
    pub(crate) fn at(&self, i: usize, j: usize) -> f64 {
        self.blocks[j * self.height() + i / LANES].0[i % LANES]
    }

    pub(crate) fn set(&mut self, i: usize, j: usize, x: f64) {
        let stride = self.height();
        self.blocks[j * stride + i / LANES].0[i % LANES] = x;
    }

    /// Blocks of a column.
    #[inline(always)]
    pub(crate) fn height(&self) -> usize {
        self.rows.div_ceil(LANES)
    }

    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    pub(crate) fn cols(&self) -> usize {
        self.cols
    }

    #[inline(always)]
    pub(crate) fn column(&self, j: usize) -> &[Block] {
        &self.blocks[j * self.height()..][..self.height()]
    }

    pub(crate) fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    pub(crate) fn blocks_mut(&mut self) -> &mut [Block] {
        &mut self.blocks
    }

    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.blocks.copy_from_slice(&other.blocks);
    }

    pub(crate) fn view(&self) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice_with_stride(numbers(&self.blocks), self.rows, self.cols, self.height() * LANES)
    }

    pub(crate) fn view_mut(&mut self) -> MatMut<'_, f64> {
        view_mut(&mut self.blocks, self.rows, self.cols)
    }
}

/// Some columns of a matrix of `rows` rows.
pub(crate) fn view_mut(blocks: &mut [Block], rows: usize, cols: usize) -> MatMut<'_, f64> {
    let stride = rows.div_ceil(LANES) * LANES;
    MatMut::from_column_major_slice_with_stride_mut(numbers_mut(blocks), rows, cols, stride)
}

/// Number of rows of length `cols`, all of them finite.
pub(crate) fn count_rows(name: &'static str, rows: &[f64], cols: usize) -> Result<usize, Error> {
    if cols == 0 || rows.is_empty() {
        return Err(Error::Shape { name, found: rows.len(), expected: cols.max(1) });
    }
    if !rows.len().is_multiple_of(cols) {
        return Err(Error::Shape { name, found: rows.len(), expected: rows.len().next_multiple_of(cols) });
    }
    match rows.iter().position(|x| !x.is_finite()) {
        Some(index) => Err(Error::OutOfRange { name, index, value: rows[index], expected: "must be finite" }),
        None => Ok(rows.len() / cols),
    }
}
