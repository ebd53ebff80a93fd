//! A density of some consecutive coordinates of a state, as a density of the whole: flat in all others.
//!
//! Law `within_is_flat_elsewhere`: value and gradient are the target's at the coordinates, 0 is the slope of the others.

use crate::density::{GaussNewton, GradLogDensity, LogDensity};
use crate::lanes::{Block, triangle};
use core::ops::Range;

/// The density.
#[derive(Clone, Debug)]
pub struct Within<D> {
    /// Density of the coordinates.
    pub target: D,
    /// First of them; there are as many as the target has.
    pub first: usize,
    /// Dimension of the whole state.
    pub dim: usize,
}

impl<D: LogDensity> Within<D> {
    fn range(&self) -> Range<usize> {
        self.first..self.first + self.target.dim()
    }
}

impl<D: LogDensity> LogDensity for Within<D> {
    fn dim(&self) -> usize {
        self.dim
    }
    fn workspace(&self) -> usize {
        self.target.workspace()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.target.log_density(&x[self.range()])
    }
    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        self.target.log_density_block(&x[self.range()], ws)
    }
}

impl<D: GradLogDensity> GradLogDensity for Within<D> {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad.fill(0.0);
        self.target.log_density_grad(&x[self.range()], &mut grad[self.range()])
    }
    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
        grad.fill(Block::ZERO);
        self.target.log_density_grad_block(&x[self.range()], &mut grad[self.range()], ws)
    }
}

impl<D: GaussNewton> Within<D> {
    /// Writes a matrix of the coordinates into one of the whole state.
    fn place(&self, own: &[Block], matrix: &mut [Block]) {
        matrix.fill(Block::ZERO);
        for i in 0..self.target.dim() {
            for j in 0..=i {
                matrix[triangle(self.first + i, self.first + j)] = own[triangle(i, j)];
            }
        }
    }
}

impl<D: GaussNewton> GaussNewton for Within<D> {
    fn matrix_workspace(&self) -> usize {
        triangle(self.target.dim(), 0) + self.target.matrix_workspace()
    }
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], ws: &mut [Block]) {
        diagonal.fill(Block::ZERO);
        self.target.gauss_newton_diagonal_block(&x[self.range()], &mut diagonal[self.range()], ws);
    }
    fn gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        let (own, ws) = ws.split_at_mut(triangle(self.target.dim(), 0));
        self.target.gauss_newton_block(&x[self.range()], own, ws);
        self.place(own, matrix);
    }
    fn weighted_gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        let (own, ws) = ws.split_at_mut(triangle(self.target.dim(), 0));
        self.target.weighted_gauss_newton_block(&x[self.range()], own, ws);
        self.place(own, matrix);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::density::Lanes;
    use crate::lanes::Isa;
    use crate::toy::Quadratic;

    #[test]
    fn within_is_flat_elsewhere() {
        let leaf = Quadratic { centre: vec![0.5, -0.5], precision: vec![2.0, 3.0] };
        let target = Lanes { leaf, isa: Isa::best() };
        let within = Within { target, first: 1, dim: 4 };
        let (x, mut grad) = ([9.0, 0.7, 0.1, -8.0], [f64::NAN; 4]);
        let value = within.log_density_grad(&x, &mut grad);
        let mut own = [0.0; 2];
        assert_eq!(value, within.target.log_density_grad(&x[1..3], &mut own));
        assert_eq!(grad, [0.0, own[0], own[1], 0.0]);
        let (x, mut grad, mut ws) = (x.map(Block::splat), [Block::splat(f64::NAN); 4], [Block::ZERO; 20]);
        assert_eq!(
            within.log_density_grad_block(&x, &mut grad, &mut ws).0[3],
            within.log_density_block(&x, &mut ws).0[5]
        );
        assert_eq!([grad[0].0[2], grad[3].0[2]], [0.0; 2]);
        let mut matrix = [Block::splat(f64::NAN); 10];
        within.gauss_newton_block(&x, &mut matrix, &mut ws);
        for i in 0..4 {
            for j in 0..=i {
                let expected = if i == j { [0.0, 2.0, 3.0, 0.0][i] } else { 0.0 };
                assert_eq!(matrix[triangle(i, j)].0[7], expected, "{i} {j}");
            }
        }
    }
}
