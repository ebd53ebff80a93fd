//! What was found to be constant, as the set-up stores it.

use super::Fit;
use crate::lasting_errors::{DrawnNumber, DrawnScale, MeasuredErrors, VERSION};
use crate::lasting_prior::SCALES;
use crate::lasting_sources::PointSources;
use crate::stored::Setup;
use sinew_body::point_derivatives::{length_names, lengthened};
use sinew_dynamics::lasting_scales::LastingDraws;
use sinew_observe::lasting::lasting_errors::LastingErrors;

/// Digits of a draw.
const DIGITS: usize = 5;

impl Fit {
    /// Puts what was found into the set-up; lengths become the body's own. What all lags share is 0 in the mean, since nothing shows it.
    pub(super) fn store(mut self, setup: &mut Setup, found: LastingDraws, source: Vec<PointSources>) {
        let Self { errors, points, middle, frames, model, expected, .. } = &self;
        let cameras: Vec<String> = setup.camera.iter().map(|camera| camera.name.clone()).collect();
        let common = common_lag(errors, &found);
        let number = |(place, name): (usize, String)| {
            let shared = if errors.lags().contains(&place) { common } else { 0.0 };
            let value = rounded(found.mean[place] - shared);
            let draws = found.errors.iter().map(|g| rounded(g[place] - shared - value)).collect();
            let base = if errors.lengths().contains(&place) { value } else { 0.0 };
            let [prior_mean, prior_sd] = [expected[place][0] - base, expected[place][1]].map(rounded);
            DrawnNumber { name, value: value - base, prior_mean, prior_sd, draws }
        };
        let scale = |(k, name): (usize, &str)| DrawnScale {
            name: name.into(),
            draws: found.scales.iter().map(|scales| rounded(scales[k])).collect(),
        };
        let longer: Vec<f64> = errors.lengths().map(|place| rounded(found.mean[place])).collect();
        setup.lasting = Some(MeasuredErrors {
            version: VERSION,
            blind_cameras: (0..cameras.len())
                .filter(|c| !self.shows_somebody(*c))
                .map(|c| cameras[c].clone())
                .collect(),
            number: errors.names(&cameras, &length_names(), points).into_iter().enumerate().map(number).collect(),
            cameras,
            points: points.clone(),
            middle_m: middle.map(rounded),
            frames: frames.len(),
            worth: rounded(self.worth * frames.len() as f64),
            persistence_s: rounded(self.persistence_s),
            scale: SCALES.into_iter().enumerate().map(scale).collect(),
            source: source.into_iter().map(|source| source.map(rounded)).collect(),
        });
        for (known, view) in setup.camera.iter_mut().zip(&model.views) {
            known.sigma_px = view.sigma_px;
        }
        setup.model_error_m = model.model_error_m;
        setup.store_mistakes(&model.mistakes);
        setup.proportions = lengthened(&setup.proportions, &longer);
        self.frames.retain(|frame| frame.number == setup.start_frame);
        if let Some(frame) = self.frames.pop() {
            setup.start_pose = frame.pose;
        }
    }

    /// Whether a camera has a keypoint in any frame.
    fn shows_somebody(&self, camera: usize) -> bool {
        self.frames.iter().any(|frame| frame.detections[camera].iter().any(Option::is_some))
    }
}

/// Mean, over draws and cameras, of their lags.
fn common_lag(errors: &LastingErrors, found: &LastingDraws) -> f64 {
    let all = || found.errors.iter().flat_map(|g| &g[errors.lags()]);
    all().sum::<f64>() / all().count().max(1) as f64
}

/// A number with few digits, as it is stored.
fn rounded(x: f64) -> f64 {
    format!("{x:.*e}", DIGITS - 1).parse().unwrap_or(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_stored_with_few_digits() {
        assert_eq!(rounded(0.123_456_78), 0.12346);
        assert_eq!(rounded(0.0), 0.0);
        assert_eq!(rounded(-1.0 / 3.0), -0.33333);
    }
}
