//! Every field of a checkpoint matters: none can be changed or left out unnoticed.
//!
//! A run is stopped in its middle, and its checkpoint is taken apart as JSON. One field after the other is changed, and emptied; the run is resumed from that and stopped again
//! a frame later. A field is *noticed* if the run is refused, or if its checkpoint or its files differ there from an unbroken run's. Long lists count as two fields. A
//! field must be noticed in one of five runs at least: particles on keypoints, Hamiltonian Monte Carlo with smoothing and with a fixed lag, a search on silhouettes, one on silhouettes and colours with a set-up of its own. In the first somebody
//! else is in the cameras' view in the frame after the stop.

use crate::common::synthetic::Whole;
use crate::common::{Files, column, files, write_files};
use serde_json::Value;
use sinew::track::checkpoint::{self, Checkpoint};
use sinew_results::problem;
use std::collections::BTreeMap;
use std::fs;

/// Frames of the run, those before the checkpoint, and those before the comparison.
const FRAMES: u64 = 12;
const STOP: u64 = 7;
const END: u64 = 8;

/// Numbers of a list above which its parts are changed together.
const LONG: usize = 16;
const PARTS: usize = 2;

/// Angles of the frame before, to which the next ones are taken nearest: left out they show only beyond half a turn, which a test of the result folder has
/// (`channels_beyond_half_a_turn_do_not_jump_where_a_run_is_resumed`), and one of their marginals (`intervals_are_not_cut_at_half_a_turn`).
const ANGLES: [&str; 2] = ["/pipeline/angles", "/written/channels_before"];

/// A place in a document, and for long lists which part of it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Field {
    pointer: String,
    part: Option<usize>,
}

/// Places of all fields below a value: lists of numbers, of texts and of such lists are one field.
fn fields(value: &Value, pointer: &str, out: &mut Vec<Field>) {
    let mut push = |part| out.push(Field { pointer: pointer.to_owned(), part });
    match value {
        Value::Array(items) if !items.is_empty() && items.iter().all(Value::is_object) => {
            items.iter().enumerate().for_each(|(i, item)| fields(item, &format!("{pointer}/{i}"), out));
        }
        Value::Array(items) if items.len() > LONG => (0..PARTS).for_each(|part| push(Some(part))),
        Value::Object(entries) => {
            for (key, item) in entries {
                fields(item, &format!("{pointer}/{}", key.replace('~', "~0").replace('/', "~1")), out);
            }
        }
        _ => push(None),
    }
}

/// Another value of the same kind.
fn changed(value: &mut Value) {
    match value {
        Value::Bool(flag) => *flag = !*flag,
        Value::String(text) => text.push('1'),
        // More than a turn, whether in degrees or radians: what is nearest to an angle is then another one.
        Value::Number(number) if number.is_f64() => *value = (number.as_f64().unwrap() * 1.01 + 400.0).into(),
        Value::Number(number) => *value = (number.as_u64().unwrap() ^ 1).into(),
        Value::Array(items) if items.is_empty() => {}
        Value::Array(items) => items.iter_mut().for_each(changed),
        Value::Object(entries) => entries.values_mut().for_each(changed),
        Value::Null => {}
    }
}

/// What stands where nothing was kept.
fn emptied(value: &mut Value) {
    match value {
        Value::Bool(flag) => *flag = false,
        Value::String(text) => text.clear(),
        Value::Number(number) if number.is_f64() => *value = 0.0.into(),
        Value::Number(_) => *value = 0.into(),
        Value::Array(items) => items.clear(),
        Value::Object(entries) => entries.values_mut().for_each(emptied),
        Value::Null => {}
    }
}

/// A document with a field edited; `None` where that changes nothing.
fn with(document: &Value, field: &Field, edit: fn(&mut Value)) -> Option<Value> {
    let mut edited = document.clone();
    let place = edited.pointer_mut(&field.pointer).unwrap();
    match (&field.part, place) {
        (Some(part), Value::Array(items)) => {
            let length = items.len().div_ceil(PARTS);
            items.iter_mut().skip(part * length).take(length).for_each(edit);
        }
        (_, place) => edit(place),
    }
    (edited != *document).then_some(edited)
}

/// Resumes in a copy of a stopped run; the files after [`END`] frames, or why it was refused.
fn resumed(whole: &Whole, stopped: &Files, from: Checkpoint) -> Result<Files, String> {
    let out = whole.folder.path().join("resumed");
    write_files(&out, stopped);
    let ended = whole.run(&out, 1, Some(END), Some(from)).map(drop).map_err(|error| error.to_string());
    let mut left = files(&out);
    fs::remove_dir_all(&out).unwrap();
    left.remove("timings.json");
    ended.map(|()| left)
}

/// The files of a run that was stopped, and its checkpoint as a document.
fn stopped(whole: &Whole) -> (Files, Value) {
    let out = whole.folder.path().join("stopped");
    whole.run(&out, 1, Some(STOP), None).unwrap();
    let from = checkpoint::read(&out).unwrap();
    assert_eq!(from.done, STOP);
    let document = serde_json::to_value(&from).unwrap();
    let again: Checkpoint = serde_json::from_value(document.clone()).expect("all numbers are finite");
    assert!(again == from, "a document keeps the bits");
    (files(&out), document)
}

/// Edits of fields, and whether they are noticed.
type Edits = BTreeMap<(Field, &'static str), bool>;

/// Every edit of a field that is not `known` to be noticed.
fn edits(whole: &Whole, known: &Edits) -> Edits {
    let (stopped, document) = stopped(whole);
    let unbroken = whole.folder.path().join("unbroken");
    whole.run(&unbroken, 1, Some(END), None).unwrap();
    let mut expected = files(&unbroken);
    expected.remove("timings.json");
    assert!(expected.contains_key(problem::NAME));
    let from = serde_json::from_value(document.clone()).unwrap();
    let same = resumed(whole, &stopped, from).unwrap();
    let differing: Vec<&String> = expected.keys().filter(|name| same.get(*name) != expected.get(*name)).collect();
    assert!(same == expected, "unchanged, it continues to the same files and the same checkpoint: {differing:?}");
    let mut all = vec![];
    fields(&document, "", &mut all);
    let mut noticed = BTreeMap::new();
    for field in all {
        for (how, edit) in [("changed", changed as fn(&mut Value)), ("left out", emptied)] {
            if known.get(&(field.clone(), how)) == Some(&true) {
                continue;
            }
            let Some(edited) = with(&document, &field, edit) else { continue };
            let Ok(from) = serde_json::from_value(edited) else { continue };
            let is_same = resumed(whole, &stopped, from).is_ok_and(|left| left == expected);
            noticed.insert((field.clone(), how), !is_same);
        }
    }
    noticed
}

/// Puts somebody else into a camera's view in the frame after the stop.
fn with_somebody_else(mut whole: Whole, camera: usize) -> Whole {
    whole.recording.keypoints[camera][STOP as usize].iter_mut().flatten().for_each(|point| point.x += 300.0);
    whole
}

#[test]
fn every_field_is_noticed() {
    let particles = [("method", "bootstrap"), ("particles", "64"), ("draws", "1"), ("body", "cf28")];
    let particles = Whole::blurred(FRAMES, &particles, 20.0);
    let restarted = column(&particles.files["frames.csv"], "restarted");
    assert!(restarted.iter().skip(1).all(|restarted| restarted == "0"), "it must continue: {restarted:?}");
    let smoothed = [("method", "hmc"), ("draws", "1"), ("body", "cf28"), ("smooth", "true")];
    let lagged = [("method", "hmc"), ("draws", "1"), ("body", "cf28"), ("lag_frames", "2")];
    let search = [("method", "annealed"), ("particles", "8"), ("layers", "2"), ("raster", "64"), ("draws", "1")];
    let colours = [("method", "hppf"), ("particles", "8"), ("raster", "64"), ("draws", "1")];
    let runs = [
        with_somebody_else(with_somebody_else(particles, 0), 1),
        Whole::lasting(FRAMES, &smoothed),
        Whole::lasting(FRAMES, &lagged),
        Whole::from_silhouettes(FRAMES, &search),
        Whole::from_pictures(FRAMES, &colours),
    ];
    let mut noticed = Edits::new();
    for whole in &runs {
        for (edit, is_noticed) in edits(whole, &noticed) {
            *noticed.entry(edit).or_insert(false) |= is_noticed;
        }
    }
    println!("{} edits", noticed.len());
    for images in ["masks", "pictures"] {
        let read = format!("/read/{images}/0/start");
        assert!(noticed.keys().any(|(field, _)| field.pointer == read), "{read} is edited");
    }
    assert!(noticed.len() > 150, "{}", noticed.len());
    let is_excused =
        |field: &Field, how: &str| how == "left out" && ANGLES.iter().any(|angles| field.pointer.starts_with(angles));
    let unnoticed = noticed.into_iter().filter(|((field, how), noticed)| !noticed && !is_excused(field, how));
    let unnoticed: Vec<String> =
        unnoticed.map(|((field, how), _)| format!("{} {:?} {how}", field.pointer, field.part)).collect();
    assert_eq!(unnoticed, Vec::<String>::new());
}
