//! Files of OpenCV's `FileStorage`: a tree of names, texts and numbers, as YAML or XML.
//!
//! ```yaml
//! %YAML:1.0
//! ---
//! camera_matrix: !!opencv-matrix
//!    rows: 3
//!    cols: 3
//!    dt: d
//!    data: [ 500.5, 0., 320., 0., 501.25, 240., 0., 0., 1. ]
//! names:
//!    - "left"
//! ```
//!
//! A matrix is a map with its numbers in `data`, rows first.

mod node;
mod yaml;

use crate::source_text::{shortened, without_mark};
use crate::xml_text::{Element, Xml, unescaped};
use crate::{Error, Place};
pub(crate) use node::Node;
use node::Value;

/// Nesting allowed; calibrations need four levels.
const MAX_DEPTH: usize = 100;

/// Outermost element of the XML form.
const ROOT: &str = "opencv_storage";

/// Whether a text is such a file, by its first words.
pub(crate) fn is_of(text: &str) -> bool {
    let start = without_mark(text).trim_start();
    start.starts_with("%YAML")
        || start.contains("!!opencv-matrix")
        || (start.starts_with('<') && start.contains("<opencv_storage"))
}

/// Parses a file into its outermost map.
pub(crate) fn parse(name: &str, text: &str) -> Result<Node, Error> {
    if !without_mark(text).trim_start().starts_with('<') {
        return yaml::parse(name, text);
    }
    let xml = Xml::parse(name, text)?;
    let root = xml.root();
    if root.name() == ROOT {
        return from_xml(name, root, 0);
    }
    Err(Place::file(name).at_line(root.line()).syntax(format!("<{}>", shortened(root.name())), format!("<{ROOT}>")))
}

fn from_xml(file: &str, element: Element<'_>, depth: usize) -> Result<Node, Error> {
    let line = element.line();
    check_depth(file, line, depth)?;
    if element.children().next().is_none() && depth > 0 {
        let mut items = tokens(&element.written_text());
        let scalar = |text| Node { line, value: Value::Scalar(text) };
        return Ok(match items.len() {
            1 => scalar(items.remove(0)),
            _ => Node { line, value: Value::List(items.into_iter().map(scalar).collect()) },
        });
    }
    let inner = |child| from_xml(file, child, depth + 1);
    let value = if depth > 0 && element.children().all(|child| child.name() == "_") {
        Value::List(element.children().map(inner).collect::<Result<_, _>>()?)
    } else {
        Value::Map(
            element.children().map(|child| Ok((child.name().to_owned(), inner(child)?))).collect::<Result<_, _>>()?,
        )
    };
    Ok(Node { line, value })
}

fn check_depth(file: &str, line: usize, depth: usize) -> Result<(), Error> {
    let place = || Place::file(file).at_line(line);
    if depth < MAX_DEPTH { Ok(()) } else { Err(Error::TooDeep { place: place(), limit: MAX_DEPTH }) }
}

/// Words of a text; what stands in quotes is one.
fn tokens(text: &str) -> Vec<String> {
    let mut found = vec![];
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let (token, after) = match rest.strip_prefix('"') {
            Some(quoted) => quoted.split_once('"').unwrap_or((quoted, "")),
            None => rest.split_at(rest.find(char::is_whitespace).unwrap_or(rest.len())),
        };
        found.push(unescaped(token));
        rest = after.trim_start();
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const XML: &str = "<?xml version=\"1.0\"?>\n<opencv_storage>\n<cameras>\n  <_>\n    <name>\"cam &quot;0&quot; b\"</name>\n    <k type_id=\"opencv-matrix\">\n      <rows>1</rows>\n      <cols>2</cols>\n      <data>\n        500.5 1.</data></k></_></cameras>\n<names>\n  \"1\" \"b c\"</names>\n</opencv_storage>\n";
    const YAML: &str = "%YAML:1.0\n---\ncameras:\n   -\n      name: \"cam \\\"0\\\" b\"\n      k: !!opencv-matrix\n         rows: 1\n         cols: 2\n         data: [ 500.5,\n             1. ]\nnames:\n   - \"1\"\n   - b c\n";

    #[test]
    fn both_forms_hold_the_same() {
        for text in [XML, YAML] {
            let root = parse("a", text).unwrap();
            let camera = &root.get("cameras").unwrap().items()[0];
            assert_eq!(camera.get("name").unwrap().text(), Some("cam \"0\" b"));
            assert_eq!(camera.get("k").unwrap().numbers("a", "k").unwrap(), [500.5, 1.0]);
            let names: Vec<_> = root.get("names").unwrap().items().iter().filter_map(Node::text).collect();
            assert_eq!(names, ["1", "b c"]);
        }
    }

    #[test]
    fn numbers_that_are_none_are_placed() {
        let error = |number: &str| {
            let root = parse("a.yml", &format!("%YAML:1.0\n---\nk: [ 1., {number} ]\n")).unwrap();
            root.get("k").unwrap().numbers("a.yml", "k").unwrap_err().to_string()
        };
        assert_eq!(error("-.Inf"), "a.yml (k): value out of range at line 3");
        assert_eq!(error("x"), "a.yml:3 (k): `x`; expected a number");
        let error = parse("a.xml", "<calibration/>").unwrap_err();
        assert_eq!(error.to_string(), "a.xml:1: <calibration>; expected <opencv_storage>");
    }
}
