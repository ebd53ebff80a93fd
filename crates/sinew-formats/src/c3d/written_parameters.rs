//! Parameter section of the C3D files that are written: groups POINT, ANALOG, FORCE_PLATFORM and TRIAL.

use super::recording::C3dHeader;
use super::source::BLOCK;
use std::io;

/// Values of a parameter that is written.
enum Written<'a> {
    Word(u16),
    /// A frame number in two words, the low one first.
    LongWord(u32),
    Real(f32),
    Text(&'a str),
    /// Texts, padded to the longest.
    Texts(&'a [String]),
    /// An array of that type without elements.
    Nothing(i8),
}

/// Texts that one parameter can count.
const TEXTS: usize = 255;

/// Bytes of the values of one parameter: the distance to the next one is a word with sign in many readers.
const VALUE_BYTES: usize = 32_000;

/// Blocks that the section's head can count.
pub(super) const BLOCKS: usize = 255;

/// The section, in whole blocks, for frames that begin in the block behind it.
pub(super) fn section(header: &C3dHeader, frames: u32) -> io::Result<Vec<u8>> {
    // The number of the first block of the frames stands inside: its value does not change the length.
    let blocks = records(header, frames, 0)?.len().div_ceil(BLOCK);
    if blocks > BLOCKS {
        let what = format!("the names of {} points do not fit into a C3D file", header.markers.len());
        return Err(io::Error::new(io::ErrorKind::InvalidInput, what));
    }
    let mut section = records(header, frames, (2 + blocks) as u16)?;
    section.resize(blocks * BLOCK, 0);
    section[2] = blocks as u8;
    Ok(section)
}

fn records(header: &C3dHeader, frames: u32, data_block: u16) -> io::Result<Vec<u8>> {
    use Written::{LongWord, Nothing, Real, Text, Texts, Word};
    let rate = header.rate_hz as f32;
    let last = header.last_frame(frames)?;
    // The first two bytes mean nothing, then come the number of blocks and the processor: Intel.
    let mut out = vec![1, 0x50, 0, 84];
    group(&mut out, 1, "POINT", "points in space");
    let used = header.markers.len().try_into().unwrap_or(u16::MAX);
    let shown = frames.try_into().unwrap_or(u16::MAX);
    parameter(&mut out, 1, "USED", &Word(used));
    parameter(&mut out, 1, "SCALE", &Real(-1.0));
    parameter(&mut out, 1, "RATE", &Real(rate));
    parameter(&mut out, 1, "DATA_START", &Word(data_block));
    parameter(&mut out, 1, "FRAMES", &Word(shown));
    for (number, labels) in (1..).zip(pieces(&header.markers)) {
        let name = |name: &str| if number == 1 { name.into() } else { format!("{name}{number}") };
        parameter(&mut out, 1, &name("LABELS"), &Texts(labels));
        parameter(&mut out, 1, &name("DESCRIPTIONS"), &Texts(&vec![String::new(); labels.len()]));
    }
    parameter(&mut out, 1, "UNITS", &Text(header.units.symbol()));
    for (name, axis) in [("X_SCREEN", header.right), ("Y_SCREEN", header.up)] {
        axis.into_iter().for_each(|axis| parameter(&mut out, 1, name, &Text(axis.name())));
    }
    group(&mut out, 2, "ANALOG", "no analog channels");
    parameter(&mut out, 2, "USED", &Word(0));
    parameter(&mut out, 2, "GEN_SCALE", &Real(1.0));
    parameter(&mut out, 2, "RATE", &Real(rate));
    for (name, kind) in [("LABELS", -1), ("SCALE", 4), ("OFFSET", 2)] {
        parameter(&mut out, 2, name, &Nothing(kind));
    }
    group(&mut out, 3, "FORCE_PLATFORM", "no force plates");
    parameter(&mut out, 3, "USED", &Word(0));
    group(&mut out, 4, "TRIAL", "frames of the recording");
    parameter(&mut out, 4, "ACTUAL_START_FIELD", &LongWord(header.first_frame));
    parameter(&mut out, 4, "ACTUAL_END_FIELD", &LongWord(last));
    // A name without letters ends the section.
    out.extend([0; 2]);
    Ok(out)
}

/// Labels cut into pieces that one parameter holds each; an empty piece where there are none.
fn pieces(labels: &[String]) -> Vec<&[String]> {
    let mut pieces = Vec::new();
    let mut rest = labels;
    loop {
        let fits = |count: &usize| rest[..*count].iter().map(String::len).max().unwrap_or(0) * count <= VALUE_BYTES;
        let count = (0..=rest.len().min(TEXTS)).rev().find(fits).unwrap_or_default();
        let (piece, others) = rest.split_at(count);
        pieces.push(piece);
        rest = others;
        if rest.is_empty() {
            return pieces;
        }
    }
}

/// Begins a record; [`linked`] ends it.
fn named(out: &mut Vec<u8>, number: i8, name: &str) -> usize {
    out.extend([name.len() as u8, number as u8]);
    out.extend(name.as_bytes());
    let link_at = out.len();
    out.extend([0; 2]);
    link_at
}

/// Writes the description, and the distance from `link_at` to the next record.
fn linked(out: &mut Vec<u8>, link_at: usize, description: &str) {
    out.push(description.len() as u8);
    out.extend(description.as_bytes());
    let distance = (out.len() - link_at) as u16;
    out[link_at..link_at + 2].copy_from_slice(&distance.to_le_bytes());
}

fn group(out: &mut Vec<u8>, number: i8, name: &str, description: &str) {
    let link_at = named(out, -number, name);
    linked(out, link_at, description);
}

fn parameter(out: &mut Vec<u8>, group: i8, name: &str, value: &Written<'_>) {
    let link_at = named(out, group, name);
    // Type, number of dimensions, dimensions, values.
    match value {
        Written::Word(word) => {
            out.extend([2, 0]);
            out.extend(word.to_le_bytes());
        }
        Written::LongWord(number) => {
            out.extend([2, 1, 2]);
            out.extend(number.to_le_bytes());
        }
        Written::Real(real) => {
            out.extend([4, 0]);
            out.extend(real.to_le_bytes());
        }
        Written::Text(text) => {
            out.extend([-1_i8 as u8, 1, text.len() as u8]);
            out.extend(text.as_bytes());
        }
        Written::Texts(texts) => {
            let width = texts.iter().map(String::len).max().unwrap_or(0).max(1);
            out.extend([-1_i8 as u8, 2, width as u8, texts.len() as u8]);
            for text in *texts {
                out.extend(text.as_bytes());
                out.resize(out.len() + width - text.len(), b' ');
            }
        }
        Written::Nothing(kind) => out.extend([*kind as u8, 1, 0]),
    }
    linked(out, link_at, "");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_cut_where_a_parameter_ends() {
        let sizes = |labels: &[String]| pieces(labels).iter().map(|piece| piece.len()).collect::<Vec<_>>();
        let labels = |count: usize, length: usize| vec!["a".repeat(length); count];
        assert_eq!(sizes(&labels(0, 1)), [0]);
        assert_eq!(sizes(&labels(255, 4)), [255]);
        assert_eq!(sizes(&labels(600, 4)), [255, 255, 90]);
        assert_eq!(sizes(&labels(300, 250)), [128, 128, 44]);
    }
}
