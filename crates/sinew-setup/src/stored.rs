//! The value of the set-up pass and its file, `setup.toml`.
//!
//! `body` is `"H32"`, `"CF28"`, `"HPPF24"`, `"HAPF31"`, or the whole text of a body file, so that the set-up repeats a run when that file is gone.

use super::colours::MeasuredColours;
use super::girth::MeasuredGirth;
use super::lasting_errors::MeasuredErrors;
use super::lasting_prior::stands_for_no_joint;
use super::setup_error::SetupError;
use crate::Error;
use serde::{Deserialize, Serialize};
use sinew_body::flesh::Flesh;
use sinew_body::standard::{cf28, h32};
use sinew_body::standard_flesh::standard_flesh;
use sinew_body::{KinematicTree, Point, Proportions, hapf31, hppf24};
use sinew_formats::{body_file, body_toml};
use sinew_input::Problems;
use sinew_observe::cameras::camera_error::with_error;
use sinew_observe::{Camera, View};

/// Version of the file's structure.
pub const SCHEMA: u32 = 2;

/// A body by name or from a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Body {
    /// The standard body for real people, 32 degrees of freedom.
    #[default]
    H32,
    /// The body of Choo & Fleet (2001), 28 degrees of freedom.
    CF28,
    /// The body of Husz, Wallace & Green (2007), 24 degrees of freedom.
    HPPF24,
    /// The body of Raskin, Rudzsky & Rivlin (2011), 31 degrees of freedom.
    HAPF31,
    /// The body of a file, with the sizes that it has there.
    File(FileBody),
}

/// A body file.
#[derive(Clone, Debug, PartialEq)]
pub struct FileBody {
    text: String,
    tree: KinematicTree,
    flesh: Option<Flesh>,
}

impl FileBody {
    /// Reads a body file; `name` is that of the file, for messages.
    ///
    /// # Errors
    /// A text that is no body.
    pub fn read(name: &str, text: &str) -> Result<Self, Error> {
        let body_toml::BodyDefinition { tree, flesh } = body_file::read(name, text)?;
        Ok(Self { tree, flesh, text: text.into() })
    }

    /// The body.
    #[must_use]
    pub const fn tree(&self) -> &KinematicTree {
        &self.tree
    }
}

impl Body {
    /// What builds a standard body from the subject's sizes. The subject of HPPF24 and HAPF31, which have few points, and of a body file is measured with H32: sizes show whether the units are right and
    /// what is missing; these two take them, and a body of a file keeps its own.
    #[must_use]
    pub const fn builder(&self) -> fn(&Proportions) -> KinematicTree {
        match self {
            Self::H32 | Self::HPPF24 | Self::HAPF31 | Self::File(_) => h32,
            Self::CF28 => cf28,
        }
    }

    /// The body that is tracked.
    #[must_use]
    pub fn tree(&self, proportions: &Proportions) -> KinematicTree {
        match self {
            Self::File(body) => body.tree.clone(),
            Self::H32 | Self::CF28 => self.builder()(proportions),
            Self::HPPF24 => hppf24::sized(proportions),
            Self::HAPF31 => hapf31::sized(proportions),
        }
    }

    /// The solids of the body that is tracked: the solids of its file, the papers' of HPPF24 and HAPF31, else the standard flesh of its [`Body::tree`].
    ///
    /// # Errors
    /// A body of a file without solids whose links have none of the standard names.
    pub fn flesh(&self, tree: &KinematicTree) -> Result<Flesh, SetupError> {
        match self {
            Self::File(FileBody { flesh: Some(flesh), .. }) => Ok(flesh.clone()),
            Self::HPPF24 => hppf24::flesh_on(tree).map_err(SetupError::NoFlesh),
            Self::HAPF31 => hapf31::flesh_on(tree).map_err(SetupError::NoFlesh),
            _ => standard_flesh(tree).map_err(SetupError::NoFlesh),
        }
    }

    /// Whether it brings solids of its own, which stay as they are.
    #[must_use]
    pub const fn has_solids(&self) -> bool {
        matches!(self, Self::File(FileBody { flesh: Some(_), .. }))
    }

    /// Whether the subject is measured with this body itself.
    #[must_use]
    pub const fn is_measured(&self) -> bool {
        matches!(self, Self::H32 | Self::CF28)
    }

    /// Name for messages.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::H32 => "H32",
            Self::CF28 => "CF28",
            Self::HPPF24 => "HPPF24",
            Self::HAPF31 => "HAPF31",
            Self::File(_) => "the body of the file",
        }
    }
}

impl From<Body> for String {
    fn from(body: Body) -> Self {
        match body {
            Body::File(body) => body.text,
            named => named.name().into(),
        }
    }
}

impl TryFrom<String> for Body {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        match text.as_str() {
            "H32" => Ok(Self::H32),
            "CF28" => Ok(Self::CF28),
            "HPPF24" => Ok(Self::HPPF24),
            "HAPF31" => Ok(Self::HAPF31),
            _ if text.contains("[[link]]") => FileBody::read("body", &text).map(Self::File).map_err(|e| e.to_string()),
            _ => Err(format!("unknown body `{text}`; known: H32, CF28, HPPF24, HAPF31, or the text of a body file")),
        }
    }
}

/// What is constant about a camera's detections.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraSetup {
    /// Name in the calibration.
    pub name: String,
    /// Observed − projected, pixels.
    pub offset_px: [f64; 2],
    /// Standard deviation per axis of a detection of usual confidence, pixels.
    pub sigma_px: f64,
    /// Median confidence of the detections.
    pub usual_confidence: f64,
    /// Probability that left and right of arms, or legs, are exchanged in a frame.
    #[serde(default = "super::mistake_prior::usual_exchanged")]
    pub exchanged: f64,
    /// Probability that a keypoint is somebody else's, in a frame that shows others.
    #[serde(default = "super::mistake_prior::usual_elsewhere")]
    pub elsewhere: f64,
}

/// Everything that tracking needs before it streams.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Setup {
    /// Version of this structure.
    pub schema: u32,
    /// The body.
    pub body: Body,
    /// Name of the keypoint layout.
    pub layout: String,
    /// Which person, where several were shown: 0 is the most complete one at the start.
    pub person: usize,
    /// Axis or direction `X,Y,Z` of the calibration's world that points up, as declared or found; the set-up is that of the world turned to z up.
    #[serde(default = "z_up")]
    pub world_up: String,
    /// Standard deviation of `world_up` about each horizontal axis, degrees, where the person showed it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub world_up_sd_deg: Option<f64>,
    /// World axis that points from feet to head, as found: `+z` where all is well.
    pub up_axis: String,
    /// Distance between a keypoint and the body's point, per axis, metres.
    pub model_error_m: f64,
    /// Standard deviation of the logarithm of the body's size about that of `proportions`: 0 where it was measured or given.
    #[serde(default)]
    pub size_sd: f64,
    /// Frame of `start_pose`.
    pub start_frame: u64,
    /// State of the body in that frame.
    pub start_pose: Vec<f64>,
    /// Step size of Hamiltonian Monte Carlo, once tuned.
    pub step_size: Option<f64>,
    /// Leapfrog steps of a trajectory, once tuned.
    pub leapfrog_steps: Option<u32>,
    /// Motion noise of each degree of freedom per square-root second (metres, radians), once chosen.
    pub motion_sd: Option<Vec<f64>>,
    /// Girths of the subject, where masks show them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub girth: Option<MeasuredGirth>,
    /// Sizes of the subject.
    #[serde(with = "Sizes")]
    pub proportions: Proportions,
    /// Cameras in use, in the order of the calibration.
    pub camera: Vec<CameraSetup>,
    /// Colours of the subject's parts, where pictures show them and the score compares them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub colours: Option<MeasuredColours>,
    /// What is constant over the recording and known only up to an error.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lasting: Option<MeasuredErrors>,
}

fn z_up() -> String {
    sinew_input::up_axis::Z_UP.into()
}

/// [`Proportions`] as a table.
#[derive(Serialize, Deserialize)]
#[serde(remote = "Proportions", deny_unknown_fields)]
struct Sizes {
    spine: f64,
    shoulder_height: f64,
    shoulder_half_width: f64,
    hip_half_width: f64,
    pelvis_drop: f64,
    upper_arm: f64,
    forearm: f64,
    thigh: f64,
    shin: f64,
    head_top: [f64; 3],
    nose: [f64; 3],
    eye: [f64; 3],
    ear: [f64; 3],
    heel: [f64; 3],
    big_toe: [f64; 3],
    small_toe: [f64; 3],
}

impl Setup {
    /// The body with the subject's sizes, points of head and feet where detectors see them; that of a body file as it is.
    #[must_use]
    pub fn tree(&self) -> KinematicTree {
        self.tree_of(&self.proportions)
    }

    /// The same with other sizes.
    #[must_use]
    pub fn tree_of(&self, sizes: &Proportions) -> KinematicTree {
        let tree = self.body.tree(sizes);
        let places = self.places(&tree, |point| self.follows_detectors(point));
        tree.with_points_moved(&places)
    }

    /// Whether a point of the body is where detectors see it: points of heads and feet stand for no joint.
    #[must_use]
    pub fn follows_detectors(&self, point: &str) -> bool {
        self.body.is_measured() && stands_for_no_joint(point)
    }

    /// The solids of [`Setup::tree`], as thick as the subject where that is known.
    ///
    /// # Errors
    /// As [`Body::flesh`].
    pub fn flesh(&self) -> Result<Flesh, SetupError> {
        let flesh = self.body.flesh(&self.tree())?;
        Ok(self.girth.map_or(flesh.clone(), |measured| measured.girth().applied(&flesh)))
    }

    /// What the likelihood needs to know about each camera of the set-up, without biases.
    #[must_use]
    pub fn views(&self, cameras: &[Camera]) -> Vec<View> {
        let own = |known: &CameraSetup| cameras.iter().find(|camera| camera.name == known.name);
        self.camera.iter().filter_map(own).filter_map(|camera| self.view(camera, &[])).collect()
    }

    /// A camera as the set-up found it, with the biases of its detector for the points of these names; `None` for one that the set-up does not know.
    #[must_use]
    pub fn view(&self, camera: &Camera, points: &[String]) -> Option<View> {
        let CameraSetup { sigma_px, usual_confidence, .. } =
            *self.camera.iter().find(|known| known.name == camera.name)?;
        let (as_it_is, bias_px) = (self.as_it_is(camera, 1.0), self.bias_px(camera, points));
        Some(View { camera: as_it_is, bias_px, sigma_px, usual_confidence })
    }

    /// A camera of the set-up, `scale` times the size for which its offset holds, as the set-up found it: with its error, or its offset where there is no more.
    #[must_use]
    pub fn as_it_is(&self, camera: &Camera, scale: f64) -> Camera {
        if let Some(error) = self.lasting.as_ref().and_then(|lasting| lasting.camera_error(&camera.name)) {
            return with_error(camera, &error);
        }
        let mut shifted = camera.clone();
        if let Some(known) = self.camera.iter().find(|known| known.name == camera.name) {
            shifted.intrinsics.cx += scale * known.offset_px[0];
            shifted.intrinsics.cy += scale * known.offset_px[1];
        }
        shifted
    }

    /// All of them: what they show lies where it lies in images.
    #[must_use]
    pub fn as_they_are(&self, cameras: &[Camera], scale: f64) -> Vec<Camera> {
        cameras.iter().map(|camera| self.as_it_is(camera, scale)).collect()
    }

    /// How late a camera's clock is, seconds.
    #[must_use]
    pub fn lag_s(&self, camera: &Camera) -> f64 {
        self.lasting.as_ref().map_or(0.0, |lasting| lasting.lag_s(&camera.name))
    }

    /// Biases of a camera's detector for some points, pixels.
    #[must_use]
    pub fn bias_px(&self, camera: &Camera, points: &[String]) -> Vec<[f64; 2]> {
        let Some(lasting) = &self.lasting else { return vec![] };
        let known = lasting.bias_px(camera);
        let bias = |name| known.get(lasting.points.iter().position(|point| point == name)?).copied();
        points.iter().map(|name| bias(name).unwrap_or_default()).collect()
    }

    /// How far the detectors see each point of [`Setup::tree`] from where it is, in the frame of its link, metres.
    #[must_use]
    pub fn detected_places(&self, tree: &KinematicTree) -> Vec<[f64; 3]> {
        self.places(tree, |point| !self.follows_detectors(point))
    }

    /// Places of those points of a body that are wanted; others are at 0.
    fn places(&self, tree: &KinematicTree, is_wanted: impl Fn(&str) -> bool) -> Vec<[f64; 3]> {
        let Some(lasting) = &self.lasting else { return vec![[0.0; 3]; tree.points().len()] };
        let known = lasting.places_m();
        let place = |name: &str| known.get(lasting.points.iter().position(|point| point == name)?).copied();
        let wanted = |point: &Point| is_wanted(&point.name).then(|| place(&point.name)).flatten().unwrap_or_default();
        tree.points().iter().map(wanted).collect()
    }

    /// Reads a `setup.toml`; `name` is that of the file, for messages.
    ///
    /// # Errors
    /// TOML that is malformed, unknown or missing keys, and all values that cannot be, in one message.
    pub fn from_toml(name: &str, text: &str) -> Result<Self, Error> {
        let setup = Self::parse(name, text)?;
        let problems = setup.problems();
        if problems.is_empty() { Ok(setup) } else { Err(Problems { file: name.into(), problems }.into()) }
    }

    /// As [`Setup::from_toml`], with values that cannot be.
    pub fn parse(name: &str, text: &str) -> Result<Self, Error> {
        let refused =
            |e: toml::de::Error| Problems { file: name.into(), problems: vec![e.to_string().trim_end().into()] };
        Ok(toml::from_str(text).map_err(refused)?)
    }

    /// All values that cannot be, one sentence each.
    #[must_use]
    pub fn problems(&self) -> Vec<String> {
        let mut problems = vec![];
        if self.schema != SCHEMA {
            problems.push(format!("schema = {}; this version reads {SCHEMA}: make the set-up again", self.schema));
            return problems;
        }
        let sizes = [self.proportions.spine, self.proportions.upper_arm, self.proportions.thigh, self.proportions.shin];
        if !sizes.iter().all(|x| *x > 0.0 && x.is_finite()) {
            problems.push("proportions: lengths must be positive".into());
        } else if !self.proportions.are_within(f64::MAX) {
            problems.push("proportions hold a number that is not finite".into());
        } else if !self.proportions.are_within(Proportions::LONGEST_M) {
            problems.push(format!("proportions hold a length of more than {} m", Proportions::LONGEST_M));
        } else {
            let dof = self.tree().dof();
            if self.start_pose.len() != dof {
                let found = self.start_pose.len();
                let body = self.body.name();
                problems.push(format!("start_pose has {found} numbers; {body} has {dof} degrees of freedom"));
            }
        }
        problems.extend(self.world_problem());
        if !self.start_pose.iter().all(|x| x.is_finite()) {
            problems.push("start_pose holds a number that is not finite".into());
        }
        if !(self.model_error_m >= 0.0 && self.model_error_m.is_finite()) {
            problems.push(format!("model_error_m = {}; must not be negative", self.model_error_m));
        }
        if !(0.0..1.0).contains(&self.size_sd) {
            problems.push(format!("size_sd = {}; must be at least 0 and less than 1", self.size_sd));
        }
        if let Some(problem) = self.girth.and_then(|girth| girth.problem()) {
            problems.push(problem);
        }
        let cameras: Vec<&str> = self.camera.iter().map(|camera| camera.name.as_str()).collect();
        if problems.is_empty()
            && let (Some(colours), Ok(flesh)) = (&self.colours, self.flesh())
        {
            problems.extend(colours.problem(&cameras, &flesh));
        }
        problems.extend(self.lasting.as_ref().and_then(|lasting| lasting.problem(&cameras)));
        for camera in &self.camera {
            if !(camera.sigma_px > 0.0 && camera.sigma_px.is_finite()) {
                problems.push(format!("camera `{}`: sigma_px = {}; must be positive", camera.name, camera.sigma_px));
            }
            for (key, probability) in [("exchanged", camera.exchanged), ("elsewhere", camera.elsewhere)] {
                if !(0.0..0.5).contains(&probability) {
                    let name = &camera.name;
                    problems
                        .push(format!("camera `{name}`: {key} = {probability}; must be at least 0 and less than 0.5"));
                }
            }
            if !camera.offset_px.iter().all(|x| x.is_finite()) {
                problems.push(format!("camera `{}`: offset_px is not finite", camera.name));
            }
        }
        problems
    }

    /// What is wrong with the axis or direction that points up.
    fn world_problem(&self) -> Option<String> {
        if sinew_input::up_axis::z_up_from(&self.world_up).is_none() {
            return Some(format!("world_up = {}; must be one of +x, -x, +y, -y, +z, -z, or X,Y,Z", self.world_up));
        }
        let is_odd = self.world_up_sd_deg.is_some_and(|sd| !(sd >= 0.0 && sd.is_finite()));
        is_odd.then(|| "world_up_sd_deg must be a number that is not negative".into())
    }

    /// The text of `setup.toml`.
    ///
    /// # Errors
    /// None that is known; the serialiser's are passed on.
    pub fn to_toml(&self) -> Result<String, SetupError> {
        toml::to_string(self).map_err(SetupError::Unwritable)
    }
}
