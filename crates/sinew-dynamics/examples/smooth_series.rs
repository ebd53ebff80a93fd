//! A noisy series with a gap: filtered, smoothed, with its log evidence.

use sinew_core::transition::Moments;
use sinew_dynamics::kalman::{Form, Kalman, Model};

fn main() -> Result<(), sinew_dynamics::Error> {
    let seen = [0.1, 0.9, 1.8, f64::NAN, f64::NAN, 5.2, 5.9, 7.1];
    let observations: Vec<_> = seen.iter().map(|y| vec![y.is_finite().then_some(*y)]).collect();
    // Place and speed, of which the place is seen with variance 0.04.
    let cart = Model {
        dim: 2,
        matrix: vec![1.0, 1.0, 0.0, 1.0],
        noise: vec![0.001, 0.0, 0.0, 0.01],
        observation: vec![1.0, 0.0],
        error: vec![0.04],
    };
    let filter = Kalman::new(cart, Form::SquareRoot)?;
    let start = Moments { mean: vec![0.0, 1.0], covariance: vec![1.0, 0.0, 0.0, 0.25] };
    let frames = filter.filter(&start, &observations)?;
    for ((seen, frame), smoothed) in seen.iter().zip(&frames).zip(filter.smooth(&frames)?) {
        let [now, then] =
            [&frame.filtered, &smoothed].map(|m| format!("{:.2} ± {:.2}", m.mean[0], m.covariance[0].sqrt()));
        println!("seen {seen:4.1}, filtered {now}, smoothed {then}");
    }
    println!("log evidence {:.3}", frames.iter().map(|frame| frame.log_likelihood).sum::<f64>());
    Ok(())
}
