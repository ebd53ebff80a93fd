//! Writer of all that a C3D file holds, for Intel and of reals.
//!
//! Points have residuals and cameras; analog channels, events and parameters stay.
//!
//! The fourth number of a point is cameras · 256 + residual / |scale| as a real, −1 where it is missing, with the scale of
//! the file made negative, which marks reals (Technical User Guide, “Notes for programmers, floating point”). Samples are
//! as they were stored: value / (scale · general scale) + offset. Parameters keep their groups, types and extents, but
//! where they say how frames are stored: POINT:SCALE, POINT:DATA_START, and counts of points, channels and frames.

use super::events;
use super::parameters::{C3dGroup, C3dParameter, C3dValues};
use super::recording::{AnalogChannel, C3d, C3dPoint};
use super::source::BLOCK;
use super::writer::invalid;
use super::written_parameters::BLOCKS;
use std::io::{self, Write};

/// Longest text of a parameter, and most elements in a direction.
const EXTENT: usize = 255;

/// Where the header has its events, counted in bytes from 0: the mark, their number, times, flags and labels.
const EVENTS_AT: [usize; 5] = [298, 300, 304, 376, 396];

/// Writes a file as it was read; of each number four bytes are kept.
///
/// # Errors
/// What the stream reports; `InvalidInput` for what a file cannot hold, as parameters of more than 130 kB.
pub fn write_whole(out: &mut impl Write, file: &C3d) -> io::Result<()> {
    let count = u32::try_from(file.frames.len()).map_err(|_| invalid("more frames than a header can count"))?;
    let last = file.header.last_frame(count)?;
    let blocks = section(file, count, 0)?.len() / BLOCK;
    if blocks > BLOCKS {
        return Err(invalid("its parameters have more than 130 kB"));
    }
    let data_block = (2 + blocks) as u16;
    out.write_all(&header(file, data_block, last)?)?;
    out.write_all(&section(file, count, data_block)?)?;
    let mut written = 0;
    for frame in 0..file.frames.len() {
        let numbers = frame_numbers(file, frame)?;
        written += 4 * numbers.len();
        numbers.iter().try_for_each(|number| out.write_all(&number.to_le_bytes()))?;
    }
    out.write_all(&[0; BLOCK][..written.next_multiple_of(BLOCK) - written])
}

fn short(value: f64) -> io::Result<f32> {
    let short = value as f32;
    if short.is_finite() { Ok(short) } else { Err(invalid("a number that is too large, or none, cannot be written")) }
}

/// Points, then the samples of all channels at each of their times.
fn frame_numbers(file: &C3d, frame: usize) -> io::Result<Vec<f32>> {
    let Some(points) = file.frames.get(frame) else { return Ok(vec![]) };
    let analog = &file.analog;
    let mut numbers = Vec::with_capacity(4 * points.len() + analog.channels.len() * analog.samples_per_frame);
    for point in points {
        numbers.extend(fourth(file, point.as_ref())?);
    }
    for sample in frame * analog.samples_per_frame..(frame + 1) * analog.samples_per_frame {
        for channel in &analog.channels {
            numbers.push(stored(channel, sample, analog.general_scale)?);
        }
    }
    Ok(numbers)
}

/// Position and fourth number.
fn fourth(file: &C3d, point: Option<&C3dPoint>) -> io::Result<[f32; 4]> {
    let Some(point) = point else { return Ok([0.0, 0.0, 0.0, -1.0]) };
    let steps = (f64::from(point.residual) / file.scale).round().clamp(0.0, 255.0);
    let [x, y, z] = point.position;
    Ok([short(x)?, short(y)?, short(z)?, (256.0 * f64::from(point.cameras) + steps) as f32])
}

/// A sample as it was stored.
fn stored(channel: &AnalogChannel, sample: usize, general_scale: f64) -> io::Result<f32> {
    let value = channel.samples.get(sample).copied().unwrap_or_default();
    let factor = channel.scale * general_scale;
    // A channel of scale 0 is 0 whatever was stored.
    short(if factor == 0.0 { channel.offset } else { value / factor + channel.offset })
}

fn header(file: &C3d, data_block: u16, last: u32) -> io::Result<[u8; BLOCK]> {
    let too_many = |what: &'static str| move |_| invalid(what);
    let analog = &file.analog;
    let points = u16::try_from(file.header.markers.len()).map_err(too_many("more points than a C3D file can count"))?;
    let samples = analog.channels.len() * analog.samples_per_frame;
    let samples = u16::try_from(samples).map_err(too_many("more samples in a frame than a C3D file can count"))?;
    let each = u16::try_from(analog.samples_per_frame.max(1)).map_err(too_many("more samples than a word counts"))?;
    let clipped = |number: u32| number.try_into().unwrap_or(u16::MAX);
    let mut block = [0; BLOCK];
    let words = [0x5002, points, samples, clipped(file.header.first_frame), clipped(last), 0, 0, 0, data_block, each];
    for (place, word) in block.as_chunks_mut::<2>().0.iter_mut().zip(words) {
        *place = word.to_le_bytes();
    }
    block[12..16].copy_from_slice(&(-short(file.scale)?).to_le_bytes());
    block[20..24].copy_from_slice(&short(file.header.rate_hz)?.to_le_bytes());
    let own = file.events.len().saturating_sub(events::events(&file.groups).len());
    let [mark, number, times, flags, labels] = EVENTS_AT;
    let shown: Vec<_> = file.events.iter().take(own.min(super::header::EVENTS)).collect();
    if !shown.is_empty() {
        block[mark..mark + 2].copy_from_slice(&super::header::HAS_EVENTS.to_le_bytes());
        block[number..number + 2].copy_from_slice(&(shown.len() as u16).to_le_bytes());
    }
    for (index, event) in shown.iter().enumerate() {
        block[times + 4 * index..][..4].copy_from_slice(&short(event.time_s)?.to_le_bytes());
        block[flags + index] = 1;
        let place = &mut block[labels + 4 * index..][..4];
        place.fill(b' ');
        let bytes = event.label.as_bytes();
        let length = bytes.len().min(4);
        place[..length].copy_from_slice(&bytes[..length]);
    }
    Ok(block)
}

/// The parameter section in whole blocks.
fn section(file: &C3d, frames: u32, data_block: u16) -> io::Result<Vec<u8>> {
    let mut out = vec![1, 0x50, 0, 84];
    let groups = u8::try_from(file.groups.len()).ok().filter(|count| *count < 128);
    groups.ok_or_else(|| invalid("more groups of parameters than a C3D file can count"))?;
    for (number, group) in (1_i8..).zip(&file.groups) {
        named(&mut out, -number, &group.name, |out| described(out, &group.description))?;
        for parameter in &group.parameters {
            let layout = about_layout(file, group, parameter, frames, data_block)?;
            let parameter = layout.as_ref().unwrap_or(parameter);
            named(&mut out, number, &parameter.name, |out| {
                values(out, parameter)?;
                described(out, &parameter.description)
            })?;
        }
    }
    out.extend([0; 2]);
    out.resize(out.len().next_multiple_of(BLOCK), 0);
    out[2] = (out.len() / BLOCK).min(BLOCKS) as u8;
    Ok(out)
}

/// What a parameter says now that frames are stored otherwise.
fn about_layout(
    file: &C3d,
    group: &C3dGroup,
    parameter: &C3dParameter,
    frames: u32,
    data_block: u16,
) -> io::Result<Option<C3dParameter>> {
    let is = |own: &str, name: &str| group.name.eq_ignore_ascii_case(own) && parameter.name.eq_ignore_ascii_case(name);
    let word = |value: usize| C3dValues::Integers(vec![value.try_into().unwrap_or(u16::MAX) as i16]);
    let values = if is("POINT", "SCALE") {
        C3dValues::Reals(vec![-f64::from(short(file.scale)?)])
    } else if is("POINT", "DATA_START") {
        word(data_block.into())
    } else if is("POINT", "USED") {
        word(file.header.markers.len())
    } else if is("POINT", "FRAMES") {
        word(frames as usize)
    } else if is("ANALOG", "USED") {
        word(file.analog.channels.len())
    } else {
        return Ok(None);
    };
    Ok(Some(C3dParameter { values, dimensions: vec![], ..parameter.clone() }))
}

/// A record: the lengths of its name and of what follows, and these.
fn named(
    out: &mut Vec<u8>,
    number: i8,
    name: &str,
    content: impl FnOnce(&mut Vec<u8>) -> io::Result<()>,
) -> io::Result<()> {
    let name = clipped(name, 127);
    // A record without a name would end the section.
    let name = if name.is_empty() { "_" } else { name };
    out.extend([name.len() as u8, number as u8]);
    out.extend(name.as_bytes());
    let link_at = out.len();
    out.extend([0; 2]);
    content(out)?;
    let distance = i16::try_from(out.len() - link_at).map_err(|_| invalid("a parameter of more than 32 kB"))?;
    out[link_at..link_at + 2].copy_from_slice(&distance.to_le_bytes());
    Ok(())
}

/// The beginning of a text that has no more bytes.
fn clipped(text: &str, most: usize) -> &str {
    let end = (0..=most.min(text.len())).rev().find(|end| text.is_char_boundary(*end)).unwrap_or_default();
    &text[..end]
}

fn described(out: &mut Vec<u8>, description: &str) -> io::Result<()> {
    let description = clipped(description, EXTENT);
    out.push(description.len() as u8);
    out.extend(description.as_bytes());
    Ok(())
}

/// Type, number of extents, extents, values.
fn values(out: &mut Vec<u8>, parameter: &C3dParameter) -> io::Result<()> {
    let kind: i8 = match &parameter.values {
        C3dValues::Texts(_) => -1,
        C3dValues::Bytes(_) => 1,
        C3dValues::Integers(_) => 2,
        C3dValues::Reals(_) => 4,
    };
    let mut extents = parameter.dimensions.clone();
    if let (C3dValues::Texts(texts), Some(width)) = (&parameter.values, extents.first_mut()) {
        // A text of Latin-1 takes more bytes as UTF-8.
        let longest = texts.iter().map(String::len).max().unwrap_or_default().min(EXTENT) as u8;
        *width = longest.max(*width);
    }
    out.extend([kind as u8, extents.len() as u8]);
    out.extend(&extents);
    match &parameter.values {
        C3dValues::Texts(texts) => {
            let width = extents.first().map_or(1, |width| usize::from(*width));
            for text in texts {
                let text = clipped(text, width);
                out.extend(text.as_bytes());
                out.resize(out.len() + width - text.len(), b' ');
            }
        }
        C3dValues::Bytes(bytes) => out.extend(bytes),
        C3dValues::Integers(words) => out.extend(words.iter().flat_map(|word| word.to_le_bytes())),
        C3dValues::Reals(reals) => {
            for real in reals {
                // What is no number in a parameter says nothing about points, and is kept.
                out.extend((*real as f32).to_le_bytes());
            }
        }
    }
    Ok(())
}
