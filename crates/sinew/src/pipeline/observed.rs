//! What is bound in a frame: keypoints, silhouettes, or both. Each tracker takes from it what it can use.

use super::Bound;
use core::ops::Range;
use sinew_core::density::{GaussNewton, GradLogDensity, LogDensity, PartLogDensity};
use sinew_core::lanes::Block;
use sinew_observe::image_likelihood::ImageLikelihood;
use sinew_observe::soft_silhouette::SoftSilhouette;

/// The images of a frame.
pub enum BoundImages {
    /// By a weighting function of the papers, which has no gradient.
    Scored(ImageLikelihood),
    /// By the distance of limbs from the contour, for methods with gradients.
    Soft(SoftSilhouette),
}

/// The likelihood of a frame: that of keypoints times that of images.
///
/// Scored images have no gradient and no curvature; methods that need them get soft ones ([`super::Method::takes_gradients`]).
pub struct Observed {
    pub(super) keypoints: Bound,
    /// The keypoints of each part of the body; empty for methods without parts.
    pub(super) parts: Vec<Bound>,
    pub(super) images: Option<BoundImages>,
}

impl From<Bound> for Observed {
    fn from(keypoints: Bound) -> Self {
        Self { keypoints, parts: vec![], images: None }
    }
}

impl Observed {
    fn soft(&self) -> Option<&SoftSilhouette> {
        match &self.images {
            Some(BoundImages::Soft(soft)) => Some(soft),
            _ => None,
        }
    }

    fn image_density(&self) -> Option<&dyn LogDensity> {
        match self.images.as_ref()? {
            BoundImages::Scored(images) => Some(images),
            BoundImages::Soft(soft) => Some(soft),
        }
    }
}

fn add(to: &mut [Block], from: &[Block]) {
    for (to, from) in to.iter_mut().zip(from) {
        to.0.iter_mut().zip(from.0).for_each(|(to, from)| *to += from);
    }
}

impl LogDensity for Observed {
    fn dim(&self) -> usize {
        self.keypoints.dim()
    }

    /// That of the larger one, and room for the curvature of soft images.
    fn workspace(&self) -> usize {
        let d = self.dim();
        let soft = self.soft().map_or(0, |soft| soft.workspace() + d * (d + 1) / 2);
        self.keypoints.workspace().max(soft)
    }

    fn log_density(&self, x: &[f64]) -> f64 {
        self.keypoints.log_density(x) + self.image_density().map_or(0.0, |images| images.log_density(x))
    }

    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        let mut value = [self.keypoints.log_density_block(x, ws)];
        if let Some(images) = self.image_density() {
            add(&mut value, &[images.log_density_block(x, ws)]);
        }
        value[0]
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
            Some(BoundImages::Scored(images)) => images.log_density_parts_block(parts.clone(), x, out, ws),
            _ => out.fill(Block::ZERO),
        }
        for (out, part) in out.iter_mut().zip(&self.parts[parts]) {
            add(std::slice::from_mut(out), &[part.log_density_block(x, ws)]);
        }
    }
}

impl GradLogDensity for Observed {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let value = self.keypoints.log_density_grad(x, grad);
        let Some(soft) = self.soft() else { return value };
        let mut of_images = vec![0.0; x.len()];
        let images = soft.log_density_grad(x, &mut of_images);
        grad.iter_mut().zip(of_images).for_each(|(g, image)| *g += image);
        value + images
    }

    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
        let mut value = [self.keypoints.log_density_grad_block(x, grad, ws)];
        if let Some(soft) = self.soft() {
            let (of_images, ws) = ws.split_at_mut(x.len());
            add(&mut value, &[soft.log_density_grad_block(x, of_images, ws)]);
            add(grad, of_images);
        }
        value[0]
    }
}

impl GaussNewton for Observed {
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], ws: &mut [Block]) {
        self.keypoints.gauss_newton_diagonal_block(x, diagonal, ws);
        if let Some(soft) = self.soft() {
            let (of_images, ws) = ws.split_at_mut(x.len());
            soft.gauss_newton_diagonal_block(x, of_images, ws);
            add(diagonal, of_images);
        }
    }

    fn gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        self.keypoints.gauss_newton_block(x, matrix, ws);
        self.add_soft_curvature(x, matrix, ws);
    }

    fn weighted_gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        self.keypoints.weighted_gauss_newton_block(x, matrix, ws);
        self.add_soft_curvature(x, matrix, ws);
    }

    /// Keypoints alone find the mode from afar.
    fn broadened(&self, factor: f64) -> Option<Box<dyn GaussNewton + '_>> {
        self.keypoints.broadened(factor)
    }
}

impl Observed {
    fn add_soft_curvature(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        if let Some(soft) = self.soft() {
            let (of_images, ws) = ws.split_at_mut(matrix.len());
            soft.gauss_newton_block(x, of_images, ws);
            add(matrix, of_images);
        }
    }
}
