//! Cameras that a run did not use, against `sinew predict`.
//!
//! Keypoints of the judged frames count. The camera's own offset, the median over the frames of tuning, is taken off.

use super::protocol::{LAYOUT, Recording, is_in, sets};
use super::summary::over_seeds;
use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown};
use crate::support::statistics::{mean, median, quantile, verdict};
use crate::support::store::{Store, rows};
use crate::support::table::{header, row};
use serde_json::{Value, json};
use sinew::formats::openpose::{OpenposeOptions, OpenposePerson};
use sinew::formats::tidy_csv;
use sinew::formats::{Layout, layout, openpose};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

/// Frames of tuning; those after them are judged.
pub(super) const TUNED: u64 = 60;
/// Detections of lower confidence are not compared.
const CONFIDENT: f64 = 0.5;
/// Squared distance of the 90 % region of two dimensions.
pub(super) const REGION: f64 = 4.605_170_186;

/// What is predicted of a keypoint: mean, and covariance without the common part.
pub(super) struct Expected {
    /// Its place in the layout.
    pub(super) column: usize,
    pub(super) at: [f64; 2],
    pub(super) covariance: [f64; 3],
}

/// What is predicted, frame by frame.
pub(super) type Prediction = BTreeMap<u64, Vec<Expected>>;

/// What was observed of it, the camera's own offset taken off.
pub(super) struct Observed {
    /// Its frame.
    pub(super) frame: u64,
    /// Its place in the layout.
    pub(super) column: usize,
    /// Whether its frame served tuning.
    pub(super) is_tuned: bool,
    pub(super) error_px: f64,
    /// Squared distance in standard deviations.
    pub(super) square: f64,
    /// The same with the keypoint's own offset taken off as well, its median over the frames of tuning; not a number where these do not show it.
    pub(super) without_constant: f64,
    /// Logarithm of the determinant of the covariance.
    pub(super) log_determinant: f64,
}

/// The table of `sinew predict`.
fn expected(text: &str) -> Outcome<Prediction> {
    let table = tidy_csv::read_cells("predicted.csv", text)?;
    let layout = layout::find(LAYOUT)?;
    let mut frames = Prediction::new();
    for (_, row) in &table.rows {
        let number = |k: usize| row[k].parse::<f64>();
        let Some(column) = layout.index(&row[2]) else { continue };
        let own = |k: usize| -> Outcome<f64> { Ok(number(5 + k)? - number(8 + k)?) };
        let at = [number(3)?, number(4)?];
        frames.entry(row[0].parse()?).or_default().push(Expected {
            column,
            at,
            covariance: [own(0)?, own(1)?, own(2)?],
        });
    }
    Ok(frames)
}

fn residuals<'a>(person: &OpenposePerson, expected: &'a [Expected]) -> Vec<(&'a Expected, [f64; 2])> {
    let one = |expected: &'a Expected| {
        let seen = person.keypoints.get(expected.column).copied().flatten()?;
        let away = [seen.x - expected.at[0], seen.y - expected.at[1]];
        (seen.confidence > CONFIDENT).then_some((expected, away))
    };
    expected.iter().filter_map(one).collect()
}

/// The people that a camera saw in a frame.
fn people(recording: &Recording, camera: &str, frame: u64, layout: &Layout) -> Outcome<Vec<OpenposePerson>> {
    let path = recording.file(camera, frame).ok_or("a camera is not in the recording")?;
    let options = OpenposeOptions { layout: Some(layout), ..OpenposeOptions::default() };
    Ok(openpose::read(&shown(&path), &std::fs::read_to_string(&path)?, &options)?.people)
}

/// Frames and keypoints of which two of the used cameras or more are confident.
fn seen_twice(recording: &Recording, used: &[&str]) -> Outcome<BTreeSet<(u64, usize)>> {
    let (layout, mut count) = (layout::find(LAYOUT)?, BTreeMap::<(u64, usize), usize>::new());
    for (camera, frame) in used.iter().flat_map(|camera| (0..recording.frames as u64).map(move |frame| (camera, frame)))
    {
        let people = people(recording, camera, frame, &layout)?;
        let is_seen = |column: &usize| {
            let all = || people.iter().filter_map(|person| person.keypoints.get(*column).copied().flatten());
            all().any(|seen| seen.confidence > CONFIDENT)
        };
        for column in (0..layout.points.len()).filter(is_seen) {
            *count.entry((frame, column)).or_default() += 1;
        }
    }
    Ok(count.into_iter().filter_map(|(key, cameras)| (cameras > 1).then_some(key)).collect())
}

/// What a camera saw of a prediction, and its own offset.
pub(super) fn observed(
    prediction: Prediction,
    recording: &Recording,
    camera: &str,
) -> Outcome<(Vec<Observed>, [f64; 2])> {
    let layout = layout::find(LAYOUT)?;
    let mut seen: Vec<(u64, usize, [f64; 3], [f64; 2])> = vec![];
    for (frame, expected) in prediction {
        let people = people(recording, camera, frame, &layout)?;
        let by_person = people.iter().map(|person| residuals(person, &expected)).filter(|seen| !seen.is_empty());
        let away = |seen: &Vec<(&Expected, [f64; 2])>| median(seen.iter().map(|(_, [u, v])| u.hypot(*v)));
        if let Some(nearest) = by_person.min_by(|a, b| away(a).total_cmp(&away(b))) {
            seen.extend(nearest.into_iter().map(|(own, r)| (frame, own.column, own.covariance, r)));
        }
    }
    let offset = [0, 1].map(|axis: usize| median(seen.iter().filter(|s| s.0 < TUNED).map(|s| s.3[axis])));
    let constant = |column: usize| {
        let own = || seen.iter().filter(|s| s.0 < TUNED && s.1 == column);
        [0, 1].map(|axis: usize| median(own().map(|s| s.3[axis])))
    };
    let constants: Vec<[f64; 2]> = (0..layout.points.len()).map(constant).collect();
    let one = |&(frame, column, [uu, uv, vv], r): &(u64, usize, [f64; 3], [f64; 2])| {
        let determinant = uu * vv - uv * uv;
        let square = |from: [f64; 2]| {
            let [a, b] = [r[0] - from[0], r[1] - from[1]];
            (vv * a * a - 2.0 * uv * a * b + uu * b * b) / determinant
        };
        let error_px = (r[0] - offset[0]).hypot(r[1] - offset[1]);
        let (is_tuned, log_determinant) = (frame < TUNED, determinant.ln());
        let (square, without_constant) = (square(offset), square(constants[column]));
        Observed { frame, column, is_tuned, error_px, square, without_constant, log_determinant }
    };
    Ok((seen.iter().map(one).collect(), offset))
}

/// What `sinew predict` says that a camera should see of a run.
pub(super) fn predicted(program: &Program, recording: &Recording, run: &Path, camera: &str) -> Outcome<Prediction> {
    let table = run.join("predicted.csv");
    let flags = ["predict", &shown(run), "--calibration", &shown(&recording.calibration), "--camera", camera];
    let rest = ["-o", &shown(&table), "--force"];
    program.run(&flags.into_iter().chain(rest).map(str::to_owned).collect::<Vec<_>>(), &[0])?;
    expected(&std::fs::read_to_string(&table)?)
}

/// A run with some cameras, and what the others see of it.
pub(super) fn cell(program: &Program, recording: &Recording, used: &[&str], seed: u64) -> Outcome<Value> {
    let folder = program.folder.join(format!("used-{}-{seed}", used.join("-")));
    program.track(&recording.flags(used, seed), &folder)?;
    let (twice, mut found) = (seen_twice(recording, used)?, serde_json::Map::new());
    for camera in recording.cameras.iter().filter(|camera| !used.contains(camera)) {
        let (seen, offset) = observed(predicted(program, recording, &folder, camera)?, recording, camera)?;
        let row = |s: &Observed| {
            let is_seen_twice = f64::from(u8::from(twice.contains(&(s.frame, s.column))));
            [s.square, s.error_px, is_seen_twice, s.column as f64, s.without_constant, s.log_determinant]
        };
        let judged: Vec<[f64; 6]> = seen.iter().filter(|s| !s.is_tuned).map(row).collect();
        found.insert((*camera).into(), json!({ "judged": judged, "offset_px": offset }));
    }
    std::fs::remove_dir_all(&folder)?;
    Ok(found.into())
}

/// Share of the observations inside 90 % regions, percent; `square` is the place of the squared distance in a row.
fn share(judged: &mut dyn Iterator<Item = &Vec<f64>>, square: usize) -> f64 {
    let known = judged.map(|j| j[square]).filter(|square| !square.is_nan());
    100.0 * mean(known.map(|square| f64::from(u8::from(square <= REGION))))
}

/// What judged observations come to, each number seed by seed.
fn row(text: &mut String, name: &str, seeds: &[Vec<Vec<f64>>], bounds: Option<[f64; 2]>) {
    let each = |of: &dyn Fn(&Vec<Vec<f64>>) -> f64| seeds.iter().map(of).collect::<Vec<f64>>();
    let at = |share: f64| {
        over_seeds(&each(&|judged| {
            quantile(&judged.iter().map(|j| j[1]).collect::<Vec<f64>>(), share).unwrap_or(f64::NAN)
        }))
    };
    let twice = |j: &&Vec<f64>| j[2] > 0.0;
    let inside = each(&|judged| share(&mut judged.iter(), 0));
    let (bound, met) = match bounds {
        Some([low, high]) => (format!("{low} to {high}"), verdict(is_in(mean(inside.iter().copied()), [low, high]))),
        None => (String::new(), ""),
    };
    row!(
        *text,
        "{name} | {:.0} | {} | {bound} | {met} | {} | {} | {} | {:.0} | {}",
        mean(each(&|judged| judged.len() as f64).into_iter()),
        over_seeds(&inside),
        over_seeds(&each(&|judged| share(&mut judged.iter(), 4))),
        at(0.5),
        at(0.9),
        mean(each(&|judged| judged.iter().filter(twice).count() as f64).into_iter()),
        over_seeds(&each(&|judged| share(&mut judged.iter().filter(twice), 0))),
    );
}

/// Tables of three and of two cameras used, for runs of some seeds.
pub(super) fn table(store: &Store, recording: &Recording, seeds: Range<u64>) -> String {
    let (mut text, last) = (String::new(), recording.frames - 1);
    let [three, two] = recording.bounds;
    for (size, bounds, each) in [(3, three, recording.each), (2, two, None)] {
        let _ = writeln!(
            text,
            "{size} cameras used, the others predicted; frames {TUNED} to {last}; mean ± standard deviation over seeds:\n"
        );
        text += &header(
            "| camera left out, used | observations | inside 90 % regions, % | bound | | own constant known, % | median error, px | 90 % of errors, px | two used cameras see it | inside, % |",
        );
        let mut all: Vec<Vec<Vec<f64>>> = seeds.clone().map(|_| vec![]).collect();
        for used in sets(&recording.cameras, size) {
            let cells: Vec<&Value> = seeds.clone().filter_map(|seed| store.get(&recording.cell(&used, seed))).collect();
            for camera in recording.cameras.iter().filter(|camera| !used.contains(camera) && !cells.is_empty()) {
                let judged: Vec<Vec<Vec<f64>>> = cells.iter().map(|cell| rows(&cell[camera]["judged"])).collect();
                row(&mut text, &format!("{camera}, {}", used.join(" ")), &judged, each);
                all.iter_mut().zip(judged).for_each(|(all, own)| all.extend(own));
            }
        }
        all.retain(|own| !own.is_empty());
        row(&mut text, "**all**", &all, Some(bounds));
        text.push('\n');
    }
    text
}

/// Kinds of keypoints, by what their names end with.
const KINDS: [(&str, &[&str]); 8] = [
    ("head and neck", &["Nose", "Eye", "Ear", "Head", "Neck"]),
    ("shoulders", &["Shoulder"]),
    ("elbows", &["Elbow"]),
    ("wrists", &["Wrist"]),
    ("hips", &["Hip"]),
    ("knees", &["Knee"]),
    ("ankles", &["Ankle"]),
    ("feet", &["Toe", "Heel"]),
];

/// What observations of a kind come to, three cameras used and two, seed by seed.
fn kind_row(name: &str, [three, two]: [&[Vec<Vec<f64>>]; 2]) -> String {
    let over = |seeds: &[Vec<Vec<f64>>], of: &dyn Fn(&[Vec<f64>]) -> f64| {
        let found: Vec<f64> = seeds.iter().map(|judged| of(judged)).filter(|found| found.is_finite()).collect();
        if found.is_empty() { "–".into() } else { over_seeds(&found) }
    };
    let inside = |place: usize| move |judged: &[Vec<f64>]| share(&mut judged.iter(), place);
    // The radius of a disk of the same area as the region.
    let radius = |judged: &[Vec<f64>]| mean(judged.iter().map(|j| (0.25 * j[5]).exp() * REGION.sqrt()));
    let score = |judged: &[Vec<f64>]| mean(judged.iter().map(|j| -0.5 * (j[0] + j[5]) - std::f64::consts::TAU.ln()));
    let count = mean(three.iter().map(|judged| judged.len() as f64));
    let set = |seeds: &[Vec<Vec<f64>>]| {
        let [held, free, size, score] =
            [over(seeds, &inside(0)), over(seeds, &inside(4)), over(seeds, &radius), over(seeds, &score)];
        format!("{held} | {free} | {size} | {score}")
    };
    format!("| {name} | {count:.0} | {} | {} |\n", set(three), set(two))
}

/// Coverage, size of regions and log score by kind of keypoint, three cameras used and two; and coverage once one constant of each camera and keypoint, its median over the frames of tuning, is known.
pub(super) fn kinds_table(store: &Store, recording: &Recording, seeds: Range<u64>) -> Outcome<String> {
    let layout = layout::find(LAYOUT)?;
    let judged = |size: usize, seed: u64, names: &[&str]| -> Vec<Vec<f64>> {
        let cells =
            sets(&recording.cameras, size).into_iter().filter_map(|used| store.get(&recording.cell(&used, seed)));
        let all = cells.flat_map(|cell| recording.cameras.iter().flat_map(|camera| rows(&cell[camera]["judged"])));
        let is_own = |row: &Vec<f64>| {
            let name = layout.points.get(row[3] as usize).cloned().flatten().unwrap_or_default();
            names.iter().any(|end| name.ends_with(end))
        };
        all.filter(is_own).collect()
    };
    let mut text = format!("By kind of keypoint, mean ± standard deviation over seeds, frames from {TUNED} on:\n\n");
    text += &header(
        "| keypoints | observations, 3 used | inside 90 %, % | own constant known, % | radius, px | log score | 2 used: inside, % | own constant known, % | radius, px | log score |",
    );
    let everything: Vec<&str> = KINDS.iter().flat_map(|(_, names)| names.iter().copied()).collect();
    for (name, names) in KINDS.into_iter().chain([("**all**", everything.as_slice())]) {
        let [three, two] = [3, 2].map(|size| seeds.clone().map(|seed| judged(size, seed, names)).collect::<Vec<_>>());
        if two.iter().chain(&three).any(|judged| !judged.is_empty()) {
            text += &kind_row(name, [&three, &two]);
        }
    }
    Ok(text)
}
