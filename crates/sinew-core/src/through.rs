//! A density of decoded states as a function of sampled ones, which lets a tracker sample a latent space.

use crate::decode::Decode;
use crate::density::{GaussNewton, Global, GradLogDensity, LogDensity, PartLogDensity};
use crate::lanes::{Block, LANES, triangle};

/// A density of a decoded state, as a function of the sampled one. It is a likelihood term: no Jacobian is added.
///
/// Law `through_pulls_back`: the value is the target's at the decoded state, the gradient the decoder's pullback of the target's, the curvature Jᵀ H J with the target's H. Nothing is allocated for a block.
#[derive(Clone, Copy, Debug)]
pub struct Through<D, C> {
    /// Density of the decoded state.
    pub target: D,
    /// The decoder.
    pub decoder: C,
}

impl<D: LogDensity, C: Decode> Through<D, C> {
    fn decoded(&self, x: &[f64]) -> Vec<f64> {
        let mut decoded = vec![0.0; self.target.dim()];
        self.decoder.decode(x, &mut decoded);
        decoded
    }

    /// Decodes a block into the first blocks of a workspace; returns them and the rest.
    fn decoded_block<'a>(&self, x: &[Block], ws: &'a mut [Block]) -> (&'a mut [Block], &'a mut [Block]) {
        let (decoded, ws) = ws.split_at_mut(self.target.dim());
        self.decoder.decode_block(x, decoded, ws);
        (decoded, ws)
    }
}

impl<D: LogDensity, C: Decode> LogDensity for Through<D, C> {
    fn dim(&self) -> usize {
        self.decoder.source_dim()
    }
    fn workspace(&self) -> usize {
        2 * self.target.dim() + self.target.workspace().max(self.decoder.workspace())
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.target.log_density(&self.decoded(x))
    }
    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        let (decoded, ws) = self.decoded_block(x, ws);
        self.target.log_density_block(decoded, ws)
    }
}

impl<D: GradLogDensity, C: Decode> GradLogDensity for Through<D, C> {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let mut target_grad = vec![0.0; self.target.dim()];
        let value = self.target.log_density_grad(&self.decoded(x), &mut target_grad);
        self.decoder.pullback(x, &target_grad, grad);
        value
    }
    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
        let (decoded, ws) = self.decoded_block(x, ws);
        let (target_grad, ws) = ws.split_at_mut(self.target.dim());
        let value = self.target.log_density_grad_block(decoded, target_grad, ws);
        self.decoder.pullback_block(x, target_grad, grad, ws);
        value
    }
}

/// The parts are the target's. A part may depend on the whole sampled state, so that a product stays one only through a coordinatewise decoder.
impl<D: PartLogDensity, C: Decode> PartLogDensity for Through<D, C> {
    fn parts(&self) -> usize {
        self.target.parts()
    }
    fn is_product(&self) -> bool {
        self.target.is_product() && self.decoder.is_coordinatewise()
    }
    fn has_intermediates(&self) -> bool {
        self.target.has_intermediates()
    }
    fn log_intermediate_block(&self, part: usize, x: &[Block], ws: &mut [Block]) -> Block {
        let (decoded, ws) = self.decoded_block(x, ws);
        self.target.log_intermediate_block(part, decoded, ws)
    }
    fn global_block(&self, x: &[Block], ws: &mut [Block]) -> Global {
        let (decoded, ws) = self.decoded_block(x, ws);
        self.target.global_block(decoded, ws)
    }
    fn log_density_parts_block(&self, parts: &[usize], x: &[Block], out: &mut [Block], ws: &mut [Block]) {
        let (decoded, ws) = self.decoded_block(x, ws);
        self.target.log_density_parts_block(parts, decoded, out, ws);
    }
}

impl<D: GaussNewton, C: Decode> Through<D, C> {
    /// Diagonals through a coordinatewise decoder: its slopes squared times the target's.
    fn scaled_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], ws: &mut [Block]) {
        let (decoded, ws) = self.decoded_block(x, ws);
        self.target.gauss_newton_diagonal_block(decoded, diagonal, ws);
        let (ones, ws) = ws.split_at_mut(diagonal.len());
        let (slopes, ws) = ws.split_at_mut(diagonal.len());
        ones.fill(Block::splat(1.0));
        self.decoder.pullback_block(x, ones, slopes, ws);
        for (entry, slope) in diagonal.iter_mut().zip(slopes) {
            for lane in 0..LANES {
                entry.0[lane] *= slope.0[lane] * slope.0[lane];
            }
        }
    }
}

impl<D: GaussNewton, C: Decode> GaussNewton for Through<D, C> {
    fn matrix_workspace(&self) -> usize {
        let (m, n) = (self.target.dim(), self.dim());
        m + triangle(m, 0) + triangle(n, 0) + self.target.matrix_workspace().max(self.decoder.matrix_workspace())
    }
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], ws: &mut [Block]) {
        if self.decoder.is_coordinatewise() {
            return self.scaled_diagonal_block(x, diagonal, ws);
        }
        let (matrix, ws) = ws.split_at_mut(triangle(self.dim(), 0));
        self.gauss_newton_block(x, matrix, ws);
        for (j, entry) in diagonal.iter_mut().enumerate() {
            *entry = matrix[triangle(j, j)];
        }
    }
    fn gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        let (decoded, ws) = self.decoded_block(x, ws);
        let (target_matrix, ws) = ws.split_at_mut(triangle(self.target.dim(), 0));
        self.target.gauss_newton_block(decoded, target_matrix, ws);
        self.decoder.pullback_matrix_block(x, target_matrix, matrix, ws);
    }
    fn weighted_gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        let (decoded, ws) = self.decoded_block(x, ws);
        let (target_matrix, ws) = ws.split_at_mut(triangle(self.target.dim(), 0));
        self.target.weighted_gauss_newton_block(decoded, target_matrix, ws);
        self.decoder.pullback_matrix_block(x, target_matrix, matrix, ws);
    }
    fn broadened(&self, factor: f64) -> Option<Box<dyn GaussNewton + '_>> {
        let target = self.target.broadened(factor)?;
        // A trait object, so that broadening what is broadened makes no new type.
        let decoder: &dyn Decode = &self.decoder;
        Some(Box::new(Through { target, decoder }))
    }
}
