//! Lines of a stream, none of them longer than a bound.

use std::io::{BufRead, ErrorKind, Result};

/// What came next.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Line {
    /// A line without its end; the last one may lack it.
    Whole,
    /// A line of more than the bound, of which nothing is kept.
    TooLong,
    /// The end of the stream.
    End,
}

/// Reads the next line into `line`, in place of what it held.
pub(super) fn next_line(stream: &mut impl BufRead, line: &mut Vec<u8>, most: usize) -> Result<Line> {
    line.clear();
    let (mut is_empty, mut is_too_long) = (true, false);
    loop {
        let read = match stream.fill_buf() {
            Err(error) if error.kind() == ErrorKind::Interrupted => continue,
            read => read?,
        };
        let end = read.iter().position(|byte| *byte == b'\n');
        let part = &read[..end.unwrap_or(read.len())];
        is_empty &= read.is_empty();
        is_too_long |= line.len() + part.len() > most;
        if is_too_long {
            line.clear();
        } else {
            line.extend_from_slice(part);
        }
        let (is_last, used) = (read.is_empty() || end.is_some(), part.len() + usize::from(end.is_some()));
        stream.consume(used);
        match (is_last, is_empty, is_too_long) {
            (false, _, _) => {}
            (true, true, _) => return Ok(Line::End),
            (true, false, true) => return Ok(Line::TooLong),
            (true, false, false) => return Ok(Line::Whole),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::BufReader;

    #[test]
    fn lines_of_any_length_in_any_pieces() {
        let text = b"abc\n\nabcdefghij\nxyz";
        for piece in 1..20 {
            let mut stream = BufReader::with_capacity(piece, &text[..]);
            let mut line = vec![];
            let mut found = vec![];
            loop {
                match next_line(&mut stream, &mut line, 5).unwrap() {
                    Line::End => break,
                    kind => found.push((kind, String::from_utf8(line.clone()).unwrap())),
                }
            }
            let expected = [(Line::Whole, "abc"), (Line::Whole, ""), (Line::TooLong, ""), (Line::Whole, "xyz")];
            assert_eq!(found, expected.map(|(kind, text)| (kind, text.to_owned())), "{piece}");
        }
    }
}
