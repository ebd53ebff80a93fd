//! What a C3D file holds: its points as any motion, and what the format has beside them.

use super::facts::{Facts, shortened};
use super::motion_file;
use crate::Error;
use sinew_formats::c3d::C3d;
use sinew_motion::convert::c3d_points;
use std::collections::BTreeMap;
use std::path::Path;

/// Facts of a file.
pub(super) fn facts(path: &Path) -> Result<Facts, Error> {
    let file = c3d_points::file(path)?;
    let mut facts = motion_file::motion_facts(path, c3d_points::motion(&file));
    let up = file.header.up.map_or(String::new(), |axis| format!(", {} up", axis.name()));
    let (units, processor) = (file.header.units.symbol(), file.processor.name());
    facts.row("stored", format!("{units}{up}, first frame {}, for {processor}", file.header.first_frame));
    let names: Vec<String> = file.analog.channels.iter().map(|channel| channel.name.clone()).collect();
    if !names.is_empty() {
        let rate = file.analog_rate_hz();
        facts.row("analog", format!("{} channels at {rate} per second: {}", names.len(), shortened(&names)));
    }
    if !file.events.is_empty() {
        facts.row("events", events(&file));
    }
    Ok(facts)
}

/// How often each happens, and when the first and the last do.
fn events(file: &C3d) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for event in &file.events {
        *counts.entry(&event.label).or_default() += 1;
    }
    let listed: Vec<String> = counts.iter().map(|(label, count)| format!("{label} ({count})")).collect();
    let times = || file.events.iter().map(|event| event.time_s);
    let (first, last) = (times().fold(f64::INFINITY, f64::min), times().fold(f64::NEG_INFINITY, f64::max));
    format!("{} from {first:.2} to {last:.2} s: {}", file.events.len(), shortened(&listed))
}
