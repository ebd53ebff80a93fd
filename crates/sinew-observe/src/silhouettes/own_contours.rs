//! Parts that are judged by all of their own contour, whatever hides them.
//!
//! Another reading of the likelihood of a part of the coarse-to-fine tracker.
//!
//! In the likelihood of the whole body (eq. 3) contour points inside another part's outline do not count, since no edge is seen there. The likelihood λ_k of a part takes the same points; a part that hides, before or behind
//! another, then has few of them or none, and a part of which no contour counts misses nothing: the choice of the best part by λ_k is drawn to poses that hide it. Here a part is seen as if it were alone: none of its
//! contour is left out, wherever it lies. The whole body is judged as ever.

use crate::model::ObservationModel as _;
use crate::silhouettes::image_likelihood::{Cues, ImageLikelihood, ImageModel};
use crate::silhouettes::solid_body::SolidBody;
use sinew_body::KinematicTree;
use sinew_body::flesh::{Flesh, Solid};
use sinew_core::density::{LogDensity, PartLogDensity};
use sinew_core::lanes::Block;
use std::sync::Arc;

/// Models of each solid alone, otherwise as the model of the whole body.
///
/// # Errors
/// Errors of [`Flesh::new`] and [`SolidBody::new`], where the flesh is none of the tree's.
pub fn alone(whole: &ImageModel, tree: &KinematicTree, flesh: &Flesh) -> Result<Vec<ImageModel>, sinew_body::Error> {
    let model = |solid: &Solid| {
        let body = Arc::new(SolidBody::new(tree, &Flesh::new(tree, vec![solid.clone()])?)?);
        Ok(ImageModel { body, ..whole.clone() })
    };
    flesh.solids().iter().map(model).collect()
}

/// One frame's likelihood of the whole body, and of each solid alone.
#[derive(Debug)]
pub struct OwnContours<'a> {
    whole: &'a ImageLikelihood,
    parts: Vec<ImageLikelihood>,
}

impl<'a> OwnContours<'a> {
    /// Binds the models of [`alone`] to what the one camera saw; `whole` is bound to the same.
    #[must_use]
    pub fn new(whole: &'a ImageLikelihood, models: &[ImageModel], cues: &Cues) -> Self {
        Self { whole, parts: models.iter().map(|model| model.bind(vec![Some(cues.clone())])).collect() }
    }
}

impl LogDensity for OwnContours<'_> {
    fn dim(&self) -> usize {
        self.whole.dim()
    }

    fn log_density(&self, x: &[f64]) -> f64 {
        self.whole.log_density(x)
    }

    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        self.whole.log_density_block(x, ws)
    }
}

impl PartLogDensity for OwnContours<'_> {
    fn parts(&self) -> usize {
        self.parts.len()
    }

    fn log_density_parts_block(&self, parts: &[usize], x: &[Block], out: &mut [Block], ws: &mut [Block]) {
        for (out, part) in out.iter_mut().zip(parts.iter().map(|&part| &self.parts[part])) {
            *out = part.log_density_block(x, ws);
        }
    }
}
