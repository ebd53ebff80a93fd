//! JSON from other programs: where it ends too early, how deep it nests, and Python's `NaN`.
//!
//! One scan over the text comes first. It refuses deep nesting before anything is built and knows which bracket is open
//! where a truncated file ends. `NaN` outside strings, which Python writes and JSON forbids, is read as `null`;
//! `Infinity` and numbers like `1e999` are errors.

use crate::source_text::{line_at, shortened, truncated, without_mark};
use crate::{Error, Place, frame_number};
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::borrow::Cow;

/// Nesting allowed; detectors need five levels.
pub const MAX_DEPTH: usize = 100;

/// Parses JSON text into a value.
///
/// # Errors
/// [`Error::Truncated`], [`Error::TooDeep`], [`Error::OutOfRange`] or [`Error::Syntax`], with the line.
pub fn parse<T: DeserializeOwned>(name: &str, text: &str) -> Result<T, Error> {
    let text = without_mark(text);
    let scan = scan(name, text)?;
    let json = if scan.nan.is_empty() { Cow::Borrowed(text) } else { Cow::Owned(nan_as_null(text, &scan.nan)) };
    serde_json::from_str(&json).map_err(|error| {
        if error.is_eof() || (scan.open != NOTHING && is_at_end(&json, &error)) {
            return truncated(name, text, scan.open);
        }
        let place = Place::file(name);
        let line = error.line();
        let message = error.to_string();
        let what = message.rsplit_once(" at line ").map_or(message.as_str(), |(what, _)| what);
        match scan.infinity {
            Some(infinity) if infinity <= line => Error::OutOfRange { place, line: infinity },
            _ if what == "number out of range" => Error::OutOfRange { place, line },
            _ => place.at_line(line).syntax(shortened(what), "JSON of this kind"),
        }
    })
}

/// A frame's number, which may be a name that ends with it; pandas writes whole numbers as `3.0`.
pub(crate) fn frame_number_of(value: &Value) -> Option<u64> {
    /// Below this every whole number is one of floating point.
    const EXACT: f64 = 9e15;
    let whole = |number: f64| ((0.0..EXACT).contains(&number) && number.fract() == 0.0).then_some(number as u64);
    match value {
        Value::Number(number) => number.as_u64().or_else(|| whole(number.as_f64()?)),
        Value::String(name) => frame_number::parse(name),
        _ => None,
    }
}

/// Whether an error is about the last bytes of a text: a number or literal that is cut, like `-` or `Na`.
fn is_at_end(text: &str, error: &serde_json::Error) -> bool {
    let last_line = text.rsplit('\n').next().unwrap_or_default();
    error.line() == line_at(text, text.len()) && error.column() + 3 > last_line.len()
}

/// What is open at the end of a text whose brackets are closed.
const NOTHING: &str = "a value";

struct Scan {
    open: &'static str,
    nan: Vec<usize>,
    infinity: Option<usize>,
}

fn scan(name: &str, text: &str) -> Result<Scan, Error> {
    let mut stack = Vec::new();
    let mut nan = Vec::new();
    let mut infinity = None;
    let (mut in_string, mut escaped) = (false, false);
    for (offset, byte) in text.bytes().enumerate() {
        if in_string {
            match byte {
                _ if escaped => escaped = false,
                b'\\' => escaped = true,
                b'"' => in_string = false,
                _ => {}
            }
            continue;
        }
        match byte {
            b'"' => in_string = true,
            b'[' | b'{' => {
                if stack.len() == MAX_DEPTH {
                    return Err(Error::TooDeep {
                        place: Place::file(name).at_line(line_at(text, offset)),
                        limit: MAX_DEPTH,
                    });
                }
                stack.push(if byte == b'[' { "an array" } else { "an object" });
            }
            b']' | b'}' => {
                stack.pop();
            }
            b'N' if text.as_bytes().get(offset..offset + 3) == Some(b"NaN") => nan.push(offset),
            b'I' if infinity.is_none() => infinity = Some(line_at(text, offset)),
            _ => {}
        }
    }
    let open = if in_string { "a string" } else { stack.last().copied().unwrap_or(NOTHING) };
    Ok(Scan { open, nan, infinity })
}

fn nan_as_null(text: &str, places: &[usize]) -> String {
    let mut out = String::with_capacity(text.len() + places.len());
    let mut done = 0;
    for &place in places {
        out.push_str(text.get(done..place).unwrap_or_default());
        if out.ends_with('-') {
            out.pop();
        }
        out.push_str("null");
        done = place + 3;
    }
    out.push_str(text.get(done..).unwrap_or_default());
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, message: &str) {
        assert_eq!(parse::<Vec<f64>>("a.json", text).unwrap_err().to_string(), message, "{text}");
    }

    #[test]
    fn the_place_of_every_fault_is_named() {
        check("[1, 2,\n3,", "a.json: ends inside an array at byte 9 (line 2)");
        check("", "a.json: ends inside a value at byte 0 (line 1)");
        check("[\"abc", "a.json: ends inside a string at byte 5 (line 1)");
        check("[1, x]", "a.json:1: expected value; expected JSON of this kind");
    }

    #[test]
    fn numbers_out_of_range_are_refused_and_nan_is_null() {
        check("[1,\n2,\n1e999]", "a.json: value out of range at line 3");
        check("[1,\n-Infinity]", "a.json: value out of range at line 2");
        let read: Vec<Option<f64>> = parse("a.json", "[NaN, 1.5, -NaN]").unwrap();
        assert_eq!(read, [None, Some(1.5), None]);
    }

    #[test]
    fn deep_nesting_is_refused() {
        check(&"[".repeat(100_000), "a.json:1: nested more than 100 deep");
    }
}
