//! Reader of BVH files: a stream of words for the hierarchy, one line per frame for the motion.

use super::hierarchy::{Bvh, BvhJoint, CHANNEL_NAMES, Channel};
use crate::limits::{MAX_JOINTS, check_count};
use crate::nearest::nearest;
use crate::source_text::{check_claim, finite, numbered_lines, shortened};
use crate::{Error, Place, Warning};
use std::collections::BTreeSet;

/// Reads a file.
///
/// # Errors
/// A hierarchy that is none or has more than [`MAX_JOINTS`] joints, channels that are unknown, rows of another length, cells that are no numbers, a frame count
/// that the file cannot hold.
pub fn read(name: &str, text: &str) -> Result<Bvh, Error> {
    let mut lines = numbered_lines(text);
    let mut words = Words { name, pending: Vec::new(), line: 0, joint_names: BTreeSet::new() };
    let joints = hierarchy(&mut words, &mut lines)?;
    let channels: usize = joints.iter().map(|joint| joint.channels.len()).sum();

    let mut warnings = Vec::new();
    let mut lines = lines.filter(|(_, line)| !line.trim().is_empty());
    let mut header = |key: &str, what: &'static str| match lines.next() {
        Some((number, line)) => {
            let value = after_key(line, key).map(|value| (number, value.to_owned()));
            value.ok_or_else(|| words.syntax_at(number, line, what))
        }
        None => Err(words.end(what)),
    };
    let (line, frames) = header("Frames", "a line `Frames: <count>`")?;
    let stated = finite(|| Place::file(name).at_line(line), &frames)?;
    if stated < 0.0 || stated.fract() != 0.0 {
        return Err(words.bad_value(line, "Frames", &frames, "a count"));
    }
    check_claim(name, stated as u64, "frames", text)?;
    let (line, time) = header("FrameTime", "a line `Frame Time: <seconds>`")?;
    let frame_time_s = finite(|| Place::file(name).at_line(line), &time)?;
    if frame_time_s <= 0.0 {
        return Err(words.bad_value(line, "Frame Time", &time, "positive"));
    }

    let mut frames = Vec::new();
    for (number, line) in lines {
        let at = || Place::file(name).at_line(number);
        let row = line.split_whitespace().map(|cell| finite(at, cell)).collect::<Result<Vec<f64>, Error>>()?;
        if row.len() != channels {
            return Err(Error::RowLength { place: at(), found: row.len(), expected: channels });
        }
        frames.push(row);
    }
    if stated as u64 != frames.len() as u64 {
        let (stated, found) = (stated as u64, frames.len() as u64);
        warnings.push(Warning::CountDisagrees { place: Place::file(name), field: "Frames", stated, found });
    }
    Ok(Bvh { joints, frame_time_s, frames, warnings })
}

/// What follows `key:`, blanks inside the key and before the colon and letter case ignored.
fn after_key<'a>(line: &'a str, key: &str) -> Option<&'a str> {
    let (found, value) = line.split_once(':')?;
    let found: String = found.split_whitespace().collect();
    found.eq_ignore_ascii_case(key).then(|| value.trim())
}

struct Words<'a> {
    name: &'a str,
    pending: Vec<&'a str>,
    line: usize,
    joint_names: BTreeSet<String>,
}

impl<'a> Words<'a> {
    fn next(&mut self, lines: &mut impl Iterator<Item = (usize, &'a str)>, expected: &str) -> Result<&'a str, Error> {
        loop {
            if let Some(word) = self.pending.pop() {
                return Ok(word);
            }
            let Some((number, line)) = lines.next() else { return Err(self.end(expected)) };
            self.line = number;
            self.pending = line.split_whitespace().rev().collect();
        }
    }

    fn number(&mut self, lines: &mut impl Iterator<Item = (usize, &'a str)>, what: &str) -> Result<f64, Error> {
        let word = self.next(lines, what)?;
        finite(|| self.place(), word)
    }

    fn place(&self) -> Place {
        Place::file(self.name).at_line(self.line)
    }

    fn syntax(&self, found: &str, expected: &str) -> Error {
        self.syntax_at(self.line, found, expected)
    }

    fn syntax_at(&self, line: usize, found: &str, expected: &str) -> Error {
        Place::file(self.name).at_line(line).syntax(format!("`{}`", shortened(found)), expected)
    }

    fn end(&self, expected: &str) -> Error {
        Place::file(self.name).syntax("the file ends", expected)
    }

    fn bad_value(&self, line: usize, field: &str, found: &str, expected: &str) -> Error {
        Place::file(self.name).at_line(line).bad_value(field, shortened(found), expected)
    }
}

/// What a `{` opened.
#[derive(Clone, Copy)]
enum Open {
    Joint(usize),
    EndSite(usize),
}

fn hierarchy<'a>(
    words: &mut Words<'a>,
    lines: &mut impl Iterator<Item = (usize, &'a str)>,
) -> Result<Vec<BvhJoint>, Error> {
    let first = words.next(lines, "`HIERARCHY`")?;
    if !first.eq_ignore_ascii_case("HIERARCHY") {
        return Err(words.syntax(first, "`HIERARCHY`"));
    }
    let mut joints: Vec<BvhJoint> = Vec::new();
    let mut open: Vec<Open> = Vec::new();
    loop {
        let word = words.next(lines, if open.is_empty() { "`ROOT` or `MOTION`" } else { "`}`" })?;
        match (word.to_ascii_uppercase().as_str(), open.last().copied()) {
            ("ROOT", None) => open.push(new_joint(words, lines, &mut joints, None)?),
            ("JOINT", Some(Open::Joint(parent))) => open.push(new_joint(words, lines, &mut joints, Some(parent))?),
            ("END", Some(Open::Joint(parent))) => {
                let site = words.next(lines, "`Site`")?;
                if !site.eq_ignore_ascii_case("Site") {
                    return Err(words.syntax(site, "`Site`"));
                }
                open_brace(words, lines)?;
                open.push(Open::EndSite(parent));
            }
            ("OFFSET", Some(owner)) => {
                let mut offset = [0.0; 3];
                for value in &mut offset {
                    *value = words.number(lines, "three numbers")?;
                }
                match owner {
                    Open::Joint(index) => joints.iter_mut().skip(index).take(1).for_each(|joint| joint.offset = offset),
                    Open::EndSite(index) => {
                        joints.iter_mut().skip(index).take(1).for_each(|joint| joint.end_site = Some(offset));
                    }
                }
            }
            ("CHANNELS", Some(Open::Joint(index))) => {
                let channels = channels(words, lines)?;
                if let Some(joint) = joints.get_mut(index) {
                    joint.channels = channels;
                }
            }
            ("}", Some(_)) => {
                open.pop();
            }
            ("MOTION", None) if !joints.is_empty() => return Ok(joints),
            _ => {
                return Err(words
                    .syntax(word, "`ROOT`, `JOINT`, `End Site`, `OFFSET`, `CHANNELS`, `}` or `MOTION` in its place"));
            }
        }
    }
}

fn open_brace<'a>(words: &mut Words<'a>, lines: &mut impl Iterator<Item = (usize, &'a str)>) -> Result<(), Error> {
    let brace = words.next(lines, "`{`")?;
    if brace == "{" { Ok(()) } else { Err(words.syntax(brace, "`{`")) }
}

/// Reads the name (the rest of its line, which may hold blanks) and the brace.
fn new_joint<'a>(
    words: &mut Words<'a>,
    lines: &mut impl Iterator<Item = (usize, &'a str)>,
    joints: &mut Vec<BvhJoint>,
    parent: Option<usize>,
) -> Result<Open, Error> {
    let mut name = words.next(lines, "a name")?.to_owned();
    while let Some(word) = words.pending.pop_if(|word| *word != "{") {
        name.push(' ');
        name.push_str(word);
    }
    open_brace(words, lines)?;
    if !words.joint_names.insert(name.clone()) {
        return Err(words.place().twice("joint", name));
    }
    joints.push(BvhJoint { name, parent, offset: [0.0; 3], channels: Vec::new(), end_site: None });
    check_count(|| words.place(), joints.len(), "joints", MAX_JOINTS)?;
    Ok(Open::Joint(joints.len() - 1))
}

fn channels<'a>(
    words: &mut Words<'a>,
    lines: &mut impl Iterator<Item = (usize, &'a str)>,
) -> Result<Vec<Channel>, Error> {
    let word = words.next(lines, "a number of channels")?;
    let count: usize = match word.parse() {
        Ok(count) if count <= 6 => count,
        _ => return Err(words.bad_value(words.line, "CHANNELS", word, "0 to 6")),
    };
    let mut channels = Vec::with_capacity(count);
    for _ in 0..count {
        let word = words.next(lines, "a channel")?;
        let known = CHANNEL_NAMES.iter().find(|(name, _)| name.eq_ignore_ascii_case(word));
        let Some(&(_, channel)) = known else {
            let nearest = nearest(word, CHANNEL_NAMES.map(|(name, _)| name)).map(Into::into);
            return Err(Error::UnknownName { place: words.place(), what: "channel", name: shortened(word), nearest });
        };
        channels.push(channel);
    }
    Ok(channels)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "HIERARCHY\nROOT My Hips\n{\n\tOFFSET 0 0 0\n\tCHANNELS 6 Xposition Yposition Zposition Yrotation Xrotation Zrotation \n\
        \tJOINT Leg\n\t{\n\t\tOFFSET 0 -1 0\n\t\tCHANNELS 3 Zrotation Yrotation Xrotation\n\t\tEnd Site\n\t\t{\n\t\t\tOFFSET 0 -2 0\n\t\t}\n\t}\n}\n\
        MOTION\nFrames: 2\nFrame Time: .0083333\n1 2 3 90 0 0 0 0 90 \n0 0 0 0 0 0 90 0 0\n";

    fn check_error(text: &str, message: &str) {
        assert_eq!(read("a.bvh", text).unwrap_err().to_string(), message);
    }

    #[test]
    fn each_joint_keeps_its_order_of_channels() {
        let bvh = read("a.bvh", FILE).unwrap();
        assert_eq!(bvh.point_names(), ["My Hips", "Leg", "Leg_End"]);
        assert_eq!(bvh.joints[0].channels[3], Channel::Rotation(1));
        assert_eq!(bvh.frame_time_s, 0.0083333);
        let close = |frame: usize, expected: [[f64; 3]; 3]| {
            for ((_, point), expected) in bvh.positions(frame).unwrap().iter().zip(expected) {
                point.iter().zip(expected).for_each(|(a, b)| assert!((a - b).abs() < 1e-12, "{point:?} {expected:?}"));
            }
        };
        close(0, [[1.0, 2.0, 3.0], [1.0, 1.0, 3.0], [-1.0, 1.0, 3.0]]);
        close(1, [[0.0, 0.0, 0.0], [0.0, -1.0, 0.0], [2.0, -1.0, 0.0]]);
    }

    #[test]
    fn spelling_and_line_ends_are_forgiven() {
        let plain = read("a.bvh", FILE).unwrap();
        let other = FILE.replace("Frame Time:", "FrameTime :").replace("Frames:", "frames :").replace('\n', "\r\n");
        assert_eq!(read("a.bvh", &other).unwrap(), plain);
        assert_eq!(read("a.bvh", &FILE.replace("My Hips\n{", "My Hips {")).unwrap(), plain);
    }

    #[test]
    fn faults_are_named() {
        check_error("", "a.bvh: the file ends; expected `HIERARCHY`");
        check_error(&FILE.replace("0 0 90", "0 0 x"), "a.bvh:19: `x`; expected a number");
        check_error(&FILE.replace("0 0 90 ", "0 0"), "a.bvh:19: 8 values; expected 9");
        check_error(
            &FILE.replace("Xrotation\n", "Xrotatoin\n"),
            "a.bvh:9: unknown channel `Xrotatoin`; did you mean `Xrotation`?",
        );
        check_error(
            &FILE.replace("Frames: 2", "Frames: 1000000000"),
            "a.bvh: file claims 10^9 frames, holds 313 bytes",
        );
        check_error(&FILE.replace(".0083333", "0"), "a.bvh:18: Frame Time = 0; must be positive");
        check_error(&FILE.replace("Leg", "My Hips"), "a.bvh:7: the joint `My Hips` is there twice");
        let chain = |joints: usize| {
            let joint = |k: usize| format!("JOINT j{k}\n{{\nOFFSET 0 1 0\nCHANNELS 0\n");
            let below: String = (1..joints).map(joint).collect();
            let joints = format!("ROOT j0\n{{\nOFFSET 0 0 0\nCHANNELS 0\n{below}{}", "}\n".repeat(joints));
            format!("HIERARCHY\n{joints}MOTION\nFrames: 0\nFrame Time: 0.1\n")
        };
        assert_eq!(read("a.bvh", &chain(2000)).unwrap().joints.len(), 2000);
        check_error(&chain(2001), "a.bvh:8003: more than 2000 joints, the most that are read");
        let warnings = read("a.bvh", &FILE.replace("Frames: 2", "Frames: 3")).unwrap().warnings;
        assert_eq!(warnings[0].to_string(), "a.bvh: Frames says 3, the file holds 2");
    }
}
