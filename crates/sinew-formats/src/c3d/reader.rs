//! Reader of C3D files of all three processors, of words and of reals.

use super::frame_range::frame_range;
use super::frames::{self, FrameLayout};
use super::header::{self, Header};
use super::parameters::{C3dGroup, count, reals, texts, unsigned};
use super::recording::{Analog, AnalogChannel, C3d, C3dHeader};
use super::screen_axes::ScreenAxis;
use super::source::{BLOCK, Source};
use super::{events, parameter_records};
use crate::point_name::repeated;
use crate::source_text::shortened;
use crate::trc::Units;
use crate::{Error, Place, Warning};

/// Reads a file.
///
/// # Errors
/// A header or parameter section that is none or is cut off, a processor that is not known, units other than m, cm and
/// mm, a rate that is not positive, more frames than the file holds.
pub fn read(name: &str, bytes: &[u8]) -> Result<C3d, Error> {
    let (source, mut header) = header::read(name, bytes)?;
    let groups = parameter_records::read(&source, header.parameters_at)?;
    let mut warnings = Vec::new();
    let is_unsigned =
        texts(&groups, "ANALOG", "FORMAT").first().is_some_and(|format| format.eq_ignore_ascii_case("UNSIGNED"));
    let layout = FrameLayout::new(&source, &header, is_unsigned)?;
    for (field, group, found) in [("POINT:USED", "POINT", layout.points), ("ANALOG:USED", "ANALOG", layout.channels)] {
        let stated = count(&groups, group, "USED").filter(|&stated| stated != found as u64);
        let place = Place::file(name);
        warnings.extend(stated.map(|stated| Warning::CountDisagrees { place, field, stated, found: found as u64 }));
    }
    let data_at = data_at(&source, &header, &groups)?;
    let room = room(&source, &header, data_at, layout.bytes());
    let range = frame_range(&source, &header, &groups, room, &mut warnings)?;
    if room_is_left(room, range.count, layout.bytes()) {
        let (read, room) = (range.count as u64, room);
        warnings.push(Warning::UnreadFrames { place: Place::file(name), read, room });
    }
    let mut analog = analog(&groups, layout);
    let frames = frames::read(&source, data_at, layout, range.count, &mut analog.channels, analog.general_scale)?;
    let mut all_events = std::mem::take(&mut header.events);
    all_events.extend(events::events(&groups));
    let scale = layout.scale.abs();
    let header = C3dHeader {
        rate_hz: rate(&source, &header, &groups)?,
        units: units(&source, &groups, &mut warnings)?,
        first_frame: range.first,
        right: screen_axis(&source, &groups, "X_SCREEN")?,
        up: screen_axis(&source, &groups, "Y_SCREEN")?,
        markers: names(&texts(&groups, "POINT", "LABELS"), layout.points, "point"),
    };
    if header.up.is_none() {
        let (field, value) = ("POINT:Y_SCREEN", "+Z (up)".into());
        warnings.push(Warning::Assumed { place: Place::file(name), field, value });
    }
    let place = || Place::file(name);
    warnings.extend(repeated(&header.markers).map(|name| Warning::RepeatedMarker { place: place(), name }));
    Ok(C3d { processor: source.processor, header, scale, frames, analog, events: all_events, groups, warnings })
}

/// First byte of the frames.
fn data_at(source: &Source<'_>, header: &Header, groups: &[C3dGroup]) -> Result<usize, Error> {
    let stated = match header.data_block {
        0 => count(groups, "POINT", "DATA_START").unwrap_or_default(),
        block => block.into(),
    };
    match usize::try_from(stated) {
        Ok(block @ 1..=0xffff) => Ok((block - 1) * BLOCK),
        _ => Err(source.bad("POINT:DATA_START", stated, "the block of the first frame, 1 to 65535")),
    }
}

/// Frames that the file has room for: up to its end, or up to the parameter section where that comes later.
fn room(source: &Source<'_>, header: &Header, data_at: usize, frame: usize) -> u64 {
    let length = source.bytes.len();
    let end = if header.parameters_at > data_at { header.parameters_at.min(length) } else { length };
    match frame {
        // Frames of nothing take no bytes; a file cannot have more of them than it has bytes.
        0 => length as u64,
        _ => (end.saturating_sub(data_at) / frame) as u64,
    }
}

/// Whether there is more behind the frames than what fills the last block.
fn room_is_left(room: u64, frames: usize, frame: usize) -> bool {
    frame > 0 && room.saturating_sub(frames as u64).saturating_mul(frame as u64) >= BLOCK as u64
}

/// The rate as the decimal number with the fewest digits that its four bytes stand for: 59.94, not 59.939998626708984.
fn rate(source: &Source<'_>, header: &Header, groups: &[C3dGroup]) -> Result<f64, Error> {
    let stated = reals(groups, "POINT", "RATE").first().copied().filter(|rate| *rate != 0.0);
    let rate = stated.unwrap_or(header.rate_hz);
    let short: f64 = (rate as f32).to_string().parse().unwrap_or(rate);
    if short.is_finite() && short > 0.0 { Ok(short) } else { Err(source.bad("POINT:RATE", rate, "positive")) }
}

fn units(source: &Source<'_>, groups: &[C3dGroup], warnings: &mut Vec<Warning>) -> Result<Units, Error> {
    let stated = texts(groups, "POINT", "UNITS").into_iter().next().filter(|units| !units.is_empty());
    let Some(stated) = stated else {
        let (field, value) = ("POINT:UNITS", "mm".into());
        warnings.push(Warning::Assumed { place: Place::file(source.name), field, value });
        return Ok(Units::Millimetres);
    };
    Units::named(stated).ok_or_else(|| source.bad("POINT:UNITS", shortened(stated), "m, cm or mm"))
}

fn screen_axis(source: &Source<'_>, groups: &[C3dGroup], name: &str) -> Result<Option<ScreenAxis>, Error> {
    let stated = texts(groups, "POINT", name).into_iter().next().filter(|axis| !axis.is_empty());
    let Some(stated) = stated else { return Ok(None) };
    let field = format!("POINT:{name}");
    ScreenAxis::named(stated).map(Some).ok_or_else(|| source.bad(&field, shortened(stated), "+X, -X, +Y, -Y, +Z or -Z"))
}

/// Exactly `count` names; those without a label are numbered from 1.
fn names(labels: &[&str], count: usize, what: &str) -> Vec<String> {
    let label = |number: usize| match labels.get(number - 1) {
        None | Some(&"") => format!("{what}_{number}"),
        Some(label) => (*label).to_owned(),
    };
    (1..=count).map(label).collect()
}

/// The channels without their samples.
fn analog(groups: &[C3dGroup], layout: FrameLayout) -> Analog {
    let [scales, general] = ["SCALE", "GEN_SCALE"].map(|name| reals(groups, "ANALOG", name));
    let read_offsets = if layout.is_unsigned { unsigned } else { reals };
    let offsets = read_offsets(groups, "ANALOG", "OFFSET");
    let units = texts(groups, "ANALOG", "UNITS");
    let names = names(&texts(groups, "ANALOG", "LABELS"), layout.channels, "channel");
    let channel = |(index, name): (usize, String)| AnalogChannel {
        name,
        units: units.get(index).copied().unwrap_or_default().to_owned(),
        scale: scales.get(index).copied().unwrap_or(1.0),
        offset: offsets.get(index).copied().unwrap_or(0.0),
        samples: Vec::new(),
    };
    Analog {
        samples_per_frame: layout.samples_per_frame,
        general_scale: general.first().copied().unwrap_or(1.0),
        is_unsigned: layout.is_unsigned,
        channels: names.into_iter().enumerate().map(channel).collect(),
    }
}
