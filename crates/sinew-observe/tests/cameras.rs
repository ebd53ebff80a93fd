//! Laws of cameras: derivatives, the inverse of the distortion, epipolar geometry, rigid motions.

use proptest::prelude::*;
use sinew_observe::cameras::lens::Brown;
use sinew_observe::cameras::triangulate::{self, Seen, triangulate};
use sinew_observe::{Camera, Intrinsics};

type M3 = [[f64; 3]; 3];

fn product(a: M3, b: M3) -> M3 {
    [0, 1, 2].map(|i: usize| [0, 1, 2].map(|j: usize| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn transposed(a: M3) -> M3 {
    [0, 1, 2].map(|i: usize| [0, 1, 2].map(|j: usize| a[j][i]))
}

fn applied(a: M3, v: [f64; 3]) -> [f64; 3] {
    a.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// A camera on a ring of 3 to 6 m, with a mild lens.
fn camera() -> impl Strategy<Value = Camera> {
    let place = (3.0..6.0, 0.0..std::f64::consts::TAU, 0.5..3.0);
    let lens = (-0.1..0.1, -0.02..0.05, -1e-3..1e-3, -1e-3..1e-3, -0.01..0.01);
    (place, lens, 400.0..1800.0).prop_map(|((radius, angle, height), (k1, k2, p1, p2, k3), focal)| {
        let centre = [radius * f64::cos(angle), radius * f64::sin(angle), height];
        let mut camera =
            Camera::look_at("C", [1088.0, 1920.0], focal, centre, [0.0, 0.0, 1.0]).expect("not straight down");
        camera.lens = Brown { k1, k2, p1, p2, k3 }.into();
        camera.intrinsics.fy *= 1.01;
        camera
    })
}

fn point() -> impl Strategy<Value = [f64; 3]> {
    [-0.8..0.8, -0.8..0.8, 0.0..2.0]
}

proptest! {
    /// The derivative of the projection against central differences (K8).
    #[test]
    fn projection_jacobian_is_that_of_central_differences(camera in camera(), p in point()) {
        if let Some((pixel, jacobian)) = camera.project_with_jacobian(p) {
            let scale = camera.intrinsics.fx;
            prop_assert_eq!(Some(pixel), camera.project(p).pixel());
            for k in 0..3 {
                let at = |h: f64| { let mut p = p; p[k] += h; camera.project(p).pixel() };
                if let (Some(above), Some(below)) = (at(1e-4), at(-1e-4)) {
                    for axis in 0..2 {
                        let numeric = (above[axis] - below[axis]) / 2e-4;
                        prop_assert!((numeric - jacobian[axis][k]).abs() < 1e-6 * scale, "{numeric} {}", jacobian[axis][k]);
                    }
                }
            }
        }
    }

    /// Inside the image the distortion can be undone to 1e-6 px.
    #[test]
    fn distorting_and_undistorting_gives_the_pixel_back(camera in camera(), u in 0.0..1088.0, v in 0.0..1920.0) {
        let normalised = camera.normalised_from_pixel([u, v]);
        if normalised[0].hypot(normalised[1]) < 0.95 * camera.lens.valid_radius() {
            let seen = camera.pixel_from_normalised(camera.lens.distorted(normalised).expect("inside"));
            let back = camera.undistort(seen).expect("inside the valid radius");
            prop_assert!((back[0] - u).abs() < 1e-6 && (back[1] - v).abs() < 1e-6, "{back:?}");
        }
    }

    /// Epipolar constraint of two cameras (K9): `x2ᵀ E x1 = 0` with `E = [t]× R`, and `F = K2⁻ᵀ E K1⁻¹` in pixels.
    #[test]
    fn a_point_is_triangulated_where_it_is_through_any_lens(a in camera(), b in camera(), c in camera(), p in point()) {
        let cameras = [a, b, c];
        let seen: Option<Vec<Seen<'_>>> = cameras
            .iter()
            .map(|camera| Some(Seen { camera, pixel: camera.project(p).pixel()?, confidence: 0.9 }))
            .collect();
        let apart = |i: usize, j: usize| {
            let [a, b] = [i, j].map(|c| cameras[c].centre());
            (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>() > 1.0
        };
        prop_assume!(apart(0, 1) && apart(0, 2) && apart(1, 2));
        if let Some(seen) = seen {
            let found = triangulate(&seen, &triangulate::Config::default());
            let found = found.ok_or_else(|| TestCaseError::fail("no point"))?;
            prop_assert!((0..3).all(|k| (found.point[k] - p[k]).abs() < 1e-6), "{:?} for {p:?}", found.point);
            prop_assert!(found.error_px < 1e-4 && found.used == [0, 1, 2]);
        }
    }

    #[test]
    fn two_views_of_a_point_satisfy_the_epipolar_constraint(a in camera(), b in camera(), p in point()) {
        let r = product(b.rotation, transposed(a.rotation));
        let between = [0, 1, 2].map(|k: usize| a.centre()[k] - b.centre()[k]);
        let t = applied(b.rotation, between);
        let cross = [[0.0, -t[2], t[1]], [t[2], 0.0, -t[0]], [-t[1], t[0], 0.0]];
        let essential = product(cross, r);
        let (x1, x2) = (a.point_in_camera(p), b.point_in_camera(p));
        let residual: f64 = applied(essential, x1).iter().zip(x2).map(|(l, x)| l * x).sum();
        prop_assert!(residual.abs() < 1e-12, "{residual}");

        let inverse = |Intrinsics { fx, fy, cx, cy }: Intrinsics| {
            [[1.0 / fx, 0.0, -cx / fx], [0.0, 1.0 / fy, -cy / fy], [0.0, 0.0, 1.0]]
        };
        let fundamental = product(product(transposed(inverse(b.intrinsics)), essential), inverse(a.intrinsics));
        let (u1, u2) = (a.project_ideal(p).expect("in front"), b.project_ideal(p).expect("in front"));
        let line = applied(fundamental, [u1[0], u1[1], 1.0]);
        let residual = line[0] * u2[0] + line[1] * u2[1] + line[2];
        prop_assert!(residual.abs() < 1e-10, "{residual}");
    }

    /// Moving world and camera together changes no pixel.
    #[test]
    fn a_turned_camera_sees_the_turned_world(camera in camera(), p in point(), angle in -3.0..3.0) {
        let (s, c) = f64::sin_cos(angle);
        let turn = product([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0], [0.0, c, s], [0.0, -s, c]]);
        let [before, after] = [camera.project(p).pixel(), camera.turned(turn).project(applied(turn, p)).pixel()];
        match (before, after) {
            (Some(a), Some(b)) => prop_assert!((0..2).all(|k| (a[k] - b[k]).abs() < 1e-8), "{a:?} {b:?}"),
            (a, b) => prop_assert_eq!(a, b),
        }
    }

    #[test]
    fn pixels_do_not_change_when_everything_moves(camera in camera(), p in point(), angle in -3.0..3.0, d in point()) {
        let (s, c) = f64::sin_cos(angle);
        let turn = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
        let moved_point = { let q = applied(turn, p); [q[0] + d[0], q[1] + d[1], q[2] + d[2]] };
        let rotation = product(camera.rotation, transposed(turn));
        let shift = applied(rotation, d);
        let translation = [0, 1, 2].map(|k: usize| camera.translation[k] - shift[k]);
        let moved = Camera { rotation, translation, ..camera.clone() };
        if let (Some(a), Some(b)) = (camera.project(p).pixel(), moved.project(moved_point).pixel()) {
            prop_assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9);
        }
    }
}
