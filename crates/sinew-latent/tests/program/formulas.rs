//! Formulas of the covariance and of the units of outputs, worked by hand.

use sinew_latent::covariance::Covariance;
use sinew_latent::outputs::{Preparation, Standard};

#[test]
fn a_covariance_has_a_squared_exponential_a_linear_and_a_constant_part() {
    let covariance = Covariance { variance: 2.0, inverse_width: 0.5, linear: 3.0, bias: 0.25, white: 7.0 };
    let (x, y) = ([1.0, -2.0], [0.5, 1.0]);
    // |x − y|² = 0.25 + 9, x·y = 0.5 − 2.
    let expected = 2.0 * (-0.25 * 9.25_f64).exp() + 3.0 * -1.5 + 0.25;
    assert!((covariance.between(&x, &y) - expected).abs() < 1e-14);
    assert_eq!(covariance.at(&x), 17.25);
    assert!((covariance.between(&x, &x) - covariance.at(&x)).abs() < 1e-14);
}

/// Columns 1, 3 and 10, 40: means 2 and 25, standard deviations 1 and 15.
#[test]
fn outputs_are_seen_less_their_mean_over_their_spread() {
    let rows = [1.0, 10.0, 3.0, 40.0];
    let standard = Standard::new(&rows, 2, Preparation::Standardised).unwrap();
    assert_eq!(standard.apply(&rows), [-1.0, -1.0, 1.0, 1.0]);
    assert_eq!(standard.apply(&[4.0, 32.5]), [2.0, 0.5]);
    assert_eq!([standard.restore(0, 2.0), standard.restore(1, 0.5)], [4.0, 32.5]);
}
