//! glTF 2.0: a moving skeleton in one binary file (`.glb`; Khronos, ISO/IEC 12113:2022), written.
//!
//! A skeleton of BVH becomes
//!
//! - a node for each joint, below a node `skeleton`;
//! - an animation `motion` that turns every joint and moves those with position channels, linear between frames;
//! - a mesh `bones` of the bones in their rest pose, bound to the joints by a skin, so that viewers have something to
//!   draw and programs for animation find bones to retarget.
//!
//! glTF has metres, seconds, Y up and right-handed axes, as our BVH files have; a file in another unit must be scaled
//! first. A figure in glTF faces +Z at rest, which is for the skeleton to do. Numbers have single precision.

mod bones;
mod document;

use document::{Document, invalid};
use sinew_formats::bvh::Bvh;
use std::io::{self, Write};

/// Writes a whole file.
///
/// # Errors
/// What the stream reports; `InvalidInput` where the skeleton has no joint or more than 65 535, a joint stands before its
/// parent, a number is not finite in single precision, or the file would exceed 4 GiB, the most that the format counts.
pub fn write(out: &mut impl Write, skeleton: &Bvh) -> io::Result<()> {
    let joints = &skeleton.joints;
    if joints.is_empty() || joints.len() > usize::from(u16::MAX) {
        return Err(invalid("a skeleton has at least one joint and at most 65535"));
    }
    if joints.iter().enumerate().any(|(index, joint)| joint.parent.is_some_and(|parent| parent >= index)) {
        return Err(invalid("joints must follow their parents"));
    }
    check_numbers(skeleton)?;
    let Document { root, mut bytes } = document::document(skeleton)?;
    let mut json = root.to_vec()?;
    // Chunks end at multiples of four bytes: text with spaces, numbers with zeros.
    json.resize(json.len().next_multiple_of(4), b' ');
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let size = |length: usize| u32::try_from(length).map_err(|_| invalid("a file of more than 4 GiB"));
    out.write_all(b"glTF")?;
    for number in [2, size(12 + 8 + json.len() + 8 + bytes.len())?] {
        out.write_all(&number.to_le_bytes())?;
    }
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &bytes)] {
        out.write_all(&size(chunk.len())?.to_le_bytes())?;
        out.write_all(kind)?;
        out.write_all(chunk)?;
    }
    Ok(())
}

/// Refuses numbers that the format cannot hold, by their places.
fn check_numbers(skeleton: &Bvh) -> io::Result<()> {
    let check = |place: &dyn Fn() -> String, values: &[f64]| match values.iter().find(|x| !(**x as f32).is_finite()) {
        Some(value) => Err(invalid(&format!("{} has {value:e}, which single precision does not reach", place()))),
        None => Ok(()),
    };
    for joint in &skeleton.joints {
        check(&|| format!("the offset of `{}`", joint.name), &joint.offset)?;
        check(&|| format!("the end of `{}`", joint.name), &joint.end_site.unwrap_or_default())?;
    }
    for (number, row) in (1..).zip(&skeleton.frames) {
        let mut column = 0;
        for joint in &skeleton.joints {
            let columns = column..column + joint.channels.len();
            column = columns.end;
            check(&|| format!("frame {number} of `{}`", joint.name), row.get(columns).unwrap_or_default())?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests;
