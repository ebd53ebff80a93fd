//! The help text of a command: what it does, its usage and two examples.

macro_rules! template {
    ($($example:literal),+) => {
        concat!("{about}\n\n{usage-heading} {usage}\n\nExamples:\n", $("  ", $example, "\n"),+, "\n{all-args}{after-help}")
    };
}

pub(crate) use template;
