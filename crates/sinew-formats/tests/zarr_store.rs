//! The Zarr store: its own metadata against its chunks, and read by Python where that is installed.

use serde_json::Value;
use sinew_formats::zarr::inference_data::{DrawsKind, RunAttributes, group, posterior, root, schema};
use sinew_formats::zarr::{Constant, DataType, FrameValues, Labels, MemoryStore, Schema, Store, Variable, Writer};
use std::io;
use std::process::Command;

const CHAINS: usize = 2;
const DRAWS: usize = 20;
const DOF: usize = 3;
const MARKERS: usize = 2;
const FRAMES: usize = 150;

const RUN: RunAttributes<'_> =
    RunAttributes { library_version: "0.1.0", method: "hmc", kind: DrawsKind::Filtered, seed: 7, created_at: None };

fn example_schema() -> Schema {
    let dof = (0..DOF).map(|i| format!("knee.r{i}")).collect();
    let mut schema = schema(CHAINS, DRAWS, dof, vec!["Nose".into(), "Größe".into()]);
    schema.dimensions.insert("camera".into(), Labels::Names(vec!["cam_01".into()]));
    schema.groups.push(posterior(&RUN));
    let mut stats = group("sample_stats", &RUN);
    for (name, dimensions, data_type) in [
        ("lp", &["chain", "draw", "frame"][..], DataType::Float64),
        ("diverging", &["chain", "draw", "frame"], DataType::Bool),
        ("n_steps", &["chain", "draw", "frame"], DataType::Int64),
        ("ess", &["chain", "frame"], DataType::Float64),
    ] {
        stats.variables.push(Variable::new(name, dimensions, data_type));
    }
    schema.groups.push(stats);
    let mut constants = group("constant_data", &RUN);
    let variable = Variable::new("camera_centre", &["camera", "axis"], DataType::Float64).with_attribute("units", "m");
    constants.constants.push(Constant { variable, values: vec![1.0, 2.0, 3.0] });
    schema.groups.push(constants);
    schema.attributes = root(&RUN, &schema.groups);
    schema
}

/// A value that encodes where it came from, with some spread over the draws.
fn value(frame: usize, index: usize) -> f64 {
    frame as f64 + ((index * 7919) % 1000) as f64 / 1000.0
}

fn push_frames<S: Store>(writer: &mut Writer<S>, frames: usize) -> io::Result<()> {
    let draws = CHAINS * DRAWS;
    for frame in 0..frames {
        let numbers = |n: usize| (0..n).map(|i| value(frame, i)).collect::<Vec<f64>>();
        let (angle, root, marker) = (numbers(draws * DOF), numbers(draws * 3), numbers(draws * MARKERS * 3));
        let (lp, ess) = (numbers(draws), numbers(CHAINS));
        let diverging: Vec<bool> = (0..draws).map(|i| i == frame % draws).collect();
        let steps: Vec<i64> = (0..draws).map(|i| (i + frame) as i64).collect();
        let values = [
            FrameValues::Numbers(&angle),
            FrameValues::Numbers(&root),
            FrameValues::Numbers(&marker),
            FrameValues::Numbers(&lp),
            FrameValues::Flags(&diverging),
            FrameValues::Integers(&steps),
            FrameValues::Numbers(&ess),
        ];
        writer.push(100 + frame as i64, frame as f64 / 60.0, &values)?;
    }
    Ok(())
}

fn example() -> MemoryStore {
    let mut writer = Writer::create(MemoryStore::default(), example_schema()).unwrap();
    push_frames(&mut writer, FRAMES).unwrap();
    writer.finish().unwrap()
}

fn document(store: &MemoryStore, path: &str) -> Value {
    serde_json::from_slice(&store.0[path]).unwrap()
}

fn sizes(value: &Value) -> Vec<usize> {
    value.as_array().unwrap().iter().map(|v| usize::try_from(v.as_u64().unwrap()).unwrap()).collect()
}

/// Every array: all chunks that its metadata promises are there, with the right length, and no others.
fn check_chunks(store: &MemoryStore) {
    let mut expected: Vec<String> = Vec::new();
    for (key, bytes) in store.0.iter().filter(|(key, _)| key.ends_with("zarr.json")) {
        expected.push(key.clone());
        let metadata: Value = serde_json::from_slice(bytes).unwrap();
        if metadata["node_type"] == "group" {
            continue;
        }
        let path = key.strip_suffix("/zarr.json").unwrap();
        let (shape, chunk) =
            (sizes(&metadata["shape"]), sizes(&metadata["chunk_grid"]["configuration"]["chunk_shape"]));
        assert_eq!(shape.len(), metadata["dimension_names"].as_array().unwrap().len(), "{path}");
        let counts: Vec<usize> = shape.iter().zip(&chunk).map(|(size, chunk)| size.div_ceil(*chunk)).collect();
        assert!(counts.iter().filter(|&&count| count > 1).count() <= 1, "{path}: only frames are cut");
        let element = match metadata["data_type"].as_str().unwrap() {
            "float32" => Some(4),
            "float64" | "int64" => Some(8),
            "bool" => Some(1),
            _ => None,
        };
        for index in 0..counts.iter().product::<usize>() {
            let part = |count: &usize| if *count > 1 { index } else { 0 }.to_string();
            let chunk_key = format!("{path}/c.{}", counts.iter().map(part).collect::<Vec<_>>().join("."));
            let bytes = store.0.get(&chunk_key).unwrap_or_else(|| panic!("{chunk_key} is missing"));
            if let Some(element) = element {
                assert_eq!(bytes.len(), element * chunk.iter().product::<usize>(), "{chunk_key}");
            }
            expected.push(chunk_key);
        }
    }
    expected.sort();
    let found: Vec<&String> = store.0.keys().collect();
    assert_eq!(found, expected.iter().collect::<Vec<_>>());
}

#[test]
fn chunks_are_those_that_the_metadata_promise() {
    let store = example();
    check_chunks(&store);
    let angle = document(&store, "posterior/angle/zarr.json");
    assert_eq!(sizes(&angle["shape"]), [CHAINS, DRAWS, FRAMES, DOF]);
    assert_eq!(sizes(&angle["chunk_grid"]["configuration"]["chunk_shape"]), [CHAINS, DRAWS, 64, DOF]);
    assert_eq!(angle["attributes"]["coordinates"], "time");
    assert_eq!(angle["fill_value"], "NaN");
    assert!(store.0.contains_key("posterior/angle/c.0.0.2.0"));
}

#[test]
fn values_lie_where_the_shape_says_and_the_rest_is_padding() {
    let store = example();
    let chunk = &store.0["posterior/angle/c.0.0.2.0"];
    let at = |outer: usize, place: usize, dof: usize| {
        let offset = 4 * ((outer * 64 + place) * DOF + dof);
        f32::from_le_bytes(chunk[offset..offset + 4].try_into().unwrap())
    };
    for (outer, frame, dof) in [(0, 128, 0), (7, 130, 2), (39, 149, 1)] {
        assert_eq!(at(outer, frame - 128, dof), value(frame, outer * DOF + dof) as f32);
    }
    assert!(at(0, 150 - 128, 0).is_nan());
    let markers = &store.0["posterior/marker_position/c.0.0.0.0.0"];
    assert_eq!(markers.len(), 4 * CHAINS * DRAWS * 64 * MARKERS * 3);
    assert_eq!(&store.0["posterior/axis/c.0"], b"\x03\0\0\0\x01\0\0\0x\x01\0\0\0y\x01\0\0\0z");
}

#[test]
fn a_store_of_few_frames_has_no_padding() {
    let mut writer = Writer::create(MemoryStore::default(), example_schema()).unwrap();
    push_frames(&mut writer, 7).unwrap();
    let store = writer.finish().unwrap();
    check_chunks(&store);
    let angle = document(&store, "posterior/angle/zarr.json");
    assert_eq!(sizes(&angle["chunk_grid"]["configuration"]["chunk_shape"]), [CHAINS, DRAWS, 7, DOF]);
    let chunk = &store.0["posterior/angle/c.0.0.0.0"];
    for (outer, frame, dof) in [(0, 0, 0), (7, 6, 2), (39, 3, 1)] {
        let offset = 4 * ((outer * 7 + frame) * DOF + dof);
        let found = f32::from_le_bytes(chunk[offset..offset + 4].try_into().unwrap());
        assert_eq!(found, value(frame, outer * DOF + dof) as f32);
    }
}

#[test]
fn all_metadata_are_consolidated_in_the_root() {
    let store = example();
    let root = document(&store, "zarr.json");
    let consolidated = &root["consolidated_metadata"];
    assert_eq!((&consolidated["kind"], &consolidated["must_understand"]), (&"inline".into(), &false.into()));
    let nodes = consolidated["metadata"].as_object().unwrap();
    let paths: Vec<&str> = store.0.keys().filter_map(|key| key.strip_suffix("/zarr.json")).collect();
    assert_eq!(nodes.len(), paths.len());
    for path in paths {
        assert_eq!(nodes[path], document(&store, &format!("{path}/zarr.json")), "{path}");
    }
}

#[test]
fn a_run_that_is_killed_is_readable_up_to_the_last_chunk() {
    let mut store = MemoryStore::default();
    let mut writer = Writer::create(&mut store, example_schema()).unwrap();
    push_frames(&mut writer, 100).unwrap();
    drop(writer);
    check_chunks(&store);
    assert_eq!(sizes(&document(&store, "posterior/time/zarr.json")["shape"]), [64]);
}

#[test]
fn the_same_frames_give_the_same_bytes() {
    assert_eq!(example(), example());
}

#[test]
fn schemas_and_values_that_do_not_fit_are_refused() {
    let refused = |change: fn(&mut Schema)| {
        let mut schema = example_schema();
        change(&mut schema);
        Writer::create(MemoryStore::default(), schema).err().unwrap().to_string()
    };
    assert_eq!(refused(|s| drop(s.dimensions.remove("dof"))), "dimension `dof` has no labels");
    assert!(refused(|s| s.groups[0].name = "..".into()).contains("cannot be a path"));
    assert!(refused(|s| s.groups[1].name = "posterior".into()).contains("is there twice"));
    assert!(refused(|s| s.groups[0].variables[0].dimensions = vec!["dof".into()]).contains("`frame` once"));
    assert!(refused(|s| s.groups[2].constants[0].values.clear()).contains("0 values for the shape [1, 3]"));
    let mut writer = Writer::create(MemoryStore::default(), example_schema()).unwrap();
    assert!(writer.push(0, 0.0, &[]).is_err());
    assert!(writer.push(0, 0.0, &[FrameValues::Numbers(&[1.0]); 7]).is_err());
    assert_eq!(writer.frames(), 0);
}

struct Folder(std::path::PathBuf);

impl Store for Folder {
    fn put(&mut self, key: &str, bytes: &[u8]) -> io::Result<()> {
        let path = self.0.join(key);
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent)?;
        }
        std::fs::write(path, bytes)
    }
}

/// Opens the store as users do; run with the Python named by `SINEW_PYTHON`, or `python3`.
#[test]
fn python_opens_the_store() {
    let python = std::env::var_os("SINEW_PYTHON").unwrap_or_else(|| "python3".into());
    let has = |module: &str| {
        let found = Command::new(&python).args(["-W", "ignore", "-c", &format!("import {module}")]).output();
        let there = found.is_ok_and(|output| output.status.success());
        if !there {
            println!("skipped: no {module}");
        }
        there
    };
    if !(has("zarr") && has("xarray")) {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("posterior.zarr");
    let mut writer = Writer::create(Folder(path.clone()), example_schema()).unwrap();
    push_frames(&mut writer, FRAMES).unwrap();
    writer.finish().unwrap();
    let killed = folder.path().join("killed.zarr");
    let mut writer = Writer::create(Folder(killed.clone()), example_schema()).unwrap();
    push_frames(&mut writer, 100).unwrap();
    drop(writer);
    let script = if has("arviz") {
        concat!(include_str!("zarr_open.py"), "\ncheck_arviz()\n")
    } else {
        include_str!("zarr_open.py")
    };
    let output = Command::new(&python).args(["-W", "ignore", "-c", script]).args([&path, &killed]).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
    println!("{text}");
}
