//! Limbs whose sides a detector may have exchanged: the mixture against its components, its gradient, its curvature, its lanes.

use sinew_body::standard::h32;
use sinew_body::{Plan, Proportions, point_positions};
use sinew_core::density::{GaussNewton, GradLogDensity, LogDensity};
use sinew_core::lanes::{Block, Isa, LANES, set_lane};
use sinew_observe::association::following::Associated;
use sinew_observe::keypoints::bystanders::elsewhere;
use sinew_observe::keypoints::mistakes::paired_limbs;
use sinew_observe::{
    Camera, Detection, KeypointFrame, KeypointModel, Mistakes, Noise, ObservationModel, View, association,
};
use std::sync::Arc;

const FLOOR: Noise = Noise::OutlierFloor { outlier: 0.02 };
const STUDENT: Noise = Noise::StudentT { degrees: 4.0 };

type Detections = Vec<Vec<Option<Detection>>>;

/// Three cameras around a body that stands with its feet together.
struct Scene {
    model: KeypointModel,
    points: Vec<f64>,
    pose: Vec<f64>,
    detections: Detections,
}

fn limbs(names: &[String], tree: &sinew_body::KinematicTree) -> Vec<Vec<(usize, usize)>> {
    let place = |name: &str| names.iter().position(|own| own == name);
    let pair = |(k, name): (usize, &String)| Some((k, place(&format!("R{}", name.strip_prefix('L')?))?));
    let pairs: Vec<(usize, usize)> = names.iter().enumerate().filter_map(pair).collect();
    paired_limbs(tree, &(0..names.len()).collect::<Vec<_>>(), &pairs)
}

fn scene(noise: Noise, exchanged: f64, isa: Isa) -> Scene {
    let tree = h32(&Proportions::default());
    let names: Vec<String> = tree.points().iter().map(|point| point.name.clone()).collect();
    let plan = Arc::new(Plan::with_all_points(&tree));
    let mut pose = vec![0.0; plan.dof()];
    pose[2] = 1.0;
    pose.iter_mut().enumerate().skip(6).for_each(|(j, x)| *x = 0.1 * (1.3 * j as f64).sin());
    let mut points = vec![0.0; 3 * plan.points()];
    point_positions(&plan, isa, &pose, &mut points);
    let view = |k: usize| {
        let (sin, cos) = (0.3 + 2.1 * k as f64).sin_cos();
        let camera =
            Camera::look_at("C", [1000.0, 800.0], 700.0, [4.0 * cos, 4.0 * sin, 1.3], [0.0, 0.0, 1.0]).unwrap();
        View { camera, bias_px: vec![[2.0, -1.0]; plan.points()], sigma_px: 9.0, usual_confidence: 0.7 }
    };
    let views: Vec<View> = (0..3).map(view).collect();
    let seen = |(c, view): (usize, &View)| {
        let one = |(k, p): (usize, &[f64])| {
            let [u, v] = view.camera.project([p[0], p[1], p[2]]).pixel()?;
            let jitter = f64::from((5 * k as u32 + 3 * c as u32) % 13) - 6.0;
            let confidence = 0.5 + 0.03 * (k % 7) as f64;
            ((k + 2 * c) % 11 != 0).then_some(Detection::new([u + jitter + 2.0, v - jitter - 1.0], confidence))
        };
        points.chunks_exact(3).enumerate().map(one).collect::<Vec<_>>()
    };
    let detections = views.iter().enumerate().map(seen).collect();
    let mistakes = Mistakes { limbs: limbs(&names, &tree), exchanged: vec![exchanged; 3], elsewhere: vec![0.01; 3] };
    let model = KeypointModel { plan, views, noise, model_error_m: 0.0, least_confidence: 0.05, mistakes, isa };
    Scene { model, points, pose, detections }
}

impl Scene {
    fn bound(&self, detections: &Detections) -> impl GaussNewton + use<> {
        self.model.bind(KeypointFrame { detections, elsewhere: &[], predicted: &self.points })
    }

    /// The same where another pose is predicted.
    fn predicted(mut self, pose: &[f64]) -> Self {
        point_positions(&self.model.plan, Isa::baseline(), pose, &mut self.points);
        self
    }

    /// The frame with the sides of a pair of limbs exchanged in a camera.
    fn exchanged(&self, detections: &Detections, camera: usize, limb: usize) -> Detections {
        let mut exchanged = detections.clone();
        self.model.mistakes.limbs[limb].iter().for_each(|&(left, right)| exchanged[camera].swap(left, right));
        exchanged
    }

    /// The same cameras, which never exchange anything.
    fn without_mistakes(&self) -> Self {
        let model = KeypointModel { mistakes: Mistakes::default(), ..self.model.clone() };
        Self { model, points: self.points.clone(), pose: self.pose.clone(), detections: self.detections.clone() }
    }

    /// Frames with every combination of exchanged limbs, and the logarithms of how probable they are.
    fn combinations(&self) -> Vec<(Detections, f64)> {
        let mut all = vec![(self.detections.clone(), 0.0)];
        for camera in 0..self.model.views.len() {
            for limb in 0..self.model.mistakes.limbs.len() {
                let q = self.model.mistakes.exchanged(camera);
                let both = |(frame, weight): (Detections, f64)| {
                    let crossed = self.exchanged(&frame, camera, limb);
                    [(frame, weight + (1.0 - q).ln()), (crossed, weight + q.ln())]
                };
                all = all.into_iter().flat_map(both).collect();
            }
        }
        all
    }
}

fn moved(pose: &[f64], by: f64) -> Vec<f64> {
    pose.iter().enumerate().map(|(j, x)| x + by * (2.1 * j as f64).cos()).collect()
}

/// Arms and legs are the limbs; hips and shoulders belong to them, eyes and ears to none.
#[test]
fn arms_and_legs_are_the_limbs() {
    let tree = h32(&Proportions::default());
    let names: Vec<String> = tree.points().iter().map(|point| point.name.clone()).collect();
    let found = limbs(&names, &tree);
    let of = |limb: &Vec<(usize, usize)>| {
        let mut lefts: Vec<&str> = limb.iter().map(|(left, _)| names[*left].as_str()).collect();
        lefts.sort_unstable();
        limb.iter().for_each(|(l, r)| assert_eq!(names[*l][1..], names[*r][1..]));
        lefts.join(" ")
    };
    let mut named: Vec<String> = found.iter().map(of).collect();
    named.sort();
    assert_eq!(named, ["LAnkle LBigToe LHeel LHip LKnee LSmallToe", "LElbow LShoulder LWrist"]);
}

/// Log of the sum of components with weights, at a pose.
fn log_sum(components: &[(impl LogDensity, f64)], pose: &[f64]) -> f64 {
    let logs: Vec<f64> = components.iter().map(|(one, weight)| one.log_density(pose) + weight).collect();
    let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    largest + logs.iter().map(|log| (log - largest).exp()).sum::<f64>().ln()
}

/// The density is the sum over all combinations of exchanged limbs, at the predicted pose and near it, for both shapes.
#[test]
fn the_mixture_is_the_sum_of_its_components() {
    for noise in [FLOOR, STUDENT] {
        for q in [0.02, 0.4] {
            for predicted in [0.0, 0.05, 0.3] {
                let scene = scene(noise, q, Isa::baseline());
                let pose = moved(&scene.pose, predicted);
                let scene = scene.predicted(&pose);
                let plain = scene.without_mistakes();
                let components: Vec<_> =
                    scene.combinations().into_iter().map(|(frame, weight)| (plain.bound(&frame), weight)).collect();
                assert_eq!(components.len(), 64);
                let mixture = scene.bound(&scene.detections);
                for pose in [pose.clone(), moved(&pose, 0.03)] {
                    // Pairs that are out of the question at the prediction are left out.
                    let (found, expected) = (mixture.log_density(&pose), log_sum(&components, &pose));
                    assert!((found - expected).abs() < 1e-6 * expected.abs(), "{noise:?}: {found} for {expected}");
                }
            }
        }
    }
}

/// A frame whose camera has exchanged the legs says as much of the pose as one that has not.
#[test]
fn exchanged_legs_are_put_right() {
    let scene = scene(FLOOR, 0.02, Isa::baseline());
    let legs = scene.model.mistakes.limbs.iter().position(|limb| limb.len() == 6).unwrap();
    // Legs far apart in the image of camera 0: keypoints to the side.
    let mut apart = scene.detections.clone();
    let plain = scene.without_mistakes();
    let frame = KeypointFrame { detections: &apart, elsewhere: &[], predicted: &scene.points };
    let straight = scene.model.exchanged(&frame)[0][legs].unwrap();
    apart = scene.exchanged(&apart, 0, legs);
    let frame = KeypointFrame { detections: &apart, elsewhere: &[], predicted: &scene.points };
    let crossed = scene.model.exchanged(&frame)[0][legs].unwrap();
    assert!(straight < 0.01 && crossed > 0.9, "{straight}, {crossed}");
    let gain = |scene: &Scene| {
        let bound = scene.bound(&apart);
        bound.log_density(&scene.pose)
    };
    assert!(gain(&scene) > gain(&plain) + 3.0, "{} and {}", gain(&scene), gain(&plain));
}

/// One camera of three may have exchanged the legs; that all three have is less likely than that the pose has.
#[test]
fn a_pose_that_most_cameras_contradict_is_turned() {
    let scene = scene(FLOOR, 0.02, Isa::baseline());
    let legs = scene.model.mistakes.limbs.iter().position(|limb| limb.len() == 6).unwrap();
    let is_turned = |cameras: usize| {
        let crossed =
            (0..cameras).fold(scene.detections.clone(), |frame, camera| scene.exchanged(&frame, camera, legs));
        scene.model.is_turned(&KeypointFrame { detections: &crossed, elsewhere: &[], predicted: &scene.points })
    };
    assert_eq!([0, 1, 2, 3].map(is_turned), [false, false, true, true]);
}

#[test]
fn gradients_of_mixtures_are_differences() {
    for noise in [FLOOR, STUDENT] {
        let scene = scene(noise, 0.4, Isa::baseline());
        let mixture = scene.bound(&scene.detections);
        for by in [0.0, 0.04, 0.15] {
            let pose = moved(&scene.pose, by);
            let mut grad = vec![0.0; pose.len()];
            mixture.log_density_grad(&pose, &mut grad);
            let largest = grad.iter().fold(1.0_f64, |m, g| m.max(g.abs()));
            for j in 0..pose.len() {
                let at = |h: f64| {
                    let mut moved = pose.clone();
                    moved[j] += h;
                    mixture.log_density(&moved)
                };
                let h = 1e-4;
                let numeric = (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
                assert!((numeric - grad[j]).abs() < 1e-6 * largest, "{noise:?} {j}: {numeric} for {}", grad[j]);
            }
        }
    }
}

/// A block, a state by itself and every instruction set give one answer.
#[test]
fn lanes_of_mixtures_agree() {
    for noise in [FLOOR, STUDENT] {
        let reference = scene(noise, 0.4, Isa::baseline());
        let single = reference.bound(&reference.detections);
        let states: Vec<Vec<f64>> = (0..LANES).map(|lane| moved(&reference.pose, 0.02 * lane as f64)).collect();
        let mut block = vec![Block::ZERO; reference.pose.len()];
        states.iter().enumerate().for_each(|(lane, state)| set_lane(&mut block, lane, state));
        for isa in Isa::available() {
            let mixture = scene(noise, 0.4, isa).bound(&reference.detections);
            let mut ws = vec![Block::ZERO; mixture.workspace()];
            let mut grad = vec![Block::ZERO; block.len()];
            let value = mixture.log_density_grad_block(&block, &mut grad, &mut ws);
            let plain = mixture.log_density_block(&block, &mut ws);
            for (lane, state) in states.iter().enumerate() {
                let mut expected = vec![0.0; state.len()];
                let log = single.log_density_grad(state, &mut expected);
                for found in [value.0[lane], plain.0[lane], mixture.log_density(state)] {
                    assert!((found - log).abs() <= 1e-12 * log.abs(), "{}: {found} for {log}", isa.name());
                }
                let largest = expected.iter().fold(1.0_f64, |m, g| m.max(g.abs()));
                for (found, expected) in grad.iter().zip(&expected) {
                    assert!((found.0[lane] - expected).abs() <= 1e-11 * largest, "{}", isa.name());
                }
            }
        }
    }
}

/// The weighted matrix of one pair in doubt is that of both ways, each by how probable it is; the other one counts every keypoint once.
#[test]
fn curvature_of_a_mixture_is_weighed() {
    for noise in [FLOOR, STUDENT] {
        let mut scene = scene(noise, 0.0, Isa::best());
        scene.model.mistakes.exchanged = vec![0.3, 0.0, 0.0];
        scene.model.mistakes.limbs.retain(|limb| limb.len() == 6);
        let plain = scene.without_mistakes();
        let ways =
            [scene.detections.clone(), scene.exchanged(&scene.detections, 0, 0)].map(|frame| plain.bound(&frame));
        let mixture = scene.bound(&scene.detections);
        let pose = moved(&scene.pose, 0.06);
        let block: Vec<Block> = pose.iter().map(|x| Block::splat(*x)).collect();
        let size = pose.len() * (pose.len() + 1) / 2;
        let mut ws = vec![Block::ZERO; mixture.workspace()];
        let mut matrix = |density: &dyn GaussNewton, weighted: bool| {
            let mut matrix = vec![Block::ZERO; size];
            match weighted {
                true => density.weighted_gauss_newton_block(&block, &mut matrix, &mut ws),
                false => density.gauss_newton_block(&block, &mut matrix, &mut ws),
            }
            matrix.iter().map(|entry| entry.0[3]).collect::<Vec<f64>>()
        };
        let [straight, crossed] = [0, 1].map(|way: usize| ways[way].log_density(&pose));
        let probability = 1.0 / (1.0 + (0.7_f64 / 0.3).ln().exp() * (straight - crossed).exp());
        let weighted = matrix(&mixture, true);
        let expected: Vec<Vec<f64>> = ways.iter().map(|way| matrix(way, true)).collect();
        let largest = weighted.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (k, found) in weighted.iter().enumerate() {
            let expected = (1.0 - probability) * expected[0][k] + probability * expected[1][k];
            assert!((found - expected).abs() < 1e-9 * largest, "{noise:?} {k}: {found} for {expected}");
        }
        let whole = matrix(&mixture, false);
        let plain = matrix(&ways[0], false);
        let largest = whole.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        // Keypoints that only the other side has count for it, too.
        let missing = whole.iter().zip(&plain).filter(|(a, b)| (*a - *b).abs() > 1e-9 * largest).count();
        assert!(missing < size / 2 && whole[0] >= plain[0] * (1.0 - 1e-9), "{missing}");
    }
}

/// Broadened, a mixture is that of broadened components, but for pairs that are out of the question unbroadened.
#[test]
fn broadened_mixtures_have_broadened_components() {
    let scene = scene(FLOOR, 0.4, Isa::baseline());
    let plain = scene.without_mistakes();
    let mixture = scene.bound(&scene.detections);
    let broad = mixture.broadened(3.0).unwrap();
    let frames: Vec<_> =
        scene.combinations().into_iter().map(|(frame, weight)| (plain.bound(&frame), weight)).collect();
    let components: Vec<_> = frames.iter().map(|(one, weight)| (one.broadened(3.0).unwrap(), *weight)).collect();
    let pose = moved(&scene.pose, 0.1);
    let (found, expected) = (broad.log_density(&pose), log_sum(&components, &pose));
    assert!((found - expected).abs() < 1e-5 * expected.abs(), "{found} for {expected}");
}

/// Somebody else's keypoints raise the floor where they are, in the density as in its formula; the same person detected twice does not.
#[test]
fn keypoints_of_others_raise_the_floor() {
    let mut scene = scene(FLOOR, 0.0, Isa::baseline());
    scene.model.mistakes.exchanged.clear();
    let own = scene.detections[0].clone();
    let shifted = |by: f64| -> Vec<Option<Detection>> {
        own.iter().map(|d| d.map(|d| Detection { pixel: [d.pixel[0] + by, d.pixel[1]], ..d })).collect()
    };
    let found = Associated { members: vec![Some(0), None, None], people: vec![own.clone(), vec![], vec![]] };
    let keypoints: Vec<usize> = (0..own.len()).collect();
    let config = association::Config::default();
    let density = |other: Vec<Option<Detection>>| {
        elsewhere(&scene.model, [&[vec![own.clone(), other], vec![], vec![]], &[]], &found, &keypoints, &config)
    };
    assert!(density(shifted(3.0))[0].is_empty(), "the same person");
    let mut other = shifted(250.0);
    // One keypoint of the other lies where the person's does.
    let jumped = (0..own.len()).find(|&k| own[k].is_some()).unwrap();
    other[jumped] = own[jumped];
    let found = density(other);
    assert!(found[1].is_empty() && found[2].is_empty());
    let confidence = own[jumped].unwrap().confidence;
    let variance = 2.0 * 81.0 * 0.7 / confidence;
    assert!((found[0][jumped] - 1.0 / (std::f64::consts::TAU * variance)).abs() < 1e-12, "{}", found[0][jumped]);
    assert!(found[0].iter().enumerate().all(|(k, density)| k == jumped || *density < 1e-20));

    // With the keypoint alone, the density at a pose is the formula.
    let mut alone: Detections = vec![vec![None; own.len()]; 3];
    alone[0][jumped] = own[jumped];
    let bound = |elsewhere: &[Vec<f64>]| {
        scene.model.bind(KeypointFrame { detections: &alone, elsewhere, predicted: &scene.points })
    };
    let variance = scene.model.variance_px2(
        0,
        &Detection::new([0.0; 2], confidence),
        1,
        &scene.points[3 * jumped..3 * jumped + 3],
    );
    let expected = |pi: f64, density: f64, core: f64| {
        ((1.0 - 0.02 - pi) * core / (std::f64::consts::TAU * variance) + 0.02 / 8e5 + pi * density).ln()
    };
    let away = moved(&scene.pose, 3.0);
    let mut at = vec![0.0; scene.points.len()];
    point_positions(&scene.model.plan, Isa::baseline(), &away, &mut at);
    let view = &scene.model.views[0];
    let core = match view.camera.project([at[3 * jumped], at[3 * jumped + 1], at[3 * jumped + 2]]).pixel() {
        Some([u, v]) => {
            let [x, y] = own[jumped].unwrap().pixel;
            (-0.5 * ((x - 2.0 - u).powi(2) + (y + 1.0 - v).powi(2)) / variance).exp()
        }
        None => 0.0,
    };
    for (elsewhere, pi, density) in [(vec![], 0.0, 0.0), (found.clone(), 0.01, found[0][jumped])] {
        let value = bound(&elsewhere).log_density(&away);
        let formula = expected(pi, density, core);
        assert!((value - formula).abs() < 1e-9, "{value} for {formula}");
    }
    let at = KeypointFrame { detections: &alone, elsewhere: &found, predicted: &scene.points };
    let probability = scene.model.elsewhere(&at);
    assert_eq!(probability[0].len(), 1);
    assert!(probability[0][0] > 0.0 && probability[0][0] < 0.05, "{probability:?}");
}
