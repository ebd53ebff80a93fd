//! What the user reads: the answer on stdout, errors and warnings on stderr.

use super::args::{Color, General};
use super::error::Error;
use std::error::Error as _;
use std::io::{self, IsTerminal as _, Write as _};
use std::path::PathBuf;

/// How to speak.
pub(crate) struct Report {
    quiet: u8,
    verbose: u8,
    colored: bool,
}

const RED: &str = "31";
const YELLOW: &str = "33";
const GREEN: &str = "32";

/// Name of the stream in errors.
const STDOUT: &str = "standard output";

impl Report {
    pub(crate) fn new(general: &General) -> Self {
        let colored = match general.color {
            Color::Always => true,
            Color::Never => false,
            Color::Auto => {
                io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty())
            }
        };
        Self { quiet: general.quiet, verbose: general.verbose, colored }
    }

    fn say(&self, color: &str, word: &str, text: &str) {
        // Nobody listens where stderr is closed.
        let _ = if self.colored {
            writeln!(io::stderr(), "\x1b[1;{color}m{word}:\x1b[0m {text}")
        } else {
            writeln!(io::stderr(), "{word}: {text}")
        };
    }

    pub(crate) fn error(&self, error: &Error) {
        self.say(RED, "error", &error.to_string());
        let mut cause = error.source();
        while let Some(inner) = cause {
            self.say(RED, "caused by", &inner.to_string());
            cause = inner.source();
        }
        if let Some(help) = error.help() {
            self.say(GREEN, "help", &help);
        }
    }

    /// Warnings, each once.
    pub(crate) fn warnings(&self, warnings: &[String]) {
        warnings.iter().for_each(|warning| self.warning(warning));
    }

    /// A warning; silenced by `-qq`.
    pub(crate) fn warning(&self, text: &str) {
        if self.quiet < 2 {
            self.say(YELLOW, "warning", text);
        }
    }

    /// A diagnostic that failed.
    pub(crate) fn failed(&self, text: &str) {
        self.say(RED, "diagnostic failed", text);
    }

    /// A line on stderr that is neither error nor warning; silenced by `-q`.
    pub(crate) fn note(&self, text: &str) {
        if self.quiet == 0 {
            let _ = writeln!(io::stderr(), "{text}");
        }
    }

    /// A line that `-v` asks for.
    pub(crate) fn detail(&self, text: &str) {
        if self.verbose > 0 {
            self.note(text);
        }
    }
}

/// Prints the answer.
pub(crate) fn answer(text: &str) -> Result<(), Error> {
    let mut out = io::stdout().lock();
    let written =
        out.write_all(text.as_bytes()).and_then(|()| if text.ends_with('\n') { Ok(()) } else { out.write_all(b"\n") });
    let written = written.and_then(|()| out.flush());
    Ok(written.map_err(sinew::Error::io("write to", PathBuf::from(STDOUT)))?)
}

/// Prints the answer as JSON.
pub(crate) fn answer_json(value: &serde_json::Value) -> Result<(), Error> {
    answer(&format!("{value:#}"))
}

/// Whether the reader of our answer went away.
pub(crate) fn is_closed_pipe(error: &Error) -> bool {
    let file = match error {
        Error::Report(sinew_report::Error::Analysis(sinew_analysis::Error::Run(error))) => error.file(),
        _ => None,
    };
    file.is_some_and(|file| file.path.as_os_str() == STDOUT && file.source.kind() == io::ErrorKind::BrokenPipe)
}
