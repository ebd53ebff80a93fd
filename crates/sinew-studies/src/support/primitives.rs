//! Action primitives of a body, learned once and kept in a file.

use super::outcome::Outcome;
use rayon::prelude::*;
use sinew::core::random::Stage;
use sinew::dynamics::primitives::file;
use sinew::dynamics::primitives::learning::{Config, TrainingMotion, learn_feature, noise_sd};
use sinew::dynamics::primitives::model::PrimitiveModel;
use sinew_motion::follow::NamedBody;
use sinew_motion::learn::features::feature_vectors;
use std::path::Path;

/// What is learned: feature vectors in a primitive, and clusters at most.
pub(crate) struct Lesson {
    pub(crate) body: NamedBody,
    pub(crate) rate_hz: f64,
    pub(crate) length: usize,
    pub(crate) clusters: usize,
}

/// The model of sequences of states, from its file where there is one; `sequences` makes them where there is none.
pub(crate) fn learned(
    path: &Path,
    lesson: &Lesson,
    stage: Stage,
    sequences: impl FnOnce() -> Outcome<Vec<Vec<f64>>>,
) -> Outcome<PrimitiveModel> {
    let name = path.display().to_string();
    if let Ok(text) = std::fs::read_to_string(path) {
        return Ok(file::read(&name, &text)?);
    }
    let Lesson { body, rate_hz, length, clusters } = *lesson;
    let mut config = Config { length, ..Config::default() };
    config.mixture.components = clusters;
    let (state, dim, sequences) = (body.name(), body.tree().dof(), sequences()?);
    let horizontal = &NamedBody::HORIZONTAL;
    let motion = TrainingMotion { state, dim, frame_rate: rate_hz, sequences: &sequences, horizontal };
    let noise_sd = noise_sd(&motion, &config)?;
    let features = feature_vectors(body);
    let learn = |(index, feature)| learn_feature(&motion, feature, &noise_sd, &config, stage.round(index), &mut |_| {});
    let primitives = features.par_iter().enumerate().map(learn).collect::<Result<Vec<_>, _>>()?;
    let model = PrimitiveModel { state: state.into(), dim, frame_rate: rate_hz, length, noise_sd, primitives };
    std::fs::write(path, file::write(&name, &model)?)?;
    Ok(model)
}
