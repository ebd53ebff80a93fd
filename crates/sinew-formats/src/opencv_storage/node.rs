//! A value of a file of OpenCV: a text, a list or a map, with its line.

use crate::source_text::finite;
use crate::{Error, Place};

/// A value of a file. Two are equal wherever they stand.
#[derive(Clone, Debug)]
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

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
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
                None => Err(place().lacks("data")),
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
