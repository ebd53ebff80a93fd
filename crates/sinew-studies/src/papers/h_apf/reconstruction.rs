//! How well poses come back from a latent space. Root mean square of ℘(℘⁻¹(ω)) − ω over rows and angles, degrees.

use super::lessons::{Poses, Taught};
use crate::support::outcome::Outcome;
use sinew::body::hapf31::ANGLES;
use sinew::core::decode::Decode;
use sinew::core::hierarchy::AnyDecode;
use sinew::core::lanes::Isa;
use sinew::latent::space::Below;
use sinew::latent::tree::hierarchy_with_steps;
use std::sync::Arc;

/// Latent spaces that together hold a pose, each with its coordinates.
type Cover = Vec<(Vec<usize>, Arc<AnyDecode>)>;

fn error_deg(cover: &Cover, poses: &Poses) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for pose in poses.angles() {
        for (coordinates, decoder) in cover {
            let own: Vec<f64> = coordinates.iter().map(|&j| pose[j]).collect();
            let mut found = vec![0.0; own.len()];
            decoder.decode(&decoder.encode(&own).unwrap_or_default(), &mut found);
            sum += own.iter().zip(&found).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
            count += own.len();
        }
    }
    (sum / f64::from(count as u32)).sqrt().to_degrees()
}

/// What was learned in one way: of which dimension its latents are, and its errors on what it learned from and on what was held out.
pub(super) struct Reconstruction {
    pub(super) name: &'static str,
    pub(super) dim: usize,
    pub(super) training_deg: f64,
    pub(super) held_out_deg: f64,
}

/// Of single spaces, of the hierarchy's root and of its leaves, with that number of steps of every inverse after regression.
pub(super) fn reconstructions(taught: &Taught, steps: usize) -> Outcome<[Reconstruction; 4]> {
    let isa = Isa::best();
    let tree = hierarchy_with_steps(&taught.hierarchy.model, steps, isa)?;
    let single = |model| -> Outcome<Cover> {
        Ok(vec![((0..ANGLES).collect(), Arc::new(Below::with_steps(model, 0, steps, isa)?))])
    };
    let cover = |nodes: &mut dyn Iterator<Item = usize>| -> Cover {
        nodes.map(|node| &tree.nodes()[node]).map(|node| (node.coordinates.clone(), node.pose.clone())).collect()
    };
    let covers: [(&'static str, Cover); 4] = [
        ("GPLVM", single(&taught.gplvm.model)?),
        ("GPDM", single(&taught.gpdm.model)?),
        ("HGPLVM, root", cover(&mut std::iter::once(0))),
        ("HGPLVM, leaves", cover(&mut tree.leaves())),
    ];
    Ok(covers.map(|(name, cover)| Reconstruction {
        name,
        dim: cover.iter().map(|(_, decoder)| decoder.source_dim()).sum(),
        training_deg: error_deg(&cover, &taught.poses),
        held_out_deg: error_deg(&cover, &taught.held_out),
    }))
}
