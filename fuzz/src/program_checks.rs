//! One check per reader of the program itself, and one for a whole step of a filter.
//! Whatever the bytes, there is a value or an error with words in it.
//!
//! Used by the fuzz targets and by `tests/tests/whole/corpus.rs`, like [`super::checks`].

use sinew::config::settings::Settings;
use sinew::core::decode::Decode as _;
use sinew::core::lanes::Isa;
use sinew::core::transition::{MotionModel as _, Transition as _};
use sinew::dynamics::primitives::{file, motion::PrimitiveMotion};
use sinew::input::in_memory::InMemory;
use sinew::input::recording::RecordingOptions;
use sinew::input::source::FrameSource;
use sinew::methods::{BootstrapMethod, HmcMethod, Method};
use sinew::observe::Detection;
use sinew::observe::association::Person;
use sinew::setup::{Setup, SetupRequest, set_up};
use sinew::track::Pipeline;
use sinew::track::checkpoint::Checkpoint;
use sinew::tracking::posterior::Posterior;
use sinew::tracking::{bootstrap, hmc_filter};
use sinew::{formats::Layout, observe::Camera};
use sinew_input::Error as InputError;
use sinew_latent::file as latent_file;
use sinew_latent::model::RootPrior;
use sinew_latent::motion::{LatentMotion, StepNoise};
use sinew_latent::space::Below;
use sinew_report::Error;
use sinew_report::inspect::{Subject, file_facts};
use sinew_results::estimate::FrameEstimate;
use sinew_results::problem::Problem;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_words::{exit_code, help};
use std::cell::RefCell;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

/// The value, or a failure that a user can read: it has words, and an exit code of the table.
fn answered<T>(result: Result<T, impl Into<Error>>) -> Option<T> {
    match result.map_err(Into::into) {
        Ok(value) => Some(value),
        Err(error) => {
            assert!(!error.to_string().is_empty() && (1..=5).contains(&exit_code(&error)), "{error}");
            assert!(help(&error).is_none_or(|help| !help.is_empty()));
            None
        }
    }
}

/// Puts the bytes into a file of that name and looks at what it belongs to.
fn inspected(name: &str, data: &[u8], subject: impl Fn(PathBuf) -> Subject) {
    thread_local!(static FOLDER: RefCell<Option<tempfile::TempDir>> = const { RefCell::new(None) });
    FOLDER.with_borrow_mut(|folder| {
        let folder = folder.get_or_insert_with(|| tempfile::tempdir().expect("a place for files"));
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap_or(Path::new(""))).expect("a place for files");
        fs::write(&path, data).expect("a place for files");
        if let Some(facts) = answered(file_facts(&subject(path), &RecordingOptions::default(), None)) {
            assert!(!facts.title.is_empty());
        }
    });
}

fn above(path: &Path, levels: usize) -> PathBuf {
    path.ancestors().nth(levels).unwrap_or(path).to_owned()
}

/// `sinew.toml`.
pub fn settings(data: &[u8]) {
    inspected("sinew.toml", data, Subject::Configuration);
}

/// `setup.toml`; what is written of a set-up is read as the same.
pub fn setup(data: &[u8]) {
    inspected("setup.toml", data, Subject::Setup);
    let Some(setup) = std::str::from_utf8(data).ok().and_then(|text| answered(Setup::from_toml("setup.toml", text)))
    else {
        return;
    };
    if let Some(written) = answered(setup.to_toml()) {
        let again = Setup::from_toml("written", &written).unwrap_or_else(|error| panic!("{error} in\n{written}"));
        assert!(again.to_toml().is_ok_and(|text| text == written), "{written}");
    }
}

/// `summary.json`.
pub fn summary(data: &[u8]) {
    inspected("results/summary.json", data, |path| Subject::Results(above(&path, 1)));
}

/// The metadata of a variable in `posterior.zarr`.
pub fn zarr_metadata(data: &[u8]) {
    inspected("store.zarr/zarr.json", br#"{"zarr_format": 3, "node_type": "group"}"#, |path| {
        Subject::Draws(above(&path, 1))
    });
    inspected("store.zarr/variable/zarr.json", data, |path| Subject::Draws(above(&path, 2)));
}

/// Tables of a result folder.
pub fn result_tables(data: &[u8]) {
    inspected("joints.csv", data, Subject::Motion);
}

/// Checkpoints, as they are and with length and checksum put right, so that what lies behind them is reached.
pub fn checkpoint(data: &[u8]) {
    decoded(data);
    let Some((head, body)) = data.split_at_checked(20) else { return };
    let Some((_, body)) = body.split_at_checked(8) else { return };
    let body = &body[..body.len().saturating_sub(4)];
    let mut sealed = [b"sinew checkpoint", &head[16..], &(body.len() as u64).to_le_bytes(), body].concat();
    sealed[16..20].copy_from_slice(&1_u32.to_le_bytes());
    let checksum = crc32fast::hash(&sealed);
    sealed.extend(checksum.to_le_bytes());
    decoded(&sealed);
}

fn decoded(data: &[u8]) {
    match Checkpoint::decode(data) {
        Ok(checkpoint) => {
            let written = checkpoint.encode().expect("what was read can be written");
            let again = Checkpoint::decode(&written)
                .and_then(|again| again.encode().map_err(|error| Problem::Settings(vec![error.to_string()])));
            assert_eq!(again, Ok(written));
        }
        Err(problem) => {
            let error = Error::from(sinew_results::Error::checkpoint(Path::new("results"), problem));
            assert!(!error.to_string().is_empty() && help(&error).is_some_and(|help| !help.is_empty()));
            assert!((2..=5).contains(&exit_code(&error)));
        }
    }
}

/// A motion model; what is written of one is read as the same, and it moves a state.
pub fn primitive_model(data: &[u8]) {
    inspected("model.json", data, Subject::MotionModel);
    let Ok(text) = std::str::from_utf8(data) else { return };
    let model = match file::read("model.json", text) {
        Ok(model) => model,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let written = file::write("written", &model).expect("a model that was read can be written");
    assert_eq!(file::read("written", &written).as_ref(), Ok(&model));
    let rest = vec![0.0; model.dim];
    for primitives in &model.primitives {
        let dt = model.frame_rate.recip();
        let mut motion = PrimitiveMotion::new(&model, &primitives.feature.name, dt, Isa::baseline())
            .unwrap_or_else(|error| panic!("{error} of a model that was read"));
        (0..model.length.min(8)).for_each(|_| motion.follow(None, &rest));
        assert!(!motion.log_density(&rest, &rest).is_nan());
    }
}

/// A latent model; what is written of one is read as the same, and all its maps are made and used.
pub fn latent_model(data: &[u8]) {
    inspected("model.json", data, Subject::LatentModel);
    let Ok(text) = std::str::from_utf8(data) else { return };
    let stored = match latent_file::read("model.json", text) {
        Ok(stored) => stored,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let written = latent_file::write("written", &stored).expect("a model that was read can be written");
    assert_eq!(latent_file::read("written", &written).as_ref(), Ok(&stored));
    let model = &stored.model;
    let never = |error| -> ! { panic!("{error} of a model that was read") };
    for root in model.roots() {
        let node = &model.nodes[root];
        let below = Below::new(model, root, Isa::baseline()).unwrap_or_else(|error| never(error));
        assert_eq!(below.columns().len(), model.columns);
        let latent = below.encode(model.row(node.rows.start)).expect("a latent");
        let mut decoded = vec![0.0; model.columns];
        for x in [&latent, node.latent(0)] {
            below.decode(x, &mut decoded);
            assert!(x.iter().chain(&decoded).all(|x| x.is_finite()), "{x:?} {decoded:?}");
        }
        if let RootPrior::Dynamics { .. } = model.prior {
            let motion = LatentMotion::new(model, root, StepNoise::Predicted, Isa::baseline());
            let motion = motion.unwrap_or_else(|error| never(error));
            assert!(motion.mean(node.latent(0)).iter().chain(&motion.variances(node.latent(0))).all(|x| x.is_finite()));
        }
    }
}

/// What the frames of [`filter_step`] begin with: a walker, two frames of four cameras, a set-up.
static SCENE: LazyLock<(InMemory, Setup)> = LazyLock::new(|| {
    let script = Script { duration_s: 0.4, ..Script::default() };
    let SyntheticRecording { cameras, layout, keypoints, .. } =
        SyntheticRecording::new(&script, 3).expect("a recording");
    let mut recording = InMemory { cameras, layout, keypoints };
    let frames: Vec<_> = (0..12).map(|number| Ok::<_, sinew::Error>((number, recording.people(number)?))).collect();
    let found = set_up(&recording.cameras, &recording.layout, &SetupRequest::default(), frames);
    let (mut setup, _) = found.expect("a set-up");
    (setup.step_size, setup.leapfrog_steps) = (Some(0.4), Some(3));
    (recording, setup)
});

/// A frame of the walker, changed by bytes.
struct Changed<'a> {
    recording: &'a InMemory,
    people: Vec<Vec<Person>>,
}

impl FrameSource for Changed<'_> {
    fn cameras(&self) -> &[Camera] {
        &self.recording.cameras
    }
    fn layout(&self) -> &Layout {
        &self.recording.layout
    }
    fn frames(&self) -> Range<u64> {
        0..1
    }
    fn people(&mut self, _: u64) -> Result<Vec<Vec<Person>>, InputError> {
        Ok(self.people.clone())
    }
}

/// Values that a detector may give, far or near.
const ODD: [f64; 8] = [0.0, -0.0, 1e-300, 1.0, -1e4, 1e9, -1e18, 1e300];

/// A step of a filter on a scene that the bytes make: people missing, doubled and moved, keypoints missing, swapped, far away and of any confidence. The first byte says which tracker.
pub fn filter_step(data: &[u8]) {
    let (recording, setup) = &*SCENE;
    let Some((first, rest)) = data.split_first() else { return };
    let mut people = recording.clone().people(u64::from(first % 8)).expect("a frame");
    let cameras = people.len();
    for change in rest.as_chunks::<4>().0 {
        let [what, which, keypoint, value] = *change;
        let view = &mut people[usize::from(which) % cameras];
        let Some(count) = view.first().map(Vec::len) else { continue };
        let place = usize::from(keypoint) % count;
        match what % 8 {
            0 => view.clear(),
            1 if view.len() < 8 => view.extend(view.first().cloned()),
            2 => view[0][place] = None,
            3 => view[0].swap(place, usize::from(value) % count),
            4 => view.iter_mut().flatten().flatten().for_each(|d| d.pixel[0] += 4.0 * f64::from(value)),
            5 => {
                let [u, v] = [value, keypoint].map(|at| ODD[usize::from(at) % ODD.len()]);
                view[0][place] = Some(Detection::new([u, v], 1.0));
            }
            6 => view[0].iter_mut().flatten().for_each(|d| d.confidence = f64::from(value) / 255.0),
            _ => view.rotate_left(1),
        }
    }
    let method: Arc<dyn Method> = match first % 16 {
        15 => Arc::new(HmcMethod(hmc_filter::Config { chains: 8, updates: 1, burn_in: 0, ..HmcMethod::default().0 })),
        _ => Arc::new(BootstrapMethod(bootstrap::Config { particles: 8, ..bootstrap::Config::default() })),
    };
    let settings = Settings { method, draws: 2, ..Settings::default() };
    let tree = setup.tree();
    let pipeline = Pipeline::new(setup, &tree, &recording.cameras, &recording.layout, settings);
    let Some(mut pipeline) = answered(pipeline) else { return };
    let mut source = Changed { recording, people };
    answered(pipeline.track(&mut source, 0..1, |estimate: FrameEstimate, _: &Posterior<'_>| {
        let points = estimate.points.iter().flat_map(|p| [p.mean, p.sd, p.q05, p.q95]).flatten();
        let numbers = estimate.mean_state.iter().chain(&estimate.draws.states).copied().chain(points);
        assert!(numbers.into_iter().all(f64::is_finite), "an estimate that is no number");
        Ok(())
    }));
}
