//! XML: read by `roxmltree`, with the line of every element, and texts escaped for what is written.
//!
//! A document type is refused: no calibration has one, and entities of its own can make a small file a huge one.

use crate::source_text::{malformed, truncated, without_mark};
use crate::{Error, Place};
use roxmltree::{Document, Node};

/// A document.
pub(crate) struct Xml<'a> {
    document: Document<'a>,
    /// Bytes where its lines end.
    line_ends: Vec<usize>,
}

/// An element with what it holds.
#[derive(Clone, Copy)]
pub(crate) struct Element<'x> {
    node: Node<'x, 'x>,
    line_ends: &'x [usize],
}

impl<'a> Xml<'a> {
    pub(crate) fn parse(name: &str, text: &'a str) -> Result<Self, Error> {
        let text = without_mark(text);
        let document = Document::parse(text).map_err(|error| match error {
            roxmltree::Error::UnclosedRootNode | roxmltree::Error::UnexpectedEndOfStream => {
                truncated(name, text, "an element")
            }
            roxmltree::Error::DtdDetected => {
                Error::Unsupported { place: Place::file(name), what: "a document type in XML".into() }
            }
            error => {
                let at = error.pos();
                malformed(name, text, [at.row as usize, at.col as usize - 1], &format!("valid XML ({error})"))
            }
        })?;
        Ok(Self { document, line_ends: text.match_indices('\n').map(|(at, _)| at).collect() })
    }

    /// The outermost element.
    pub(crate) fn root(&self) -> Element<'_> {
        Element { node: self.document.root_element(), line_ends: &self.line_ends }
    }
}

impl<'x> Element<'x> {
    /// Name, without its prefix.
    pub(crate) fn name(&self) -> &'x str {
        self.node.tag_name().name()
    }

    /// Line where it begins.
    pub(crate) fn line(&self) -> usize {
        1 + self.line_ends.partition_point(|&end| end < self.node.range().start)
    }

    pub(crate) fn attribute(&self, name: &str) -> Option<&'x str> {
        self.node.attribute(name)
    }

    /// Elements in it.
    pub(crate) fn children(self) -> impl Iterator<Item = Self> {
        self.node.children().filter(Node::is_element).map(move |node| Self { node, ..self })
    }

    /// Elements in it of some name.
    pub(crate) fn named(self, name: &str) -> impl Iterator<Item = Self> {
        self.children().filter(move |child| child.name() == name)
    }

    /// It and all elements in it, in the order of the file.
    pub(crate) fn descendants(self) -> impl Iterator<Item = Self> {
        self.node.descendants().filter(Node::is_element).map(move |node| Self { node, ..self })
    }

    /// Text between its tags and around its elements, as it is written.
    pub(crate) fn written_text(&self) -> String {
        let document = self.node.document().input_text();
        self.node.children().filter(Node::is_text).filter_map(|text| document.get(text.range())).collect()
    }
}

/// A text with its entities replaced; one with entities that do not exist stays as it is.
pub(crate) fn unescaped(text: &str) -> String {
    let element = format!("<_>{text}</_>");
    let read = Document::parse(&element).ok();
    read.and_then(|read| Some(read.root_element().text()?.to_owned())).unwrap_or_else(|| text.to_owned())
}

/// A text as it stands in an element of XML or HTML, or in an attribute.
#[must_use]
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c if c.is_control() && !matches!(c, '\n' | '\t') => out.push_str(&format!("&#{};", u32::from(c))),
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
        let text = "\u{feff}<?xml version='1.0'?>\n<!-- <a> -->\n<a b = \"1 &lt; 2\"\n c='\"'>\n 1 <d/>2\n<d>x &amp;</d></a>\n";
        let xml = Xml::parse("a.xml", text).unwrap();
        let root = xml.root();
        let words: String = root.written_text().split_whitespace().collect();
        assert_eq!((root.name(), root.line(), &words[..]), ("a", 3, "12"));
        assert_eq!([root.attribute("b"), root.attribute("c")], [Some("1 < 2"), Some("\"")]);
        let inner: Vec<_> = root.named("d").map(|element| (element.line(), element.written_text())).collect();
        assert_eq!(inner, [(5, String::new()), (6, "x &amp;".into())]);
        assert_eq!(root.descendants().map(|element| element.name()).collect::<String>(), "add");
    }

    #[test]
    fn faults_are_placed() {
        let check = |text: &str, message: &str| {
            assert_eq!(Xml::parse("a.xml", text).err().unwrap().to_string(), message);
        };
        check("<a>\n<b>", "a.xml: ends inside an element at byte 7 (line 2)");
        check("<a>\n<b", "a.xml: ends inside an element at byte 6 (line 2)");
        check("<a b=\"1", "a.xml: ends inside an element at byte 7 (line 1)");
        check("<a>\n</b>", "a.xml:2: `</b>`; expected valid XML (expected 'a' tag, not 'b' at 2:1)");
        check("<!DOCTYPE x [<!ENTITY a \"b\">]><x/>", "a.xml: a document type in XML is not supported");
    }

    #[test]
    fn texts_survive_escaping() {
        for text in ["", "a <\"&\"> 'b'", "\n\té", "&amp;&"] {
            assert_eq!(unescaped(&escaped(text)), text);
        }
        assert_eq!(unescaped("&#x41;&#66; é"), "AB é");
        assert_eq!(unescaped("&unknown; &"), "&unknown; &");
    }
}
