//! Writer of BVH files, frame by frame.

use super::hierarchy::{Bvh, BvhJoint, CHANNEL_NAMES, Channel};
use crate::numbers::write_number;
use std::io::{self, Write};

/// Writes hierarchy and header. The length does not depend on `frames`: write it with 0 first, and again at the start of
/// the file once the number is known.
///
/// # Errors
/// What the stream reports; `InvalidInput` for joints that do not follow their parents in depth-first order, names that
/// cannot be read back, and a frame time that is not positive.
pub fn write_header(out: &mut impl Write, joints: &[BvhJoint], frame_time_s: f64, frames: u32) -> io::Result<()> {
    if !(frame_time_s > 0.0 && frame_time_s.is_finite()) {
        return Err(invalid("the frame time must be positive"));
    }
    writeln!(out, "HIERARCHY")?;
    let mut open: Vec<usize> = Vec::new();
    for (index, joint) in joints.iter().enumerate() {
        check_name(&joint.name)?;
        while open.last().is_some_and(|&last| Some(last) != joint.parent) {
            open.pop();
            writeln!(out, "{}}}", indent(open.len()))?;
        }
        if joint.parent.is_some() && open.is_empty() {
            return Err(invalid("joints must follow their parents depth first"));
        }
        let depth = open.len();
        let keyword = if joint.parent.is_some() { "JOINT" } else { "ROOT" };
        write!(out, "{0}{keyword} {1}\n{0}{{\n", indent(depth), joint.name)?;
        let inside = indent(depth + 1);
        write_offset(out, &inside, joint.offset)?;
        write!(out, "{inside}CHANNELS {}", joint.channels.len())?;
        for channel in &joint.channels {
            write!(out, " {}", channel_name(*channel))?;
        }
        writeln!(out)?;
        if let Some(end) = joint.end_site {
            write!(out, "{inside}End Site\n{inside}{{\n")?;
            write_offset(out, &indent(depth + 2), end)?;
            writeln!(out, "{inside}}}")?;
        }
        open.push(index);
    }
    while open.pop().is_some() {
        writeln!(out, "{}}}", indent(open.len()))?;
    }
    write!(out, "MOTION\nFrames: {frames:10}\nFrame Time: {frame_time_s:.7}\n")
}

/// Writes a row of the motion table.
///
/// # Errors
/// What the stream reports; `InvalidInput` for a number that is not finite, which this format cannot express.
pub fn write_frame(out: &mut impl Write, values: &[f64]) -> io::Result<()> {
    for (i, &value) in values.iter().enumerate() {
        if value.is_nan() {
            return Err(invalid("BVH has no missing values"));
        }
        if i > 0 {
            write!(out, " ")?;
        }
        write_number(out, value)?;
    }
    writeln!(out)
}

/// Writes a whole file.
///
/// # Errors
/// As [`write_header`] and [`write_frame`].
pub fn write(out: &mut impl Write, bvh: &Bvh) -> io::Result<()> {
    let frames = u32::try_from(bvh.frames.len()).map_err(|_| invalid("more frames than a header can count"))?;
    write_header(out, &bvh.joints, bvh.frame_time_s, frames)?;
    bvh.frames.iter().try_for_each(|frame| write_frame(out, frame))
}

fn write_offset(out: &mut impl Write, inside: &str, offset: [f64; 3]) -> io::Result<()> {
    write!(out, "{inside}OFFSET ")?;
    write_frame(out, &offset)
}

fn channel_name(channel: Channel) -> &'static str {
    CHANNEL_NAMES.iter().find(|(_, known)| *known == channel).map_or("Xposition", |(name, _)| name)
}

fn indent(depth: usize) -> String {
    "  ".repeat(depth)
}

fn check_name(name: &str) -> io::Result<()> {
    let words: Vec<&str> = name.split_whitespace().collect();
    if words.is_empty() || words.join(" ") != name || name.contains(['{', '}']) {
        return Err(invalid(&format!("`{}` cannot be a name in a BVH file", name.escape_debug())));
    }
    Ok(())
}

fn invalid(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, what)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bvh::read;

    fn joint(name: &str, parent: Option<usize>, end_site: Option<[f64; 3]>) -> BvhJoint {
        let rotations = [2, 1, 0].map(Channel::Rotation);
        BvhJoint { name: name.into(), parent, offset: [0.0, -0.5, 1e-7], channels: rotations.into(), end_site }
    }

    fn tree() -> Vec<BvhJoint> {
        let tip = Some([0.0, 0.0, 1.0]);
        vec![joint("hip", None, None), joint("a", Some(0), None), joint("b", Some(1), tip), joint("c", Some(0), tip)]
    }

    #[test]
    fn branches_are_closed_and_read_back() {
        let frames = vec![(0..12).map(f64::from).collect()];
        let bvh = Bvh { joints: tree(), frame_time_s: 0.04, frames, warnings: Vec::new() };
        let mut out = Vec::new();
        write(&mut out, &bvh).unwrap();
        assert_eq!(read("a.bvh", std::str::from_utf8(&out).unwrap()).unwrap(), bvh);
    }

    #[test]
    fn the_header_can_be_written_over_itself() {
        let length = |frames| {
            let mut out = Vec::new();
            write_header(&mut out, &tree(), 0.04, frames).unwrap();
            out.len()
        };
        assert_eq!(length(0), length(u32::MAX));
    }

    #[test]
    fn what_cannot_be_read_back_is_refused() {
        let mut joints = tree();
        joints.swap(2, 3);
        assert!(write_header(&mut Vec::new(), &joints, 0.04, 0).is_err());
        assert!(write_header(&mut Vec::new(), &tree(), 0.0, 0).is_err());
        assert!(write_frame(&mut Vec::new(), &[f64::NAN]).is_err());
    }
}
