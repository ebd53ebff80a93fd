//! Rigs that are drawn from the set-up's own prior: are their truths uniform among the draws of the posterior?
//!
//! Ranks of one rig depend on each other. So one number of each rig, another one from rig to rig, is tested for uniformity over the rigs; and each number over the rigs, the least probability counting (Bonferroni). Errors of coverage are over rigs.
//! One rig is tracked, and its truths are ranked, in [`ranked`]; two of its cameras predict the others in [`two_cameras`]; [`sinew_tests::drawn_rig`] draws it.

mod ranked;
pub(super) mod two_cameras;

pub(super) use ranked::flags;

use super::derived::limb_angles;
use super::protocol::{DRAWS, LEAST_P, NOMINAL, WITHIN};
use super::summary::{shown, uniformity};
use crate::support::outcome::Outcome;
use crate::support::program::Program;
use crate::support::statistics::{mean_and_error, verdict};
use crate::support::store::{Store, numbers};
use crate::support::table::{header, row, with_spread};
use serde_json::Value;
use sinew::body::point_derivatives::length_names;
use sinew_tests::drawn_rig::Rig;
use sinew_tests::evaluation::ranks::{self, LEVELS, all_uniform, shape};
use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

/// Families of numbers, by their keys, as they are shown.
const FAMILIES: [(&str, &str); 17] = [
    ("rotation", "cameras: rotation"),
    ("translation", "cameras: translation"),
    ("focal", "cameras: focal length"),
    ("principal_point", "cameras: principal point"),
    ("k1", "cameras: k1"),
    ("lengths", "lengths of the body"),
    ("places", "places of keypoints on links"),
    ("biases", "biases of detectors"),
    ("lags", "lags of the cameras"),
    ("scales", "scales of the prior"),
    ("root", "root of the pose, three frames"),
    ("hinges", "flexion of knees and elbows, three frames"),
    ("angles", "all angles of the limbs, three frames"),
    ("segments", "lengths of segments, three frames"),
    ("distances", "distances between two joints, three frames"),
    ("coordinates", "coordinates of joints, three frames"),
    ("left_out", "offset of a camera left out (scale mixture)"),
];

/// A row of the table, from the ranks of each rig.
fn row(name: &str, rigs: &[Vec<u32>]) -> String {
    let count = rigs.first().map_or(0, Vec::len);
    let inside = LEVELS.map(|level| {
        let of = |ranks: &Vec<u32>| 100.0 * ranks::coverage(ranks, DRAWS, level);
        mean_and_error(&rigs.iter().map(of).collect::<Vec<_>>())
    });
    let one: Vec<u32> = rigs.iter().enumerate().map(|(rig, ranks)| ranks[rig % count]).collect();
    let each = (0..count).map(|k| uniformity(&rigs.iter().map(|ranks| ranks[k]).collect::<Vec<_>>()));
    let [one, each] = [uniformity(&one), all_uniform(&each.collect::<Vec<_>>()).map_or(f64::NAN, |found| found.p)];
    let form = shape(&rigs.concat(), DRAWS);
    let [centre, error] = inside[2];
    let bound = WITHIN.max(3.0 * error);
    let met = verdict((centre - NOMINAL).abs() <= bound && one >= LEAST_P && each >= LEAST_P);
    let [half, most, _, all] = inside.map(|[share, _]| share);
    format!(
        "| {name} | {count} | {half:.0} | {most:.0} | {centre:.1} ± {error:.1} | {all:.0} | {:.2} | {:+.3} | {} | {} | {NOMINAL} ± {bound:.1}, p ≥ {LEAST_P} | {met} |",
        form.width,
        form.bias,
        shown(one),
        shown(each),
    )
}

/// The table, and what failed.
pub(super) fn table(store: &Store, seeds: Range<u64>) -> String {
    let cells: Vec<&Value> = store.for_seeds(CELLS, seeds);
    let (failed, found): (Vec<&Value>, Vec<&Value>) = cells.iter().partition(|cell| cell["failed"].is_string());
    let mut text = format!("{} simulated rigs, of which {} were refused or failed:\n\n", cells.len(), failed.len());
    text += &header(
        "| numbers | a rig | inside 50 %, % | 80 | 90 | 95 | width | shift | p, one a rig | p, each | bound | |",
    );
    for (key, name) in FAMILIES {
        let ranks = |cell: &&Value| ranks_of(cell, key);
        let rigs: Vec<Vec<u32>> = found.iter().map(ranks).filter(|ranks| !ranks.is_empty()).collect();
        if !rigs.is_empty() {
            let _ = writeln!(text, "{}", row(name, &rigs));
        }
    }
    for cell in failed {
        let _ = writeln!(text, "\nfailed: {}", cell["failed"].as_str().unwrap_or_default().replace('\n', " "));
    }
    text
}

/// A rig: ranks by family, or why there are none.
pub(super) fn cell(program: &Program, seed: u64) -> Outcome<Value> {
    ranked::cell(program, &Rig::drawn(seed)?, Path::new(&format!("rig-{seed}")), seed)
}

/// The same where keypoints lie at the joints and have no biases.
pub(super) fn cell_at_joints(program: &Program, seed: u64) -> Outcome<Value> {
    ranked::cell(program, &Rig::at_joints(seed)?, Path::new(&format!("rig-at-joints-{seed}")), seed)
}

/// What the names of cells of rigs begin with.
pub(super) const CELLS: &str = "rig";

/// The same of rigs whose keypoints lie at the joints.
pub(super) const CELLS_AT_JOINTS: &str = "rig at joints";

fn ranks_of(cell: &Value, key: &str) -> Vec<u32> {
    numbers(&cell[key]).into_iter().map(|x| x as u32).collect()
}

fn share_inside(ranks: &[u32]) -> f64 {
    100.0 * ranks::coverage(ranks, DRAWS, NOMINAL / 100.0)
}

/// Families that are held in rigs whose keypoints lie at the joints.
const AT_JOINTS: [(&str, &str); 4] = [
    ("segments", "lengths of segments"),
    ("angles", "all angles of the limbs"),
    ("distances", "distances between two joints"),
    ("coordinates", "coordinates of joints"),
];

/// Rigs whose keypoints lie at the joints, against the same rigs with keypoints aside.
///
/// # Errors
/// Lengths without a forearm.
pub(super) fn at_joints_table(store: &Store, seeds: Range<u64>) -> Outcome<String> {
    let is_at_joints = |seed: &u64| store.get(&format!("{CELLS_AT_JOINTS}/{seed}")).is_some();
    let [at_joints, aside] =
        [CELLS_AT_JOINTS, CELLS].map(|kind| store.for_seeds(kind, seeds.clone().filter(is_at_joints)));
    let mut text = format!(
        "{} rigs, inside 90 % intervals, keypoints as the prior has them and at the joints:\n\n",
        at_joints.len()
    );
    text += &header("| numbers | keypoints aside, with biases, % | at the joints, without, % |");
    for (key, name) in AT_JOINTS {
        let held = |cells: &[&Value]| {
            let ranks = cells.iter().map(|cell| ranks_of(cell, key)).filter(|ranks| !ranks.is_empty());
            with_spread(mean_and_error(&ranks.map(|ranks| share_inside(&ranks)).collect::<Vec<_>>()), 1)
        };
        row!(text, "{name} | {} | {}", held(&aside), held(&at_joints));
    }
    let forearm = forearm()?;
    let shifted = |cells: &[&Value]| {
        let found = cells.iter().filter(|cell| cell["lengths"].is_array());
        let [shift, error] = mean_and_error(&found.map(|cell| shift_of(cell, forearm)).collect::<Vec<_>>());
        format!("{shift:+.3} ± {error:.3}")
    };
    let _ = writeln!(
        text,
        "\nShift of the ranks of the forearm's length (below 0: draws too long): {} and {}.",
        shifted(&aside),
        shifted(&at_joints)
    );
    Ok(text)
}

fn forearm() -> Outcome<usize> {
    Ok(length_names().iter().position(|name| *name == "forearm").ok_or("no length of the forearm")?)
}

/// Where the truth of a length lies among the draws, from −½ to ½.
fn shift_of(cell: &Value, length: usize) -> f64 {
    shape(&[ranks_of(cell, "lengths")[length]], DRAWS).bias
}

/// What a rig says about arms.
struct Arms {
    aside_m: f64,
    upper_arms: f64,
    other_limbs: f64,
    /// Where the truth of the forearm's length lies among the draws, from −½ to ½.
    forearm: f64,
}

/// Angles of upper arms and of the other limbs, and the length of the forearm, for thirds of the rigs by how far the keypoints of elbows lie from their joints.
///
/// # Errors
/// A rig that cannot be drawn.
pub(super) fn elbow_table(store: &Store, seeds: Range<u64>) -> Outcome<String> {
    let forearm = forearm()?;
    let mut rigs: Vec<Arms> = vec![];
    for seed in seeds {
        let Some(cell) = store.get(&format!("{CELLS}/{seed}")).filter(|cell| cell["angles"].is_array()) else {
            continue;
        };
        let rig = Rig::drawn(seed)?;
        let names: Vec<String> = limb_angles(&rig.body()).into_iter().map(|(_, name)| name).collect();
        let ranks = ranks_of(cell, "angles");
        let held = |upper_arms: bool| {
            let own = |(k, _): &(usize, &u32)| names[k % names.len()].contains("upper_arm") == upper_arms;
            share_inside(&ranks.iter().enumerate().filter(own).map(|(_, rank)| *rank).collect::<Vec<u32>>())
        };
        rigs.push(Arms {
            aside_m: rig.aside("Elbow"),
            upper_arms: held(true),
            other_limbs: held(false),
            forearm: shift_of(cell, forearm),
        });
    }
    rigs.sort_by(|a, b| a.aside_m.total_cmp(&b.aside_m));
    let mut text = String::from(
        "Angles inside 90 % intervals, and shift of the ranks of the forearm's length, by how far elbows are seen from their joints, root mean square of both:\n\n",
    );
    text += &header(
        "| third of the rigs | elbows aside, mm | upper arms, % | other limbs, % | length of the forearm, shift |",
    );
    for (name, third) in ["nearest", "middle", "farthest"].into_iter().zip(rigs.chunks(rigs.len().div_ceil(3).max(1))) {
        let of = |value: fn(&Arms) -> f64| mean_and_error(&third.iter().map(value).collect::<Vec<_>>());
        let [least, most] = [third.first(), third.last()].map(|arms| 1e3 * arms.map_or(f64::NAN, |arms| arms.aside_m));
        let [shift, error] = of(|arms| arms.forearm);
        row!(
            text,
            "{name} | {least:.0} to {most:.0} | {} | {} | {shift:+.3} ± {error:.3}",
            with_spread(of(|arms| arms.upper_arms), 1),
            with_spread(of(|arms| arms.other_limbs), 1),
        );
    }
    Ok(text)
}
