//! What is known of a constant number after the set-up, beside what was known before.

use super::lasting_errors::MeasuredErrors;
use super::lasting_prior::{HEAVY, KIND_SCALES, LAG_SCALE, SCALES, kind, place_scale};
use sinew_observe::offsets::median;

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
        let count = number.draws.len() as f64;
        let mean = number.draws.iter().sum::<f64>() / count;
        let variance = number.draws.iter().map(|draw| (draw - mean).powi(2)).sum::<f64>() / count;
        KnownNumber {
            mean: number.value + if self.layout().lags().contains(&place) { mean } else { 0.0 },
            sd: variance.sqrt(),
            prior_mean: number.prior_mean,
            prior_sd: number.prior_sd * self.spread(place),
        }
    }

    /// Standard deviation of the prior of a number over its size at the median of its scale: tails and draws of the scale widen it.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_learned_where_half_of_its_variance_is_gone() {
        let known = |sd| KnownNumber { mean: 1.0, sd, prior_mean: 0.0, prior_sd: 2.0 };
        assert!(known(1.4).is_learned() && !known(1.42).is_learned() && !known(f64::NAN).is_learned());
    }
}
