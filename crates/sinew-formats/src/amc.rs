//! AMC: the motion of an Acclaim recording, for a skeleton read by [`asf`](crate::asf).
//!
//! ```text
//! :FULLY-SPECIFIED
//! :DEGREES
//! 1
//! root 8.87208 15.7511 -31.7081 5.5217 4.9122 3.70117
//! rtibia 30.0014
//! …
//! ```
//!
//! A frame starts with its number (from 1); a bone's line has only its degrees of freedom, in the skeleton's order. Bones
//! come in any order, and all that have degrees of freedom must be there.
//!
//! ```
//! # let skeleton = ":units\n length 0.45\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n:bonedata\n begin\n name thigh\n\
//! # direction 0 -1 0\n length 7\n axis 0 0 20 XYZ\n dof rx\n end\n:hierarchy\n begin\n root thigh\n end\n";
//! let skeleton = sinew_formats::asf::read("07.asf", skeleton)?;
//! let motion = sinew_formats::amc::read("07_01.amc", ":DEGREES\n1\nroot 0 16 0 0 0 0\nthigh 30\n", &skeleton)?;
//! let ends = skeleton.bone_ends_m(&motion.frames[0].values);
//! assert!((ends[0][1] - 16.0 * 0.0254 / 0.45).abs() < 1e-12);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::asf::Asf;
use crate::nearest::nearest;
use crate::source_text::{finite, numbered_lines, shortened};
use crate::{Error, Place, Warning};
use std::collections::BTreeMap;

/// A frame.
#[derive(Clone, Debug, PartialEq)]
pub struct AmcFrame {
    /// Number, counted from 1.
    pub number: u64,
    /// The root's channels, then each bone's in the skeleton's order.
    pub values: Vec<f64>,
}

/// A motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Amc {
    /// Frames by rising number.
    pub frames: Vec<AmcFrame>,
    /// What was odd.
    pub warnings: Vec<Warning>,
}

/// Reads a motion.
///
/// # Errors
/// Angles in another unit than the skeleton's, frame numbers that do not rise, bones that the skeleton lacks, that are
/// missing or that come twice, and lines with more or fewer numbers than degrees of freedom.
pub fn read(name: &str, text: &str, skeleton: &Asf) -> Result<Amc, Error> {
    let slots = slots(skeleton);
    let mut frames: Vec<AmcFrame> = Vec::new();
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    let mut last_line = 0;
    for (number, line) in numbered_lines(text) {
        last_line = number;
        let place = || Place::file(name).at_line(number);
        let line = line.split('#').next().unwrap_or_default().trim();
        if let Some(header) = line.strip_prefix(':') {
            let in_degrees = header.eq_ignore_ascii_case("degrees");
            if (in_degrees || header.eq_ignore_ascii_case("radians")) && in_degrees != skeleton.degrees {
                return Err(place().bad_value("angle unit", shortened(header), "that of the skeleton"));
            }
            continue;
        }
        let mut words = line.split_whitespace();
        let Some(first) = words.next() else { continue };
        if let Ok(frame) = first.parse::<u64>() {
            check_complete(&slots, &seen, frames.last(), place)?;
            if frames.last().is_some_and(|last| last.number >= frame) {
                return Err(place().bad_value("frame", frame.to_string(), "above that before"));
            }
            seen.clear();
            frames.push(AmcFrame { number: frame, values: vec![0.0; skeleton.channels()] });
            continue;
        }
        let Some(frame) = frames.last_mut() else {
            return Err(place().syntax(format!("`{}`", shortened(first)), "a frame number"));
        };
        let Some((&bone, &(start, count))) = slots.get_key_value(first) else {
            let nearest = nearest(first, slots.keys().copied()).map(Into::into);
            return Err(Error::UnknownName { place: place(), what: "bone", name: shortened(first), nearest });
        };
        if seen.insert(bone, number).is_some() {
            return Err(place().twice("bone", bone));
        }
        let values = words.map(|word| finite(place, word)).collect::<Result<Vec<f64>, Error>>()?;
        if values.len() != count {
            return Err(Error::RowLength { place: place().within(bone), found: values.len(), expected: count });
        }
        frame.values.iter_mut().skip(start).zip(values).for_each(|(slot, value)| *slot = value);
    }
    check_complete(&slots, &seen, frames.last(), || Place::file(name).at_line(last_line))?;
    Ok(Amc { frames, warnings: Vec::new() })
}

/// Numbers of the frames, which a text gives without its skeleton.
#[must_use]
pub fn frame_numbers(text: &str) -> Vec<u64> {
    let first = |line: &str| line.split('#').next()?.split_whitespace().next()?.parse().ok();
    numbered_lines(text).filter_map(|(_, line)| first(line)).collect()
}

/// First value and number of values of the root and of every bone.
fn slots(skeleton: &Asf) -> BTreeMap<&str, (usize, usize)> {
    let mut next = skeleton.root_channels.len();
    let mut slots = BTreeMap::from([("root", (0, next))]);
    for bone in &skeleton.bones {
        slots.insert(bone.name.as_str(), (next, bone.dof.len()));
        next += bone.dof.len();
    }
    slots
}

fn check_complete(
    slots: &BTreeMap<&str, (usize, usize)>,
    seen: &BTreeMap<&str, usize>,
    frame: Option<&AmcFrame>,
    place: impl Fn() -> Place,
) -> Result<(), Error> {
    let Some(frame) = frame else { return Ok(()) };
    match slots.iter().find(|(bone, (_, count))| *count > 0 && !seen.contains_key(*bone)) {
        Some((bone, _)) => {
            let place = place().within(format!("frame {}", frame.number));
            Err(place.lacks(*bone))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::asf;

    const SKELETON: &str = ":units\n length 0.45\n angle deg\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n:bonedata\n\
        begin\n name a\n direction 0 1 0\n length 1\n axis 0 0 0 XYZ\n dof rx rz\n end\n\
        begin\n name b\n direction 0 1 0\n length 1\n axis 0 0 0 XYZ\n end\n:hierarchy\n begin\n root a\n a b\n end\n";

    const MOTION: &str =
        "#!OML\n:FULLY-SPECIFIED\n:DEGREES\n1\na 7 8\nroot 1 2 3 4 5 6\n3\nroot 0 0 0 0 0 0\na 1 -9.5e-015\n";

    fn check_error(text: &str, message: &str) {
        let skeleton = asf::read("a.asf", SKELETON).unwrap();
        assert_eq!(read("a.amc", text, &skeleton).unwrap_err().to_string(), message);
    }

    #[test]
    fn values_come_in_the_order_of_the_skeleton() {
        let skeleton = asf::read("a.asf", SKELETON).unwrap();
        let motion = read("a.amc", MOTION, &skeleton).unwrap();
        assert_eq!(motion.frames[0].values, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
        assert_eq!((motion.frames[1].number, motion.frames[1].values[7]), (3, -9.5e-15));
        assert_eq!(frame_numbers(MOTION), [1, 3]);
    }

    #[test]
    fn faults_are_named() {
        check_error(&MOTION.replace("a 7 8\n", ""), "a.amc:6 (frame 1): `a` is missing");
        check_error(&MOTION.replace("a 7 8", "a 7"), "a.amc:5 (a): 1 values; expected 2");
        check_error(&MOTION.replace("a 7 8", "a 7 x"), "a.amc:5: `x`; expected a number");
        check_error(&MOTION.replace("\n3\n", "\n1\n"), "a.amc:7: frame = 1; must be above that before");
        check_error(
            &MOTION.replace("DEGREES", "RADIANS"),
            "a.amc:3: angle unit = RADIANS; must be that of the skeleton",
        );
        check_error(&MOTION.replace("root 0", "roto 0"), "a.amc:8: unknown bone `roto`; did you mean `root`?");
        check_error("root 1 2 3", "a.amc:1: `root`; expected a frame number");
    }
}
