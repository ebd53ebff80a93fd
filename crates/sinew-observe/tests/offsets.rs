//! Offsets of cameras: found but for a shift of the world, and never from nothing.

use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;
use sinew_observe::cameras::offsets::{Config, Sighted, estimate, hidden_shift_m};
use sinew_observe::cameras::triangulate::{Seen, linear};
use sinew_observe::{Camera, Detection};

fn ring(n: usize) -> Vec<Camera> {
    (0..n)
        .map(|i| {
            let angle = 0.4 + std::f64::consts::TAU * i as f64 / n as f64;
            let centre = [4.0 * angle.cos(), 4.0 * angle.sin(), 1.8];
            Camera::look_at(&format!("C{i}"), [1000.0, 1000.0], 1000.0, centre, [0.0, 0.0, 1.0]).expect("a view")
        })
        .collect()
}

/// Forty frames of twelve points near the middle.
fn frames(cameras: &[Camera], offsets: &[[f64; 2]], confidence: f64) -> Vec<Sighted> {
    (0..40)
        .map(|f| {
            let point = |k: usize| {
                let t = f as f64 * 0.37 + k as f64;
                [0.3 * t.sin(), 0.3 * (1.7 * t).cos(), 1.0 + 0.6 * (0.9 * t).sin()]
            };
            let seen = |camera: &Camera, [du, dv]: [f64; 2]| {
                let pixel = |k| camera.project(point(k)).pixel().map(|[u, v]| [u + du, v + dv]);
                (0..12).map(|k| Some(Detection::new(pixel(k)?, confidence))).collect()
            };
            cameras.iter().zip(offsets).map(|(camera, offset)| seen(camera, *offset)).collect()
        })
        .collect()
}

#[test]
fn offsets_make_rays_meet_and_shift_nobody() {
    check_offsets(0.7, Config::default());
    check_offsets(0.12, Config { least_confidence: 0.1, ..Config::default() });
}

fn check_offsets(confidence: f64, config: Config) {
    let cameras = ring(4);
    let truth = [[8.0, -3.0], [-6.0, 2.0], [3.0, 5.0], [-4.0, -4.0]];
    let frames = frames(&cameras, &truth, confidence);
    let noise = estimate(&cameras, &frames, &Config { tolerance_px: 1e-4, rounds: 200, ..config });
    let mut shifts = vec![];
    for frame in &frames {
        for k in (0..12).collect::<Vec<usize>>() {
            let seen = |without: bool| -> Vec<Seen<'_>> {
                let at = |c: usize| {
                    let d = frame[c][k].expect("seen");
                    let [u, v] = if without { noise[c].offset_px } else { [0.0; 2] };
                    Seen { camera: &cameras[c], pixel: [d.pixel[0] - u, d.pixel[1] - v], confidence: d.confidence }
                };
                (0..4).map(at).collect()
            };
            let point = linear(&seen(true), true).expect("four rays");
            for s in seen(true) {
                let [u, v] = s.camera.project(point).pixel().expect("in front");
                let residual = (u - s.pixel[0]).hypot(v - s.pixel[1]);
                assert!(residual < 1.5, "{residual} px remain of offsets up to 8.5");
            }
            let plain = linear(&seen(false), true).expect("four rays");
            shifts.push([0, 1, 2].map(|a: usize| plain[a] - point[a]));
        }
    }
    for axis in 0..3 {
        let mut along: Vec<f64> = shifts.iter().map(|s| s[axis]).collect();
        assert!(sinew_core::estimators::median(&mut along).abs() < 2e-3, "points are shifted along axis {axis}");
    }
    assert!(noise.iter().all(|n| n.sigma_px < 1.0 && n.usual_confidence == confidence));
}

#[test]
fn nothing_seen_gives_no_offset_and_no_scatter() {
    let cameras = ring(3);
    for noise in [
        estimate(&cameras, &[], &Config::default()),
        estimate(&cameras, &[vec![vec![None; 12]; 3]], &Config::default()),
        estimate(&cameras, &frames(&cameras[..1], &[[5.0, 5.0]], 0.7), &Config::default()),
    ] {
        assert!(noise.iter().all(|n| n.offset_px == [0.0; 2] && n.sigma_px.is_nan()));
    }
}

/// Offsets are drawn and the shift of least squares is taken away: the mean square of that shift is what the remains foretell.
#[test]
fn what_remains_of_offsets_foretells_the_shift_that_they_hide() {
    const MIDDLE: [f64; 3] = [0.1, -0.2, 1.0];
    for cameras in [ring(3), ring(4), ring(6)] {
        let jacobians: Vec<_> = cameras.iter().map(|c| c.project_with_jacobian(MIDDLE).unwrap().1).collect();
        let rows: Vec<[f64; 3]> = jacobians.into_iter().flatten().collect();
        let design = nalgebra::DMatrix::from_fn(rows.len(), 3, |row, k| rows[row][k]);
        let svd = design.clone().svd(true, true);
        let (mut hidden, mut foretold) = (0.0, 0.0);
        for draw in 0..4000 {
            let mut normal = [Block::ZERO; 2];
            Stage::new(3, "offsets").at_frame(draw).whole().fill_normal(Isa::baseline(), &mut normal);
            let drawn = normal.iter().flat_map(|block| block.0).map(|z| 5.0 * z).take(rows.len());
            let drawn = nalgebra::DVector::from_iterator(rows.len(), drawn);
            let shift = svd.solve(&drawn, 1e-12).unwrap();
            let remains = &drawn - &design * &shift;
            let offsets: Vec<[f64; 2]> = remains.as_slice().chunks(2).map(|pair| [pair[0], pair[1]]).collect();
            hidden += shift.norm_squared() / 3.0;
            foretold += hidden_shift_m(&cameras, &offsets, MIDDLE).unwrap().powi(2);
        }
        let ratio = foretold / hidden;
        assert!((ratio - 1.0).abs() < 0.06, "{} cameras: {ratio}", cameras.len());
    }
    assert_eq!(hidden_shift_m(&ring(1), &[[3.0, 0.0]], MIDDLE), None);
}
