//! Draws answer to what lasts in a straight line: what does that leave out?
//!
//! Of one set-up and some of its draws of g, two runs each: one tracks with ĝ and moves its draws as g asks, the other takes that g for true. The difference of their means is what the straight line leaves out; it is compared with the standard deviation over all draws.

use super::derived::{SEGMENTS, distance, limb_angles};
use super::posterior::Drawn;
use super::protocol::Recording;
use super::rigs;
use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown};
use crate::support::statistics::{mean, quantile};
use crate::support::store::{Store, numbers};
use crate::support::table::{header, row};
use serde_json::{Map, Value, json};
use sinew::body::KinematicTree;
use sinew::body::point_derivatives::lengthened;
use sinew::body::standard::EVALUATION_JOINTS;
use sinew::setup::{MeasuredErrors, Setup};
use sinew_tests::drawn_rig::Rig;
use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Draws of g that are tracked with, of each set-up.
const OWN: usize = 8;

/// Families of numbers: key and name.
const FAMILIES: [(&str, &str); 4] = [
    ("coordinates", "coordinates of joints"),
    ("segments", "lengths of segments"),
    ("upper arms", "angles of the upper arms"),
    ("other limbs", "angles of the other limbs"),
];

/// Families that are angles.
const ANGLES: [&str; 2] = ["upper arms", "other limbs"];

/// Mean and standard deviation over draws of each number, by its family, frame after frame.
type Found = BTreeMap<&'static str, Vec<[f64; 2]>>;

/// Mean and standard deviation over draws; angles are taken on the circle.
fn moments(draws: usize, is_angle: bool, from_draw: impl Fn(usize) -> f64) -> [f64; 2] {
    let first = from_draw(0);
    let away = |draw| difference(is_angle, from_draw(draw), first);
    let centre = mean((0..draws).map(away));
    [first + centre, mean((0..draws).map(|draw| (away(draw) - centre).powi(2))).sqrt()]
}

/// a − b, of angles the shortest way.
fn difference(is_angle: bool, a: f64, b: f64) -> f64 {
    if is_angle { (a - b + PI).rem_euclid(TAU) - PI } else { a - b }
}

fn found(folder: &Path, body: &KinematicTree) -> Outcome<Found> {
    let (markers, angles) = (Drawn::read(folder, "marker_position")?, Drawn::read(folder, "angle")?);
    let point = |name: &str| body.point_index(name).ok_or(format!("the body lacks {name}"));
    let joints: Vec<usize> = EVALUATION_JOINTS.iter().map(|name| point(name)).collect::<Result<_, _>>()?;
    let segments: Vec<[usize; 2]> =
        SEGMENTS.iter().map(|[a, b]| Ok([point(a)?, point(b)?])).collect::<Result<_, String>>()?;
    let mut all = Found::new();
    for frame in 0..markers.frames {
        for (joint, axis) in joints.iter().flat_map(|joint| (0..3).map(move |axis| (*joint, axis))) {
            let numbers = moments(markers.draws, false, |draw| markers.point(draw, frame, joint)[axis]);
            all.entry("coordinates").or_default().push(numbers);
        }
        for [a, b] in &segments {
            let long = |draw| distance(markers.point(draw, frame, *a), markers.point(draw, frame, *b));
            all.entry("segments").or_default().push(moments(markers.draws, false, long));
        }
        for (angle, name) in limb_angles(body) {
            let family = if name.contains("upper_arm") { "upper arms" } else { "other limbs" };
            all.entry(family).or_default().push(moments(angles.draws, true, |draw| angles.at(draw, frame)[angle]));
        }
    }
    Ok(all)
}

/// The set-up that has one draw of g for all that is known, and the one that takes it for true.
fn with_draw(setup: &Setup, draw: usize) -> Outcome<[Setup; 2]> {
    let without = "a set-up without what lasts";
    let layout = setup.lasting.as_ref().ok_or(without)?.layout();
    let [mut moved, mut own] = [setup.clone(), setup.clone()];
    let moved_errors = moved.lasting.as_mut().ok_or(without)?;
    let own_errors = own.lasting.as_mut().ok_or(without)?;
    let mut longer = vec![];
    for (place, (moved, own)) in moved_errors.number.iter_mut().zip(&mut own_errors.number).enumerate() {
        let by = moved.draws[draw];
        moved.draws.fill(by);
        own.draws.fill(0.0);
        if layout.lengths().contains(&place) {
            longer.push(by);
        } else {
            own.value += by;
        }
    }
    own.proportions = lengthened(&own.proportions, &longer);
    Ok([moved, own])
}

/// Median, and 90th percentile, of what the straight line leaves out, in standard deviations, by family.
fn left_out(program: &Program, flags: &[String], folder: &Path) -> Outcome<Value> {
    std::fs::create_dir_all(folder)?;
    let run = |name: &str, setup: Option<&Setup>| -> Outcome<PathBuf> {
        let (out, path) = (folder.join(name), folder.join(format!("{name}.toml")));
        let mut all = flags.to_vec();
        if let Some(setup) = setup {
            std::fs::write(&path, toml::to_string(setup)?)?;
            all.extend(["--setup".to_owned(), shown(&path)]);
        }
        program.track(&all, &out)?;
        Ok(out)
    };
    let base = run("base", None)?;
    let setup = Setup::from_toml("setup.toml", &std::fs::read_to_string(base.join("setup.toml"))?)?;
    let total = found(&base, &setup.tree())?;
    let draws = setup.lasting.as_ref().map_or(0, MeasuredErrors::draws);
    let mut away: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for draw in (0..OWN).map(|k| k * draws / OWN) {
        let [moved, own] = with_draw(&setup, draw)?;
        let straight = found(&run("moved", Some(&moved))?, &moved.tree())?;
        let taken_for_true = found(&run("own", Some(&own))?, &own.tree())?;
        for (family, total) in &total {
            let both = straight[family].iter().zip(&taken_for_true[family]).zip(total);
            let is_angle = ANGLES.contains(family);
            let one = |((moved, own), [_, sd]): ((&[f64; 2], &[f64; 2]), &[f64; 2])| {
                difference(is_angle, own[0], moved[0]).abs() / sd
            };
            away.entry(family).or_default().extend(both.map(one));
        }
    }
    std::fs::remove_dir_all(folder)?;
    let each =
        |(family, away): (&str, Vec<f64>)| (family.to_owned(), json!([quantile(&away, 0.5), quantile(&away, 0.9)]));
    Ok(away.into_iter().map(each).collect::<Map<_, _>>().into())
}

/// The recording that was tuned on, all cameras.
pub(super) fn recording_cell(program: &Program, recording: &Recording, seed: u64) -> Outcome<Value> {
    left_out(program, &recording.flags(&recording.cameras, seed), &program.folder.join(format!("straight-{seed}")))
}

/// A rig that is drawn from the prior.
pub(super) fn rig_cell(program: &Program, seed: u64) -> Outcome<Value> {
    let folder = program.folder.join(format!("straight-rig-{seed}"));
    std::fs::create_dir_all(&folder)?;
    let flags = rigs::flags(&Rig::drawn(seed)?, &folder, seed)?;
    let found = left_out(program, &flags, &folder.join("runs"))?;
    std::fs::remove_dir_all(&folder)?;
    Ok(found)
}

/// What the names of cells begin with, of the recording and of rigs.
pub(super) const RECORDINGS: &str = "straight/recording";
pub(super) const RIGS: &str = "straight/rig";

fn add(text: &mut String, name: &str, cells: &[&Value]) {
    let mean_of =
        |key: &str, k: usize| mean(cells.iter().map(|cell| numbers(&cell[key]).get(k).copied().unwrap_or(f64::NAN)));
    let both = FAMILIES.map(|(key, _)| format!("{:.2}, {:.2}", mean_of(key, 0), mean_of(key, 1))).join(" | ");
    row!(*text, "{name} | {} | {both}", cells.len());
}

/// What the straight line leaves out of the recording, and of rigs by how far elbows are seen from their joints.
///
/// # Errors
/// A rig that cannot be drawn.
pub(super) fn table(store: &Store, runs: Range<u64>, rigs: Range<u64>) -> Outcome<String> {
    let mut text = format!(
        "What draws that answer in a straight line leave out, in standard deviations, median and 90th percentile, means over set-ups; {OWN} draws of g of each:\n\n"
    );
    let names = FAMILIES.map(|(_, name)| name).join(" | ");
    text += &header(&format!("| set-ups | how many | {names} |"));
    let recording: Vec<&Value> = store.for_seeds(RECORDINGS, runs);
    add(&mut text, "real recording", &recording);
    let mut found: Vec<(f64, &Value)> = vec![];
    for seed in rigs {
        if let Some(cell) = store.get(&format!("{RIGS}/{seed}")) {
            found.push((Rig::drawn(seed)?.aside("Elbow"), cell));
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    for third in found.chunks(found.len().div_ceil(3).max(1)) {
        let [least, most] = [third.first(), third.last()].map(|rig| 1e3 * rig.map_or(f64::NAN, |rig| rig.0));
        let cells: Vec<&Value> = third.iter().map(|(_, cell)| *cell).collect();
        add(&mut text, &format!("rigs, elbows {least:.0} to {most:.0} mm aside"), &cells);
    }
    Ok(text)
}
