//! The thread that reads lines, refuses those that are no next frame, and lets the others wait.

use super::answer::refused;
use super::answering::Answering;
use super::lines::{Line, next_line};
use super::queue::Queue;
use super::refusals::Kind;
use crate::formats::Layout;
use crate::input::flag::flag;
use crate::input::live::{LiveCameras, Views};
use std::io::{BufReader, Read};
use std::sync::Arc;

/// Bytes of a line at most: a hundred people in a hundred cameras.
pub(super) const MOST_BYTES: usize = 1 << 24;

/// Characters that are said of a line at most: answers that nobody takes wait in memory.
const MOST_WORDS: usize = 500;

/// The frame number of a line that cannot be read as a frame.
#[derive(serde::Deserialize)]
struct Numbered {
    frame: Option<u64>,
}

/// The beginning of what is said of a line, which may hold names as long as the line.
fn bounded(text: &str) -> &str {
    text.char_indices().nth(MOST_WORDS).map_or(text, |(end, _)| &text[..end])
}

/// What lines are checked against, and where frames and refusals go.
pub(super) struct Reading {
    pub(super) cameras: LiveCameras,
    pub(super) layout: Option<Layout>,
    /// Frames that a number may be ahead of the one before.
    pub(super) most_ahead: u64,
    pub(super) queue: Arc<Queue>,
    pub(super) answering: Answering,
}

impl Reading {
    /// Reads until the end of the stream, on a thread that nobody waits for: a read may never return.
    pub(super) fn begin(mut self, stream: impl Read + Send + 'static) {
        std::thread::spawn(move || {
            let mut stream = BufReader::with_capacity(1 << 16, stream);
            self.read(&mut stream);
            self.queue.close();
        });
    }

    fn read(&mut self, stream: &mut BufReader<impl Read>) {
        let (mut line, mut last) = (vec![], None);
        for number in 1_u64.. {
            match next_line(stream, &mut line, MOST_BYTES) {
                Err(error) => {
                    self.queue.state().warnings.push(format!("the input ended at line {number}: {error}"));
                    return;
                }
                Ok(Line::End) => return,
                Ok(Line::TooLong) => {
                    let text = format!("line {number}: longer than {MOST_BYTES} bytes; expected one frame");
                    self.refuse(number, None, Kind::TooLong, &text);
                }
                Ok(Line::Whole) if line.iter().all(u8::is_ascii_whitespace) => {}
                Ok(Line::Whole) => match self.frame(number, &line, last) {
                    Ok(views) => {
                        last = Some(views.number);
                        if !self.queue.push(views) {
                            return;
                        }
                    }
                    Err((frame, kind, text)) => self.refuse(number, frame, kind, &text),
                },
            }
        }
    }

    /// The frame of a line, if it is one that may follow the last one.
    fn frame(&mut self, line: u64, text: &[u8], last: Option<u64>) -> Result<Views, (Option<u64>, Kind, String)> {
        let name = format!("line {line}");
        let text = std::str::from_utf8(text)
            .map_err(|error| (None, Kind::Malformed, format!("{name}: {error}; save as UTF-8")))?;
        let numbered = || serde_json::from_str::<Numbered>(text).ok()?.frame;
        let malformed = |error: &dyn std::fmt::Display| (numbered(), Kind::Malformed, error.to_string());
        let views = self.cameras.read(&name, text, self.layout.as_ref()).map_err(|error| malformed(&error))?;
        let number = views.number;
        let refused = |kind, text| Err((Some(number), kind, text));
        match last {
            Some(last) if number == last => {
                return refused(
                    Kind::Repeated,
                    format!("{name}: frame {number} came before; one line holds all cameras"),
                );
            }
            Some(last) if number < last => {
                return refused(Kind::Late, format!("{name}: frame {number} came after frame {last}; numbers rise"));
            }
            Some(last) if number - last > self.most_ahead => {
                let most = self.most_ahead;
                let text = format!("{name}: frame {number} came after frame {last}; at most {most} may be missing");
                return refused(Kind::FarAhead, text);
            }
            _ if number > u64::from(u32::MAX) => {
                return refused(Kind::Malformed, format!("{name}: frame {number}; at most {}", u32::MAX));
            }
            _ => {}
        }
        if self.layout.is_none() {
            let guessed = self.cameras.guessed_layout(&name, &views).map_err(|error| malformed(&error))?;
            let Some((layout, warning)) = guessed else {
                return refused(
                    Kind::NobodyYet,
                    format!("{name}: nobody was seen yet, and no {} is given", flag("layout")),
                );
            };
            let mut state = self.queue.state();
            state.warnings.extend(warning);
            state.layout = Some(layout.clone());
            self.layout = Some(layout);
        }
        Ok(views)
    }

    fn refuse(&self, line: u64, frame: Option<u64>, kind: Kind, text: &str) {
        let text = bounded(text);
        self.queue.state().refusals.add(kind, text);
        self.answering.post(refused(line, frame, text));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_about_a_line_are_cut() {
        let long = "\u{e9}".repeat(8 << 20);
        assert_eq!(bounded(&long).chars().count(), MOST_WORDS);
        assert_eq!(bounded("no calibration for `C7`"), "no calibration for `C7`");
    }
}
