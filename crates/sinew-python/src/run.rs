//! Whole runs: what `sinew track` does, heard by Python.

use crate::arrays::{frame_number, numbers};
use crate::background::interruptible;
use crate::camera::PyCamera;
use crate::failure::{Failure, USAGE};
use crate::given::Given;
use pyo3::prelude::*;
use sinew::config::common::CONFIDENCE_SCALE;
use sinew::config::setting::{Setting, SettingKind};
use sinew::config::table;
use sinew::formats::nearest::nearest;
use sinew::run::calibration;
use sinew::run::listener::{Counter, Listener};
use sinew::run::settings::{Given as Settings, with_stated_rate};
use sinew::run::{CameTo, Request};
use sinew_report::written_page::write_for_run;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};

/// What is counted: what, unit, done, total.
type Progress = (&'static str, &'static str, u64, u64);

/// Texts and counts of a run until Python takes them.
#[derive(Default)]
struct Heard {
    texts: Mutex<Vec<(&'static str, String)>>,
    progress: Mutex<Option<Progress>>,
    stop: Arc<AtomicBool>,
}

fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Heard {
    fn text(&self, kind: &'static str, text: &str) {
        locked(&self.texts).push((kind, text.to_owned()));
    }

    /// Hands everything on: `hear(kind, text)` and `count(what, unit, done, total)`.
    fn say(&self, py: Python<'_>, hear: &Py<PyAny>, count: &Py<PyAny>) -> PyResult<()> {
        let texts = std::mem::take(&mut *locked(&self.texts));
        let progress = locked(&self.progress).take();
        for text in texts {
            hear.call1(py, text)?;
        }
        progress.map_or(Ok(()), |progress| count.call1(py, progress).map(drop))
    }
}

impl Listener for Heard {
    fn warning(&self, text: &str) {
        self.text("warning", text);
    }
    fn note(&self, text: &str) {
        self.text("note", text);
    }
    fn counter(&self, what: &'static str, unit: &'static str, total: u64) -> Box<dyn Counter + '_> {
        Box::new(Counted { heard: self, what, unit, total })
    }
    fn stop(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.stop)
    }
}

struct Counted<'a> {
    heard: &'a Heard,
    what: &'static str,
    unit: &'static str,
    total: u64,
}

impl Counter for Counted<'_> {
    fn at(&mut self, done: u64) {
        *locked(&self.heard.progress) = Some((self.what, self.unit, done, self.total));
    }
}

/// The settings by name, as they are typed.
fn named(settings: Vec<(String, String)>) -> Result<Settings, Failure> {
    let known = |(key, text): (String, String)| match table::find(&key) {
        Some(setting) => Ok((setting.key, text)),
        None => {
            let meant = nearest(&key, table::settings().iter().map(|setting| setting.key));
            let meant = meant.map(|key| format!("; did you mean `{key}`?")).unwrap_or_default();
            Err(Failure {
                code: USAGE,
                help: Some("`sinew.settings()` lists all of them".into()),
                ..Failure::argument(format!("unknown setting `{key}`{meant}"))
            })
        }
    };
    settings.into_iter().map(known).collect()
}

/// All settings in the order of the reference: name, help, what kind of value, and the values where they are few.
#[pyfunction]
pub(crate) fn settings_table() -> Vec<(&'static str, &'static str, &'static str, Vec<&'static str>)> {
    let row = |setting: &Setting| {
        let (kind, choices): (_, &[&str]) = match setting.kind {
            SettingKind::Path | SettingKind::NameOrPath => ("path", &[]),
            SettingKind::Choice(names) => ("choice", names),
            SettingKind::Count(..) => ("count", &[]),
            SettingKind::Number { .. } => ("number", &[]),
            SettingKind::Flag => ("flag", &[]),
            SettingKind::Frames => ("frames", &[]),
            SettingKind::Text => ("text", &[]),
            SettingKind::Names => ("names", &[]),
            SettingKind::Direction => ("direction", &[]),
            SettingKind::Lags => ("lags", &[]),
        };
        (setting.key, setting.help, kind, choices.to_vec())
    };
    table::settings().iter().map(row).collect()
}

/// Cameras, keypoints, names of the points and the number of the first frame.
type GivenArrays<'py> = (Vec<PyRef<'py, PyCamera>>, Bound<'py, PyAny>, Option<Vec<Option<String>>>, Bound<'py, PyAny>);

/// Tracks; returns the result folder and the diagnostics that failed.
#[pyfunction]
#[pyo3(signature = (settings, given, config, resume, page, write_calibration, hear, count))]
#[allow(clippy::too_many_arguments)]
pub(crate) fn track(
    py: Python<'_>,
    settings: Vec<(String, String)>,
    given: Option<GivenArrays<'_>>,
    config: Option<PathBuf>,
    resume: bool,
    page: bool,
    write_calibration: Option<PathBuf>,
    hear: Py<PyAny>,
    count: Py<PyAny>,
) -> PyResult<(PathBuf, Vec<String>)> {
    let settings = named(settings)?;
    let given = given
        .map(|(cameras, keypoints, points, first)| {
            let first = frame_number("first_frame", &first)?;
            Ok::<_, PyErr>(Given::new(&cameras, numbers("keypoints", &keypoints)?, points, first)?)
        })
        .transpose()?;
    let heard = Heard::default();
    let resolved = sinew::run::settings::settings(&settings, config.as_deref());
    let resolved = resolved.and_then(|resolved| with_stated_rate(resolved, &heard));
    let mut resolved = resolved.map_err(Failure::from)?;
    if let Some(given) = given {
        resolved.given = Some(Arc::new(given.recording(resolved.of(&CONFIDENCE_SCALE))?));
    }
    heard.warnings(&resolved.warnings);
    heard.warnings(&resolved.idle_flags());
    let out = resolved.track().out;
    let request = Request { resume, page, write_calibration, settings_file: config, ..Request::default() };
    let came_to = interruptible(
        py,
        &heard.stop,
        |py| heard.say(py, &hear, &count),
        || {
            let came_to = sinew::run::track(&resolved, &request, &heard).map_err(Failure::from)?;
            if page {
                let calibration = calibration(&resolved.track()).map_err(Failure::from)?;
                write_for_run(&out, &calibration, &heard).map_err(Failure::from)?;
            }
            if let CameTo::One(outcome) = &came_to {
                heard.warnings(&outcome.summary.warnings);
            }
            Ok(came_to)
        },
    )?;
    Ok((out, failed_diagnostics(&came_to)))
}

/// The diagnostics that failed.
fn failed_diagnostics(came_to: &CameTo) -> Vec<String> {
    match came_to {
        CameTo::One(outcome) => outcome.summary.failed_diagnostics.clone(),
        CameTo::Complete(summary) => {
            let failed = summary["failed_diagnostics"].as_array().into_iter().flatten();
            failed.filter_map(|text| text.as_str()).map(str::to_owned).collect()
        }
        CameTo::Several(summary) => {
            let failed = summary.people.iter().flat_map(|person| {
                person.failed_diagnostics.iter().map(|failed| format!("person {}: {failed}", person.person))
            });
            failed.collect()
        }
    }
}
