//! Every test of the kit on kernels that are right and on kernels with a known bug.
//!
//! The former must pass, the latter must be caught. Seeds are fixed; false alarms 1e-6 each.

use sinew_core::density::{GradLogDensity, LogDensity};
use sinew_core::random::BlockRng;
use sinew_invariance::draws::{normals, uniform};
use sinew_invariance::targets::{Banana, ExactTarget, GaussianTarget, HalfLine, MixtureTarget, Truncated};
use sinew_invariance::{
    Bound, Control, CountLaw, Differences, ExactRank, ExactStart, Geweke, Integrator, LongRun, RankCalibration, Report,
    Resampling, TestFunctions, Wrong, calibration, energy_order, exact_rank, exact_start, geweke, gradient, long_run,
    mixing, resampling, reversibility, two_sample, volume,
};

/// Random-walk Metropolis with steps of `sd` and a rule for acceptance by log density before, after, and a uniform number.
fn walk(
    target: &impl LogDensity,
    sd: f64,
    accept: impl Fn(f64, f64, f64) -> bool,
) -> impl Fn(&[f64], &mut BlockRng) -> Vec<f64> {
    move |x, rng| {
        let y: Vec<f64> = x.iter().zip(normals(x.len(), rng)).map(|(x, z)| x + sd * z).collect();
        if accept(target.log_density(x), target.log_density(&y), uniform(rng)) { y } else { x.to_vec() }
    }
}

fn metropolis(before: f64, after: f64, u: f64) -> bool {
    u.ln() < after - before
}

/// Leapfrog on a unit mass.
fn leapfrog(target: &impl GradLogDensity, q: &[f64], p: &[f64], h: f64, steps: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut q, mut p, mut g) = (q.to_vec(), p.to_vec(), vec![0.0; q.len()]);
    for _ in 0..steps {
        target.log_density_grad(&q, &mut g);
        p.iter_mut().zip(&g).for_each(|(p, g)| *p += 0.5 * h * g);
        q.iter_mut().zip(&p).for_each(|(q, p)| *q += h * p);
        target.log_density_grad(&q, &mut g);
        p.iter_mut().zip(&g).for_each(|(p, g)| *p += 0.5 * h * g);
    }
    (q, p)
}

fn energy(target: &impl LogDensity, q: &[f64], p: &[f64]) -> f64 {
    0.5 * p.iter().map(|p| p * p).sum::<f64>() - target.log_density(q)
}

fn start_of(target: &impl ExactTarget, steps: usize, kernel: impl Fn(&[f64], &mut BlockRng) -> Vec<f64>) -> Report {
    let config = ExactStart { starts: 10_000, steps, ..ExactStart::default() };
    exact_start(&config, |rng| target.draw(rng), kernel, &TestFunctions::moments(target.dim()))
}

#[test]
fn right_kernels_pass_exact_starts_on_every_target() {
    let gaussian = GaussianTarget::equicorrelated(3, 0.6);
    start_of(&gaussian, 5, walk(&gaussian, 0.8, metropolis)).assert_holds();
    let modes = vec![GaussianTarget::scaled(&[1.0]), GaussianTarget::new(vec![4.0], vec![vec![0.5]])];
    let mixture = MixtureTarget::new(vec![0.3, 0.7], modes);
    start_of(&mixture, 5, walk(&mixture, 2.0, metropolis)).assert_holds();
    let banana = Banana { sd: 1.5, bend: 0.6 };
    start_of(&banana, 5, walk(&banana, 1.0, metropolis)).assert_holds();
    let half = HalfLine { rate: vec![1.0, 5.0] };
    start_of(&half, 5, walk(&half, 0.5, metropolis)).assert_holds();
    for beyond in [f64::NEG_INFINITY, f64::NAN] {
        let cliff = Truncated { whole: GaussianTarget::standard(2), edge: 0.3, beyond };
        start_of(&cliff, 5, walk(&cliff, 0.8, metropolis)).assert_holds();
    }
}

#[test]
fn exact_starts_catch_wrong_acceptance() {
    let target = GaussianTarget::standard(2);
    start_of(&target, 1, walk(&target, 0.8, |_, _, _| true)).assert_fails();
    start_of(&target, 1, walk(&target, 0.8, |before, after, u| u.ln() < before - after)).assert_fails();
    start_of(&target, 1, walk(&target, 0.8, |before, after, u| u.ln() < 0.5 * (after - before))).assert_fails();
    // NaN that is accepted: `!(u >= ratio)` where `u < ratio` was meant.
    let region = Truncated { whole: GaussianTarget::standard(2), edge: 0.3, beyond: f64::NAN };
    #[allow(clippy::neg_cmp_op_on_partial_ord)]
    start_of(&region, 1, walk(&region, 0.8, |before, after, u| !(u.ln() >= after - before))).assert_fails();
}

#[test]
fn exact_starts_see_noise_that_is_two_per_cent_too_small() {
    let autoregressive =
        |factor: f64| move |x: &[f64], rng: &mut BlockRng| vec![0.6 * x[0] + factor * 0.8 * normals(1, rng)[0]];
    let target = GaussianTarget::standard(1);
    let config = ExactStart { starts: 100_000, steps: 5, ..ExactStart::default() };
    let functions = TestFunctions::moments(1);
    exact_start(&config, |rng| target.draw(rng), autoregressive(1.0), &functions).assert_holds();
    exact_start(&config, |rng| target.draw(rng), autoregressive(0.98), &functions).assert_fails();
}

#[test]
fn kernels_of_several_chains_are_tested_together() {
    let target = GaussianTarget::standard(2);
    let one = walk(&target, 0.8, metropolis);
    let eight = |x: &[f64], rng: &mut BlockRng| x.chunks(2).flat_map(|x| one(x, rng)).collect::<Vec<_>>();
    let draw = |rng: &mut BlockRng| (0..8).flat_map(|_| target.draw(rng)).collect::<Vec<_>>();
    let functions = || TestFunctions::moments(2).together(8);
    let config = ExactStart { starts: 2000, steps: 3, ..ExactStart::default() };
    exact_start(&config, draw, eight, &functions()).assert_holds();
    let careless = walk(&target, 0.8, |before, after, u| u.ln() < 0.7 * (after - before));
    let eight = |x: &[f64], rng: &mut BlockRng| x.chunks(2).flat_map(|x| careless(x, rng)).collect::<Vec<_>>();
    exact_start(&config, draw, eight, &functions()).assert_fails();
}

/// A kernel that pushes both tails outward keeps the mean of x and what lies on either side of its median, but not the shape.
#[test]
fn two_samples_see_a_change_of_shape() {
    let target = GaussianTarget::standard(1);
    let functions = TestFunctions::none().with("x0", |x| x[0]);
    let config = ExactStart::default();
    two_sample(&config, |rng| target.draw(rng), walk(&target, 1.0, metropolis), &functions).assert_holds();
    let shaped = |x: &[f64], _: &mut BlockRng| vec![if x[0].abs() < 0.3 { x[0] } else { x[0] + 0.3 * x[0].signum() }];
    exact_start(&config, |rng| target.draw(rng), shaped, &functions).assert_holds();
    two_sample(&config, |rng| target.draw(rng), shaped, &functions).assert_fails();
}

#[test]
fn exact_ranks_see_a_sweep_that_is_not_its_own_reversal() {
    let rho: f64 = 0.9;
    let target = GaussianTarget::equicorrelated(2, rho);
    let gibbs = |order: [usize; 2]| {
        move |x: &[f64], rng: &mut BlockRng| {
            let (mut x, z) = (x.to_vec(), normals(2, rng));
            for i in order {
                x[i] = rho * x[1 - i] + (1.0 - rho * rho).sqrt() * z[i];
            }
            x
        }
    };
    // A function of the first coordinate alone sees a reversible chain whichever way the sweep goes.
    let functions = || TestFunctions::moments(2).with("skew", |x| x[0] - 0.5 * x[1]);
    let config = ExactRank { paths: 20_000, steps: 4, ..ExactRank::default() };
    let draw = |rng: &mut BlockRng| target.draw(rng);
    exact_rank(&config, draw, gibbs([0, 1]), gibbs([1, 0]), &functions()).assert_holds();
    exact_rank(&config, draw, gibbs([0, 1]), gibbs([0, 1]), &functions()).assert_fails();
    let right = walk(&target, 0.7, metropolis);
    exact_rank(&config, draw, &right, &right, &functions()).assert_holds();
    let still = |x: &[f64], _: &mut BlockRng| x.to_vec();
    exact_rank(&ExactRank::default(), draw, still, still, &functions()).assert_fails();
    let wrong = walk(&target, 0.7, |_, _, _| true);
    exact_rank(&ExactRank::default(), draw, &wrong, &wrong, &functions()).assert_fails();
}

/// The mean θ ~ N(0, 1) of five observations of standard deviation 1.
fn simulate(theta: &[f64], rng: &mut BlockRng) -> Vec<f64> {
    normals(5, rng).iter().map(|z| theta[0] + z).collect()
}

/// The posterior of θ with observations of standard deviation `sd`: mean and standard deviation.
fn posterior(y: &[f64], sd: f64) -> (f64, f64) {
    let precision = 1.0 + y.len() as f64 / (sd * sd);
    (y.iter().sum::<f64>() / (sd * sd) / precision, precision.sqrt().recip())
}

#[test]
fn geweke_sees_another_noise_level_than_the_simulators() {
    let kernel = |sd: f64| {
        move |theta: &[f64], y: &[f64], rng: &mut BlockRng| {
            let (mean, spread) = posterior(y, sd);
            let target = GaussianTarget::new(vec![mean], vec![vec![spread]]);
            walk(&target, 0.5, metropolis)(theta, rng)
        }
    };
    let prior = |rng: &mut BlockRng| normals(1, rng);
    let functions = TestFunctions::moments(1);
    // Steps are short, so that the error needs cycles to add up.
    let config = Geweke { cycles: 400, ..Geweke::default() };
    geweke(&config, prior, simulate, kernel(1.0), &functions).assert_holds();
    geweke(&config, prior, simulate, kernel(0.7), &functions).assert_fails();
}

/// Data with a covariate that never changes, and is no sum of powers of two.
#[test]
fn constants_are_no_finding() {
    let simulate = |theta: &[f64], rng: &mut BlockRng| vec![theta[0] + normals(1, rng)[0], 0.3];
    let kernel = |theta: &[f64], y: &[f64], rng: &mut BlockRng| {
        let (mean, spread) = posterior(&y[..1], 1.0);
        walk(&GaussianTarget::new(vec![mean], vec![vec![spread]]), 0.8, metropolis)(theta, rng)
    };
    let prior = |rng: &mut BlockRng| normals(1, rng);
    geweke(&Geweke::default(), prior, simulate, kernel, &TestFunctions::moments(3)).assert_holds();
}

#[test]
fn calibration_sees_intervals_too_narrow_shifted_and_correlated() {
    let draws = |narrower: f64, shift: f64| {
        move |y: &[f64], n: usize, rng: &mut BlockRng| {
            let (mean, sd) = posterior(y, 1.0);
            normals(n, rng).into_iter().map(|z| vec![mean + shift * sd + narrower * sd * z]).collect::<Vec<_>>()
        }
    };
    let prior = |rng: &mut BlockRng| normals(1, rng);
    let functions = TestFunctions::none().with("mean", |x| x[0]);
    let run =
        |narrower, shift| calibration(&RankCalibration::default(), prior, simulate, draws(narrower, shift), &functions);
    let (report, ranks) = run(1.0, 0.0);
    report.assert_holds();
    assert_eq!(ranks.ranks[0].len() % 500, 0);
    run(0.7, 0.0).0.assert_fails();
    run(1.4, 0.0).0.assert_fails();
    run(1.0, 0.5).0.assert_fails();
    let stuck = |y: &[f64], n: usize, rng: &mut BlockRng| vec![draws(1.0, 0.0)(y, 1, rng)[0].clone(); n];
    calibration(&RankCalibration::default(), prior, simulate, stuck, &functions).0.assert_fails();
    let sticky = |y: &[f64], n: usize, rng: &mut BlockRng| {
        let (mean, sd) = posterior(y, 1.0);
        let mut z = normals(1, rng)[0];
        let mut next = |e: f64| {
            z = 0.99 * z + 0.14 * e;
            vec![mean + sd * z]
        };
        normals(n, rng).into_iter().map(&mut next).collect::<Vec<_>>()
    };
    calibration(&RankCalibration::default(), prior, simulate, sticky, &functions).0.assert_fails();
}

#[test]
fn integrators_are_distinguished() {
    let target = Banana { sd: 1.0, bend: 0.5 };
    let starts: Vec<(Vec<f64>, Vec<f64>)> = {
        let mut rng = sinew_core::random::Stage::new(3, "starts").whole();
        (0..100).map(|_| (target.draw(&mut rng), normals(2, &mut rng))).collect()
    };
    let energy = |q: &[f64], p: &[f64]| energy(&target, q, p);
    let right = |q: &[f64], p: &[f64], h: f64, n: usize| leapfrog(&target, q, p, h, n);
    let right = Integrator { map: &right, energy: &energy };
    reversibility(&right, &starts, 0.1, 20, 1e-10).assert_holds();
    volume(&right, &starts[..5], 0.1, 3, 1e-7).assert_holds();
    energy_order(&right, &starts, 0.8, 0.1, [1.8, 2.2]).assert_holds();

    let euler = |q: &[f64], p: &[f64], h: f64, n: usize| {
        let (mut q, mut p, mut g) = (q.to_vec(), p.to_vec(), vec![0.0; 2]);
        for _ in 0..n {
            target.log_density_grad(&q, &mut g);
            p.iter_mut().zip(&g).for_each(|(p, g)| *p += h * g);
            q.iter_mut().zip(&p).for_each(|(q, p)| *q += h * p);
        }
        (q, p)
    };
    let half_kick_missing = Integrator { map: &euler, energy: &energy };
    volume(&half_kick_missing, &starts[..5], 0.1, 3, 1e-7).assert_holds();
    reversibility(&half_kick_missing, &starts, 0.1, 20, 1e-10).assert_fails();
    energy_order(&half_kick_missing, &starts, 0.8, 0.1, [1.8, 2.2]).assert_fails();

    let by_position = |q: &[f64], p: &[f64], h: f64, n: usize| leapfrog(&target, q, p, h / (1.0 + q[0] * q[0]), n);
    let by_position = Integrator { map: &by_position, energy: &energy };
    reversibility(&by_position, &starts, 0.1, 20, 1e-10).assert_fails();
    volume(&by_position, &starts[..5], 0.1, 3, 1e-7).assert_fails();

    let lost = |q: &[f64], p: &[f64], h: f64, n: usize| (leapfrog(&target, q, p, h, n).0, vec![f64::NAN; 2]);
    reversibility(&Integrator { map: &lost, energy: &energy }, &starts, 0.1, 20, 1e-10).assert_fails();
    let still = |q: &[f64], p: &[f64], _: f64, _: usize| (q.to_vec(), p.to_vec());
    reversibility(&Integrator { map: &still, energy: &energy }, &starts, 0.1, 20, 1e-10).assert_fails();
}

#[test]
fn gradients_are_checked_in_every_entry() {
    let banana = Banana { sd: 1.3, bend: 0.7 };
    let points = [vec![0.3, -1.0], vec![-2.0, 0.5], vec![1.0, 4.0]];
    gradient(&Differences::default(), |x, g| banana.log_density_grad(x, g), &points).assert_holds();
    let wrong = |x: &[f64], g: &mut [f64]| {
        let value = banana.log_density_grad(x, g);
        g[1] *= -1.0;
        value
    };
    let report = gradient(&Differences::default(), wrong, &points);
    report.assert_fails();
    assert!(report.worst().is_some_and(|s| s.name.contains("entry 1")), "{report}");
    let half = HalfLine { rate: vec![1.0] };
    gradient(&Differences::default(), |x, g| half.log_density_grad(x, g), &[vec![-1.0]]).assert_fails();
}

/// Systematic resampling: one uniform number, N equally spaced pointers.
fn systematic(weights: &[f64], n: usize, rng: &mut BlockRng) -> Vec<usize> {
    let (offset, last) = (uniform(rng), weights.iter().rposition(|&w| w > 0.0).unwrap_or(0));
    let (mut i, mut sum) = (0, weights[0]);
    let pointer = |k: usize| (k as f64 + offset) / n as f64;
    (0..n)
        .map(|k| {
            while sum <= pointer(k) && i < last {
                i += 1;
                sum += weights[i];
            }
            i
        })
        .collect()
}

#[test]
fn resampling_is_held_to_its_law() {
    let mut weights = vec![0.0, 0.3, 1e-12, 0.25, 0.0, 0.15, 0.3];
    let sum: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|w| *w /= sum);
    let config = Resampling { law: CountLaw::FloorOrCeiling, ..Resampling::default() };
    resampling(&config, &weights, systematic).assert_holds();
    resampling(&config, &[1.0], systematic).assert_holds();
    resampling(&config, &weights, |w, n, rng| systematic(w, n, rng).iter().map(|i| (i + 1) % 7).collect())
        .assert_fails();
    resampling(&config, &weights, |w, n, rng| systematic(w, n - 1, rng)).assert_fails();
    resampling(&config, &weights, |w, n, rng| systematic(w, n, rng).iter().map(|i| i + 7).collect()).assert_fails();
    let multinomial =
        |w: &[f64], n: usize, rng: &mut BlockRng| (0..n).map(|_| systematic(w, 1, rng)[0]).collect::<Vec<_>>();
    resampling(&Resampling::default(), &weights, multinomial).assert_holds();
    resampling(&config, &weights, multinomial).assert_fails();
    // Residual resampling with W for N W: no index is ever taken for sure, and the rest is drawn by W.
    let floored = |w: &[f64], n: usize, rng: &mut BlockRng| multinomial(w, n, rng);
    resampling(&Resampling { law: CountLaw::AtLeastFloor, ..config }, &weights, floored).assert_fails();
    // An index of weight 1e-12 that is taken once in every replicate.
    let favoured = |w: &[f64], n: usize, rng: &mut BlockRng| {
        let mut parents = systematic(w, n, rng);
        parents[0] = 2;
        parents
    };
    resampling(&Resampling::default(), &weights, favoured).assert_fails();
}

/// Indices with some 30 expected offspring, where a z-score would cry wolf: 1000 tests at a rate of 0.01, with 4.5 standard errors to spare.
#[test]
fn false_alarms_of_rare_counts_keep_the_stated_rate() {
    let weights = [0.003, 0.003, 0.003, 0.991];
    let multinomial =
        |w: &[f64], n: usize, rng: &mut BlockRng| (0..n).map(|_| systematic(w, 1, rng)[0]).collect::<Vec<_>>();
    let failed = (0..1000).filter(|&seed| {
        let control = Control { false_alarm_rate: 0.01, stages: 1, growth: 1 };
        let config = Resampling { replicates: 1000, offspring: 10, seed, control, ..Resampling::default() };
        !resampling(&config, &weights, multinomial).holds()
    });
    let rate = failed.count() as f64 / 1000.0;
    assert!(rate < 0.01 + 4.5 * (0.0099_f64 / 1000.0).sqrt(), "{rate}");
}

#[test]
fn long_runs_see_what_keeps_the_target_but_does_not_reach_it() {
    let target = GaussianTarget::equicorrelated(2, 0.5);
    let functions = TestFunctions::moments(2);
    let expected = [0.0, 1.0, 0.0, 1.0, 0.5];
    let starts = [vec![3.0, -3.0], vec![-3.0, 3.0], vec![0.0, 0.0], vec![3.0, 3.0]];
    long_run(&LongRun::default(), &starts, walk(&target, 1.2, metropolis), &functions, &expected).assert_holds();
    let still = |x: &[f64], _: &mut BlockRng| x.to_vec();
    start_of(&target, 1, still).assert_fails();
    let second_only = |x: &[f64], rng: &mut BlockRng| vec![x[0], 0.5 * x[0] + 0.75_f64.sqrt() * normals(1, rng)[0]];
    start_of(&target, 1, second_only).assert_holds();
    long_run(&LongRun::default(), &starts, second_only, &functions, &expected).assert_fails();
    long_run(&LongRun::default(), &starts, still, &functions, &expected).assert_fails();
    let first_only = |x: &[f64], rng: &mut BlockRng| {
        let moved = walk(&target, 1.2, metropolis)(x, rng);
        if moved[1] > 0.0 || x[1] < 0.0 { moved } else { x.to_vec() }
    };
    long_run(&LongRun::default(), &starts, first_only, &functions, &expected).assert_fails();
    mixing(&LongRun::default(), &starts, walk(&target, 1.2, metropolis), &functions, 1.02, 40.0).assert_holds();
    mixing(&LongRun::default(), &starts, walk(&target, 0.02, metropolis), &functions, 1.02, 40.0).assert_fails();
}

/// Independent draws with 8 events expected among them, where a z-score cries wolf in 4 % of the tests: 1000 tests at a rate of 0.01, with 4.5 standard errors to spare.
#[test]
fn false_alarms_of_rare_events_keep_the_stated_rate() {
    let rare = TestFunctions::none().with("is rare", |x| f64::from(u8::from(x[0] < 0.004)));
    let fresh = |_: &[f64], rng: &mut BlockRng| vec![uniform(rng)];
    let failed = (0..1000).filter(|&seed| {
        let control = Control { false_alarm_rate: 0.01, stages: 1, growth: 1 };
        let config = LongRun { burn_in: 0, draws: 500, seed, control };
        !long_run(&config, &vec![vec![0.5]; 4], fresh, &rare, &[0.004]).holds()
    });
    let rate = failed.count() as f64 / 1000.0;
    assert!(rate < 0.01 + 4.5 * (0.0099_f64 / 1000.0).sqrt(), "{rate}");
}

/// A jump that is tried in one step of a thousand is right, and says how seldom it moves.
#[test]
fn kernels_that_move_rarely_are_reported_with_how_rarely() {
    let target = GaussianTarget::standard(1);
    let rarely = |x: &[f64], rng: &mut BlockRng| if uniform(rng) < 0.001 { target.draw(rng) } else { x.to_vec() };
    let test = |least_moved: f64| {
        let config = ExactStart { starts: 40_000, least_moved, ..ExactStart::default() };
        exact_start(&config, |rng| target.draw(rng), rarely, &TestFunctions::moments(1))
    };
    test(1e-4).assert_holds();
    let said = test(0.01).to_string();
    assert!(said.contains("share of starts that moved"), "{said}");
    test(0.01).assert_fails();
}

/// 400 exact-start tests of a right kernel at a rate of 0.1: false alarms lie between 2 % and 10 % with 4.5 standard errors to spare. The normal law holds for the means, the law of signs for the rest; Bonferroni makes the rate smaller.
#[test]
fn false_alarms_of_a_whole_test_keep_the_stated_rate() {
    let target = GaussianTarget::equicorrelated(2, 0.5);
    let control = Control { false_alarm_rate: 0.1, ..Control::default() };
    let failed = (0..400).filter(|&seed| {
        let config = ExactStart { starts: 500, seed, control, ..ExactStart::default() };
        let report =
            exact_start(&config, |rng| target.draw(rng), walk(&target, 1.0, metropolis), &TestFunctions::moments(2));
        !report.holds()
    });
    let rate = failed.count() as f64 / 400.0;
    assert!((0.005..0.1 + 4.5 * (0.09_f64 / 400.0).sqrt()).contains(&rate), "{rate}");
}

#[test]
fn a_report_says_how_it_was_judged() {
    let target = GaussianTarget::standard(1);
    let report = start_of(&target, 1, walk(&target, 0.8, |_, _, _| true));
    let text = report.to_string();
    assert!(
        text.contains("exact start FAILS") && text.contains("10000 starts") && text.contains("a failure shows"),
        "{text}"
    );
    assert!(text.contains("false alarms: 1e-6 a test") && text.contains("seed 1"), "{text}");
    let judged_by_chance = report.statistics.iter().filter(|s| matches!(s.bound, Bound::Probability { .. }));
    assert_eq!(judged_by_chance.count(), report.statistics.len() - 1);
}

/// The text that the guide shows is what its example prints.
#[test]
fn the_guide_shows_what_is_printed() {
    let broken = |x: &[f64], rng: &mut BlockRng| {
        let y = x[0] * normals(1, rng)[0].exp();
        if uniform(rng).ln() < x[0] - y { vec![y] } else { x.to_vec() }
    };
    let target = HalfLine { rate: vec![1.0] };
    let report = exact_start(&ExactStart::default(), |rng| target.draw(rng), broken, &TestFunctions::moments(1));
    assert_eq!(report.to_string(), include_str!("../src/guide/broken.txt").trim_end(), "paste this:\n{report}");
}

/// So is the report of the README.
#[test]
fn the_readme_shows_what_is_printed() {
    let target = GaussianTarget::equicorrelated(2, 0.8);
    let report = exact_start(
        &ExactStart::default(),
        |rng| target.draw(rng),
        walk(&target, 0.9, metropolis),
        &TestFunctions::moments(2),
    );
    let shown = include_str!("../README.md").contains(&format!("```text\n{report}\n```"));
    assert!(shown, "paste this:\n{report}");
}

/// Runs of a hundred that an exponent of the target fails whose standard deviation is wrong by this much.
fn failed_by_a_wrong_exponent(wrong_by: f64) -> usize {
    let target = GaussianTarget::standard(1);
    let exponent = (1.0 - wrong_by).powi(-2);
    let tempered = |before: f64, after: f64, u: f64| metropolis(exponent * before, exponent * after, u);
    let fails = |&seed: &u64| {
        let config = ExactStart { starts: 2000, seed, ..ExactStart::default() };
        let kernel = walk(&target, 1.5, tempered);
        !exact_start(&config, |rng| target.draw(rng), kernel, &TestFunctions::moments(1)).holds()
    };
    (1..=100).filter(fails).count()
}

/// A hundred runs with a rate of 0.9 have a standard deviation of 3: the bounds are more than four of them away.
#[test]
fn a_report_that_holds_says_what_it_would_have_seen() {
    let target = GaussianTarget::standard(1);
    let config = ExactStart { starts: 2000, ..ExactStart::default() };
    let kernel = walk(&target, 1.5, metropolis);
    let report = exact_start(&config, |rng| target.draw(rng), kernel, &TestFunctions::moments(1));
    report.assert_holds();
    let found = report.detectable.iter().find(|one| one.what == Wrong::StandardDeviation).unwrap();
    assert!(found.of == "x0²" && (0.05..0.25).contains(&found.size), "{found:?}");
    let text = report.to_string();
    assert!(text.contains("sees 9 times in 10: a standard deviation wrong by"), "{text}");
    let (whole, half) = (failed_by_a_wrong_exponent(found.size), failed_by_a_wrong_exponent(0.5 * found.size));
    assert!((77..=100).contains(&whole) && half <= 35, "{whole} and {half} of 100");
}
