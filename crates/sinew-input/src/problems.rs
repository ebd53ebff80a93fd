//! All mistakes of a settings or set-up file.

/// A configuration with mistakes, all of them.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.listed())]
pub struct Problems {
    /// File, or `the command line`.
    pub file: String,
    /// What is wrong, one sentence each.
    pub problems: Vec<String>,
}

impl Problems {
    fn listed(&self) -> String {
        let Self { file, problems } = self;
        match &problems[..] {
            [one] => match one.strip_prefix("line ") {
                Some(rest) => format!("{file}:{rest}"),
                None => format!("{file}: {one}"),
            },
            many => format!("{} problems in {file}:\n  {}", many.len(), many.join("\n  ")),
        }
    }
}
