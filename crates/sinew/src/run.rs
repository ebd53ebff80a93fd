//! Whole runs: from settings to result folders, of one person or of several, stopped and continued.
//!
//! [`track`] is what `sinew track` does, for whoever listens: a terminal, a notebook, a batch of trials, nobody.
//!
//! ```text
//! settings ──▶ whom ──▶ one_person             (one folder)
//!                └────▶ people ──▶ one_person… (one folder each, beside each other)
//! ```
//!
//! ```
//! use sinew::run::listener::Deaf;
//! use sinew::Error;
//! use sinew::run::{Request, settings, track};
//!
//! let given = [("calibration", "Calib.toml".to_owned()), ("fps", "60".to_owned())];
//! let resolved = settings::settings(&given, None)?;
//! let refused = track(&resolved, &Request::default(), &Deaf::default());
//! assert!(matches!(refused, Err(Error::NothingToTrack { observation: false, .. })));
//! # Ok::<(), Error>(())
//! ```

pub mod claimed;
mod former_results;
pub mod listener;
pub mod live;
mod one_person;
mod people;
mod pieces;
mod refined_calibration;
mod request;
pub mod resume;
pub mod settings;
pub mod threads;
pub mod whom;

pub use one_person::track_alone;
pub use pieces::{calibration, how_to_resume, read_from};
pub use request::{CameTo, Request};

use crate::Error;
use crate::config::Resolved;
use crate::track::job;
use listener::Listener;
use pieces::opened;
use request::Run;
use sinew_results::refuse_inputs;
use whom::{Whom, looked_for};

/// Tracks the people in a recording into the folder of the settings.
///
/// # Errors
/// [`Error`], with what was done kept in the folder where anything was.
pub fn track(resolved: &Resolved, request: &Request, listener: &dyn Listener) -> Result<CameTo, Error> {
    let config = resolved.track();
    let calibration = calibration(&config)?;
    let read_from = read_from(&config, &calibration, request.settings_file.as_deref());
    // Mistakes in the settings are said before what is in the folder.
    refuse_inputs(&config.out, &read_from)?;
    if let Some(path) = &request.write_calibration {
        refined_calibration::check(path, &config, &read_from)?;
    }
    if request.page {
        sinew_results::refuse_other_page(&config.out.join(sinew_results::PAGE_NAME), config.force)?;
    }
    job::check_settings(resolved)?;
    let claimed = || {
        if request.resume {
            Ok(None)
        } else {
            claimed::claimed_in(request.storage(), &config, &read_from, listener).map(Some)
        }
    };
    let (claim, whom) = looked_for(resolved, &calibration, listener, claimed)?;
    if request.resume {
        resume::refuse_other_number(&config.out, matches!(whom, Whom::Everybody(_)))?;
    }
    let run = Run { resolved, request, calibration: &calibration, read_from: &read_from, listener };
    let chosen = match &whom {
        Whom::Everybody(roll) => return Ok(CameTo::Several(people::track(run, roll, claim)?)),
        Whom::One(roll, person) => Some((roll, *person)),
        Whom::MostComplete => None,
    };
    let (mut recording, frames) = opened(&config, &calibration, chosen)?;
    one_person::track(run, &mut recording, frames, claim)
}
