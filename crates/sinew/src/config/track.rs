//! The settings of a tracking run as one plain value.

use super::resolved::Resolved;
use super::settings::Settings;
use super::value::Value;
use super::values::Origin;
use crate::methods::Score;
use crate::track::error::TrackError;
use crate::{Error, files};
use sinew_angles::Convention;
use sinew_core::lanes::Isa;
use sinew_dynamics::primitives::file;
use sinew_dynamics::primitives::model::PrimitiveModel;
use sinew_dynamics::random_walk::Between;
use sinew_input::footage::{FootageFiles, Init};
use sinew_input::lag::ClockLag;
use sinew_input::recording::given::GivenRecording;
use sinew_input::recording::read_frames::ReadFrames;
use sinew_latent::file::StoredModel;
use sinew_observe::Noise;
use sinew_results::standing_trial::StandingTrial;
use sinew_setup::KnownSetup;
use sinew_setup::shared_cameras::SharedCameras;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Settings of a tracking run.
#[derive(Clone, Debug)]
pub struct TrackConfig {
    /// Calibration file.
    pub calibration: Option<PathBuf>,
    /// Keypoint folder or file.
    pub keypoints: Option<PathBuf>,
    /// Cameras and keypoints in memory, in place of these two.
    pub given: Option<Arc<GivenRecording>>,
    /// Folder of masks.
    pub silhouettes: Option<PathBuf>,
    /// Folder of images.
    pub images: Option<PathBuf>,
    /// Size of the masks over that of the calibrated images; that of the keypoints' images if `None`.
    pub mask_scale: Option<f64>,
    /// Where tracking from silhouettes alone begins.
    pub init: Option<Init>,
    /// Name of a layout or path of a mapping file.
    pub layout: Option<String>,
    /// Confidence that means certainty.
    pub confidence_scale: f64,
    /// Size of the images over that of the calibrated ones.
    pub image_scale: f64,
    /// Frames to track.
    pub frames: Option<Range<u64>>,
    /// Frames per second.
    pub fps: Option<f64>,
    /// Cameras to use.
    pub cameras: Option<Vec<String>>,
    /// Whether sizes and speeds that no person has are taken.
    pub any_size: bool,
    /// Frames that cameras are late.
    pub lag: Vec<(String, ClockLag)>,
    /// Whether everybody is tracked whom two cameras see.
    pub everybody: bool,
    /// Number of the person to track, from 1 on in the order of coming; of the most complete at the start where nobody can be followed beforehand.
    pub person: Option<usize>,
    /// Who is tracked.
    pub subject: Option<String>,
    /// Whether cameras may begin and end apart.
    pub trim: bool,
    /// Axis of the calibration's world that points up; `+z`, or what the set-up says, if `None`.
    pub up_axis: Option<String>,
    /// Direction of the calibration's world that points up, or `auto`, in place of an axis.
    pub up: Option<String>,
    /// `h32`, `cf28`, `hppf24`, `hapf31` or the path of a body file.
    pub body: String,
    /// Set-up of an earlier run.
    pub setup: Option<PathBuf>,
    /// What the passes of a run have read of keypoints.
    pub read_before: Arc<ReadFrames>,
    /// What that file holds, where it was read before.
    pub known_setup: Option<Arc<KnownSetup>>,
    /// Cameras that other recordings share.
    pub shared_cameras: Option<Arc<SharedCameras>>,
    /// Frames for the set-up pass.
    pub setup_frames: Option<Range<u64>>,
    /// Learned motion model.
    pub motion_model: Option<PathBuf>,
    /// Latent model of poses.
    pub latent: Option<PathBuf>,
    /// Result folder of a standing trial.
    pub standing: Option<PathBuf>,
    /// Whether a backward pass follows.
    pub smooth: bool,
    /// Frames after its own that every frame sees.
    pub lag_frames: u64,
    /// How frames are tracked; instruction set and frame rate are not settled yet ([`TrackConfig::settings`]).
    pub tracking: Settings,
    /// Instruction set; the best if `None`.
    pub simd: Option<String>,
    /// Threads; as many as the system grants if `None`.
    pub threads: Option<usize>,
    /// Where diagnostics fail.
    pub limits: sinew_results::Limits,
    /// Output folder.
    pub out: PathBuf,
    /// Seconds between checkpoints.
    pub checkpoint_every: f64,
    /// Whether results there may be replaced.
    pub force: bool,
}

impl Resolved {
    /// The settings of a tracking run.
    #[must_use]
    pub fn track(&self) -> TrackConfig {
        let trial = self.trial_folder().and_then(|folder| Some(folder.file_name()?.to_string_lossy().into_owned()));
        let default_out = || Path::new("sinew-out").join(trial.clone().unwrap_or_else(|| "trial".into()));
        TrackConfig {
            calibration: self.values.path("calibration"),
            keypoints: self.values.path("keypoints"),
            given: self.given.clone(),
            silhouettes: self.values.path("silhouettes"),
            images: self.values.path("images"),
            mask_scale: self.values.number("mask_scale"),
            init: match (self.values.path("init"), self.values.text("init").as_deref()) {
                (Some(path), _) => Some(Init::Points(path)),
                (None, Some(_)) => Some(Init::Keypoints),
                (None, None) => None,
            },
            layout: self.values.text("layout"),
            confidence_scale: self.values.number("confidence_scale").unwrap_or(1.0),
            image_scale: self.values.number("image_scale").unwrap_or(1.0),
            frames: self.values.frames("frames"),
            fps: self.values.number("fps"),
            cameras: match self.values.get("cameras") {
                Some(Value::Names(names)) => Some(names.clone()),
                _ => None,
            },
            any_size: self.values.flag("any_size"),
            lag: match self.values.get("lag") {
                Some(Value::Lags(lags)) => lags.clone(),
                _ => vec![],
            },
            person: self.values.count("person").and_then(|person| usize::try_from(person).ok()),
            everybody: self.tracks_everybody(),
            subject: self.values.text("subject"),
            trim: self.values.flag("trim"),
            up_axis: self.values.text("up_axis"),
            up: self.values.text("up"),
            body: self.values.text("body").unwrap_or_default(),
            setup: self.values.path("setup"),
            read_before: Arc::clone(&self.read_before),
            known_setup: self.known_setup.clone(),
            shared_cameras: self.shared_cameras.clone(),
            setup_frames: self.values.frames("setup_frames"),
            motion_model: self.values.path("motion_model"),
            latent: self.values.path("latent"),
            standing: self.values.path("static"),
            smooth: self.values.flag("smooth"),
            lag_frames: self.values.count("lag_frames").unwrap_or_default(),
            tracking: self.settings(),
            simd: self.values.text("simd"),
            threads: self.values.count("threads").map(|threads| usize::try_from(threads).unwrap_or(usize::MAX)),
            limits: sinew_results::Limits {
                r_hat: self.values.number("max_r_hat").unwrap_or(f64::INFINITY),
                r_hat_share: self.values.number("max_r_hat_share").unwrap_or(1.0),
                divergent_share: self.values.number("max_divergent_share").unwrap_or(1.0),
                ess: self.values.number("min_ess").unwrap_or_default(),
            },
            out: self.values.path("out").unwrap_or_else(default_out),
            checkpoint_every: self.values.number("checkpoint_every").unwrap_or_default(),
            force: self.values.flag("force"),
        }
    }

    /// Whether nothing says that it is one person: neither a choice nor what is of one.
    fn tracks_everybody(&self) -> bool {
        let is_all = self.values.text("people").as_deref() == Some("all");
        is_all && self.values.get("person").is_none() && self.single_person_setting().is_none()
    }

    /// The setting, if any, whose value is of one person: a set-up, a standing trial, masks, a start or a name.
    #[must_use]
    pub fn single_person_setting(&self) -> Option<&'static str> {
        ["setup", "silhouettes", "init", "static", "subject"].into_iter().find(|key| self.values.get(key).is_some())
    }

    /// The same run into another folder.
    #[must_use]
    pub fn into_folder(&self, folder: &Path) -> Self {
        let mut other = self.clone();
        other.values.of.insert("out", (Value::Path(folder.to_owned()), Origin::Flag));
        other
    }

    /// The run of one of several people, by their number, into a folder of their own.
    #[must_use]
    pub fn for_person(&self, number: usize, folder: &Path) -> Self {
        let mut other = self.into_folder(folder);
        other.values.of.insert("person", (Value::Count(number as u64), Origin::Flag));
        other
    }

    /// How frames are tracked, on the best instruction set and at the default rate.
    fn settings(&self) -> Settings {
        let (about, values) = (self.method(), &self.values);
        let begins_only = values.get("init").is_some();
        let beside_keypoints = (values.get("keypoints").is_some() || self.given.is_some()) && !begins_only;
        let usual_score = if beside_keypoints { about.score_beside_keypoints } else { about.score };
        let score = values.text("score").and_then(|name| Score::named(&name)).unwrap_or(usual_score);
        let usual = Settings::default();
        Settings {
            method: (about.configure)(values),
            seed: values.count("seed").unwrap_or(usual.seed),
            noise: match values.text("noise").as_deref() {
                Some("student-t") => Noise::StudentT { degrees: values.number("degrees").unwrap_or(f64::INFINITY) },
                _ => values.number("outlier").map_or(usual.noise, |outlier| Noise::OutlierFloor { outlier }),
            },
            least_confidence: values.number("least_confidence").unwrap_or(usual.least_confidence),
            between: match values.text("prior").as_deref() {
                Some("mixture") => Between::Mixture,
                _ => Between::Gaussian,
            },
            motion_scale: values.number("motion_scale").unwrap_or(usual.motion_scale),
            score: values.number("kappa").map_or(usual.score, |kappa| score.with_kappa(kappa)),
            raster: values.size_or("raster", usual.raster),
            angles: values.text("angles").and_then(|name| Convention::named(&name)).unwrap_or_default(),
            draws: values.size_or("draws", usual.draws),
            setup_is_given: values.path("setup").is_some(),
            person: values.count("person").and_then(|person| usize::try_from(person).ok()),
            ..usual
        }
    }
}

/// Frame rate taken where none is given.
pub const DEFAULT_FPS: f64 = 30.0;

impl TrackConfig {
    /// The files to be read, with the calibration file that was named or found.
    #[must_use]
    pub fn files<'a>(&'a self, calibration: &'a Path) -> FootageFiles<'a> {
        let method = self.tracking.method.about();
        FootageFiles {
            calibration,
            keypoints: self.keypoints.as_deref(),
            given: self.given.as_deref(),
            silhouettes: self.silhouettes.as_deref(),
            images: self.images.as_deref(),
            mask_scale: self.mask_scale,
            init: self.init.as_ref(),
            has_setup: self.setup.is_some(),
            needs_gradients: method.needs_gradients.then_some(method.name),
        }
    }

    /// How frames are tracked.
    ///
    /// # Errors
    /// [`TrackError::NoInstructionSet`]; a motion model or latent model that cannot be read.
    pub fn settings(&self) -> Result<Settings, Error> {
        let isa = match &self.simd {
            None => Isa::best(),
            Some(name) => Isa::by_name(name).ok_or_else(|| {
                let available = Isa::available().into_iter().map(Isa::name).collect();
                TrackError::NoInstructionSet { asked: name.clone(), available }
            })?,
        };
        let motion_model = self.motion_model.as_deref().map(read_model).transpose()?;
        let latent_model = self.latent.as_deref().map(read_latent).transpose()?;
        let fps = self.fps.unwrap_or(DEFAULT_FPS);
        let read = |folder| StandingTrial::read(folder, self.tracking.angles).map(Arc::new);
        let standing = self.standing.as_deref().map(read).transpose()?;
        Ok(Settings { isa, fps, motion_model, latent_model, standing, ..self.tracking.clone() })
    }
}

/// The latent model in a file.
fn read_latent(path: &Path) -> Result<Arc<StoredModel>, Error> {
    let text = files::read_text(path, sinew_latent::file::MAX_BYTES)?;
    let name = path.display().to_string();
    Ok(Arc::new(sinew_latent::file::read(&name, &text).map_err(TrackError::LatentModel)?))
}

/// The motion model in a file.
fn read_model(path: &Path) -> Result<Arc<PrimitiveModel>, Error> {
    let text = files::read_text(path, file::MAX_BYTES)?;
    Ok(Arc::new(file::read(&path.display().to_string(), &text).map_err(TrackError::MotionModel)?))
}
