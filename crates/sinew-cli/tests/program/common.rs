//! A synthetic recording on disk and the program to run on it.

pub mod known_answers;
pub mod linear_world;
pub mod path_posterior;
pub mod synthetic;
pub mod tally;
pub mod walks;

use sinew::core::estimators::mean;
use sinew::formats::trc;
use sinew_simulate::recording::{Script, SyntheticRecording};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

/// A folder with a recording, and the program that runs in it.
pub struct Trial {
    /// Removed at the end.
    pub folder: tempfile::TempDir,
}

/// The recording of `duration_s` seconds at 30 frames per second.
pub fn trial(duration_s: f64) -> Trial {
    let folder = tempfile::tempdir().unwrap();
    let recording = SyntheticRecording::new(&Script { duration_s, ..Script::default() }, 7).unwrap();
    let root = folder.path();
    for (name, text) in recording.keypoint_files() {
        let path = root.join("pose").join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    fs::write(root.join("Calib.toml"), recording.calibration_toml()).unwrap();
    Trial { folder }
}

/// What names the real recording of one man and a bystander; `None` where the shared data are missing.
pub fn balancing_trial() -> Option<[String; 3]> {
    let data = sinew_tests::data::shared("pose2sim_single")?;
    let file = |flag: &str, name: &str| format!("--{flag}={}", data.join(name).display());
    Some([file("calibration", "Calib.toml"), file("keypoints", "T01_BalancingTrial/pose"), "--layout=BODY_25B".into()])
}

/// Every file below a folder, by its name.
pub type Files = BTreeMap<String, Vec<u8>>;

/// A folder that several tests begin with: the first that asks makes it, each gets a copy of its files. Results among them name the folder that they were made in.
pub fn made_once(made: &OnceLock<Files>, make: impl FnOnce() -> Trial) -> Trial {
    let made = made.get_or_init(|| files(make().folder.path()));
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    write_files(trial.folder.path(), made);
    trial
}

/// Writes files below a folder.
pub fn write_files(folder: &Path, files: &Files) {
    for (name, bytes) in files {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }
}

/// What `sinew track` needs on every recording here.
pub const TRACK: [&str; 10] = [
    "track",
    "--calibration",
    "Calib.toml",
    "--keypoints",
    "pose",
    "--fps",
    "30",
    "--layout",
    "BODY_25B",
    "--no-progress",
];

/// Settings of the sampler that make a run short, and limits that its diagnostics keep all the same.
pub const QUICK: [&str; 6] =
    ["--updates=4", "--burn-in=1", "--chains=8", "--max-r-hat=1e9", "--max-r-hat-share=1", "--max-divergent-share=1"];

impl Trial {
    /// Path of a file in the folder.
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Keypoint file of a camera and frame.
    pub fn keypoints(&self, camera: usize, frame: usize) -> PathBuf {
        self.path(&format!("pose/C{camera}_json/C{camera}.{frame:04}.json"))
    }

    /// Changes the text of a file.
    pub fn edit(&self, path: &Path, change: impl FnOnce(String) -> String) {
        let text = fs::read_to_string(path).unwrap();
        fs::write(path, change(text)).unwrap();
    }

    /// The program in this folder, without settings of its surroundings.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_sinew"));
        command.current_dir(self.folder.path()).args(arguments);
        for (name, _) in std::env::vars_os().filter(|(name, _)| name.to_string_lossy().starts_with("SINEW_")) {
            command.env_remove(name);
        }
        command
    }

    /// Runs the program.
    pub fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Runs `sinew track` quickly with more arguments, into `out` unless they name another folder.
    pub fn track(&self, more: &[&str]) -> Output {
        let out: &[&str] = if more.iter().any(|argument| argument.starts_with("-o")) { &[] } else { &["-oout"] };
        self.run(&[&TRACK[..], &QUICK, out, more].concat())
    }

    /// Exit code and what stands on stderr, with the folder's name replaced. What depends on chance is left out: residuals, clocks estimated from a few
    /// frames of a person who stands still.
    pub fn printed(&self, output: &Output) -> String {
        let text =
            String::from_utf8_lossy(&output.stderr).replace(&self.folder.path().display().to_string(), "[trial]");
        let by_chance = |line: &&str| ["residual of", "fits best when"].iter().any(|words| line.contains(words));
        let lines: Vec<&str> = text.lines().filter(|line| !by_chance(line)).collect();
        format!("exit {}\n{}", output.status.code().unwrap_or(-1), lines.join("\n"))
    }

    /// As [`Trial::printed`] for `sinew track`.
    pub fn track_printed(&self, more: &[&str]) -> String {
        self.printed(&self.track(more))
    }
}

/// Every file below a folder.
pub fn files(folder: &Path) -> Files {
    let mut found = BTreeMap::new();
    let mut pending = vec![folder.to_owned()];
    while let Some(path) = pending.pop() {
        if path.is_dir() {
            pending.extend(fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
        } else {
            let name = path.strip_prefix(folder).unwrap().display().to_string();
            found.insert(name, fs::read(&path).unwrap());
        }
    }
    found
}

/// Cells of a column of a table.
pub fn column(table: &[u8], name: &str) -> Vec<String> {
    let text = String::from_utf8_lossy(table);
    let mut rows = text.lines().map(|line| line.split(','));
    let place = rows.next().unwrap().position(|column| column == name).unwrap();
    rows.map(|mut row| row.nth(place).unwrap().to_owned()).collect()
}

/// CRC-32 (the polynomial of zip and png), bit by bit: another implementation than the program's.
pub fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg()))
    })
}

/// Joints of the limbs.
const JOINTS: [&str; 12] = [
    "RShoulder",
    "RElbow",
    "RWrist",
    "RHip",
    "RKnee",
    "RAnkle",
    "LShoulder",
    "LElbow",
    "LWrist",
    "LHip",
    "LKnee",
    "LAnkle",
];

/// Mean distance between the limbs' joints of two files, over all frames, millimetres.
pub fn limb_error_mm(trial: &Trial, truth: &str, found: &str) -> f64 {
    let positions = |name: &str| {
        let file = trc::read(name, &fs::read_to_string(trial.path(name)).unwrap()).unwrap();
        let path = |joint: &&'static str| {
            let marker = file.marker_index(joint).unwrap();
            let place = |frame| file.point_in_world(frame, marker).unwrap();
            (*joint, (0..file.frames.len()).map(place).collect::<Vec<_>>())
        };
        JOINTS.iter().map(path).collect::<BTreeMap<_, _>>()
    };
    let (truth, found) = (positions(truth), positions(found));
    let distances: Vec<f64> = JOINTS
        .iter()
        .flat_map(|joint| truth[joint].iter().zip(&found[joint]))
        .map(|(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt())
        .collect();
    assert!(!distances.is_empty() && truth.values().next().map(Vec::len) == found.values().next().map(Vec::len));
    1e3 * distances.iter().sum::<f64>() / distances.len() as f64
}

/// Correlation over draws.
pub fn correlation(one: &[f64], other: &[f64]) -> f64 {
    let product = |a: &[f64], b: &[f64]| -> f64 {
        let (of_a, of_b) = (mean(a), mean(b));
        a.iter().zip(b).map(|(x, y)| (x - of_a) * (y - of_b)).sum()
    };
    product(one, other) / (product(one, one) * product(other, other)).sqrt()
}
