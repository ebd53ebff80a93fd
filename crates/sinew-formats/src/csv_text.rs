//! Records of tables in text by `csv`, with the line on which each starts.
//!
//! Blank lines are skipped, and blanks around cells in lines without quotes.

use crate::Error;
use crate::source_text::{truncated_in_line, without_mark};
use csv::{ReaderBuilder, StringRecord};
use std::io::Read as _;

/// Stands behind the text: a quote that is never closed swallows it.
const END: &[u8] = b"\nend\n";

/// The records of a text.
///
/// # Errors
/// [`Error::Truncated`] for a quote that is never closed.
pub(crate) fn records(
    name: &str,
    text: &str,
    separator: u8,
) -> impl Iterator<Item = Result<(usize, StringRecord), Error>> {
    let text = without_mark(text);
    let mut builder = ReaderBuilder::new();
    builder.has_headers(false).flexible(true).delimiter(separator);
    let mut reader = builder.from_reader(text.as_bytes().chain(END));
    let next = move || {
        let mut record = StringRecord::new();
        let start = reader.position().clone();
        let rest = text.get(start.byte() as usize..).filter(|rest| !rest.trim().is_empty())?;
        reader.read_record(&mut record).ok()?;
        // The reader skips line ends as a part of the record behind them.
        let skipped = &rest[..rest.len() - rest.trim_start_matches(['\r', '\n']).len()];
        let line = start.line() as usize + skipped.matches('\n').count();
        let end = reader.position().byte() as usize;
        let read = rest.get(..end - start.byte() as usize).unwrap_or(rest);
        let is_blank = read.trim().is_empty();
        if !read.contains('"') {
            record.trim();
        }
        Some(if end > text.len() + 1 {
            Err(truncated_in_line(name, text, "a quoted cell", line))
        } else {
            Ok((!is_blank).then_some((line, record)))
        })
    };
    std::iter::from_fn(next).filter_map(Result::transpose)
}
