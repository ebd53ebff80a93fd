//! Shift symmetry: where world and cameras are moved by a rigid motion, estimates move along.
//! To 1e-9 where nothing is drawn, within 4 Monte Carlo errors where it is.

use sinew::core::density::{GradLogDensity, Lanes, LogDensity};
use sinew::core::diagnostics::effective_sample_size;
use sinew::core::lanes::{Block, Isa, LANES};
use sinew::core::random::Stage;
use sinew::dynamics::gaussian::Gaussian;
use sinew::observe::Camera;
use sinew::observe::cameras::triangulate::{Config, Seen, linear, refined, triangulate};
use sinew::samplers::chains::{Schedule, draw_trajectories};
use sinew::samplers::hmc::Hmc;
use sinew_tests::camera_point::{CameraPoint, Sight, View};

/// A turn about a slanted axis and a shift of some metres.
struct Motion {
    turn: [[f64; 3]; 3],
    shift: [f64; 3],
}

fn motion() -> Motion {
    // Rodrigues about (1, 2, 2) / 3 by 0.8 rad.
    let (axis, angle) = ([1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0], 0.8_f64);
    let (sin, cos) = angle.sin_cos();
    let cross = [[0.0, -axis[2], axis[1]], [axis[2], 0.0, -axis[0]], [-axis[1], axis[0], 0.0]];
    let turn = [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| f64::from(u8::from(i == j)) * cos + sin * cross[i][j] + (1.0 - cos) * axis[i] * axis[j])
    });
    Motion { turn, shift: [3.0, -5.0, 0.7] }
}

impl Motion {
    fn of(&self, x: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| self.shift[i] + (0..3).map(|j| self.turn[i][j] * x[j]).sum::<f64>())
    }

    /// The camera that sees of the moved world what this one sees of the old.
    fn camera(&self, camera: &Camera) -> Camera {
        let rotation =
            [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| camera.rotation[i][k] * self.turn[j][k]).sum::<f64>()));
        let translation =
            [0, 1, 2].map(|i| camera.translation[i] - (0..3).map(|j| rotation[i][j] * self.shift[j]).sum::<f64>());
        Camera { rotation, translation, ..camera.clone() }
    }
}

fn cameras() -> Vec<Camera> {
    [[3.0, 3.0, 1.5], [-3.0, 2.5, 1.0], [0.5, -4.0, 2.0]]
        .map(|centre| Camera::look_at("c", [1280.0, 720.0], 900.0, centre, [0.0, 0.0, 1.0]).expect("not straight down"))
        .to_vec()
}

fn seen<'a>(cameras: &'a [Camera], pixels: &[[f64; 2]]) -> Vec<Seen<'a>> {
    cameras.iter().zip(pixels).map(|(camera, &pixel)| Seen { camera, pixel, confidence: 0.9 }).collect()
}

#[test]
fn triangulated_points_move_with_the_world() {
    let (motion, old) = (motion(), cameras());
    let new: Vec<Camera> = old.iter().map(|camera| motion.camera(camera)).collect();
    for (k, point) in [[0.1, -0.2, 1.1], [0.6, 0.5, 0.3], [-0.4, 0.2, 1.7]].into_iter().enumerate() {
        let error = |c: usize| 1.5 * (1.7 * (3 * k + c) as f64).sin();
        let pixels: Vec<[f64; 2]> = old
            .iter()
            .enumerate()
            .map(|(c, camera)| {
                let [u, v] = camera.project(point).pixel().expect("in front");
                let [x, y] = new[c].project(motion.of(point)).pixel().expect("in front");
                assert!((u - x).abs() < 1e-9 && (v - y).abs() < 1e-9, "pixels stay");
                [u + error(c), v - error(c + 1)]
            })
            .collect();
        let before = seen(&old, &pixels);
        let after = seen(&new, &pixels);
        let off = |a: [f64; 3], b: [f64; 3]| {
            let moved = motion.of(a);
            (0..3).map(|i| (moved[i] - b[i]).abs()).fold(0.0, f64::max)
        };
        let of = |seen: &[Seen<'_>]| linear(seen, true).expect("a point");
        let exact: Vec<[f64; 2]> = old.iter().map(|c| c.project(point).pixel().expect("in front")).collect();
        let certain = off(of(&seen(&old, &exact)), of(&seen(&new, &exact)));
        assert!(certain < 1e-9, "linear, without errors: off by {certain}");
        // The algebraic error that the linear method makes small is not the same after a motion: with errors of 1.5 px it differs by micrometres.
        let algebraic = off(of(&before), of(&after));
        assert!(algebraic < 1e-4, "linear, with errors: off by {algebraic}");
        let start = triangulate(&before, &Config::default()).expect("a point").point;
        let sigma = [1.5; 3];
        let fine = refined(&before, &sigma, start).expect("a point").point;
        let moved = refined(&after, &sigma, motion.of(start)).expect("a point").point;
        assert!(off(fine, moved) < 1e-9, "refined: off by {}", off(fine, moved));
    }
}

/// The posterior of the camera point in both worlds: density to 1e-9, means of chains within 4 Monte Carlo errors of the moved exact mean.
#[test]
fn the_posterior_of_a_point_moves_with_the_world() {
    let Some(point) = CameraPoint::stored() else { return };
    let motion = motion();
    let three = |x: &[f64]| -> [f64; 3] { [x[0], x[1], x[2]] };
    let view = |v: &View| View { camera: motion.camera(&v.camera), ..v.clone() };
    let sight = Sight(point.sight.0.iter().map(view).collect());
    let variance = sinew_tests::stored::number(&point.stored["p0"]).powi(2);
    let covariance: Vec<f64> = (0..9).map(|e| if e / 3 == e % 3 { variance } else { 0.0 }).collect();
    let centre = motion.of(three(point.prior.leaf.mean())).to_vec();
    let prior = Lanes { leaf: Gaussian::new(centre, &covariance).expect("positive definite"), isa: Isa::best() };
    let target = sinew::core::combinators::Sum(&sight, &prior);
    for x in [point.mode.clone(), vec![0.1, -0.1, 1.0], vec![0.3, -0.5, 0.8]] {
        let moved = motion.of(three(&x));
        let (old, new) = (point.target().log_density(&x), target.log_density(&moved));
        assert!((old - new).abs() < 1e-9 * old.abs().max(1.0), "{old} against {new}");
        let (mut before, mut after) = ([0.0; 3], [0.0; 3]);
        point.target().log_density_grad(&x, &mut before);
        target.log_density_grad(&moved, &mut after);
        for (i, found) in after.iter().enumerate() {
            let turned: f64 = (0..3).map(|j| motion.turn[i][j] * before[j]).sum();
            let scale = before.iter().fold(1.0_f64, |a, g| a.max(g.abs()));
            assert!((found - turned).abs() < 1e-9 * scale, "{found} against {turned}");
        }
    }
    let curvature: Vec<f64> = (0..3).map(|j| 1.0 / point.moments.covariance[4 * j]).collect();
    let hmc = Hmc::new(0.5, &curvature, 5, 0.2, Isa::best()).expect("valid");
    let start = motion.of(three(&point.mode));
    let starts: Vec<Block> = (0..2).flat_map(|_| start.map(Block::splat)).collect();
    let schedule = Schedule { updates: 1000, burn_in: 50 };
    let draws =
        draw_trajectories(&target, &hmc, &starts, 2 * LANES, schedule, &Stage::new(4, "moved world")).expect("finite");
    let exact = motion.of(three(&point.moments.mean));
    for (j, exact) in exact.into_iter().enumerate() {
        let series = draws.series(j);
        let n = series.iter().map(Vec::len).sum::<usize>() as f64;
        let mean = series.iter().flatten().sum::<f64>() / n;
        let variance = series.iter().flatten().map(|x| (x - mean).powi(2)).sum::<f64>() / n;
        let z = (mean - exact) / (variance / effective_sample_size(&series)).sqrt();
        assert!(z.abs() < 4.0, "coordinate {j}: {mean} against {exact}, z = {z}, bound 4, seed 4");
    }
}
