//! Where the truth of a rig lies among the draws of its run.

use super::super::derived::{Run, Truth, ranked};
use super::super::posterior::Drawn;
use super::super::protocol::{DRAWS, LAYOUT};
use super::super::summary::scale_mixture_rank;
use crate::support::outcome::Outcome;
use crate::support::program::Program;
use crate::support::statistics::mean;
use serde_json::{Map, Value, json};
use sinew::observe::cameras::camera_error::PRINCIPAL_POINT;
use sinew::predict::predict;
use sinew::setup::{MeasuredErrors, Setup};
use sinew_body::points::points_of_states;
use sinew_tests::drawn_rig::{FRAMES, RATE_HZ, Rig, USED, truth};
use std::ops::Range;
use std::path::Path;

/// Frames whose poses are ranked.
const RANKED: [usize; 3] = [10, 30, FRAMES - 1];

/// Files of a rig in a folder, and the flags that track them.
pub(in super::super) fn flags(rig: &Rig, folder: &Path, seed: u64) -> Outcome<Vec<String>> {
    let (draws, seed) = (DRAWS.to_string(), seed.to_string());
    let more = ["--layout", LAYOUT, "--draws", &draws, "--seed", &seed, "--updates", "16", "--any-size"];
    let usual = ["--threads", "1", "--force", "--no-progress"];
    Ok([rig.write(folder)?, more.into_iter().chain(usual).map(str::to_owned).collect()].concat())
}

/// Ranks by family, or why there are none.
pub(super) fn cell(program: &Program, rig: &Rig, folder: &Path, seed: u64) -> Outcome<Value> {
    let folder = program.folder.join(folder);
    std::fs::create_dir_all(&folder)?;
    let flags = flags(rig, &folder, seed)?;
    let run = folder.join("run");
    let found = match program.track(&flags, &run) {
        Ok(()) => ranks(rig, &folder, &run)?,
        Err(refused) => json!({ "failed": refused.to_string() }),
    };
    std::fs::remove_dir_all(&folder)?;
    Ok(found)
}

fn ranks(rig: &Rig, folder: &Path, run: &Path) -> Outcome<Value> {
    let path = run.join("setup.toml");
    let setup = Setup::from_toml("setup.toml", &std::fs::read_to_string(path)?)?;
    let known = setup.lasting.as_ref().ok_or("a set-up without what lasts")?;
    let mut found = ranks_that_last(rig, &setup, known);
    found.append(&mut pose_ranks(rig, run)?);
    let scales = known.scale("cameras").ok_or("a set-up without a scale of the cameras")?;
    found.insert("left_out".into(), json!(left_out_ranks(rig, &folder.join("Calib.toml"), run, scales)?));
    Ok(found.into())
}

/// Of a truth less the value that tracking uses, among draws of the same.
fn rank(truth: f64, draws: &[f64]) -> u32 {
    draws.iter().take(DRAWS).filter(|draw| **draw < truth).count() as u32
}

fn ranks_that_last(rig: &Rig, setup: &Setup, known: &MeasuredErrors) -> Map<String, Value> {
    let layout = known.layout();
    let truth = truth(rig, setup, known);
    let ranks = |places: Vec<Range<usize>>| {
        let one = |place: usize| rank(truth[place] - known.number[place].value, &known.number[place].draws);
        Value::from(places.into_iter().flatten().map(one).collect::<Vec<u32>>())
    };
    let camera_ranks = |own: Range<usize>| {
        let place = |camera: usize| {
            let first = layout.camera(camera).start;
            first + own.start..first + own.end
        };
        ranks((0..layout.cameras).map(place).collect())
    };
    let scales = rig.scales.iter().zip(&known.scale).map(|(truth, scale)| rank(*truth, &scale.draws));
    let families = [
        ("rotation", camera_ranks(0..3)),
        ("translation", camera_ranks(3..6)),
        ("focal", camera_ranks(6..7)),
        ("principal_point", camera_ranks(PRINCIPAL_POINT..PRINCIPAL_POINT + 2)),
        ("k1", camera_ranks(9..10)),
        ("lengths", ranks(vec![layout.lengths()])),
        ("places", ranks(vec![layout.places()])),
        ("biases", ranks(vec![layout.biases()])),
        ("lags", ranks(vec![layout.lags()])),
        ("scales", scales.collect::<Vec<u32>>().into()),
    ];
    families.map(|(name, ranks)| (name.to_owned(), ranks)).into_iter().collect()
}

fn pose_ranks(rig: &Rig, run: &Path) -> Outcome<Map<String, Value>> {
    let root = Drawn::read(run, "root")?;
    let root_rank =
        |(frame, axis): (usize, usize)| root.rank(rig.states[frame][axis], |draw| root.at(draw, frame)[axis]);
    let places = RANKED.iter().flat_map(|&frame| (0..3).map(move |axis| (frame, axis)));
    let mut found = Map::new();
    found.insert("root".into(), places.map(root_rank).collect::<Vec<u32>>().into());
    let frames = points_of_states(&rig.body(), &rig.states).frames;
    let truth = Truth { frames, states: rig.states.clone(), rate_hz: RATE_HZ as usize };
    for (key, ranks) in ranked(&Run::read(run)?, &truth, &RANKED)? {
        found.insert(key.into(), ranks.into());
    }
    Ok(found)
}

/// Ranks of the offset of the camera that was left out, its mean over keypoints and frames. The camera's own errors are nearly all of it: Student's t with four degrees of freedom, whose scale is as that of the cameras was drawn.
fn left_out_ranks(rig: &Rig, calibration: &Path, run: &Path, scales: &[f64]) -> Outcome<[u32; 2]> {
    let prediction = predict(run, calibration, &rig.cameras[USED].name)?;
    let mut away: Vec<[f64; 2]> = vec![];
    for (frame, row) in prediction.frames.iter().zip(prediction.predicted.chunks(prediction.keypoints.len().max(1))) {
        for (name, predicted) in prediction.keypoints.iter().zip(row) {
            let Some(point) = rig.points.iter().position(|own| own == name) else { continue };
            let Some((pixel, predicted)) = rig.pixels[USED][*frame as usize][point].zip(*predicted) else { continue };
            away.push([0, 1].map(|axis: usize| pixel[axis] - predicted.mean[axis]));
        }
    }
    let sd = [prediction.common[0].sqrt(), prediction.common[2].sqrt()];
    let offset = |axis: usize| mean(away.iter().map(|away| away[axis])) / sd[axis];
    Ok([scale_mixture_rank(offset(0), scales)?, scale_mixture_rank(offset(1), scales)?])
}
