//! Densities behind a reference or in a box.

use crate::density::{GaussNewton, Global, GradLogDensity, LogDensity, PartLogDensity};
use crate::lanes::Block;

macro_rules! forward_to_target {
    ($($wrapper:ty),*) => {$(
        impl<D: LogDensity + ?Sized> LogDensity for $wrapper where Self: Sync {
            fn dim(&self) -> usize {
                (**self).dim()
            }
            fn workspace(&self) -> usize {
                (**self).workspace()
            }
            fn log_density(&self, x: &[f64]) -> f64 {
                (**self).log_density(x)
            }
            fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
                (**self).log_density_block(x, ws)
            }
        }
        impl<D: GradLogDensity + ?Sized> GradLogDensity for $wrapper where Self: Sync {
            fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
                (**self).log_density_grad(x, grad)
            }
            fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
                (**self).log_density_grad_block(x, grad, ws)
            }
        }
        impl<D: PartLogDensity + ?Sized> PartLogDensity for $wrapper where Self: Sync {
            fn parts(&self) -> usize {
                (**self).parts()
            }
            fn is_product(&self) -> bool {
                (**self).is_product()
            }
            fn has_intermediates(&self) -> bool {
                (**self).has_intermediates()
            }
            fn log_intermediate_block(&self, part: usize, x: &[Block], ws: &mut [Block]) -> Block {
                (**self).log_intermediate_block(part, x, ws)
            }
            fn global_block(&self, x: &[Block], ws: &mut [Block]) -> Global {
                (**self).global_block(x, ws)
            }
            fn log_density_part(&self, part: usize, x: &[f64]) -> f64 {
                (**self).log_density_part(part, x)
            }
            fn log_density_parts_block(&self, parts: &[usize], x: &[Block], out: &mut [Block], ws: &mut [Block]) {
                (**self).log_density_parts_block(parts, x, out, ws);
            }
        }
        impl<D: GaussNewton + ?Sized> GaussNewton for $wrapper where Self: Sync {
            fn matrix_workspace(&self) -> usize {
                (**self).matrix_workspace()
            }
            fn gauss_newton_diagonal(&self, x: &[f64], diagonal: &mut [f64]) {
                (**self).gauss_newton_diagonal(x, diagonal);
            }
            fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], ws: &mut [Block]) {
                (**self).gauss_newton_diagonal_block(x, diagonal, ws);
            }
            fn gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
                (**self).gauss_newton_block(x, matrix, ws);
            }
            fn weighted_gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
                (**self).weighted_gauss_newton_block(x, matrix, ws);
            }
            fn broadened(&self, factor: f64) -> Option<Box<dyn GaussNewton + '_>> {
                (**self).broadened(factor)
            }
        }
    )*};
}
forward_to_target!(&D, Box<D>);
