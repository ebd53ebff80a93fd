//! The first half of the set-up: follow the person and keep an evenly spaced part of the frames.
//!
//! Memory is bounded whatever the length of the recording: every n-th frame is kept, and when that becomes more than twice the wanted number every second one is
//! dropped and n doubled. The first frames are also kept without gaps, for what depends on time, and so are short windows at frames 120, 180 … 480, 960, 1920 …
//! after the first, for what changes with time.

use super::calibration_fit;
use super::exchanged_cameras;
use super::setup_error::SetupError;
use super::stored::Body;
use super::warning::SetupWarning;
use sinew_formats::Layout;
use sinew_input::lag::ClockLag;
use sinew_input::limbs::{LIMBS, limbs};
use sinew_observe::Camera;
use sinew_observe::association::following::{Following, follow};
use sinew_observe::association::{self, Person};
use sinew_observe::cameras::cross_view::cameras_behind;
use sinew_observe::cameras::offsets::{self, Sighted};
use sinew_observe::clocks::lag_estimate::CameraLag;

/// What to set up, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct SetupRequest {
    /// The body.
    pub body: Body,
    /// Which person: 0 is the most complete one at the start.
    pub person: usize,
    /// Frames kept, at most twice as many.
    pub frames: usize,
    /// Frames kept without gaps at the beginning.
    pub window: usize,
    /// Frames from which offsets are estimated.
    pub offset_frames: usize,
    /// Frames from which sizes are measured.
    pub shape_frames: usize,
    /// Size of the images over that of the calibrated ones, as declared; the cameras are resized already.
    pub image_scale: f64,
    /// How late cameras are, as declared; the frames are read with it already.
    pub lag: Vec<(String, ClockLag)>,
    /// How late cameras are, as everybody in view shows; found from the one person if `None`.
    pub lags_of_all: Option<Vec<CameraLag>>,
    /// Frames per second, by which speeds are judged; nothing is said about them if `None`.
    pub fps: Option<f64>,
    /// Whether sizes and speeds that no person has are taken.
    pub any_size: bool,
    /// How people are distinguished.
    pub association: association::Config,
    /// How offsets are estimated.
    pub offsets: offsets::Config,
}

impl Default for SetupRequest {
    fn default() -> Self {
        Self {
            body: Body::H32,
            person: 0,
            frames: 500,
            window: 300,
            offset_frames: 150,
            shape_frames: 120,
            image_scale: 1.0,
            lag: vec![],
            lags_of_all: None,
            fps: None,
            any_size: false,
            association: association::Config::default(),
            offsets: offsets::Config::default(),
        }
    }
}

/// The tracked person in some frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Collected {
    /// Frame numbers and what the cameras saw, evenly spaced.
    pub spread: Vec<(u64, Sighted)>,
    /// The same without gaps, from the first frame in which they were found.
    pub window: Vec<(u64, Sighted)>,
    /// Windows without gaps later in the recording.
    pub later: Vec<Vec<(u64, Sighted)>>,
    /// Everybody in some of the first frames in which several cameras show people.
    pub everybody: Vec<Vec<Vec<Person>>>,
    /// Some of the first frames in which no camera shows more than one person.
    pub alone: Vec<Sighted>,
    /// Frames read.
    pub read: u64,
    /// Frames in which they were found.
    pub found: u64,
    /// Largest number of people in one view.
    pub people: usize,
    /// For each camera, the frames in which it showed somebody.
    pub crowded: Vec<u64>,
    /// For each camera, the frames in which it showed the tracked person.
    pub matched: Vec<u64>,
}

impl Collected {
    /// What the cameras saw in at most about `most` evenly spaced frames.
    #[must_use]
    pub fn sighted(&self, most: usize) -> Vec<Sighted> {
        let stride = self.spread.len().div_ceil(most.max(1)).max(1);
        self.spread.iter().step_by(stride).map(|(_, s)| s.clone()).collect()
    }

    /// Keeps what the cameras saw in a frame where it is wanted; every `stride`-th frame is spread evenly.
    fn keep(&mut self, number: u64, sighted: Sighted, request: &SetupRequest, stride: &mut u64) {
        let first = self.window.first().map_or(number, |(first, _)| *first);
        if let Some(window) = later_window(number.saturating_sub(first)) {
            self.later.resize_with(self.later.len().max(window + 1), Vec::new);
            self.later[window].push((number, sighted.clone()));
        }
        if self.window.len() < request.window {
            self.window.push((number, sighted.clone()));
        }
        if (self.found - 1).is_multiple_of(*stride) {
            self.spread.push((number, sighted));
        }
        if self.spread.len() > 2 * request.frames.max(1) {
            let mut index = 0_usize;
            self.spread.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            *stride *= 2;
        }
    }
}

/// Frames of a later window.
const LATER_FRAMES: u64 = 60;
/// Windows up to which one follows the other; beyond, each is twice as far from the first frame as the one before.
const LATER_DENSE: u64 = 8;
/// Frames kept in which each view shows one person at most.
const ALONE: usize = 8;

/// Index of the later window of a frame that comes `since` frames after the first.
fn later_window(since: u64) -> Option<usize> {
    let number = since / LATER_FRAMES;
    match number {
        0..2 => None,
        2..=LATER_DENSE => Some(number as usize - 2),
        _ => number.is_power_of_two().then(|| (LATER_DENSE - 2 + u64::from((number / LATER_DENSE).ilog2())) as usize),
    }
}

/// What the cameras saw of the only person there is; `None` where there are more, or fewer than two cameras saw them.
#[must_use]
pub fn alone(people: &[Vec<Person>]) -> Option<Sighted> {
    let seen = people.iter().filter(|view| !view.is_empty()).count();
    let is_one = seen > 1 && people.iter().all(|view| view.len() < 2);
    is_one.then(|| people.iter().map(|view| view.first().cloned().unwrap_or_default()).collect())
}

/// Follows the person through the frames.
///
/// # Errors
/// Errors of the iterator; nobody found; a calibration that fits the keypoints only when it is read differently.
pub fn collect<E: From<SetupError>>(
    cameras: &[Camera],
    layout: &Layout,
    request: &SetupRequest,
    frames: impl IntoIterator<Item = Result<(u64, Vec<Vec<Person>>), E>>,
) -> Result<Collected, E> {
    let mut following = Following { person: request.person, ..Following::default() };
    let none = vec![0; cameras.len()];
    let mut out = Collected { crowded: none.clone(), matched: none, ..Collected::default() };
    let mut stride = 1;
    let mut behind = (0, 0);
    let mut surest = 0.0_f64;
    for frame in frames {
        let (number, people) = frame?;
        out.read += 1;
        out.people = out.people.max(people.iter().map(Vec::len).max().unwrap_or(0));
        for (count, people) in out.crowded.iter_mut().zip(&people) {
            *count += u64::from(!people.is_empty());
        }
        let confidences = people.iter().flatten().flatten().flatten().map(|d| d.confidence);
        surest = confidences.fold(surest, f64::max);
        if out.alone.len() < ALONE {
            out.alone.extend(alone(&people));
        }
        if out.everybody.len() < ALONE && people.iter().filter(|view| !view.is_empty()).count() > 1 {
            out.everybody.push(people.clone());
        }
        let associated = follow(&mut following, cameras, &people, None, &request.association);
        if !associated.is_present() {
            if behind.0 == 0 && out.found == 0 {
                behind = cameras_behind(cameras, &people);
            }
            continue;
        }
        out.found += 1;
        for (count, person) in out.matched.iter_mut().zip(&associated.people) {
            *count += u64::from(!person.is_empty());
        }
        if following.lengths.is_empty() {
            following.lengths = limb_lengths(cameras, layout, &associated.people, &request.association);
        }
        out.keep(number, associated.people, request, &mut stride);
    }
    exchanged_cameras::check(cameras, &out.everybody, &request.association)?;
    calibration_fit::check(cameras, &out.alone, request.image_scale)?;
    if out.found == 0 {
        return Err(nobody(cameras, layout, request, &out, behind, surest).into());
    }
    Ok(out)
}

/// Lengths of the limbs that a frame shows, once there are several; for [`Following::lengths`].
#[must_use]
pub fn limb_lengths(
    cameras: &[Camera],
    layout: &Layout,
    people: &[Person],
    config: &association::Config,
) -> Vec<(usize, usize, f64)> {
    let views: Vec<Vec<Person>> = people.iter().map(|p| vec![p.clone()]).collect();
    let members: Vec<Option<usize>> = people.iter().map(|p| (!p.is_empty()).then_some(0)).collect();
    let points = association::triangulated(cameras, &views, &members, config);
    let at = |k: usize| points.get(k).copied().flatten();
    let lengths: Vec<(usize, usize, f64)> = limbs(layout)
        .into_iter()
        .filter_map(|(i, j)| {
            let (a, b) = (at(i)?, at(j)?);
            Some((i, j, (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()))
        })
        .collect();
    if 2 * lengths.len() >= LIMBS.len() { lengths } else { vec![] }
}

fn nobody(
    cameras: &[Camera],
    layout: &Layout,
    request: &SetupRequest,
    out: &Collected,
    behind: (usize, usize),
    surest: f64,
) -> SetupError {
    let frames = out.read;
    if out.people > 0 && surest < request.offsets.least_confidence {
        SetupError::Unsure { surest, least: request.offsets.least_confidence }
    } else if cameras.len() > 1 && 2 * behind.0 >= behind.1.max(1) {
        SetupError::Behind(SetupWarning::Behind { cameras: behind.0, of: behind.1, names: vec![] })
    } else if out.people == 0 {
        SetupError::Nobody { frames }
    } else if request.person > 0 {
        SetupError::NoSuchPerson { person: request.person, frames }
    } else if cameras.len() > 1 {
        SetupError::NoAgreement { cameras: cameras.len(), frames }
    } else {
        SetupError::TooFewKeypoints { layout: layout.name.clone(), frames }
    }
}
