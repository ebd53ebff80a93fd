//! What users compute from draws: angles, lengths of segments, distances between joints, displacements over a second.
//!
//! Demos of many seeds, filtered and smoothed, truths ranked among the draws. The same demos give the reliability of coordinates, and that of runs as they were before what lasts was in the intervals.

use super::before::{self, Input};
use super::posterior::Drawn;
use super::protocol::{CURVE, DERIVED, DRAWS, FIRST_DERIVED, LAYOUT, NOMINAL};
use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown};
use crate::support::statistics::{mean_and_error, verdict};
use crate::support::store::{Store, numbers};
use crate::support::table::{header, row, with_spread};
use serde_json::{Map, Value, json};
use sinew::body::standard::EVALUATION_JOINTS;
use sinew::body::{Joint, KinematicTree};
use sinew::core::random::Stage;
use sinew::formats::trc;
use sinew::setup::Setup;
use sinew_simulate::adult;
use sinew_simulate::recording::{Script, SyntheticRecording};
use sinew_tests::evaluation::ranks;
use std::ops::Range;
use std::path::Path;

/// Ends of the segments whose lengths are computed.
pub(super) const SEGMENTS: [[&str; 2]; 8] = [
    ["LHip", "LKnee"],
    ["RHip", "RKnee"],
    ["LKnee", "LAnkle"],
    ["RKnee", "RAnkle"],
    ["LShoulder", "LElbow"],
    ["RShoulder", "RElbow"],
    ["LElbow", "LWrist"],
    ["RElbow", "RWrist"],
];
const DISTANCES: [[&str; 2]; 5] =
    [["LWrist", "RWrist"], ["LAnkle", "RAnkle"], ["LKnee", "RKnee"], ["RWrist", "LAnkle"], ["LShoulder", "RHip"]];
/// Names of the hinges' angles.
const HINGES: [&str; 4] = ["l_shin.rx", "r_shin.rx", "l_forearm.rx", "r_forearm.rx"];

/// What is computed: key and name.
const WHAT: [(&str, &str); 6] = [
    ("hinges", "flexion of knees and elbows"),
    ("angles", "all angles of the limbs"),
    ("segments", "lengths of segments"),
    ("distances", "distances between two joints"),
    ("displacements", "displacements of a joint over a second, by axis"),
    ("coordinates", "coordinates of joints"),
];

/// What is true of a run: in each frame the points of the body, in its order, and its state.
pub(super) struct Truth {
    pub(super) frames: Vec<Vec<[f64; 3]>>,
    pub(super) states: Vec<Vec<f64>>,
    pub(super) rate_hz: usize,
}

/// The draws of a run.
pub(super) struct Run {
    body: KinematicTree,
    markers: Drawn,
    angles: Drawn,
}

impl Run {
    pub(super) fn read(folder: &Path) -> Outcome<Self> {
        let setup = Setup::from_toml("setup.toml", &std::fs::read_to_string(folder.join("setup.toml"))?)?;
        let (markers, angles) = (Drawn::read(folder, "marker_position")?, Drawn::read(folder, "angle")?);
        Ok(Self { body: setup.tree(), markers, angles })
    }

    fn point(&self, name: &str) -> Outcome<usize> {
        Ok(self.body.point_index(name).ok_or(format!("the body lacks {name}"))?)
    }

    fn points<const N: usize>(&self, names: &[[&str; N]]) -> Outcome<Vec<Vec<usize>>> {
        names.iter().map(|names| names.iter().map(|name| self.point(name)).collect()).collect()
    }

    /// The rank of what follows from where points are: `value` takes what gives the place of a point in a frame.
    fn rank(&self, truth: &Truth, value: impl Fn(&dyn Fn(usize, usize) -> [f64; 3]) -> f64) -> u32 {
        let at_truth = value(&|frame, point| truth.frames[frame][point]);
        self.markers.rank(at_truth, |draw| value(&|frame, point| self.markers.point(draw, frame, point)))
    }
}

/// The truth that a demo wrote, points in the order of the body, and the states that it has from the same walker.
fn truth(folder: &Path, body: &KinematicTree, seed: u64) -> Outcome<Truth> {
    let points = trc::read("truth.trc", &std::fs::read_to_string(folder.join("truth.trc"))?)?;
    let script = Script { proportions: adult::drawn(&Stage::new(seed, "walker")), ..Script::default() };
    let walker = SyntheticRecording::new(&script, seed)?;
    let columns: Vec<usize> = body
        .points()
        .iter()
        .map(|point| points.marker_index(&point.name).ok_or(format!("no truth of {}", point.name)))
        .collect::<Result<_, _>>()?;
    let place = |frame, column| points.point_in_world(frame, column).ok_or("a gap in the truth");
    let frames: Vec<Vec<[f64; 3]>> = (0..walker.states.len())
        .map(|frame| columns.iter().map(|column| place(frame, *column)).collect::<Result<_, _>>())
        .collect::<Result<_, _>>()?;
    let own = walker.truth.select(&body.points().iter().map(|point| point.name.as_str()).collect::<Vec<_>>());
    let is_same = |(a, b): (&[f64; 3], &[f64; 3])| distance(*a, *b) < 1e-5;
    if !frames.iter().flatten().zip(own.frames.iter().flatten()).all(is_same) {
        return Err("the demo walks otherwise".into());
    }
    Ok(Truth { frames, states: walker.states, rate_hz: walker.rate_hz as usize })
}

pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

/// Ranks in some frames, by what is computed.
pub(super) fn ranked(run: &Run, truth: &Truth, frames: &[usize]) -> Outcome<Vec<(&'static str, Vec<u32>)>> {
    let second = truth.rate_hz;
    let joints: Vec<usize> = EVALUATION_JOINTS.iter().map(|name| run.point(name)).collect::<Outcome<_>>()?;
    let between = |pairs: &[[&str; 2]]| -> Outcome<Vec<u32>> {
        let pairs = run.points(pairs)?;
        let all = frames.iter().flat_map(|&frame| pairs.iter().map(move |pair| (frame, pair[0], pair[1])));
        Ok(all.map(|(frame, a, b)| run.rank(truth, |at| distance(at(frame, a), at(frame, b)))).collect())
    };
    let on_axes = || {
        let joints = &joints;
        let axes = move |&frame: &usize| joints.iter().flat_map(move |&j| (0..3).map(move |axis| (frame, j, axis)));
        frames.iter().flat_map(axes)
    };
    let moved = |(f, joint, axis): (usize, usize, usize)| {
        run.rank(truth, |at| at(f + second, joint)[axis] - at(f, joint)[axis])
    };
    let coordinate = |(f, joint, axis): (usize, usize, usize)| run.rank(truth, |at| at(f, joint)[axis]);
    let has_second = |(frame, ..): &(usize, usize, usize)| frame + second < truth.frames.len();
    Ok(vec![
        ("hinges", angles(run, truth, frames, |name| HINGES.contains(&name))),
        ("angles", angles(run, truth, frames, |_| true)),
        ("segments", between(&SEGMENTS)?),
        ("distances", between(&DISTANCES)?),
        ("displacements", on_axes().filter(has_second).map(moved).collect()),
        ("coordinates", on_axes().map(coordinate).collect()),
    ])
}

/// Angles of the limbs of a body: their places among all angles, and their names.
pub(super) fn limb_angles(body: &KinematicTree) -> Vec<(usize, String)> {
    let names = body.dof_names();
    let rotations = body.joints().enumerate().filter(|(_, (_, joint))| matches!(joint, Joint::Rotate(_)));
    let named = rotations.enumerate().map(|(angle, (dof, _))| (angle, names[dof].clone()));
    named.filter(|(_, name)| name.starts_with("l_") || name.starts_with("r_")).collect()
}

/// Ranks of the angles of limbs that are wanted.
fn angles(run: &Run, truth: &Truth, frames: &[usize], is_wanted: impl Fn(&str) -> bool) -> Vec<u32> {
    let names = run.body.dof_names();
    let wanted: Vec<(usize, usize)> = limb_angles(&run.body)
        .into_iter()
        .filter(|(_, name)| is_wanted(name))
        .filter_map(|(angle, name)| Some((angle, names.iter().position(|own| *own == name)?)))
        .collect();
    let all = frames.iter().flat_map(|&frame| wanted.iter().map(move |&(angle, dof)| (frame, angle, dof)));
    all.map(|(frame, angle, dof)| run.angles.rank(truth.states[frame][dof], |draw| run.angles.at(draw, frame)[angle]))
        .collect()
}

/// Share inside central intervals of each level.
fn curve(ranks: &[u32]) -> [f64; CURVE.len()] {
    CURVE.map(|level| ranks::coverage(ranks, DRAWS, level))
}

/// Curves of a run by what is computed.
fn curves_of(run: &Path, demo: &Path, seed: u64) -> Outcome<Value> {
    let run = Run::read(run)?;
    let truth = truth(demo, &run.body, seed)?;
    let ranked = ranked(&run, &truth, &(0..truth.states.len()).collect::<Vec<_>>())?;
    Ok(ranked.into_iter().map(|(key, ranks)| (key.to_owned(), json!(curve(&ranks)))).collect::<Map<_, _>>().into())
}

/// The demo of a folder tracked as it was before.
fn tracked_before(program: &Program, demo: &Path, flags: &[String], folder: &Path) -> Outcome<()> {
    let (calibration, keypoints) = (demo.join("Calib.toml"), demo.join("keypoints"));
    let fps = Script::default().rate_hz;
    let cameras = ["C1", "C2", "C3", "C4"];
    let input = Input { calibration: &calibration, keypoints: &keypoints, cameras: &cameras, fps };
    let (calibrated, seen, fps, draws) = (shown(&calibration), shown(&keypoints), fps.to_string(), DRAWS.to_string());
    let files = ["--calibration", &calibrated, "--keypoints", &seen, "--layout", LAYOUT];
    let rest = ["--fps", &fps, "--draws", &draws];
    let own = files.into_iter().chain(rest).map(str::to_owned).collect::<Vec<_>>();
    before::track(program, &input, &[flags, own.as_slice()].concat(), folder)?;
    Ok(())
}

/// Demos of a seed: filtered, smoothed, and as it was before.
pub(super) fn cell(program: &Program, seed: u64) -> Outcome<Value> {
    let [folder, plainly] = ["", "-before"].map(|when| program.folder.join(format!("derived-{seed}{when}")));
    let (out, settings) = (shown(&folder), folder.with_extension("toml"));
    let flags = ["--threads", "1", "--no-progress", "--force", "--seed", &seed.to_string()].map(str::to_owned);
    let demo = ["demo", "--json", "-o", &out, "--config", &shown(&settings)].map(str::to_owned);
    let mut found = Map::new();
    for (kind, smooth) in [("filtered", false), ("smoothed", true)] {
        std::fs::write(&settings, format!("draws = {DRAWS}\nsmooth = {smooth}\n"))?;
        program.run(&[demo.as_slice(), &flags].concat(), &[0, 4])?;
        found.insert(kind.into(), curves_of(&folder, &folder, seed)?);
    }
    tracked_before(program, &folder, &flags, &plainly)?;
    found.insert("before".into(), curves_of(&plainly, &folder, seed)?);
    std::fs::remove_file(&settings)?;
    std::fs::remove_dir_all(&folder)?;
    std::fs::remove_dir_all(&plainly)?;
    Ok(found.into())
}

/// What the names of cells begin with.
pub(super) const CELLS: &str = "derived";

/// Curves of a kind of run over the seeds.
pub(super) fn curves(store: &Store, seeds: Range<u64>, kind: &str, key: &str) -> Vec<Vec<f64>> {
    store.for_seeds(CELLS, seeds).into_iter().map(|cell| numbers(&cell[kind][key])).collect()
}

/// Shares inside 90 % intervals.
pub(super) fn table(store: &Store, seeds: Range<u64>) -> String {
    let nominal = CURVE.iter().position(|level| (100.0 * level - NOMINAL).abs() < 1e-9).unwrap_or_default();
    let count = curves(store, seeds.clone(), "filtered", "hinges").len();
    let mut text =
        format!("{count} demos, seeds from {FIRST_DERIVED}, what follows from draws, inside 90 % intervals:\n\n");
    text += &header("| what | filtered, % | with `--smooth`, % | before, filtered, % | bound | |");
    for (key, name) in WHAT {
        let of = |kind: &str| {
            let shares: Vec<f64> =
                curves(store, seeds.clone(), kind, key).iter().map(|curve| 100.0 * curve[nominal]).collect();
            mean_and_error(&shares)
        };
        let [filtered, smoothed, before] = ["filtered", "smoothed", "before"].map(of);
        // Filtered draws of different frames do not belong together.
        let judged = if key == "displacements" { vec![smoothed] } else { vec![filtered, smoothed] };
        let met = verdict(judged.iter().all(|[share, _]| (share - NOMINAL).abs() <= DERIVED));
        let [filtered, smoothed, before] = [filtered, smoothed, before].map(|share| with_spread(share, 1));
        row!(text, "{name} | {filtered} | {smoothed} | {before} | {NOMINAL} ± {DERIVED} | {met}");
    }
    text
}
