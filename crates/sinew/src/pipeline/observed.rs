//! What is bound in a frame: keypoints, silhouettes, or both. Each tracker takes from it what it can use.

use super::Bound;
use core::ops::Range;
use sinew_core::density::{GaussNewton, GradLogDensity, LogDensity, PartLogDensity};
use sinew_core::lanes::Block;
use sinew_observe::image_likelihood::ImageLikelihood;

/// The likelihood of a frame.
///
/// Its value is that of keypoints and images together. Gradients and curvature are those of the keypoints: images have none, and methods that need them are refused with images ([`super::Method::takes_images`]).
pub struct Observed {
    pub(super) keypoints: Bound,
    /// The keypoints of each part of the body; empty for methods without parts.
    pub(super) parts: Vec<Bound>,
    pub(super) images: Option<ImageLikelihood>,
}

impl From<Bound> for Observed {
    fn from(keypoints: Bound) -> Self {
        Self { keypoints, parts: vec![], images: None }
    }
}

impl LogDensity for Observed {
    fn dim(&self) -> usize {
        self.keypoints.dim()
    }

    fn workspace(&self) -> usize {
        self.keypoints.workspace()
    }

    fn log_density(&self, x: &[f64]) -> f64 {
        self.keypoints.log_density(x) + self.images.as_ref().map_or(0.0, |images| images.log_density(x))
    }

    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        let mut value = self.keypoints.log_density_block(x, ws);
        if let Some(images) = &self.images {
            value.0.iter_mut().zip(images.log_density_block(x, ws).0).for_each(|(value, image)| *value += image);
        }
        value
    }
}

impl PartLogDensity for Observed {
    fn parts(&self) -> usize {
        self.parts.len()
    }

    fn is_product(&self) -> bool {
        self.images.is_none()
    }

    fn log_density_parts_block(&self, parts: Range<usize>, x: &[Block], out: &mut [Block], ws: &mut [Block]) {
        match &self.images {
            Some(images) => images.log_density_parts_block(parts.clone(), x, out, ws),
            None => out.fill(Block::ZERO),
        }
        for (out, part) in out.iter_mut().zip(&self.parts[parts]) {
            out.0.iter_mut().zip(part.log_density_block(x, ws).0).for_each(|(out, value)| *out += value);
        }
    }
}

impl GradLogDensity for Observed {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        self.keypoints.log_density_grad(x, grad)
    }

    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
        self.keypoints.log_density_grad_block(x, grad, ws)
    }
}

impl GaussNewton for Observed {
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], ws: &mut [Block]) {
        self.keypoints.gauss_newton_diagonal_block(x, diagonal, ws);
    }

    fn gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        self.keypoints.gauss_newton_block(x, matrix, ws);
    }

    fn weighted_gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        self.keypoints.weighted_gauss_newton_block(x, matrix, ws);
    }

    fn broadened(&self, factor: f64) -> Option<Box<dyn GaussNewton + '_>> {
        self.keypoints.broadened(factor)
    }
}
