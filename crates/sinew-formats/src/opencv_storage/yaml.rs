//! The YAML that OpenCV writes, as a tree of nodes.

use super::node::{Node, Value};
use crate::source_text::{line_at, shortened, without_mark};
use crate::{Error, Place};
use std::collections::BTreeMap;

/// Nesting allowed; calibrations need four levels.
const MAX_DEPTH: usize = 100;

/// A line that is neither blank nor a comment.
#[derive(Clone, Copy)]
struct Line<'a> {
    number: usize,
    indent: usize,
    /// From its first character on, without the end of the line.
    text: &'a str,
    /// Where that stands in the file.
    start: usize,
}

/// Lines still to be read.
struct Reader<'a> {
    name: &'a str,
    text: &'a str,
    lines: Vec<Line<'a>>,
    at: usize,
}

/// Parses a file into its outermost map or list.
pub(super) fn parse(name: &str, text: &str) -> Result<Node, Error> {
    let text = without_mark(text);
    let mut start = 0;
    let mut lines = vec![];
    for (index, line) in text.split_inclusive('\n').enumerate() {
        let content = line.trim_start_matches(' ');
        let indent = line.len() - content.len();
        let shown = content.trim_end();
        if !shown.is_empty() && !shown.starts_with(['#', '%']) && !matches!(shown, "---" | "...") {
            lines.push(Line { number: index + 1, indent, text: shown, start: start + indent });
        }
        start += line.len();
    }
    let mut reader = Reader { name, text, lines, at: 0 };
    let Some(first) = reader.peek() else {
        return Ok(Node { line: 1, value: Value::Map(vec![]) });
    };
    let node = reader.block(first.indent, 0)?;
    match reader.peek() {
        Some(line) => Err(reader.unexpected(line, "a line as far to the right as those before")),
        None => Ok(node),
    }
}

impl<'a> Reader<'a> {
    fn peek(&self) -> Option<Line<'a>> {
        self.lines.get(self.at).copied()
    }

    fn place(&self, line: usize) -> Place {
        Place::file(self.name).at_line(line)
    }

    fn unexpected(&self, line: Line<'_>, expected: &str) -> Error {
        let found = format!("`{}`", shortened(line.text));
        Error::Syntax { place: self.place(line.number), found, expected: expected.into() }
    }

    fn truncated(&self, inside: &'static str) -> Error {
        let offset = self.text.len();
        Error::Truncated { place: Place::file(self.name), inside, offset, line: Some(line_at(self.text, offset)) }
    }

    fn check_depth(&self, depth: usize, line: usize) -> Result<(), Error> {
        if depth < MAX_DEPTH { Ok(()) } else { Err(Error::TooDeep { place: self.place(line), limit: MAX_DEPTH }) }
    }

    /// The map or list whose lines begin in some column.
    fn block(&mut self, indent: usize, depth: usize) -> Result<Node, Error> {
        let Some(first) = self.peek() else { return Err(self.truncated("a map")) };
        self.check_depth(depth, first.number)?;
        let value = if is_item(first.text) {
            Value::List(self.items(indent, depth)?)
        } else {
            Value::Map(self.entries(indent, depth)?)
        };
        Ok(Node { line: first.number, value })
    }

    fn items(&mut self, indent: usize, depth: usize) -> Result<Vec<Node>, Error> {
        let mut items = vec![];
        while let Some(line) = self.peek().filter(|line| line.indent == indent && is_item(line.text)) {
            let content = line.text.get(1..).unwrap_or_default().trim_start();
            let shift = line.text.len() - content.len();
            // What follows the dash is a line of its own, farther to the right.
            let inner = Line { indent: indent + shift, text: content, start: line.start + shift, ..line };
            if content.is_empty() {
                self.at += 1;
                items.push(self.nested(indent + 1, line.number, depth)?);
            } else if is_item(content) || key_of(content).is_some() {
                if let Some(own) = self.lines.get_mut(self.at) {
                    *own = inner;
                }
                items.push(self.block(inner.indent, depth + 1)?);
            } else {
                items.push(self.inline(inner, depth)?);
            }
        }
        Ok(items)
    }

    fn entries(&mut self, indent: usize, depth: usize) -> Result<Vec<(String, Node)>, Error> {
        let mut entries: Vec<(String, Node)> = vec![];
        let mut known = BTreeMap::new();
        while let Some(line) = self.peek().filter(|line| line.indent == indent && !is_item(line.text)) {
            let Some((key, after)) = key_of(line.text) else { return Err(self.unexpected(line, "`name: value`")) };
            let content = without_tag(after);
            let shift = line.text.len() - content.len();
            let node = if content.is_empty() || content.starts_with('#') {
                self.at += 1;
                // Lists may stand as far to the left as the name.
                let is_list = self.peek().is_some_and(|next| next.indent == indent && is_item(next.text));
                self.nested(if is_list { indent } else { indent + 1 }, line.number, depth)?
            } else {
                self.inline(Line { text: content, start: line.start + shift, ..line }, depth)?
            };
            // Two files in one may both say the same.
            let first = known.get(&key).and_then(|&first: &usize| entries.get(first));
            if first.is_some_and(|(_, first)| *first != node) {
                let name = shortened(&key);
                return Err(Error::DuplicateName { place: self.place(line.number), what: "key", name });
            }
            if first.is_none() {
                known.insert(key.clone(), entries.len());
                entries.push((key, node));
            }
        }
        Ok(entries)
    }

    /// The lines that stand at least that far to the right; an empty text where there are none.
    fn nested(&mut self, least: usize, line: usize, depth: usize) -> Result<Node, Error> {
        match self.peek().filter(|next| next.indent >= least) {
            Some(next) => self.block(next.indent, depth + 1),
            None => Ok(Node { line, value: Value::Scalar(String::new()) }),
        }
    }

    /// A value that begins in a line: a text, or brackets that may end in a later line.
    fn inline(&mut self, line: Line<'a>, depth: usize) -> Result<Node, Error> {
        if !line.text.starts_with(['[', '{', '"', '\'']) {
            self.at += 1;
            return Ok(Node { line: line.number, value: Value::Scalar(plain(line.text).to_owned()) });
        }
        let rest = self.text.get(line.start..).unwrap_or_default();
        let mut flow = Flow { reader: self, rest, line: line.number };
        let node = flow.value(depth + 1)?;
        let (rest, end) = (flow.rest, flow.line);
        let after = rest.lines().next().unwrap_or_default().trim();
        if !after.is_empty() && !after.starts_with('#') {
            let found = format!("`{}`", shortened(after));
            return Err(Error::Syntax { place: self.place(end), found, expected: "the end of the line".into() });
        }
        while self.peek().is_some_and(|line| line.number <= end) {
            self.at += 1;
        }
        Ok(node)
    }
}

fn is_item(text: &str) -> bool {
    text == "-" || text.starts_with("- ")
}

/// The name that a line begins with, and what follows its colon.
fn key_of(text: &str) -> Option<(String, &str)> {
    let (key, after) = match text.strip_prefix('"') {
        Some(quoted) => {
            let (key, after) = quoted.split_once('"')?;
            (key, after.trim_start().strip_prefix(':')?)
        }
        None if text.starts_with(['[', '{', '\'', '#']) => return None,
        None => text.split_once(": ").or_else(|| Some((text.strip_suffix(':')?, "")))?,
    };
    Some((key.trim().to_owned(), after.trim_start()))
}

/// What follows a tag like `!!opencv-matrix`.
fn without_tag(text: &str) -> &str {
    if !text.starts_with('!') {
        return text;
    }
    text.find(' ').and_then(|end| text.get(end..)).unwrap_or_default().trim_start()
}

/// A text without quotes, up to a comment.
fn plain(text: &str) -> &str {
    text.split(" #").next().unwrap_or_default().trim()
}

/// Values in brackets and quotes.
struct Flow<'r, 'a> {
    reader: &'r Reader<'a>,
    rest: &'a str,
    line: usize,
}

impl Flow<'_, '_> {
    fn skip(&mut self, bytes: usize) {
        let (skipped, rest) = self.rest.split_at_checked(bytes).unwrap_or((self.rest, ""));
        self.line += skipped.bytes().filter(|&byte| byte == b'\n').count();
        self.rest = rest;
    }

    fn skip_space(&mut self) {
        self.skip(self.rest.len() - self.rest.trim_start().len());
    }

    fn take(&mut self, mark: char) -> bool {
        self.skip_space();
        let is_there = self.rest.starts_with(mark);
        if is_there {
            self.skip(mark.len_utf8());
        }
        is_there
    }

    fn value(&mut self, depth: usize) -> Result<Node, Error> {
        self.reader.check_depth(depth, self.line)?;
        self.skip_space();
        let line = self.line;
        let value = if self.take('[') {
            Value::List(self.list(depth)?)
        } else if self.take('{') {
            Value::Map(self.map(depth)?)
        } else {
            Value::Scalar(self.scalar()?)
        };
        Ok(Node { line, value })
    }

    fn list(&mut self, depth: usize) -> Result<Vec<Node>, Error> {
        let mut items = vec![];
        while !self.take(']') {
            items.push(self.value(depth + 1)?);
            if !self.take(',') && !self.rest.starts_with(']') {
                return Err(self.unexpected("an array", "`,` or `]`"));
            }
        }
        Ok(items)
    }

    fn map(&mut self, depth: usize) -> Result<Vec<(String, Node)>, Error> {
        let mut entries = vec![];
        while !self.take('}') {
            let key = self.scalar()?;
            if !self.take(':') {
                return Err(self.unexpected("a map", "`:`"));
            }
            entries.push((key, self.value(depth + 1)?));
            if !self.take(',') && !self.rest.starts_with('}') {
                return Err(self.unexpected("a map", "`,` or `}`"));
            }
        }
        Ok(entries)
    }

    fn unexpected(&self, inside: &'static str, expected: &str) -> Error {
        if self.rest.is_empty() {
            return self.reader.truncated(inside);
        }
        let found = format!("`{}`", shortened(self.rest.lines().next().unwrap_or_default()));
        Error::Syntax { place: self.reader.place(self.line), found, expected: expected.into() }
    }

    fn scalar(&mut self) -> Result<String, Error> {
        self.skip_space();
        let Some(quote) = self.rest.chars().next().filter(|c| matches!(c, '"' | '\'')) else {
            let length = self.rest.find([',', ']', '}', ':', '\n']).unwrap_or(self.rest.len());
            let text = self.rest.get(..length).unwrap_or_default().trim();
            if text.is_empty() {
                return Err(self.unexpected("an array", "a value"));
            }
            self.skip(length);
            return Ok(text.to_owned());
        };
        let mut text = String::new();
        let mut chars = self.rest.char_indices().skip(1);
        while let Some((at, c)) = chars.next() {
            match c {
                _ if c == quote => {
                    self.skip(at + 1);
                    return Ok(text);
                }
                '\\' if quote == '"' => match chars.next() {
                    Some((_, 'n')) => text.push('\n'),
                    Some((_, 't')) => text.push('\t'),
                    Some((_, 'r')) => text.push('\r'),
                    Some((_, c)) => text.push(c),
                    None => break,
                },
                c => text.push(c),
            }
        }
        Err(self.reader.truncated("a string"))
    }
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
