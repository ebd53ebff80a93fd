//! What is known about a file or folder, as rows of names and values.

use std::ops::Range;

/// What is known about something.
#[derive(Debug, Default)]
pub struct Facts {
    /// What it is.
    pub title: String,
    /// Name and value of each fact.
    pub rows: Vec<(String, String)>,
    /// What is odd.
    pub odd: Vec<Odd>,
}

/// Something odd about a file or folder.
#[derive(Debug)]
pub enum Odd {
    /// In words.
    Words(String),
    /// Frames of cameras that a recording would be refused for.
    Refused(sinew_input::Error),
    /// Cameras that begin or end apart, each with its frames; tracking takes the frames of all, if that is asked for.
    Apart([(String, Range<u64>); 2]),
    /// A run that was stopped and can be resumed.
    Stopped,
    /// A run of several people that is unfinished.
    Unfinished,
}

impl<T: Into<String>> From<T> for Odd {
    fn from(words: T) -> Self {
        Self::Words(words.into())
    }
}

impl Facts {
    pub(crate) fn new(title: String) -> Self {
        Self { title, ..Self::default() }
    }

    pub(crate) fn row(&mut self, name: impl Into<String>, value: impl Into<String>) {
        self.rows.push((name.into(), value.into()));
    }
}

/// Names shown before a list is cut short.
const LISTED: usize = 12;

pub(super) fn shortened(names: &[String]) -> String {
    let listed = names.iter().take(LISTED).cloned().collect::<Vec<_>>().join(" ");
    if names.len() > LISTED { format!("{listed} and {} more", names.len() - LISTED) } else { listed }
}
