//! Eight schools (Rubin 1981), non-centred, with named coordinates, the parameters themselves in the summary, and the warm-up's draws.

use sinew_samplers::{Density, Error, check_gradient, nuts};

const EFFECT: [f64; 8] = [28.0, 8.0, -3.0, 7.0, -1.0, 1.0, 18.0, 12.0];
const ERROR: [f64; 8] = [15.0, 10.0, 16.0, 11.0, 9.0, 11.0, 10.0, 18.0];

/// y_j ~ N(μ + τ t_j, s_j²), t_j ~ N(0, 1), μ ~ N(0, 5²), τ ~ Cauchy(0, 5) above 0; the state is (t, μ, ln τ).
struct Schools;

impl Density for Schools {
    fn dim(&self) -> usize {
        10
    }
    fn log_density(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let (mu, tau) = (x[8], x[9].exp());
        let mut value = -mu * mu / 50.0 - (tau * tau / 25.0).ln_1p() + x[9];
        (gradient[8], gradient[9]) = (-mu / 25.0, 1.0 - 2.0 * tau * tau / (25.0 + tau * tau));
        for j in 0..8 {
            let z = (EFFECT[j] - mu - tau * x[j]) / ERROR[j];
            value -= 0.5 * (x[j] * x[j] + z * z);
            gradient[j] = tau * z / ERROR[j] - x[j];
            gradient[8] += z / ERROR[j];
            gradient[9] += tau * x[j] * z / ERROR[j];
        }
        value
    }
}

fn main() -> Result<(), Error> {
    check_gradient(&Schools, &[0.3; 10])?;
    let settings = nuts::Settings { seed: 42, acceptance: 0.95, keep_warm_up: true, ..Default::default() };
    let run = nuts::sample(&Schools, settings)?;
    let names = (1..=8).map(|j| format!("theta[{j}]")).chain(["mu".into(), "tau".into()]);
    let schools = run.map(names, |x, theta| {
        let (mu, tau) = (x[8], x[9].exp());
        (0..8).for_each(|j| theta[j] = mu + tau * x[j]);
        (theta[8], theta[9]) = (mu, tau);
    });
    println!("{}", schools.summary());
    if let Some(warm_up) = &schools.warm_up {
        println!("first draws of tau in the warm-up: {:.2?}", &warm_up.series(9)[0][..5]);
    }
    Ok(())
}
