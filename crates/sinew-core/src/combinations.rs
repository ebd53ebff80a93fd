//! Linear combinations of rows of draws.
//!
//! A row holds one quantity for some draws, eight to a block. A matrix of coefficients takes rows of x to rows of y, for all draws at once.

use crate::lanes::{Block, Isa, Kernel, Real, dispatch};

/// Blocks of a row that stay in registers.
const GROUP: usize = 4;

struct Combine<'a> {
    coefficients: &'a [f64],
    x: &'a [Block],
    y: &'a mut [Block],
    blocks: usize,
}

impl Combine<'_> {
    /// Blocks `first..first + N` of all rows.
    #[inline(always)]
    fn columns<V: Real<Mem = Block>, const N: usize>(&mut self, first: usize) {
        let width = self.x.len() / self.blocks;
        for (row, y) in self.coefficients.chunks_exact(width).zip(self.y.chunks_exact_mut(self.blocks)) {
            let Some(y) = y[first..].first_chunk_mut::<N>() else { continue };
            let mut sum = [V::splat(0.0); N];
            for (sum, y) in sum.iter_mut().zip(&*y) {
                *sum = V::load(y);
            }
            for (by, x) in row.iter().zip(self.x.chunks_exact(self.blocks)) {
                let Some(x) = x[first..].first_chunk::<N>() else { continue };
                if *by != 0.0 {
                    let by = V::splat(*by);
                    for (sum, x) in sum.iter_mut().zip(x) {
                        *sum = by.fma(V::load(x), *sum);
                    }
                }
            }
            for (sum, y) in sum.into_iter().zip(y) {
                sum.store(y);
            }
        }
    }
}

impl Kernel<Block> for Combine<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let grouped = self.blocks / GROUP * GROUP;
        for first in (0..grouped).step_by(GROUP) {
            self.columns::<V, GROUP>(first);
        }
        for first in grouped..self.blocks {
            self.columns::<V, 1>(first);
        }
    }
}

/// `y += C x` for a row of `blocks` blocks each: C has a row for each of y and a column for each of x, row after row; zeros in it cost nothing.
pub fn add_combinations(isa: Isa, coefficients: &[f64], x: &[Block], y: &mut [Block], blocks: usize) {
    if !x.is_empty() && !y.is_empty() {
        dispatch(isa, Combine { coefficients, x, y, blocks });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{numbers, numbers_mut};

    #[test]
    fn combinations_are_the_product_on_every_instruction_set() {
        let (height, width, blocks) = (3, 5, 6);
        let wave = |count: usize, by: f64| (0..count).map(move |k| (by * k as f64).sin());
        let mut coefficients: Vec<f64> = wave(height * width, 0.7).collect();
        coefficients[4] = 0.0;
        let mut x = vec![Block::ZERO; width * blocks];
        numbers_mut(&mut x).iter_mut().zip(wave(8 * width * blocks, 1.3)).for_each(|(x, wave)| *x = wave);
        for isa in Isa::available() {
            let mut y = vec![Block::splat(2.0); height * blocks];
            add_combinations(isa, &coefficients, &x, &mut y, blocks);
            for (k, found) in numbers(&y).iter().enumerate() {
                let (row, draw) = (k / (8 * blocks), k % (8 * blocks));
                let by = |j: usize| coefficients[row * width + j] * numbers(&x)[j * 8 * blocks + draw];
                let expected = 2.0 + (0..width).map(by).sum::<f64>();
                assert!((found - expected).abs() < 1e-14, "{isa:?} row {row}, draw {draw}: {found} for {expected}");
            }
        }
        add_combinations(Isa::baseline(), &[], &[], &mut [], blocks);
    }
}
