//! URDF: links and joints of a robot or of a musculoskeletal model (ROS).
//!
//! ```xml
//! <robot name="arm">
//!   <link name="base"/>
//!   <link name="upper_arm"/>
//!   <joint name="shoulder" type="revolute">
//!     <parent link="base"/> <child link="upper_arm"/>
//!     <origin xyz="0 0 1.4" rpy="0 0 0"/>
//!     <axis xyz="0 1 0"/>
//!     <limit lower="-1.5" upper="1.5"/>
//!   </joint>
//! </robot>
//! ```
//!
//! Lengths are in metres, angles in radians; `rpy` turns about the fixed axes x, y, z in this order. Read are links and joints of the types
//! `fixed`, `revolute`, `continuous`, `prismatic` and `floating` (translations, then rotations about z, y, x). Every link becomes a link of the
//! body, named as in the file, with a point of its name at its origin. A joint that mimics another gets a degree of freedom of its own; masses,
//! shapes and everything else are passed over. The first link hangs in the world: a body that moves about needs a `floating` joint above it.
//!
//! ```
//! let text = "<robot name='arm'><link name='base'/><link name='arm'/><joint name='a' type='revolute'><parent link='base'/><child link='arm'/>
//!             <origin xyz='0 0 1' rpy='0 0 1.5707963267948966'/><axis xyz='0 0.6 0.8'/><limit lower='-1' upper='2'/></joint></robot>";
//! let robot = sinew_formats::urdf::read("arm.urdf", text)?;
//! assert_eq!(robot.tree.dof_names(), ["arm.ru"]);
//! assert_eq!(robot.ranges, [Some([-1.0, 2.0])]);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::limits::{MAX_JOINTS, check_count};
use crate::nearest::nearest;
use crate::rotation::{Matrix, about_axis, product};
use crate::source_text::shortened;
use crate::xml_text::{Element, Xml};
use crate::{Error, Place};
use sinew_body::{Axis, Joint, KinematicTree, Link, Point};
use std::collections::BTreeMap;

/// What a file holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Urdf {
    /// The body.
    pub tree: KinematicTree,
    /// Least and greatest value of each degree of freedom, radians or metres, where the file limits it.
    pub ranges: Vec<Option<[f64; 2]>>,
}

/// A joint of the file.
struct Hinge<'a> {
    parent: String,
    offset: [f64; 3],
    rest: Option<Matrix>,
    joints: Vec<Joint>,
    range: Option<[f64; 2]>,
    element: Element<'a>,
}

/// Types of joints that are read.
const TYPES: &str = "fixed, revolute, continuous, prismatic or floating";

/// Reads a robot.
///
/// # Errors
/// XML that is malformed, a document that is no robot, joints of other types, without parent or child or with such as are no links, two joints
/// above one link, rings of joints, numbers that are none.
pub fn read(name: &str, text: &str) -> Result<Urdf, Error> {
    let xml = Xml::parse(name, text)?;
    let root = xml.root();
    if root.name() != "robot" {
        return Err(Error::MissingField { place: Place::file(name), field: "<robot>".into() });
    }
    let at = |element: Element<'_>| Place::file(name).at_line(element.line());
    let required = |element: Element<'_>, key: &str| {
        let missing = || Error::MissingField { place: at(element), field: format!("{}.{key}", element.name()) };
        element.attribute(key).map(str::to_owned).ok_or_else(missing)
    };
    let names = root.named("link").map(|link| required(link, "name")).collect::<Result<Vec<String>, Error>>()?;
    check_count(|| at(root), names.len(), "links", MAX_JOINTS)?;
    let mut above: BTreeMap<String, Hinge<'_>> = BTreeMap::new();
    for element in root.named("joint") {
        let linked = |key: &str| {
            let child = element.named(key).next();
            let child = child.ok_or_else(|| Error::MissingField { place: at(element), field: format!("<{key}>") })?;
            let link = required(child, "link")?;
            let unknown = || Error::UnknownName {
                place: at(child),
                what: "link",
                nearest: nearest(&link, names.iter().map(String::as_str)).map(Into::into),
                name: shortened(&link),
            };
            if names.contains(&link) { Ok(link) } else { Err(unknown()) }
        };
        let (parent, child) = (linked("parent")?, linked("child")?);
        let hinge = hinge(element, parent, &at)?;
        if above.insert(child.clone(), hinge).is_some() {
            return Err(Error::DuplicateName { place: at(element), what: "joint above the link", name: child });
        }
    }
    let mut links: Vec<Link> = vec![];
    let mut ranges = vec![];
    // Roots first, then whatever hangs on a link that is there; what is left hangs on itself.
    let mut waiting: Vec<&String> = names.iter().collect();
    while !waiting.is_empty() {
        let before = waiting.len();
        waiting.retain(|own| {
            let own = own.as_str();
            let Some(hinge) = above.get(own) else {
                links.push(Link::new(own, None, [0.0; 3], vec![]));
                return false;
            };
            let Some(parent) = links.iter().position(|link| link.name == hinge.parent) else { return true };
            ranges.extend(hinge.joints.iter().map(|_| hinge.range));
            links.push(Link { rest: hinge.rest, ..Link::new(own, Some(parent), hinge.offset, hinge.joints.clone()) });
            false
        });
        if waiting.len() == before {
            let ring = above.get(waiting[0]).map_or(root, |hinge| hinge.element);
            let (found, expected) = (format!("a ring of joints through `{}`", waiting[0]), "a tree of links".into());
            return Err(Error::Syntax { place: at(ring), found, expected });
        }
    }
    let points = links.iter().enumerate();
    let points = points.map(|(link, own)| Point { name: own.name.clone(), link, offset: [0.0; 3] }).collect();
    let tree = KinematicTree::new(links, points).map_err(|reason| Error::Body { place: Place::file(name), reason })?;
    Ok(Urdf { tree, ranges })
}

fn hinge<'a>(element: Element<'a>, parent: String, at: &impl Fn(Element<'_>) -> Place) -> Result<Hinge<'a>, Error> {
    let vector = |tag: &str, key: &str, usual: [f64; 3]| {
        let child = element.named(tag).next();
        let Some((child, text)) = child.and_then(|child| Some((child, child.attribute(key)?))) else {
            return Ok(usual);
        };
        numbers::<3>(text).ok_or_else(|| bad(at(child), key, text, "three finite numbers"))
    };
    let offset = vector("origin", "xyz", [0.0; 3])?;
    let angles = vector("origin", "rpy", [0.0; 3])?;
    let [roll, pitch, yaw] = angles;
    let rest = product(&product(&about_axis(2, yaw), &about_axis(1, pitch)), &about_axis(0, roll));
    let axis = || {
        let vector = vector("axis", "xyz", [1.0, 0.0, 0.0])?;
        Axis::along(vector).map_err(|_| bad(at(element), "axis", &format!("{vector:?}"), "a vector that is not zero"))
    };
    let kind = element.attribute("type").unwrap_or_default();
    let joints = match kind {
        "fixed" => vec![],
        "revolute" | "continuous" => vec![Joint::Rotate(axis()?)],
        "prismatic" => vec![Joint::Translate(axis()?)],
        "floating" => {
            use Axis::{X, Y, Z};
            [X, Y, Z].map(Joint::Translate).into_iter().chain([Z, Y, X].map(Joint::Rotate)).collect()
        }
        _ => return Err(bad(at(element), "type", kind, TYPES)),
    };
    let limit = |key: &str| {
        let text = element.named("limit").next().and_then(|limit| limit.attribute(key))?;
        Some(numbers::<1>(text).map(|[x]| x).ok_or_else(|| bad(at(element), key, text, "a finite number")))
    };
    let range = match (limit("lower").transpose()?, limit("upper").transpose()?) {
        (Some(lower), Some(upper)) if kind == "revolute" || kind == "prismatic" => Some([lower, upper]),
        _ => None,
    };
    Ok(Hinge { parent, offset, rest: (angles != [0.0; 3]).then_some(rest), joints, range, element })
}

fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let numbers = text.split_whitespace().map(|word| word.parse::<f64>().ok().filter(|x| x.is_finite()));
    <[f64; N]>::try_from(numbers.collect::<Option<Vec<f64>>>()?).ok()
}

fn bad(place: Place, field: &str, found: &str, expected: &str) -> Error {
    Error::BadValue { place, field: field.into(), found: format!("`{}`", shortened(found)), expected: expected.into() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    /// A joint from link `a` to link `b`.
    fn joint(kind: &str, inside: &str) -> String {
        let ends = "<parent link='a'/><child link='b'/>";
        format!(
            "<robot name='r'><link name='b'/><link name='a'/><joint name='j' type='{kind}'>{ends}{inside}</joint></robot>"
        )
    }

    /// Worked by hand: a quarter turn of the frame about z takes the axis x to y, which turns z to x.
    #[test]
    fn frames_and_axes_are_those_of_the_format() {
        let inside = format!("<origin xyz='1 2 3' rpy='0 0 {FRAC_PI_2}'/><axis xyz='2 0 0'/>");
        let robot = read("r.urdf", &joint("continuous", &inside)).unwrap();
        assert_eq!(robot.tree.dof_names(), ["b.rx"]);
        let frames = robot.tree.link_frames(&[FRAC_PI_2]);
        let (rotation, origin) = frames[robot.tree.link_index("b").unwrap()];
        assert_eq!(origin, [1.0, 2.0, 3.0]);
        let expected = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let near = rotation.as_flattened().iter().zip(expected.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(near, "{rotation:?}");
        // Roll, pitch, yaw: about the fixed x first, so z of the link goes to −y, and yaw takes that to x.
        let inside = format!("<origin rpy='{FRAC_PI_2} 0 {FRAC_PI_2}'/>");
        let robot = read("r.urdf", &joint("fixed", &inside)).unwrap();
        let z = robot.tree.link_frames(&[])[1].0.map(|row| row[2]);
        assert!((z[0] - 1.0).abs() < 1e-12, "{z:?}");
    }

    #[test]
    fn faults_are_named_with_their_lines() {
        let fault = |text: &str| read("r.urdf", text).unwrap_err().to_string();
        assert_eq!(fault(&joint("ball", "")), format!("r.urdf:1: type = `ball`; must be {TYPES}"));
        let word = fault(&joint("fixed", "\n<origin xyz='1 two 3'/>"));
        assert_eq!(word, "r.urdf:2: xyz = `1 two 3`; must be three finite numbers");
        assert!(fault(&joint("revolute", "<axis xyz='0 0 0'/>")).contains("a vector that is not zero"));
        assert!(fault(&joint("fixed", "").replace("child link='b'", "child link='c'")).contains("unknown link `c`"));
        assert!(fault(&joint("fixed", "").replace("child link='b'", "child link='a'")).contains("a ring of joints"));
        assert!(fault("<model/>").contains("<robot>"));
        assert!(fault("<robot/>").contains("not a valid body"));
    }
}
