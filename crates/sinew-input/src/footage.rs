//! Everything that is read of a recording to be tracked, one frame at a time.
//!
//! Keypoints, masks, images, or a part of them.
//!
//! Keypoints may serve for the set-up alone ([`Init::Keypoints`]); without keypoints, points in space over time may, as another system or an earlier run has left them ([`Init::Points`]): they are seen by the calibrated cameras, as a
//! detector without errors would see them. Row k of such a file belongs to frame k, counted from the first frame that is tracked.
//!
//! Where one of several people was chosen, they alone are shown, from the first frame that a camera saw them in to the last.

use super::frame::{Frame, FrameImages};
use super::input_error::InputError;
use super::roll::Roll;
use super::source::{FrameSource, InputHashes};
use crate::pictures::{self, Pictures};
use crate::recording::given::GivenRecording;
use crate::recording::{self, Calibrated, Recording, chosen_cameras};
use crate::silhouettes::{self, Silhouettes};
use crate::{Error, files};
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_formats::{Layout, layout, trc};
use sinew_observe::association::Person;
use sinew_observe::clocks::lag_estimate::CameraLag;
use sinew_observe::silhouettes::bit_image::BitImage;
use sinew_observe::{Camera, Detection, RgbImage};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Points in space over time.
struct Points {
    /// Frame of the first row.
    first: u64,
    /// Row by row, in the order of the layout.
    rows: Vec<Vec<Option<[f64; 3]>>>,
}

/// Where tracking from silhouettes alone begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Init {
    /// Keypoints, which are not used for tracking.
    Keypoints,
    /// Points in space over time, a TRC file.
    Points(PathBuf),
}

/// Files and folders of a recording to be tracked.
#[derive(Clone, Copy, Debug)]
pub struct FootageFiles<'a> {
    /// Calibration file.
    pub calibration: &'a Path,
    /// Keypoint folder.
    pub keypoints: Option<&'a Path>,
    /// Cameras and keypoints in memory, in place of these two.
    pub given: Option<&'a GivenRecording>,
    /// Folder of masks.
    pub silhouettes: Option<&'a Path>,
    /// Folder of images.
    pub images: Option<&'a Path>,
    /// Size of the masks over that of the calibrated images; that of the keypoints' images if `None`.
    pub mask_scale: Option<f64>,
    /// Where tracking from silhouettes alone begins.
    pub init: Option<&'a Init>,
    /// Whether a set-up is given, from which tracking can begin.
    pub has_setup: bool,
    /// Name of the method, if it needs gradients, which masks alone do not give.
    pub needs_gradients: Option<&'static str>,
}

/// A recording of keypoints, masks and images, of one of its people or of everybody.
pub struct Footage<'a> {
    cameras: Vec<Camera>,
    layout: Layout,
    frames: Range<u64>,
    available: Range<u64>,
    keypoints: Option<Recording>,
    points: Option<Points>,
    silhouettes: Option<Silhouettes>,
    pictures: Option<Pictures>,
    /// Whether keypoints or points are for the set-up only.
    begins_only: bool,
    warnings: Vec<String>,
    calibration_hash: u64,
    /// Who is who, and which of the roll's people is shown; everybody if `None`.
    chosen: Option<(&'a Roll, usize)>,
}

/// Layout of someone of whom no keypoints are read.
const USUAL_LAYOUT: &str = "BODY_25B";

impl<'a> Footage<'a> {
    /// Opens what the settings name: at least keypoints or masks.
    ///
    /// # Errors
    /// Errors of [`Recording::open`], [`Silhouettes::open`] and [`Pictures::open`]; nothing to track; no start for masks.
    pub fn open(files: &FootageFiles<'_>, options: &recording::RecordingOptions) -> Result<Self, Error> {
        let calibration = files.calibration;
        let begins_only = files.init.is_some();
        let mut footage = match (files.given, files.keypoints) {
            (Some(given), _) => Self::with_keypoints(Recording::given(given, options)?),
            (None, Some(keypoints)) => Self::with_keypoints(Recording::open(calibration, keypoints, options)?),
            (None, None) => Self::without_keypoints(calibration, options)?,
        };
        footage.begins_only = begins_only;
        if let Some(folder) = files.silhouettes {
            let scale = files.mask_scale.map(|scale| scale / options.image_scale);
            let names = footage.calibrated(calibration)?;
            let has_keypoints = footage.keypoints.is_some();
            let frames = if has_keypoints { Some(footage.frames.clone()) } else { options.frames.clone() };
            recording::check_lags(&options.lag, &names)?;
            let lag = options.lag.clone();
            let masks =
                silhouettes::ImageFolderOptions { scale, frames, trim: options.trim, lag, calibrated: names.clone() };
            let masks = Silhouettes::open(folder, &footage.cameras, &masks)?;
            if !has_keypoints {
                (footage.frames, footage.available) = (masks.frames(), masks.available());
            }
            if let Some(folder) = files.images {
                let frames = Some(footage.frames.clone());
                let lag = options.lag.clone();
                let images = pictures::ImageFolderOptions { scale, frames, trim: true, lag, calibrated: names };
                footage.pictures = Some(Pictures::open(folder, &footage.cameras, &images)?);
            }
            footage.silhouettes = Some(masks);
        }
        if files.silhouettes.is_some()
            && (begins_only || footage.keypoints.is_none())
            && let Some(method) = files.needs_gradients
        {
            return Err(InputError::GradientsOfSilhouettes { method }.into());
        }
        match files.init {
            Some(Init::Points(path)) => footage.begin_at(path)?,
            Some(Init::Keypoints) if footage.keypoints.is_none() => {
                return Err(InputError::InitWithoutKeypoints.into());
            }
            None if footage.keypoints.is_none() && !files.has_setup => {
                return Err(InputError::NoStart.into());
            }
            _ => {}
        }
        Ok(footage)
    }

    fn with_keypoints(recording: Recording) -> Self {
        Self {
            cameras: recording.cameras().to_vec(),
            layout: recording.layout().clone(),
            frames: recording.frames(),
            available: recording.available(),
            keypoints: Some(recording),
            points: None,
            silhouettes: None,
            pictures: None,
            begins_only: false,
            warnings: vec![],
            calibration_hash: 0,
            chosen: None,
        }
    }

    fn without_keypoints(calibration: &Path, options: &recording::RecordingOptions) -> Result<Self, Error> {
        let Calibrated { cameras, warnings, hash, .. } = Calibrated::read(calibration)?;
        let cameras = match &options.cameras {
            Some(names) => chosen_cameras(cameras, names)?,
            None => cameras,
        };
        Ok(Self {
            cameras: cameras.iter().map(|camera| camera.resized(options.image_scale)).collect(),
            layout: layout::find(USUAL_LAYOUT)?,
            frames: 0..0,
            available: 0..0,
            keypoints: None,
            points: None,
            silhouettes: None,
            pictures: None,
            begins_only: false,
            warnings,
            calibration_hash: hash,
            chosen: None,
        })
    }

    fn calibrated(&self, calibration: &Path) -> Result<Vec<String>, Error> {
        match &self.keypoints {
            Some(recording) => Ok(recording.calibrated().to_vec()),
            None => Ok(Calibrated::read(calibration)?.names),
        }
    }

    fn begin_at(&mut self, path: &Path) -> Result<(), Error> {
        let name = path.display().to_string();
        let file = trc::read(&name, &files::read_text(path, MAX_TEXT_BYTES)?)?;
        let markers = &file.header.markers;
        let layout = Layout { name: name.clone(), points: markers.iter().cloned().map(Some).collect() };
        if let Some((point, words)) = recording::lacking(&layout) {
            return Err(InputError::MarkerMissing { file: name, point, words, markers: markers.clone() }.into());
        }
        let row = |row| (0..markers.len()).map(|marker| file.point_in_world(row, marker)).collect();
        let rows: Vec<_> = (0..file.frames.len()).map(row).collect();
        // The recording's frame 0 is at time 0.
        let by_time = file.frames.first().map_or(0.0, |row| row.time_s * file.header.rate_hz).round() as u64;
        let end = by_time.saturating_add(rows.len() as u64);
        let wanted = self.frames.start;
        let reaches = (by_time..end).contains(&wanted);
        if !reaches {
            self.warnings.push(format!(
                "{name}: by its times it has frames {by_time}..{end}, and tracking begins with frame {wanted}: its first row is taken for that frame"
            ));
        }
        self.points = Some(Points { first: if reaches { by_time } else { wanted }, rows });
        (self.layout, self.keypoints) = (layout, None);
        Ok(())
    }

    /// The same recording, of which one of its people is shown if one is `chosen`.
    #[must_use]
    pub fn showing(self, chosen: Option<(&'a Roll, usize)>) -> Self {
        Self { chosen, ..self }
    }

    /// Frames from which a set-up may take others than those to be tracked.
    #[must_use]
    pub fn available(&self) -> Range<u64> {
        match &self.points {
            Some(points) => {
                self.frames.start..self.frames.end.min(points.first.saturating_add(points.rows.len() as u64))
            }
            None => self.available.clone(),
        }
    }

    /// Files and folders that the recording is read from.
    #[must_use]
    pub fn folders(&self) -> Vec<PathBuf> {
        let keypoints = self.keypoints.iter().flat_map(Recording::folders);
        let masks = self.silhouettes.iter().flat_map(Silhouettes::folders);
        keypoints.chain(masks).chain(self.pictures.iter().flat_map(Pictures::folders)).collect()
    }

    /// What cameras without errors see of the points of a frame.
    fn projected(&self, points: &Points, number: u64) -> Vec<Vec<Person>> {
        let row = number.checked_sub(points.first).and_then(|row| points.rows.get(usize::try_from(row).ok()?));
        let Some(row) = row else { return vec![vec![]; self.cameras.len()] };
        let seen = |camera: &Camera| {
            let detection = |point: &Option<[f64; 3]>| {
                let pixel = camera.project((*point)?).pixel()?;
                Some(Detection::new(pixel, 1.0))
            };
            vec![row.iter().map(detection).collect()]
        };
        self.cameras.iter().map(seen).collect()
    }

    /// For each camera everybody whom it saw in a frame.
    fn everybody(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error> {
        match (&self.points, &mut self.keypoints) {
            (Some(points), _) => Ok(self.projected(points, number)),
            (None, Some(recording)) => recording.people(number),
            (None, None) => Ok(vec![vec![]; self.cameras.len()]),
        }
    }

    /// Those of a frame who are shown, and those who are known to be someone else.
    fn parted(&self, number: u64, people: Vec<Vec<Person>>) -> [Vec<Vec<Person>>; 2] {
        match self.chosen {
            Some((roll, person)) => roll.parted(number, person, people),
            None => [people, vec![]],
        }
    }
}

impl FrameSource for Footage<'_> {
    fn cameras(&self) -> &[Camera] {
        &self.cameras
    }

    fn layout(&self) -> &Layout {
        &self.layout
    }

    fn frames(&self) -> Range<u64> {
        self.chosen.map_or_else(|| self.frames.clone(), |(roll, person)| roll.people[person].frames.clone())
    }

    fn people(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error> {
        let people = self.everybody(number)?;
        let [own, _] = self.parted(number, people);
        Ok(own)
    }

    fn others(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error> {
        if self.chosen.is_none() {
            return Ok(vec![]);
        }
        let people = self.everybody(number)?;
        let [_, others] = self.parted(number, people);
        Ok(others)
    }

    fn shows_one(&self) -> bool {
        self.chosen.is_some()
    }

    fn lags_of_all(&self) -> Option<&[CameraLag]> {
        self.chosen.map(|(roll, _)| roll.lags.as_slice())
    }

    fn warnings(&self) -> Vec<String> {
        let keypoints = self.keypoints.iter().flat_map(Recording::warnings);
        let masks = self.silhouettes.iter().flat_map(Silhouettes::warnings);
        let images = self.pictures.iter().flat_map(Pictures::warnings);
        self.warnings.iter().cloned().chain(keypoints).chain(masks).chain(images).collect()
    }

    fn input_hashes(&self) -> InputHashes {
        let mut hashes = match &self.keypoints {
            Some(recording) => recording.input_hashes(),
            None => [("calibration".to_owned(), format!("{:016x}", self.calibration_hash))].into(),
        };
        hashes.extend(self.silhouettes.iter().map(|masks| ("silhouettes".to_owned(), masks.input_hash())));
        hashes.extend(self.pictures.iter().map(|images| ("images".to_owned(), images.input_hash())));
        hashes
    }

    fn image_cameras(&self) -> Option<Vec<Camera>> {
        self.silhouettes.as_ref().map(Silhouettes::cameras)
    }

    fn masks(&mut self, number: u64) -> Result<Vec<Option<BitImage>>, Error> {
        Ok(self.silhouettes.as_mut().map(|masks| masks.frame(number)).transpose()?.unwrap_or_default())
    }

    fn pictured(&self, numbers: &Range<u64>) -> Vec<u64> {
        self.pictures.as_ref().map(|pictures| pictures.numbers_in(numbers)).unwrap_or_default()
    }

    fn pictures(&mut self, number: u64) -> Result<Vec<Option<RgbImage>>, Error> {
        Ok(self.pictures.as_mut().map(|pictures| pictures.frame(number)).transpose()?.unwrap_or_default())
    }

    fn frame(&mut self, number: u64) -> Result<Frame, Error> {
        let people = match self.begins_only {
            true => vec![vec![]; self.cameras.len()],
            false => self.everybody(number)?,
        };
        let images = FrameImages { silhouettes: self.masks(number)?, pictures: self.pictures(number)? };
        let [people, others] = self.parted(number, people);
        Ok(Frame { people, others, images })
    }
}
