//! What is bound in a frame: keypoints, silhouettes, or both. Each tracker takes from it what it can use.

use crate::KeypointLikelihood;
use crate::silhouettes::image_likelihood::ImageLikelihood;
use crate::silhouettes::soft_silhouette::SoftSilhouette;
use sinew_core::density::{GaussNewton, Global, GradLogDensity, LogDensity, PartLogDensity};
use sinew_core::lanes::Block;

/// What a keypoint likelihood is made of in a frame.
pub type BoundKeypoints = sinew_core::density::Lanes<KeypointLikelihood>;

/// The images of a frame.
pub enum BoundImages {
    /// By a weighting function of the papers, which has no gradient.
    Scored(ImageLikelihood),
    /// By the distance of limbs from the contour, for methods with gradients.
    Soft(SoftSilhouette),
}

/// The likelihood of a frame: that of keypoints times that of images.
///
/// Scored images have no gradient and no curvature; methods that need them get soft ones.
pub struct FrameLikelihood {
    /// That of all keypoints.
    pub keypoints: BoundKeypoints,
    /// The keypoints of each part of the body; empty for methods without parts.
    pub parts: Vec<BoundKeypoints>,
    /// That of the images, if there are any.
    pub images: Option<BoundImages>,
}

impl From<BoundKeypoints> for FrameLikelihood {
    fn from(keypoints: BoundKeypoints) -> Self {
        Self { keypoints, parts: vec![], images: None }
    }
}

impl FrameLikelihood {
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

impl LogDensity for FrameLikelihood {
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

impl PartLogDensity for FrameLikelihood {
    fn parts(&self) -> usize {
        self.parts.len()
    }

    fn is_product(&self) -> bool {
        self.images.is_none()
    }

    /// True for the scores of whole silhouettes. A solid has no factor of them: a trunk between its own limbs has no contour, and its value alone is largest at a wrong place.
    fn has_intermediates(&self) -> bool {
        matches!(&self.images, Some(BoundImages::Scored(images)) if !images.is_of_parts())
    }

    /// The keypoints of the parts that are in place; in a frame without keypoints the silhouettes of the whole body, to the power of the share of parts that are in place. Both at once, or silhouettes at full power, would hold
    /// the trunk where limbs that have not moved yet fit.
    fn log_intermediate_block(&self, part: usize, x: &[Block], ws: &mut [Block]) -> Block {
        let in_place = part + 1;
        match self.image_density() {
            Some(images) if self.keypoints.leaf.is_empty() => {
                let power = in_place as f64 / self.parts() as f64;
                Block(images.log_density_block(x, ws).0.map(|value| power * value))
            }
            _ => {
                let mut value = [Block::ZERO];
                self.parts.iter().take(in_place).for_each(|own| add(&mut value, &[own.log_density_block(x, ws)]));
                value[0]
            }
        }
    }

    /// The alignment of silhouettes, and the keypoints; by these alone every state meets what was seen.
    fn global_block(&self, x: &[Block], ws: &mut [Block]) -> Global {
        let mut keypoints = [self.keypoints.log_density_block(x, ws)];
        let met = match &self.images {
            Some(BoundImages::Scored(images)) => {
                let Global { log_likelihood, met } = images.global_block(x, ws);
                add(&mut keypoints, &[log_likelihood]);
                met
            }
            _ => Block::splat(1.0),
        };
        Global { log_likelihood: keypoints[0], met }
    }

    fn log_density_parts_block(&self, parts: &[usize], x: &[Block], out: &mut [Block], ws: &mut [Block]) {
        match &self.images {
            Some(BoundImages::Scored(images)) => images.log_density_parts_block(parts, x, out, ws),
            _ => out.fill(Block::ZERO),
        }
        for (out, part) in out.iter_mut().zip(parts.iter().map(|&part| &self.parts[part])) {
            add(std::slice::from_mut(out), &[part.log_density_block(x, ws)]);
        }
    }
}

impl GradLogDensity for FrameLikelihood {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let value = self.keypoints.log_density_grad(x, grad);
        let Some(soft) = self.soft() else { return value };
        let mut image_term = vec![0.0; x.len()];
        let images = soft.log_density_grad(x, &mut image_term);
        grad.iter_mut().zip(image_term).for_each(|(g, image)| *g += image);
        value + images
    }

    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], ws: &mut [Block]) -> Block {
        let mut value = [self.keypoints.log_density_grad_block(x, grad, ws)];
        if let Some(soft) = self.soft() {
            let (image_term, ws) = ws.split_at_mut(x.len());
            add(&mut value, &[soft.log_density_grad_block(x, image_term, ws)]);
            add(grad, image_term);
        }
        value[0]
    }
}

impl GaussNewton for FrameLikelihood {
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], ws: &mut [Block]) {
        self.keypoints.gauss_newton_diagonal_block(x, diagonal, ws);
        if let Some(soft) = self.soft() {
            let (image_term, ws) = ws.split_at_mut(x.len());
            soft.gauss_newton_diagonal_block(x, image_term, ws);
            add(diagonal, image_term);
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

impl FrameLikelihood {
    fn add_soft_curvature(&self, x: &[Block], matrix: &mut [Block], ws: &mut [Block]) {
        if let Some(soft) = self.soft() {
            let (image_term, ws) = ws.split_at_mut(matrix.len());
            soft.gauss_newton_block(x, image_term, ws);
            add(matrix, image_term);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::silhouettes::bit_image::BitImage;
    use crate::silhouettes::contour_map::contour_map;
    use crate::silhouettes::image_likelihood::{Cues, ImageModel};
    use crate::silhouettes::image_score::ImageScore;
    use crate::silhouettes::soft_silhouette::SoftSilhouetteModel;
    use crate::silhouettes::solid_body::SolidBody;
    use crate::{Camera, Detection, KeypointFrame, KeypointModel, Mistakes, Noise, ObservationModel, View};
    use sinew_body::standard::h32;
    use sinew_body::standard_flesh::standard_flesh;
    use sinew_body::{Plan, Proportions, point_positions};
    use sinew_core::lanes::Isa;
    use std::sync::Arc;

    fn camera() -> Camera {
        Camera::look_at("C", [160.0, 120.0], 130.0, [0.5, -4.0, 1.2], [0.0, 0.0, 1.0]).unwrap()
    }

    /// Keypoints of a standing body, `offset` pixels to the right of where they are, or none.
    fn keypoints(offset: Option<f64>) -> BoundKeypoints {
        let (isa, tree, camera) = (Isa::best(), h32(&Proportions::default()), camera());
        let plan = Arc::new(Plan::with_all_points(&tree));
        let mut at = vec![0.0; 3 * plan.points()];
        point_positions(&plan, isa, &standing(), &mut at);
        let seen = |p: &[f64]| {
            let pixel = camera.project([p[0], p[1], p[2]]).pixel()?;
            Some(Detection::new([pixel[0] + offset?, pixel[1] - 1.0], 0.8))
        };
        let detections = vec![at.chunks(3).map(seen).collect::<Vec<_>>()];
        let view = View { camera: camera.clone(), bias_px: vec![], sigma_px: 3.0, usual_confidence: 0.8 };
        let model = KeypointModel {
            plan,
            views: vec![view],
            noise: Noise::OutlierFloor { outlier: 0.02 },
            model_error_m: 0.01,
            least_confidence: 0.1,
            mistakes: Mistakes::default(),
            isa,
        };
        model.bind(KeypointFrame { detections: &detections, elsewhere: &[], predicted: &at })
    }

    /// Keypoints of a standing body in one camera and a narrow silhouette in it, apart and together.
    fn pieces() -> (BoundKeypoints, SoftSilhouette, FrameLikelihood) {
        let tree = h32(&Proportions::default());
        let flesh = standard_flesh(&tree).unwrap();
        let soft = SoftSilhouetteModel::new(&tree, &flesh, vec![camera()], 3.0, Isa::best()).unwrap();
        let mask = [Some(BitImage::from_fn(160, 120, |x, _| (70..84).contains(&x)))];
        let images = Some(BoundImages::Soft(soft.bind(&mask)));
        let bound = || keypoints(Some(2.0));
        (bound(), soft.bind(&mask), FrameLikelihood { keypoints: bound(), parts: vec![], images })
    }

    fn standing() -> Vec<f64> {
        let mut state = vec![0.05; 32];
        state[..3].copy_from_slice(&[0.0, 0.0, 1.0]);
        state
    }

    /// Keypoints of the parts in place; a power of the whole silhouette where there are no keypoints; and none where the score is a product over solids.
    #[test]
    fn intermediates_take_keypoints_before_silhouettes() {
        let tree = h32(&Proportions::default());
        let flesh = standard_flesh(&tree).unwrap();
        let count = flesh.solids().len();
        let silhouette = BitImage::from_fn(160, 120, |x, _| (70..84).contains(&x));
        let likelihood = |score: ImageScore, offset: Option<f64>| {
            let body = Arc::new(SolidBody::new(&tree, &flesh).unwrap());
            let isa = Isa::best();
            let model = ImageModel { body, cameras: vec![camera()], score, colours: Arc::default(), isa };
            let cues = Cues { edges: Some(contour_map(&silhouette)), silhouette: silhouette.clone(), picture: None };
            let parts = (0..count).map(|_| keypoints(offset)).collect();
            let images = Some(BoundImages::Scored(model.bind(vec![Some(cues)])));
            FrameLikelihood { keypoints: keypoints(offset), parts, images }
        };
        let x: Vec<Block> = standing().iter().map(|&x| Block::splat(x)).collect();
        let score = ImageScore::DeutscherReid { kappa: 100.0, bidirectional: Some(0.5) };
        let (seen, unseen) = (likelihood(score, Some(2.0)), likelihood(score, None));
        let mut ws = vec![Block::ZERO; seen.workspace()];
        let one = seen.keypoints.log_density(&standing());
        let images = unseen.log_density(&standing());
        assert!(images < -10.0, "{images}");
        for part in 0..count {
            let [with, without] = [&seen, &unseen].map(|both| both.log_intermediate_block(part, &x, &mut ws).0[3]);
            let expected = (part + 1) as f64 * one;
            assert!((with - expected).abs() < 1e-9 * expected.abs(), "{part}: {with} for {expected}");
            let expected = (part + 1) as f64 / count as f64 * images;
            assert!((without - expected).abs() < 1e-9 * images.abs(), "{part}: {without} for {expected}");
        }
        assert!(seen.has_intermediates() && !seen.is_product());
        assert!(!likelihood(ImageScore::Parts, None).has_intermediates());
    }

    #[test]
    fn keypoints_and_soft_images_add_up() {
        let (keypoints, soft, both) = pieces();
        let x: Vec<Block> = standing().iter().map(|&x| Block::splat(x)).collect();
        let (d, triangle) = (32, 32 * 33 / 2);
        let mut ws = vec![Block::ZERO; both.workspace() + soft.workspace()];
        let near =
            |a: f64, b: f64, sum: f64| assert!((a + b - sum).abs() < 1e-9 * sum.abs().max(1.0), "{a} and {b}, {sum}");
        let values = [keypoints.log_density(&standing()), soft.log_density(&standing()), both.log_density(&standing())];
        near(values[0], values[1], values[2]);
        assert!(values[1] < -1.0, "arms stick out of the silhouette: {}", values[1]);
        near(values[0], values[1], both.log_density_block(&x, &mut ws).0[5]);
        let mut grads = [0, 1, 2].map(|_| vec![Block::ZERO; d]);
        let [a, b, sum] = &mut grads;
        keypoints.log_density_grad_block(&x, a, &mut ws);
        soft.log_density_grad_block(&x, b, &mut ws);
        near(values[0], values[1], both.log_density_grad_block(&x, sum, &mut ws).0[1]);
        (0..d).for_each(|j| near(a[j].0[0], b[j].0[0], sum[j].0[0]));
        let mut single = vec![0.0; d];
        both.log_density_grad(&standing(), &mut single);
        (0..d).for_each(|j| near(a[j].0[0], b[j].0[0], single[j]));
        let mut matrices = [0, 1, 2].map(|_| vec![Block::ZERO; triangle]);
        let [a, b, sum] = &mut matrices;
        keypoints.gauss_newton_block(&x, a, &mut ws);
        soft.gauss_newton_block(&x, b, &mut ws);
        both.gauss_newton_block(&x, sum, &mut ws);
        (0..triangle).for_each(|j| near(a[j].0[3], b[j].0[3], sum[j].0[3]));
        keypoints.weighted_gauss_newton_block(&x, a, &mut ws);
        both.weighted_gauss_newton_block(&x, sum, &mut ws);
        (0..triangle).for_each(|j| near(a[j].0[3], b[j].0[3], sum[j].0[3]));
        let mut diagonals = [0, 1, 2].map(|_| vec![Block::ZERO; d]);
        let [a, b, sum] = &mut diagonals;
        keypoints.gauss_newton_diagonal_block(&x, a, &mut ws);
        soft.gauss_newton_diagonal_block(&x, b, &mut ws);
        both.gauss_newton_diagonal_block(&x, sum, &mut ws);
        (0..d).for_each(|j| near(a[j].0[2], b[j].0[2], sum[j].0[2]));
    }
}
