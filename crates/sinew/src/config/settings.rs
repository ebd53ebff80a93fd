//! How a recording is tracked.

use super::common::{
    ANGLES, ASSUMED_FPS, DEGREES, DRAWS, FPS, INIT, KAPPA, KEYPOINTS, LATENT, LEAST_CONFIDENCE, MOTION_MODEL,
    MOTION_SCALE, NOISE, NoiseShape, OUTLIER, PERSON, PRIOR, RASTER, SCORE, SEED, SETUP, SIMD, STATIC,
};
use super::resolved::Resolved;
use super::setting::SettingValues;
use super::table::METHOD;
use crate::methods::Method;
use crate::track::error::TrackError;
use crate::{Error, files};
use sinew_angles::Convention;
use sinew_core::lanes::Isa;
use sinew_dynamics::primitives::file;
use sinew_dynamics::primitives::model::PrimitiveModel;
use sinew_dynamics::random_walk::Between;
use sinew_latent::file::StoredModel;
use sinew_observe::Noise;
use sinew_observe::silhouettes::image_score::ImageScore;
use sinew_results::standing_trial::StandingTrial;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How to track, complete; the default is the preset for real recordings.
#[derive(Clone, Debug)]
pub struct Settings {
    /// The method with its own settings.
    pub method: Arc<dyn Method>,
    /// Seed of all random streams.
    pub seed: u64,
    /// Frames per second; [`ASSUMED_FPS`] where nobody gave them.
    pub fps: f64,
    /// Instruction set.
    pub isa: Isa,
    /// Density of a keypoint.
    pub noise: Noise,
    /// Keypoints of lower confidence count as missing.
    pub least_confidence: f64,
    /// Prior between frames.
    pub between: Between,
    /// Factor on the motion noise that the set-up pass found.
    pub motion_scale: f64,
    /// Learned motion model that takes the place of the random walk.
    pub motion_model: Option<Arc<PrimitiveModel>>,
    /// Latent model of the body's poses.
    pub latent_model: Option<Arc<StoredModel>>,
    /// Weighting function of images.
    pub score: ImageScore,
    /// Longest side of the raster in which silhouettes are compared, pixels.
    pub raster: usize,
    /// Whose definitions the angles of joints follow.
    pub angles: Convention,
    /// Run of a trial in which the person stands: the zero of the angles.
    pub standing: Option<Arc<StandingTrial>>,
    /// Thinned draws kept of each frame.
    pub draws: usize,
    /// Whether the set-up is that of an earlier run, which advice depends on.
    pub setup_is_given: bool,
    /// Number by which the person was chosen, which advice depends on.
    pub person: Option<usize>,
}

impl Settings {
    /// Whether the colours of pictures are compared: by scores that do, which methods with gradients do not use.
    #[must_use]
    pub fn compares_colours(&self) -> bool {
        self.score.compares_colours() && !self.method.about().needs_gradients
    }
}

/// As a run has them for which nobody set anything.
impl Default for Settings {
    fn default() -> Self {
        Self::without_files(&SettingValues::default(), Isa::best(), true)
    }
}

impl Resolved {
    /// How frames are tracked, with the models that the settings name.
    ///
    /// # Errors
    /// [`TrackError::NoInstructionSet`]; a motion model, latent model or standing trial that cannot be read.
    pub fn settings(&self) -> Result<Settings, Error> {
        let keypoints = self.of(&KEYPOINTS).is_some() || self.given.is_some();
        let beside_keypoints = keypoints && self.of(&INIT).is_none();
        let settings = Settings::without_files(&self.values, self.instruction_set()?, beside_keypoints);
        let trial = |folder: PathBuf| StandingTrial::read(&folder, settings.angles).map(Arc::new);
        Ok(Settings {
            motion_model: self.of(&MOTION_MODEL).map(|path| motion_model(&path)).transpose()?,
            latent_model: self.of(&LATENT).map(|path| latent_model(&path)).transpose()?,
            standing: self.of(&STATIC).map(trial).transpose()?,
            ..settings
        })
    }

    /// The instruction set that was asked for, or the best of this processor.
    ///
    /// # Errors
    /// [`TrackError::NoInstructionSet`].
    pub fn instruction_set(&self) -> Result<Isa, TrackError> {
        let Some(asked) = self.of(&SIMD) else { return Ok(Isa::best()) };
        Isa::by_name(&asked).ok_or_else(|| {
            let available = Isa::available().into_iter().map(Isa::name).collect();
            TrackError::NoInstructionSet { asked, available }
        })
    }
}

impl Settings {
    /// The settings of a run that names no models. Images have another score beside keypoints.
    fn without_files(values: &SettingValues, isa: Isa, beside_keypoints: bool) -> Self {
        let about = values.of(&METHOD);
        let usual_score = if beside_keypoints { about.score_beside_keypoints } else { about.score };
        Self {
            method: (about.configure)(values),
            seed: values.of(&SEED),
            fps: values.of(&FPS).unwrap_or(ASSUMED_FPS),
            isa,
            noise: match values.of(&NOISE) {
                NoiseShape::Floor => Noise::OutlierFloor { outlier: values.of(&OUTLIER) },
                NoiseShape::StudentT => Noise::StudentT { degrees: values.of(&DEGREES) },
            },
            least_confidence: values.of(&LEAST_CONFIDENCE),
            between: values.of(&PRIOR),
            motion_scale: values.of(&MOTION_SCALE),
            motion_model: None,
            latent_model: None,
            score: values.of(&SCORE).unwrap_or(usual_score).with_kappa(values.of(&KAPPA)),
            raster: values.of(&RASTER),
            angles: values.of(&ANGLES),
            standing: None,
            draws: values.of(&DRAWS),
            setup_is_given: values.of(&SETUP).is_some(),
            person: values.of(&PERSON),
        }
    }
}

/// The latent model in a file.
fn latent_model(path: &Path) -> Result<Arc<StoredModel>, Error> {
    let text = files::read_text(path, sinew_latent::file::MAX_BYTES)?;
    let name = path.display().to_string();
    Ok(Arc::new(sinew_latent::file::read(&name, &text).map_err(TrackError::LatentModel)?))
}

/// The motion model in a file.
///
/// # Errors
/// A file that cannot be read or is no motion model.
pub fn motion_model(path: &Path) -> Result<Arc<PrimitiveModel>, Error> {
    let text = files::read_text(path, file::MAX_BYTES)?;
    Ok(Arc::new(file::read(&path.display().to_string(), &text).map_err(TrackError::MotionModel)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::common::PARTICLES;
    use crate::config::setting::{Setting, SettingKind, Value};
    use crate::config::table::settings;
    use crate::config::value::to_text;
    use crate::config::{Sources, resolve};
    use crate::methods::METHODS;

    /// Values besides the default, as they would be typed.
    fn others(setting: &Setting) -> Vec<String> {
        let usual = setting.default.as_ref();
        let other = match (setting.kind, usual) {
            (SettingKind::Choice(names), _) => return names.iter().map(|name| (*name).to_owned()).collect(),
            (SettingKind::Count(least, _), None) => least.to_string(),
            (SettingKind::Count(..), Some(Value::Count(usual))) => (usual + 1).to_string(),
            (SettingKind::Number { .. }, Some(Value::Number(usual))) => (usual + 0.01).to_string(),
            (SettingKind::Number { .. }, _) => "2".to_owned(),
            (SettingKind::Flag, Some(Value::Flag(usual))) => (!usual).to_string(),
            (SettingKind::Frames, _) => "3..7".to_owned(),
            (SettingKind::Lags, _) => "a=1".to_owned(),
            (SettingKind::Direction, _) => "0,-1,0.2".to_owned(),
            (_, usual) => format!("{}-other.toml", usual.map(to_text).unwrap_or_default()),
        };
        vec![other]
    }

    /// What a run gets of some settings: files that are not there are named by the error.
    fn gets(given: &[(&'static str, String)]) -> String {
        let resolved = resolve(&Sources { flags: given.to_vec(), ..Sources::default() }).unwrap();
        let method = (resolved.method().configure)(&resolved.values);
        format!("{:?} {:?} {method:?}", resolved.track(), resolved.settings())
    }

    #[test]
    fn every_setting_changes_what_a_run_gets() {
        for setting in settings() {
            let owner = METHODS.iter().find(|about| about.settings.iter().any(|own| own.row().key == setting.key));
            let mut beside = vec![];
            match owner {
                Some(owner) => beside.extend([(METHOD.key, owner.name), (LATENT.key, "model.json")]),
                None if setting.key == PARTICLES.key => beside.push((METHOD.key, "bootstrap")),
                None if setting.key == DEGREES.key => beside.push((NOISE.key, "student-t")),
                None => {}
            }
            let beside: Vec<_> = beside.into_iter().map(|(key, text)| (key, text.to_owned())).collect();
            let usual = gets(&beside);
            let arrives = |text: String| gets(&[&beside[..], &[(setting.key, text)]].concat()) != usual;
            assert!(others(setting).into_iter().any(arrives), "`{}` changes nothing", setting.key);
        }
    }
}
