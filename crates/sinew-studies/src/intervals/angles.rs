//! Angles of joints and their rates in `angles.csv` of demos, against the truth.
//!
//! True angles come from the axes of the true links by the geometric definition of Grood & Suntay (1983): about the right axis of the proximal link, about the floating axis, about the long axis of the distal link. The
//! program reads the same angles off the entries of a product of rotations; what both share is the pose of the body in the true state ([`sinew_setup::posed_body::pose`]). True rates are differences of true
//! angles over the window that docs/reference/angles.md states, and once more over the two frames about each frame, which is what a rate is usually taken for.

use super::protocol::{DERIVED, FIRST_ANGLES, NOMINAL};
use crate::support::outcome::Outcome;
use crate::support::program::{Program, shown};
use crate::support::statistics::{mean_and_error, verdict};
use crate::support::store::{Store, numbers};
use crate::support::table::{header, with_spread};
use serde_json::{Map, Value, json};
use sinew::body::KinematicTree;
use sinew::core::random::Stage;
use sinew::formats::tidy_csv;
use sinew_setup::posed_body::pose;
use sinew_simulate::adult;
use sinew_simulate::recording::{Script, SyntheticRecording};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use std::path::Path;

type V3 = [f64; 3];

/// Right, forward and up axis of a link in the world.
type Axes = [V3; 3];

const WORLD: Axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Flexion, adduction and rotation of a distal link from a proximal one.
fn grood_suntay([right, forward, up]: Axes, distal: Axes) -> V3 {
    let across = cross(distal[2], right);
    let length = dot(across, across).sqrt();
    let floating = across.map(|x| x / length);
    [
        dot(floating, up).atan2(dot(floating, forward)),
        dot(distal[2], right).asin(),
        dot(floating, distal[0]).atan2(dot(floating, distal[1])),
    ]
}

/// Angles by their names, degrees.
pub(crate) type Angles = BTreeMap<String, f64>;

/// True angles by the names of `angles.csv`.
pub(crate) fn true_angles(body: &KinematicTree, state: &[f64]) -> Outcome<Angles> {
    let posed = pose(body, state);
    let axes = |link: &str| -> Outcome<Axes> {
        let m = posed.rotations[body.link_index(link).ok_or(format!("no {link}"))?];
        Ok([0, 1, 2].map(|k: usize| m.map(|row| row[k])))
    };
    let mut found = Angles::new();
    let mut put = |names: [&str; 3], side: &str, angles: V3, signs: V3| {
        for k in (0..3).filter(|k| !names[*k].is_empty()) {
            found.insert(format!("{}{side}", names[k]), signs[k] * angles[k].to_degrees());
        }
    };
    let (pelvis, spine, girdle, head) = (axes("pelvis")?, axes("spine")?, axes("girdle")?, axes("head")?);
    let plain = [1.0; 3];
    put(["pelvis_tilt", "pelvis_list", "pelvis_rotation"], "", grood_suntay(WORLD, pelvis), plain);
    put(["", "lumbar_bending", "lumbar_rotation"], "", grood_suntay(pelvis, spine), plain);
    let turn = |from: Axes, to: Axes| dot(to[0], from[1]).atan2(dot(to[0], from[0]));
    put(["girdle_rz", "", ""], "", [turn(spine, girdle), 0.0, 0.0], plain);
    // The head's own order: about up, forward, right.
    let nod = dot(head[1], spine[2]).atan2(dot(head[2], spine[2]));
    put(["head_rz", "head_ry", "head_rx"], "", [turn(spine, head), (-dot(head[0], spine[2])).asin(), nod], plain);
    for (prefix, side, sign) in [("r_", "_r", 1.0), ("l_", "_l", -1.0)] {
        let link = |name: &str| axes(&format!("{prefix}{name}"));
        let (thigh, shin, foot) = (link("thigh")?, link("shin")?, link("foot")?);
        let (upper, forearm) = (link("upper_arm")?, link("forearm")?);
        let mirrored = [1.0, sign, sign];
        put(["hip_flexion", "hip_adduction", "hip_rotation"], side, grood_suntay(pelvis, thigh), mirrored);
        put(["arm_flex", "arm_add", "arm_rot"], side, grood_suntay(girdle, upper), mirrored);
        put(["knee_angle", "", ""], side, grood_suntay(thigh, shin), [-1.0; 3]);
        put(["elbow_flex", "", ""], side, grood_suntay(upper, forearm), plain);
        let [flexion, tilt, _] = grood_suntay(shin, foot);
        put(["ankle_angle", "", ""], side, [flexion; 3], plain);
        put([&format!("{prefix}foot_ry"), "", ""], "", [tilt; 3], plain);
    }
    Ok(found)
}

/// Rows of an angle that are counted together.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    count: f64,
    inside: f64,
    error: f64,
    half_width: f64,
}

impl Tally {
    fn add(&mut self, truth: f64, [mean, low, high]: V3) {
        self.count += 1.0;
        self.inside += f64::from(u8::from((low..=high).contains(&truth)));
        self.error += (truth - mean).abs();
        self.half_width += 0.5 * (high - low);
    }

    fn json(self) -> Value {
        let Self { count, inside, error, half_width } = self;
        json!([count, inside, error, half_width])
    }
}

/// What is counted of each angle.
const COUNTED: [&str; 7] =
    ["seen", "unseen", "rate", "rate unseen", "rate standing", "rate walking", "rate, two frames"];

/// Time of standing at the start of a demo, seconds.
const STANDING_S: f64 = 1.0;

/// A run's angles against the truth, by frame; a rate is over a number of frames before and after.
pub(super) fn tallied(folder: &Path, truth: &[Angles], rate_hz: f64, window: [usize; 2]) -> Outcome<Value> {
    let table = tidy_csv::read_cells("angles.csv", &std::fs::read_to_string(folder.join("angles.csv"))?)?;
    let column = |name: &str| table.columns.iter().position(|column| column == name).ok_or(format!("no column {name}"));
    let [frame, name, seen] = [column("frame")?, column("name")?, column("seen")?];
    let triple = |what: &str, unit: &str| -> Outcome<[usize; 3]> {
        let of = |which: &str| column(&format!("{what}{which}_{unit}"));
        Ok([of("mean")?, of("q05")?, of("q95")?])
    };
    let (angle, rate) = (triple("", "deg")?, triple("rate_", "deg_s")?);
    let last = truth.len() - 1;
    let mut tallies: BTreeMap<String, [Tally; COUNTED.len()]> = BTreeMap::new();
    for (_, row) in &table.rows {
        let number: usize = row[frame].parse()?;
        let read = |columns: [usize; 3]| -> Option<V3> {
            let [a, b, c] = columns.map(|column| row[column].parse().ok());
            Some([a?, b?, c?])
        };
        let at = |frame: usize| truth[frame].get(&row[name]).copied().ok_or(format!("no truth of {}", row[name]));
        let known = read(angle).ok_or("an angle that is no number")?;
        let is_seen = row[seen] == "1";
        let own = tallies.entry(row[name].clone()).or_default();
        let here = at(number)?;
        own[usize::from(!is_seen)].add(here + 360.0 * ((known[0] - here) / 360.0).round(), known);
        let Some(known) = read(rate) else { continue };
        let change = |first: usize, last: usize| -> Outcome<f64> {
            let turned = at(last)? - at(first)?;
            Ok((turned - 360.0 * (turned / 360.0).round()) * rate_hz / (last - first) as f64)
        };
        let true_rate = change(number.saturating_sub(window[0]), (number + window[1]).min(last))?;
        own[if is_seen { 2 } else { 3 }].add(true_rate, known);
        if is_seen {
            let is_standing = (number as f64) < STANDING_S * rate_hz;
            own[if is_standing { 4 } else { 5 }].add(true_rate, known);
            own[6].add(change(number.saturating_sub(1), (number + 1).min(last))?, known);
        }
    }
    let of = |tallies: [Tally; COUNTED.len()]| -> Value { tallies.map(Tally::json).to_vec().into() };
    Ok(tallies.into_iter().map(|(name, tallies)| (name, of(tallies))).collect::<Map<_, _>>().into())
}

/// Demos of a seed, filtered and smoothed.
pub(super) fn cell(program: &Program, seed: u64) -> Outcome<Value> {
    let script = Script { proportions: adult::drawn(&Stage::new(seed, "walker")), ..Script::default() };
    let walker = SyntheticRecording::new(&script, seed)?;
    let truth = walker.states.iter().map(|state| true_angles(&walker.body, state)).collect::<Outcome<Vec<_>>>()?;
    let folder = program.folder.join(format!("angles-{seed}"));
    let settings = folder.with_extension("toml");
    let flags =
        ["demo", "--json", "--threads", "1", "--no-progress", "--force", "--seed", &seed.to_string(), "--config"];
    let files = [shown(&settings), "-o".to_owned(), shown(&folder)];
    let mut found = Map::new();
    // A rate is over the last two frames where frames are filtered, and over the frames on both sides where they are smoothed.
    for (kind, smooth, window) in [("filtered", false, [2, 0]), ("smoothed", true, [1, 1])] {
        std::fs::write(&settings, format!("smooth = {smooth}\n"))?;
        program.run(&[&flags.map(str::to_owned)[..], &files].concat(), &[0, 4])?;
        found.insert(kind.into(), tallied(&folder, &truth, script.rate_hz, window)?);
    }
    std::fs::remove_file(&settings)?;
    std::fs::remove_dir_all(&folder)?;
    Ok(found.into())
}

/// What the names of cells begin with.
pub(super) const CELLS: &str = "angles";

/// An angle without its side.
fn group(name: &str) -> &str {
    let name = name.strip_suffix("_l").or_else(|| name.strip_suffix("_r")).unwrap_or(name);
    name.strip_prefix("l_").or_else(|| name.strip_prefix("r_")).unwrap_or(name)
}

/// Of each seed: share inside in percent, mean error and mean half-width of what is counted of an angle on both sides, or of all.
pub(super) fn shares(cells: &[&Value], kind: &str, counted: usize, wanted: Option<&str>) -> Vec<[f64; 3]> {
    let seed_shares = |cell: &&Value| {
        let mut sums = [0.0; 4];
        for (name, tallies) in cell[kind].as_object().into_iter().flatten() {
            if wanted.is_none_or(|wanted| group(name) == wanted) {
                let own = numbers(&tallies[counted]);
                sums.iter_mut().zip(own).for_each(|(sum, x)| *sum += x);
            }
        }
        let [count, inside, error, half_width] = sums;
        (count > 0.0).then(|| [100.0 * inside / count, error / count, half_width / count])
    };
    cells.iter().filter_map(seed_shares).collect()
}

/// Cells of a row of the table.
pub(super) fn written(shares: &[[f64; 3]]) -> (f64, String) {
    if shares.len() < 2 {
        return (f64::NAN, "| | |".into());
    }
    let of = |k: usize| mean_and_error(&shares.iter().map(|seed| seed[k]).collect::<Vec<_>>());
    let ([inside, error], [apart, _], [half_width, _]) = (of(0), of(1), of(2));
    (inside, format!("| {} | {apart:.1} | {half_width:.1} ", with_spread([inside, error], 1)))
}

/// A row: what is counted of an angle or of all, filtered and smoothed, and the bound where it is judged.
fn row(cells: &[&Value], what: &str, counted: usize, wanted: Option<&str>, is_judged: bool) -> String {
    let kinds = ["filtered", "smoothed"].map(|kind| written(&shares(cells, kind, counted, wanted)));
    let held = kinds.iter().all(|(inside, _)| (inside - NOMINAL).abs() <= DERIVED);
    let bound = if is_judged { format!("{NOMINAL} ± {DERIVED} | {}", verdict(held)) } else { "| ".into() };
    format!("| {what} {}{}| {bound} |\n", kinds[0].1, kinds[1].1)
}

const HEAD: &str = "| what | filtered: inside 90 % intervals, % | mean error | half-width \
    | with `--smooth`: inside 90 % intervals, % | mean error | half-width | bound | |";

/// All angles together, and their rates.
pub(super) fn table(store: &Store, seeds: Range<u64>) -> String {
    let cells = store.for_seeds(CELLS, seeds);
    let text = format!(
        "{} demos, seeds from {FIRST_ANGLES}, `angles.csv` against the truth:\n\n{}",
        cells.len(),
        header(HEAD)
    );
    let rows = [
        (0, "angles that are seen, °"),
        (1, "angles that are not seen, °"),
        (2, "rates of angles that are seen, °/s"),
        (4, "the same, standing"),
        (5, "the same, walking"),
        (6, "the same, truth over the frames on both sides"),
        (3, "rates of angles that are not seen, °/s"),
    ];
    text + &rows.map(|(counted, what)| row(&cells, what, counted, None, matches!(counted, 0 | 2))).concat()
}

/// Each angle, both sides together.
pub(super) fn each_table(store: &Store, seeds: Range<u64>) -> String {
    let cells = store.for_seeds(CELLS, seeds);
    let known = cells.first().and_then(|cell| cell["filtered"].as_object()).into_iter().flatten();
    let names: BTreeSet<&str> = known.map(|(name, _)| group(name)).collect();
    let mut text = format!("Each angle, both sides together:\n\n{}", header(HEAD));
    for name in names {
        for (counted, what) in [(0, "°"), (1, "not seen, °"), (2, "rate, °/s"), (3, "rate, not seen, °/s")] {
            if shares(&cells, "filtered", counted, Some(name)).len() > 1 {
                text += &row(&cells, &format!("`{name}`, {what}"), counted, Some(name), false);
            }
        }
    }
    text
}
