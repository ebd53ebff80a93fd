//! Frames that come while they are tracked.
//!
//! What a line says of the calibrated cameras, and a source that holds the frame at hand.
//!
//! A line is read by [`LiveCameras`], on any thread; its views go to a [`LiveRecording`], which keeps those for the set-up until they are forgotten and else one frame only.
//! A frame of which nothing was taken is one that no camera saw.

use super::recording::guess;
use super::recording::{Calibrated, RecordingOptions, check_layout, chosen_cameras, drop_beyond_lens, known_layout};
use super::source::{FrameSource, InputHashes};
use crate::Error;
use sinew_formats::live_frame;
use sinew_formats::openpose::{OpenposeFrame, OpenposeOptions, OpenposePerson, Tally, detections};
use sinew_formats::{Error as FormatError, Layout, Place, camera_name};
use sinew_observe::Camera;
use sinew_observe::association::Person;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

/// What the cameras sent of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Views {
    /// Number of the frame.
    pub number: u64,
    /// By camera, in the order of [`LiveCameras::cameras`]; none where it sent nothing.
    pub seen: Vec<Option<OpenposeFrame>>,
}

impl Views {
    /// Number of cameras that show somebody.
    #[must_use]
    pub fn with_people(&self) -> usize {
        self.seen.iter().flatten().filter(|seen| !seen.people.is_empty()).count()
    }

    fn people(&self) -> impl Iterator<Item = &OpenposePerson> {
        self.seen.iter().flatten().flat_map(|seen| &seen.people)
    }
}

/// The cameras that send.
#[derive(Clone, Debug)]
pub struct LiveCameras {
    cameras: Vec<Camera>,
    calibrated: Vec<String>,
    confidence_scale: f64,
    warnings: Vec<String>,
    hash: u64,
}

impl LiveCameras {
    /// The cameras of a calibration, or the chosen ones.
    ///
    /// # Errors
    /// A calibration that cannot be read, and a chosen camera that is not in it.
    pub fn open(calibration: &Path, options: &RecordingOptions) -> Result<Self, Error> {
        let Calibrated { cameras, names, warnings, hash } = Calibrated::read(calibration)?;
        let cameras = match options.cameras.as_deref() {
            Some(chosen) => chosen_cameras(cameras, chosen)?,
            None => cameras,
        };
        let cameras = cameras.iter().map(|camera| camera.resized(options.image_scale)).collect();
        Ok(Self { cameras, calibrated: names, confidence_scale: options.confidence_scale, warnings, hash })
    }

    /// The cameras, sized like the images with the keypoints.
    #[must_use]
    pub fn cameras(&self) -> &[Camera] {
        &self.cameras
    }

    /// The layout that is named.
    ///
    /// # Errors
    /// One that is unknown, or with which no body can be placed.
    pub fn named_layout(&self, options: &RecordingOptions) -> Result<Option<Layout>, Error> {
        let layout = options.layout.as_deref().map(known_layout::named_layout).transpose()?;
        layout.iter().try_for_each(check_layout)?;
        Ok(layout)
    }

    /// What a line says; `name` is its place for messages. Without a layout any number of keypoints is taken.
    ///
    /// # Errors
    /// What [`live_frame::read`] refuses; a camera that is not calibrated, or that is there under two names.
    pub fn read(&self, name: &str, line: &str, layout: Option<&Layout>) -> Result<Views, Error> {
        let options = OpenposeOptions { frame: None, layout, confidence_scale: self.confidence_scale };
        let frame = live_frame::read(name, line, &options)?;
        let mut views = Views { number: frame.number, seen: vec![None; self.cameras.len()] };
        let mut there = Vec::with_capacity(frame.cameras.len());
        for (camera, seen) in frame.cameras {
            let folded = camera_name::fold(&camera);
            let place = || Place::file(name).within(format!("frame {}", frame.number));
            if there.contains(&folded) {
                return Err(FormatError::DuplicateName { place: place(), what: "camera", name: camera }.into());
            }
            match self.cameras.iter().position(|known| camera_name::fold(&known.name) == folded) {
                Some(index) => views.seen[index] = seen,
                None if self.calibrated.iter().any(|known| camera_name::fold(known) == folded) => {}
                None => {
                    let calibrated = self.calibrated.clone();
                    return Err(FormatError::NoCalibration { name: camera, calibrated }.into());
                }
            }
            there.push(folded);
        }
        Ok(views)
    }

    /// The layout of the people in a frame, with a warning if there was a choice; `name` is its place for messages. None where nobody is there.
    ///
    /// # Errors
    /// A number of keypoints that no layout has.
    pub fn guessed_layout(&self, name: &str, views: &Views) -> Result<Option<(Layout, Option<String>)>, Error> {
        let people: Vec<OpenposePerson> = views.people().cloned().collect();
        if people.is_empty() {
            return Ok(None);
        }
        let (layout, warning) = guess::people_layout(&people, Path::new(name))?;
        check_layout(&layout)?;
        Ok(Some((layout, warning)))
    }
}

/// The frame at hand, and frames for the set-up.
#[derive(Clone, Debug)]
pub struct LiveRecording {
    cameras: LiveCameras,
    layout: Layout,
    kept: BTreeMap<u64, Vec<Vec<Person>>>,
    at_hand: Option<(u64, Vec<Vec<Person>>)>,
    frames: Range<u64>,
    tallies: Vec<Tally>,
    silent: Vec<u64>,
    beyond_lens: Vec<u64>,
}

impl LiveRecording {
    /// Before the first frame.
    #[must_use]
    pub fn new(cameras: LiveCameras, layout: Layout) -> Self {
        let count = cameras.cameras.len();
        Self {
            cameras,
            layout,
            kept: BTreeMap::new(),
            at_hand: None,
            frames: 0..0,
            tallies: vec![Tally::default(); count],
            silent: vec![0; count],
            beyond_lens: vec![0; count],
        }
    }

    /// Keeps a frame for the set-up.
    pub fn keep(&mut self, views: Views) {
        let number = views.number;
        let people = self.placed(views, false);
        self.kept.insert(number, people);
    }

    /// Forgets the frames for the set-up.
    pub fn forget(&mut self) {
        self.kept.clear();
    }

    /// Takes a frame to be tracked.
    pub fn take(&mut self, views: Views) {
        let number = views.number;
        let start = if self.frames.is_empty() { number } else { self.frames.start };
        self.frames = start..number + 1;
        let people = self.placed(views, true);
        self.at_hand = Some((number, people));
    }

    /// The people in every view, without keypoints that no ray leads to.
    fn placed(&mut self, views: Views, is_counted: bool) -> Vec<Vec<Person>> {
        let mut people = Vec::with_capacity(views.seen.len());
        for (index, seen) in views.seen.into_iter().enumerate() {
            if is_counted {
                match &seen {
                    Some(_) => self.tallies[index].add(views.number, seen.as_ref()),
                    None => self.silent[index] += 1,
                }
            }
            let mut own = seen.unwrap_or_default().people;
            let dropped = drop_beyond_lens(&self.cameras.cameras[index], &mut own);
            self.beyond_lens[index] += if is_counted { dropped } else { 0 };
            people.push(own);
        }
        detections(&people)
    }

    /// What is odd about the frames so far.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = self.cameras.warnings.clone();
        for (index, Camera { name, .. }) in self.cameras.cameras.iter().enumerate() {
            let silent = self.silent[index];
            if silent > 0 {
                warnings.push(format!("{name} sent nothing in {silent} frames"));
            }
            warnings.extend(self.tallies[index].warnings(name).iter().map(ToString::to_string));
            let points = self.beyond_lens[index];
            if points > 0 {
                warnings.push(format!(
                    "{name}: {points} points lie beyond the valid radius of the lens model; treated as missing"
                ));
            }
        }
        warnings
    }
}

impl FrameSource for LiveRecording {
    /// Of the calibration: what was sent is not there again.
    fn input_hashes(&self) -> InputHashes {
        [("calibration".to_owned(), format!("{:016x}", self.cameras.hash))].into()
    }

    fn cameras(&self) -> &[Camera] {
        &self.cameras.cameras
    }

    fn layout(&self) -> &Layout {
        &self.layout
    }

    /// From the first frame that was taken to the one at hand.
    fn frames(&self) -> Range<u64> {
        self.frames.clone()
    }

    fn people(&mut self, number: u64) -> Result<Vec<Vec<Person>>, Error> {
        let at_hand = self.at_hand.as_ref().filter(|(own, _)| *own == number).map(|(_, people)| people);
        let people = at_hand.or_else(|| self.kept.get(&number));
        Ok(people.cloned().unwrap_or_else(|| vec![vec![]; self.cameras.cameras.len()]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_formats::layout;

    fn cameras() -> LiveCameras {
        let camera = |name| Camera::look_at(name, [640.0, 480.0], 500.0, [3.0, 0.0, 1.0], [0.0, 0.0, 1.0]).unwrap();
        LiveCameras {
            cameras: vec![camera("C1"), camera("C2")],
            calibrated: vec!["C1".into(), "C2".into(), "C3".into()],
            confidence_scale: 1.0,
            warnings: vec![],
            hash: 0,
        }
    }

    fn line(number: u64, cameras: &[&str]) -> String {
        let numbers = vec!["0.5"; 75].join(",");
        let one = |name: &&str| format!(r#""{name}": {{"people": [{{"pose_keypoints_2d": [{numbers}]}}]}}"#);
        let cameras: Vec<String> = cameras.iter().map(one).collect();
        format!(r#"{{"frame": {number}, "cameras": {{{}}}}}"#, cameras.join(","))
    }

    #[test]
    fn cameras_go_by_name_and_what_is_not_chosen_is_left_out() {
        let views = cameras().read("line 1", &line(4, &["c02", "C3"]), None).unwrap();
        assert!(views.seen[0].is_none() && views.seen[1].is_some() && views.with_people() == 1);
        let refused = |names: &[&str]| cameras().read("line 1", &line(4, names), None).unwrap_err().to_string();
        assert_eq!(refused(&["C1", "c_1"]), "line 1 (frame 4): the camera `c_1` is there twice");
        assert_eq!(refused(&["C7"]), "no calibration for `C7`; calibrated: C1, C2, C3");
    }

    #[test]
    fn a_frame_that_never_came_shows_nobody() {
        let layout = layout::find("BODY_25B").unwrap();
        let cameras = cameras();
        let mut live = LiveRecording::new(cameras.clone(), layout.clone());
        for number in [4, 7] {
            live.take(cameras.read("line 1", &line(number, &["C1"]), Some(&layout)).unwrap());
        }
        assert_eq!(live.frames(), 4..8);
        assert_eq!(live.people(6).unwrap(), vec![Vec::<Person>::new(); 2]);
        assert_eq!(live.people(7).unwrap()[0].len(), 1);
        assert_eq!(live.warnings()[0], "C2 sent nothing in 2 frames");
    }
}
