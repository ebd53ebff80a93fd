//! The Kalman filter and smoother against the joint Gaussian of all states and observations.
//!
//! It is conditioned in one piece: no recursion, no gain.

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use sinew_core::density::GaussNewton;
use sinew_core::lanes::{Block, Isa, triangle};
use sinew_core::transition::{Cloud, FramePrior, Moments, MotionModel, Predict};
use sinew_dynamics::factor;
use sinew_dynamics::gaussian::Gaussian;
use sinew_dynamics::kalman::{Form, Kalman, Model};
use sinew_dynamics::linear_gaussian::LinearGaussian;
use sinew_dynamics::smoother::Smoother;

const D: usize = 3;
const K: usize = 2;
const FRAMES: usize = 4;

fn model() -> Model {
    Model {
        dim: D,
        matrix: vec![1.0, 0.4, -0.1, 0.2, 0.7, 0.3, 0.0, -0.5, 0.9],
        noise: vec![0.3, 0.1, -0.05, 0.1, 0.4, 0.12, -0.05, 0.12, 0.2],
        observation: vec![1.0, -0.3, 0.2, 0.0, 0.8, 1.1],
        error: vec![0.5, 0.15, 0.15, 0.3],
    }
}

fn start() -> Moments {
    Moments { mean: vec![0.5, -1.0, 2.0], covariance: vec![1.0, 0.2, -0.3, 0.2, 0.6, 0.1, -0.3, 0.1, 0.8] }
}

fn observations() -> Vec<Vec<Option<f64>>> {
    let z = |t: usize, i: usize| Some((1.3 * t as f64 + 2.0 * i as f64).sin() * 2.0);
    (0..FRAMES).map(|t| (0..K).map(|i| z(t, i).filter(|_| (t, i) != (2, 0))).collect()).collect()
}

fn matrix(rows: &[f64], height: usize, width: usize) -> Mat<f64> {
    Mat::from_fn(height, width, |i, j| rows[i * width + j])
}

/// Mean and covariance of all states, then of all observations, frame after frame.
fn joint() -> (Mat<f64>, Mat<f64>) {
    let Model { matrix: a, noise, observation, error, .. } = model();
    let (a, q, c, r) = (matrix(&a, D, D), matrix(&noise, D, D), matrix(&observation, K, D), matrix(&error, K, K));
    let states = FRAMES * D;
    let mut mean = Mat::zeros(states + FRAMES * K, 1);
    let mut covariance = Mat::zeros(states + FRAMES * K, states + FRAMES * K);
    let (mut m, mut p) = (matrix(&start().mean, D, 1), matrix(&start().covariance, D, D));
    for t in 0..FRAMES {
        if t > 0 {
            m = &a * &m;
            p = &a * &p * a.transpose() + &q;
        }
        mean.submatrix_mut(t * D, 0, D, 1).copy_from(&m);
        let mut across = p.clone();
        for u in t..FRAMES {
            covariance.submatrix_mut(u * D, t * D, D, D).copy_from(&across);
            covariance.submatrix_mut(t * D, u * D, D, D).copy_from(across.transpose());
            across = &a * across;
        }
    }
    let mut seen = Mat::zeros(FRAMES * K, states);
    (0..FRAMES).for_each(|t| seen.submatrix_mut(t * K, t * D, K, D).copy_from(&c));
    let state_covariance = covariance.submatrix(0, 0, states, states).to_owned();
    let cross = &seen * &state_covariance;
    let mut seen_covariance = &cross * seen.transpose();
    for t in 0..FRAMES {
        let mut block = seen_covariance.submatrix_mut(t * K, t * K, K, K);
        block += &r;
    }
    let expected = &seen * mean.submatrix(0, 0, states, 1);
    mean.submatrix_mut(states, 0, FRAMES * K, 1).copy_from(expected);
    covariance.submatrix_mut(states, 0, FRAMES * K, states).copy_from(&cross);
    covariance.submatrix_mut(0, states, states, FRAMES * K).copy_from(cross.transpose());
    covariance.submatrix_mut(states, states, FRAMES * K, FRAMES * K).copy_from(&seen_covariance);
    (mean, covariance)
}

/// Moments of the state of frame `t` given the observations of the first `frames` frames, and the log density of these observations.
fn conditioned(t: usize, frames: usize) -> (Moments, f64) {
    let (mean, covariance) = joint();
    let observations = observations();
    let seen: Vec<(usize, f64)> = (0..frames)
        .flat_map(|u| (0..K).map(move |i| (u, i)))
        .filter_map(|(u, i)| Some((FRAMES * D + u * K + i, observations[u][i]?)))
        .collect();
    let n = seen.len();
    let s = Mat::from_fn(n, n, |i, j| covariance[(seen[i].0, seen[j].0)]);
    let e = Mat::from_fn(n, 1, |i, _| seen[i].1 - mean[(seen[i].0, 0)]);
    let cross = Mat::from_fn(D, n, |i, j| covariance[(t * D + i, seen[j].0)]);
    let (solved, gained) = (s.partial_piv_lu().solve(&e), s.partial_piv_lu().solve(cross.transpose()));
    let (shift, less) = (&cross * &solved, &cross * &gained);
    let moments = Moments {
        mean: (0..D).map(|i| mean[(t * D + i, 0)] + shift[(i, 0)]).collect(),
        covariance: (0..D * D).map(|k| covariance[(t * D + k / D, t * D + k % D)] - less[(k / D, k % D)]).collect(),
    };
    let eigenvalues = s.self_adjoint_eigenvalues(Side::Lower).unwrap();
    let log_determinant: f64 = eigenvalues.iter().map(|x| x.ln()).sum();
    let square = (e.transpose() * &solved)[(0, 0)];
    (moments, -0.5 * (square + log_determinant + n as f64 * std::f64::consts::TAU.ln()))
}

fn near(found: &Moments, expected: &Moments) {
    let pairs = found.mean.iter().zip(&expected.mean).chain(found.covariance.iter().zip(&expected.covariance));
    pairs.for_each(|(f, e)| assert!((f - e).abs() < 1e-10, "{found:?} for {expected:?}"));
}

#[test]
fn filter_smoother_and_evidence_match_the_joint_gaussian() {
    for form in [Form::Joseph, Form::SquareRoot] {
        let filter = Kalman::new(model(), form).unwrap();
        let found = filter.filter(&start(), &observations()).unwrap();
        let smoothed = filter.smooth(&found).unwrap();
        assert_eq!((found.len(), smoothed.len()), (FRAMES, FRAMES));
        let mut evidence = 0.0;
        for (t, frame) in found.iter().enumerate() {
            near(&frame.predicted, &conditioned(t, t).0);
            let (filtered, so_far) = conditioned(t, t + 1);
            near(&frame.filtered, &filtered);
            near(&smoothed[t], &conditioned(t, FRAMES).0);
            evidence += frame.log_likelihood;
            assert!((evidence - so_far).abs() < 1e-10, "{form:?}, frame {t}: {evidence} for {so_far}");
        }
    }
}

#[test]
fn the_prior_of_linear_motion_has_the_moments_of_the_prediction() {
    let Model { matrix, noise, .. } = model();
    let motion = LinearGaussian::new(D, matrix, noise, start().covariance, Isa::best()).unwrap();
    assert_eq!(motion.dim(), D);
    let moments = conditioned(1, 2).0;
    let prior = motion.predict(Cloud { last: &[], count: 0, moments: &moments }).unwrap();
    let predicted = conditioned(2, 2).0;
    let expected = Gaussian::new(predicted.mean.clone(), &predicted.covariance).unwrap();
    let bound = FramePrior::precision(&prior);
    for (found, expected) in bound.iter().zip(expected.precision()) {
        assert!((found - expected).abs() < 1e-9, "{found} for {expected}");
    }
    assert_eq!(expected.mean(), predicted.mean);
}

/// P P⁻¹ = I, and the curvature is P⁻¹ in packed rows.
#[test]
fn the_curvature_of_a_gaussian_is_its_precision() {
    let covariance = start().covariance;
    let gaussian = Gaussian::new(start().mean, &covariance).unwrap();
    let product = matrix(&covariance, D, D) * matrix(gaussian.precision(), D, D);
    for (i, j) in (0..D).flat_map(|i| (0..D).map(move |j| (i, j))) {
        assert!((product[(i, j)] - f64::from(u8::from(i == j))).abs() < 1e-12);
    }
    let leaf = sinew_core::density::Lanes { leaf: gaussian.clone(), isa: Isa::best() };
    let x = [Block::splat(0.3); D];
    let (mut packed, mut diagonal) = ([Block::ZERO; triangle(D, 0)], [Block::ZERO; D]);
    leaf.gauss_newton_block(&x, &mut packed, &mut []);
    leaf.gauss_newton_diagonal_block(&x, &mut diagonal, &mut []);
    for i in 0..D {
        assert_eq!(diagonal[i], Block::splat(gaussian.precision()[i * D + i]));
        for j in 0..=i {
            assert_eq!(packed[triangle(i, j)], Block::splat(gaussian.precision()[i * D + j]));
        }
    }
}

#[test]
fn a_walk_is_the_identity_with_the_squares_of_its_steps() {
    let walk = Smoother::random_walk(&[0.5, 0.2, 2.0]);
    let identity = vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let squares = vec![0.25, 0.0, 0.0, 0.0, 0.2 * 0.2, 0.0, 0.0, 0.0, 4.0];
    let plain = Smoother::new(D, identity, squares).unwrap();
    let (before, after) = (conditioned(0, 1).0, conditioned(1, 4).0);
    assert_eq!(walk.step(&before, &after).unwrap(), plain.step(&before, &after).unwrap());
}

/// A factor times its transpose is the matrix, and nothing stands above its diagonal.
#[test]
fn factors_are_triangular_roots() {
    let covariance = start().covariance;
    let lower = factor::cholesky("covariance", &covariance, D).unwrap().lower;
    assert_eq!([lower[1], lower[2], lower[5]], [0.0; 3]);
    let square = matrix(&lower, D, D) * matrix(&lower, D, D).transpose();
    let root = factor::root("covariance", &covariance, D).unwrap();
    let root_squared = matrix(&root, D, D) * matrix(&root, D, D).transpose();
    let inverse = matrix(&factor::inverse_lower(&lower, D), D, D) * matrix(&lower, D, D);
    for (i, j) in (0..D).flat_map(|i| (0..D).map(move |j| (i, j))) {
        assert!((square[(i, j)] - covariance[i * D + j]).abs() < 1e-14);
        assert!((root_squared[(i, j)] - covariance[i * D + j]).abs() < 1e-14);
        assert!((inverse[(i, j)] - f64::from(u8::from(i == j))).abs() < 1e-14);
    }
}
