//! How well a latent model keeps poses: from a pose to its latent and back, ℘(℘⁻¹(·)), as trackers go.

use rayon::prelude::*;
use sinew_core::decode::Decode as _;
use sinew_core::lanes::Isa;
use sinew_latent::Error;
use sinew_latent::model::LatentModel;
use sinew_latent::space::Below;

/// Poses that came back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reconstruction {
    /// Root mean square of all angles' deviations, radians.
    pub rms_rad: f64,
    /// Poses that were tried.
    pub poses: usize,
}

/// Tries at most `most` poses (rows of the model's columns), evenly spaced; of several roots the one that misses a pose least counts. None without poses.
///
/// # Errors
/// A model whose covariances have no factor.
pub fn reconstruction(model: &LatentModel, poses: &[f64], most: usize) -> Result<Option<Reconstruction>, Error> {
    let all = poses.len() / model.columns;
    let tried: Vec<&[f64]> = (0..all.min(most))
        .map(|k| if all > most { k * all / most } else { k })
        .map(|row| &poses[row * model.columns..][..model.columns])
        .collect();
    if tried.is_empty() {
        return Ok(None);
    }
    let mut least = vec![f64::INFINITY; tried.len()];
    for root in model.roots() {
        let below = Below::new(model, root, Isa::baseline())?;
        least.par_iter_mut().zip(&tried).for_each(|(least, pose)| *least = least.min(missed(&below, pose)));
    }
    let count = (tried.len() * model.columns) as f64;
    Ok(Some(Reconstruction { rms_rad: (least.iter().sum::<f64>() / count).sqrt(), poses: tried.len() }))
}

/// Squared distance of a pose from what its latent decodes to; infinite where it has no latent.
fn missed(below: &Below, pose: &[f64]) -> f64 {
    let Some(latent) = below.encode(pose) else { return f64::INFINITY };
    let mut again = vec![0.0; pose.len()];
    below.decode(&latent, &mut again);
    let square: f64 = again.iter().zip(pose).map(|(a, b)| (a - b) * (a - b)).sum();
    if square.is_nan() { f64::INFINITY } else { square }
}
