//! Numerical trouble has a defined end: one particle, extreme step sizes, energy errors, a hundred frames without observation.

use sinew::core::density::{GaussNewton, GradLogDensity, Lanes, LogDensity};
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::core::random::Stage;
use sinew::core::toy::Quadratic;
use sinew::dynamics::linear_gaussian::LinearGaussian;
use sinew::samplers::Error;
use sinew::samplers::chains::{Schedule, draw_trajectories};
use sinew::samplers::hmc::{Chains, Hmc, Workspace, update};
use sinew::samplers::metric::Metric;
use sinew::samplers::tuning::{self, StepSizeTrial};
use sinew::tracking::bootstrap::{self, Bootstrap};
use sinew::tracking::hmc_filter::{self, HmcFilter};
use sinew::tracking::{Inferred, Tracker};
use sinew_tests::linear_series::{MixtureBetween, Series};

fn quadratic(precision: f64) -> Lanes<Quadratic> {
    Lanes { leaf: Quadratic { centre: vec![0.0; 2], precision: vec![precision; 2] }, isa: Isa::best() }
}

/// One particle is a filter with no spread; none is refused; numbers that do not fill a block are as good as any.
#[test]
fn one_particle_is_a_filter_and_none_is_refused() {
    let series = Series::simulated(2, 5, &Stage::new(1, "one particle"));
    for particles in [0, 1, 3, 9] {
        let config = bootstrap::Config { particles, ..bootstrap::Config::default() };
        let filter = Bootstrap::new(config, series.model(), series.m0.clone());
        if particles == 0 {
            let Err(error) = filter else { panic!("no particles are no filter") };
            assert!(error.to_string().contains("at least 1"), "{error}");
            continue;
        }
        let mut filter = filter.expect("valid");
        for frame in 0..5 {
            let info =
                filter.step(&series.sight(frame), Stage::new(1, "step").at_frame(frame as u32)).expect("weights");
            assert!(
                info.mean.iter().all(|m| m.is_finite())
                    && info.ess >= 1.0 - 1e-12
                    && info.ess <= particles as f64 + 1e-9
            );
            assert!(info.log_evidence.is_some_and(f64::is_finite));
        }
        if particles == 1 {
            let moments = filter.posterior().moments(Isa::best());
            assert_eq!(moments.covariance, [0.0; 4]);
        }
    }
}

/// A step of 10¹⁰ diverges always and moves nothing; one of 10⁻³⁰⁰ is accepted always; NaN, 0 and infinity are refused.
#[test]
fn extreme_step_sizes_have_a_defined_end() {
    let target = quadratic(1.0);
    let starts = vec![Block::splat(0.5); 2];
    let schedule = Schedule { updates: 50, burn_in: 0 };
    let run = |eta: f64| {
        let hmc = Hmc::new(eta, &[1.0; 2], 5, 0.2, Isa::best())?;
        draw_trajectories(&target, &hmc, &starts, LANES, schedule, &Stage::new(1, "extreme"))
    };
    for eta in [1e10, 1e150, f64::MAX] {
        let wild = run(eta).expect("defined");
        assert_eq!((wild.divergences, wild.acceptance), (50 * LANES, 0.0), "{eta}");
        assert_eq!(wild.last, starts, "{eta}");
        assert!(wild.stats.iter().all(|s| s.energy.is_finite() && s.log_density.is_finite()), "{eta}");
    }
    for eta in [1e-300, f64::MIN_POSITIVE, 5e-324] {
        let still = run(eta).expect("defined");
        assert!(still.divergences == 0 && (still.acceptance - 1.0).abs() < 1e-12 && still.last == starts, "{eta}");
    }
    for eta in [f64::NAN, f64::INFINITY, 0.0, -1.0] {
        assert!(matches!(run(eta), Err(Error::OutOfRange { name: "step size", .. })), "{eta}");
    }
}

/// The search for a step size halves or doubles at most 50 times: from 10¹⁰ it arrives, from 10⁻³⁰⁰ it says where it stopped, NaN is refused.
#[test]
fn the_search_for_a_step_size_ends() {
    let (target, metric) = (quadratic(1.0), Metric::Diagonal(vec![1.0; 2]));
    let search = |first_step_size: f64| {
        let mut trial =
            StepSizeTrial { target: &target, metric: &metric, states: vec![Block::splat(0.5); 2], isa: Isa::best() };
        let config = tuning::Config { first_step_size, jitter: 0.2, ..tuning::Config::default() };
        tuning::step_size(&mut trial, 3, &config, &Stage::new(2, "search"))
    };
    let found = search(1e10).expect("34 halvings away");
    assert!(found.step_size < 2.0 && (found.acceptance - 0.85).abs() < 0.03, "{found:?}");
    let error = search(1e-300).unwrap_err();
    assert!(matches!(error, Error::StepSizeNotFound { tried: 50, .. }), "{error}");
    assert!(error.to_string().contains("after 50 halvings or doublings"), "{error}");
    assert!(matches!(search(f64::NAN), Err(Error::OutOfRange { name: "step size", .. })));
}

/// An energy error above 1000 is a divergence: rejected and counted; one below is an ordinary rejection.
#[test]
fn large_energy_errors_are_divergences() {
    for (precision, diverges) in [(1e8, true), (1.0, false)] {
        let target = quadratic(precision);
        let hmc = Hmc::new(1.9, &[1.0; 2], 1, 0.0, Isa::best()).expect("valid");
        let mut chains = Chains::new(&target, vec![Block::splat(0.0); 2]).expect("finite");
        let before = chains.clone();
        let mut ws = Workspace::new(&target);
        let moved = update(&target, &hmc, &mut chains, &mut ws, &mut Stage::new(3, "energy").whole());
        assert_eq!(moved.divergent, [diverges; LANES]);
        if diverges {
            assert_eq!(chains, before);
            assert_eq!((moved.acceptance, moved.accepted), (Block::ZERO, [false; LANES]));
        }
    }
}

/// No observation: a density of 0 everywhere.
struct Nothing(usize);

impl LogDensity for Nothing {
    fn dim(&self) -> usize {
        self.0
    }
    fn log_density(&self, _x: &[f64]) -> f64 {
        0.0
    }
}

impl GradLogDensity for Nothing {
    fn log_density_grad(&self, _x: &[f64], grad: &mut [f64]) -> f64 {
        grad.fill(0.0);
        0.0
    }
}

impl GaussNewton for Nothing {
    fn gauss_newton_diagonal_block(&self, _x: &[Block], diagonal: &mut [Block], _ws: &mut [Block]) {
        diagonal.fill(Block::ZERO);
    }
}

/// x' = 0.9 x + N(0, 0.5²) from a narrow start.
fn damped() -> Series {
    let mut series = Series::simulated(2, 1, &Stage::new(4, "damped"));
    series.a = vec![0.9, 0.0, 0.0, 0.9];
    series.q = vec![0.25, 0.0, 0.0, 0.25];
    series.p0 = vec![0.01, 0.0, 0.0, 0.01];
    series
}

/// Variances of a hundred frames without observation, and what they add to the evidence.
fn blind(tracker: &mut impl Tracker<Nothing>) -> (Vec<f64>, f64) {
    let mut evidence = 0.0;
    let variances = (0..100)
        .map(|frame| {
            let info = tracker.step(&Nothing(2), Stage::new(5, "blind").at_frame(frame)).expect("continues");
            evidence += info.log_evidence.unwrap_or(f64::NAN);
            let moments = tracker.posterior().moments(Isa::best());
            0.5 * (moments.covariance[0] + moments.covariance[3])
        })
        .collect();
    (variances, evidence)
}

/// Missing for a hundred frames: every filter continues with its prior, its variance grows to the stationary value 0.25 / (1 − 0.81), log Z adds 0.
#[test]
fn a_hundred_frames_without_observation_lead_to_the_stationary_variance() {
    let series = damped();
    let stationary = 0.25 / (1.0 - 0.81);
    let model =
        || LinearGaussian::new(2, series.a.clone(), series.q.clone(), series.p0.clone(), Isa::best()).expect("valid");
    let particles = bootstrap::Config { particles: 2000, ..bootstrap::Config::default() };
    let adaptive = bootstrap::Config { resample_below: 0.5, ..particles.clone() };
    let chains = |chains| hmc_filter::Config {
        chains,
        updates: 12,
        burn_in: 4,
        step_size: 0.7,
        leapfrog_steps: 3,
        jitter: 0.2,
        ..hmc_filter::Config::default()
    };
    let (white, lower) = series.whitened();
    let scale = lower[0] * lower[0];
    let found = [
        ("bootstrap", 1.0, blind(&mut Bootstrap::new(particles, model(), vec![0.0; 2]).expect("valid"))),
        ("bootstrap, adaptive", 1.0, blind(&mut Bootstrap::new(adaptive, model(), vec![0.0; 2]).expect("valid"))),
        (
            "hmc, gaussian",
            1.0,
            blind(&mut HmcFilter::new(chains(32), model(), vec![0.0; 2], Isa::best()).expect("valid")),
        ),
        (
            "hmc, mixture",
            scale,
            blind(
                &mut HmcFilter::new(chains(128), MixtureBetween::new(&white), vec![0.0; 2], Isa::best())
                    .expect("valid"),
            ),
        ),
    ];
    for (name, scale, (variances, evidence)) in found {
        let late = scale * variances[60..].iter().sum::<f64>() / 40.0;
        println!("{name}: variance {late:.3} for {stationary:.3}, log Z {evidence:e}");
        assert!(evidence.abs() < 1e-9, "{name}: log Z {evidence}");
        assert!(scale * variances[0] < 0.1, "{name}: starts narrow, {}", scale * variances[0]);
        assert!((late / stationary - 1.0).abs() < 0.2, "{name}: {late} against {stationary}, bound 20 %");
    }
}
