//! The Kalman filter and smoother against stored references, a dense joint Gaussian and each other (E1, `kalman-psd`).

use sinew::core::random::Stage;
use sinew::core::transition::Moments;
use sinew::dynamics::factor::{cholesky, inverse_lower};
use sinew::dynamics::kalman::{Filtered, Form, Kalman, Model};
use sinew_tests::linear_series::{Series, product, rows};
use sinew_tests::stored::{number, numbers};

const FORMS: [Form; 2] = [Form::Joseph, Form::SquareRoot];

fn seen(series: &Series) -> Vec<Vec<Option<f64>>> {
    series.z.iter().map(|z| z.iter().copied().map(Some).collect()).collect()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn diagonal(moments: &Moments) -> Vec<f64> {
    moments.covariance.iter().step_by(moments.mean.len() + 1).copied().collect()
}

/// The Kalman filter and smoother against stored exact numbers (E1): log-likelihood to 1e-8; increments, means, variances and whole covariances to 1e-9.
#[test]
fn both_forms_equal_the_stored_filter_and_smoother() {
    for name in ["lgssm_d2.json", "lgssm_d10.json"] {
        let Some(series) = Series::stored(name) else { return };
        let stored = &series.stored;
        for form in FORMS {
            let filter = series.filter(form);
            let frames = filter.filter(&series.start(), &seen(&series)).expect("positive definite");
            let smoothed = filter.smooth(&frames).expect("positive definite");
            let increments: Vec<f64> = frames.iter().map(|f| f.log_likelihood).collect();
            let total = (increments.iter().sum::<f64>() - number(&stored["log_likelihood"])).abs();
            assert!(total < 1e-8, "{name}, {form:?}: log-likelihood off by {total}");
            let increment_error = largest_difference(&increments, &numbers(&stored["log_likelihood_increments"]));
            assert!(increment_error < 1e-9, "{name}, {form:?}: increments off by {increment_error}");
            let stages: [(&str, Vec<&Moments>); 3] = [
                ("predicted", frames.iter().map(|f| &f.predicted).collect()),
                ("filtered", frames.iter().map(|f| &f.filtered).collect()),
                ("smoothed", smoothed.iter().collect()),
            ];
            for (what, found) in stages {
                let means = rows(&stored[&format!("{what}_mean")]);
                let variances = rows(&stored[&format!("{what}_var_diag")]);
                assert_eq!(found.len(), means.len());
                for (frame, found) in found.iter().enumerate() {
                    let off = [
                        largest_difference(&found.mean, &means[frame]),
                        largest_difference(&diagonal(found), &variances[frame]),
                    ];
                    assert!(off.iter().all(|off| *off < 1e-9), "{name}, {form:?}, {what}, frame {frame}: {off:?}");
                }
                let Some(listed) = stored[&format!("{what}_cov_frames")].as_array() else {
                    assert_eq!(what, "predicted", "whole covariances are stored of the others");
                    continue;
                };
                assert!(listed.len() >= 7);
                for (frame, whole) in listed.iter().zip(stored[&format!("{what}_cov")].as_array().expect("array")) {
                    let frame = frame.as_u64().expect("number") as usize;
                    let off = largest_difference(&found[frame].covariance, &rows(whole).concat());
                    assert!(off < 1e-9, "{name}, {form:?}, {what} covariance of frame {frame} off by {off}");
                }
            }
        }
    }
}

/// Covariance Σ and mean of all states and observations of a series as one Gaussian, states first.
fn joint(series: &Series) -> (Vec<f64>, Vec<f64>, usize) {
    let (d, k, frames) = (series.dim, series.r.len(), series.z.len());
    let (states, n) = (d * frames, (d + k) * frames);
    let transposed = |m: &[f64]| -> Vec<f64> { (0..d * d).map(|e| m[e % d * d + e / d]).collect() };
    let (mut mean, mut sigma) = (vec![0.0; n], vec![0.0; n * n]);
    // Cov(x_s, x_t) = P_s (Aᵀ)^{t−s} for s ≤ t.
    let (mut p, mut m) = (series.p0.clone(), series.m0.clone());
    for s in 0..frames {
        if s > 0 {
            p = product(&product(&series.a, &p, d), &transposed(&series.a), d);
            p.iter_mut().zip(&series.q).for_each(|(p, q)| *p += q);
            m = series.a.chunks(d).map(|row| row.iter().zip(&m).map(|(a, m)| a * m).sum()).collect();
        }
        mean[s * d..(s + 1) * d].copy_from_slice(&m);
        let mut across = p.clone();
        for t in s..frames {
            if t > s {
                across = product(&across, &transposed(&series.a), d);
            }
            for (e, entry) in across.iter().enumerate() {
                let (i, j) = (s * d + e / d, t * d + e % d);
                sigma[i * n + j] = *entry;
                sigma[j * n + i] = *entry;
            }
        }
    }
    for t in 0..frames {
        for o in 0..k {
            let row = states + t * k + o;
            mean[row] = (0..d).map(|j| series.c[o][j] * mean[t * d + j]).sum();
            for i in 0..states {
                let entry: f64 = (0..d).map(|j| series.c[o][j] * sigma[i * n + t * d + j]).sum();
                sigma[i * n + row] = entry;
                sigma[row * n + i] = entry;
            }
        }
    }
    for t in 0..frames * k {
        for u in 0..frames * k {
            let (row, column) = (states + t, states + u);
            let entry: f64 = (0..d).map(|j| series.c[t % k][j] * sigma[(t / k * d + j) * n + column]).sum();
            sigma[row * n + column] = entry + if t / k == u / k { series.r[t % k][u % k] } else { 0.0 };
        }
    }
    (mean, sigma, states)
}

/// Without data: log-likelihood and smoothed moments of a random model against one dense Gaussian over all frames.
#[test]
fn a_random_model_agrees_with_one_dense_gaussian() {
    let mut series = Series::simulated(4, 6, &Stage::new(7, "dense joint"));
    series.r = vec![vec![0.1, 0.03], vec![0.03, 0.2]];
    let (mean, sigma, states) = joint(&series);
    let n = mean.len();
    let k = n - states;
    let block = |rows: std::ops::Range<usize>, columns: std::ops::Range<usize>| -> Vec<f64> {
        rows.flat_map(|i| sigma[i * n..][columns.clone()].to_vec()).collect()
    };
    let lower = cholesky("observations", &block(states..n, states..n), k).expect("positive definite").lower;
    let whitening = inverse_lower(&lower, k);
    let z = series.z.concat();
    let whiten = |v: &[f64]| -> Vec<f64> {
        whitening.chunks(k).map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum()).collect()
    };
    let e = whiten(&z.iter().zip(&mean[states..]).map(|(z, m)| z - m).collect::<Vec<_>>());
    let log = (0..k).map(|i| -0.5 * e[i] * e[i] - lower[i * (k + 1)].ln() - 0.5 * std::f64::consts::TAU.ln());
    let log: f64 = log.sum();
    let across: Vec<Vec<f64>> = (0..states).map(|i| whiten(&sigma[i * n + states..(i + 1) * n])).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for form in FORMS {
        let filter = series.filter(form);
        let frames = filter.filter(&series.start(), &seen(&series)).expect("positive definite");
        let found: f64 = frames.iter().map(|f| f.log_likelihood).sum();
        assert!((found - log).abs() < 1e-11, "{form:?}: {found} against {log}");
        for (t, smoothed) in filter.smooth(&frames).expect("positive definite").iter().enumerate() {
            for i in 0..4 {
                let at = t * 4 + i;
                let exact = mean[at] + dot(&across[at], &e);
                assert!(
                    (smoothed.mean[i] - exact).abs() < 1e-11,
                    "{form:?}, frame {t}: {} against {exact}",
                    smoothed.mean[i]
                );
                for j in 0..4 {
                    let exact = sigma[at * n + t * 4 + j] - dot(&across[at], &across[t * 4 + j]);
                    let found = smoothed.covariance[i * 4 + j];
                    assert!((found - exact).abs() < 1e-11, "{form:?}, frame {t}: {found} against {exact}");
                }
            }
        }
    }
}

fn smallest_eigenvalue(c: &[f64]) -> f64 {
    let (mean, half) = (0.5 * (c[0] + c[3]), 0.5 * (c[0] - c[3]));
    mean - half.hypot(c[1])
}

/// `kalman-psd`: R = 1e-12, Q = 0, 10⁴ frames: symmetric to 0, smallest eigenvalue at least −1e-12; both forms.
#[test]
fn covariances_stay_covariances_over_ten_thousand_exact_frames() {
    let model = Model {
        dim: 2,
        matrix: vec![1.0, 0.1, 0.0, 0.98],
        noise: vec![0.0; 4],
        observation: vec![1.0, 0.0],
        error: vec![1e-12],
    };
    let start = Moments { mean: vec![0.0, 1.0], covariance: vec![0.25, 0.0, 0.0, 1.0] };
    let (mut position, mut speed) = (0.1, 1.2);
    let mut observed = vec![];
    for _ in 0..10_000 {
        observed.push(vec![Some(position)]);
        (position, speed) = (position + 0.1 * speed, 0.98 * speed);
    }
    for form in FORMS {
        let filter = Kalman::new(model.clone(), form).expect("valid");
        let frames: Vec<Filtered> = filter.filter(&start, &observed).expect("positive definite");
        let mut least = f64::INFINITY;
        for frame in &frames {
            for c in [&frame.predicted.covariance, &frame.filtered.covariance] {
                assert!(c.iter().all(|x| x.is_finite()) && c[1] == c[2], "{c:?}");
                least = least.min(smallest_eigenvalue(c));
            }
        }
        println!("{form:?}: smallest eigenvalue {least:e}");
        assert!(least >= -1e-12, "{form:?}: smallest eigenvalue {least}, bound -1e-12");
        let last = &frames[9_999].filtered;
        assert!((last.mean[0] - 6.1).abs() < 1e-5, "{form:?}: {last:?}");
    }
}

/// Both forms on a random series with missing sensors and frames.
#[test]
fn the_square_root_form_equals_josephs() {
    for (dim, seed) in [(2, 1), (5, 2), (10, 3)] {
        let series = Series::simulated(dim, 40, &Stage::new(seed, "forms"));
        let mut observed = seen(&series);
        for (frame, z) in observed.iter_mut().enumerate() {
            for (sensor, z) in z.iter_mut().enumerate() {
                if (frame + 2 * sensor) % 5 == 0 || (10..14).contains(&frame) {
                    *z = None;
                }
            }
        }
        let [joseph, root] = FORMS.map(|form| {
            let filter = series.filter(form);
            let frames = filter.filter(&series.start(), &observed).expect("positive definite");
            (filter.smooth(&frames).expect("positive definite"), frames)
        });
        for (a, b) in joseph.1.iter().zip(&root.1) {
            assert!((a.log_likelihood - b.log_likelihood).abs() < 1e-11);
            for (a, b) in [(&a.predicted, &b.predicted), (&a.filtered, &b.filtered)] {
                assert!(largest_difference(&a.mean, &b.mean) < 1e-11);
                assert!(largest_difference(&a.covariance, &b.covariance) < 1e-12);
            }
        }
        for (a, b) in joseph.0.iter().zip(&root.0) {
            assert!(largest_difference(&a.mean, &b.mean) < 1e-11);
        }
        assert!(joseph.1[10..14].iter().all(|f| f.log_likelihood == 0.0 && f.filtered == f.predicted));
    }
}

/// A hundred frames without observation: the covariance tends to the stationary one, P = A P Aᵀ + Q, and nothing is added to the log-likelihood.
#[test]
fn without_observations_the_variance_becomes_the_stationary_one() {
    let phi = 0.9_f64;
    for form in FORMS {
        let model = Model { dim: 1, matrix: vec![phi], noise: vec![0.5], observation: vec![1.0], error: vec![0.1] };
        let filter = Kalman::new(model, form).expect("valid");
        let start = Moments { mean: vec![2.0], covariance: vec![0.01] };
        let frames = filter.filter(&start, &vec![vec![None]; 101]).expect("nothing is seen");
        let stationary = 0.5 / (1.0 - phi * phi);
        let last = frames[100].filtered.covariance[0];
        assert!((last / stationary - 1.0).abs() < 1e-8, "{form:?}: {last} against {stationary}");
        assert!(frames.windows(2).all(|f| f[0].filtered.covariance[0] < f[1].filtered.covariance[0] + 1e-12));
        assert_eq!(frames.iter().map(|f| f.log_likelihood).sum::<f64>(), 0.0);
    }
}
