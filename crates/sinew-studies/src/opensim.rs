//! `cargo xtask study opensim`: our joint angles beside OpenSim's inverse kinematics on the same markers. The tables of docs/evidence/opensim.md.
//!
//! The program tracks a recording; `crates/sinew-studies/peers/opensim_ik.py` scales Pose2Sim's OpenSim model by the run's `markers.trc` and fits it to them. Python packages are installed, pinned, into an environment of the study's folder.

mod compared;

use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown};
use crate::support::study_options::ProgramOptions;
use compared::{Angles, Compared};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What to run.
#[derive(clap::Args)]
pub struct Args {
    /// Seeds of each recording, from 1 on
    #[arg(long, default_value_t = 5)]
    seeds: u64,
    #[command(flatten)]
    options: ProgramOptions,
    /// The Python that makes the environment; `opensim` has wheels for 3.10 to 3.13
    #[arg(long, default_value = "python3")]
    python: PathBuf,
}

/// A recording: its name here, its folder, flags of `track` with paths in the folder, and the people with their names.
struct Recording {
    name: &'static str,
    folder: &'static str,
    flags: &'static [&'static str],
    inputs: [&'static str; 2],
    markers: &'static str,
    people: &'static [(&'static str, &'static str)],
}

const RECORDINGS: [Recording; 3] = [
    Recording {
        name: "single",
        folder: "pose2sim_single",
        flags: &["--layout", "BODY_25B", "--fps", "60"],
        inputs: ["Calib.toml", "T01_BalancingTrial/pose"],
        markers: "Body25b",
        people: &[("pose2sim_single", "")],
    },
    Recording {
        name: "two",
        folder: "pose2sim_two_people",
        flags: &["--layout", "BODY_25B", "--fps", "60", "--people", "all"],
        inputs: ["Calib.toml", "pose"],
        markers: "Body25b",
        people: &[("pose2sim_two_people, who sits", "people/01"), ("pose2sim_two_people, who steps", "people/02")],
    },
    Recording {
        name: "gesture",
        folder: "caliscope_gesture",
        flags: &["--fps", "30", "--up", "auto"],
        inputs: ["camera_array.toml", "xy_HOLISTIC.csv"],
        markers: "BlazePose",
        people: &[("caliscope_gesture", "")],
    },
];

/// Pose2Sim's own triangulation of the first recording.
const THEIR_MARKERS: &str =
    "pose2sim_single/T01_BalancingTrial/pose-3d/S00_P00_T01_BalancingTrial_0-100_filt_butterworth.trc";
/// The model of all tables but where another is named, and Pose2Sim's other one.
const MODELS: [&str; 2] = ["Model_Pose2Sim_simple.osim", "Model_Pose2Sim_muscles_flex.osim"];

/// The environment of the script.
struct Python {
    program: PathBuf,
    script: PathBuf,
}

/// Runs a command whose words are shown only where it fails.
fn succeeded(command: &mut Command) -> Outcome<()> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    if output.status.success() {
        return Ok(());
    }
    let said = [output.stdout, output.stderr].map(|said| String::from_utf8_lossy(&said).into_owned());
    Err(format!("{command:?}: {}\n{}", output.status, said.concat()).into())
}

impl Python {
    /// Makes the environment, unless one with the same requirements is there.
    fn installed(root: &Path, folder: &Path, python: &Path) -> Outcome<Self> {
        let peers = root.join("crates/sinew-studies/peers");
        let requirements = peers.join("opensim_requirements.txt");
        let (place, wanted) = (folder.join("environment"), fs::read_to_string(&requirements)?);
        let (program, stamp) = (place.join("bin/python"), place.join("requirements.txt"));
        if fs::read_to_string(&stamp).ok().as_ref() != Some(&wanted) {
            succeeded(Command::new(python).args(["-m", "venv", "--clear"]).arg(&place))?;
            // Pose2Sim is there for its models alone, so what it needs to run is left out.
            let install = ["-m", "pip", "install", "--quiet", "--no-deps", "-r"];
            succeeded(Command::new(&program).args(install).arg(&requirements))?;
            fs::write(&stamp, wanted)?;
        }
        Ok(Self { program, script: peers.join("opensim_ik.py") })
    }

    /// Inverse kinematics of a file of markers.
    fn fitted(&self, set: &str, markers: &Path, out: &Path, model: &str) -> Outcome<()> {
        let mut command = Command::new(&self.program);
        succeeded(command.arg(&self.script).arg(set).arg(markers).arg(out).args(["--model", model]))
    }
}

/// Tracks a recording with a seed and fits the model to each of its people.
fn compared(study: &Study<'_>, recording: &Recording, seed: u64) -> Outcome<Vec<Compared>> {
    let data = study.data.join(recording.folder);
    let (out, seed) = (study.folder.join(format!("{}-{seed}", recording.name)), seed.to_string());
    let [calibration, keypoints] = recording.inputs.map(|input| shown(&data.join(input)));
    let inputs = ["--calibration", &calibration, "--keypoints", &keypoints];
    let rest = ["--seed", &seed, "--simd", "baseline", "--force", "--no-progress"];
    let flags = inputs.iter().chain(recording.flags).chain(&rest).map(|&flag| flag.to_owned()).collect::<Vec<_>>();
    study.program.track(&flags, &out)?;
    let person = |(_, place): &(&str, &str)| {
        let run = out.join(place);
        let fit = run.join("opensim");
        study.python.fitted(recording.markers, &run.join("markers.trc"), &fit, MODELS[0])?;
        Compared::read(&Angles::read(&run.join("angles.mot"))?, &fit)
    };
    recording.people.iter().map(person).collect()
}

/// What a study has at hand.
struct Study<'a> {
    program: Program,
    python: Python,
    data: &'a Path,
    folder: &'a Path,
}

/// How much inverse kinematics varies by itself: of other markers of the same motion, and of Pose2Sim's other model.
fn variation(study: &Study<'_>) -> Outcome<String> {
    let ours = study.folder.join("single-1");
    let [theirs, muscles] = ["their-markers", "their-model"].map(|name| study.folder.join(name));
    study.python.fitted("Body25b", &study.data.join(THEIR_MARKERS), &theirs, MODELS[0])?;
    study.python.fitted("Body25b", &ours.join("markers.trc"), &muscles, MODELS[1])?;
    let usual = Angles::read(&ours.join("opensim/ik.mot"))?;
    let others = [theirs, muscles].map(|folder| Angles::read(&folder.join("ik.mot")));
    let [theirs, muscles] = others;
    Ok(compared::variation(&usual, &[theirs?, muscles?]))
}

/// Runs the command.
pub fn run(root: &Path, args: &Args) -> Outcome<()> {
    let (data, program) = (args.options.data(root), args.options.program(root, "opensim")?);
    let folder = program.folder.clone();
    let python = Python::installed(root, &folder, &args.python)?;
    let study = Study { program, python, data: &data, folder: &folder };
    let mut text = String::new();
    for recording in &RECORDINGS {
        let mut people: Vec<Vec<Compared>> = recording.people.iter().map(|_| vec![]).collect();
        for seed in 1..=args.seeds {
            for (seeds, found) in people.iter_mut().zip(compared(&study, recording, seed)?) {
                seeds.push(found);
            }
        }
        for ((name, _), seeds) in recording.people.iter().zip(&people) {
            text += &format!("{name}:\n\n{}\n", compared::table(seeds));
        }
    }
    text += &format!("Inverse kinematics alone:\n\n{}\n", variation(&study)?);
    text += &format!("Markers:\n\n{}", compared::markers(&folder.join("single-1/opensim"))?);
    println!("{text}");
    Ok(fs::write(folder.join("tables.md"), text)?)
}
