//! The smallest program: a normal distribution, its mean and its deviation.

use sinew_samplers::{Density, Error, nuts};

/// N(3, 2²).
struct Normal;

impl Density for Normal {
    fn dim(&self) -> usize {
        1
    }
    fn log_density(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let z = (x[0] - 3.0) / 2.0;
        gradient[0] = -z / 2.0;
        -0.5 * z * z
    }
}

fn main() -> Result<(), Error> {
    println!("{}", nuts::sample(&Normal, nuts::Settings::default())?.summary());
    Ok(())
}
