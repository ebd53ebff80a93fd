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
//! The YAML is that which OpenCV writes: maps and lists by indentation, lists and maps in brackets, texts with and without
//! quotes, comments; no anchors, no blocks of text. A matrix is a map with its numbers in `data`, rows first.

mod yaml;

use crate::source_text::{finite, without_mark};
use crate::xml_text::{self, Element, unescaped};
use crate::{Error, Place};

/// A value of a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    /// Line where it begins.
    pub(crate) line: usize,
    /// What it is.
    pub(crate) value: Value,
}

/// What a value is.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// A text or a number.
    Scalar(String),
    /// A list.
    List(Vec<Node>),
    /// Names and values in the order of the file.
    Map(Vec<(String, Node)>),
}

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
    let root = xml_text::parse(name, text)?;
    if root.name == ROOT {
        return Ok(from_xml(&root));
    }
    Err(Error::Syntax {
        place: Place::file(name).at_line(root.line),
        found: format!("<{}>", crate::source_text::shortened(root.name)),
        expected: format!("<{ROOT}>"),
    })
}

fn from_xml(element: &Element<'_>) -> Node {
    let line = element.line;
    if element.children.is_empty() && element.name != ROOT {
        let mut items = tokens(&element.text);
        let scalar = |text| Node { line, value: Value::Scalar(text) };
        return match items.len() {
            1 => scalar(items.remove(0)),
            _ => Node { line, value: Value::List(items.into_iter().map(scalar).collect()) },
        };
    }
    let value = if element.children.iter().all(|child| child.name == "_") && element.name != ROOT {
        Value::List(element.children.iter().map(from_xml).collect())
    } else {
        Value::Map(element.children.iter().map(|child| (child.name.to_owned(), from_xml(child))).collect())
    };
    Node { line, value }
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

impl Node {
    /// The value of a name, of maps only.
    pub(crate) fn get(&self, key: &str) -> Option<&Self> {
        let Value::Map(entries) = &self.value else { return None };
        entries.iter().find(|(name, _)| name == key).map(|(_, node)| node)
    }

    /// The value of the first of some names that is there.
    pub(crate) fn first(&self, keys: &[&str]) -> Option<&Self> {
        keys.iter().find_map(|key| self.get(key))
    }

    /// Items of a list; none of anything else.
    pub(crate) fn items(&self) -> &[Self] {
        if let Value::List(items) = &self.value { items } else { &[] }
    }

    /// A text, or a number as it is written.
    pub(crate) fn text(&self) -> Option<&str> {
        if let Value::Scalar(text) = &self.value { Some(text) } else { None }
    }

    /// All numbers of a number, list or matrix, rows first.
    pub(crate) fn numbers(&self, file: &str, within: &str) -> Result<Vec<f64>, Error> {
        let place = || Place::file(file).at_line(self.line).within(within);
        match &self.value {
            Value::Scalar(text) => Ok(vec![finite(place, plain_number(text))?]),
            Value::List(items) => {
                let mut numbers = Vec::with_capacity(items.len());
                for item in items {
                    numbers.extend(item.numbers(file, within)?);
                }
                Ok(numbers)
            }
            Value::Map(_) => match self.get("data") {
                Some(data) => data.numbers(file, within),
                None => Err(Error::MissingField { place: place(), field: "data".into() }),
            },
        }
    }
}

/// A number without the dot that OpenCV puts before `Nan` and `Inf`.
fn plain_number(text: &str) -> &str {
    let is_special = |text: &str| ["nan", "inf"].iter().any(|word| text.eq_ignore_ascii_case(word));
    let unsigned = text.trim_start_matches(['-', '+']);
    unsigned.strip_prefix('.').filter(|text| is_special(text)).unwrap_or(text)
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
