//! What persistent errors add to a filter's covariance, against the whole linear system of all frames.

use faer::linalg::solvers::DenseSolveCore;
use faer::{Mat, MatRef, Side};
use sinew_dynamics::linearised_filter::LinearisedFilter;
use sinew_dynamics::persistent_errors::{Persistence, PersistentErrors};

const D: usize = 3;
const K: usize = 4;
const FRAMES: usize = 10;

fn observed(t: usize, k: usize) -> bool {
    (t + 2 * k) % 7 != 3 && t != 6
}

/// H_t: changes from frame to frame; rows of 0 for what is missing.
fn observation(t: usize) -> Mat<f64> {
    Mat::from_fn(K, D, |k, j| if observed(t, k) { (1.3 * (k * D + j) as f64 + 0.05 * t as f64).cos() } else { 0.0 })
}

fn diagonal(values: [f64; D]) -> Mat<f64> {
    Mat::from_fn(D, D, |i, j| if i == j { values[i] } else { 0.0 })
}

fn numbers(m: MatRef<'_, f64>) -> Vec<f64> {
    (0..m.nrows() * m.ncols()).map(|e| m[(e / m.ncols(), e % m.ncols())]).collect()
}

/// The error of the estimate is linear in the steps of the state and in all errors so far, whose covariance is known: each of the two is propagated whole.
#[test]
fn the_covariance_of_the_estimate_is_exact_whatever_is_missing() {
    let (initial, step, r) = ([0.4, 0.3, 0.2], [0.002, 0.003, 0.001], 0.5);
    let persistence = Persistence { share: 0.8, correlation: 0.8 };
    let mut filter = LinearisedFilter::new(&initial);
    let mut persistent = PersistentErrors::new(D, K);
    // How the estimate's error answers to: the start, the step of each frame, the errors of each frame.
    let mut by_start = Mat::<f64>::identity(D, D);
    let mut by_step: Vec<Mat<f64>> = vec![];
    let mut by_error: Vec<Mat<f64>> = vec![];
    let mut lacked = 0.0_f64;
    for t in 0..FRAMES {
        if t > 0 {
            filter.predict(&step);
            by_step.push(Mat::identity(D, D));
        }
        let h = observation(t);
        let information = h.transpose() * &h * faer::Scale(1.0 / r);
        filter.update(&numbers(information.as_ref())).unwrap();
        let covariance = filter.covariance();
        let whitened = &h * faer::Scale(1.0 / r.sqrt());
        if t == 4 {
            let saved = persistent.save();
            persistent = PersistentErrors::new(D, K);
            persistent.restore(&saved).unwrap();
        }
        persistent
            .update(&covariance, &numbers(information.as_ref()), &numbers(whitened.as_ref()), persistence)
            .unwrap();
        let p = MatRef::from_row_major_slice(&covariance, D, D);
        let kept = Mat::<f64>::identity(D, D) - p * &information;
        by_start = &kept * &by_start;
        by_step.iter_mut().chain(&mut by_error).for_each(|by| *by = &kept * &*by);
        by_error.push(p * h.transpose() * faer::Scale(-1.0 / r));

        let mut expected = &by_start * diagonal(initial) * by_start.transpose();
        for by in &by_step {
            expected += by * diagonal(step) * by.transpose();
        }
        for (s, a) in by_error.iter().enumerate() {
            for (u, b) in by_error.iter().enumerate() {
                let Persistence { share, correlation } = persistence;
                let lag = s.abs_diff(u) as i32;
                let common = r * share * correlation.powi(lag) + if lag == 0 { r * (1.0 - share) } else { 0.0 };
                expected += a * b.transpose() * faer::Scale(common);
            }
        }
        let missing = persistent.missing();
        for (e, (known, missing)) in covariance.iter().zip(&missing).enumerate() {
            let expected = expected[(e / D, e % D)];
            assert!((known + missing - expected).abs() < 1e-12, "frame {t}: {known} + {missing} for {expected}");
        }
        lacked = lacked.max(missing[0] / covariance[0]);
    }
    assert!(lacked > 0.25, "errors that persist must matter here: {lacked}");
    assert!(persistent.restore(&[0.0; 4]).is_err());
    persistent.restart();
    assert!(persistent.missing().iter().all(|x| *x == 0.0));
}

/// What it costs, for a state that hardly moves and errors that persist over ten frames: the filter that takes them as white claims less than a third of its variance; with what is missing it says all of it, which is 1.85 times that of a filter that knows of them.
#[test]
fn the_filter_says_how_much_larger_its_error_is() {
    let (phi, share, q): (f64, f64, f64) = (0.9, 0.93, 1e-3);
    let mut filter = LinearisedFilter::new(&[1.0]);
    let mut persistent = PersistentErrors::new(1, 1);
    // The best: state and error together, one observation without noise but for the white share.
    let mut joint = Mat::from_fn(2, 2, |i, j| if i == j { [1.0, share][i] } else { 0.0 });
    for t in 0..400 {
        if t > 0 {
            filter.predict(&[q]);
            joint = Mat::from_fn(2, 2, |i, j| [1.0, phi][i] * [1.0, phi][j] * joint[(i, j)]);
            joint[(0, 0)] += q;
            joint[(1, 1)] += share * (1.0 - phi * phi);
        }
        filter.update(&[1.0]).unwrap();
        let covariance = filter.covariance();
        persistent.update(&covariance, &[1.0], &[1.0], Persistence { share, correlation: phi }).unwrap();
        let mut information = joint.llt(Side::Lower).unwrap().inverse();
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            information[(i, j)] += 1.0 / (1.0 - share);
        }
        joint = information.llt(Side::Lower).unwrap().inverse();
    }
    let (claimed, total, best) =
        (filter.covariance()[0], filter.covariance()[0] + persistent.missing()[0], joint[(0, 0)]);
    assert!(total > 3.0 * claimed, "{total} for {claimed}");
    assert!((1.8..1.9).contains(&(total / best)), "{total} for {best}");
}
