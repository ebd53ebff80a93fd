//! The posterior of everything that is constant over a recording.
//!
//! That is cameras, the subject's lengths, places of keypoints, biases of detectors, lags of clocks.
//!
//! Poses of some frames and g are found together by Gauss–Newton. Frame after frame a random walk links the poses and a filter carries beside them how its estimates answer to g ([`Lasting`]), which eliminates the poses from the block-tridiagonal
//! matrix with a border. What remains are Λ and λ of g alone, from which g and the scales of its prior are drawn ([`lasting_scales`]). Each round:
//!
//! 1. normal equations of all frames at their poses and g ([`linearised`]); outliers count little
//! 2. forward: filter and Λ, λ
//! 3. mean of g given Λ and λ
//! 4. backward: smoothed poses at that g; scatter of each camera, and how long errors last
//!
//! Errors of a detector last some frames, so frames that follow each other are not worth as many independent ones. With the correlation 0.93 φ of a residual with that of the next frame looked at, φ = exp(−Δt/τ), they are worth
//! the share 1 / (1 + 2 · 0.93 φ/(1 − φ)); a frame's information is multiplied by it. For constants that is exact in long recordings. τ has a prior around 0.1 s.
//! Nor are recordings of one person independent in which they do the same: where n of them follow each other, errors of alike frames correlate by some ρ, and the information is divided by 1 + (n − 1) ρ, so that a recording that is shown twice tells nothing new.

mod stored;

use super::error_persistence::{Residuals, persistence_s};
use super::lasting_errors::LASTING_SHARE;
use super::lasting_prior::{expected_places, prior};
use super::lasting_sources::point_sources;
use super::level_points::{LevelPoints, level_points, levelled, tied};
use super::looked_frames::{Looked, looked_at, middle, observed_by};
use super::measured_mistakes;
use super::mirrored_places::{MirroredPair, exchange, exchange_prior, in_parts, pairs, prior_of_parts};
use super::motion_noise::{default_sd, initial_sd};
use super::scatter::like_the_others;
use super::shared_cameras::{CameraInformation, SharedCameras};
use super::stored::Setup;
use crate::Error;
use sinew_body::KinematicTree;
use sinew_body::point_derivatives::{Neighbours, PointDerivatives, length_names};
use sinew_core::estimators::median;
use sinew_core::random::Stage;
use sinew_core::transition::Moments;
use sinew_dynamics::lasting::{FrameInformation, Lasting, informed};
use sinew_dynamics::lasting_scales::{
    HeldDraws, LastingData, LastingDraws, LastingPrior, SweepSchedule, draws_given, mean_at,
};
use sinew_dynamics::shared_numbers::said_of;
use sinew_dynamics::smoother::Smoother;
use sinew_input::source::FrameSource;
use sinew_observe::cameras::camera_error::{NUMBERS, PRINCIPAL_POINT, with_error};
use sinew_observe::cameras::offsets::{self, CameraNoise, Sighted, robust_sigma};
use sinew_observe::clocks::on_time::on_time;
use sinew_observe::clocks::point_velocity::{REACH_S, body_velocities, share_of_motion, velocity_sd};
use sinew_observe::lasting::lasting_errors::{
    LastingErrors, LinearisedFrame, linearised, linearised_detections, pixels_per_metre,
};
use sinew_observe::{Camera, Detection, KeypointFrame, KeypointModel, View};
use std::ops::Range;

/// Rounds of poses and g.
const ROUNDS: usize = 3;
/// Steps between poses over the steps of the recording's motion. How large the steps of someone's angles are is not known; taken as known, they would say how long limbs are: longer limbs turn less for the same keypoints. Steps this wide say next to nothing of it, and still lead from frame to frame: in 160 rigs forearms come out 3.8 ± 1.2 mm too long, with half of it 5.1 ± 1.2 mm, with twice of it 3.1 ± 1.2 mm, but then one rig's spine is far off.
const UNTIED: f64 = 10.0;
/// Draws to find the mean in a round.
const ROUND: SweepSchedule = SweepSchedule { draws: 48, burn_in: 16, apart: 1 };
/// A precision that says nothing.
const FLAT: f64 = 1e10;
/// Share of a camera's residuals that is left, at least.
const LEAST_LEFT: f64 = 0.1;

/// Finds what is constant in the frames of `numbers`, moves cameras, lengths and scatter of the set-up to it, and stores draws of it.
///
/// # Errors
/// Errors of the source; a posterior that does not exist.
pub fn measure_lasting(
    setup: &mut Setup,
    source: &mut dyn FrameSource,
    numbers: Range<u64>,
    fps: f64,
    seed: u64,
) -> Result<(), Error> {
    measure_lasting_with(setup, source, numbers, (fps, seed), None, &mut || Ok::<_, Error>(())).map(drop)
}

/// As [`measure_lasting`], with cameras that other recordings share, if these are the cameras of the source; gives what its own frames say of them. `proceed` is called every few tenths of a second and may stop.
///
/// # Errors
/// As [`measure_lasting`]; errors of `proceed`.
pub fn measure_lasting_with<E: From<Error>>(
    setup: &mut Setup,
    source: &mut dyn FrameSource,
    numbers: Range<u64>,
    (fps, seed): (f64, u64),
    shared_cameras: Option<&SharedCameras>,
    proceed: &mut dyn FnMut() -> Result<(), E>,
) -> Result<CameraInformation, E> {
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let tree = setup.tree();
    let shared: Vec<(usize, usize)> =
        tree.points().iter().enumerate().filter_map(|(p, point)| Some((p, layout.index(&point.name)?))).collect();
    let looked = looked_at(setup, source, &tree, &shared, numbers, fps)?;
    let mut fit = Fit::new(setup, &tree, &cameras, &shared, looked, fps);
    let names: Vec<String> = cameras.iter().map(|camera| camera.name.clone()).collect();
    fit.held = shared_cameras.filter(|shared| shared.cameras == names).map(|shared| shared.held.clone());
    fit.at_errors(&cameras);
    for round in 0..ROUNDS {
        proceed()?;
        let pass = fit.pass()?;
        let found = fit.drawn(&pass.data, ROUND, Stage::new(seed, "lasting rounds").round(round))?;
        fit.settle(&pass.data, &found)?;
        fit.follow(&pass)?;
        fit.at_errors(&cameras);
        fit.mistakes();
        if cameras.len() > 1 {
            fit.scatter(&pass);
        }
    }
    proceed()?;
    let pass = fit.pass()?;
    let found = fit.drawn(&pass.data, SweepSchedule::default(), Stage::new(seed, "lasting"))?;
    let poses: Vec<_> = fit.frames.iter().zip(&pass.responses).map(|(frame, j)| (&frame.pose[..], &j[..])).collect();
    let keypoint_at = |name: &str| fit.points.iter().position(|own| own == name && setup.follows_detectors(name));
    let build = |sizes: &_| setup.body.tree(sizes);
    let source = point_sources(build, &setup.proportions, &fit.errors, &found, &poses, keypoint_at);
    let scales = fit.median_scales(&found);
    let said =
        said_of(&fit.in_parts(&pass.data), &fit.prior, &scales, &(0..NUMBERS * cameras.len())).map_err(Error::from)?;
    fit.store(setup, found, source);
    let LastingData { information, pull } = said;
    Ok(CameraInformation { cameras: names, world_up: setup.world_up.clone(), information, pull })
}

fn median_scale(found: &LastingDraws, scale: usize) -> f64 {
    median(&mut found.scales.iter().map(|scales| scales[scale]).collect::<Vec<_>>())
}

/// Result of one pass over the frames.
struct Pass {
    /// g at which it was made.
    g: Vec<f64>,
    /// Number of independent frames that each frame counted for, at most 1.
    worth: f64,
    data: LastingData,
    filtered: Vec<Moments>,
    /// Derivative of each filtered mean by g, d × p (degrees of freedom × constants), row after row.
    responses: Vec<Vec<f64>>,
    /// What was linearised, without G.
    frames: Vec<LinearisedFrame>,
}

/// State of the rounds: poses of the frames looked at, and the constants g.
struct Fit {
    errors: LastingErrors,
    /// Body of the lengths that g counts from.
    unmoved: Neighbours,
    /// Body at g.
    body: Neighbours,
    model: KeypointModel,
    prior: LastingPrior,
    /// Draws of cameras that are known from elsewhere, too.
    held: Option<HeldDraws>,
    level: Vec<LevelPoints>,
    pairs: Vec<MirroredPair>,
    points: Vec<String>,
    middle: [f64; 3],
    scales: Vec<f64>,
    frames: Vec<Looked>,
    initial: Vec<f64>,
    /// Standard deviations of a step from a frame looked at to the next.
    steps: Vec<Vec<f64>>,
    g: Vec<f64>,
    /// Mean and standard deviation of each number's prior, at the scales last drawn.
    expected: Vec<[f64; 2]>,
    /// Usual time from a frame looked at to the next, seconds.
    seconds_apart: f64,
    /// Time constant τ of persistent errors, seconds.
    persistence_s: f64,
    /// Number of independent frames that each frame counts for, at most 1.
    worth: f64,
    /// Frames a second, and usual velocities of the pose over the time in which they are looked at.
    fps: f64,
    usual_velocity: Vec<f64>,
}

impl Fit {
    fn new(
        setup: &Setup,
        tree: &KinematicTree,
        cameras: &[Camera],
        shared: &[(usize, usize)],
        frames: Vec<Looked>,
        fps: f64,
    ) -> Self {
        let indices: Vec<usize> = shared.iter().map(|(p, _)| *p).collect();
        let points: Vec<String> = indices.iter().map(|&p| tree.points()[p].name.clone()).collect();
        let unmoved = Neighbours::new(|sizes| setup.body.tree(sizes), &setup.proportions, &indices);
        let expected = expected_places(|sizes| setup.body.tree(sizes), &points, &setup.proportions);
        let level = if setup.body.is_measured() { level_points(&points) } else { vec![] };
        let middle = middle(&unmoved, &frames, &setup.start_pose);
        let errors = LastingErrors { cameras: cameras.len(), lengths: length_names().len(), points: points.len() };
        let mut g = vec![0.0; errors.count()];
        for (c, (camera, known)) in cameras.iter().zip(&setup.camera).enumerate() {
            let first = errors.camera(c).start + PRINCIPAL_POINT;
            g[first] = known.offset_px[0] / camera.intrinsics.fx;
            g[first + 1] = known.offset_px[1] / camera.intrinsics.fy;
        }
        let motion = setup.motion_sd.clone().unwrap_or_else(|| default_sd(tree));
        let mut seconds: Vec<f64> =
            frames.windows(2).map(|pair| (pair[1].number - pair[0].number) as f64 / fps).collect();
        let step = |seconds: &f64| motion.iter().map(|sd| UNTIED * sd * seconds.sqrt()).collect();
        let pairs = pairs(&errors, &points);
        let prior = prior(&errors, &points, &setup.proportions, &expected, tied(&level), fps.recip());
        Self {
            prior: prior_of_parts(&pairs, prior),
            held: None,
            level,
            pairs,
            model: observed_by(setup, tree, cameras, &indices),
            scales: cameras.iter().map(|camera| pixels_per_metre(camera, middle)).collect(),
            steps: seconds.iter().map(step).collect(),
            initial: initial_sd(tree).iter().map(|sd| (10.0 * sd).powi(2)).collect(),
            errors,
            body: unmoved.clone(),
            unmoved,
            points,
            middle,
            frames,
            expected: vec![[0.0, f64::INFINITY]; g.len()],
            g,
            seconds_apart: median(&mut seconds),
            persistence_s: 0.0,
            worth: 1.0,
            fps,
            usual_velocity: motion.iter().map(|sd| sd / (2.0 * REACH_S).sqrt()).collect(),
        }
    }

    /// Body, cameras, biases and detections at g.
    fn at_errors(&mut self, cameras: &[Camera]) {
        self.body = self.unmoved.reshaped(&self.g[self.errors.lengths()], &self.g[self.errors.places()]);
        for (c, (view, camera)) in self.model.views.iter_mut().zip(cameras).enumerate() {
            let mut error = [0.0; NUMBERS];
            error.copy_from_slice(&self.g[self.errors.camera(c)]);
            view.camera = with_error(camera, &error);
            let bias = |point| {
                let first = self.errors.bias(c, point).start;
                [first, first + 1].map(|place| self.scales[c] * self.g[place])
            };
            view.bias_px = (0..self.errors.points).map(bias).collect();
        }
        self.on_time();
    }

    /// How the body moves in each frame, and what cameras that are not late would have seen.
    fn on_time(&mut self) {
        let sd = velocity_sd(self.position_sd_m(), self.fps);
        let bodies: Vec<_> = self.frames.iter().map(|frame| self.body.at(&frame.pose)).collect();
        let move_in = |(frame, body): (&Looked, &PointDerivatives)| {
            body_velocities(&body.by_pose, &frame.seen_velocities, &self.usual_velocity, sd)
        };
        let found: Vec<_> = self.frames.iter().zip(&bodies).map(move_in).collect();
        let motion = share_of_motion(&found);
        let lags = &self.g[self.errors.lags()];
        for ((Looked { detections, velocities, on_time: shown, .. }, body), found) in
            self.frames.iter_mut().zip(&bodies).zip(found)
        {
            *velocities = found.velocities.into_iter().map(|v| v.map(|x| motion * x)).collect();
            let views = self.model.views.iter().zip(&*detections).zip(lags);
            let seen = |((view, seen), lag): ((&View, &Vec<_>), &f64)| {
                on_time(&view.camera, seen, &body.positions, velocities, *lag)
            };
            *shown = views.map(seen).collect();
        }
    }

    /// Scatter of a keypoint in space, metres: that of its detections in all cameras.
    fn position_sd_m(&self) -> f64 {
        let views = self.model.views.iter().zip(&self.scales);
        views.map(|(view, scale)| (scale / view.sigma_px).powi(2)).sum::<f64>().sqrt().recip()
    }

    fn linearised(&self, frame: &Looked) -> LinearisedFrame {
        let body = self.body.at(&frame.pose);
        let found = linearised_detections(&self.model, &frame.on_time, &frame.elsewhere, &body);
        linearised(&found, &self.errors, &self.scales, (&body, &frame.velocities), self.model.plan.dof())
    }

    /// How often cameras take something for something else.
    fn mistakes(&mut self) {
        let points: Vec<Vec<f64>> = self.frames.iter().map(|frame| self.body.at(&frame.pose).positions).collect();
        let frames = self.frames.iter().zip(&points).map(|(Looked { on_time, elsewhere, .. }, predicted)| {
            KeypointFrame { detections: on_time, elsewhere, predicted }
        });
        self.model.mistakes = measured_mistakes::measured(&self.model, frames);
    }

    /// One pass over the frames at g: what they say of g, its absolute value, and what a frame is worth.
    fn pass(&mut self) -> Result<Pass, Error> {
        let (d, p) = (self.model.plan.dof(), self.errors.count());
        let mut flat = vec![0.0; p * p];
        (0..p).for_each(|i| flat[i * p + i] = FLAT);
        let mut lasting = Lasting::new(d, p, &flat)?;
        let mut filtered: Vec<Moments> = vec![];
        let (mut seen_in, mut responses): (Vec<LinearisedFrame>, Vec<Vec<f64>>) = (vec![], vec![]);
        for (index, frame) in self.frames.iter().enumerate() {
            let seen = self.linearised(frame);
            let predicted = self.predicted(index, frame, filtered.last());
            let away: Vec<f64> = predicted.mean.iter().zip(&frame.pose).map(|(m, x)| m - x).collect();
            let less = |pull: &[f64], rows: &[f64], by_row: bool| -> Vec<f64> {
                let width = pull.len();
                let moved = |i: usize| {
                    (0..d).map(|j| rows[if by_row { i * d + j } else { j * width + i }] * away[j]).sum::<f64>()
                };
                pull.iter().enumerate().map(|(i, pull)| self.worth * (pull - moved(i))).collect()
            };
            let times = |values: &[f64]| values.iter().map(|x| self.worth * x).collect::<Vec<f64>>();
            let weighted =
                |row: &[(usize, f64)]| row.iter().map(|(place, by)| (*place, self.worth.sqrt() * by)).collect();
            let said = FrameInformation {
                state: times(&seen.pose),
                between: times(&seen.between),
                lasting: seen.lasting.iter().map(|row| weighted(row)).collect(),
                state_pull: less(&seen.pose_pull, &seen.pose, true),
                lasting_pull: less(&seen.lasting_pull, &seen.between, false),
            };
            let moments = informed(&predicted, &said.state, &said.state_pull)?;
            lasting.update(&moments.covariance, &said)?;
            filtered.push(moments);
            responses.push(lasting.response());
            seen_in.push(LinearisedFrame { lasting: vec![], between: vec![], ..seen });
        }
        let information = lasting.information();
        let absolute: Vec<f64> =
            information.chunks_exact(p).map(|row| row.iter().zip(&self.g).map(|(a, g)| a * g).sum()).collect();
        let pull = lasting.pull().iter().zip(absolute).map(|(pull, at)| pull + at).collect();
        let worth = self.worth;
        self.measure_persistence(&seen_in);
        Ok(Pass {
            g: self.g.clone(),
            worth,
            data: LastingData { information, pull },
            filtered,
            responses,
            frames: seen_in,
        })
    }

    /// How long errors persist, and what a frame is worth.
    fn measure_persistence(&mut self, frames: &[LinearisedFrame]) {
        if frames.len() < 2 {
            return;
        }
        let residuals = Residuals::new(frames, self.errors.cameras, self.errors.points);
        let stretches: Vec<usize> = self.frames.iter().map(|frame| frame.stretch).collect();
        let (found, pairs) = residuals.successive_correlation(&stretches);
        self.persistence_s = persistence_s(found, self.worth * pairs, self.seconds_apart);
        let phi = (-self.seconds_apart / self.persistence_s).exp();
        let bodies: Vec<Vec<f64>> = self.frames.iter().map(|frame| self.body.at(&frame.pose).positions).collect();
        let again = residuals.redundancy(&stretches, &bodies);
        self.worth = 1.0 / (again * (1.0 + 2.0 * LASTING_SHARE * phi / (1.0 - phi)));
    }

    fn predicted(&self, index: usize, frame: &Looked, former: Option<&Moments>) -> Moments {
        let d = frame.pose.len();
        let (mean, mut covariance, added) = match former {
            None => (frame.pose.clone(), vec![0.0; d * d], self.initial.clone()),
            Some(former) => {
                let step = self.steps[index - 1].iter().map(|sd| sd * sd).collect();
                (former.mean.clone(), former.covariance.clone(), step)
            }
        };
        added.iter().enumerate().for_each(|(j, variance)| covariance[j * d + j] += variance);
        Moments { mean, covariance }
    }

    /// Poses that know the frames after them, at the g that was found since the pass.
    fn follow(&mut self, pass: &Pass) -> Result<(), Error> {
        let change: Vec<f64> = self.g.iter().zip(&pass.g).map(|(new, old)| new - old).collect();
        let answer = |response: &[f64]| -> Vec<f64> {
            response.chunks_exact(change.len()).map(|row| row.iter().zip(&change).map(|(j, g)| j * g).sum()).collect()
        };
        let mut next: Option<(Moments, Vec<f64>)> = None;
        let mut taken = 0.0;
        for (index, (own, response)) in pass.filtered.iter().zip(&pass.responses).enumerate().rev() {
            let moved = answer(response);
            let (smoothed, moved) = match &next {
                None => (own.clone(), moved),
                Some((after, moved_after)) => {
                    let smoother = Smoother::random_walk(&self.steps[index]);
                    (smoother.step(own, after)?, smoother.changes(own, &moved, moved_after)?)
                }
            };
            taken += pass.worth * trace(&pass.frames[index].pose, &smoothed.covariance);
            self.frames[index].pose = smoothed.mean.iter().zip(&moved).map(|(x, by)| x + by).collect();
            next = Some((smoothed, moved));
        }
        self.model_error(pass, taken);
        Ok(())
    }

    /// How much of a number of g the data tell, from 0 to 1.
    fn share_from_data(&self, pass: &Pass, place: usize) -> f64 {
        let said = pass.data.information[place * self.errors.count() + place];
        said / (said + self.expected[place][1].powi(-2))
    }

    /// The model error: what residuals about the body have beyond the noise of the detectors, once each bias is gone. Poses took `taken` of them.
    fn model_error(&mut self, pass: &Pass, taken: f64) {
        let all = || pass.frames.iter().flat_map(|frame| &frame.residuals);
        let count = 2.0 * all().count() as f64;
        let taken_by_errors: f64 = (0..self.errors.count()).map(|place| self.share_from_data(pass, place)).sum();
        let left =
            (1.0 - taken / count).max(LEAST_LEFT) * (1.0 - taken_by_errors / (pass.worth * count)).max(LEAST_LEFT);
        let scaled = all().flat_map(|r| r.residual_px.map(|px| px / r.noise_px2.sqrt()));
        let beyond = robust_sigma(scaled).powi(2) / left - 1.0;
        let by_model = all().map(|r| r.by_model_error / r.noise_px2).sum::<f64>() / (0.5 * count);
        let model_error_m = (beyond / by_model).max(0.0).sqrt();
        if model_error_m.is_finite() {
            self.model.model_error_m = model_error_m;
        }
    }

    /// Scatter of each camera, once its bias for each point is gone: that of [`offsets`], with the share that biases took. Lags are not in it: draws answer for them.
    fn scatter(&mut self, pass: &Pass) {
        let without_bias = |(view, seen): (&View, &Vec<Option<Detection>>)| {
            let shifted = |(point, seen): (usize, &Option<Detection>)| {
                let ([du, dv], seen) = (view.bias_of(point), (*seen)?);
                Some(Detection { pixel: [seen.pixel[0] - du, seen.pixel[1] - dv], ..seen })
            };
            seen.iter().enumerate().map(shifted).collect::<Vec<_>>()
        };
        let views = &self.model.views;
        let sighted: Vec<Sighted> =
            self.frames.iter().map(|frame| views.iter().zip(&frame.on_time).map(without_bias).collect()).collect();
        let cameras: Vec<Camera> = views.iter().map(|view| view.camera.clone()).collect();
        let config = offsets::Config { no_offsets: true, ..offsets::Config::default() };
        let noise = offsets::estimate(&cameras, &sighted, &config);
        let own = |(c, (noise, scale)): (usize, (&CameraNoise, &f64))| {
            let biases = (0..self.errors.points).flat_map(|point| self.errors.bias(c, point));
            let taken: f64 = biases.map(|place| self.share_from_data(pass, place)).sum();
            let left = (1.0 - taken / (self.worth * noise.residuals as f64 * 2.0)).max(LEAST_LEFT);
            noise.sigma_px / left.sqrt() / scale
        };
        let own: Vec<f64> = noise.iter().zip(&self.scales).enumerate().map(own).collect();
        for ((view, scatter_m), scale) in self.model.views.iter_mut().zip(like_the_others(&own)).zip(&self.scales) {
            if scatter_m.is_finite() {
                view.sigma_px = scale * scatter_m;
            }
        }
    }

    /// Puts g to its mean at the medians of its drawn scales: where cameras tell little of their scale, the mean of a few draws may be far off, and the next round linearises there.
    fn settle(&mut self, data: &LastingData, found: &LastingDraws) -> Result<(), Error> {
        self.g = mean_at(&self.in_parts(data), &self.prior, &self.median_scales(found), self.held.as_ref())?;
        exchange(&self.pairs, &mut self.g);
        Ok(())
    }

    fn median_scales(&self, found: &LastingDraws) -> Vec<f64> {
        (0..self.prior.scales.len()).map(|scale| median_scale(found, scale)).collect()
    }

    /// What the data say, with what is level, of the numbers of the prior: parts of pairs in place of their numbers.
    fn in_parts(&self, data: &LastingData) -> LastingData {
        in_parts(&self.pairs, levelled(data, &self.errors, &self.unmoved, &self.level))
    }

    /// Draws g, and keeps its mean and the sizes of its prior.
    fn drawn(&mut self, data: &LastingData, schedule: SweepSchedule, stage: Stage) -> Result<LastingDraws, Error> {
        let mut found = draws_given(&self.in_parts(data), &self.prior, schedule, stage, self.held.as_ref())?;
        found.errors.iter_mut().chain([&mut found.mean]).for_each(|g| exchange(&self.pairs, g));
        for cluster in &self.prior.clusters {
            let size = cluster.scale.map_or(1.0, |scale| median_scale(&found, scale));
            cluster.numbers.iter().for_each(|(place, mean, unit)| self.expected[*place] = [*mean, unit * size]);
        }
        exchange_prior(&self.pairs, &mut self.expected);
        self.g.clone_from(&found.mean);
        Ok(found)
    }
}

/// Trace of the product of two symmetric matrices.
fn trace(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
