//! YAML by `saphyr-parser`, as a tree of nodes, and what OpenCV writes that no YAML has.
//!
//! `%YAML:1.0` is no directive, `{ x:1 }` has no blank behind the colon, and files that stand one after the other are one
//! map: the entries of all documents.

use super::check_depth;
use super::node::{Node, Value};
use crate::source_text::{malformed, shortened, without_mark};
use crate::{Error, Place};
use saphyr_parser::{Event, Parser};
use std::collections::BTreeMap;

/// A list or map whose end has not come.
struct Open {
    node: Node,
    /// Name of the value that comes next in a map.
    key: Option<String>,
    /// Places of the names of a map.
    known: BTreeMap<String, usize>,
}

impl Open {
    fn new(line: usize, value: Value) -> Self {
        Self { node: Node { line, value }, key: None, known: BTreeMap::new() }
    }

    /// Adds an item of a list, or a name or value of a map; a name may be there twice with one value.
    fn add(&mut self, file: &str, node: Node) -> Result<(), Error> {
        let entries = match &mut self.node.value {
            Value::Map(entries) => entries,
            Value::List(items) => {
                items.push(node);
                return Ok(());
            }
            Value::Scalar(_) => return Ok(()),
        };
        let (line, place) = (node.line, Place::file(file).at_line(node.line));
        let (key, value) = match (self.key.take(), node.value) {
            (None, Value::Scalar(key)) => {
                self.key = Some(key);
                return Ok(());
            }
            (None, _) => return Err(Error::Unsupported { place, what: "a map or list as a name".into() }),
            (Some(key), Value::Scalar(text)) if text.is_empty() && key.contains(':') => {
                let (key, text) = key.split_once(':').unwrap_or_default();
                (key.to_owned(), Value::Scalar(text.to_owned()))
            }
            (Some(key), value) => (key, value),
        };
        match self.known.get(&key).and_then(|&first| entries.get(first)) {
            Some((_, first)) if first.value == value => {}
            Some(_) => return Err(place.twice("key", shortened(&key))),
            None => {
                self.known.insert(key.clone(), entries.len());
                entries.push((key, Node { line, value }));
            }
        }
        Ok(())
    }
}

/// Parses a file into its outermost map.
pub(super) fn parse(name: &str, text: &str) -> Result<Node, Error> {
    let text = without_mark(text);
    // Behind a line end of ours, so that lines count one more.
    let yaml = format!("\n{text}").replace("\n%", "\n#");
    let line_of = |marker: saphyr_parser::Marker| marker.line().saturating_sub(1).max(1);
    let mut root = Open::new(1, Value::Map(vec![]));
    let mut open: Vec<Open> = vec![];
    for event in Parser::new_from_str(&yaml) {
        let (event, span) = event.map_err(|error| {
            let place = [line_of(*error.marker()), error.marker().col()];
            malformed(name, text, place, &format!("valid YAML ({})", error.info()))
        })?;
        let line = line_of(span.start);
        let done = match event {
            Event::MappingStart(..) | Event::SequenceStart(..) => {
                check_depth(name, line, open.len())?;
                let is_map = matches!(event, Event::MappingStart(..));
                open.push(Open::new(line, if is_map { Value::Map(vec![]) } else { Value::List(vec![]) }));
                continue;
            }
            Event::MappingEnd | Event::SequenceEnd => open.pop().map(|done| done.node),
            Event::Scalar(text, ..) => Some(Node { line, value: Value::Scalar(text.into_owned()) }),
            Event::Alias(_) => {
                let place = Place::file(name).at_line(line);
                return Err(Error::Unsupported { place, what: "an alias in YAML".into() });
            }
            _ => None,
        };
        match (done, open.last_mut()) {
            (Some(done), Some(parent)) => parent.add(name, done)?,
            (Some(Node { line, value: Value::Map(entries) }), None) => {
                if root.known.is_empty() {
                    root.node.line = line;
                }
                for (key, node) in entries {
                    root.add(name, Node { line: node.line, value: Value::Scalar(key) })?;
                    root.add(name, node)?;
                }
            }
            _ => {}
        }
    }
    Ok(root.node)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(node: &Node) -> String {
        match &node.value {
            Value::Scalar(text) => text.clone(),
            Value::List(items) => format!("[{}]", items.iter().map(shown).collect::<Vec<_>>().join(" ")),
            Value::Map(entries) => {
                let entries: Vec<_> = entries.iter().map(|(key, node)| format!("{key}={}", shown(node))).collect();
                format!("{{{}}}", entries.join(" "))
            }
        }
    }

    #[test]
    fn maps_lists_and_brackets_nest() {
        let check = |text: &str, expected: &str| assert_eq!(shown(&parse("a.yml", text).unwrap()), expected, "{text}");
        check("%YAML 1.2\n---\na: 1 # one\nb: \"x: y\"\n...\n", "{a=1 b=x: y}");
        check("a:\n   b:\n      c: 1\n   d: 2\ne: 3\n", "{a={b={c=1} d=2} e=3}");
        check(
            "a:\n- 1\n- 2\nb:\n  -\n    x: 1\n    y: [ 1., 2.,\n       3. ]\n  - x: 4\n    y: 5\n",
            "{a=[1 2] b=[{x=1 y=[1. 2. 3.]} {x=4 y=5}]}",
        );
        check(
            "a: !!opencv-matrix\n   rows: 1\n   data: []\nb: { x:1, y: [ 2 ] }\nc:\n",
            "{a={rows=1 data=[]} b={x=1 y=[2]} c=}",
        );
        check("", "{}");
    }

    #[test]
    fn faults_are_placed() {
        let check = |text: &str, message: &str| assert_eq!(parse("a.yml", text).unwrap_err().to_string(), message);
        check("a: [ 1,\n2", "a.yml: ends inside an array at byte 9 (line 2)");
        check("a: \"x", "a.yml: ends inside a string at byte 5 (line 1)");
        check("a: 1\n   b: 2\n", "a.yml:2: `b: 2`; expected a line as far to the right as those before");
        check("a: 1\nb\n", "a.yml:2: `b`; expected `name: value`");
        check("a: 1\na: 2\n", "a.yml:2: the key `a` is there twice");
        check("a: [ 1 ] 2\n", "a.yml:1: `2`; expected the end of the line");
        check(&format!("a: {}", "[".repeat(200)), "a.yml:1: nested more than 100 deep");
    }
}
