//! What a run says, on the terminal.

use super::args::General;
use super::interrupt;
use super::progress::Progress;
use super::report::Report;
use sinew::run::listener::{Counter, Listener};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The terminal of the process.
#[derive(Clone, Copy)]
pub(crate) struct Terminal<'a> {
    pub(crate) general: &'a General,
    pub(crate) report: &'a Report,
}

impl Listener for Terminal<'_> {
    fn warning(&self, text: &str) {
        self.report.warning(text);
    }

    fn note(&self, text: &str) {
        self.report.note(text);
    }

    fn counter(&self, what: &'static str, unit: &'static str, total: u64) -> Box<dyn Counter + '_> {
        Box::new(Progress::counting(self.general, what, unit, total))
    }

    fn stop(&self) -> Arc<AtomicBool> {
        interrupt::flag("the frame")
    }
}

impl Counter for Progress {
    fn at(&mut self, done: u64) {
        Self::at(self, done);
    }
}
