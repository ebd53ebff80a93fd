//! A run of one person: from the beginning, or from where it was stopped.

use super::claimed::{claimed, claimed_in};
use super::listener::{Listener, PassCounter};
use super::pieces::{FromFootage, RESUME, calibration, setup_frames, within};
use super::request::{CameTo, Run};
use super::resume::{Stopped, same_run, stopped_run};
use super::settings::reading;
use super::threads::{wanted, with_threads};
use super::{people, refined_calibration};
use crate::Error;
use crate::config::{Resolved, TrackConfig};
use crate::input::footage::Footage;
use crate::input::one_person::OnePerson;
use crate::input::roll::Roll;
use crate::track::checkpoint::Checkpoint;
use crate::track::job::{self, Outcome, Watch};
use sinew_results::{Claim, ResultFolder, problem, refuse_inputs};
use std::ops::Range;
use std::path::PathBuf;

/// A run of one person into the folder of the settings.
pub(crate) struct OneRun<'a> {
    pub(crate) run: Run<'a>,
    pub(crate) config: &'a TrackConfig,
}

impl OneRun<'_> {
    pub(crate) fn track<S: FromFootage>(
        &self,
        source: &mut S,
        setup_frames: Range<u64>,
        claim: Option<Claim>,
    ) -> Result<CameTo, Error> {
        let Self { run: Run { resolved, request, read_from, listener, .. }, config } = *self;
        if !request.resume {
            people::forget_people(config, read_from)?;
        }
        let (claim, from) = match (claim, request.resume) {
            (Some(claim), _) => (claim, None),
            (None, false) => (claimed_in(request.storage(), config, read_from, listener)?, None),
            (None, true) => match stopped_run(config, read_from, listener)? {
                Stopped::Complete(claim, summary) => {
                    let hashes = |source: &S| source.footage().input_hashes();
                    same_run(source, setup_frames, resolved, &claim, &summary, listener, hashes)?;
                    ResultFolder::forget(&claim)?;
                    self.refine()?;
                    return Ok(CameTo::Complete(summary));
                }
                Stopped::At(claim, checkpoint) => (claim, Some(*checkpoint)),
            },
        };
        let outcome = tracked(source, setup_frames, resolved, claim, from, listener);
        let outcome = outcome.inspect_err(|error| {
            if let Error::Results(sinew_results::Error::Checkpoint { .. }) = error {
                return;
            }
            // What is odd about the input may be why it could not be tracked.
            listener.warnings(&source.footage().warnings());
            if config.out.join(problem::NAME).exists() {
                listener.note(&format!("the frames before are kept in {}; {RESUME}", config.out.display()));
            }
        })?;
        self.refine()?;
        sinew_results::forget_derived(&config.out)?;
        Ok(CameTo::One(Box::new(outcome)))
    }

    /// Writes the calibration that the run found, if it is wanted.
    fn refine(&self) -> Result<(), Error> {
        let path = self.run.request.write_calibration.as_ref();
        path.map_or(Ok(()), |path| {
            refined_calibration::write(path, self.config, self.run.calibration, self.run.listener)
        })
    }
}

/// One run into its own folder, without anything besides; of one of several people, if he is named.
///
/// # Errors
/// [`Error`], as [`super::track`].
pub fn track_alone(
    resolved: &Resolved,
    chosen: Option<(&Roll, usize)>,
    read_from: &[PathBuf],
    listener: &dyn Listener,
) -> Result<Outcome, Error> {
    let config = resolved.track();
    refuse_inputs(&config.out, read_from)?;
    job::check_settings(resolved)?;
    let mut recording = Footage::open(&config.files(&calibration(&config)?), &reading(&config))?;
    let frames = setup_frames(&config, &recording)?;
    let claim = claimed(&config, read_from, listener)?;
    let Some((roll, person)) = chosen else {
        return tracked(&mut recording, frames, resolved, claim, None, listener);
    };
    let frames = within(&frames, &roll.people[person].frames);
    let mut source = OnePerson { source: &mut recording, roll, person };
    tracked(&mut source, frames, resolved, claim, None, listener)
}

/// The run itself, with its progress.
fn tracked<S: FromFootage>(
    source: &mut S,
    setup_frames: Range<u64>,
    resolved: &Resolved,
    claim: Claim,
    from: Option<Checkpoint>,
    listener: &dyn Listener,
) -> Result<Outcome, Error> {
    with_threads(wanted(&resolved.track()), || {
        let mut counter = PassCounter::new(listener);
        let stop = listener.stop();
        let mut at = |pass, done, total| counter.at(pass, done, total);
        let mut watch = Watch { progress: &mut at, stop: &stop };
        let inputs = |source: &S| (source.footage().warnings(), source.footage().input_hashes());
        job::track(source, setup_frames, resolved, claim, &mut watch, inputs, from)
    })
}
