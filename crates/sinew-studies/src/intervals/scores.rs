//! Sharpness: log scores of cameras that a run did not use.
//!
//! Of the prediction as it is, and as it was before what lasts was in the intervals.
//!
//! What was predicted before is the spread of the draws in the camera with the noise of the detectors, in proportion to the size of the person in the image, and the model error. Widened, its covariances are multiplied by the one factor that is best on the frames of tuning,
//! which for Gaussian densities is half of the mean squared distance.

use super::before::{self, Input};
use super::left_out::{Expected, Observed, Prediction, REGION, TUNED, observed, predicted};
use super::posterior::Drawn;
use super::protocol::{CAMERAS, LAYOUT, NOMINAL, Recording, sets};
use crate::support::outcome::Outcome;
use crate::support::program::Program;
use crate::support::statistics::{mean, quantile, verdict};
use crate::support::store::{Store, rows};
use crate::support::table::header;
use serde_json::{Map, Value, json};
use sinew::formats::layout;
use sinew::observe::Camera;
use sinew::observe::lasting::lasting_errors::pixels_per_metre;
use sinew::setup::Setup;
use sinew_analysis::validate::ObservationTally;
use sinew_results::tracked::Tracked;
use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

/// What the draws of a run and the noise of its set-up predict for a camera.
fn plain(run: &Path, tracked: &Tracked, used: &[Camera], camera: &Camera) -> Outcome<Prediction> {
    let (layout, markers) = (layout::find(LAYOUT)?, Drawn::read(run, "marker_position")?);
    let body = tracked.setup.tree();
    let points = || (0..body.points().len()).filter_map(|p| Some((p, layout.index(&body.points()[p].name)?)));
    let all = || (0..markers.frames).flat_map(|frame| points().map(move |(p, _)| (frame, p)));
    let middle = [0, 1, 2].map(|axis: usize| mean(all().map(|(frame, p)| markers.point(0, frame, p)[axis])));
    let alone = alone(&tracked.setup, used, middle) * pixels_per_metre(camera, middle).powi(2);
    let one = |frame: usize, point: usize, column: usize| -> Option<Expected> {
        let from_draw = |draw: usize| camera.project(markers.point(draw, frame, point)).pixel();
        let pixels: Vec<[f64; 2]> = (0..markers.draws).map(from_draw).collect::<Option<_>>()?;
        let at = [0, 1].map(|axis: usize| mean(pixels.iter().map(|pixel| pixel[axis])));
        let product = |a: usize, b: usize| mean(pixels.iter().map(|pixel| (pixel[a] - at[a]) * (pixel[b] - at[b])));
        Some(Expected { column, at, covariance: [product(0, 0) + alone, product(0, 1), product(1, 1) + alone] })
    };
    let numbers = tracked.frames.iter().map(|(number, _)| *number).enumerate();
    Ok(numbers
        .map(|(frame, number)| (number, points().filter_map(|(p, column)| one(frame, p, column)).collect()))
        .collect())
}

/// Variance of a detection with the model error at the distance of the middle, square metres: the mean of the used cameras.
fn alone(setup: &Setup, used: &[Camera], middle: [f64; 3]) -> f64 {
    let noise = |(known, camera): (&sinew::setup::CameraSetup, &Camera)| {
        (known.sigma_px / pixels_per_metre(camera, middle)).powi(2)
    };
    mean(setup.camera.iter().zip(used).map(noise)) + setup.model_error_m.powi(2)
}

fn stored(seen: &[Observed]) -> Value {
    let row = |s: &Observed| [f64::from(u8::from(s.is_tuned)), s.square, s.log_determinant, s.error_px];
    json!(seen.iter().map(row).collect::<Vec<_>>())
}

/// Both runs with some cameras, and what the others see of them.
pub(super) fn cell(program: &Program, recording: &Recording, used: &[&str], seed: u64) -> Outcome<Value> {
    let name = format!("{}-{seed}", used.join("-"));
    let [after, plainly] = ["after", "before"].map(|when| program.folder.join(format!("scores-{name}-{when}")));
    program.track(&recording.flags(used, seed), &after)?;
    let (calibration, keypoints) = (recording.calibration.as_path(), recording.keypoints.as_path());
    let input = Input { calibration, keypoints, cameras: used, fps: recording.fps };
    before::track(program, &input, &recording.flags(used, seed), &plainly)?;
    let tracked = Tracked::read(&plainly)?;
    let cameras = tracked.cameras(calibration)?.0;
    let calibrated = sinew::input::recording::Calibrated::read(calibration)?.cameras;
    let mut found = Map::new();
    for camera in CAMERAS.iter().filter(|camera| !used.contains(camera)) {
        let own = calibrated.iter().find(|known| known.name == *camera).ok_or("a camera is not calibrated")?;
        let (with, _) = observed(predicted(program, recording, &after, camera)?, recording, camera)?;
        let (without, _) = observed(plain(&plainly, &tracked, &cameras, own)?, recording, camera)?;
        found.insert((*camera).into(), json!({ "after": stored(&with), "before": stored(&without) }));
    }
    std::fs::remove_dir_all(&after)?;
    std::fs::remove_dir_all(&plainly)?;
    Ok(found.into())
}

/// Observations of a cell: of the frames of tuning, and judged.
fn split(cell: &Value) -> [Vec<Vec<f64>>; 2] {
    rows(cell).into_iter().partition(|row| row[0] == 1.0).into()
}

/// Judged observations against covariances times a factor.
fn tally(judged: &[Vec<f64>], factor: f64) -> ObservationTally {
    let score = |row: &Vec<f64>| -0.5 * (row[1] / factor + row[2]) - factor.ln() - std::f64::consts::TAU.ln();
    ObservationTally {
        errors_px: judged.iter().map(|row| row[3]).collect(),
        squares: judged.iter().map(|row| row[1] / factor).collect(),
        log_scores: judged.iter().map(score).collect(),
    }
}

/// What all left-out cameras of sets of a size say: as predicted, before, and before widened.
pub(super) struct Scored {
    pub(super) after: ObservationTally,
    pub(super) before: ObservationTally,
    pub(super) widened: ObservationTally,
    factor: f64,
    /// What is predicted, covariances of each camera and set times the factor with which 90 % of its regions hold 90 %.
    pub(super) fitted: ObservationTally,
    /// The same camera by camera.
    cameras: Vec<(String, [ObservationTally; 3])>,
}

/// Name of the cell of both runs with some cameras.
pub(super) fn name(used: &[&str], seed: u64) -> String {
    format!("scores/{}/{seed}", used.join("+"))
}

/// The sets of a size, as far as they were run; observations of all seeds together.
pub(super) fn scored(store: &Store, size: usize, seeds: Range<u64>) -> Option<Scored> {
    let mut cells: Vec<(String, Vec<&Value>)> = vec![];
    for used in sets(&CAMERAS, size) {
        let found: Vec<&Value> = seeds.clone().filter_map(|seed| store.get(&name(&used, seed))).collect();
        for camera in CAMERAS.iter().filter(|camera| !used.contains(camera) && !found.is_empty()) {
            let seen = found.iter().map(|cell| &cell[camera]).collect();
            cells.push((format!("{camera}, {}", used.join(" ")), seen));
        }
    }
    let both = |seen: &[&Value], when: &str| -> [Vec<Vec<f64>>; 2] {
        let split: Vec<_> = seen.iter().map(|cell| split(&cell[when])).collect();
        [0, 1].map(|part: usize| split.iter().flat_map(|split| split[part].clone()).collect())
    };
    let everything: Vec<&Value> = cells.iter().flat_map(|(_, seen)| seen.iter().copied()).collect();
    let all = |when: &str| both(&everything, when);
    let ([_, after], [tuned, before]) = (all("after"), all("before"));
    let factor = 0.5 * mean(tuned.iter().map(|row| row[1]));
    let three =
        |after: &[Vec<f64>], before: &[Vec<f64>]| [tally(after, 1.0), tally(before, 1.0), tally(before, factor)];
    let by_camera = |(name, seen): &(String, Vec<&Value>)| {
        let ([_, after], [_, before]) = (both(seen, "after"), both(seen, "before"));
        (name.clone(), three(&after, &before))
    };
    let cameras: Vec<(String, [ObservationTally; 3])> = cells.iter().map(by_camera).collect();
    let fitted = ObservationTally {
        squares: cameras.iter().flat_map(|(_, [after, ..])| fitted(&after.squares)).collect(),
        ..ObservationTally::default()
    };
    let [after, before, widened] = three(&after, &before);
    (!after.squares.is_empty()).then_some(Scored { after, before, widened, factor, fitted, cameras })
}

/// Squared distances over the factor with which regions of 90 % hold 90 %.
fn fitted(squares: &[f64]) -> Vec<f64> {
    let factor = quantile(squares, NOMINAL / 100.0).map_or(1.0, |square| square / REGION);
    squares.iter().map(|square| square / factor).collect()
}

/// Tables of three and of two cameras used, for runs of some seeds.
pub(super) fn table(store: &Store, seeds: &Range<u64>) -> String {
    let mut text = String::new();
    for size in [3, 2] {
        let _ = writeln!(
            text,
            "{size} cameras used, log scores of what the others see; frames {TUNED} to 99, all seeds:\n"
        );
        text += &header(
            "| camera left out, used | log score | before | before, widened | inside 90 % regions before, % | widened | |",
        );
        let Some(scored) = scored(store, size, seeds.clone()) else { continue };
        let Scored { after, before, widened, factor, cameras, .. } = scored;
        let row = |name: &str, [after, before, widened]: &[ObservationTally; 3], is_judged: bool| {
            let inside = |tally: &ObservationTally| 100.0 * tally.coverage(NOMINAL / 100.0);
            let [a, b, c] = [after, before, widened].map(ObservationTally::log_score);
            let met = if is_judged { verdict(a > c && a > b) } else { "" };
            format!("| {name} | {a:.2} | {b:.2} | {c:.2} | {:.0} | {:.0} | {met} |\n", inside(before), inside(widened))
        };
        cameras.iter().for_each(|(name, tallies)| text += &row(name, tallies, false));
        text += &row("**all**", &[after, before, widened], true);
        let _ = writeln!(text, "\nWidened: covariances times {factor:.1}.\n");
    }
    text
}
