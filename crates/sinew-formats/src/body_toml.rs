//! Body files: a kinematic tree with named points as TOML.
//!
//! ```toml
//! [[link]]                          # parents before their children
//! name = "pelvis"                   # no parent: a root
//! offset = [0.0, 0.0, 0.0]          # origin in the parent's frame, metres (zero where it is missing)
//! joints = ["tx", "ty", "tz", "rz", "ry", "rx"]   # degrees of freedom, left to right (none where it is missing)
//!
//! [[link]]
//! name = "left_thigh"
//! parent = "pelvis"
//! offset = [-0.09, 0.0, -0.1]
//! joints = ["rz", "ry", "rx"]
//!
//! [[point]]                         # keypoint layouts and markers are matched by name
//! name = "LKnee"
//! link = "left_thigh"
//! offset = [0.0, 0.0, -0.43]        # in the link's frame, metres (zero where it is missing)
//! ```
//!
//! `tx` is a translation along the link's x axis in metres, `rx` a rotation about it in radians. Keys other than these
//! are refused. What is written reads back equal.
//!
//! ```
//! use sinew_formats::body_toml;
//! let text = "[[link]]\nname = \"arm\"\njoints = [\"rz\"]\n[[point]]\nname = \"hand\"\nlink = \"arm\"\noffset = [0.5, 0.0, 0.0]\n";
//! let body = body_toml::read("arm.toml", text)?;
//! assert_eq!(body.dof_names(), ["arm.rz"]);
//! assert_eq!(body_toml::read("arm.toml", &body_toml::write(&body))?, body);
//! let error = body_toml::read("arm.toml", "[[link]]\nname = \"arm\"\njoint = [\"rz\"]\n").unwrap_err();
//! assert_eq!(error.to_string(), "arm.toml:3: unknown key `joint`; did you mean `joints`?");
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::nearest::nearest;
use crate::source_text::shortened;
use crate::toml_text::{Document, Table, Value, array, quoted};
use crate::{Error, Place};
use sinew_body::{Axis, Joint, KinematicTree, Link, Point};
use std::fmt::Write as _;

const JOINTS: [(&str, Joint); 6] = [
    ("tx", Joint::Translate(Axis::X)),
    ("ty", Joint::Translate(Axis::Y)),
    ("tz", Joint::Translate(Axis::Z)),
    ("rx", Joint::Rotate(Axis::X)),
    ("ry", Joint::Rotate(Axis::Y)),
    ("rz", Joint::Rotate(Axis::Z)),
];

/// Links or points that a body may have: two names are compared for every pair.
const MAX_PARTS: usize = 2000;

/// Reads a body.
///
/// # Errors
/// TOML that is malformed, unknown keys, joints, parents or links, names that are used twice, parents that come after
/// their children.
pub fn read(name: &str, text: &str) -> Result<KinematicTree, Error> {
    let document = Document::parse(name, text)?;
    let root = document.root();
    root.allow(&["link", "point"])?;
    let mut links: Vec<Link> = Vec::new();
    for table in tables(root, "link")? {
        table.allow(&["name", "parent", "offset", "joints"])?;
        let link = Link {
            name: unique_name(table, "link", links.iter().map(|link| link.name.as_str()))?,
            parent: table.get("parent").map(|value| link_named(value, "parent link", &links)).transpose()?,
            offset: offset(table)?,
            joints: joints(table)?,
        };
        links.push(link);
    }
    let mut points: Vec<Point> = Vec::new();
    for table in tables(root, "point")? {
        table.allow(&["name", "link", "offset"])?;
        let point = Point {
            name: unique_name(table, "point", points.iter().map(|point| point.name.as_str()))?,
            link: link_named(table.require("link")?, "link", &links)?,
            offset: offset(table)?,
        };
        points.push(point);
    }
    KinematicTree::new(links, points).map_err(|reason| Error::Body { place: Place::file(name), reason })
}

fn tables<'a>(root: Table<'a>, key: &'a str) -> Result<Vec<Table<'a>>, Error> {
    let tables = root.array_of_tables(key)?;
    if tables.len() > MAX_PARTS {
        let (field, found) = (format!("[[{key}]]"), format!("{} tables", tables.len()));
        return Err(Error::BadValue { place: root.place(), field, found, expected: format!("at most {MAX_PARTS}") });
    }
    Ok(tables)
}

fn unique_name<'n>(
    table: Table<'_>,
    what: &'static str,
    mut others: impl Iterator<Item = &'n str>,
) -> Result<String, Error> {
    let name = table.string("name")?;
    if others.any(|other| other == name) {
        return Err(Error::DuplicateName { place: table.place(), what, name });
    }
    Ok(name)
}

fn link_named(value: Value<'_>, what: &'static str, links: &[Link]) -> Result<usize, Error> {
    let name = value.string()?;
    links.iter().position(|link| link.name == name).ok_or_else(|| Error::UnknownName {
        place: value.place(),
        what,
        nearest: nearest(&name, links.iter().map(|link| link.name.as_str())).map(Into::into),
        name: shortened(&name),
    })
}

fn offset(table: Table<'_>) -> Result<[f64; 3], Error> {
    table.get("offset").map_or(Ok([0.0; 3]), |value| value.numbers())
}

fn joints(table: Table<'_>) -> Result<Vec<Joint>, Error> {
    let Some(value) = table.get("joints") else { return Ok(Vec::new()) };
    let joint = |item: &Value<'_>| {
        let name = item.string()?;
        let known = JOINTS.iter().find(|(known, _)| *known == name).map(|(_, joint)| *joint);
        known.ok_or_else(|| item.must_be("tx, ty, tz, rx, ry or rz"))
    };
    value.items()?.iter().map(joint).collect()
}

/// Writes a body.
#[must_use]
pub fn write(tree: &KinematicTree) -> String {
    let mut out = String::new();
    let name_of = |link: usize| tree.links().get(link).map_or_else(String::new, |link| quoted(&link.name));
    // Writing to a String cannot fail.
    for link in tree.links() {
        let _ = writeln!(out, "[[link]]\nname = {}", quoted(&link.name));
        if let Some(parent) = link.parent {
            let _ = writeln!(out, "parent = {}", name_of(parent));
        }
        let names = link.joints.iter().filter_map(|joint| JOINTS.iter().find(|(_, known)| known == joint));
        let joints: Vec<String> = names.map(|(name, _)| quoted(name)).collect();
        let _ = writeln!(out, "offset = {}\njoints = [{}]\n", array(&link.offset), joints.join(", "));
    }
    for point in tree.points() {
        let (name, link, offset) = (quoted(&point.name), name_of(point.link), array(&point.offset));
        let _ = writeln!(out, "[[point]]\nname = {name}\nlink = {link}\noffset = {offset}\n");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, message: &str) {
        assert_eq!(read("body.toml", text).unwrap_err().to_string(), message, "{text}");
    }

    #[test]
    fn faults_are_named() {
        let root = "[[link]]\nname = \"pelvis\"\n";
        check("", "body.toml: not a valid body");
        check("[[lnk]]\n", "body.toml:1: unknown key `lnk`; did you mean `link`?");
        check(&format!("{root}joints = [\"rw\"]"), "body.toml:3: joints = \"rw\"; must be tx, ty, tz, rx, ry or rz");
        check(&format!("{root}offset = [1, 2]"), "body.toml:3: offset = [1, 2]; must be an array of 3 numbers");
        check(&format!("{root}{root}"), "body.toml:3: the link `pelvis` is there twice");
        check(&format!("{root}parent = \"hip\""), "body.toml:3: unknown parent link `hip`");
        check(
            &format!("{root}[[point]]\nname = \"a\"\nlink = \"plevis\""),
            "body.toml:5: unknown link `plevis`; did you mean `pelvis`?",
        );
        check(&format!("{root}[[point]]\nname = \"a\""), "body.toml:3: `link` is missing");
    }

    #[test]
    fn an_empty_body_says_why() {
        let error = read("body.toml", "").unwrap_err();
        let cause = std::error::Error::source(&error).unwrap();
        assert_eq!(cause.to_string(), "the body has no links; give at least one");
    }
}
