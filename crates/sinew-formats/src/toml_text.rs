//! TOML with line numbers: a view on a parsed document whose failed requests name file, line and table.
//!
//! Our own files name the keys they allow and get the nearest one suggested for any other; files of other programs are
//! read leniently.

use crate::nearest::nearest;
use crate::source_text::{line_at, shortened, truncated, without_mark};
use crate::{Error, Place};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A parsed file.
pub(crate) struct Document<'a> {
    name: &'a str,
    text: &'a str,
    table: Spanned<DeTable<'a>>,
}

/// A table of a document.
#[derive(Clone, Copy)]
pub(crate) struct Table<'a> {
    name: &'a str,
    text: &'a str,
    offset: usize,
    table: &'a DeTable<'a>,
    within: Option<&'a str>,
}

/// A value of a document.
#[derive(Clone, Copy)]
pub(crate) struct Value<'a> {
    table: Table<'a>,
    key: &'a str,
    value: &'a Spanned<DeValue<'a>>,
}

impl<'a> Document<'a> {
    /// Parses a file; nesting is limited by the TOML parser.
    pub(crate) fn parse(name: &'a str, text: &'a str) -> Result<Self, Error> {
        let text = without_mark(text);
        match DeTable::parse(text) {
            Ok(table) => Ok(Self { name, text, table }),
            Err(error) => Err(grammar_error(name, text, &error)),
        }
    }

    pub(crate) fn root(&'a self) -> Table<'a> {
        Table { name: self.name, text: self.text, offset: 0, table: self.table.get_ref(), within: None }
    }
}

fn grammar_error(name: &str, text: &str, error: &toml::de::Error) -> Error {
    let span = error.span().unwrap_or(0..0);
    let rest = text.get(span.start..).unwrap_or_default();
    if rest.trim_start().is_empty() && !text.trim().is_empty() {
        let inside = if error.message().contains("string") { "a string" } else { open_bracket(text) };
        return truncated(name, text, inside);
    }
    let place = Place::file(name).at_line(line_at(text, span.start));
    if error.message().contains("duplicate key") {
        let name = text.get(span).unwrap_or_default();
        return place.twice("key", shortened(name.trim()));
    }
    place.syntax(
        format!("`{}`", shortened(rest.lines().next().unwrap_or_default())),
        format!("valid TOML ({})", error.message()),
    )
}

fn open_bracket(text: &str) -> &'static str {
    let count = |c| text.matches(c).count();
    if count('[') > count(']') {
        "an array"
    } else if count('{') > count('}') {
        "an inline table"
    } else {
        "a value"
    }
}

impl<'a> Table<'a> {
    /// The same table under a name that messages show.
    pub(crate) fn within(self, name: &'a str) -> Self {
        Self { within: Some(name), ..self }
    }

    /// Where the table stands.
    pub(crate) fn place(&self) -> Place {
        self.place_at(self.offset)
    }

    fn place_at(&self, offset: usize) -> Place {
        let place = Place::file(self.name).at_line(line_at(self.text, offset));
        match self.within {
            Some(within) => place.within(within),
            None => place,
        }
    }

    /// Refuses keys other than these.
    pub(crate) fn allow(&self, known: &[&str]) -> Result<(), Error> {
        let unknown = self.table.iter().filter(|(key, _)| !known.contains(&key.get_ref().as_ref()));
        let first = unknown.min_by_key(|(key, _)| key.span().start);
        let Some((key, _)) = first else { return Ok(()) };
        let name = key.get_ref().as_ref();
        let nearest = nearest(name, known.iter().copied()).map(Into::into);
        Err(Error::UnknownKey { place: self.place_at(key.span().start), key: shortened(name), nearest })
    }

    /// Keys with their tables, in the order of the file; values that are no tables are left out.
    pub(crate) fn tables(&self) -> Vec<(&'a str, Table<'a>)> {
        let mut found: Vec<_> = self
            .table
            .iter()
            .filter_map(|(key, value)| {
                let table = value.get_ref().as_table()?;
                let offset = key.span().start;
                Some((key.get_ref().as_ref(), Table { offset, table, within: None, ..*self }))
            })
            .collect();
        found.sort_by_key(|(_, table)| table.offset);
        found
    }

    /// Keys with their values, in the order of the file.
    pub(crate) fn values(&self) -> Vec<(&'a str, Value<'a>)> {
        let mut found: Vec<_> = self.table.iter().collect();
        found.sort_by_key(|(key, _)| key.span().start);
        let with_name = |(key, value): (&'a Spanned<_>, &'a Spanned<DeValue<'a>>)| {
            let key = AsRef::<str>::as_ref(key.get_ref());
            (key, Value { table: *self, key, value })
        };
        found.into_iter().map(with_name).collect()
    }

    pub(crate) fn get(&self, key: &'a str) -> Option<Value<'a>> {
        self.table.get(key).map(|value| Value { table: *self, key, value })
    }

    pub(crate) fn require(&self, key: &'a str) -> Result<Value<'a>, Error> {
        self.get(key).ok_or_else(|| self.place().lacks(key))
    }

    pub(crate) fn string(&self, key: &'a str) -> Result<String, Error> {
        self.require(key)?.string()
    }

    pub(crate) fn optional_string(&self, key: &'a str) -> Result<Option<String>, Error> {
        self.get(key).map(|value| value.string()).transpose()
    }

    /// Array of strings.
    pub(crate) fn strings(&self, key: &'a str) -> Result<Vec<String>, Error> {
        self.require(key)?.items()?.iter().map(Value::string).collect()
    }

    /// Array of exactly `N` finite numbers.
    pub(crate) fn numbers<const N: usize>(&self, key: &'a str) -> Result<[f64; N], Error> {
        self.require(key)?.numbers()
    }

    /// Array of tables; a missing one is empty.
    pub(crate) fn array_of_tables(&self, key: &'a str) -> Result<Vec<Table<'a>>, Error> {
        let Some(value) = self.get(key) else { return Ok(Vec::new()) };
        value.items()?.iter().map(Value::as_table).collect()
    }
}

impl<'a> Value<'a> {
    /// Where the value stands.
    pub(crate) fn place(&self) -> Place {
        self.table.place_at(self.value.span().start)
    }

    /// The value as it is written, shortened.
    pub(crate) fn source(&self) -> String {
        shortened(self.table.text.get(self.value.span()).unwrap_or_default())
    }

    /// An error about this value.
    pub(crate) fn must_be(&self, expected: impl Into<String>) -> Error {
        self.place().bad_value(self.key, self.source(), expected)
    }

    pub(crate) fn as_table(&self) -> Result<Table<'a>, Error> {
        let table = self.value.get_ref().as_table().ok_or_else(|| self.must_be("a table"))?;
        Ok(Table { offset: self.value.span().start, table, within: None, ..self.table })
    }

    pub(crate) fn string(&self) -> Result<String, Error> {
        self.value.get_ref().as_str().map(Into::into).ok_or_else(|| self.must_be("a string"))
    }

    pub(crate) fn bool(&self) -> Result<bool, Error> {
        self.value.get_ref().as_bool().ok_or_else(|| self.must_be("true or false"))
    }

    pub(crate) fn items(&self) -> Result<Vec<Value<'a>>, Error> {
        let array = self.value.get_ref().as_array().ok_or_else(|| self.must_be("an array"))?;
        Ok(array.iter().map(|value| Value { value, ..*self }).collect())
    }

    /// A finite number, written as float or integer.
    pub(crate) fn number(&self) -> Result<f64, Error> {
        let value = match self.value.get_ref() {
            DeValue::Float(float) => float.as_str().parse::<f64>().ok(),
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse::<f64>().ok(),
            _ => None,
        };
        match value {
            Some(value) if value.is_finite() => Ok(value),
            Some(_) => {
                let place = self.place();
                let line = place.line.unwrap_or(1);
                Err(Error::OutOfRange { place: Place { line: None, ..place }, line })
            }
            None => Err(self.must_be("a number")),
        }
    }

    /// An array of exactly `N` finite numbers.
    pub(crate) fn numbers<const N: usize>(&self) -> Result<[f64; N], Error> {
        let items = self.items()?;
        let values = items.iter().map(Value::number).collect::<Result<Vec<f64>, Error>>()?;
        <[f64; N]>::try_from(values).map_err(|_| self.must_be(format!("an array of {N} numbers")))
    }
}

/// A string as a TOML basic string.
pub(crate) fn quoted(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            c if c.is_control() => out.push_str(&format!("\\u{:04X}", u32::from(c))),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// A string as a TOML key: bare where that is allowed.
pub(crate) fn key(text: &str) -> String {
    let bare = !text.is_empty() && text.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-');
    if bare { text.to_owned() } else { quoted(text) }
}

/// Numbers as a TOML array; they read back equal.
pub(crate) fn array(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
    format!("[{}]", values.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, read: impl Fn(Table<'_>) -> Result<(), Error>, message: &str) {
        let result = Document::parse("a.toml", text).and_then(|document| read(document.root()));
        assert_eq!(result.unwrap_err().to_string(), message, "{text}");
    }

    #[test]
    fn faults_are_placed() {
        let nothing = |_: Table<'_>| Ok(());
        check("a = 1\nb = [1, 2", nothing, "a.toml: ends inside an array at byte 15 (line 2)");
        check("a = 1\na = 2", nothing, "a.toml:2: the key `a` is there twice");
        check("a = nan\nb = [1,\n1e999]", |t| t.numbers::<2>("b").map(drop), "a.toml: value out of range at line 3");
        check("a = 'x'", |t| t.require("a")?.number().map(drop), "a.toml:1: a = 'x'; must be a number");
        check(
            "[t]\na = [1]",
            |t| t.tables()[0].1.within("t").numbers::<2>("a").map(drop),
            "a.toml:2 (t): a = [1]; must be an array of 2 numbers",
        );
        check(
            "paticles = 1",
            |t| t.allow(&["frames", "particles"]),
            "a.toml:1: unknown key `paticles`; did you mean `particles`?",
        );
    }

    #[test]
    fn strings_survive_quoting() {
        for text in ["", "a b", "\"\\\n\u{1}\u{7f}é", "[x]"] {
            let written = format!("{} = {}", key(text), quoted(text));
            let document = Document::parse("a.toml", &written).unwrap();
            assert!(document.root().strings("no such key").is_err());
            assert_eq!(document.root().get(text).unwrap().string().unwrap(), text);
        }
    }
}
