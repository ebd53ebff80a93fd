//! XML with line numbers: the elements, attributes and texts that calibrations are made of.
//!
//! Declarations, processing instructions and comments are skipped; `&lt;` and the other named entities and numbers are replaced. A
//! document type is refused: no calibration has one, and entities of its own can make a small file a huge one. Elements
//! nest at most [`MAX_DEPTH`] deep.

use crate::source_text::{line_at, shortened, without_mark};
use crate::{Error, Place};
use std::collections::BTreeSet;

/// Nesting allowed; calibrations need five levels.
pub(crate) const MAX_DEPTH: usize = 100;

/// An element with what it holds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Element<'a> {
    /// Name, with its prefix.
    pub(crate) name: &'a str,
    /// Line where it begins.
    pub(crate) line: usize,
    /// Elements in it.
    pub(crate) children: Vec<Element<'a>>,
    /// Text between its tags and around its elements, as it is written.
    pub(crate) text: String,
    attributes: Vec<(&'a str, &'a str)>,
}

impl<'a> Element<'a> {
    /// An attribute, with its entities replaced.
    pub(crate) fn attribute(&self, name: &str) -> Option<String> {
        self.attributes.iter().find(|(key, _)| *key == name).map(|(_, value)| unescaped(value))
    }

    /// Elements in it of some name.
    pub(crate) fn named<'s>(&'s self, name: &'s str) -> impl Iterator<Item = &'s Element<'a>> {
        self.children.iter().filter(move |child| child.name == name)
    }
}

/// A place in the text and its line.
struct Cursor<'a> {
    name: &'a str,
    text: &'a str,
    rest: &'a str,
    line: usize,
}

impl<'a> Cursor<'a> {
    fn place(&self) -> Place {
        Place::file(self.name).at_line(self.line)
    }

    fn skip(&mut self, bytes: usize) -> &'a str {
        let (skipped, rest) = self.rest.split_at_checked(bytes).unwrap_or((self.rest, ""));
        self.line += skipped.bytes().filter(|&byte| byte == b'\n').count();
        self.rest = rest;
        skipped
    }

    /// What stands before the next occurrence of a mark, which is skipped as well.
    fn until(&mut self, mark: &str, inside: &'static str) -> Result<&'a str, Error> {
        let Some(length) = self.rest.find(mark) else { return Err(self.truncated(inside)) };
        let before = self.skip(length);
        self.skip(mark.len());
        Ok(before)
    }

    fn truncated(&self, inside: &'static str) -> Error {
        let (place, offset) = (Place::file(self.name), self.text.len());
        Error::Truncated { place, inside, offset, line: Some(line_at(self.text, offset)) }
    }

    fn unexpected(&self, expected: &str) -> Error {
        let found = format!("`{}`", shortened(self.rest.lines().next().unwrap_or_default()));
        Error::Syntax { place: self.place(), found, expected: expected.into() }
    }

    /// A name of an element or attribute.
    fn word(&mut self) -> Result<&'a str, Error> {
        let is_part = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.' | ':');
        let length = self.rest.find(|c| !is_part(c)).unwrap_or(self.rest.len());
        if length == 0 {
            return Err(if self.rest.is_empty() { self.truncated("a tag") } else { self.unexpected("a name") });
        }
        Ok(self.skip(length))
    }

    fn skip_space(&mut self) {
        self.skip(self.rest.len() - self.rest.trim_start().len());
    }
}

/// The outermost element of a text.
pub(crate) fn parse<'a>(name: &'a str, text: &'a str) -> Result<Element<'a>, Error> {
    let text = without_mark(text);
    let mut cursor = Cursor { name, text, rest: text, line: 1 };
    let mut open: Vec<Element<'a>> = vec![];
    loop {
        let Some(length) = cursor.rest.find('<') else {
            return Err(if open.is_empty() && !text.contains('<') {
                cursor.unexpected("an XML element")
            } else {
                cursor.truncated("an element")
            });
        };
        let between = cursor.skip(length);
        match open.last_mut() {
            Some(parent) => parent.text.push_str(between),
            None if between.trim().is_empty() => {}
            None => {
                return Err(Error::Syntax {
                    place: cursor.place(),
                    found: format!("`{}`", shortened(between.trim())),
                    expected: "an XML element".into(),
                });
            }
        }
        let closed = if cursor.rest.starts_with("</") {
            cursor.skip(2);
            Some(end(&mut cursor, &mut open)?)
        } else if cursor.rest.starts_with("<!") || cursor.rest.starts_with("<?") {
            skip_remark(&mut cursor)?;
            None
        } else {
            cursor.skip(1);
            let (element, is_whole) = start(&mut cursor)?;
            if open.len() == MAX_DEPTH {
                return Err(Error::TooDeep { place: cursor.place(), limit: MAX_DEPTH });
            }
            open.push(element);
            if is_whole { open.pop() } else { None }
        };
        if let Some(element) = closed {
            let Some(parent) = open.last_mut() else { return Ok(element) };
            parent.children.push(element);
        }
    }
}

fn skip_remark(cursor: &mut Cursor<'_>) -> Result<(), Error> {
    if cursor.rest.starts_with("<!--") {
        cursor.until("-->", "a comment")?;
    } else if cursor.rest.starts_with("<?") {
        cursor.until("?>", "a declaration")?;
    } else {
        let what = format!("`{}` in XML", shortened(cursor.rest.split('>').next().unwrap_or_default()));
        return Err(Error::Unsupported { place: cursor.place(), what });
    }
    Ok(())
}

/// The element that a closing tag closes.
fn end<'a>(cursor: &mut Cursor<'a>, open: &mut Vec<Element<'a>>) -> Result<Element<'a>, Error> {
    let name = cursor.word()?;
    cursor.skip_space();
    let Some(element) = open.pop_if(|element| element.name == name) else {
        let expected = open.last().map_or("an element".into(), |element| format!("</{}>", element.name));
        return Err(Error::Syntax { place: cursor.place(), found: format!("`</{}>`", shortened(name)), expected });
    };
    if !cursor.rest.starts_with('>') {
        return Err(if cursor.rest.is_empty() { cursor.truncated("a tag") } else { cursor.unexpected("`>`") });
    }
    cursor.skip(1);
    Ok(element)
}

/// An element from behind its `<` to the end of the tag, and whether that closes it.
fn start<'a>(cursor: &mut Cursor<'a>) -> Result<(Element<'a>, bool), Error> {
    let line = cursor.line;
    let name = cursor.word()?;
    let mut known = BTreeSet::new();
    let mut element = Element { name, line, children: vec![], text: String::new(), attributes: vec![] };
    loop {
        cursor.skip_space();
        if cursor.rest.starts_with("/>") {
            cursor.skip(2);
            return Ok((element, true));
        }
        if cursor.rest.starts_with('>') {
            cursor.skip(1);
            return Ok((element, false));
        }
        let key = cursor.word()?;
        cursor.skip_space();
        let mut chars = cursor.rest.chars().filter(|c| !c.is_whitespace());
        let (Some('='), Some(quote @ ('"' | '\''))) = (chars.next(), chars.next()) else {
            return Err(if matches!(cursor.rest.trim(), "" | "=") {
                cursor.truncated("a tag")
            } else {
                cursor.unexpected("`=` and a value in quotes")
            });
        };
        let mark = quote.to_string();
        cursor.until(&mark, "a tag")?;
        let value = cursor.until(&mark, "an attribute")?;
        if !known.insert(key) {
            return Err(Error::DuplicateName { place: cursor.place(), what: "attribute", name: shortened(key) });
        }
        element.attributes.push((key, value));
    }
}

/// Bytes of the longest entity, with its semicolon.
const LONGEST_ENTITY: usize = 12;

/// A text with its entities replaced; what is no entity stays.
pub(crate) fn unescaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('&') {
        out.push_str(before);
        rest = after;
        let length = after.bytes().take(LONGEST_ENTITY).position(|byte| byte == b';');
        match length.and_then(|length| Some((character(after.get(..length)?)?, after.get(length + 1..)?))) {
            Some((character, after)) => {
                out.push(character);
                rest = after;
            }
            None => out.push('&'),
        }
    }
    out.push_str(rest);
    out
}

fn character(entity: &str) -> Option<char> {
    Some(match entity {
        "lt" => '<',
        "gt" => '>',
        "amp" => '&',
        "quot" => '"',
        "apos" => '\'',
        _ => {
            let number = entity.strip_prefix('#')?;
            let code = match number.strip_prefix('x') {
                Some(digits) => u32::from_str_radix(digits, 16),
                None => number.parse(),
            };
            char::from_u32(code.ok()?)?
        }
    })
}

/// A text as the value of an attribute.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push_str(&format!("&#{};", u32::from(c))),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_have_attributes_texts_and_lines() {
        let text =
            "\u{feff}<?xml version='1.0'?>\n<!-- <a> -->\n<a b = \"1 &lt; 2\"\n c='\"'>\n 1 <d/>2\n<d>x</d></a>\n";
        let root = parse("a.xml", text).unwrap();
        assert_eq!((root.name, root.line, root.text.split_whitespace().collect::<String>()), ("a", 3, "12".into()));
        assert_eq!([root.attribute("b"), root.attribute("c")], [Some("1 < 2".into()), Some("\"".into())]);
        let inner: Vec<_> = root.named("d").map(|element| (element.line, &element.text[..])).collect();
        assert_eq!(inner, [(5, ""), (6, "x")]);
    }

    #[test]
    fn faults_are_placed() {
        let check = |text: &str, message: &str| assert_eq!(parse("a.xml", text).unwrap_err().to_string(), message);
        check("<a>\n<b>", "a.xml: ends inside an element at byte 7 (line 2)");
        check("<a>\n<b", "a.xml: ends inside a tag at byte 6 (line 2)");
        check("<a b=\"1", "a.xml: ends inside an attribute at byte 7 (line 1)");
        check("<a>\n</b>", "a.xml:2: `</b>`; expected </a>");
        check("<a b=1>", "a.xml:1: `=1>`; expected `=` and a value in quotes");
        check("<a b=\"1\" b=\"2\"/>", "a.xml:1: the attribute `b` is there twice");
        check("x <a/>", "a.xml:1: `x`; expected an XML element");
        check(
            "<!DOCTYPE x [<!ENTITY a \"b\">]><x/>",
            "a.xml:1: `<!DOCTYPE x [<!ENTITY a \"b\"` in XML is not supported",
        );
        check(&"<a>".repeat(101), "a.xml:1: nested more than 100 deep");
    }

    #[test]
    fn texts_survive_escaping() {
        for text in ["", "a <\"&\"> 'b'", "\n\t\u{1}é", "&amp;&"] {
            assert_eq!(unescaped(&escaped(text)), text);
        }
        assert_eq!(unescaped("&#x41;&#66;&unknown;& &#xFFFFFFFF;"), "AB&unknown;& &#xFFFFFFFF;");
    }
}
