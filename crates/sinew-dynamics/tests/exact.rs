//! Motion against closed forms: steps of a random walk, and the backward pass over two frames.

use sinew_core::density::LogDensity as _;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::part::Part;
use sinew_core::random::{BlockRng, Stage};
use sinew_core::transition::{Cloud, FramePrior, Moments, PartTransition, Predict, Transition};
use sinew_dynamics::linear_gaussian::LinearGaussian;
use sinew_dynamics::linear_motion::predict;
use sinew_dynamics::random_walk::{Between, RandomWalk};
use sinew_dynamics::smoother::Smoother;

/// Variance of 200 000 steps against the requested one, |z| < 4.5: sees 1 % of the standard deviation. 3 coordinates × 5 ways to draw; seed 1, false alarm 1e-4.
#[test]
fn steps_of_a_walk_are_as_wide_as_stated() {
    let (sd, initial) = ([0.25, 0.5, 1.0], [0.1, 2.0, 0.3]);
    let walk = |between| {
        let walk = RandomWalk::new(&[0.5, 1.0, 2.0], 0.25, between, Isa::best()).expect("valid");
        walk.with_initial_sd(initial.to_vec()).expect("valid")
    };
    let centre = [0.3, -1.0, 4.0];
    let last: Vec<Block> = centre.iter().map(|&x| Block::splat(x)).collect();
    let moments = Moments { mean: centre.to_vec(), covariance: vec![0.0; 9] };
    let prior = |between| walk(between).predict(Cloud { last: &last, count: 1, moments: &moments }).expect("valid");
    let (mixture, gaussian) = (prior(Between::Mixture), prior(Between::Gaussian));
    assert_eq!([mixture.dim(), gaussian.dim()], [3, 3]);
    let (walk, all) = (walk(Between::Mixture), Part::new(vec![0, 1, 2], 3).expect("valid"));
    let check = |what: &str, sd: [f64; 3], draw: &dyn Fn(&mut [Block], &mut BlockRng)| {
        let (mut rng, mut out, mut sums) = (Stage::new(1, what).whole(), vec![Block::ZERO; 3], [[0.0; 2]; 3]);
        let n = 200_000.0;
        for _ in 0..25_000 {
            draw(&mut out, &mut rng);
            for (sums, (x, c)) in sums.iter_mut().zip(out.iter().zip(centre)) {
                for x in x.0 {
                    sums[0] += (x - c) / n;
                    sums[1] += (x - c) * (x - c) / n;
                }
            }
        }
        for (j, ([mean, square], sd)) in sums.into_iter().zip(sd).enumerate() {
            let z = [mean / (sd / f64::sqrt(n)), (square / (sd * sd) - 1.0) / f64::sqrt(2.0 / n)];
            assert!(z.iter().all(|z| z.abs() < 4.5), "{what}, coordinate {j}: z = {z:?}, bound 4.5, seed 1");
        }
    };
    check("step", sd, &|out, rng| walk.sample_block(&last, out, rng));
    check("part", sd, &|out, rng| {
        out.copy_from_slice(&last);
        walk.sample_part_block(&all, out, rng);
    });
    check("first frame", initial, &|out, rng| walk.sample_initial_block(&centre, out, rng));
    check("mixture", sd, &|out, rng| mixture.sample_block(0, out, rng));
    check("gaussian", sd, &|out, rng| gaussian.sample_block(0, out, rng));
}

const A: [f64; 4] = [0.9, 0.3, -0.2, 0.8];
const Q: [f64; 4] = [0.5, 0.2, 0.2, 0.4];
const P: [f64; 4] = [1.2, -0.4, -0.4, 0.7];
const M: [f64; 2] = [0.3, -1.0];

fn product(a: &[f64; 4], b: &[f64; 4]) -> [f64; 4] {
    [0, 1, 2, 3].map(|k: usize| a[k / 2 * 2] * b[k % 2] + a[k / 2 * 2 + 1] * b[2 + k % 2])
}

fn transposed(a: &[f64; 4]) -> [f64; 4] {
    [a[0], a[2], a[1], a[3]]
}

fn inverse(a: &[f64; 4]) -> [f64; 4] {
    let det = a[0] * a[3] - a[1] * a[2];
    [a[3] / det, -a[1] / det, -a[2] / det, a[0] / det]
}

fn sum(a: &[f64; 4], b: &[f64; 4], sign: f64) -> [f64; 4] {
    [0, 1, 2, 3].map(|k: usize| a[k] + sign * b[k])
}

fn applied(a: &[f64; 4], x: [f64; 2]) -> [f64; 2] {
    [a[0] * x[0] + a[1] * x[1], a[2] * x[0] + a[3] * x[1]]
}

/// What observing the second frame with precision J does to the first, in information form: its posterior precision is P⁻¹ + Aᵀ (Q + J⁻¹)⁻¹ A. No gain, no prediction: another way than the backward pass takes.
#[test]
fn the_backward_pass_is_conditioning_of_the_joint_gaussian() {
    let (j, z) = ([2.0, 0.5, 0.5, 1.0], [1.5, 0.5]);
    // Filtered moments of the second frame.
    let predicted = sum(&product(&product(&A, &P), &transposed(&A)), &Q, 1.0);
    let prior_mean = applied(&A, M);
    let second = inverse(&sum(&inverse(&predicted), &j, 1.0));
    let (push, pull) = (applied(&inverse(&predicted), prior_mean), applied(&j, z));
    let mean = applied(&second, [push[0] + pull[0], push[1] + pull[1]]);
    let ahead = predict(&A, &Q, &Moments { mean: M.to_vec(), covariance: P.to_vec() });
    assert!(ahead.mean.iter().zip(prior_mean).all(|(a, b)| (a - b).abs() < 1e-14));
    assert!(ahead.covariance.iter().zip(predicted).all(|(a, b)| (a - b).abs() < 1e-14));

    let smoother = Smoother::new(2, A.to_vec(), Q.to_vec()).expect("square");
    let filtered = Moments { mean: M.to_vec(), covariance: P.to_vec() };
    let next = Moments { mean: mean.to_vec(), covariance: second.to_vec() };
    let found = smoother.step(&filtered, &next).expect("valid");

    let first_precision = product(&product(&transposed(&A), &inverse(&sum(&Q, &inverse(&j), 1.0))), &A);
    let exact = inverse(&sum(&inverse(&P), &first_precision, 1.0));
    let seen = applied(&transposed(&A), applied(&inverse(&sum(&Q, &inverse(&j), 1.0)), z));
    let own = applied(&inverse(&P), M);
    let exact_mean = applied(&exact, [own[0] + seen[0], own[1] + seen[1]]);
    for (k, (found, exact)) in found.mean.iter().zip(exact_mean).enumerate() {
        assert!((found - exact).abs() < 1e-12, "mean {k}: {found} against {exact}");
    }
    for (k, (found, exact)) in found.covariance.iter().zip(exact).enumerate() {
        assert!((found - exact).abs() < 1e-12, "covariance {k}: {found} against {exact}");
    }
}

/// Trajectories drawn backwards from smoothed last states have the smoothed moments of the first frame: 5 statistics at |z| < 4.5, seed 2.
#[test]
fn sampled_first_frames_have_the_smoothed_moments() {
    let smoother = Smoother::new(2, A.to_vec(), Q.to_vec()).expect("square");
    let filtered = Moments { mean: M.to_vec(), covariance: P.to_vec() };
    let next = Moments { mean: vec![1.0, -0.5], covariance: vec![0.3, 0.1, 0.1, 0.2] };
    let exact = smoother.step(&filtered, &next).expect("valid");
    let (mut states, mut rng) = (vec![Block::ZERO; 2 * 5000], Stage::new(2, "backwards").whole());
    smoother.sample_last(&next, &mut states, Isa::best(), &mut rng).expect("semi-definite");
    smoother.sample(&filtered, &mut states, Isa::best(), &mut rng).expect("positive definite");
    let n = (states.len() / 2 * LANES) as f64;
    let column =
        |j: usize| states.iter().skip(j).step_by(2).flat_map(|b| b.0).map(|x| x - exact.mean[j]).collect::<Vec<_>>();
    let (x, y) = (column(0), column(1));
    let moment = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / n;
    let c = &exact.covariance;
    for (what, z) in [
        ("mean of x", x.iter().sum::<f64>() / n / (c[0] / n).sqrt()),
        ("mean of y", y.iter().sum::<f64>() / n / (c[3] / n).sqrt()),
        ("xx", (moment(&x, &x) / c[0] - 1.0) / (2.0 / n).sqrt()),
        ("yy", (moment(&y, &y) / c[3] - 1.0) / (2.0 / n).sqrt()),
        ("xy", (moment(&x, &y) - c[1]) / ((c[0] * c[3] + c[1] * c[1]) / n).sqrt()),
    ] {
        assert!(z.abs() < 4.5, "{what}: z = {z}, bound 4.5, seed 2");
    }
}

/// The prior of the next frame is N(A m, A P Aᵀ + Q), drawn from and evaluated. 3 statistics at |z| < 4.5, seed 3.
#[test]
fn linear_motion_widens_by_its_own_noise() {
    let model = LinearGaussian::new(2, A.to_vec(), Q.to_vec(), P.to_vec(), Isa::best()).expect("valid");
    let moments = Moments { mean: M.to_vec(), covariance: P.to_vec() };
    let prior = model.predict(Cloud { last: &[], count: 0, moments: &moments }).expect("valid");
    let exact = sum(&product(&product(&A, &P), &transposed(&A)), &Q, 1.0);
    let centre = applied(&A, M);
    let precision = inverse(&exact);
    assert!((0..2).all(|j| (prior.precision_diagonal()[j] - precision[3 * j]).abs() < 1e-12));
    let (mut rng, mut out, mut sums) = (Stage::new(3, "widens").whole(), [Block::ZERO; 2], [0.0; 3]);
    let n = 80_000.0;
    for _ in 0..10_000 {
        prior.sample_block(0, &mut out, &mut rng);
        for lane in 0..LANES {
            let [x, y] = [0, 1].map(|j| out[j].0[lane] - centre[j]);
            sums.iter_mut().zip([x * x, x * y, y * y]).for_each(|(s, v)| *s += v / n);
        }
    }
    for (k, (found, (exact, variance))) in sums
        .into_iter()
        .zip([
            (exact[0], 2.0 * exact[0] * exact[0]),
            (exact[1], exact[0] * exact[3] + exact[1] * exact[1]),
            (exact[3], 2.0 * exact[3] * exact[3]),
        ])
        .enumerate()
    {
        let z = (found - exact) / f64::sqrt(variance / n);
        assert!(z.abs() < 4.5, "moment {k}: {found} against {exact}, z = {z}, bound 4.5, seed 3");
    }
}
