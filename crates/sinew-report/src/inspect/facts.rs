//! What is known about a file or folder, as rows of names and values.

/// What is known about something.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Facts {
    /// What it is.
    pub title: String,
    /// Name and value of each fact.
    pub rows: Vec<(String, String)>,
    /// What is odd.
    pub odd: Vec<String>,
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
