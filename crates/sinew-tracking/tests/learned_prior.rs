//! The HMC filter under the Gaussian of action primitives: what it draws is the posterior of that prior.

mod common;

use common::Sight;
use sinew_core::combinators::Sum;
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Isa, LANES, get_lane};
use sinew_core::random::Stage;
use sinew_core::transition::{Cloud, FramePrior, Moments, MotionModel, Predict};
use sinew_dynamics::primitives::learning::{Config, TrainingMotion, learn};
use sinew_dynamics::primitives::model::{FeatureVector, PrimitiveModel};
use sinew_dynamics::primitives::motion::PrimitiveMotion;
use sinew_dynamics::random_walk::Between;
use sinew_samplers::diagnostics::effective_sample_size;
use sinew_tracking::hmc_filter::{self, HmcFilter};
use sinew_tracking::{Inferred, StepInfo, Tracker};

const DIM: usize = 3;
const RATE_HZ: f64 = 20.0;
/// Precision of what is seen: the first two coordinates well, the last hardly.
const SEEN: [f64; DIM] = [400.0, 900.0, 1.0];

/// One coordinate stands still, two swing.
fn swing(frame: usize) -> [f64; DIM] {
    let phase = 0.37 * frame as f64;
    [0.1, phase.sin(), 0.6 * (0.8 * phase).cos()]
}

fn model() -> PrimitiveModel {
    let sequence: Vec<f64> = (0..300).flat_map(swing).collect();
    let motion =
        TrainingMotion { state: "swing", dim: DIM, frame_rate: RATE_HZ, sequences: &[sequence], horizontal: &[] };
    let feature = FeatureVector { name: "swing".into(), coordinates: vec![2, 1] };
    let mut config = Config::default();
    config.mixture.components = 10;
    learn(&motion, &[feature], &config, Stage::new(1, "learned prior"), &mut |_| {}).expect("valid")
}

fn sight(frame: usize) -> Sight {
    Sight::new(swing(frame).to_vec(), SEEN.to_vec(), false)
}

fn mean(series: &[Vec<f64>]) -> f64 {
    series.iter().flatten().sum::<f64>() / series.iter().map(Vec::len).sum::<usize>() as f64
}

/// For a Gaussian target of precision Λ the gradient at a draw is N(0, Λ): its mean over the draws is nothing, its mean square Λ_jj.
#[test]
fn its_draws_have_the_gradients_of_their_gaussian_posterior() {
    let motion = PrimitiveMotion::new(&model(), "swing", 1.0 / RATE_HZ, Isa::best()).expect("valid");
    let mut motion = motion.with_between(Between::Gaussian);
    let config = hmc_filter::Config::real_recordings();
    let (chains, updates) = (config.chains, config.updates);
    let mut filter = HmcFilter::new(config, motion.clone(), swing(0).to_vec(), Isa::best()).expect("valid");
    let moments = Moments { mean: vec![0.0; DIM], covariance: vec![0.0; DIM * DIM] };
    for frame in 0..12 {
        let posterior = filter.posterior();
        let (last, count) = (posterior.states.to_vec(), posterior.weights.len());
        let stage = Stage::new(3, "filter").at_frame(frame as u32);
        let info: StepInfo = filter.step(&sight(frame), stage).expect("a posterior");
        if motion.is_matching() {
            assert_eq!(info.trajectories, chains * updates, "frame {frame}: chains disagree");
            let prior = motion.predict(Cloud { last: &last, count, moments: &moments }).expect("valid");
            let target = sight(frame);
            let target = Sum(&target, &prior);
            let draws = filter.posterior().states.to_vec();
            let (mut state, mut gradient) = ([0.0; DIM], [0.0; DIM]);
            let mut series = vec![vec![vec![]; chains]; DIM];
            for i in 0..filter.posterior().weights.len() {
                get_lane(&draws[i / LANES * DIM..][..DIM], i % LANES, &mut state);
                target.log_density_grad(&state, &mut gradient);
                series.iter_mut().zip(gradient).for_each(|(series, g)| series[i % chains].push(g));
            }
            for (j, mut series) in series.into_iter().enumerate() {
                let precision = SEEN[j] + prior.precision_diagonal()[j];
                let z = mean(&series) / (precision / effective_sample_size(&series)).sqrt();
                assert!(z.abs() < 4.5, "frame {frame}, coordinate {j}: z = {z}, bound 4.5");
                series.iter_mut().flatten().for_each(|g| *g *= *g / precision);
                let z = (mean(&series) - 1.0) / (2.0 / effective_sample_size(&series)).sqrt();
                assert!(z.abs() < 4.5, "frame {frame}, coordinate {j}: square, z = {z}, bound 4.5");
            }
        }
        motion.follow(None, filter.estimate());
    }
}
