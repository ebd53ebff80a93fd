//! Body files: a kinematic tree with named points, and the solids of its flesh, as TOML.
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
//! rest = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]   # rotation in the parent's frame where joints are at zero, rows first (none where it is missing)
//! joints = ["rz", "ry", "rx"]
//!
//! [[point]]                         # keypoint layouts and markers are matched by name
//! name = "LKnee"
//! link = "left_thigh"
//! offset = [0.0, 0.0, -0.43]        # in the link's frame, metres (zero where it is missing)
//!
//! [[solid]]                         # truncated elliptical cones, for silhouettes; none: the standard flesh
//! name = "left_thigh"
//! link = "left_thigh"
//! base = [0.0, 0.0, 0.0]            # centre of its base in the link's frame, metres (zero where it is missing)
//! axes = [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]   # x, y and z, which goes from base to top, in the link's frame (its own where missing)
//! height = 0.43                     # metres
//! radii = [0.09, 0.06]              # semi-axis along x at base and top, metres
//! ratio = 1.0                       # semi-axis along y over that along x (1 where it is missing)
//! ```
//!
//! `tx` is a translation along the link's x axis in metres, `rx` a rotation about it in radians; `["t", x, y, z]` and `["r", x, y, z]` are the same along and about any other vector. Axes are a right-handed frame of unit vectors. A solid comes after the one that it hangs on, that of the link above. Keys other than
//! these are refused. What is written reads back equal.
//!
//! ```
//! use sinew_formats::body_toml;
//! let text = "[[link]]\nname = \"arm\"\njoints = [\"rz\"]\n[[point]]\nname = \"hand\"\nlink = \"arm\"\noffset = [0.5, 0.0, 0.0]\n";
//! let body = body_toml::read("arm.toml", text)?;
//! assert_eq!(body.tree.dof_names(), ["arm.rz"]);
//! assert_eq!(body_toml::read("arm.toml", &body_toml::write(&body.tree, body.flesh.as_ref()))?, body);
//! let error = body_toml::read("arm.toml", "[[link]]\nname = \"arm\"\njoint = [\"rz\"]\n").unwrap_err();
//! assert_eq!(error.to_string(), "arm.toml:3: unknown key `joint`; did you mean `joints`?");
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::nearest::nearest;
use crate::source_text::shortened;
use crate::toml_text::{Document, Table, Value, array, quoted};
use crate::{Error, Place};
use sinew_body::flesh::{Flesh, Solid, UPWARDS};
use sinew_body::frustum::Frustum;
use sinew_body::{Axis, Joint, KinematicTree, Link, Point};
use std::fmt::Write as _;

/// Links, points or solids that a body may have: two names are compared for every pair.
const MAX_PARTS: usize = 2000;

/// What a body file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyDefinition {
    /// Links and points.
    pub tree: KinematicTree,
    /// Its solids, if the file has any.
    pub flesh: Option<Flesh>,
}

/// Reads a body.
///
/// # Errors
/// TOML that is malformed, unknown keys, joints, parents or links, names that are used twice, parents that come after
/// their children, solids without extent or with axes that are no frame.
pub fn read(name: &str, text: &str) -> Result<BodyDefinition, Error> {
    let document = Document::parse(name, text)?;
    let root = document.root();
    root.allow(&["link", "point", "solid"])?;
    let mut links: Vec<Link> = Vec::new();
    for table in tables(root, "link")? {
        table.allow(&["name", "parent", "offset", "rest", "joints"])?;
        let link = Link {
            name: unique_name(table, "link", links.iter().map(|link| link.name.as_str()))?,
            parent: table.get("parent").map(|value| link_named(value, "parent link", &links)).transpose()?,
            offset: offset(table)?,
            rest: table.get("rest").map(axes).transpose()?,
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
    let tree = KinematicTree::new(links, points).map_err(|reason| Error::Body { place: Place::file(name), reason })?;
    let flesh = flesh(root, &tree)?;
    Ok(BodyDefinition { tree, flesh })
}

fn flesh(root: Table<'_>, tree: &KinematicTree) -> Result<Option<Flesh>, Error> {
    let tables = tables(root, "solid")?;
    let mut solids: Vec<Solid> = Vec::new();
    for &table in &tables {
        table.allow(&["name", "link", "base", "axes", "height", "radii", "ratio"])?;
        let [below, above] = table.numbers("radii")?;
        if !(below > 0.0 && above > 0.0) {
            return Err(table.require("radii")?.must_be("greater than 0"));
        }
        let frustum = Frustum {
            height: positive(table.require("height")?)?,
            radii: [below, above],
            ratio: table.get("ratio").map_or(Ok(1.0), positive)?,
        };
        let solid = Solid {
            name: unique_name(table, "solid", solids.iter().map(|solid| solid.name.as_str()))?,
            link: link_named(table.require("link")?, "link", tree.links())?,
            base: table.get("base").map_or(Ok([0.0; 3]), |value| value.numbers())?,
            axes: table.get("axes").map_or(Ok(UPWARDS), axes)?,
            frustum,
        };
        solids.push(solid);
    }
    if solids.is_empty() {
        return Ok(None);
    }
    let place = |reason: &sinew_body::Error| match reason {
        sinew_body::Error::BadSolid { solid, .. } => {
            let table = tables.iter().find(|table| table.string("name").is_ok_and(|name| name == *solid));
            table.map_or(root.place(), Table::place)
        }
        _ => root.place(),
    };
    Flesh::new(tree, solids).map(Some).map_err(|reason| Error::Body { place: place(&reason), reason })
}

fn positive(value: Value<'_>) -> Result<f64, Error> {
    match value.number()? {
        number if number > 0.0 => Ok(number),
        _ => Err(value.must_be("greater than 0")),
    }
}

fn axes(value: Value<'_>) -> Result<[[f64; 3]; 3], Error> {
    let axes = value.items()?.iter().map(Value::numbers).collect::<Result<Vec<[f64; 3]>, Error>>()?;
    <[[f64; 3]; 3]>::try_from(axes).map_err(|_| value.must_be("3 arrays of 3 numbers"))
}

fn tables<'a>(root: Table<'a>, key: &'a str) -> Result<Vec<Table<'a>>, Error> {
    let tables = root.array_of_tables(key)?;
    if tables.len() > MAX_PARTS {
        return Err(root.place().bad_value(
            format!("[[{key}]]"),
            format!("{} tables", tables.len()),
            format!("at most {MAX_PARTS}"),
        ));
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
        return Err(table.place().twice(what, name));
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
    value.items()?.iter().map(joint).collect()
}

fn joint(item: &Value<'_>) -> Result<Joint, Error> {
    let refused = || item.must_be("tx, ty, tz, rx, ry, rz, [\"t\", x, y, z] or [\"r\", x, y, z]");
    let Ok(parts) = item.items() else {
        return Joint::named(&item.string()?).ok_or_else(refused);
    };
    let [kind, vector @ ..] = &parts[..] else { return Err(refused()) };
    let numbers = vector.iter().map(Value::number).collect::<Result<Vec<f64>, Error>>()?;
    let axis = <[f64; 3]>::try_from(numbers).ok().and_then(|vector| Axis::along(vector).ok()).ok_or_else(refused)?;
    match kind.string()?.as_str() {
        "t" => Ok(Joint::Translate(axis)),
        "r" => Ok(Joint::Rotate(axis)),
        _ => Err(refused()),
    }
}

/// How a joint stands in a file.
fn joint_text(joint: Joint) -> String {
    joint.name().map_or_else(
        || {
            let kind = if matches!(joint, Joint::Translate(_)) { "t" } else { "r" };
            let [x, y, z] = joint.axis().direction();
            format!("[\"{kind}\", {x:?}, {y:?}, {z:?}]")
        },
        quoted,
    )
}

/// Writes a body, with its solids if they are given.
#[must_use]
pub fn write(tree: &KinematicTree, flesh: Option<&Flesh>) -> String {
    let mut out = String::new();
    let name_of = |link: usize| tree.links().get(link).map_or_else(String::new, |link| quoted(&link.name));
    // Writing to a String cannot fail.
    for link in tree.links() {
        let _ = writeln!(out, "[[link]]\nname = {}", quoted(&link.name));
        if let Some(parent) = link.parent {
            let _ = writeln!(out, "parent = {}", name_of(parent));
        }
        if let Some(rest) = &link.rest {
            let _ = writeln!(out, "rest = [{}]", rest.each_ref().map(|row| array(row)).join(", "));
        }
        let joints: Vec<String> = link.joints.iter().map(|joint| joint_text(*joint)).collect();
        let _ = writeln!(out, "offset = {}\njoints = [{}]\n", array(&link.offset), joints.join(", "));
    }
    for point in tree.points() {
        let (name, link, offset) = (quoted(&point.name), name_of(point.link), array(&point.offset));
        let _ = writeln!(out, "[[point]]\nname = {name}\nlink = {link}\noffset = {offset}\n");
    }
    for Solid { name, link, base, axes, frustum } in flesh.map_or(&[][..], Flesh::solids) {
        let Frustum { height, radii, ratio } = frustum;
        let (name, link, base, radii) = (quoted(name), name_of(*link), array(base), array(radii));
        let axes = axes.each_ref().map(|axis| array(axis)).join(", ");
        let _ = writeln!(out, "[[solid]]\nname = {name}\nlink = {link}\nbase = {base}\naxes = [{axes}]");
        let _ = writeln!(out, "height = {height:?}\nradii = {radii}\nratio = {ratio:?}\n");
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
        let joints = "must be tx, ty, tz, rx, ry, rz, [\"t\", x, y, z] or [\"r\", x, y, z]";
        check("", "body.toml: not a valid body");
        check("[[lnk]]\n", "body.toml:1: unknown key `lnk`; did you mean `link`?");
        check(&format!("{root}joints = [\"rw\"]"), &format!("body.toml:3: joints = \"rw\"; {joints}"));
        let zero = format!("body.toml:3: joints = [\"r\", 0, 0, 0]; {joints}");
        check(&format!("{root}joints = [[\"r\", 0, 0, 0]]"), &zero);
        check(&format!("{root}rest = [[1, 0, 0]]"), "body.toml:3: rest = [[1, 0, 0]]; must be 3 arrays of 3 numbers");
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
    fn faults_of_solids_are_named() {
        let solid = |more: &str| format!("[[link]]\nname = \"arm\"\n[[solid]]\nname = \"a\"\nlink = \"arm\"\n{more}");
        let sizes = "height = 0.3\nradii = [0.05, 0.04]\n";
        assert_eq!(read("body.toml", &solid(sizes)).unwrap().flesh.unwrap().solids().len(), 1);
        check(&solid("heigth = 1"), "body.toml:6: unknown key `heigth`; did you mean `height`?");
        check(&solid("height = 0.3"), "body.toml:3: `radii` is missing");
        check(&solid("height = 0\nradii = [1, 1]"), "body.toml:6: height = 0; must be greater than 0");
        check(&solid("height = 1\nradii = [0.1, -0.1]"), "body.toml:7: radii = [0.1, -0.1]; must be greater than 0");
        check(&solid(&format!("{sizes}ratio = -1")), "body.toml:8: ratio = -1; must be greater than 0");
        check(
            &solid(&format!("{sizes}axes = [[1, 0, 0]]")),
            "body.toml:8: axes = [[1, 0, 0]]; must be 3 arrays of 3 numbers",
        );
        check(
            &solid(sizes).replace("link = \"arm\"", "link = \"amr\""),
            "body.toml:5: unknown link `amr`; did you mean `arm`?",
        );
        let twice = format!("{}[[solid]]\nname = \"a\"\nlink = \"arm\"\n{sizes}", solid(sizes));
        check(&twice, "body.toml:8: the solid `a` is there twice");
        let skewed = solid(&format!("{sizes}axes = [[1, 0, 0], [1, 0, 0], [0, 0, 1]]"));
        check(&skewed, "body.toml:3: not a valid body");
        let cause = std::error::Error::source(&read("body.toml", &skewed).unwrap_err()).unwrap().to_string();
        assert!(cause.contains("`a`") && cause.contains("right-handed"), "{cause}");
    }

    #[test]
    fn an_empty_body_says_why() {
        let error = read("body.toml", "").unwrap_err();
        let cause = std::error::Error::source(&error).unwrap();
        assert_eq!(cause.to_string(), "the body has no links; give at least one");
    }
}
