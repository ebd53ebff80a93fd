//! The pose of a person of 32 degrees of freedom from keypoints in three cameras: the mode of their likelihood and a prior, with its uncertainty.
//!
//! `cargo run --release -p sinew-observe --example pose_from_keypoints`

use nalgebra::DMatrix;
use sinew_body::standard::h32;
use sinew_body::{Plan, Proportions, point_positions};
use sinew_core::combinators::Sum;
use sinew_core::density::{GaussNewton, GradLogDensity, Lanes, LogDensity};
use sinew_core::lanes::{Block, Isa, numbers, triangle};
use sinew_core::lbfgs::{Lbfgs, Objective};
use sinew_core::random::Stage;
use sinew_core::toy::Quadratic;
use sinew_observe::{Camera, Detection, KeypointFrame, KeypointModel, Mistakes, Noise, ObservationModel, View};
use std::sync::Arc;

struct Negative<D>(D);

impl<D: GradLogDensity> Objective for Negative<D> {
    fn evaluate(&mut self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let value = self.0.log_density_grad(x, gradient);
        gradient.iter_mut().for_each(|g| *g = -*g);
        -value
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (body, isa, sigma_px) = (h32(&Proportions::default()), Isa::best(), 3.0);
    let plan = Arc::new(Plan::with_all_points(&body));
    let (dof, count) = (plan.dof(), plan.points());
    let mut standing = vec![0.0; dof];
    standing[2] = 1.0;
    let mut random = vec![Block::ZERO; (dof + 6 * count).div_ceil(8)];
    Stage::new(1, "pose").whole().fill_normal(isa, &mut random);
    let (turns, errors) = numbers(&random).split_at(dof);
    let truth: Vec<f64> = standing.iter().zip(turns).map(|(x, z)| x + 0.2 * z).collect();
    let at = |state: &[f64]| {
        let mut points = vec![0.0; 3 * count];
        point_positions(&plan, isa, state, &mut points);
        points
    };
    let (mut views, mut detections, mut errors) = (vec![], vec![], errors.iter().map(|z| sigma_px * z));
    for k in 0..3 {
        let (sin, cos) = (0.4 + 2.1 * f64::from(k)).sin_cos();
        let camera =
            Camera::look_at(&format!("C{k}"), [1000.0; 2], 700.0, [4.0 * cos, 4.0 * sin, 1.5], [0.0, 0.0, 1.0])?;
        let mut seen = |point: &[f64; 3]| {
            let [u, v] = camera.project(*point).pixel()?;
            Some(Detection::new([u + errors.next()?, v + errors.next()?], 0.8))
        };
        detections.push(at(&truth).as_chunks().0.iter().map(&mut seen).collect::<Vec<_>>());
        views.push(View { camera, bias_px: vec![], sigma_px, usual_confidence: 0.8 });
    }
    let (noise, mistakes) = (Noise::OutlierFloor { outlier: 0.01 }, Mistakes::default());
    let model =
        KeypointModel { plan: plan.clone(), views, noise, model_error_m: 0.0, least_confidence: 0.1, mistakes, isa };
    let frame = KeypointFrame { detections: &detections, elsewhere: &[], predicted: &at(&standing) };
    // Half a radian and half a metre about standing.
    let prior = Lanes { leaf: Quadratic { centre: standing.clone(), precision: vec![4.0; dof] }, isa };
    let mut posterior = Negative(Sum(model.bind(frame), prior));
    let mut gradient = vec![0.0; dof];
    let value = posterior.evaluate(&standing, &mut gradient);
    let mut search = Lbfgs::at(standing, value, gradient);
    while search.iterations < 500 && search.step(&mut posterior) {}
    let (found, sum) = (&search.x, &posterior.0);
    let mut matrix = vec![Block::ZERO; triangle(dof, 0)];
    let mut workspace = vec![Block::ZERO; sum.matrix_workspace().max(sum.workspace())];
    sum.gauss_newton_block(&sinew_core::lanes::splat(found), &mut matrix, &mut workspace);
    let precision = DMatrix::from_fn(dof, dof, |i, j| matrix[triangle(i.max(j), i.min(j))].0[0]);
    let covariance = precision.try_inverse().ok_or("the matrix is singular")?;
    for name in ["pelvis.tx", "r_shin.rx", "r_forearm.rx", "l_shin.rx", "head.rz"] {
        let Some(k) = body.dof_names().iter().position(|own| own == name) else { continue };
        println!("{name:13} {:7.3} ± {:.3}, truly {:7.3}", found[k], covariance[(k, k)].sqrt(), truth[k]);
    }
    let off = |k: &usize| ((found[*k] - truth[*k]) / covariance[(*k, *k)].sqrt()).abs() < 2.0;
    println!("{} of {dof} coordinates within two standard deviations", (0..dof).filter(off).count());
    let apart = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>();
    let (now, then) = (at(found), at(&truth));
    let squares: f64 = now.as_chunks().0.iter().zip(then.as_chunks().0).map(apart).sum();
    println!(
        "joints {:.1} mm off, root mean square, after {} evaluations",
        1e3 * (squares / count as f64).sqrt(),
        search.evaluations
    );
    Ok(())
}
