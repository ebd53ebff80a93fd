//! A boat followed by Hamiltonian Monte Carlo from its distances to two beacons, whose errors have heavy tails: the observation has a gradient and no curvature.
//!
//! `cargo run --release -p sinew-tracking --example gradient_only`

use sinew_core::combinators::GivenCurvature;
use sinew_core::density::{GradLogDensity, LogDensity};
use sinew_core::lanes::Isa;
use sinew_core::random::Stage;
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_tracking::hmc_filter::{Config, HmcFilter};
use sinew_tracking::{Inferred, Tracker};

const BEACONS: [[f64; 2]; 2] = [[0.0, 0.0], [10.0, 0.0]];
/// Scale of the distances' errors.
const SCALE: f64 = 0.2;

/// Distances to the beacons, log p = −2 Σ ln(1 + (r / SCALE)² / 3): Student's t with three degrees.
struct Distances([f64; 2]);

impl LogDensity for Distances {
    fn dim(&self) -> usize {
        2
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut [0.0; 2])
    }
}

impl GradLogDensity for Distances {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        grad.fill(0.0);
        let mut value = 0.0;
        for (beacon, seen) in BEACONS.iter().zip(self.0) {
            let way = [x[0] - beacon[0], x[1] - beacon[1]];
            let distance = way[0].hypot(way[1]).max(1e-9);
            let error = (distance - seen) / SCALE;
            value -= 2.0 * (error * error / 3.0).ln_1p();
            let slope = -4.0 * error / (3.0 + error * error) / SCALE / distance;
            grad.iter_mut().zip(way).for_each(|(g, way)| *g += slope * way);
        }
        value
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let walk = RandomWalk::new(&[0.5; 2], 1.0, Between::Gaussian, Isa::best())?.with_initial_sd(vec![1.0; 2])?;
    let mut filter = HmcFilter::new(Config::real_recordings(), walk, vec![3.0, 4.0], Isa::best())?;
    for frame in 0..10 {
        let boat = [3.0 + 0.4 * f64::from(frame), 4.0 + 0.2 * f64::from(frame)];
        let mut seen = BEACONS.map(|b| (boat[0] - b[0]).hypot(boat[1] - b[1]));
        // One distance is 3 off, as by an echo.
        seen[0] += if frame == 5 { 3.0 } else { 0.1 };
        // Near the truth a distance's curvature is 4 / (3 SCALE²).
        let observed = GivenCurvature { target: Distances(seen), diagonal: vec![4.0 / 3.0 / SCALE / SCALE; 2] };
        let info = filter.step(&observed, Stage::new(1, "boat").at_frame(frame))?;
        let sd = filter.posterior().sd(&info.mean);
        let [x, y] = [0, 1].map(|k| format!("{:5.2} ± {:.2}", info.mean[k], sd[k]));
        let r_hat = info.r_hat.unwrap_or(f64::NAN);
        println!("{frame}: x {x}, y {y}, truly {:.1} and {:.1}, R-hat {r_hat:.2}", boat[0], boat[1]);
    }
    Ok(())
}
