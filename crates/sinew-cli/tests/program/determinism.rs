//! The same numbers whatever the threads, the run and the way the frames are fed.
//!
//! And somebody who leaves and comes back elsewhere is found again.

// A run of frames is a range, and there is a list of them.
#![allow(clippy::single_range_in_vec_init)]

use crate::common::synthetic::{Whole, results};
use crate::common::{correlation, files, trial};
use sinew::Error;
use sinew::config::settings::Settings;
use sinew::config::{Sources, resolve};
use sinew::core::estimators::{mean, median};
use sinew::core::lanes::Isa;
use sinew::input::source::FrameSource;
use sinew::input::up_axis::z_up_from;
use sinew::input::upright::Upright;
use sinew::methods::{BootstrapMethod, HmcMethod, Method};
use sinew::setup::{self, Setup, SetupRequest};
use sinew::track::Pipeline;
use sinew::track::job::{self, Watch};
use sinew::tracking::posterior::Posterior;
use sinew::tracking::{bootstrap, hmc_filter};
use sinew_results::estimate::{FrameEstimate, Quality};
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::simulated_source::source;
use std::collections::BTreeMap;
use std::fs;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

fn recording(duration_s: f64) -> SyntheticRecording {
    SyntheticRecording::new(&Script { duration_s, ..Script::default() }, 7).unwrap()
}

fn set_up(recording: &SyntheticRecording, frames: Range<u64>) -> Setup {
    let mut source = source(recording);
    let frames = frames.map(|number| Ok::<_, Error>((number, source.people(number)?)));
    let (mut found, _) =
        setup::set_up(&recording.cameras, &recording.layout, &SetupRequest::default(), frames).unwrap();
    (found.step_size, found.leapfrog_steps) = (Some(0.4), Some(5));
    found
}

fn quick() -> Settings {
    let hmc = hmc_filter::Config { chains: 8, updates: 12, burn_in: 4, ..HmcMethod::default().0 };
    Settings { method: Arc::new(HmcMethod(hmc)), draws: 16, ..Settings::default() }
}

fn bootstrap(particles: usize) -> Arc<dyn Method> {
    Arc::new(BootstrapMethod(bootstrap::Config { particles, ..bootstrap::Config::default() }))
}

/// Tracks ranges of frames one after the other with one pipeline.
fn tracked(
    recording: &SyntheticRecording,
    setup: &Setup,
    settings: &Settings,
    parts: &[Range<u64>],
) -> Vec<FrameEstimate> {
    let (tree, mut source, mut all) = (setup.tree(), source(recording), vec![]);
    let mut pipeline = Pipeline::new(setup, &tree, &recording.cameras, &recording.layout, settings.clone()).unwrap();
    for part in parts {
        let keep = |estimate, _: &Posterior<'_>| {
            all.push(estimate);
            Ok(())
        };
        pipeline.track(&mut source, part.clone(), keep).unwrap();
    }
    all
}

/// Every number of the estimates, to the bit.
fn bits(estimates: &[FrameEstimate]) -> Vec<u64> {
    let of = |e: &FrameEstimate| {
        let mut all = vec![e.number as f64, e.ess, f64::from(u8::from(e.observed)), e.time_s];
        all.extend(&e.mean_state);
        all.extend(e.points.iter().flat_map(|p| [p.mean, p.sd, p.q05, p.q95]).flatten());
        all.extend(e.state.iter().flat_map(|s| [s.mean, s.q05, s.q95]));
        all.extend(e.angles.iter().flat_map(|a| [a.pose, a.mean, a.q05, a.q95]));
        all.extend(e.angles.iter().flat_map(|a| a.rate).flatten());
        all.extend(&e.draws.states);
        all.extend(&e.draws.lp);
        all.extend(e.residual_px.iter().flatten());
        all.extend([e.log_evidence, e.r_hat, e.acceptance].into_iter().flatten());
        all.into_iter().map(f64::to_bits).collect::<Vec<u64>>()
    };
    estimates.iter().flat_map(of).collect()
}

#[test]
fn threads_runs_and_halves_give_the_same_bits() {
    let recording = recording(0.6);
    let setup = set_up(&recording, 0..18);
    for method in [quick().method, bootstrap(512)] {
        for isa in Isa::available() {
            let settings = Settings { method: method.clone(), isa, ..quick() };
            let run = |threads: usize, parts: &[Range<u64>]| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                bits(&pool.install(|| tracked(&recording, &setup, &settings, parts)))
            };
            let one = run(1, &[0..18]);
            assert!(!one.is_empty());
            let one_by_one: Vec<Range<u64>> = (0..18).map(|number| number..number + 1).collect();
            for (threads, parts) in
                [(1, vec![0..18]), (2, vec![0..18]), (8, vec![0..18]), (2, vec![0..7, 7..18]), (8, one_by_one)]
            {
                assert!(run(threads, &parts) == one, "{method:?} {isa:?} {threads} threads {parts:?}");
            }
        }
    }
}

/// Walkers that have nothing in common err apart: no draw of one is made of the random numbers of another, in the same frame, with one seed.
#[test]
fn two_trials_draw_other_numbers() {
    let walkers =
        [7, 8].map(|seed| SyntheticRecording::new(&Script { duration_s: 1.0, ..Script::default() }, seed).unwrap());
    // What is constant, number by number.
    let resolved = resolve(&Sources::default()).unwrap();
    let [one, other] = walkers.each_ref().map(|walker| {
        let mut watch = Watch { progress: &mut |_, _, _| (), stop: &AtomicBool::new(false) };
        let made = job::set_up(&mut source(walker), &resolved, &mut watch).unwrap();
        let numbers = Setup::from_toml("setup.toml", &made.toml).unwrap().lasting.unwrap().number;
        numbers.into_iter().map(|number| (number.name, number.draws)).collect::<BTreeMap<_, _>>()
    });
    let mut found: Vec<f64> = one.iter().map(|(name, draws)| correlation(draws, &other[name])).collect();
    let size = (one.values().next().unwrap().len() as f64).sqrt();
    assert!(found.len() > 200 && size > 11.0);
    let typical = median(&mut found);
    assert!(typical.abs() < 2.0 / size, "constants: median correlation {typical}");
    // The pose, each degree of freedom by itself.
    let settings = Settings { draws: 96, ..quick() };
    let [one, other] = walkers.each_ref().map(|walker| tracked(walker, &set_up(walker, 0..30), &settings, &[0..6]));
    let drawn = |estimate: &FrameEstimate, dof: usize| {
        let states = estimate.draws.states.chunks_exact(estimate.mean_state.len());
        states.map(|state| state[dof]).collect::<Vec<f64>>()
    };
    let frames = one.iter().zip(&other).skip(1);
    let dofs = 0..one[0].mean_state.len();
    let found: Vec<f64> = frames
        .flat_map(|(a, b)| dofs.clone().map(move |dof| correlation(&drawn(a, dof), &drawn(b, dof))))
        .filter(|found| found.is_finite())
        .collect();
    assert!(mean(&found).abs() < 0.05, "poses: mean correlation {}", mean(&found));
}

/// With one set-up, too, and before anybody is there, when a run cannot know which trial it is of. Frames that come one by one, as in a live run, make no difference.
#[test]
fn a_trial_that_begins_with_nobody_is_told_from_others_once_somebody_comes() {
    let mut recording = recording(0.4);
    let setup = set_up(&recording, 0..12);
    recording.keypoints.iter_mut().for_each(|camera| camera[..3].iter_mut().for_each(|frame| frame.fill(None)));
    let mut other = recording.clone();
    other.keypoints[0][3].iter_mut().flatten().for_each(|point| point.x += 1e-9);
    let parts: Vec<Range<u64>> = (0..6).map(|number| number..number + 1).collect();
    let one = tracked(&recording, &setup, &quick(), &[0..6]);
    assert!(bits(&one) == bits(&tracked(&recording, &setup, &quick(), &parts)));
    let other = tracked(&other, &setup, &quick(), &[0..6]);
    let differs = |frames: Range<usize>| {
        let between = |(a, b): (&f64, &f64)| (a - b).abs();
        let pairs = one[frames.clone()].iter().zip(&other[frames]);
        pairs.flat_map(|(a, b)| a.draws.states.iter().zip(&b.draws.states).map(between)).fold(0.0, f64::max)
    };
    assert!(differs(0..3) == 0.0 && differs(3..6) > 1e-3, "{} {}", differs(0..3), differs(3..6));
}

/// Every file of a run, filtered and smoothed.
#[test]
fn any_number_of_threads_leaves_the_same_files() {
    for method in ["hmc", "bootstrap"] {
        for smooth in ["false", "true"] {
            let whole = Whole::new(&[("method", method), ("smooth", smooth)]);
            for threads in [1, 2, 8] {
                let out = whole.folder.path().join("again");
                whole.run(&out, threads, None, None).unwrap();
                let mut files = files(&out);
                files.remove("timings.json");
                assert!(files == whole.files, "{method}, smooth {smooth}, {threads} threads");
                fs::remove_dir_all(&out).unwrap();
            }
        }
    }
}

/// Every method that takes silhouettes leaves the same files on one thread and on two.
#[test]
fn silhouettes_are_tracked_alike_on_any_number_of_threads() {
    for method in ["bootstrap", "annealed", "partitioned", "hppf", "coarse-to-fine"] {
        let few = [("method", method), ("particles", "24"), ("fine", "16"), ("layers", "2"), ("raster", "64")];
        let whole = Whole::from_silhouettes(6, &few);
        for threads in [1, 2] {
            let out = whole.folder.path().join("again");
            whole.run(&out, threads, None, None).unwrap();
            assert!(results(&out) == whole.files, "{method}, {threads} threads");
            fs::remove_dir_all(&out).unwrap();
        }
    }
}

#[test]
fn a_forced_instruction_set_gives_the_same_files_twice() {
    let trial = trial(0.2);
    for set in Isa::available().into_iter().map(Isa::name) {
        let [one, two] = ["1", "2"].map(|threads| {
            let out = format!("-o{set}-{threads}");
            let output = trial.track(&[&out, "--simd", set, "--threads", threads]);
            assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
            ["markers.trc", "joints.csv", "angles.csv", "frames.csv", "summary.json", "setup.toml", "motion.bvh"]
                .map(|name| fs::read(trial.path(&out[2..]).join(name)).unwrap())
        });
        assert!(one == two, "{set}");
        let summary: serde_json::Value = serde_json::from_slice(&one[4]).unwrap();
        assert_eq!(summary["isa"], set);
    }
}

/// Mean distance of the estimate from the truth of a frame, metres.
fn error_m(recording: &SyntheticRecording, setup: &Setup, estimate: &FrameEstimate, truth: usize) -> f64 {
    let tree = setup.tree();
    let distances: Vec<f64> = tree
        .points()
        .iter()
        .zip(&estimate.points)
        .filter_map(|(point, found)| {
            let k = recording.truth.names.iter().position(|name| *name == point.name)?;
            let truth = recording.truth.frames[truth][k];
            Some((0..3).map(|a| (found.mean[a] - truth[a]).powi(2)).sum::<f64>().sqrt())
        })
        .collect();
    distances.iter().sum::<f64>() / distances.len() as f64
}

#[test]
fn who_leaves_and_returns_elsewhere_is_found_again() {
    let mut recording = recording(4.5);
    let setup = set_up(&recording, 0..60);
    // Nobody in frames 40..60; then the walker is where they would have been 50 frames later.
    for camera in &mut recording.keypoints {
        for frame in (40..60).collect::<Vec<usize>>() {
            camera[frame].fill(None);
        }
        for frame in 60..80 {
            camera[frame] = camera[frame + 50].clone();
        }
    }
    for settings in [quick(), Settings { method: bootstrap(2048), ..quick() }] {
        let found = tracked(&recording, &setup, &settings, &[30..80]);
        assert_eq!(found.len(), 50);
        for estimate in &found {
            let away = (40..60).contains(&estimate.number);
            assert_eq!(estimate.observed, !away, "frame {}", estimate.number);
            assert_eq!(estimate.quality == Quality::Predicted, away, "frame {}", estimate.number);
            let numbers = estimate.mean_state.iter().chain(&estimate.draws.states);
            assert!(numbers.chain(estimate.points.iter().flat_map(|p| &p.sd)).all(|x| x.is_finite()));
        }
        let spread = |number: usize| found[number - 30].points.iter().map(|p| p.sd[0]).sum::<f64>();
        assert!(spread(55) > 2.0 * spread(39), "uncertainty grows while nobody is seen");
        for number in 62..80_usize {
            let error = error_m(&recording, &setup, &found[number - 30], number + 50);
            // A particle filter of so few particles drifts; the walker is found all the same, two metres from where they were lost.
            let most = if settings.method.about().name == "hmc" { 0.15 } else { 0.4 };
            assert!(error < most, "{:?} frame {number}: {error}", settings.method);
        }
    }
}

#[test]
fn a_world_that_is_declared_is_turned_to_z_up() {
    let recording = recording(0.1);
    for up in ["+x", "-x", "+y", "-y", "+z", "-z"] {
        let turn = z_up_from(up).unwrap();
        let back = [0, 1, 2].map(|i: usize| [0, 1, 2].map(|j: usize| turn[j][i]));
        let mut other = source(&recording);
        other.cameras = recording.cameras.iter().map(|camera| camera.turned(back)).collect();
        let upright = Upright::new(&mut other, up);
        for (camera, truth) in upright.cameras().iter().zip(&recording.cameras) {
            assert_eq!((camera.rotation, camera.translation), (truth.rotation, truth.translation), "{up}");
        }
    }
    // The same through the program: a calibration whose y axis points down the body.
    let trial = trial(0.2);
    let z_from_minus_y = z_up_from("-y").unwrap();
    let back = [0, 1, 2].map(|i: usize| [0, 1, 2].map(|j: usize| z_from_minus_y[j][i]));
    let plain = trial.track(&["-oplain"]);
    assert_eq!(plain.status.code(), Some(0), "{}", trial.printed(&plain));
    let mut turned = self::recording(0.2);
    turned.cameras = turned.cameras.iter().map(|camera| camera.turned(back)).collect();
    fs::write(trial.path("Calib.toml"), turned.calibration_toml()).unwrap();
    let printed = trial.track_printed(&["-odoubted"]);
    assert!(printed.contains("set `up_axis` (found: -y)"), "{printed}");
    let printed = trial.track_printed(&["--up-axis", "-y"]);
    assert!(!printed.contains("up_axis"), "{printed}");
    // The person says it as well: they walk, and their points hold the same heights.
    let printed = trial.track_printed(&["-olevelled", "--up", "auto"]);
    assert!(printed.contains("the world was levelled: up is ("), "{printed}");
    let summary = fs::read_to_string(trial.path("levelled/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert!(summary["world"]["sd_deg"].as_f64().unwrap() < 6.0, "{}", summary["world"]);
    assert!(summary["world"]["results_from_calibration"][2][1].as_f64().unwrap() < -0.98, "{}", summary["world"]);
    let printed = trial.track_printed(&["-oboth", "--up", "0,-1,0", "--up-axis", "-y"]);
    assert!(printed.contains("`up` and `up_axis` are both given"), "{printed}");
    let height = |out: &str| {
        let text = fs::read_to_string(trial.path(out).join("markers.trc")).unwrap();
        let trc = sinew::formats::trc::read("markers.trc", &text).unwrap();
        trc.point_in_world(3, trc.marker_index("Nose").unwrap()).unwrap()
    };
    let (a, b) = (height("plain"), height("out"));
    assert!((0..3).all(|k| (a[k] - b[k]).abs() < 0.05) && a[2] > 1.0, "{a:?} {b:?}");
    assert!((height("levelled")[2] - a[2]).abs() < 0.1, "{:?} {a:?}", height("levelled"));
    // The set-up knows the axis.
    let printed = trial.track_printed(&["-oagain", "--setup", "out/setup.toml", "--up-axis=+y"]);
    assert!(printed.contains("`up_axis` is +y; the set-up was made with -y"), "{printed}");
    let printed = trial.track_printed(&["-oagain", "--setup", "out/setup.toml", "--up=0,0,1"]);
    assert!(printed.contains("`up` is 0,0,1; the set-up was made with -y"), "{printed}");
    assert!(printed.contains("leave `up` out"), "{printed}");
    // It knows the body, too.
    let printed = trial.track_printed(&["-oagain", "--setup", "out/setup.toml", "--body=cf28"]);
    assert!(printed.contains("`body` is cf28; the set-up was made with h32"), "{printed}");
}
