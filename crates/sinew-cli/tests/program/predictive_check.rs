//! A run warns when the keypoints do not look as its model says.
//!
//! One walk is filmed with the noise that is assumed and then, each alone, with every error that the checks are made for. What each costs in coverage: docs/evidence/coverage.md.

use crate::common::trial;
use sinew::body::Proportions;
use sinew::config::settings::Settings;
use sinew::core::lanes::Isa;
use sinew::methods::HmcMethod;
use sinew::setup::Setup;
use sinew::track::{Doubt, Lengths, Origins};
use sinew::tracking::hmc_filter;
use sinew_simulate::detector::DetectorNoise;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::evaluation;
use sinew_tests::simulated_source::source;
use std::collections::BTreeSet;
use std::fs;
use std::sync::{Arc, OnceLock};

const FRAMES: u64 = 36;

fn film(noise: DetectorNoise) -> SyntheticRecording {
    SyntheticRecording::new(&Script { duration_s: FRAMES as f64 / 30.0, noise, ..Script::default() }, 5).unwrap()
}

fn right() -> DetectorNoise {
    DetectorNoise::stated_gaussian(3.0)
}

/// The same digits on every processor, and quick.
fn settings() -> Settings {
    let hmc = hmc_filter::Config { chains: 8, updates: 12, burn_in: 3, ..HmcMethod::default().0 };
    Settings { isa: Isa::baseline(), method: Arc::new(HmcMethod(hmc)), ..Settings::default() }
}

/// A set-up from keypoints with the noise that is assumed.
fn set_up() -> &'static Setup {
    static SETUP: OnceLock<Setup> = OnceLock::new();
    SETUP.get_or_init(|| evaluation::set_up(&mut source(&film(right())), 0..FRAMES, &settings(), |_| ()).unwrap())
}

fn doubted(noise: DetectorNoise, change: impl FnOnce(&mut Setup)) -> Vec<Doubt> {
    let mut setup = set_up().clone();
    change(&mut setup);
    evaluation::filter(&mut source(&film(noise)), &setup, 0..FRAMES, &settings()).unwrap().doubts
}

/// Each doubt in words; numbers of the first camera only, which is enough to read.
fn words(doubts: &[Doubt]) -> String {
    let all = doubts.iter().map(|doubt| doubt.describe(Origins { setup_is_given: true, ..Origins::default() }) + "\n");
    all.filter(|words| !["C2", "C3", "C4"].iter().any(|camera| words.starts_with(camera))).collect()
}

fn kinds(doubts: &[Doubt]) -> BTreeSet<&'static str> {
    doubts.iter().map(Doubt::kind).collect()
}

#[test]
fn nothing_is_reported_of_keypoints_as_assumed() {
    assert_eq!(doubted(right(), |_| ()), []);
}

#[test]
fn cameras_that_moved_are_reported() {
    let doubts = doubted(DetectorNoise { offset_px: 6.0, ..right() }, |_| ());
    assert!(kinds(&doubts).contains("offset"), "{doubts:?}");
    insta::assert_snapshot!("moved", words(&doubts));
}

#[test]
fn offsets_that_the_set_up_found_are_reported() {
    let noise = DetectorNoise { offset_px: 6.0, ..right() };
    let setup = evaluation::set_up(&mut source(&film(noise)), 0..FRAMES, &settings(), |_| ()).unwrap();
    let doubts = evaluation::filter(&mut source(&film(noise)), &setup, 0..FRAMES, &settings()).unwrap().doubts;
    assert_eq!(kinds(&doubts), BTreeSet::from(["calibration"]));
    insta::assert_snapshot!("calibration", words(&doubts));
    // Lengths are called right only by a run whose checks find them right.
    let mut longer = setup;
    longer.proportions.thigh *= 1.05;
    let doubts = evaluation::filter(&mut source(&film(noise)), &longer, 0..FRAMES, &settings()).unwrap().doubts;
    let calibration_lengths =
        |doubt: &Doubt| if let Doubt::Calibration { lengths, .. } = doubt { Some(*lengths) } else { None };
    assert_eq!(doubts.iter().find_map(calibration_lengths), Some(Lengths::Doubted), "{doubts:?}");
}

#[test]
fn noise_that_is_understated_is_reported() {
    let doubts = doubted(right(), |setup| setup.camera.iter_mut().for_each(|camera| camera.sigma_px /= 1.5));
    assert_eq!(kinds(&doubts), BTreeSet::from(["scatter"]));
    insta::assert_snapshot!("understated", words(&doubts));
}

#[test]
fn outliers_beyond_those_assumed_are_reported() {
    let doubts = doubted(DetectorNoise { outlier: 0.08, outlier_px: [40.0, 250.0], ..right() }, |_| ());
    assert_eq!(kinds(&doubts), BTreeSet::from(["outliers"]));
    insta::assert_snapshot!("outliers", words(&doubts));
}

#[test]
fn errors_that_persist_are_reported() {
    let doubts = doubted(DetectorNoise { persistence: 0.8, ..right() }, |_| ());
    assert!(kinds(&doubts).contains("persistence"), "{doubts:?}");
    insta::assert_snapshot!("persistent", words(&doubts));
}

#[test]
fn limbs_of_another_length_are_reported() {
    let doubts = doubted(right(), |setup| {
        let Proportions { upper_arm, forearm, thigh, shin, .. } = &mut setup.proportions;
        [upper_arm, forearm, thigh, shin].into_iter().for_each(|length| *length *= 1.03);
    });
    assert!(kinds(&doubts).contains("limbs"), "{doubts:?}");
    insta::assert_snapshot!("limbs", words(&doubts));
}

#[test]
fn the_program_reports_it_in_the_summary_and_on_the_terminal() {
    let trial = trial(1.0);
    let printed = trial.track_printed(&[]);
    assert!(printed.starts_with("exit 0"), "{printed}");
    trial.edit(&trial.path("out/setup.toml"), |text| {
        let mut lines: Vec<String> = text.lines().map(String::from).collect();
        for line in lines.iter_mut().filter(|line| line.starts_with("thigh = ") || line.starts_with("shin = ")) {
            let (name, length) = line.split_once(" = ").unwrap();
            *line = format!("{name} = {}", 1.05 * length.parse::<f64>().unwrap());
        }
        lines.join("\n") + "\n"
    });
    let printed = trial.track_printed(&["-oagain", "--setup", "out/setup.toml"]);
    let summary: serde_json::Value =
        serde_json::from_slice(&fs::read(trial.path("again/summary.json")).unwrap()).unwrap();
    for limb in ["thighs", "shins"] {
        let warned = summary["warnings"].as_array().unwrap().iter().filter_map(|w| w.as_str());
        assert_eq!(warned.filter(|w| w.starts_with(limb) && w.contains("shorter between")).count(), 1, "{summary}");
        assert!(printed.contains(&format!("{limb}: ")), "{printed}");
    }
}
