//! Tests of Hamiltonian integrators: reversible, volume-preserving, of the order that they claim.
//!
//! Only then is an accept step by the energy error right.
//!
//! A map (q, p) ↦ (q′, p′) of n steps of size h is
//!
//! - reversible when negating p′ and mapping again leads back to (q, −p);
//! - volume-preserving when |det ∂(q′, p′) / ∂(q, p)| = 1, here by central differences;
//! - of second order when the mean |H(q′, p′) − H(q, p)| over trajectories of one length falls as h².
//!
//! These need no randomness beyond the starts, and find what an exact-start test finds only with many draws: curvature or a step size that depends on the position, a half step that is missing.

use crate::report::{Bound, Report, Statistic};

/// (q, p, step size, number of steps) ↦ (q′, p′).
pub type PhaseSpaceMap<'a> = dyn Fn(&[f64], &[f64], f64, usize) -> (Vec<f64>, Vec<f64>) + 'a;

/// An integrator and its energy.
pub struct Integrator<'a> {
    /// What it does to a place in phase space.
    pub map: &'a PhaseSpaceMap<'a>,
    /// H(q, p).
    pub energy: &'a dyn Fn(&[f64], &[f64]) -> f64,
}

/// A place to start from: q and p.
pub type Start = (Vec<f64>, Vec<f64>);

/// The larger number, or NaN: `max` would drop it.
fn worse(a: f64, b: f64) -> f64 {
    if b > a || b.is_nan() { b } else { a }
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len(), "the map keeps the dimension");
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / b.abs().max(1.0)).fold(0.0, worse)
}

fn at_most(name: String, value: f64, most: f64) -> Statistic {
    Statistic { name, value, bound: Bound::Range { least: f64::NEG_INFINITY, most } }
}

/// Forward, flip, forward, flip: the largest distance from the start, relative above 1, is at most `tolerance` (rounding; 1e-10 for 80 steps is generous).
pub fn reversibility(integrator: &Integrator<'_>, starts: &[Start], step: f64, steps: usize, tolerance: f64) -> Report {
    let found = starts.iter().enumerate().map(|(i, (q, p))| {
        let negated = |p: &[f64]| p.iter().map(|p| -p).collect::<Vec<_>>();
        let (there, momentum) = (integrator.map)(q, p, step, steps);
        let (back, momentum) = (integrator.map)(&there, &negated(&momentum), step, steps);
        let moved = largest_difference(&there, q);
        let error = worse(largest_difference(&back, q), largest_difference(&negated(&momentum), p));
        // A map that goes nowhere is reversible and useless.
        let error = if moved > 0.0 { error } else { f64::NAN };
        at_most(
            format!("return from start {i}"),
            if back.iter().all(|x| x.is_finite()) { error } else { f64::NAN },
            tolerance,
        )
    });
    Report::exact(
        "reversibility",
        format!("{} starts, {steps} steps of {step}, momentum flipped, the same again", starts.len()),
        "the map is not its own reversal: steps or curvature that depend on the position, a half step at one end only, a momentum that is not flipped where it matters",
        found.collect(),
    )
}

/// log |det J| of one map by central differences is at most `tolerance` in size (1e-7 for smooth targets).
pub fn volume(integrator: &Integrator<'_>, starts: &[Start], step: f64, steps: usize, tolerance: f64) -> Report {
    let found = starts.iter().enumerate().map(|(i, (q, p))| {
        let d = q.len();
        let at = |j: usize, by: f64| {
            let (mut q, mut p) = (q.clone(), p.clone());
            if j < d {
                q[j] += by
            } else {
                p[j - d] += by
            }
            let (q, p) = (integrator.map)(&q, &p, step, steps);
            [q, p].concat()
        };
        let h = 1e-5;
        let columns: Vec<Vec<f64>> =
            (0..2 * d).map(|j| at(j, h).iter().zip(at(j, -h)).map(|(a, b)| (a - b) / (2.0 * h)).collect()).collect();
        at_most(format!("log |det J| at start {i}"), log_abs_det(columns).abs(), tolerance)
    });
    Report::exact(
        "volume",
        format!("Jacobians of {steps} steps of {step} at {} starts", starts.len()),
        "the map stretches or shrinks phase space: position and momentum updated together instead of in turn, steps that depend on the position",
        found.collect(),
    )
}

/// Gaussian elimination with row exchange; NaN stays NaN.
fn log_abs_det(mut rows: Vec<Vec<f64>>) -> f64 {
    let n = rows.len();
    let mut sum = 0.0;
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs())).unwrap_or(k);
        rows.swap(k, pivot);
        let (top, rest) = rows.split_at_mut(k + 1);
        sum += top[k][k].abs().ln();
        for row in rest {
            let factor = row[k] / top[k][k];
            row.iter_mut().zip(&top[k]).skip(k).for_each(|(x, y)| *x -= factor * y);
        }
    }
    sum
}

/// Slope of log mean |ΔH| against log h, for trajectories of one `length` with `step`, `step` / 2, `step` / 4 and `step` / 8, lies in `range`: [1.8, 2.2] for leapfrog. Take a hundred starts or more: single ones scatter.
pub fn energy_order(integrator: &Integrator<'_>, starts: &[Start], length: f64, step: f64, range: [f64; 2]) -> Report {
    let points: Vec<[f64; 2]> = (0..4)
        .map(|halvings| {
            let h = step / f64::from(1 << halvings);
            let steps = (length / h).round() as usize;
            let error = |(q, p): &Start| {
                let (q1, p1) = (integrator.map)(q, p, h, steps);
                ((integrator.energy)(&q1, &p1) - (integrator.energy)(q, p)).abs()
            };
            [h.ln(), (starts.iter().map(error).sum::<f64>() / starts.len() as f64).ln()]
        })
        .collect();
    let mean = |i: usize| points.iter().map(|p| p[i]).sum::<f64>() / points.len() as f64;
    let (x, y) = (mean(0), mean(1));
    let covariance: f64 = points.iter().map(|p| (p[0] - x) * (p[1] - y)).sum();
    let slope = covariance / points.iter().map(|p| (p[0] - x).powi(2)).sum::<f64>();
    let bound = Bound::Range { least: range[0], most: range[1] };
    Report::exact(
        "energy order",
        format!("mean |ΔH| over {} trajectories of length {length}, steps {step} to {}", starts.len(), step / 8.0),
        "the integrator is of another order than it claims: a missing half step makes it first order, a wrong gradient makes the error constant",
        vec![Statistic { name: "slope of log |ΔH| against log step".into(), value: slope, bound }],
    )
}
