//! Who hears of a run while it goes: a terminal, a notebook, a log, or nobody.

use crate::track::job::{RunPhase, Watch};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Hears of a run, from any of its threads.
pub trait Listener: Sync {
    /// Something is odd and the results are made all the same.
    fn warning(&self, text: &str);
    /// Something that is neither error nor warning.
    fn note(&self, text: &str);
    /// Something is counted from now on, `total` of them in all.
    fn counter(&self, what: &'static str, unit: &'static str, total: u64) -> Box<dyn Counter + '_>;
    /// Set by whoever wants an end: a run finishes the frame at hand and keeps what is done.
    fn stop(&self) -> Arc<AtomicBool>;

    /// Several warnings.
    fn warnings(&self, texts: &[String]) {
        texts.iter().for_each(|text| self.warning(text));
    }
}

/// What is counted.
pub trait Counter: Send {
    /// `done` of them are done.
    fn at(&mut self, done: u64);
}

/// Hears nothing.
#[derive(Clone, Debug, Default)]
pub struct Deaf {
    stop: Arc<AtomicBool>,
}

impl Deaf {
    /// Hears nothing, and ends when somebody else is to end.
    #[must_use]
    pub const fn stopped_by(stop: Arc<AtomicBool>) -> Self {
        Self { stop }
    }
}

impl Listener for Deaf {
    fn warning(&self, _: &str) {}
    fn note(&self, _: &str) {}
    fn counter(&self, _: &'static str, _: &'static str, _: u64) -> Box<dyn Counter + '_> {
        Box::new(Nothing)
    }
    fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }
}

struct Nothing;

impl Counter for Nothing {
    fn at(&mut self, _: u64) {}
}

/// Does what counts its passes over the frames, one counter a pass, and stops once the listener wants an end.
pub fn watched<T>(listener: &dyn Listener, run: impl FnOnce(&mut Watch<'_>) -> T) -> T {
    let mut current: Option<(RunPhase, Box<dyn Counter + '_>)> = None;
    let mut progress = |pass: RunPhase, done: u64, total: u64| {
        if current.as_ref().is_none_or(|(current, _)| *current != pass) {
            let what = match pass {
                RunPhase::Check => "reading again",
                RunPhase::SetUp => "set-up",
                RunPhase::Track => "tracking",
                RunPhase::Smooth => "smoothing",
            };
            // The one before ends first.
            current = None;
            current = Some((pass, listener.counter(what, "frames", total)));
        }
        if let Some((_, counter)) = &mut current {
            counter.at(done);
        }
    };
    run(&mut Watch { progress: &mut progress, stop: &listener.stop() })
}
