//! Two neighbouring cameras of a rig predict the two others: how much does coverage scatter from rig to rig?

use crate::support::outcome::Outcome;
use crate::support::program::Program;
use crate::support::statistics::{mean, mean_and_error, quantile};
use crate::support::store::{Store, numbers};
use crate::support::table::{header, row};
use serde_json::{Value, json};
use sinew::input::source::FrameSource as _;
use sinew::predict::predict;
use sinew_analysis::validate::left_out;
use sinew_tests::drawn_rig::{FRAMES, Rig};
use std::ops::Range;
use std::path::Path;

/// Cameras of the rig that the run uses, and those that are predicted.
const USED: [usize; 2] = [0, 1];
const PREDICTED: [usize; 2] = [2, 3];

/// Share of 90 % regions that hold, of each predicted camera.
pub(in super::super) fn cell(program: &Program, seed: u64) -> Outcome<Value> {
    let (rig, folder) = (Rig::drawn(seed)?, program.folder.join(format!("rig-two-{seed}")));
    std::fs::create_dir_all(&folder)?;
    let mut flags = super::flags(&rig, &folder, seed)?;
    let used = USED.map(|camera| rig.cameras[camera].name.as_str()).join(",");
    let cameras = flags.iter().position(|flag| flag == "--cameras").ok_or("a rig without cameras")?;
    flags[cameras + 1] = used;
    let run = folder.join("run");
    let tracked = program.track(&flags, &run);
    let all = || PREDICTED.iter().map(|camera| held(&rig, &folder, &run, *camera)).collect::<Outcome<Vec<f64>>>();
    let found = match tracked {
        Ok(()) => json!({ "held": all()? }),
        Err(refused) => json!({ "failed": refused.to_string() }),
    };
    std::fs::remove_dir_all(&folder)?;
    Ok(found)
}

fn held(rig: &Rig, folder: &Path, run: &Path, camera: usize) -> Outcome<f64> {
    let prediction = predict(run, &folder.join("Calib.toml"), &rig.cameras[camera].name)?;
    let mut source = rig.source();
    let columns: Vec<Option<usize>> = prediction.keypoints.iter().map(|name| source.layout().index(name)).collect();
    let mut people = vec![];
    for number in &prediction.frames {
        people.push(source.people(*number)?.swap_remove(camera));
    }
    Ok(100.0 * left_out(&prediction, &people, &columns).all().coverage(0.9))
}

/// What the names of cells begin with.
pub(in super::super) const CELLS: &str = "rig, two cameras";

/// Mean over rigs, and how far single cameras of single rigs are from it.
pub(in super::super) fn table(store: &Store, seeds: Range<u64>) -> String {
    let cells: Vec<&Value> = store.for_seeds(CELLS, seeds);
    let rigs: Vec<Vec<f64>> = cells.iter().map(|cell| numbers(&cell["held"])).filter(|held| !held.is_empty()).collect();
    let [centre, error] = mean_and_error(&rigs.iter().map(|held| mean(held.iter().copied())).collect::<Vec<_>>());
    let single = rigs.concat();
    let mut text = format!(
        "{} rigs of {FRAMES} frames, {} refused; two neighbouring cameras used, inside 90 % regions of the two others, offset taken off:\n\n",
        rigs.len(),
        cells.len() - rigs.len()
    );
    text += &header("| mean over rigs, % | single cameras: 5 % of them below, % | 10 % | 25 % | median | 75 % |");
    let cells = [0.05, 0.1, 0.25, 0.5, 0.75]
        .map(|share| quantile(&single, share).map_or("–".into(), |held| format!("{held:.0}")));
    row!(text, "{centre:.1} ± {error:.1} | {}", cells.join(" | "));
    text
}
