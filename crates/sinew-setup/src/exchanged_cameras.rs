//! Whether all cameras agree on a person once the calibrations of two of them are exchanged.

use super::calibration_fit::{is_doubtful, per_diagonal, residual};
use super::setup_error::SetupError;
use sinew_observe::Camera;
use sinew_observe::association::following::{Following, follow};
use sinew_observe::association::{Config, Person};
use sinew_observe::cameras::offsets::Sighted;

/// Share of the views of people in which a camera shows the person whom others see, below which something is wrong, and from which on all is well.
const DISAGREEING: f64 = 0.5;
const AGREEING: f64 = 0.9;
/// Residual, per 1000 px of image diagonal, up to which nothing is looked for: exchanged cameras that see a person from like distances may agree on somebody.
const SUSPICIOUS: f64 = 4.0;
/// Share of the present residual that an exchange must fall below.
const BETTER: f64 = 0.5;
/// Cameras up to which all pairs are tried.
const MOST: usize = 16;

/// How far cameras agree on one person in some frames.
struct Agreement {
    /// For each camera, the share of the frames in which it shows people where it shows the one whom others see.
    shares: Vec<f64>,
    /// Median distance of that person's keypoints from their triangulation, pixels.
    residual_px: Option<f64>,
}

fn agreement(cameras: &[Camera], frames: &[Vec<Vec<Person>>], config: &Config) -> Agreement {
    let (mut shown, mut matched) = (vec![0_u32; cameras.len()], vec![0_u32; cameras.len()]);
    let mut sighted: Vec<Sighted> = vec![];
    for people in frames {
        let found = follow(&mut Following::default(), cameras, people, None, config);
        for (camera, views) in people.iter().enumerate() {
            shown[camera] += u32::from(!views.is_empty());
            matched[camera] += u32::from(!found.people[camera].is_empty());
        }
        sighted.push(found.people);
    }
    let share = |(matched, shown): (&u32, &u32)| if *shown > 0 { f64::from(*matched) / f64::from(*shown) } else { 1.0 };
    Agreement { shares: matched.iter().zip(&shown).map(share).collect(), residual_px: residual(cameras, &sighted, 1.0) }
}

impl Agreement {
    fn is_perfect(&self, cameras: &[Camera]) -> bool {
        let fits = self.residual_px.is_some_and(|px| !is_doubtful(cameras, px));
        fits && self.shares.iter().all(|share| *share >= AGREEING)
    }
}

/// Refuses calibrations of which two are exchanged: frames show all people of each camera.
///
/// # Errors
/// The two cameras with which everything fits.
pub fn check(cameras: &[Camera], frames: &[Vec<Vec<Person>>], config: &Config) -> Result<(), SetupError> {
    if cameras.len() < 3 || cameras.len() > MOST || frames.is_empty() {
        return Ok(());
    }
    let now = agreement(cameras, frames, config);
    let disagree = now.shares.iter().any(|share| *share < DISAGREEING);
    let now_px = now.residual_px.unwrap_or(f64::INFINITY);
    if !disagree && per_diagonal(cameras, now_px) <= SUSPICIOUS {
        return Ok(());
    }
    let pairs = (0..cameras.len()).flat_map(|a| (a + 1..cameras.len()).map(move |b| (a, b)));
    let fitting = pairs.filter_map(|(a, b)| {
        let mut exchanged = cameras.to_vec();
        exchanged.swap(a, b);
        let found = agreement(&exchanged, frames, config);
        let residual_px = found.residual_px.filter(|px| disagree || *px < BETTER * now_px)?;
        found.is_perfect(&exchanged).then_some((a, b, residual_px))
    });
    match fitting.min_by(|x, y| x.2.total_cmp(&y.2)) {
        None => Ok(()),
        Some((a, b, residual_px)) => {
            let mut cameras = [a, b].map(|camera| cameras[camera].name.clone());
            cameras.sort();
            Err(SetupError::ExchangedCameras { cameras, residual_px })
        }
    }
}
