//! Do intervals of joint angles, meant over trials, hold the truth?
//!
//! With one set-up for all trials, and with set-ups of their own. A simulated walker a subject, of another size, before cameras that differ from their calibration as real ones do, cut into four trials of two seconds. Sessions have four such subjects before the same cameras, each with two trials. `groups.csv` has the mean over the trials of each angle's mean over time; the truth is that of the true angles. Counted
//! are angles that keypoints show in every frame.

use super::keypoint_tables::write_keypoints;
use crate::intervals::true_angles;
use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown};
use crate::support::statistics::mean_and_error;
use crate::support::table::{header, row, with_spread};
use serde_json::Value;
use sinew::core::random::Stage;
use sinew_simulate::adult;
use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::detector::DetectorNoise;
use sinew_simulate::recording::{Script, SyntheticRecording};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Trials of a subject, and frames of a trial; before them the walker stands.
const TRIALS: usize = 4;
const FRAMES: usize = 60;
const STANDING: usize = 30;
/// Seeds of the subjects begin here.
const FIRST: u64 = 3001;
/// Subjects of a session, and trials of each.
const SUBJECTS: usize = 4;
const TRIALS_IN_SESSION: usize = 2;
/// Seeds of the sessions begin here, and of the subjects of a session at that times this.
const FIRST_SESSION: u64 = 4001;
const SUBJECT_SEEDS: u64 = 100;

/// Inside, error and half-width, means over the angles of a study.
type Held = [f64; 3];

/// Studies by name, each with its rows.
type Rows = BTreeMap<String, Vec<Held>>;

/// The table of one subject a study.
pub(super) fn table(program: &Program, folder: &Path, subjects: usize) -> Outcome<String> {
    let mut rows = Rows::new();
    for seed in (FIRST..).take(subjects) {
        let walks = [SyntheticRecording::new(&script(seed), seed)?];
        for (name, share) in [("one set-up", "session"), ("set-ups of their own", "nothing")] {
            let study = Study::run(program, folder, &walks, TRIALS, share)?;
            rows.entry(name.into()).or_default().push(study.held(program, "folder")?);
        }
    }
    Ok(markdown("set-up of the four trials", &rows))
}

/// The table of sessions: several subjects before the same cameras.
pub(super) fn table_of_sessions(program: &Program, folder: &Path, sessions: usize) -> Outcome<String> {
    let mut rows = Rows::new();
    for session in (FIRST_SESSION..).take(sessions) {
        // What a detector does to all keypoints of a camera alike is not the camera's, and not the same for all subjects.
        let script = |seed| {
            let own = script(seed);
            Script { noise: DetectorNoise { offset_px: 0.0, ..own.noise }, ..own }
        };
        let first = SyntheticRecording::new(&script(session), session)?;
        let walks: Vec<SyntheticRecording> = (0..SUBJECTS as u64)
            .map(|subject| SUBJECT_SEEDS * session + subject)
            .map(|seed| SyntheticRecording::in_session(&script(seed), &first.cameras, session, seed))
            .collect();
        for share in ["session", "subject"] {
            let study = Study::run(program, folder, &walks, TRIALS_IN_SESSION, share)?;
            for (by, of) in [("subject", "means of a subject"), ("all", "mean of all subjects")] {
                rows.entry(format!("{of}, `--share {share}`")).or_default().push(study.held(program, by)?);
            }
        }
    }
    Ok(markdown("sessions of four subjects", &rows))
}

fn markdown(what: &str, rows: &Rows) -> String {
    let mut text = header(&format!("| {what} | inside 90 % intervals, % | mean error, ° | half-width, ° |"));
    for (name, studies) in rows {
        let column = |place: usize, factor: f64| {
            with_spread(mean_and_error(&studies.iter().map(|held| factor * held[place]).collect::<Vec<f64>>()), 2)
        };
        row!(text, "{name} | {} | {} | {}", column(0, 100.0), column(1, 1.0), column(2, 1.0));
    }
    text
}

fn script(seed: u64) -> Script {
    let frames = STANDING + TRIALS * FRAMES;
    let base = Script::default();
    Script {
        duration_s: (frames + 1) as f64 / base.rate_hz,
        proportions: adult::drawn(&Stage::new(seed, "walker")),
        calibration: CalibrationError::USUAL,
        ..base
    }
}

/// Frames of a trial in the walk.
fn frames(trial: usize) -> Range<usize> {
    let first = STANDING + trial * FRAMES;
    first..first + FRAMES
}

fn write_trials(walk: &SyntheticRecording, folder: &Path, settings: &str, trials: usize) -> Outcome<()> {
    fs::create_dir_all(folder)?;
    fs::write(folder.join("Calib.toml"), walk.calibration_toml())?;
    let rate = walk.rate_hz;
    fs::write(
        folder.join("sinew.toml"),
        format!("root = true\ncalibration = \"Calib.toml\"\nfps = {rate}\nlayout = \"BODY_25B\"\n{settings}"),
    )?;
    for trial in 0..trials {
        let own = folder.join(format!("T{trial}"));
        for (camera, keypoints) in walk.cameras.iter().zip(&walk.keypoints) {
            write_keypoints(walk, camera, &keypoints[frames(trial)], &own)?;
        }
    }
    Ok(())
}

/// A study that was run, with what it recorded.
struct Study<'a> {
    walks: &'a [SyntheticRecording],
    trials: usize,
    folder: PathBuf,
}

impl<'a> Study<'a> {
    /// Records and tracks the first trials of some subjects.
    fn run(
        program: &Program,
        folder: &Path,
        walks: &'a [SyntheticRecording],
        trials: usize,
        share: &str,
    ) -> Outcome<Self> {
        let folder = folder.join("groups");
        if folder.exists() {
            fs::remove_dir_all(&folder)?;
        }
        for (subject, walk) in walks.iter().enumerate() {
            write_trials(
                walk,
                &folder.join(format!("trials/S{subject}")),
                &format!("subject = \"S{subject}\"\n"),
                trials,
            )?;
        }
        let (of, study) = (shown(&folder.join("trials")), shown(&folder.join("study")));
        command(program, &["batch", "plan", &of, "-o", &study, "--share", share])?;
        command(program, &["batch", "run", &study, "-qq"])?;
        Ok(Self { walks, trials, folder })
    }

    /// Angles that keypoints do not show in some trial.
    fn unseen(&self) -> Outcome<BTreeSet<String>> {
        let mut unseen = BTreeSet::new();
        for (subject, trial) in (0..self.walks.len()).flat_map(|subject| (0..self.trials).map(move |t| (subject, t))) {
            let path = self.folder.join(format!("study/results/S{subject}/T{trial}/summary.json"));
            let summary: Value = serde_json::from_str(&fs::read_to_string(path)?)?;
            unseen.extend(summary["angles"]["unseen"].as_object().into_iter().flat_map(|all| all.keys().cloned()));
        }
        Ok(unseen)
    }

    /// The true mean of each angle over time and trials, of one subject or of all.
    fn truth(&self, group: &str) -> Outcome<BTreeMap<String, f64>> {
        let own = group.strip_prefix('S').and_then(|number| number.parse::<usize>().ok());
        let walks: Vec<_> = own.map_or(self.walks.iter().collect(), |own| vec![&self.walks[own]]);
        let mut truth: BTreeMap<String, f64> = BTreeMap::new();
        for walk in &walks {
            for state in (0..self.trials).flat_map(frames).map(|frame| &walk.states[frame]) {
                for (name, angle) in true_angles(&walk.body, state)? {
                    *truth.entry(name).or_default() += angle / (walks.len() * self.trials * FRAMES) as f64;
                }
            }
        }
        Ok(truth)
    }

    /// Its groups against the truth.
    fn held(&self, program: &Program, by: &str) -> Outcome<Held> {
        let study = self.folder.join("study");
        command(program, &["batch", "gather", &shown(&study), "--by", by])?;
        let unseen = self.unseen()?;
        let mut truths: BTreeMap<String, BTreeMap<String, f64>> = BTreeMap::new();
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for line in fs::read_to_string(study.join("groups.csv"))?.lines().skip(1) {
            let cells: Vec<&str> = line.split(',').collect();
            let [group, angle, _, _, mean, low, high, _] = cells[..] else {
                return Err(format!("a row `{line}`").into());
            };
            if unseen.contains(angle) {
                continue;
            }
            if !truths.contains_key(group) {
                truths.insert(group.to_owned(), self.truth(group)?);
            }
            let known = truths[group].get(angle).ok_or(format!("no truth of {angle}"))?;
            let (mean, low, high): (f64, f64, f64) = (mean.parse()?, low.parse()?, high.parse()?);
            sum[0] += f64::from(u8::from((low..=high).contains(known)));
            sum[1] += (mean - known).abs();
            sum[2] += 0.5 * (high - low);
            count += 1.0;
        }
        Ok(sum.map(|sum| sum / count))
    }
}

fn command(program: &Program, arguments: &[&str]) -> Outcome<()> {
    program.run(&arguments.iter().map(|text| (*text).to_owned()).collect::<Vec<_>>(), &[0, 4]).map(drop)
}
