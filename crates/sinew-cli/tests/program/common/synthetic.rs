//! Runs of the library on a short synthetic recording, stopped where a test wants.

use super::files;
use sinew::config::{Sources, resolve};
use sinew::formats::Layout;
use sinew::input::frame::{Frame, FrameImages};
use sinew::input::in_memory::InMemory;
use sinew::input::source::FrameSource;
use sinew::observe::Camera;
use sinew::observe::association::Person;
use sinew::track::checkpoint::{self, Checkpoint};
use sinew::track::job::{self, Outcome, RunPhase, Watch};
use sinew::{Error, setup};
use sinew_input::Error as InputError;
use sinew_results::{Claim, claim, claim_to_resume};
use sinew_simulate::footage::SyntheticFootage;
use sinew_simulate::recording::{Script, SyntheticRecording};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

/// Frames of a run.
pub const FRAMES: u64 = 30;

/// What is seen of the person of a recording.
#[derive(Clone, Copy, PartialEq)]
enum Seen {
    Keypoints,
    Masks,
    /// With masks, every third frame.
    Pictures,
}

/// Small silhouettes and pictures of the person of a recording.
struct Images {
    cameras: Vec<Camera>,
    frames: Vec<FrameImages>,
}

impl Images {
    fn of(recording: &SyntheticRecording, with_pictures: bool) -> Self {
        let cameras: Vec<Camera> = recording.cameras.iter().map(|camera| camera.resized(0.1)).collect();
        let footage = SyntheticFootage::with_cameras(recording.truth.clone(), 30.0, cameras.clone(), 7).unwrap();
        let frame = |frame: usize| {
            let has_pictures = with_pictures && frame.is_multiple_of(3);
            let silhouette = |camera| Some(footage.silhouette(camera, frame));
            let picture = |camera| has_pictures.then(|| footage.picture(camera, frame));
            let (silhouettes, pictures) =
                (0..cameras.len()).map(|camera| (silhouette(camera), picture(camera))).unzip();
            FrameImages { silhouettes, pictures }
        };
        Self { frames: (0..footage.frames()).map(frame).collect(), cameras }
    }
}

/// A recording, with or without images; with them, its keypoints are for the set-up.
struct Source<'a> {
    recording: InMemory,
    images: Option<&'a Images>,
}

impl FrameSource for Source<'_> {
    fn cameras(&self) -> &[Camera] {
        &self.recording.cameras
    }
    fn layout(&self) -> &Layout {
        &self.recording.layout
    }
    fn frames(&self) -> std::ops::Range<u64> {
        self.recording.frames()
    }
    fn people(&mut self, number: u64) -> Result<Vec<Vec<Person>>, InputError> {
        self.recording.people(number)
    }
    fn image_cameras(&self) -> Option<Vec<Camera>> {
        self.images.map(|images| images.cameras.clone())
    }
    fn pictured(&self, numbers: &std::ops::Range<u64>) -> Vec<u64> {
        let has_pictures = |number: &u64| {
            let images = self.images.and_then(|images| images.frames.get(*number as usize));
            images.is_some_and(|images| images.pictures.iter().any(Option::is_some))
        };
        numbers.clone().filter(has_pictures).collect()
    }
    fn frame(&mut self, number: u64) -> Result<Frame, InputError> {
        let Some(images) = self.images else {
            return Ok(Frame { people: self.people(number)?, ..Frame::default() });
        };
        let people = vec![vec![]; self.recording.cameras.len()];
        Ok(Frame { people, images: images.frames[number as usize].clone(), ..Frame::default() })
    }
}

/// A whole run, with which others are compared.
pub struct Whole {
    /// Holds the results and the set-up.
    pub folder: tempfile::TempDir,
    /// What the whole run left.
    pub files: BTreeMap<String, Vec<u8>>,
    /// What is tracked.
    pub recording: InMemory,
    images: Option<Images>,
    settings: Vec<(&'static str, String)>,
    frames: u64,
}

impl Whole {
    /// Tracks with these settings besides those that make a run short.
    pub fn new(settings: &[(&'static str, &str)]) -> Self {
        Self::lasting(FRAMES, settings)
    }

    /// As [`Whole::new`], with another number of frames.
    pub fn lasting(frames: u64, settings: &[(&'static str, &str)]) -> Self {
        Self::seen(frames, settings, Seen::Keypoints, 1.0)
    }

    /// As [`Whole::lasting`], with a multiple of the keypoint noise in the set-up: a wide likelihood, under which few particles continue from frame to frame.
    pub fn blurred(frames: u64, settings: &[(&'static str, &str)], factor: f64) -> Self {
        Self::seen(frames, settings, Seen::Keypoints, factor)
    }

    /// Tracks `frames` frames from silhouettes alone, after the set-up.
    pub fn from_silhouettes(frames: u64, settings: &[(&'static str, &str)]) -> Self {
        Self::seen(frames, settings, Seen::Masks, 1.0)
    }

    /// As [`Whole::from_silhouettes`] with pictures of every third frame, and with a set-up of its own, which learns their colours.
    pub fn from_pictures(frames: u64, settings: &[(&'static str, &str)]) -> Self {
        Self::seen(frames, settings, Seen::Pictures, 1.0)
    }

    fn seen(frames: u64, settings: &[(&'static str, &str)], seen: Seen, noise: f64) -> Self {
        let script = Script { duration_s: frames as f64 / 30.0, ..Script::default() };
        let mut recording = SyntheticRecording::new(&script, 7).unwrap();
        recording.cameras.truncate(2);
        recording.keypoints.truncate(2);
        let images = (seen != Seen::Keypoints).then(|| Images::of(&recording, seen == Seen::Pictures));
        let SyntheticRecording { cameras, layout, keypoints, .. } = recording;
        let mut recording = InMemory { cameras, layout, keypoints };
        let folder = tempfile::tempdir().unwrap();
        let body = match settings.iter().find(|(key, _)| *key == "body") {
            Some((_, "cf28")) => setup::Body::CF28,
            Some((_, "hppf24")) => setup::Body::HPPF24,
            Some((_, "hapf31")) => setup::Body::HAPF31,
            _ => setup::Body::H32,
        };
        let request = setup::SetupRequest { body, ..setup::SetupRequest::default() };
        let first: Vec<_> = (0..10).map(|number| Ok::<_, Error>((number, recording.people(number)?))).collect();
        let (mut found, _) = setup::set_up(&recording.cameras, &recording.layout, &request, first).unwrap();
        (found.step_size, found.leapfrog_steps) = (Some(0.4), Some(3));
        found.camera.iter_mut().for_each(|camera| camera.sigma_px *= noise);
        let path = folder.path().join("setup.toml");
        fs::write(&path, found.to_toml().unwrap()).unwrap();
        let short =
            [("fps", "30"), ("chains", "8"), ("updates", "2"), ("burn_in", "1"), ("draws", "2"), ("particles", "64")];
        let mut all: BTreeMap<&'static str, String> = short.map(|(key, value)| (key, value.to_owned())).into();
        all.extend(settings.iter().map(|(key, value)| (*key, (*value).to_owned())));
        if seen != Seen::Pictures {
            all.insert("setup", path.display().to_string());
        }
        all.remove("body");
        let mut whole =
            Self { folder, files: BTreeMap::new(), recording, images, settings: all.into_iter().collect(), frames };
        let out = whole.folder.path().join("whole");
        let outcome = whole.run(&out, 1, None, None).unwrap();
        assert!(outcome.summary.complete && outcome.colours.is_some() == (seen == Seen::Pictures));
        whole.files = results(&out);
        whole
    }

    /// Runs into a folder with a number of threads, from the first frame or a checkpoint, and requests an end after a number of frames.
    pub fn run(
        &self,
        out: &Path,
        threads: usize,
        stop: Option<u64>,
        from: Option<Checkpoint>,
    ) -> Result<Outcome, Error> {
        let claim = match from {
            None => claim(out, &[], false)?,
            Some(_) => claim_to_resume(out, &[])?,
        };
        self.run_in(claim, threads, stop, from)
    }

    /// As [`Whole::run`], in a claimed folder.
    pub fn run_in(
        &self,
        claim: Claim,
        threads: usize,
        stop: Option<u64>,
        from: Option<Checkpoint>,
    ) -> Result<Outcome, Error> {
        let resolved = resolve(&Sources { flags: self.settings.clone(), ..Sources::default() })?;
        let flag = AtomicBool::new(stop == Some(0) && from.is_none());
        let mut progress = |pass: RunPhase, done: u64, _: u64| {
            if pass == RunPhase::Track && Some(done) == stop {
                flag.store(true, Ordering::SeqCst);
            }
        };
        let mut source = Source { recording: self.recording.clone(), images: self.images.as_ref() };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut watch = Watch { progress: &mut progress, stop: &flag };
            job::track(&mut source, 0..self.frames, &resolved, claim, &mut watch, from)
        })
    }

    /// A run that is stopped after a number of frames and resumed gives the files of the whole one.
    pub fn check_stopped_at(&self, stop: u64) {
        let out = self.folder.path().join("out");
        let outcome = self.run(&out, 1, Some(stop), None).unwrap();
        assert_eq!(outcome.summary.complete, stop == self.frames || outcome.summary.frame_count == self.frames);
        if !outcome.summary.complete {
            let from = checkpoint::read(&out).unwrap();
            assert!(from.done == stop.max(1), "{stop}: {}", from.done);
            assert!(self.run(&out, 2, None, Some(from)).unwrap().summary.complete);
        }
        assert!(results(&out) == self.files, "stopped after {stop} of {} frames: {:?}", self.frames, self.settings);
        fs::remove_dir_all(&out).unwrap();
    }
}

/// All files that must be the same from run to run.
pub fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = files(folder);
    assert!(files.remove("timings.json").is_some());
    files
}
