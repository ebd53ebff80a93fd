//! From the bytes of a file to its text.
//!
//! A byte-order mark is dropped, CRLF stays (every reader of this crate takes it), anything that is not UTF-8 is refused
//! with its byte and line, and a file larger than its kind should be is refused before it is looked at. Whoever opens the
//! file should check [`check_size`] first, so that no memory is taken for a wrong file.
//!
//! ```
//! use sinew_formats::source_text::{decode, MAX_TEXT_BYTES};
//! assert_eq!(decode("notes.txt", b"\xEF\xBB\xBFhello\r\n", MAX_TEXT_BYTES)?, "hello\r\n");
//! let error = decode("notes.txt", b"caf\xE9", MAX_TEXT_BYTES).unwrap_err();
//! assert_eq!(error.to_string(), "notes.txt: byte 0xE9 at line 1 is not UTF-8; save as UTF-8");
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::{Error, Place};

/// Largest keypoint file (one frame) that is read: a hundred people with hands and faces take half a megabyte. Parsed, a file is up to twelve times as large.
pub const MAX_KEYPOINT_BYTES: u64 = 16 << 20;

/// Largest calibration, body or layout file that is read.
pub const MAX_CONFIG_BYTES: u64 = 16 << 20;

/// Largest motion file (TRC, C3D, MOT, BVH, AMC, CSV) that is read.
pub const MAX_TEXT_BYTES: u64 = 2 << 30;

/// Refuses a file by its size alone.
///
/// # Errors
/// [`Error::TooLarge`] above the limit.
pub fn check_size(name: &str, bytes: u64, limit: u64) -> Result<(), Error> {
    if bytes <= limit { Ok(()) } else { Err(Error::TooLarge { place: Place::file(name), bytes, limit }) }
}

/// The text of a file, without byte-order mark.
///
/// # Errors
/// [`Error::TooLarge`] above the limit, [`Error::NotUtf8`] at the first byte that is not UTF-8.
pub fn decode<'a>(name: &str, bytes: &'a [u8], limit: u64) -> Result<&'a str, Error> {
    check_size(name, bytes.len() as u64, limit)?;
    let body = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    std::str::from_utf8(body).map_err(|error| {
        let valid = error.valid_up_to();
        let line = 1 + body.iter().take(valid).filter(|&&b| b == b'\n').count();
        let byte = body.get(valid).copied().unwrap_or_default();
        Error::NotUtf8 { place: Place::file(name), byte, line, offset: valid + bytes.len() - body.len() }
    })
}

/// Text without a byte-order mark, for readers that were handed a `str`.
pub(crate) fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// Line of a byte offset, counted from 1.
pub(crate) fn line_at(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|&b| b == b'\n').count()
}

/// The error of a text that ends too early.
pub(crate) fn truncated(name: &str, text: &str, inside: &'static str) -> Error {
    truncated_in_line(name, text, inside, line_at(text, text.len()))
}

/// The same for what began in an earlier line.
pub(crate) fn truncated_in_line(name: &str, text: &str, inside: &'static str, line: usize) -> Error {
    Error::Truncated { place: Place::file(name), inside, offset: text.len(), line: Some(line) }
}

/// The error of a text that breaks a grammar in a line, counted from 1, behind that many characters of it, or behind the
/// lines before where nothing is left.
pub(crate) fn malformed(name: &str, text: &str, [line, before]: [usize; 2], expected: &str) -> Error {
    let here: String = text.lines().nth(line.saturating_sub(1)).unwrap_or_default().chars().skip(before).collect();
    let earlier = || text.lines().enumerate().take(line).filter(|(_, text)| !text.trim().is_empty()).last();
    let (line, found) = match here.trim() {
        "" => earlier().map_or((line, ""), |(index, text)| (index + 1, text.trim())),
        here => (line, here),
    };
    Place::file(name).at_line(line).syntax(format!("`{}`", shortened(found)), expected)
}

/// Lines with their numbers from 1, without line ends.
pub(crate) fn numbered_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    without_mark(text).lines().enumerate().map(|(i, line)| (i + 1, line.trim_end_matches('\r')))
}

/// Refuses a count in a header that needs more bytes than the file has.
pub(crate) fn check_claim(name: &str, claimed: u64, unit: &'static str, text: &str) -> Result<(), Error> {
    let bytes = text.len() as u64;
    if claimed <= bytes {
        Ok(())
    } else {
        Err(Error::ImpossibleCount { place: Place::file(name), claimed, unit, bytes })
    }
}

/// A finite number; a comma for the point, NaN and infinities are refused.
pub(crate) fn finite(place: impl FnOnce() -> Place, cell: &str) -> Result<f64, Error> {
    match cell.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(_) => {
            let place = place();
            let line = place.line.unwrap_or(1);
            Err(Error::OutOfRange { place: Place { line: None, ..place }, line })
        }
        Err(_) if has_decimal_comma(cell) => Err(Error::DecimalComma { place: place(), found: shortened(cell) }),
        Err(_) => Err(place().syntax(format!("`{}`", shortened(cell)), "a number")),
    }
}

/// A number or, for an empty cell and any spelling of NaN, `None`.
pub(crate) fn finite_or_missing(place: impl FnOnce() -> Place, cell: &str) -> Result<Option<f64>, Error> {
    if is_missing(cell) { Ok(None) } else { finite(place, cell).map(Some) }
}

fn is_missing(cell: &str) -> bool {
    let cell = cell.strip_prefix(['-', '+']).unwrap_or(cell);
    cell.is_empty() || ["nan", "nan(ind)", "1.#ind", "1.#qnan"].iter().any(|name| cell.eq_ignore_ascii_case(name))
}

/// Whether a text is a number but for its decimal comma.
pub(crate) fn has_decimal_comma(cell: &str) -> bool {
    cell.matches(',').count() == 1 && cell.replace(',', ".").parse::<f64>().is_ok()
}

/// The start of a text that might be very long, without control characters.
pub(crate) fn shortened(text: &str) -> String {
    const SHOWN: usize = 40;
    let mut out: String = text.chars().take(SHOWN).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(SHOWN).is_some() {
        out.push('…');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_of_a_bad_byte_is_counted_past_crlf_and_mark() {
        let error = decode("a.trc", b"\xEF\xBB\xBFone\r\ntwo\r\nthr\xE9e", 100).unwrap_err();
        assert_eq!(error, Error::NotUtf8 { place: Place::file("a.trc"), byte: 0xE9, line: 3, offset: 16 });
    }

    #[test]
    fn a_size_above_the_limit_is_refused() {
        let error = check_size("big.json", 4_200_000_000, MAX_KEYPOINT_BYTES).unwrap_err();
        assert_eq!(error.to_string(), "big.json: the file has 4.2 GB; at most 17 MB are read");
    }

    #[test]
    fn numbers_are_finite_or_named() {
        let at = || Place::file("a.csv").at_line(3);
        assert_eq!(finite(at, "-1e-3").unwrap(), -1e-3);
        assert_eq!(finite(at, "1e999").unwrap_err().to_string(), "a.csv: value out of range at line 3");
        assert_eq!(
            finite(at, "0,5").unwrap_err().to_string(),
            "a.csv:3: `0,5` has a decimal comma; expected a decimal point"
        );
        assert_eq!(finite(at, "a\tb").unwrap_err().to_string(), "a.csv:3: `a b`; expected a number");
        assert_eq!(finite_or_missing(at, "-nan").unwrap(), None);
        assert_eq!(finite_or_missing(at, "").unwrap(), None);
    }
}
