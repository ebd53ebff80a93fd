//! Pose from pixels: nonlinear least squares on the joint angles, for one camera or many.
//!
//! ```text
//! min_q  Σ ρ(|observed − projected P_k(q)| / σ_c)  +  Σ_j ((q_j − start_j) / sd_j)²
//! ```
//!
//! by Levenberg–Marquardt, ρ the square continued by Huber. With one camera nothing but the size of the body shows its depth: the prior of the angles must then be
//! tight enough to hold what cannot be seen.

use crate::keypoints::keypoint_model::{Detection, View};
use nalgebra::{DMatrix, DVector, Matrix2x3};
use sinew_body::{Plan, point_jacobian, point_positions};
use sinew_core::lanes::Isa;

/// Residuals beyond this many standard deviations pull with constant force.
const HUBER: f64 = 2.0;
/// Cost of a point that has no pixel.
const UNSEEN: f64 = 1e4;
const ISA: Isa = Isa::baseline();

/// A fitted pose.
#[derive(Clone, Debug, PartialEq)]
pub struct PixelFit {
    /// The state.
    pub pose: Vec<f64>,
    /// What was minimised.
    pub cost: f64,
    /// Median distance of the detections from the projected points, pixels.
    pub median_px: f64,
}

/// Fits a pose to the detections of a frame: for each view, for each point of the plan. `sd` holds the prior standard deviations of the degrees of freedom about
/// `start`.
#[must_use]
pub fn fit_pixels(
    plan: &Plan,
    views: &[View],
    detections: &[Vec<Option<Detection>>],
    start: &[f64],
    sd: &[f64],
    steps: usize,
) -> PixelFit {
    let dof = plan.dof();
    let n = 3 * plan.points();
    let (mut positions, mut jacobian) = (vec![0.0; n], vec![0.0; n * dof]);
    let mut pose = start.to_vec();
    let cost_at = |pose: &[f64], positions: &[f64]| {
        prior_cost(pose, start, sd) + detection_cost(plan, views, detections, positions)
    };
    point_positions(plan, ISA, &pose, &mut positions);
    let mut cost = cost_at(&pose, &positions);
    let mut mu = 1e-2;
    for _ in 0..steps {
        point_jacobian(plan, ISA, &pose, &mut positions, &mut jacobian);
        let (mut normal, mut gradient) = equations(plan, views, detections, &positions, &jacobian);
        for j in 0..dof {
            let weight = sd[j].powi(-2);
            normal[(j, j)] += weight;
            gradient[j] -= weight * (pose[j] - start[j]);
        }
        let mut improved = false;
        while mu < 1e8 {
            let mut damped = normal.clone();
            for j in 0..dof {
                damped[(j, j)] *= 1.0 + mu;
            }
            // Positive definite by the prior, unless something is not finite.
            let Some(step) = damped.cholesky().map(|c| c.solve(&gradient)) else { break };
            let next: Vec<f64> = pose.iter().zip(step.iter()).map(|(q, d)| q + d).collect();
            point_positions(plan, ISA, &next, &mut positions);
            let next_cost = cost_at(&next, &positions);
            if next_cost < cost {
                improved = cost - next_cost > 1e-9 * cost;
                pose = next;
                cost = next_cost;
                mu = (0.2 * mu).max(1e-9);
                break;
            }
            mu *= 5.0;
        }
        if !improved {
            break;
        }
    }
    point_positions(plan, ISA, &pose, &mut positions);
    let mut distances: Vec<f64> =
        residuals(plan, views, detections, &positions).filter_map(|(_, _, r)| r.map(|[u, v]| u.hypot(v))).collect();
    PixelFit { pose, cost, median_px: sinew_core::estimators::median(&mut distances) }
}

/// Squared distance from the start, in prior standard deviations.
fn prior_cost(pose: &[f64], start: &[f64], sd: &[f64]) -> f64 {
    (0..pose.len()).map(|j| ((pose[j] - start[j]) / sd[j]).powi(2)).sum()
}

/// Sum of ρ over the detections.
fn detection_cost(plan: &Plan, views: &[View], detections: &[Vec<Option<Detection>>], positions: &[f64]) -> f64 {
    let cost = |(c, _, r): (usize, usize, Option<[f64; 2]>)| match r {
        Some([u, v]) => {
            let d = u.hypot(v) / views[c].sigma_px;
            if d <= HUBER { d * d } else { HUBER * (2.0 * d - HUBER) }
        }
        None => UNSEEN,
    };
    residuals(plan, views, detections, positions).map(cost).sum()
}

/// Normal matrix and right-hand side of the detections, with Huber's weights.
fn equations(
    plan: &Plan,
    views: &[View],
    detections: &[Vec<Option<Detection>>],
    positions: &[f64],
    jacobian: &[f64],
) -> (DMatrix<f64>, DVector<f64>) {
    let dof = plan.dof();
    let mut normal = DMatrix::zeros(dof, dof);
    let mut gradient = DVector::zeros(dof);
    for (c, k, r) in residuals(plan, views, detections, positions) {
        let at = [positions[3 * k], positions[3 * k + 1], positions[3 * k + 2]];
        let (Some(r), Some((_, pixel))) = (r, views[c].camera.project_with_jacobian(at)) else { continue };
        let sigma = views[c].sigma_px;
        let weight = (HUBER * sigma / r[0].hypot(r[1])).min(1.0) / (sigma * sigma);
        let point = DMatrix::from_row_slice(3, dof, &jacobian[3 * k * dof..3 * (k + 1) * dof]);
        let rows = Matrix2x3::from_fn(|i, j| pixel[i][j]) * point;
        normal += weight * rows.transpose() * &rows;
        gradient += weight * rows.transpose() * DVector::from_column_slice(&r);
    }
    (normal, gradient)
}

/// Camera, point and observed − projected of each detection, biases removed.
fn residuals<'a>(
    plan: &'a Plan,
    views: &'a [View],
    detections: &'a [Vec<Option<Detection>>],
    positions: &'a [f64],
) -> impl Iterator<Item = (usize, usize, Option<[f64; 2]>)> + 'a {
    views.iter().zip(detections).enumerate().flat_map(move |(c, (view, seen))| {
        seen.iter().take(plan.points()).enumerate().filter_map(move |(k, d)| {
            let d = (*d)?;
            let projected = view.camera.project([positions[3 * k], positions[3 * k + 1], positions[3 * k + 2]]).pixel();
            let [du, dv] = view.bias_of(k);
            Some((c, k, projected.map(|[u, v]| [d.pixel[0] - du - u, d.pixel[1] - dv - v])))
        })
    })
}
