//! Progress on stderr: a bar on a terminal, else one line per 10 %.

use super::args::General;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use std::fmt;
use std::io::{self, IsTerminal as _, Write as _};

/// Iterations from one line in a log to the next.
const LOGGED: usize = 20;

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
        /// What is counted.
        unit: &'static str,
        /// How many in all.
        total: u64,
        /// Tenths that were shown.
        shown: u64,
    },
}

impl Progress {
    /// Starts a pass over `total` frames.
    pub(crate) fn start(general: &General, what: &'static str, total: u64) -> Self {
        Self::counting(general, what, "frames", total)
    }

    /// Starts a pass over `total` things of a kind.
    pub(crate) fn counting(general: &General, what: &'static str, unit: &'static str, total: u64) -> Self {
        if general.quiet > 0 || general.no_progress {
            return Self::Silent;
        }
        if !io::stderr().is_terminal() {
            return Self::Lines { what, unit, total, shown: 0 };
        }
        Self::Bar(bar(ProgressDrawTarget::stderr(), what, unit, total))
    }

    /// An iteration on the thing at hand, from 1 on, changed what it works towards by that share.
    pub(crate) fn iteration(&self, of: &str, iteration: usize, change: f64) {
        match self {
            Self::Silent => {}
            Self::Bar(bar) => bar.set_message(format!(" iteration {iteration}: {change:.0e}")),
            Self::Lines { what, .. } if iteration.is_multiple_of(LOGGED) => {
                let _ = writeln!(
                    io::stderr(),
                    "{what}: {of}, iteration {iteration}, log likelihood changed by {change:.0e}"
                );
            }
            Self::Lines { .. } => {}
        }
    }

    /// What is lowered step by step has come down to that value.
    pub(crate) fn value(&self, step: usize, name: &str, value: f64) {
        match self {
            Self::Silent => {}
            Self::Bar(bar) => bar.set_message(format!(" {name} {value:.1}")),
            Self::Lines { what, .. } if step.is_multiple_of(LOGGED) => {
                let _ = writeln!(io::stderr(), "{what}: step {step}, {name} {value:.2}");
            }
            Self::Lines { .. } => {}
        }
    }

    /// `done` of them are done.
    pub(crate) fn at(&mut self, done: u64) {
        match self {
            Self::Silent => {}
            Self::Bar(bar) => {
                bar.set_message("");
                advance(bar, done);
            }
            Self::Lines { what, unit, total, shown } => {
                let tenths = (10 * done).checked_div(*total).unwrap_or(10);
                if tenths > *shown {
                    *shown = tenths;
                    let _ = writeln!(io::stderr(), "{what}: {} % ({done} of {total} {unit})", 10 * tenths);
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

/// A bar that takes what the terminal's width leaves.
fn bar(target: ProgressDrawTarget, what: &'static str, unit: &str, total: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(total), target);
    // A template that does not parse falls back to indicatif's own bar.
    let template = format!("{{prefix:13}} {{wide_bar}} {{pos}}/{{len}} {unit} {{rate:>7}} {{eta:>4}} left{{msg}}");
    if let Ok(style) = ProgressStyle::with_template(&template) {
        let rate = |state: &ProgressState, out: &mut dyn fmt::Write| {
            let _ = write!(out, "{}", rate(state.per_sec()));
        };
        bar.set_style(style.with_key("rate", rate));
    }
    bar.set_prefix(what);
    bar
}

fn advance(bar: &ProgressBar, done: u64) {
    let is_first = bar.position() == 0;
    bar.set_position(done);
    if is_first {
        // Frames that were done before, by the run that is resumed, took no time in this one.
        bar.reset_eta();
    }
}

/// Frames per second in three digits, or nothing where the estimate means nothing yet.
fn rate(per_second: f64) -> String {
    match per_second {
        r if (0.0..9.95).contains(&r) => format!("{r:.1}/s"),
        r if (0.0..999.5).contains(&r) => format!("{r:.0}/s"),
        r if (0.0..99_500.0).contains(&r) => format!("{:.0}k/s", r / 1e3),
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use indicatif::TermLike;
    use std::sync::{Arc, Mutex};

    /// A terminal of 80 columns that keeps what is drawn.
    #[derive(Clone, Debug, Default)]
    struct Screen(Arc<Mutex<Vec<String>>>);

    impl TermLike for Screen {
        fn width(&self) -> u16 {
            80
        }
        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn write_line(&self, text: &str) -> io::Result<()> {
            self.write_str(text)
        }
        fn write_str(&self, text: &str) -> io::Result<()> {
            self.0.lock().unwrap().push(text.to_owned());
            Ok(())
        }
        fn clear_line(&self) -> io::Result<()> {
            Ok(())
        }
        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_bar_fits_eighty_columns_from_its_first_frame_on() {
        let screen = Screen::default();
        let target = ProgressDrawTarget::term_like_with_hz(Box::new(screen.clone()), 255);
        let bar = bar(target, "smoothing", "frames", 123_456);
        for done in [40_000, 40_001, 40_002, 90_000, 123_456] {
            advance(&bar, done);
            bar.tick();
            std::thread::sleep(std::time::Duration::from_millis(20));
        }
        let drawn: Vec<String> = screen.0.lock().unwrap().iter().map(|text| text.trim_end().to_owned()).collect();
        let bars: Vec<&String> = drawn.iter().filter(|text| text.contains("frames")).collect();
        assert!(bars.len() >= 2, "{drawn:?}");
        for text in bars {
            assert!(text.chars().count() <= 80 && text.starts_with("smoothing"), "{text}");
            let rate = text.split_once("/s").map_or("", |(before, _)| before.rsplit(' ').next().unwrap());
            assert!(rate.len() <= 4, "{text}");
        }
    }

    #[test]
    fn a_bar_fits_eighty_columns_with_its_iteration() {
        let screen = Screen::default();
        let bar = bar(ProgressDrawTarget::term_like_with_hz(Box::new(screen.clone()), 255), "learning", "vectors", 14);
        advance(&bar, 10);
        let progress = Progress::Bar(bar.clone());
        progress.iteration("l_upper_arm", 137, 1.234e-5);
        bar.tick();
        let drawn = screen.0.lock().unwrap().concat();
        assert!(drawn.contains("10/14 vectors") && drawn.contains("left iteration 137: 1e-5"), "{drawn}");
        assert!(screen.0.lock().unwrap().iter().all(|text| text.trim_end().chars().count() <= 80), "{drawn}");
    }

    #[test]
    fn rates_have_three_digits() {
        let shown = [0.0, 3.15, 9.97, 421.7, 999.7, 45_678.9, 4_567_890.1, f64::INFINITY, f64::NAN].map(rate);
        assert_eq!(shown, ["0.0/s", "3.1/s", "10/s", "422/s", "1k/s", "46k/s", "", "", ""]);
    }
}
