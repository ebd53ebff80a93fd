//! Parameter section of a C3D file: records of groups and parameters, one pointing to the next.
//!
//! A record begins with the length of its name (negative where it is locked), the number of its group (negative where it
//! is the group itself), the name, and the distance from here to the next record. The last has the distance 0, or is
//! followed by a name without letters. The number of blocks in the section's head is often wrong and is not used.

use super::parameters::{C3dGroup, C3dParameter, C3dValues, text};
use super::source::Source;
use crate::Error;
use crate::source_text::shortened;
use std::collections::BTreeMap;

const INSIDE: &str = "the parameter section";

/// The groups in the order of the file.
pub(super) fn read(source: &Source<'_>, section_at: usize) -> Result<Vec<C3dGroup>, Error> {
    let mut groups: Vec<(i8, C3dGroup)> = Vec::new();
    let mut parameters: Vec<(i8, C3dParameter)> = Vec::new();
    let mut at = section_at + 4;
    // A section that fills its last block has no end mark.
    while let [length, number, ..] = *source.bytes.get(at..).unwrap_or_default()
        && length != 0
    {
        let length = usize::from((length as i8).unsigned_abs());
        let name = text(source.slice(at + 2, length, INSIDE)?);
        let distance_at = at + 2 + length;
        let distance = usize::from(source.word(distance_at, INSIDE)?);
        let content_at = distance_at + 2;
        let end = match number as i8 {
            0 => return Err(source.bad("the group of a parameter", 0, "another number")),
            group @ ..0 => {
                let (description, end) = described(source, content_at)?;
                groups.push((group, C3dGroup { name: name.clone(), description, parameters: Vec::new() }));
                end
            }
            group => {
                let (parameter, end) = parameter(source, content_at, name.clone())?;
                parameters.push((-group, parameter));
                end
            }
        };
        if distance == 0 {
            break;
        }
        at = distance_at + distance;
        if at < end {
            return Err(source.place(distance_at).syntax(
                format!("behind {} comes byte {}", shortened(&name), at + 1),
                format!("byte {} or a later one, behind its values", end + 1),
            ));
        }
    }
    Ok(assembled(groups, parameters))
}

/// Puts parameters into their groups, which may come behind them or not at all; of two groups of one number, the first.
fn assembled(groups: Vec<(i8, C3dGroup)>, parameters: Vec<(i8, C3dParameter)>) -> Vec<C3dGroup> {
    let mut place_of = BTreeMap::new();
    let mut assembled = Vec::with_capacity(groups.len());
    for (number, group) in groups {
        place_of.entry(number).or_insert(assembled.len());
        assembled.push(group);
    }
    for (number, parameter) in parameters {
        let place = *place_of.entry(number).or_insert(assembled.len());
        if place == assembled.len() {
            assembled.push(C3dGroup::default());
        }
        assembled[place].parameters.push(parameter);
    }
    assembled
}

/// A description and the first byte behind it.
fn described(source: &Source<'_>, at: usize) -> Result<(String, usize), Error> {
    let length = usize::from(source.byte(at, INSIDE)?);
    Ok((text(source.slice(at + 1, length, INSIDE)?), at + 1 + length))
}

/// A parameter and the first byte behind it.
fn parameter(source: &Source<'_>, at: usize, name: String) -> Result<(C3dParameter, usize), Error> {
    let kind = source.byte(at, INSIDE)? as i8;
    let rank = usize::from(source.byte(at + 1, INSIDE)?);
    let dimensions = source.slice(at + 2, rank, INSIDE)?.to_vec();
    let is_empty = dimensions.contains(&0);
    let product = dimensions.iter().try_fold(1_usize, |product, &extent| product.checked_mul(extent.into()));
    let elements = if is_empty { Some(0) } else { product };
    let width = usize::from(kind.unsigned_abs());
    if !matches!(kind, -1 | 1 | 2 | 4) {
        return Err(source.place(at).bad_value(
            format!("the type of {}", shortened(&name)),
            kind.to_string(),
            "-1, 1, 2 or 4",
        ));
    }
    // No file holds more than a number of bytes can count.
    let size = elements.and_then(|elements| elements.checked_mul(width)).unwrap_or(usize::MAX);
    let data_at = at + 2 + rank;
    let data = source.slice(data_at, size, INSIDE)?;
    let values = match kind {
        -1 => {
            let length = dimensions.first().map_or(1, |&length| usize::from(length)).max(1);
            C3dValues::Texts(data.chunks_exact(length).map(text).collect())
        }
        1 => C3dValues::Bytes(data.to_vec()),
        2 => C3dValues::Integers(
            data.as_chunks::<2>().0.iter().map(|&word| source.processor.word(word) as i16).collect(),
        ),
        _ => C3dValues::Reals(data.as_chunks::<4>().0.iter().map(|&real| source.processor.real(real)).collect()),
    };
    let (description, end) = described(source, data_at + size)?;
    Ok((C3dParameter { name, description, dimensions, values }, end))
}
