//! Rigs that are drawn from the set-up's own prior: are their truths uniform among the draws of the posterior?
//!
//! Ranks of one rig depend on each other. So one number of each rig, another one from rig to rig, is tested for uniformity over the rigs; and each number over the rigs, the least probability counting (Bonferroni). Errors of coverage are over rigs.
//! One rig is tracked, and its truths are ranked, in [`ranked`]; [`sinew_tests::drawn_rig`] draws it.

mod ranked;

pub(super) use ranked::cell;

use super::derived::limb_angles;
use super::protocol::{DRAWS, LEAST_P, NOMINAL, WITHIN, verdict};
use super::summary::{shown, uniformity, with_error};
use crate::outcome::Outcome;
use crate::store::{Store, numbers};
use serde_json::Value;
use sinew_tests::drawn_rig::Rig;
use sinew_tests::evaluation::ranks::{self, LEVELS, all_uniform, shape};
use std::fmt::Write as _;
use std::ops::Range;

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
        with_error(&rigs.iter().map(of).collect::<Vec<_>>())
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
    let cells: Vec<&Value> = seeds.filter_map(|seed| store.get(&format!("rig/{seed}"))).collect();
    let (failed, found): (Vec<&Value>, Vec<&Value>) = cells.iter().partition(|cell| cell["failed"].is_string());
    let mut text = format!("{} simulated rigs, of which {} were refused or failed:\n\n", cells.len(), failed.len());
    text += "| numbers | a rig | inside 50 %, % | 80 | 90 | 95 | width | shift | p, one a rig | p, each | bound | |\n";
    text += "|---|---|---|---|---|---|---|---|---|---|---|---|\n";
    for (key, name) in FAMILIES {
        let ranks = |cell: &&Value| numbers(&cell[key]).into_iter().map(|x| x as u32).collect::<Vec<u32>>();
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

/// Angles of upper arms and of the other limbs, for thirds of the rigs by how far the keypoints of elbows lie from their joints.
///
/// # Errors
/// A rig that cannot be drawn.
pub(super) fn elbow_table(store: &Store, seeds: Range<u64>) -> Outcome<String> {
    let mut rigs: Vec<(f64, [f64; 2])> = vec![];
    for seed in seeds {
        let Some(cell) = store.get(&format!("rig/{seed}")).filter(|cell| cell["angles"].is_array()) else { continue };
        let rig = Rig::drawn(seed)?;
        let names: Vec<String> = limb_angles(&rig.body()).into_iter().map(|(_, name)| name).collect();
        let ranks: Vec<u32> = numbers(&cell["angles"]).into_iter().map(|x| x as u32).collect();
        let held = |upper_arms: bool| {
            let own = |(k, _): &(usize, &u32)| names[k % names.len()].contains("upper_arm") == upper_arms;
            let own: Vec<u32> = ranks.iter().enumerate().filter(own).map(|(_, rank)| *rank).collect();
            100.0 * ranks::coverage(&own, DRAWS, NOMINAL / 100.0)
        };
        rigs.push((rig.aside("Elbow"), [held(true), held(false)]));
    }
    rigs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut text = String::from(
        "Angles inside 90 % intervals, by how far elbows are seen from their joints, root mean square of both:\n\n",
    );
    text += "| third of the rigs | elbows aside, mm | upper arms, % | other limbs, % |\n|---|---|---|---|\n";
    for (name, third) in ["nearest", "middle", "farthest"].into_iter().zip(rigs.chunks(rigs.len().div_ceil(3).max(1))) {
        let [upper_arms, others] = [0, 1].map(|k: usize| {
            let [share, error] = with_error(&third.iter().map(|(_, held)| held[k]).collect::<Vec<_>>());
            format!("{share:.1} ± {error:.1}")
        });
        let [least, most] = [third.first(), third.last()].map(|rig| 1e3 * rig.map_or(f64::NAN, |rig| rig.0));
        let _ = writeln!(text, "| {name} | {least:.0} to {most:.0} | {upper_arms} | {others} |");
    }
    Ok(text)
}
