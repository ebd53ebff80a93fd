//! Gradients, curvature and lanes of the likelihoods, on random poses of the standard bodies.

use proptest::prelude::*;
use sinew_body::standard::h32;
use sinew_body::{Plan, Proportions, point_jacobian, point_positions};
use sinew_core::density::{GaussNewton, GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES, set_lane, triangle};
use sinew_observe::cameras::lens::{Brown, Fisheye, Lens, Rational};
use sinew_observe::{
    Camera, Detection, Intrinsics, KeypointFrame, KeypointModel, Mistakes, Noise, ObservationModel, View,
};
use std::sync::Arc;

const LENS: Brown = Brown { k1: -0.05, k2: 0.03, p1: 0.002, p2: -0.001, k3: 0.01 };

/// Four distorted cameras on a circle of 4 m, looking at (0, 0, 1).
fn views() -> Vec<View> {
    (0..4)
        .map(|i| {
            let (s, c) = (0.4 + 1.57 * f64::from(i)).sin_cos();
            let rotation = [[-s, c, 0.0], [0.0, 0.0, -1.0], [-c, -s, 0.0]];
            let camera = Camera {
                name: format!("cam{i}"),
                image_size_px: [1000.0, 1200.0],
                intrinsics: Intrinsics { fx: 900.0, fy: 880.0, cx: 500.0, cy: 610.0 },
                lens: LENS.into(),
                rotation,
                translation: [0.0, 1.0, 4.0],
            };
            View { camera, bias_px: vec![[3.0, -2.0]; 64], sigma_px: 8.0, usual_confidence: 0.7 }
        })
        .collect()
}

fn project(camera: &Camera, p: &[f64]) -> [f64; 2] {
    let c: Vec<f64> =
        (0..3).map(|i| (0..3).map(|j| camera.rotation[i][j] * p[j]).sum::<f64>() + camera.translation[i]).collect();
    let (x, y) = (c[0] / c[2], c[1] / c[2]);
    let d = LENS;
    let r2 = x * x + y * y;
    let radial = 1.0 + d.k1 * r2 + d.k2 * r2 * r2 + d.k3 * r2 * r2 * r2;
    let xd = x * radial + 2.0 * d.p1 * x * y + d.p2 * (r2 + 2.0 * x * x);
    let yd = y * radial + 2.0 * d.p2 * x * y + d.p1 * (r2 + 2.0 * y * y);
    let i = camera.intrinsics;
    [i.fx * xd + i.cx, i.fy * yd + i.cy]
}

fn keypoints(noise: Noise, isa: Isa) -> (KeypointModel, impl GaussNewton + use<>) {
    keypoints_with_errors(1.0, noise, isa)
}

/// Detections of the standing body, some of them missing, one a gross outlier; all errors that the model assumes are multiplied by `factor`.
fn keypoints_with_errors(factor: f64, noise: Noise, isa: Isa) -> (KeypointModel, impl GaussNewton + use<>) {
    let plan = Arc::new(Plan::with_all_points(&h32(&Proportions::default())));
    let views = views();
    let mut q = vec![0.0; plan.dof()];
    q[2] = 1.0;
    let mut points = vec![0.0; 3 * plan.points()];
    point_positions(&plan, isa, &q, &mut points);
    let detections: Vec<Vec<Option<Detection>>> = views
        .iter()
        .enumerate()
        .map(|(c, view)| {
            (0..plan.points())
                .map(|k| {
                    let [u, v] = project(&view.camera, &points[3 * k..3 * k + 3]);
                    let jitter = f64::from((7 * k as u32 + 3 * c as u32) % 11) - 5.0;
                    let gross = if k == 4 && c == 1 { 400.0 } else { 0.0 };
                    ((k + c) % 9 != 0).then_some(Detection::new([u + jitter + 3.0, v - jitter + gross - 2.0], 0.6))
                })
                .collect()
        })
        .collect();
    let views = views.into_iter().map(|view| View { sigma_px: factor * view.sigma_px, ..view }).collect();
    let model = KeypointModel {
        plan,
        views,
        noise,
        model_error_m: factor * 0.015,
        least_confidence: 0.05,
        mistakes: Mistakes::default(),
        isa,
    };
    let bound = model.bind(KeypointFrame { detections: &detections, elsewhere: &[], predicted: &points });
    (model, bound)
}

fn check_gradient(density: &impl GradLogDensity, x: &[f64]) {
    let mut grad = vec![0.0; x.len()];
    density.log_density_grad(x, &mut grad);
    let largest = grad.iter().fold(1.0_f64, |m, g| m.max(g.abs()));
    for j in 0..x.len() {
        let at = |h: f64| {
            let mut x = x.to_vec();
            x[j] += h;
            density.log_density(&x)
        };
        let h = 1e-4;
        let numeric = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
        assert!((numeric - grad[j]).abs() < 1e-6 * largest, "coordinate {j}: {numeric} against {}", grad[j]);
    }
}

/// Block and single state agree, on every instruction set, to 1e-12 · max(1, |log p|).
fn check_lanes<D: GradLogDensity>(density: impl Fn(Isa) -> D, x: &[f64]) {
    let d = x.len();
    let mut block = vec![Block::ZERO; d];
    let states: Vec<Vec<f64>> = (0..LANES).map(|l| x.iter().map(|x| x + 0.01 * l as f64).collect()).collect();
    for (lane, state) in states.iter().enumerate() {
        set_lane(&mut block, lane, state);
    }
    let reference = density(Isa::baseline());
    for isa in Isa::available() {
        let density = density(isa);
        let mut ws = vec![Block::ZERO; density.workspace()];
        let mut grad = vec![Block::ZERO; d];
        let value = density.log_density_grad_block(&block, &mut grad, &mut ws);
        let plain = density.log_density_block(&block, &mut ws);
        for (lane, state) in states.iter().enumerate() {
            let mut g = vec![0.0; d];
            let expected = reference.log_density_grad(state, &mut g);
            let single = density.log_density(state);
            let tolerance = 1e-12 * expected.abs().max(1.0);
            for found in [value.0[lane], plain.0[lane], single] {
                assert!((found - expected).abs() <= tolerance, "{}: {found} against {expected}", isa.name());
            }
            let largest = g.iter().fold(1.0_f64, |m, g| m.max(g.abs()));
            for j in 0..d {
                assert!((grad[j].0[lane] - g[j]).abs() <= 1e-11 * largest);
            }
        }
    }
}

fn pose(d: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-0.3..0.3, d).prop_map(|mut q| {
        q[2] += 1.0;
        q
    })
}

const NOISES: [Noise; 2] = [Noise::OutlierFloor { outlier: 0.02 }, Noise::StudentT { degrees: 4.0 }];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Gradients against central differences (K6), for the likelihoods.
    #[test]
    fn keypoint_gradient_agrees_with_central_differences(q in pose(32)) {
        for noise in NOISES {
            check_gradient(&keypoints(noise, Isa::best()).1, &q);
        }
    }

    #[test]
    fn a_broadened_likelihood_is_that_of_a_model_with_larger_errors(q in pose(32), factor in 1.5..20.0) {
        for noise in [Noise::OutlierFloor { outlier: 0.02 }, Noise::StudentT { degrees: 4.0 }] {
            let bound = keypoints(noise, Isa::best()).1;
            let broad = bound.broadened(factor).expect("offered");
            let expected = keypoints_with_errors(factor, noise, Isa::best()).1;
            let (mut g, mut h) = (vec![0.0; 32], vec![0.0; 32]);
            let (a, b) = (broad.log_density_grad(&q, &mut g), expected.log_density_grad(&q, &mut h));
            prop_assert!((a - b).abs() < 1e-10 * b.abs().max(1.0), "{a} {b}");
            let largest = h.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
            prop_assert!(g.iter().zip(&h).all(|(a, b)| (a - b).abs() < 1e-10 * largest));
        }
    }

    #[test]
    fn block_and_single_state_agree_on_every_instruction_set(q in pose(32)) {
        for noise in NOISES {
            check_lanes(|isa| keypoints(noise, isa).1, &q);
        }
    }

}

/// The keypoint curvature is that of the same sum over sightings, with every sighting at full weight.
#[test]
fn keypoint_curvature_agrees_with_the_numerical_jacobian() {
    let (model, density) = keypoints(NOISES[0], Isa::best());
    let mut q = vec![0.05; 32];
    q[2] = 1.0;
    let block: Vec<Block> = q.iter().map(|&x| Block::splat(x)).collect();
    let mut diagonal = vec![Block::ZERO; 32];
    density.gauss_newton_diagonal_block(&block, &mut diagonal, &mut vec![Block::ZERO; density.workspace()]);
    let n = model.plan.points();
    let (mut p, mut jacobian) = (vec![0.0; 3 * n], vec![0.0; 3 * n * 32]);
    point_jacobian(&model.plan, Isa::best(), &q, &mut p, &mut jacobian);
    let mut at_binding = vec![0.0; 32];
    at_binding[2] = 1.0;
    let mut standing = vec![0.0; 3 * n];
    point_positions(&model.plan, Isa::best(), &at_binding, &mut standing);
    let mut expected = [0.0; 32];
    for k in 0..n {
        let seen: Vec<_> = (0..4).filter(|c| (k + c) % 9 != 0).collect();
        for &c in &seen {
            let camera = &model.views[c].camera;
            let z = (0..3).map(|j| camera.rotation[2][j] * standing[3 * k + j]).sum::<f64>() + camera.translation[2];
            let variance = 64.0 * 0.7 / 0.6 + 2.0 / 3.0 * seen.len() as f64 * (0.015 * 900.0 / z).powi(2);
            for (j, e) in expected.iter_mut().enumerate() {
                let moved = |h: f64| {
                    let moved: Vec<f64> = (0..3).map(|a| p[3 * k + a] + h * jacobian[(3 * k + a) * 32 + j]).collect();
                    project(camera, &moved)
                };
                let (a, b) = (moved(1e-5), moved(-1e-5));
                *e += (0..2).map(|i| ((a[i] - b[i]) / 2e-5).powi(2)).sum::<f64>() / variance;
            }
        }
    }
    for (found, expected) in diagonal.iter().zip(expected) {
        assert!((found.0[0] - expected).abs() < 1e-6 * expected.max(1.0), "{} against {expected}", found.0[0]);
    }
}

#[test]
fn a_point_behind_a_camera_counts_as_an_outlier_and_does_not_pull() {
    for noise in NOISES {
        let (model, density) = keypoints(noise, Isa::best());
        let mut q = vec![0.0; 32];
        q[0] = 50.0;
        let mut grad = vec![0.0; 32];
        let value = density.log_density_grad(&q, &mut grad);
        assert!(value.is_finite());
        assert!(grad.iter().all(|g| g.is_finite()), "{grad:?}");
        let nothing = vec![vec![None; model.plan.points()]; 4];
        let empty = model.bind(KeypointFrame {
            detections: &nothing,
            elsewhere: &[],
            predicted: &vec![0.0; 3 * model.plan.points()],
        });
        assert_eq!(empty.log_density_grad(&q, &mut grad), 0.0);
        assert!(grad.iter().all(|&g| g == 0.0));
    }
}

/// Where no lens shows the body, each sighting is at its floor and nothing pulls: the same value as behind the camera, whatever the lens.
#[test]
fn a_point_beyond_the_domain_of_a_lens_counts_as_an_outlier() {
    let narrow: [Lens; 3] = [
        Brown { k1: -0.3, ..Brown::default() }.into(),
        Rational { denominator: [1.0, 0.0, 0.0], ..Rational::default() }.into(),
        Fisheye { k: [-0.4, 0.0, 0.0, 0.0] }.into(),
    ];
    for (noise, lens) in NOISES.into_iter().flat_map(|noise| narrow.map(|lens| (noise, lens))) {
        let (mut model, _) = keypoints(noise, Isa::best());
        model.views.truncate(1);
        model.views[0].camera.lens = lens;
        let camera = &model.views[0].camera;
        let n = model.plan.points();
        let bound = |model: &KeypointModel| {
            let detections = vec![vec![Some(Detection::new([480.0, 600.0], 0.6)); n]];
            model.bind(KeypointFrame { detections: &detections, elsewhere: &[], predicted: &[0.0, 0.0, 1.0].repeat(n) })
        };
        let density = bound(&model);
        let at = |place: [f64; 3]| {
            let mut q = vec![0.0; 32];
            q[..3].copy_from_slice(&place);
            let mut grad = vec![0.0; 32];
            let value = density.log_density_grad(&q, &mut grad);
            let mut points = vec![0.0; 3 * n];
            point_positions(&model.plan, Isa::best(), &q, &mut points);
            let seen = points.as_chunks::<3>().0.iter().filter(|p| camera.project(**p).pixel().is_some()).count();
            (value, grad.iter().all(|g| *g == 0.0), seen)
        };
        let [side, _, forward] = camera.rotation;
        let centre = camera.centre();
        let moved = |ahead: f64, aside: f64| [0, 1, 2].map(|k: usize| centre[k] + ahead * forward[k] + aside * side[k]);
        let (behind, beyond, seen) = (at(moved(-5.0, 0.0)), at(moved(4.0, 40.0)), at(moved(4.0, 0.0)));
        assert_eq!((behind, behind.2), (beyond, 0), "{lens:?}");
        assert!(seen.2 == n && !seen.1 && seen.0 > behind.0, "{lens:?}");
    }
}

/// The value by the formula of the module, sighting by sighting: with all cameras seeing the body, and with the body behind two of them, where only the outliers' share is left.
#[test]
fn the_density_is_the_sum_over_sightings_written_out() {
    for (noise, shift) in NOISES.into_iter().flat_map(|noise| [(noise, 0.0), (noise, 4.5)]) {
        let (model, density) = keypoints(noise, Isa::best());
        let standing = {
            let mut q = vec![0.0; 32];
            q[2] = 1.0;
            q
        };
        let mut q = standing.clone();
        // Along the axis of the first camera, past it.
        let axis = model.views[0].camera.rotation[2];
        (0..3).for_each(|k| q[k] -= shift * axis[k]);
        let points = |q: &[f64]| {
            let mut points = vec![0.0; 3 * model.plan.points()];
            point_positions(&model.plan, Isa::best(), q, &mut points);
            points
        };
        let (at_binding, now) = (points(&standing), points(&q));
        let mut expected = 0.0;
        let mut behind = 0;
        for k in 0..model.plan.points() {
            let seen: Vec<_> = (0..4).filter(|c| (k + c) % 9 != 0).collect();
            for &c in &seen {
                let camera = &model.views[c].camera;
                let depth = |p: &[f64]| camera.point_in_camera([p[0], p[1], p[2]])[2];
                let range = 3 * k..3 * k + 3;
                let scale = 0.015 * 900.0 / depth(&at_binding[range.clone()]);
                let variance = 64.0 * 0.7 / 0.6 + 2.0 / 3.0 * seen.len() as f64 * scale * scale;
                let peak = 1.0 / (std::f64::consts::TAU * variance);
                let [u, v] = project(camera, &at_binding[range.clone()]);
                let jitter = ((7 * k + 3 * c) % 11) as f64 - 5.0;
                let gross = if k == 4 && c == 1 { 400.0 } else { 0.0 };
                let in_front = depth(&now[range.clone()]) > 0.05;
                behind += usize::from(!in_front);
                let there = project(camera, &now[range]);
                let square = (u + jitter - there[0]).powi(2) + (v - jitter + gross - there[1]).powi(2);
                expected += match noise {
                    Noise::OutlierFloor { outlier } => {
                        let core = if in_front { (-0.5 * square / variance).exp() } else { 0.0 };
                        ((1.0 - outlier) * peak * core + outlier / (1000.0 * 1200.0)).ln()
                    }
                    Noise::StudentT { degrees } => {
                        let spread = if in_front { square / variance } else { 1e6 };
                        peak.ln() - 0.5 * (degrees + 2.0) * (spread / degrees + if in_front { 1.0 } else { 0.0 }).ln()
                    }
                };
            }
        }
        assert_eq!(behind > 0, shift > 0.0);
        let found = density.log_density(&q);
        assert!((found - expected).abs() < 1e-9 * expected.abs(), "{noise:?}, {shift}: {found} against {expected}");
        check_gradient(&density, &q);
    }
}

#[test]
fn a_weighted_matrix_leaves_out_what_counts_as_an_outlier() {
    for noise in [Noise::OutlierFloor { outlier: 0.02 }, Noise::StudentT { degrees: 4.0 }] {
        let (model, bound) = keypoints(noise, Isa::best());
        let d = model.plan.dof();
        let trace = |shift: f64| {
            let mut x = vec![Block::ZERO; d];
            (x[0], x[2]) = (Block::splat(shift), Block::splat(1.0));
            let (mut full, mut weighted) = (vec![Block::ZERO; triangle(d, 0)], vec![Block::ZERO; triangle(d, 0)]);
            let mut ws = vec![Block::ZERO; bound.workspace()];
            bound.gauss_newton_block(&x, &mut full, &mut ws);
            bound.weighted_gauss_newton_block(&x, &mut weighted, &mut ws);
            let entry = |m: &[Block]| m[triangle(2, 2)].0[1];
            entry(&weighted) / entry(&full)
        };
        // One of some ninety sightings is a gross outlier; a metre away all are.
        let (near, far) = (trace(0.0), trace(1.0));
        let most = if noise == (Noise::OutlierFloor { outlier: 0.02 }) { 1.0 } else { 1.5 };
        assert!(near > 0.9 && near < most, "{near}");
        assert!(far < 0.1, "{far}");
    }
}
