//! A rig that is drawn from the set-up's prior, and what its cameras see.
//!
//! 1. g, what lasts, and its scales come from [`lasting_prior::prior`] itself, with one camera more than are used; lengths of the body are part of it.
//!    Soles and eyes are level: of normal numbers that are known to be equal, each is as their mean was.
//! 2. Poses begin at a standing one, knees and elbows bent, with normal deviations and walk at random, as the set-up and the tracker assume.
//! 3. Keypoints are the body's points moved by their places on their links. Cameras show them as they are, where they were a lag before, with their biases and white noise; calibrated they are without errors.
//!    A point was there on a straight line, along the frames around. The walk is the body's at the mean of the used cameras' clocks: of a random walk, other times have other velocities, and only those there can be seen.

use sinew::body::point_derivatives::{Neighbours, length_names, lengthened, lengths};
use sinew::body::standard::{STANDING_HEIGHT_M, h32};
use sinew::body::{Joint, KinematicTree, Proportions};
use sinew::core::random::Stage;
use sinew::dynamics::lasting_scales::LastingPrior;
use sinew::formats::calib_toml;
use sinew::formats::openpose::Keypoint;
use sinew::input::in_memory::InMemory;
use sinew::observe::Camera;
use sinew::observe::cameras::camera_error::with_error;
use sinew::observe::clocks::point_velocity::{reach, velocity};
use sinew::observe::lasting::lasting_errors::{LastingErrors, pixels_per_metre};
use sinew::setup::level_points::{self, LevelPoints};
use sinew::setup::{MeasuredErrors, Setup, lasting_prior, mirrored_places, motion_noise};
use sinew_body::points::Trajectories;
use sinew_simulate::draws::{normals, uniforms};
use sinew_simulate::recording::{body_25b, keypoint_files};
use sinew_simulate::ring::{Ring, around};
use std::error::Error;
use std::ops::Range;
use std::path::Path;

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

/// Cameras that are used; one more is left out.
pub const USED: usize = 4;
/// Frames of a rig.
pub const FRAMES: usize = 50;
/// Frames a second.
pub const RATE_HZ: f64 = 30.0;
/// Noise of a detection per axis, pixels.
const SIGMA_PX: f64 = 3.0;
/// Seconds from a frame to the next.
const FRAME_S: f64 = 1.0 / RATE_HZ;
/// Standard deviation of each angle of the first pose, radians.
const START: f64 = 0.3;
/// Bends about which the hinges begin, radians: a limb that is bent the other way and turned by half a turn shows the same keypoints.
const BENDS: [(&str, f64); 4] =
    [("l_forearm.rx", 1.0), ("r_forearm.rx", 1.0), ("l_shin.rx", -1.0), ("r_shin.rx", -1.0)];
/// Steps of the poses over the steps of brisk walking.
const MOTION: f64 = 0.4;
/// Share of the image's height that the person spans: small enough for poses that wander.
const SPAN: f64 = 0.45;

/// A rig, a person and what lasts.
pub struct Rig {
    /// As calibrated; the last one is left out.
    pub cameras: Vec<Camera>,
    /// Names of the keypoints.
    pub points: Vec<String>,
    /// Where each number of `g` stands.
    pub errors: LastingErrors,
    /// What lasts.
    pub g: Vec<f64>,
    /// Scales of its prior.
    pub scales: Vec<f64>,
    /// Sizes of the person.
    pub proportions: Proportions,
    /// Poses at the times of the frames.
    pub states: Vec<Vec<f64>>,
    /// Where each camera shows each keypoint in each frame, without bias and noise.
    pub pixels: Vec<Vec<Vec<Option<[f64; 2]>>>>,
    /// What the used cameras' detectors find: of each camera and frame the keypoints of the layout.
    seen: Vec<Vec<Vec<Option<Keypoint>>>>,
}

impl Rig {
    /// The rig of a seed.
    ///
    /// # Errors
    /// Cameras that cannot stand around the person.
    pub fn drawn(seed: u64) -> Outcome<Self> {
        Self::with_keypoints_aside(seed, 1.0)
    }

    /// The rig of a seed whose detectors mean the joints, as in demos: no keypoint lies aside, and none has a bias.
    ///
    /// # Errors
    /// Cameras that cannot stand around the person.
    pub fn at_joints(seed: u64) -> Outcome<Self> {
        Self::with_keypoints_aside(seed, 0.0)
    }

    /// The rig of a seed, places and biases of its keypoints times a factor.
    fn with_keypoints_aside(seed: u64, aside: f64) -> Outcome<Self> {
        let [lasting, poses, noise] = Stage::new(seed, "rig").split(["lasting", "poses", "noise"]);
        let layout = body_25b();
        let usual = h32(&Proportions::default());
        let indices: Vec<usize> =
            (0..usual.points().len()).filter(|p| layout.index(&usual.points()[*p].name).is_some()).collect();
        let points: Vec<String> = indices.iter().map(|&p| usual.points()[p].name.clone()).collect();
        let errors = LastingErrors { cameras: USED + 1, lengths: length_names().len(), points: points.len() };
        let places = vec![[0.0; 3]; points.len()];
        let level = level_points::level_points(&points);
        let prior = lasting_prior::prior(
            &errors,
            &points,
            &Proportions::default(),
            &places,
            level_points::tied(&level),
            FRAME_S,
        );
        let pairs = mirrored_places::pairs(&errors, &points);
        let (mut g, scales) = drawn(&mirrored_places::prior_of_parts(&pairs, prior), lasting);
        mirrored_places::exchange(&pairs, &mut g);
        for LevelPoints { points, axis } in level {
            let places: Vec<usize> = points.iter().map(|&point| errors.place(point).start + axis).collect();
            let mean = places.iter().map(|&place| g[place]).sum::<f64>() / places.len() as f64;
            places.into_iter().for_each(|place| g[place] = mean);
        }
        for places in [errors.places(), errors.biases()] {
            g[places].iter_mut().for_each(|x| *x *= aside);
        }
        let proportions = lengthened(&Proportions::default(), &g[errors.lengths()]);
        let shown = walk(&usual, poses);
        let late = errors.lags().take(USED).map(|place| g[place]).sum::<f64>() / USED as f64;
        let longer = vec![0.0; errors.lengths];
        let body = Neighbours::new(h32, &proportions, &indices).reshaped(&longer, &g[errors.places()]);
        let keypoints = |state: &Vec<f64>| -> Vec<[f64; 3]> {
            body.at(state).positions.chunks_exact(3).map(|x| [x[0], x[1], x[2]]).collect()
        };
        let truth = Trajectories { names: points.clone(), frames: shown.iter().map(keypoints).collect() };
        let cameras = around(&truth, &Ring { cameras: USED + 1, span: SPAN, ..Ring::default() })?;
        let states = at_time(&shown, late);
        let mut rig = Self { cameras, points, errors, g, scales, proportions, states, pixels: vec![], seen: vec![] };
        rig.film((&truth, late), &noise);
        Ok(rig)
    }

    /// The person's body; head and feet are where detectors see them.
    #[must_use]
    pub fn body(&self) -> KinematicTree {
        let body = h32(&self.proportions);
        let place = |name: &String| {
            let own = self.points.iter().position(|point| point == name && lasting_prior::stands_for_no_joint(name));
            own.map_or([0.0; 3], |own| [0, 1, 2].map(|axis: usize| self.g[self.errors.place(own).start + axis]))
        };
        let places: Vec<[f64; 3]> = body.points().iter().map(|point| place(&point.name)).collect();
        body.with_points_moved(&places)
    }

    /// How far the keypoints of both sides of that name lie from the joints that they are named after, root mean square, metres.
    #[must_use]
    pub fn aside(&self, name: &str) -> f64 {
        let own = |point: &usize| self.points[*point].ends_with(name);
        let places: Vec<usize> = (0..self.points.len()).filter(own).collect();
        let square: f64 = places.iter().flat_map(|&point| self.errors.place(point)).map(|k| self.g[k].powi(2)).sum();
        (square / places.len() as f64).sqrt()
    }

    /// Keypoints at the mean of the used cameras' clocks, which are some seconds late.
    fn film(&mut self, (truth, late): (&Trajectories, f64), noise: &Stage) {
        let layout = body_25b();
        let middle = middle(truth);
        let velocities: Vec<Vec<[f64; 3]>> =
            (0..truth.names.len()).map(|point| slopes(|frame| truth.frames[frame][point])).collect();
        for (index, camera) in self.cameras.iter().enumerate() {
            let error = std::array::from_fn(|k| self.g[self.errors.camera(index).start + k]);
            let (real, scale) = (with_error(camera, &error), pixels_per_metre(camera, middle));
            let lag = self.g[self.errors.lag(index)] - late;
            let shown_in = |f: usize| {
                let points = truth.frames[f].iter().enumerate();
                points.map(|(p, x)| real.project(before(*x, velocities[p][f], lag)).pixel()).collect()
            };
            let shown: Vec<Vec<Option<[f64; 2]>>> = (0..truth.frames.len()).map(shown_in).collect();
            let errors = normals(&noise.round(index), 0, 2 * truth.frames.len() * self.points.len());
            let found = |f: usize| {
                let mut frame = vec![None; layout.points.len()];
                for (p, name) in self.points.iter().enumerate() {
                    let (Some(place), Some(pixel)) = (layout.index(name), shown[f][p]) else { continue };
                    let bias = self.errors.bias(index, p).start;
                    let error = 2 * (f * self.points.len() + p);
                    let at = |axis: usize| pixel[axis] + scale * self.g[bias + axis] + SIGMA_PX * errors[error + axis];
                    frame[place] = Some(Keypoint { x: at(0), y: at(1), confidence: 1.0 });
                }
                frame
            };
            if index < USED {
                self.seen.push((0..truth.frames.len()).map(found).collect());
            }
            self.pixels.push(shown);
        }
    }

    /// What the used cameras' detectors find, as a source of frames.
    #[must_use]
    pub fn source(&self) -> InMemory {
        InMemory { cameras: self.cameras[..USED].to_vec(), layout: body_25b(), keypoints: self.seen.clone() }
    }

    /// Writes calibration and keypoints, and gives the flags that track them.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn write(&self, folder: &Path) -> Outcome<Vec<String>> {
        let (calibration, keypoints) = (folder.join("Calib.toml"), folder.join("keypoints"));
        let used: Vec<&str> = self.cameras[..USED].iter().map(|camera| camera.name.as_str()).collect();
        for name in &used {
            std::fs::create_dir_all(keypoints.join(format!("{name}_json")))?;
        }
        std::fs::write(&calibration, calib_toml::write(&self.cameras))?;
        for (name, text) in keypoint_files(&self.cameras[..USED], &self.seen) {
            std::fs::write(keypoints.join(name), text)?;
        }
        let shown = |path: &Path| path.display().to_string();
        let (calibration, keypoints, used) = (shown(&calibration), shown(&keypoints), used.join(","));
        let rate = RATE_HZ.to_string();
        let flags = ["--calibration", &calibration, "--keypoints", &keypoints, "--cameras", &used, "--fps", &rate];
        Ok(flags.map(str::to_owned).to_vec())
    }
}

/// What is true of the numbers of a set-up, in its order; lengths beyond its body's, places from where its body of the true lengths has the points: head and feet have sizes that are not among the numbers.
#[must_use]
pub fn truth(rig: &Rig, setup: &Setup, known: &MeasuredErrors) -> Vec<f64> {
    let (layout, mut truth) = (known.layout(), vec![f64::NAN; known.number.len()]);
    let mut put = |to: Range<usize>, from: &[f64]| truth[to].copy_from_slice(from);
    let longer: Vec<f64> =
        lengths(&rig.proportions).iter().zip(lengths(&setup.proportions)).map(|(own, found)| own - found).collect();
    put(layout.lengths(), &longer);
    let [own_body, body] = [h32(&rig.proportions), h32(&lengthened(&setup.proportions, &longer))];
    let point = |name: &String| rig.points.iter().position(|own| own == name);
    for (p, own) in known.points.iter().enumerate().filter_map(|(p, name)| Some((p, point(name)?))) {
        let offset = |body: &KinematicTree, axis: usize| {
            body.point_index(&known.points[p]).map_or(f64::NAN, |point| body.points()[point].offset[axis])
        };
        let places = &rig.g[rig.errors.place(own)];
        let place = [0, 1, 2].map(|axis: usize| places[axis] + offset(&own_body, axis) - offset(&body, axis));
        put(layout.place(p), &place);
        (0..USED).for_each(|c| put(layout.bias(c, p), &rig.g[rig.errors.bias(c, own)]));
    }
    (0..USED).for_each(|c| put(layout.camera(c), &rig.g[rig.errors.camera(c)]));
    (0..USED).for_each(|c| put(layout.lag(c)..layout.lag(c) + 1, &[rig.g[rig.errors.lag(c)]]));
    truth
}

/// What lasts and its scales, from their prior.
fn drawn(prior: &LastingPrior, stage: Stage) -> (Vec<f64>, Vec<f64>) {
    let [scales, weights, numbers] = stage.split(["scales", "weights", "numbers"]);
    let scales: Vec<f64> = prior
        .scales
        .iter()
        .zip(normals(&scales, 0, prior.scales.len()))
        .map(|(prior, deviation)| prior.median * (prior.log_sd * deviation).exp())
        .collect();
    let count = prior.clusters.iter().map(|cluster| cluster.numbers.len()).sum();
    let (weights, deviations) = (uniforms(&weights, 0, 2 * prior.clusters.len()), normals(&numbers, 0, count));
    let mut g = vec![0.0; count];
    for (cluster, uniform) in prior.clusters.iter().zip(weights.chunks_exact(2)) {
        // Gamma(2, 2).
        let heavy = -0.5 * uniform.iter().map(|u| (1.0 - u).ln()).sum::<f64>();
        let weight = if cluster.heavy_tails { heavy } else { 1.0 };
        let size = cluster.scale.map_or(1.0, |scale| scales[scale]) / weight.sqrt();
        for &(place, mean, unit) in &cluster.numbers {
            g[place] = mean + size * unit * deviations[place];
        }
    }
    (g, scales)
}

/// Poses that walk at random.
fn walk(body: &KinematicTree, stage: Stage) -> Vec<Vec<f64>> {
    let is_angle: Vec<bool> = body.joints().map(|(_, joint)| matches!(joint, Joint::Rotate(_))).collect();
    let start = normals(&stage, 0, body.dof());
    let mut pose: Vec<f64> = start.iter().zip(is_angle).map(|(x, own)| if own { START * x } else { 0.0 }).collect();
    pose[2] = STANDING_HEIGHT_M;
    for (place, name) in body.dof_names().iter().enumerate() {
        pose[place] += BENDS.iter().filter(|(hinge, _)| hinge == name).map(|(_, bend)| bend).sum::<f64>();
    }
    let sd = motion_noise::default_sd(body);
    let steps = normals(&stage, 1, body.dof() * FRAMES);
    let next = |step: &[f64]| {
        let own = pose.clone();
        for ((x, sd), step) in pose.iter_mut().zip(&sd).zip(step) {
            *x += MOTION * sd * step / RATE_HZ.sqrt();
        }
        own
    };
    steps.chunks_exact(body.dof()).map(next).collect()
}

/// Poses at the times of the frames, from what clocks show that are some seconds late.
fn at_time(shown: &[Vec<f64>], late: f64) -> Vec<Vec<f64>> {
    let own = |j: usize| slopes(|frame| [shown[frame][j], 0.0, 0.0]).into_iter().map(|[slope, ..]| slope).collect();
    let slopes: Vec<Vec<f64>> = (0..shown[0].len()).map(own).collect();
    let moved = |(frame, pose): (usize, &Vec<f64>)| {
        pose.iter().zip(&slopes).map(|(x, slopes)| x + late * slopes[frame]).collect()
    };
    shown.iter().enumerate().map(moved).collect()
}

/// Slopes in all frames, a second, over the frames around, as the set-up knows velocities.
fn slopes(of: impl Fn(usize) -> [f64; 3]) -> Vec<[f64; 3]> {
    let numbers: Vec<u64> = (0..FRAMES as u64).collect();
    let points: Vec<_> = (0..FRAMES).map(|frame| Some(of(frame))).collect();
    let near = reach(RATE_HZ);
    let whole = |frame: usize| frame.clamp(near as usize, FRAMES - 1 - near as usize);
    let slope = |frame| velocity(&points, &numbers, whole(frame), near).map_or([0.0; 3], |v| (v * RATE_HZ).into());
    (0..FRAMES).map(slope).collect()
}

/// Where a point was some seconds before.
fn before(at: [f64; 3], velocity: [f64; 3], seconds: f64) -> [f64; 3] {
    [0, 1, 2].map(|axis: usize| at[axis] - seconds * velocity[axis])
}

/// Mean of all points over all frames.
fn middle(truth: &Trajectories) -> [f64; 3] {
    let all = || truth.frames.iter().flatten();
    [0, 1, 2].map(|axis: usize| all().map(|x| x[axis]).sum::<f64>() / all().count() as f64)
}
