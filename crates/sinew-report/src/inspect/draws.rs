//! What a Zarr store holds: groups, arrays and their attributes, from the `zarr.json` of each.

use super::error::InspectError;
use super::facts::Facts;
use crate::Error;
use serde_json::Value;
use sinew::files::read_text;
use sinew_formats::json_text;
use sinew_formats::source_text::MAX_TEXT_BYTES;
use std::fs;
use std::path::{Path, PathBuf};

/// Name of the document that every node of a store has.
const DOCUMENT: &str = "zarr.json";

/// Levels of groups below the root that are looked at; ours have one.
const LEVELS: usize = 4;

/// Attributes of groups that are shown.
const SHOWN: [&str; 3] = ["kind", "method", "seed"];

/// Whether a folder is a store, or should be one by its name.
pub(super) fn is_store(folder: &Path) -> bool {
    let is_named_so = folder.file_name().is_some_and(|name| name.to_string_lossy().contains(".zarr"));
    is_named_so || folder.join(DOCUMENT).is_file()
}

pub(super) fn facts(folder: &Path) -> Result<Facts, Error> {
    if !folder.join(DOCUMENT).is_file() {
        return Err(InspectError::NoStore { folder: folder.to_owned(), document: DOCUMENT }.into());
    }
    let mut nodes = Vec::new();
    collect(folder, "", LEVELS, &mut nodes)?;
    let is_array = |node: &Value| node["node_type"] == "array";
    let arrays = nodes.iter().filter(|(_, node)| is_array(node)).count();
    let mut facts = Facts::new(format!("{}: Zarr store of {arrays} arrays", folder.display()));
    for (title, dimension) in [("frames", "frame"), ("draws", "draw")] {
        let size = nodes.iter().flat_map(|(_, node)| sizes(node)).find(|(name, _)| name == dimension);
        if let Some((_, size)) = size {
            facts.row(title, size);
        }
    }
    let mut coordinates: Vec<String> = Vec::new();
    for (path, node) in &nodes {
        let sizes = sizes(node);
        let last = path.rsplit('/').next().unwrap_or_default();
        if !is_array(node) {
            let shown = SHOWN.iter().filter(|key| !node["attributes"][key].is_null());
            let shown: Vec<String> = shown.map(|key| format!("{key} {}", plain(&node["attributes"][key]))).collect();
            facts.row(path, shown.join(", "));
        } else if matches!(&sizes[..], [(name, _)] if name == last) {
            coordinates.push(last.to_owned());
        } else {
            let sizes: Vec<String> = sizes.iter().map(|(name, size)| format!("{name} {size}")).collect();
            let unit = node["attributes"]["units"].as_str().map(|unit| format!(", {unit}")).unwrap_or_default();
            facts.row(path, format!("{}; {}{unit}", sizes.join(", "), plain(&node["data_type"])));
        }
    }
    coordinates.sort();
    coordinates.dedup();
    facts.row("coordinates", coordinates.join(" "));
    Ok(facts)
}

/// Path and document of every node below a folder, by name.
fn collect(folder: &Path, path: &str, levels: usize, nodes: &mut Vec<(String, Value)>) -> Result<(), Error> {
    let mut names: Vec<PathBuf> = Vec::new();
    for entry in fs::read_dir(folder).map_err(sinew::Error::io("read", folder))? {
        names.push(entry.map_err(sinew::Error::io("read", folder))?.path());
    }
    names.sort();
    for below in names {
        let document = below.join(DOCUMENT);
        if !document.is_file() {
            continue;
        }
        let text = read_text(&document, MAX_TEXT_BYTES)?;
        let node: Value = json_text::parse(&document.display().to_string(), &text)?;
        let name = below.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let path = if path.is_empty() { name } else { format!("{path}/{name}") };
        let is_group = node["node_type"] == "group";
        nodes.push((path.clone(), node));
        if is_group && levels > 0 {
            collect(&below, &path, levels - 1, nodes)?;
        }
    }
    Ok(())
}

/// Name and size of each dimension of an array.
fn sizes(node: &Value) -> Vec<(String, String)> {
    let sizes = node["shape"].as_array().into_iter().flatten();
    let name = |index: usize| node["dimension_names"][index].as_str().unwrap_or("-").to_owned();
    sizes.enumerate().map(|(index, size)| (name(index), size.to_string())).collect()
}

fn plain(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}
