//! Progress on stderr: a bar on a terminal, else one line per 10 %.

use super::args::General;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal as _, Write as _};

/// Progress of one pass over frames.
pub(crate) enum Progress {
    /// Nothing is shown.
    Silent,
    /// A bar on a terminal.
    Bar(ProgressBar),
    /// Lines in a log.
    Lines {
        /// What is done.
        what: &'static str,
        /// Frames in all.
        total: u64,
        /// Tenths told.
        told: u64,
    },
}

impl Progress {
    /// Starts a pass over so many frames.
    pub(crate) fn start(general: &General, what: &'static str, total: u64) -> Self {
        if general.quiet || general.no_progress {
            return Self::Silent;
        }
        if !io::stderr().is_terminal() {
            return Self::Lines { what, total, told: 0 };
        }
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
        // A template that does not parse falls back to indicatif's own bar.
        if let Ok(style) =
            ProgressStyle::with_template("{prefix:10} {bar:40} {pos}/{len} frames  {per_sec}  {eta} left")
        {
            bar.set_style(style);
        }
        bar.set_prefix(what);
        Self::Bar(bar)
    }

    /// So many frames are done.
    pub(crate) fn at(&mut self, done: u64) {
        match self {
            Self::Silent => {}
            Self::Bar(bar) => bar.set_position(done),
            Self::Lines { what, total, told } => {
                let tenths = (10 * done).checked_div(*total).unwrap_or(10);
                if tenths > *told {
                    *told = tenths;
                    let _ = writeln!(io::stderr(), "{what}: {} % ({done} of {total} frames)", 10 * tenths);
                }
            }
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
        }
    }
}
