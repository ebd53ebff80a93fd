//! Two people of a real recording, in one run and in runs of their own.
//!
//! `pose2sim_two_people`, against Pose2Sim's tables of them.

use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown};
use crate::support::statistics::{mean, verdict, with_error};
use crate::support::table::{header, row};
use sinew::formats::trc::{self, Trc};
use std::path::{Path, PathBuf};

/// Joints of the limbs, right and left.
const LIMBS: [&str; 6] = ["Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle"];
/// Pose2Sim's tables, whom they show, and how far from them the task lets a run be, mm.
const REFERENCES: [(&str, &str, f64); 2] = [("P1.trc", "who sits", 4.2), ("P2.trc", "who steps", 31.0)];
const RATE_HZ: &str = "60";

fn read(path: &Path) -> Outcome<Trc> {
    Ok(trc::read(&shown(path), &std::fs::read_to_string(path)?)?)
}

/// Mean distance over frames and joints of the limbs, once one common shift is taken off, mm.
fn distance_mm(found: &Trc, reference: &Trc) -> f64 {
    let names: Vec<String> = LIMBS.iter().flat_map(|joint| ["R", "L"].map(|side| format!("{side}{joint}"))).collect();
    let mut differences: Vec<[f64; 3]> = vec![];
    for (place, frame) in found.frames.iter().enumerate() {
        // Rows of both are counted from 1; Pose2Sim's times begin a frame later.
        let same = |other: &trc::TrcFrame| other.number == frame.number;
        let Some(there) = reference.frames.iter().position(same) else { continue };
        for name in &names {
            let at = |trc: &Trc, frame: usize| trc.point_in_world(frame, trc.marker_index(name)?);
            if let (Some(a), Some(b)) = (at(found, place), at(reference, there)) {
                differences.push([a[0] - b[0], a[1] - b[1], a[2] - b[2]]);
            }
        }
    }
    let count = differences.len() as f64;
    let shift = [0, 1, 2].map(|axis| differences.iter().map(|d| d[axis]).sum::<f64>() / count);
    let apart = |d: &[f64; 3]| (0..3).map(|axis| (d[axis] - shift[axis]).powi(2)).sum::<f64>().sqrt();
    1e3 * differences.iter().map(apart).sum::<f64>() / count
}

/// The folders of a run of everybody.
fn folders(run: &Path) -> Outcome<Vec<PathBuf>> {
    let mut all: Vec<PathBuf> =
        std::fs::read_dir(run.join("people"))?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
    all.sort();
    Ok(all)
}

/// For each reference, the distances of all seeds: of everybody in one run, and of runs of one person.
fn distances(program: &Program, data: &Path, seeds: u64) -> Outcome<Vec<[Vec<f64>; 2]>> {
    let mut all = vec![[vec![], vec![]]; REFERENCES.len()];
    for seed in 1..=seeds {
        let paths = ["Calib.toml", "pose"].map(|name| shown(&data.join(name)));
        let seed_text = seed.to_string();
        let flags = ["--calibration", &paths[0], "--keypoints", &paths[1], "--layout", "BODY_25B", "--fps", RATE_HZ];
        let rest = ["--force", "--no-progress", "--seed", &seed_text];
        let track = |who: &[&str], out: &Path| -> Outcome<()> {
            let flags: Vec<String> = flags.iter().chain(&rest).chain(who).map(|flag| (*flag).to_owned()).collect();
            program.track(&flags, out)
        };
        let out = program.folder.join(format!("two-people-{seed}"));
        track(&["--people", "all"], &out)?;
        let people = folders(&out)?;
        for ((name, _, _), both) in REFERENCES.iter().zip(&mut all) {
            let reference = read(&data.join(name))?;
            let each = people.iter().map(|folder| Ok(distance_mm(&read(&folder.join("markers.trc"))?, &reference)));
            let each: Vec<f64> = each.collect::<Outcome<_>>()?;
            let nearest = (0..people.len()).min_by(|a, b| each[*a].total_cmp(&each[*b])).unwrap_or(0);
            let alone = program.folder.join(format!("two-people-{seed}-{}", nearest + 1));
            track(&["--people", "1", "--person", &(nearest + 1).to_string()], &alone)?;
            both[0].push(each[nearest]);
            both[1].push(distance_mm(&read(&alone.join("markers.trc"))?, &reference));
        }
    }
    Ok(all)
}

/// The table of a real recording.
pub(crate) fn table(program: &Program, data: &Path, seeds: u64) -> Outcome<String> {
    let mut text =
        header("| person | all in one run, mm | bound of the task, mm | | a run of their own (`--person`), mm |");
    for ((_, who, bound), [together, alone]) in REFERENCES.iter().zip(&distances(program, data, seeds)?) {
        let met = verdict(mean(together) <= *bound);
        row!(text, "{who} | {} | {bound} | {met} | {}", with_error(together, 1), with_error(alone, 1));
    }
    Ok(text)
}
