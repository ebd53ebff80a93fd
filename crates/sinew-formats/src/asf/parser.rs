//! Parser of ASF files: sections `:units`, `:root`, `:bonedata`, `:hierarchy`; others are skipped.

use super::skeleton::{Asf, AsfBone, RootChannel, fixed_axes};
use crate::limits::{MAX_JOINTS, check_count};
use crate::nearest::nearest;
use crate::rotation::IDENTITY;
use crate::source_text::{finite, numbered_lines, shortened};
use crate::{Error, Place};
use std::collections::{BTreeMap, BTreeSet};

/// Reads a skeleton.
///
/// # Errors
/// Sections or fields that are missing, numbers that are none, degrees of freedom other than rotations, bones that are
/// defined or attached twice or not at all.
pub fn read(name: &str, text: &str) -> Result<Asf, Error> {
    let mut parser = Parser { name, ..Parser::default() };
    let mut section = String::new();
    for (number, line) in numbered_lines(text) {
        let line = line.split('#').next().unwrap_or_default().trim();
        let mut words: Vec<&str> = line.split_whitespace().collect();
        if let Some(title) = words.first().and_then(|word| word.strip_prefix(':')) {
            section = title.to_ascii_lowercase();
            continue;
        }
        if words.is_empty() {
            continue;
        }
        let key = words.remove(0).to_ascii_lowercase();
        parser.line = number;
        match section.as_str() {
            "units" => parser.units(&key, &words)?,
            "root" => parser.root(&key, &words)?,
            "bonedata" => parser.bone(&key, &words)?,
            "hierarchy" => parser.hierarchy(key, line, &words)?,
            _ => {}
        }
    }
    parser.finish()
}

#[derive(Default)]
struct Parser<'a> {
    name: &'a str,
    line: usize,
    length_unit: Option<f64>,
    radians: bool,
    root_channels: Option<Vec<RootChannel>>,
    root_order: Option<[usize; 3]>,
    root_position: [f64; 3],
    root_orientation: [f64; 3],
    open: Option<RawBone>,
    bones: BTreeMap<String, RawBone>,
    children: BTreeMap<String, Vec<String>>,
    attached: BTreeMap<String, usize>,
}

#[derive(Clone, Default)]
struct RawBone {
    line: usize,
    name: Option<String>,
    direction: Option<[f64; 3]>,
    length: Option<f64>,
    axis: Option<([f64; 3], [usize; 3])>,
    dof: Vec<usize>,
}

impl Parser<'_> {
    fn place(&self) -> Place {
        Place::file(self.name).at_line(self.line)
    }

    fn bad(&self, field: &str, found: &[&str], expected: &str) -> Error {
        self.place().bad_value(field, shortened(&found.join(" ")), expected)
    }

    fn missing(&self, line: usize, field: &str) -> Error {
        let place = Place::file(self.name);
        if line > 0 { place.at_line(line) } else { place }.lacks(field)
    }

    fn number(&self, field: &str, words: &[&str]) -> Result<f64, Error> {
        let word = words.first().ok_or_else(|| self.bad(field, words, "a number"))?;
        finite(|| self.place(), word)
    }

    fn vector(&self, field: &str, words: &[&str]) -> Result<[f64; 3], Error> {
        let &[x, y, z, ..] = words else { return Err(self.bad(field, words, "three numbers")) };
        Ok([self.number(field, &[x])?, self.number(field, &[y])?, self.number(field, &[z])?])
    }

    fn axis_order(&self, field: &str, words: &[&str]) -> Result<[usize; 3], Error> {
        let order: Option<Vec<usize>> =
            words.first().and_then(|word| word.chars().map(|c| "XYZ".find(c.to_ascii_uppercase())).collect());
        match order.as_deref() {
            Some(&[a, b, c]) if a != b && b != c && a != c => Ok([a, b, c]),
            _ => Err(self.bad(field, words, "an order of the axes like XYZ")),
        }
    }

    fn units(&mut self, key: &str, words: &[&str]) -> Result<(), Error> {
        match key {
            "length" => {
                let unit = self.number("length", words)?;
                if unit <= 0.0 {
                    return Err(self.bad("length", words, "positive"));
                }
                self.length_unit = Some(unit);
            }
            "angle" => match words.first().map(|word| word.to_ascii_lowercase()).as_deref() {
                Some("deg") => self.radians = false,
                Some("rad") => self.radians = true,
                _ => return Err(self.bad("angle", words, "deg or rad")),
            },
            _ => {}
        }
        Ok(())
    }

    fn root(&mut self, key: &str, words: &[&str]) -> Result<(), Error> {
        match key {
            "order" => {
                let channel = |word: &&str| {
                    let axis = ["x", "y", "z"].iter().position(|axis| word.to_ascii_lowercase().ends_with(axis))?;
                    match word.to_ascii_lowercase().as_bytes() {
                        [b't', _] => Some(RootChannel::Translation(axis)),
                        [b'r', _] => Some(RootChannel::Rotation(axis)),
                        _ => None,
                    }
                };
                let channels: Option<Vec<RootChannel>> = words.iter().map(channel).collect();
                let distinct = |channels: &Vec<RootChannel>| {
                    channels
                        .iter()
                        .enumerate()
                        .all(|(i, channel)| !channels.iter().take(i).any(|other| other == channel))
                };
                let channels = channels.filter(distinct);
                self.root_channels =
                    Some(channels.ok_or_else(|| self.bad("order", words, "TX TY TZ RX RY RZ in any order"))?);
            }
            "axis" => self.root_order = Some(self.axis_order("axis", words)?),
            "position" => self.root_position = self.vector("position", words)?,
            "orientation" => self.root_orientation = self.vector("orientation", words)?,
            _ => {}
        }
        Ok(())
    }

    fn bone(&mut self, key: &str, words: &[&str]) -> Result<(), Error> {
        match key {
            "begin" => {
                self.open = Some(RawBone { line: self.line, ..RawBone::default() });
                return Ok(());
            }
            "end" => return self.close_bone(),
            _ => {}
        }
        let Some(mut bone) = self.open.take() else { return Err(self.bad("begin", &[key], "the start of a bone")) };
        match key {
            "name" => bone.name = words.first().map(|&word| word.to_owned()),
            "direction" => bone.direction = Some(self.vector("direction", words)?),
            "length" => bone.length = Some(self.number("length", words)?),
            "axis" => {
                let order = self.axis_order("axis", words.get(3..).unwrap_or_default())?;
                bone.axis = Some((self.vector("axis", words)?, order));
            }
            "dof" => {
                for word in words {
                    let axis = ["rx", "ry", "rz"].iter().position(|known| word.eq_ignore_ascii_case(known));
                    let what = || format!("degree of freedom `{}`", shortened(word));
                    let axis = axis.ok_or_else(|| Error::Unsupported { place: self.place(), what: what() })?;
                    if bone.dof.contains(&axis) {
                        return Err(self.bad("dof", words, "each axis once"));
                    }
                    bone.dof.push(axis);
                }
            }
            _ => {}
        }
        self.open = Some(bone);
        Ok(())
    }

    fn close_bone(&mut self) -> Result<(), Error> {
        let Some(bone) = self.open.take() else { return Ok(()) };
        let name = bone.name.clone().ok_or_else(|| self.missing(bone.line, "name"))?;
        if name == "root" || self.bones.contains_key(&name) {
            return Err(self.place().twice("bone", name));
        }
        self.bones.insert(name, bone);
        check_count(|| self.place(), self.bones.len(), "bones", MAX_JOINTS)?;
        Ok(())
    }

    fn hierarchy(&mut self, key: String, line: &str, children: &[&str]) -> Result<(), Error> {
        if children.is_empty() && (key == "begin" || key == "end") {
            return Ok(());
        }
        // Names keep their case; only the keywords do not matter.
        let parent = line.split_whitespace().next().unwrap_or_default();
        for name in std::iter::once(&parent).chain(children) {
            if *name != "root" && !self.bones.contains_key(*name) {
                let nearest = nearest(name, self.bones.keys().map(String::as_str)).map(Into::into);
                return Err(Error::UnknownName { place: self.place(), what: "bone", name: shortened(name), nearest });
            }
        }
        for &child in children {
            if child == "root" || self.attached.insert(child.to_owned(), self.line).is_some() {
                return Err(self.place().twice("child", child));
            }
            self.children.entry(parent.to_owned()).or_default().push(child.to_owned());
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Asf, Error> {
        let degrees = !self.radians;
        let length_unit = self.length_unit.ok_or_else(|| self.missing(0, ":units length"))?;
        let root_channels = self.root_channels.take().ok_or_else(|| self.missing(0, ":root order"))?;
        let root_order = self.root_order.ok_or_else(|| self.missing(0, ":root axis"))?;
        let matrix =
            |angles: [f64; 3], order| fixed_axes(order, if degrees { angles.map(f64::to_radians) } else { angles });
        let mut bones: Vec<AsfBone> = Vec::with_capacity(self.bones.len());
        let mut pending: Vec<(Option<usize>, String)> = Vec::new();
        let push_children = |pending: &mut Vec<(Option<usize>, String)>, index: Option<usize>, name: &str| {
            let children = self.children.get(name).into_iter().flatten();
            pending.extend(children.rev().map(|child| (index, child.clone())));
        };
        push_children(&mut pending, None, "root");
        while let Some((parent, name)) = pending.pop() {
            let Some(raw) = self.bones.get(&name) else { continue };
            let field = |field: &str| self.missing(raw.line, field);
            let (angles, order) = raw.axis.ok_or_else(|| field("axis"))?;
            push_children(&mut pending, Some(bones.len()), &name);
            bones.push(AsfBone {
                name,
                parent,
                direction: raw.direction.ok_or_else(|| field("direction"))?,
                length: raw.length.ok_or_else(|| field("length"))?,
                axis: matrix(angles, order),
                dof: raw.dof.clone(),
                order,
            });
        }
        let reached: BTreeSet<&str> = bones.iter().map(|bone| bone.name.as_str()).collect();
        if let Some((name, raw)) = self.bones.iter().find(|(name, _)| !reached.contains(name.as_str())) {
            let place = Place::file(self.name).at_line(raw.line).within(name.as_str());
            return Err(place.lacks("a path to the root in :hierarchy"));
        }
        let root_axis =
            if self.root_orientation == [0.0; 3] { IDENTITY } else { matrix(self.root_orientation, root_order) };
        let root_position = self.root_position;
        Ok(Asf { length_unit, degrees, root_channels, root_order, root_position, root_axis, bones })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "# comment\n:version 1.10\n:units\n  mass 1.0\n  length 0.45\n  angle deg\n:documentation\n  begin anything\n\
        :root\n order TX TY TZ RX RY RZ\n axis XYZ\n position 0 0 0\n orientation 0 0 0\n\
        :bonedata\n begin\n id 1\n name shin\n direction 0 -1 0\n length 2\n axis 0 0 0 XYZ\n dof rx\n limits (-10 170)\n end\n\
        begin\n name thigh\n direction 0 -1 0\n length 1\n axis 0 0 90 XYZ\n dof rx rz\n limits (-1 1)\n (-1 1)\n end\n\
        :hierarchy\n begin\n root thigh\n thigh shin\n end\n";

    #[test]
    fn skeletons_have_a_bound() {
        let bone = |k: usize| format!("begin\nname b{k}\nend\n");
        let bones: String = (0..2001).map(bone).collect();
        let text = format!(":units\nlength 1\n:root\norder TX\naxis XYZ\n:bonedata\n{bones}");
        check_error(&text, "a.asf:6009: more than 2000 bones, the most that are read");
    }

    fn check_error(text: &str, message: &str) {
        assert_eq!(read("a.asf", text).unwrap_err().to_string(), message);
    }

    #[test]
    fn parents_come_first_and_axes_turn_the_motion() {
        let asf = read("a.asf", FILE).unwrap();
        assert_eq!(asf.point_names(), ["root", "thigh", "shin"]);
        assert_eq!(asf.channels(), 9);
        // The axis frame of the thigh is turned by 90 degrees about z: its x is the global y, along the bone.
        let ends = asf.bone_ends_m(&[0.0, 3.0, 0.0, 0.0, 0.0, 0.0, 90.0, 0.0, 90.0]);
        let units = |point: [f64; 3]| point.map(|v| (v / asf.metres_per_unit() * 1e9).round() / 1e9);
        assert_eq!(units(ends[1]), [0.0, 2.0, 0.0]);
        assert_eq!(units(ends[2]), [-2.0, 2.0, 0.0]);
    }

    #[test]
    fn faults_are_named() {
        check_error("", "a.asf: `:units length` is missing");
        check_error(&FILE.replace("dof rx\n", "dof rx l\n"), "a.asf:21: degree of freedom `l` is not supported");
        check_error(&FILE.replace("thigh shin", "thigh shn"), "a.asf:36: unknown bone `shn`; did you mean `shin`?");
        check_error(
            &FILE.replace(" thigh shin\n", ""),
            "a.asf:15 (shin): `a path to the root in :hierarchy` is missing",
        );
        check_error(
            &FILE.replace("thigh shin", "shin shin"),
            "a.asf:15 (shin): `a path to the root in :hierarchy` is missing",
        );
        check_error(&FILE.replace("length 2", "length two"), "a.asf:19: `two`; expected a number");
        check_error(&FILE.replace(" direction 0 -1 0\n length 2\n", ""), "a.asf:15: `direction` is missing");
    }
}
