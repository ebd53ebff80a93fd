//! The recordings that are tracked, and models learned from other walks.
//!
//! Simulated people move as a recorded walker does; models are learned from other walks of the same walker. One recording is real.

use super::entries::{ENTRIES, Entry, Learned, Seen};
use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown};
use std::path::{Path, PathBuf};

/// Recorded walks that are tracked, and those that models learn from, all of one walker.
const TEST: [&str; 4] = ["07_01", "07_04", "07_07", "07_09"];
const TRAINING: [&str; 5] = ["07_02", "07_05", "07_06", "07_08", "07_10"];
const SUBJECT: &str = "07.asf";
/// Frames per second of simulated people.
const RATE_HZ: u32 = 30;
/// Frames per second of the real recording.
const REAL_HZ: u32 = 60;
const REFERENCE: &str = "T01_BalancingTrial/pose-3d/S00_P00_T01_BalancingTrial_0-100_filt_butterworth.trc";

/// The file of a learned model.
fn model_file(program: &Program, learned: Learned, hz: u32) -> PathBuf {
    program.folder.join(format!("{}-{hz}.json", learned.name()))
}

/// Flags for the model of a tracker.
pub(super) fn model_flags(program: &Program, entry: &Entry, film: &Film) -> Outcome<Vec<String>> {
    let Some(learned) = entry.learned else { return Ok(vec![]) };
    let file = shown(&model_file(program, learned, film.hz));
    Ok(["--body", learned.body(), learned.flag(), &file].map(str::to_owned).to_vec())
}

/// A recording.
pub(super) struct Film {
    pub(super) name: String,
    pub(super) hz: u32,
    source: Source,
}

enum Source {
    /// Folders of simulated people, by seed.
    Simulated(Vec<PathBuf>),
    /// The folder of the real recordings.
    Real(PathBuf),
}

impl Film {
    pub(super) const fn is_real(&self) -> bool {
        matches!(self.source, Source::Real(_))
    }

    /// Flags for what is seen.
    pub(super) fn flags(&self, seen: Seen, seed: u64) -> Vec<String> {
        let (calibration, keypoints, masks, init, scale) = match &self.source {
            Source::Simulated(folders) => {
                let at = |name: &str| shown(&folders[seed as usize - 1].join(name));
                (at("Calib.toml"), at("keypoints"), at("masks"), at("truth.trc"), "1")
            }
            Source::Real(data) => {
                let at = |name: &str| shown(&data.join(name));
                let keypoints = at("pose2sim_single/T01_BalancingTrial/pose");
                let masks = at("pose2sim_silhouettes/silhouettes");
                (at("pose2sim_single/Calib.toml"), keypoints, masks, "keypoints".to_owned(), "0.5")
            }
        };
        let hz = self.hz.to_string();
        let mut flags = vec!["--calibration", &calibration, "--fps", &hz];
        if seen == Seen::Keypoints || self.is_real() {
            flags.extend(["--keypoints", &keypoints, "--layout", "BODY_25B"]);
        }
        if seen == Seen::Masks {
            flags.extend(["--silhouettes", &masks, "--init", &init, "--mask-scale", scale]);
        }
        flags.into_iter().map(str::to_owned).collect()
    }

    /// The file of true joints, or of the reference.
    pub(super) fn truth(&self, seed: u64) -> Outcome<PathBuf> {
        Ok(match &self.source {
            Source::Simulated(folders) => folders.get(seed as usize - 1).ok_or("no such seed")?.join("truth.trc"),
            Source::Real(data) => data.join("pose2sim_single").join(REFERENCE),
        })
    }
}

/// The name of a run.
pub(super) fn key(film: &Film, entry: &Entry, seed: u64) -> String {
    format!("{}/{}/{}/{seed}", film.name, entry.method, entry.seen.name())
}

/// All recordings; simulated ones are made where they are not there yet.
pub(super) fn all(program: &Program, data: &Path, seeds: u64) -> Outcome<Vec<Film>> {
    let cmu = data.join("cmu_amc");
    if !cmu.is_dir() {
        return Err(format!("no recordings in {}", data.display()).into());
    }
    let mut films = vec![];
    for trial in TEST {
        let mut folders = vec![];
        for seed in 1..=seeds {
            let folder = program.folder.join(format!("{trial}-{seed}"));
            if !folder.join("truth.trc").is_file() {
                let motion = shown(&cmu.join(trial).with_extension("amc"));
                let (skeleton, out, seed) = (shown(&cmu.join(SUBJECT)), shown(&folder), seed.to_string());
                let flags = ["simulate", "--motion", &motion, "--skeleton", &skeleton, "--fps", &RATE_HZ.to_string()];
                let rest = ["--images", "none", "--seed", &seed, "-o", &out, "--force", "--no-progress"];
                program.run(&[&flags[..], &rest].concat().into_iter().map(str::to_owned).collect::<Vec<_>>(), &[0])?;
            }
            folders.push(folder);
        }
        films.push(Film { name: trial.into(), hz: RATE_HZ, source: Source::Simulated(folders) });
    }
    films.push(Film { name: "real".into(), hz: REAL_HZ, source: Source::Real(data.to_owned()) });
    Ok(films)
}

/// Learns what trackers need, at the rate of each recording, where it is not there yet.
pub(super) fn learn(program: &Program, data: &Path, films: &[Film]) -> Outcome<()> {
    let cmu = data.join("cmu_amc");
    let mut rates: Vec<u32> = films.iter().map(|film| film.hz).collect();
    rates.dedup();
    let needed = |learned: &Learned| ENTRIES.iter().any(|entry| entry.learned == Some(*learned));
    for learned in Learned::ALL.into_iter().filter(needed) {
        for &hz in &rates {
            let out = model_file(program, learned, hz);
            if out.is_file() {
                continue;
            }
            let what: &[&str] = match learned {
                Learned::Primitives => &["learn", "primitives"],
                Learned::Gpdm | Learned::Hgplvm => &["learn", "latent", "--model", learned.name()],
            };
            let (hz, out, skeleton) = (hz.to_string(), shown(&out), shown(&cmu.join(SUBJECT)));
            let mut flags: Vec<String> = what.iter().map(|&flag| flag.to_owned()).collect();
            flags.push("--motion".into());
            flags.extend(TRAINING.map(|trial| shown(&cmu.join(trial).with_extension("amc"))));
            let rest = ["--skeleton", &skeleton, "--body", learned.body(), "--fps", &hz, "-o", &out, "--no-progress"];
            flags.extend(rest.map(str::to_owned));
            program.run(&flags, &[0])?;
        }
    }
    Ok(())
}
