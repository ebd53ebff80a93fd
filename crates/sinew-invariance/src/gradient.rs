//! Gradients against central differences, along every coordinate.
//!
//! A wrong gradient under a right acceptance rule keeps the target: no test of invariance can see it. This one does.

use crate::report::{Bound, Report, Statistic};

/// How differences are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Differences {
    /// Half the distance between the two points, relative to max(1, |x_j|).
    pub step: f64,
    /// Largest error, relative to the largest entry of the gradient at that point or to 1.
    pub tolerance: f64,
}

impl Default for Differences {
    fn default() -> Self {
        Self { step: 1e-5, tolerance: 1e-6 }
    }
}

/// Compares `log_density_grad(x, grad)`, which returns the log density and writes its gradient, with differences of its own values at each point. Points where the log density is not finite are refused: they fail.
pub fn gradient(
    config: &Differences,
    log_density_grad: impl Fn(&[f64], &mut [f64]) -> f64,
    points: &[Vec<f64>],
) -> Report {
    let mut found = vec![];
    for (i, x) in points.iter().enumerate() {
        let mut claimed = vec![0.0; x.len()];
        let value = log_density_grad(x, &mut claimed);
        let scale = claimed.iter().fold(1.0_f64, |m, g| m.max(g.abs()));
        let mut scratch = vec![0.0; x.len()];
        let (mut worst, mut at) = (0.0_f64, 0);
        for j in 0..x.len() {
            let h = config.step * x[j].abs().max(1.0);
            let mut shifted = |by: f64| {
                let mut y = x.clone();
                y[j] += by;
                log_density_grad(&y, &mut scratch)
            };
            let difference = (shifted(h) - shifted(-h)) / (2.0 * h);
            let error = (claimed[j] - difference).abs() / scale;
            if error > worst || error.is_nan() {
                (worst, at) = (error, j);
            }
        }
        found.push(Statistic {
            name: format!("entry {at} at point {i}"),
            value: if value.is_finite() { worst } else { f64::NAN },
            bound: Bound::Range { least: f64::NEG_INFINITY, most: config.tolerance },
        });
    }
    Report::exact(
        "gradient",
        format!("central differences of step {:e} at {} points", config.step, points.len()),
        "an entry of the gradient is wrong, or value and gradient belong to different densities",
        found,
    )
}
