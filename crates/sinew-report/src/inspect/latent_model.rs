//! What a latent model holds.

use super::facts::Facts;
use crate::Error;
use sinew::files::read_text;
use sinew_core::lanes::Isa;
use sinew_latent::file::{self, LatentKind, StoredModel};
use sinew_latent::model::{LatentModel, Outputs, RootPrior};
use sinew_latent::training::objective;
use sinew_motion::follow::NamedBody;
use sinew_motion::learn::LearnError;
use sinew_motion::learn::features::pose_coordinates;
use sinew_motion::learn::limbs::name_of;
use sinew_motion::learn::reconstruction::{Reconstruction, reconstruction};
use std::path::Path;

/// Poses that are sent through the model and back, at most.
const TRIED: usize = 100;

/// Reads a latent model.
///
/// # Errors
/// A file that cannot be read or is none.
pub(super) fn read(path: &Path) -> Result<StoredModel, Error> {
    let text = read_text(path, file::MAX_BYTES)?;
    Ok(file::read(&path.display().to_string(), &text).map_err(LearnError::LatentModel)?)
}

/// The body whose states a model is of, if it is known and its poses have as many coordinates.
pub(super) fn body_of(stored: &StoredModel) -> Option<NamedBody> {
    let held = stored.free..stored.free + stored.model.columns;
    NamedBody::find(&stored.state).filter(|&body| pose_coordinates(body) == held)
}

pub(super) fn facts(path: &Path) -> Result<Facts, Error> {
    let stored = read(path)?;
    let StoredModel { state, frame_rate, free, kind, model } = &stored;
    let mut facts = Facts::new(format!("{}: latent model of poses", path.display()));
    facts.row("kind", format!("{kind}, {}", in_words(*kind)));
    let body = body_of(&stored);
    let rest = body.map_or(0, |body| body.tree().dof() - free - model.columns);
    let last = if rest > 0 { format!(", nor the last {rest}, of the feet") } else { String::new() };
    let first = format!("the first {free} coordinates of a state are not in it");
    facts.row("body", format!("{state}, {} angles; {first}{last}", model.columns));
    facts.row("rate", format!("{frame_rate} frames per second"));
    let plural = if model.sequences.len() == 1 { "sequence" } else { "sequences" };
    facts.row("rows", format!("{} in {} {plural}", model.rows(), model.sequences.len()));
    for n in 0..model.nodes.len() {
        facts.row(format!("space {}", name_of(body, model, n)), node(model, n));
    }
    facts.row("prior", prior(&model.prior));
    match objective(model, Isa::baseline()) {
        Ok((value, _)) => facts.row("objective", format!("{value:.2}")),
        Err(error) => facts.odd.push(format!("no objective: {error}").into()),
    }
    match reconstruction(model, &model.data, TRIED) {
        Ok(Some(Reconstruction { rms_rad, poses })) => facts.row(
            "there and back",
            format!("{:.2} degrees root mean square over {poses} of its poses", rms_rad.to_degrees()),
        ),
        Ok(None) => {}
        Err(error) => facts.odd.push(format!("no latents of poses: {error}").into()),
    }
    Ok(facts)
}

const fn in_words(kind: LatentKind) -> &'static str {
    match kind {
        LatentKind::Gplvm => "Gaussian process latent variable model",
        LatentKind::Gpdm => "Gaussian process dynamical model",
        LatentKind::Hgplvm => "hierarchical Gaussian process latent variable model",
    }
}

/// Coordinates, outputs and noise of a node.
fn node(model: &LatentModel, n: usize) -> String {
    let node = &model.nodes[n];
    let coordinates = if node.dim == 1 { "coordinate" } else { "coordinates" };
    let back = if node.back.is_some() { ", a smooth function of the poses" } else { "" };
    let generates = match &node.outputs {
        Outputs::Nodes(nodes) => format!("{} nodes", nodes.len()),
        Outputs::Columns(columns) => {
            let variance = |(&j, w): (&usize, &f64)| node.covariance.white * (model.standard.scale[j] / w).powi(2);
            let sum: f64 = columns.iter().zip(&node.weights).map(variance).sum();
            let noise = (sum / columns.len() as f64).sqrt().to_degrees();
            format!("{} angles with noise of {noise:.2} degrees", columns.len())
        }
    };
    format!("{} {coordinates}{back}, generates {generates}", node.dim)
}

fn prior(prior: &RootPrior) -> String {
    match prior {
        RootPrior::Flat => "none".into(),
        RootPrior::Normal => "each latent is standard normal".into(),
        RootPrior::Dynamics { balance, .. } => format!("dynamics from each latent to the next, factor {balance:.3}"),
    }
}
