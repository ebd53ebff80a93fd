//! The motion prior of a recording: a random walk with measured noise, or a learned motion model.
//!
//! A model of action primitives moves by its feature vector `body`. Its clusters are near the angles of its training motion, so a state that tracking starts from is turned by whole turns to the nearest such angles.

use super::error::TrackError;
use crate::Error;
use crate::config::settings::Settings;
use crate::setup::{Setup, motion_noise};
use sinew_body::standard::{cf28, h32};
use sinew_body::{Joint, KinematicTree, Proportions, hapf31, hppf24};
use sinew_dynamics::model_file::ModelFormat;
use sinew_dynamics::motion_prior::MotionPrior;
use sinew_dynamics::primitives::file::FORMAT;
use sinew_dynamics::primitives::model::PrimitiveModel;
use sinew_dynamics::primitives::motion::PrimitiveMotion;
use sinew_dynamics::random_walk::RandomWalk;
use sinew_latent::file::StoredModel;
use std::f64::consts::TAU;

/// The feature vector that moves the whole body.
const WHOLE_BODY: &str = "body";

/// How far the rate of a recording may be from that of a model, as a share.
const SAME_RATE: f64 = 0.01;

/// A random walk with the noise that the set-up found.
///
/// # Errors
/// Noise of another body.
pub fn walk(setup: &Setup, tree: &KinematicTree, settings: &Settings) -> Result<RandomWalk, Error> {
    let sd = match &setup.motion_sd {
        Some(sd) if sd.len() == tree.dof() => sd.clone(),
        _ => motion_noise::default_sd(tree),
    };
    let sd: Vec<f64> = sd.iter().map(|sd| sd * settings.motion_scale).collect();
    let walk = RandomWalk::new(&sd, 1.0 / settings.fps, settings.between, settings.isa);
    Ok(walk.and_then(|walk| walk.with_initial_sd(motion_noise::initial_sd(tree))).map_err(TrackError::Motion)?)
}

/// The motion prior that the settings ask for.
///
/// # Errors
/// A model of another body or frame rate.
pub fn motion_prior(setup: &Setup, tree: &KinematicTree, settings: &Settings) -> Result<MotionPrior, Error> {
    let Some(model) = &settings.motion_model else {
        return Ok(MotionPrior::Walk(walk(setup, tree, settings)?));
    };
    check_model(model, tree, settings.fps)?;
    let motion = PrimitiveMotion::new(model, WHOLE_BODY, 1.0 / settings.fps, settings.isa)
        .and_then(|motion| motion.with_between(settings.between).with_initial_sd(motion_noise::initial_sd(tree)));
    Ok(MotionPrior::Primitives(motion.map_err(TrackError::Motion)?))
}

/// What a model in a file was learned of.
struct LearnedOf<'a> {
    format: ModelFormat,
    state: &'a str,
    dim: usize,
    frame_rate: f64,
}

/// Refuses a model of another body or another frame rate.
fn check_body(learned_of: &LearnedOf<'_>, tree: &KinematicTree, fps: f64) -> Result<(), TrackError> {
    let LearnedOf { format, state, dim, frame_rate } = *learned_of;
    let learned = match state {
        "h32" => Some(h32(&Proportions::default())),
        "cf28" => Some(cf28(&Proportions::default())),
        "hppf24" => Some(hppf24::tree(1.0)),
        "hapf31" => Some(hapf31::sized(&Proportions::default())),
        _ => None,
    };
    let is_same = learned.is_some_and(|learned| learned.dof_names() == tree.dof_names()) && dim == tree.dof();
    if !is_same {
        return Err(TrackError::ModelBody { format, learned: state.to_owned() });
    }
    let off = (fps / frame_rate - 1.0).abs();
    if off.is_nan() || off > SAME_RATE {
        return Err(TrackError::ModelRate { format, learned: frame_rate, tracked: fps });
    }
    Ok(())
}

/// Refuses a motion model of another body, another frame rate, or without the whole body's angles.
///
/// # Errors
/// [`TrackError::ModelBody`], [`TrackError::ModelRate`], [`TrackError::Motion`].
pub fn check_model(model: &PrimitiveModel, tree: &KinematicTree, fps: f64) -> Result<(), TrackError> {
    let PrimitiveModel { state, dim, frame_rate, .. } = model;
    check_body(&LearnedOf { format: FORMAT, state, dim: *dim, frame_rate: *frame_rate }, tree, fps)?;
    if model.find(WHOLE_BODY).is_none() {
        let known = model.primitives.iter().map(|primitives| primitives.feature.name.clone()).collect();
        return Err(sinew_dynamics::Error::Unknown { name: WHOLE_BODY.into(), known }.into());
    }
    Ok(())
}

/// Refuses a latent model of another body or frame rate.
///
/// # Errors
/// [`TrackError::ModelBody`], [`TrackError::ModelRate`].
pub fn check_latent_model(stored: &StoredModel, tree: &KinematicTree, fps: f64) -> Result<(), TrackError> {
    let StoredModel { state, frame_rate, free, model, .. } = stored;
    // The model may end before the state does.
    let (format, dim) = (sinew_latent::file::FORMAT, tree.dof().max(free + model.columns));
    check_body(&LearnedOf { format, state, dim, frame_rate: *frame_rate }, tree, fps)
}

/// A state with its angles turned by whole turns to those nearest to the mean motion of a model.
pub(super) fn turned_near(
    motion_model: Option<&PrimitiveModel>,
    latent: Option<&StoredModel>,
    tree: &KinematicTree,
    mut state: Vec<f64>,
) -> Vec<f64> {
    let primitives = motion_model.and_then(|model| model.find(WHOLE_BODY));
    let from_motion =
        primitives.map(|known| known.feature.coordinates.iter().copied().zip(known.pca.mean.iter().copied()));
    let from_latent = latent.map(|stored| (stored.free..).zip(stored.model.standard.mean.iter().copied()));
    let joints: Vec<Joint> = tree.joints().map(|(_, joint)| joint).collect();
    for (j, mean) in from_motion.into_iter().flatten().chain(from_latent.into_iter().flatten()) {
        if matches!(joints.get(j), Some(Joint::Rotate(_))) {
            state[j] -= TAU * ((state[j] - mean) / TAU).round();
        }
    }
    state
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_dynamics::pca::Pca;
    use sinew_dynamics::primitives::model::{Clustering, FeatureVector, Primitives};

    fn model(body: &str, dim: usize) -> PrimitiveModel {
        let feature = FeatureVector { name: WHOLE_BODY.into(), coordinates: (6..dim).collect() };
        let pca = Pca { mean: vec![0.5; dim - 6], components: vec![], variances: vec![], total: 1.0 };
        let clustering = Clustering { requested: 1, components: 1, ..Clustering::default() };
        let primitives = vec![Primitives { feature, pca, clusters: vec![], transitions: vec![], clustering }];
        let state = body.to_owned();
        PrimitiveModel { state, dim, frame_rate: 20.0, length: 1, noise_sd: vec![0.1; dim], primitives }
    }

    #[test]
    fn models_of_another_body_or_rate_are_refused() {
        let tree = h32(&Proportions::default());
        assert!(check_model(&model("h32", 32), &tree, 20.1).is_ok());
        for other in [model("cf28", 28), model("hppf24", 24), model("horse", 32), model("h32", 31)] {
            let error = check_model(&other, &tree, 20.0).unwrap_err();
            assert!(matches!(error, TrackError::ModelBody { .. }), "{error}");
        }
        let error = check_model(&model("h32", 32), &tree, 30.0).unwrap_err();
        assert_eq!(error.to_string(), "the motion model was learned at 20 frames per second; the recording has 30");
        let mut without = model("h32", 32);
        without.primitives[0].feature.name = "head".into();
        assert!(matches!(check_model(&without, &tree, 20.0), Err(TrackError::Motion(_))));
    }

    #[test]
    fn starts_are_turned_near_the_training_motion() {
        let tree = h32(&Proportions::default());
        let found = turned_near(Some(&model("h32", 32)), None, &tree, vec![3.0 + TAU; 32]);
        assert_eq!(found[..6], [3.0 + TAU; 6]);
        assert!(found[6..].iter().all(|x| (x - 3.0).abs() < 1e-12), "{found:?}");
    }
}
