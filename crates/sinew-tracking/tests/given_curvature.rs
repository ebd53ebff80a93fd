//! The filter by Hamiltonian Monte Carlo on an observation that has a gradient and no curvature, against the Kalman filter.

use sinew_core::combinators::GivenCurvature;
use sinew_core::density::{GradLogDensity, LogDensity};
use sinew_core::lanes::Isa;
use sinew_core::random::Stage;
use sinew_core::transition::Moments;
use sinew_dynamics::kalman::{Form, Kalman, Model};
use sinew_dynamics::linear_gaussian::LinearGaussian;
use sinew_samplers::metric::Geometry;
use sinew_tracking::hmc_filter::{Config, HmcFilter};
use sinew_tracking::{Inferred, Tracker};

const TURN: [f64; 4] = [0.95, 0.2, -0.2, 0.95];
const NOISE: [f64; 4] = [0.3, 0.1, 0.1, 0.2];
const START: [f64; 4] = [1.0, 0.0, 0.0, 1.0];
const PRECISION: [f64; 2] = [4.0, 9.0];
const SEEN: [[f64; 2]; 6] = [[0.4, -1.1], [0.3, -1.6], [-0.2, -0.9], [-0.6, -1.3], [-1.4, -0.4], [-0.9, 0.2]];

/// Both coordinates seen with errors of [`PRECISION`].
struct Sight([f64; 2]);

impl LogDensity for Sight {
    fn dim(&self) -> usize {
        2
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        (0..2).map(|j| -0.5 * PRECISION[j] * (x[j] - self.0[j]).powi(2)).sum()
    }
}

impl GradLogDensity for Sight {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        (0..2).for_each(|j| grad[j] = -PRECISION[j] * (x[j] - self.0[j]));
        self.log_density(x)
    }
}

/// Root mean squares over frames and coordinates: of the mean's error in exact standard deviations, of the variance's as a share.
fn errors(geometry: Geometry, diagonal: [f64; 2], exact: &[Moments]) -> [f64; 2] {
    let motion = LinearGaussian::new(2, TURN.to_vec(), NOISE.to_vec(), START.to_vec(), Isa::best()).expect("valid");
    let config = Config { chains: 16, updates: 400, leapfrog_steps: 6, jitter: 0.2, geometry, ..Config::default() };
    let mut filter = HmcFilter::new(config, motion, vec![0.0; 2], Isa::best()).expect("valid");
    let mut sums = [0.0; 2];
    for (frame, (seen, exact)) in SEEN.into_iter().zip(exact).enumerate() {
        let observed = GivenCurvature { target: &Sight(seen), diagonal: diagonal.to_vec() };
        let info = filter.step(&observed, Stage::new(3, "given").at_frame(frame as u32)).expect("posterior");
        let found = filter.posterior().moments(Isa::best());
        for j in 0..2 {
            let variance = exact.covariance[3 * j];
            sums[0] += (info.mean[j] - exact.mean[j]).powi(2) / variance;
            sums[1] += (found.covariance[3 * j] / variance - 1.0).powi(2);
        }
    }
    sums.map(|sum| (sum / (2 * SEEN.len()) as f64).sqrt())
}

/// Some 3000 effective draws a frame: errors of 0.02 and 0.03.
#[test]
fn no_diagonal_moves_the_posterior() {
    let [a, b] = PRECISION.map(f64::recip);
    let observation = vec![1.0, 0.0, 0.0, 1.0];
    let model =
        Model { dim: 2, matrix: TURN.to_vec(), noise: NOISE.to_vec(), observation, error: vec![a, 0.0, 0.0, b] };
    let start = Moments { mean: vec![0.0; 2], covariance: START.to_vec() };
    let filtered = Kalman::new(model, Form::Joseph).expect("valid").filter(&start, &SEEN.map(|z| z.map(Some).to_vec()));
    let exact: Vec<Moments> = filtered.expect("positive definite").into_iter().map(|frame| frame.filtered).collect();
    for geometry in [Geometry::Diagonal, Geometry::Dense] {
        for diagonal in [[0.0, 0.0], PRECISION, [30.0, 0.0]] {
            let found = errors(geometry, diagonal, &exact);
            assert!(found[0] < 0.08 && found[1] < 0.1, "{geometry:?}, {diagonal:?}: {found:?}");
        }
    }
}
