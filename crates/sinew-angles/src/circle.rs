//! Angles on the circle: 359° and 1° are 2° apart, and their mean is 0°.
//!
//! The mean direction of angles is arg Σ exp(j θ). Their mean is that of the angles of the same directions which are nearest to it: of angles on one side of the cut at half a turn it is the plain mean.
//! All functions take a whole turn in the unit of their angles: [`TURN_RAD`] or [`TURN_DEG`].

/// A whole turn, radians.
pub const TURN_RAD: f64 = std::f64::consts::TAU;

/// A whole turn, degrees.
pub const TURN_DEG: f64 = 360.0;

/// The angle of the same direction that is nearest to another angle.
#[must_use]
pub fn near(angle: f64, other: f64, turn: f64) -> f64 {
    angle - turn * ((angle - other) / turn).round()
}

/// Mean direction of angles, within half a turn of 0.
#[must_use]
pub fn direction(angles: impl Iterator<Item = f64>, turn: f64) -> f64 {
    let unit = TURN_RAD / turn;
    let (sin, cos) = angles.fold((0.0, 0.0), |(s, c), x| (s + (unit * x).sin(), c + (unit * x).cos()));
    f64::atan2(sin, cos) / unit
}

/// Mean of angles, each taken nearest to their mean direction; NaN of none.
#[must_use]
pub fn mean(angles: &[f64], turn: f64) -> f64 {
    let middle = direction(angles.iter().copied(), turn);
    angles.iter().map(|angle| near(*angle, middle, turn)).sum::<f64>() / angles.len() as f64
}

/// Whole turns that make a series continuous, one for each angle: each angle plus its own lies nearest to the one before. Angles that are not finite are passed over.
pub fn turns(series: impl Iterator<Item = f64>, turn: f64) -> impl Iterator<Item = f64> {
    let mut before: Option<f64> = None;
    series.map(move |angle| {
        if !angle.is_finite() {
            return 0.0;
        }
        let continuous = before.map_or(angle, |before| near(angle, before, turn));
        before = Some(continuous);
        continuous - angle
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_and_means_do_not_know_the_cut() {
        for (turn, unit) in [(TURN_DEG, 1.0), (TURN_RAD, TURN_RAD / TURN_DEG)] {
            let of = |angles: &[f64]| angles.iter().map(|x| x * unit).collect::<Vec<f64>>();
            let across = of(&[179.0, -177.0, 181.0, 537.0, -180.0]);
            assert!((direction(across.iter().copied(), turn) / unit - 180.0).abs() < 1e-9);
            assert!((mean(&across, turn) / unit - 180.0).abs() < 1e-9);
            // Off the cut it is the plain mean, which no direction of a skew set is.
            let skew = of(&[10.0, 20.0, 90.0]);
            assert!((mean(&skew, turn) / unit - 40.0).abs() < 1e-9);
            assert!((direction(skew.iter().copied(), turn) / unit - 40.0).abs() > 1.0);
            assert!((near(-170.0 * unit, 175.0 * unit, turn) / unit - 190.0).abs() < 1e-9);
        }
        assert!(mean(&[], TURN_DEG).is_nan());
    }

    #[test]
    fn a_series_that_goes_round_is_made_continuous() {
        let goes = |k: i32| 50.0 * f64::from(k);
        let within = |k: i32| (goes(k) + 180.0).rem_euclid(360.0) - 180.0;
        let series: Vec<f64> = (0..20).map(|k| if k == 7 { f64::NAN } else { within(k) }).collect();
        for (k, by) in turns(series.iter().copied(), TURN_DEG).enumerate().filter(|(k, _)| *k != 7) {
            assert!((series[k] + by - goes(k as i32)).abs() < 1e-9, "{k}: {}", series[k] + by);
        }
    }
}
