//! What is known of a constant number after the set-up, beside what was known before.

use super::lasting_errors::{DrawnNumber, MeasuredErrors};
use super::lasting_prior::{HEAVY, KIND_SCALES, LAG_SCALE, SCALES, kind, place_scale};
use sinew_core::estimators::median;

/// A constant number: its posterior and its prior.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownNumber {
    /// Mean of the posterior.
    pub mean: f64,
    /// Its standard deviation.
    pub sd: f64,
    /// Mean of the prior.
    pub prior_mean: f64,
    /// Standard deviation of the prior, with the draws of its scale.
    pub prior_sd: f64,
}

/// Share of the prior's variance that is left where the data say as much as the prior.
const AS_MUCH: f64 = 0.5;

impl KnownNumber {
    /// Whether the data say more of it than the prior did.
    #[must_use]
    pub fn is_learned(&self) -> bool {
        self.sd.powi(2) < AS_MUCH * self.prior_sd.powi(2)
    }
}

impl MeasuredErrors {
    /// What is known of the number at a place.
    #[must_use]
    pub fn known(&self, place: usize) -> KnownNumber {
        let number = &self.number[place];
        KnownNumber {
            mean: number.value,
            sd: moments(&number.draws).1,
            prior_mean: number.prior_mean,
            prior_sd: number.prior_sd * self.spread(place),
        }
    }

    /// What is known of how much later a camera is than the mean of all; `None` with one camera. The prior is at the median of its scale: the few draws of a large one say nothing of most.
    #[must_use]
    pub fn lag_between(&self, camera: usize) -> Option<KnownNumber> {
        let lags = &self.number[self.layout().lags()];
        let (count, at) = (lags.len() as f64, |lag: &DrawnNumber, draw: usize| lag.value + lag.draws[draw]);
        let between = |draw: usize| at(&lags[camera], draw) - lags.iter().map(|lag| at(lag, draw)).sum::<f64>() / count;
        let (mean, sd) = moments(&(0..self.draws()).map(between).collect::<Vec<_>>());
        let prior_sd = self.number[self.layout().lag(camera)].prior_sd * (HEAVY * (1.0 - count.recip())).sqrt();
        (lags.len() > 1).then_some(KnownNumber { mean, sd, prior_mean: 0.0, prior_sd })
    }

    /// Standard deviation of the lag that all cameras share, a shift of time that nothing shows, seconds.
    #[must_use]
    pub fn common_lag_sd_s(&self) -> f64 {
        let lags = self.layout().lags();
        let mean = |draw: usize| {
            lags.clone().map(|place| self.number[place].draws[draw]).sum::<f64>() / lags.len().max(1) as f64
        };
        moments(&(0..self.draws()).map(mean).collect::<Vec<_>>()).1
    }

    /// Standard deviation of the prior of a number, divided by what it is at the median of the prior's scale: above 1, since heavy tails and an uncertain scale widen the prior.
    fn spread(&self, place: usize) -> f64 {
        let layout = self.layout();
        let (scale, tails) = if place < layout.lengths().start {
            (SCALES[0], HEAVY)
        } else if layout.lengths().contains(&place) {
            return 1.0;
        } else if layout.places().contains(&place) {
            let point = (place - layout.places().start) / 3;
            (SCALES[place_scale(&self.points[point])], 1.0)
        } else if layout.lags().contains(&place) {
            (LAG_SCALE, HEAVY)
        } else {
            let point = (place - layout.places().end) / 2 % layout.points;
            (KIND_SCALES[kind(&self.points[point])], HEAVY)
        };
        let Some(draws) = self.scale(scale) else { return 1.0 };
        let square = draws.iter().map(|scale| scale * scale).sum::<f64>() / draws.len() as f64;
        (tails * square).sqrt() / median(&mut draws.to_vec())
    }
}

/// Mean and standard deviation.
fn moments(draws: &[f64]) -> (f64, f64) {
    let count = draws.len() as f64;
    let mean = draws.iter().sum::<f64>() / count;
    (mean, (draws.iter().map(|draw| (draw - mean).powi(2)).sum::<f64>() / count).sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::lasting_errors::VERSION;
    use super::*;

    #[test]
    fn a_number_is_learned_where_half_of_its_variance_is_gone() {
        let known = |sd| KnownNumber { mean: 1.0, sd, prior_mean: 0.0, prior_sd: 2.0 };
        assert!(known(1.4).is_learned() && !known(1.42).is_learned() && !known(f64::NAN).is_learned());
    }

    /// Two cameras that are late by the same in all draws but a millisecond between them: that is known, and what they share is not.
    #[test]
    fn lags_are_known_between_cameras() {
        let number = |draws: [f64; 2], prior_sd| DrawnNumber {
            name: "n".into(),
            value: 0.0,
            prior_mean: 0.0,
            prior_sd,
            draws: draws.to_vec(),
        };
        let mut known = MeasuredErrors {
            version: VERSION,
            cameras: vec!["C1".into(), "C2".into()],
            middle_m: [0.0; 3],
            frames: 2,
            worth: 2.0,
            persistence_s: 0.1,
            ..MeasuredErrors::default()
        };
        let others = known.layout().lags().start;
        known.number = (0..others).map(|_| number([0.0; 2], 1.0)).collect();
        known.number.extend([number([0.011, -0.009], 0.005), number([0.009, -0.011], 0.005)]);
        let later = known.lag_between(0).unwrap();
        assert!((later.mean - 0.001).abs() < 1e-12 && later.sd < 1e-12 && (later.prior_sd - 0.005).abs() < 1e-12);
        assert!(later.is_learned() && (known.common_lag_sd_s() - 0.01).abs() < 1e-12);
        known.cameras.pop();
        known.number.remove(others);
        known.number.truncate(known.layout().count());
        assert_eq!(known.lag_between(0), None);
    }
}
