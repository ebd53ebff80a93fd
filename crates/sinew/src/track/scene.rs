//! One person in all views: association, layout to body, binding, residuals.

mod check;
mod clocks;
mod misfit;

use self::clocks::Clocks;
use super::error::TrackError;
use crate::Error;
use crate::config::settings::Settings;
use crate::methods::BoundKeypoints;
use crate::setup::measured_mistakes::mistakes;
use crate::setup::{self, CameraSetup, Setup};
use serde::{Deserialize, Serialize};
use sinew_body::half_turns::half_turns;
use sinew_body::motion_ranges::motion_ranges;
use sinew_body::{KinematicTree, Plan, point_positions};
use sinew_core::density::Lanes;
use sinew_core::estimators::median;
use sinew_dynamics::joint_limits::JointLimits;
use sinew_formats::Layout;
use sinew_observe::association::following::{Associated, Following, follow};
use sinew_observe::association::{self, Person};
use sinew_observe::cameras::offsets::{self, Sighted};
use sinew_observe::keypoints::bystanders::elsewhere;
use sinew_observe::{Camera, Detection, KeypointFrame, KeypointModel, Mistakes, Noise, ObservationModel, View};
use sinew_results::problem::{Problem, check_length};
use sinew_setup::body_limits::body_limits;
use sinew_setup::oddities::{OddPerson, Oddities, Watched};
use sinew_setup::predictive::{self, Doubt, Lengths, Origins, Predictive};
use std::sync::Arc;

/// Mean squared distance of the keypoints from a pose, in noise variances and at most [`WORST`] each, above which the pose is doubted. A right one has about 3.
const MISFIT: f64 = 6.0;
const WORST: f64 = 25.0;
/// Points that the body and the layout must share.
const LEAST_POINTS: usize = 4;

/// What a scene remembers from frame to frame.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneState {
    lengths: Vec<(usize, usize, f64)>,
    last_px: Vec<Vec<Option<[f64; 2]>>>,
    lost: usize,
    started: bool,
    velocities: Vec<f64>,
    /// Pixel and confidence: the last frame decides whether tracking begins again in the next.
    detections: Vec<Vec<Option<[f64; 4]>>>,
    oddities: Vec<Watched>,
    predictive: Predictive,
}

/// What a frame shows of the tracked person.
#[derive(Clone, Debug, Default)]
pub struct Shown {
    /// Detections: camera by camera, by point of the plan; what a late camera shows is put on time.
    pub detections: Vec<Vec<Option<Detection>>>,
    /// The same for the density of other people's keypoints ([`KeypointFrame::elsewhere`]); empty where a camera shows nobody else.
    pub elsewhere: Vec<Vec<f64>>,
    /// What is odd of the first person in each camera.
    odd: Vec<OddPerson>,
}

impl Shown {
    /// What was seen of the person ([`sinew_results::estimate::FrameEstimate::seen`]).
    pub(super) fn seen(&self) -> Vec<[f64; 3]> {
        let one = |d: &Option<Detection>| d.map_or([f64::NAN; 3], |d| [d.pixel[0], d.pixel[1], d.confidence]);
        self.detections.iter().flatten().map(one).collect()
    }

    /// Cameras that saw a keypoint of the person.
    pub(super) fn cameras(&self) -> usize {
        self.detections.iter().filter(|points| points.iter().any(Option::is_some)).count()
    }
}

/// The tracked person in the cameras.
pub struct Scene {
    model: KeypointModel,
    limits: Lanes<JointLimits>,
    /// Limbs that may be turned round where the method's prior has limits of joints.
    half_turns: Vec<[usize; 4]>,
    setup: Setup,
    cameras: Vec<Camera>,
    layout: Layout,
    /// For each point of the plan its index in the layout.
    keypoint: Vec<usize>,
    /// The same in the body.
    point: Vec<usize>,
    following: Following,
    association: association::Config,
    clocks: Clocks,
    /// What the current frame shows.
    shown: Shown,
    /// Correlation of errors from frame to frame that the intervals have been widened for.
    held_correlation: f64,
    oddities: Oddities,
    predictive: Predictive,
    origins: Origins,
    /// For each point of the layout the one of the other side, or itself.
    partners: Vec<usize>,
    /// For methods that take the body part by part, the part of each point of the plan, and how many parts there are.
    parts: Option<(Vec<usize>, usize)>,
    /// The likelihood of each part's points in the current frame.
    bound_parts: Vec<BoundKeypoints>,
}

/// How far a detection is from where it is expected.
fn distance_px(detection: Option<Detection>, expected: Option<[f64; 2]>) -> Option<f64> {
    let (Detection { pixel: [x, y], .. }, [u, v]) = (detection?, expected?);
    Some((x - u).hypot(y - v))
}

/// Points of the body that are keypoints: their index in the body and in the layout.
fn shared_points(tree: &KinematicTree, layout: &Layout) -> Result<Vec<(usize, usize)>, TrackError> {
    let points = tree.points().iter().enumerate();
    let shared: Vec<(usize, usize)> = points.filter_map(|(p, point)| Some((p, layout.index(&point.name)?))).collect();
    if shared.len() < LEAST_POINTS {
        return Err(TrackError::FewPoints { layout: layout.name.clone(), shared: shared.len(), least: LEAST_POINTS });
    }
    Ok(shared)
}

/// What the cameras see of some points of the body. A limb that is taken part by part is never exchanged as a whole.
fn keypoint_model(
    setup: &Setup,
    tree: &KinematicTree,
    cameras: &[Camera],
    points: &[usize],
    settings: &Settings,
) -> Result<KeypointModel, TrackError> {
    let names: Vec<String> = points.iter().map(|&p| tree.points()[p].name.clone()).collect();
    let unknown = |camera: &Camera| {
        let known = setup.camera.iter().map(|known| known.name.clone()).collect();
        TrackError::UnknownCamera { camera: camera.name.clone(), known }
    };
    let views = cameras.iter().map(|camera| setup.view(camera, &names).ok_or_else(|| unknown(camera)));
    let known = cameras.iter().filter_map(|camera| setup.camera.iter().find(|known| known.name == camera.name));
    let by_parts = settings.method.about().needs_parts;
    Ok(KeypointModel {
        plan: Arc::new(Plan::new(&tree.with_points_moved(&setup.detected_places(tree)), points)),
        views: views.collect::<Result<_, _>>()?,
        noise: settings.noise,
        model_error_m: setup.model_error_m,
        least_confidence: settings.least_confidence,
        mistakes: if by_parts { Mistakes::default() } else { mistakes(tree, points, known) },
        isa: settings.isa,
    })
}

/// Correlation of errors from a frame to the next that intervals are widened for.
fn held_correlation(setup: &Setup, fps: f64) -> f64 {
    let persistence = setup.lasting.as_ref().and_then(|lasting| lasting.persistence(1.0 / fps));
    persistence.map_or(0.0, |errors| errors.share * errors.correlation)
}

impl Scene {
    /// A scene before its first frame.
    ///
    /// # Errors
    /// A camera without set-up; a layout that shares no point with the body; a pose of another body.
    pub fn new(
        setup: &Setup,
        tree: &KinematicTree,
        cameras: &[Camera],
        layout: &Layout,
        settings: &Settings,
    ) -> Result<Self, Error> {
        let shared = shared_points(tree, layout)?;
        if setup.start_pose.len() != tree.dof() {
            return Err(TrackError::StartPose { found: setup.start_pose.len(), dof: tree.dof() }.into());
        }
        let points: Vec<usize> = shared.iter().map(|(p, _)| *p).collect();
        let parts = match settings.method.about().needs_parts {
            true => {
                let flesh = setup.flesh()?;
                let owner = |&p: &usize| flesh.owner(tree.points()[p].link);
                Some((points.iter().map(owner).collect(), flesh.solids().len()))
            }
            false => None,
        };
        let model = keypoint_model(setup, tree, cameras, &points, settings)?;
        let place = |k: usize| shared.iter().position(|(_, keypoint)| *keypoint == k);
        let pairs = layout.left_right_pairs();
        let mut partners: Vec<usize> = (0..layout.points.len()).collect();
        pairs.iter().for_each(|&(l, r)| partners.swap(l, r));
        let pairs = pairs.into_iter().filter_map(|(l, r)| Some((place(l)?, place(r)?))).collect();
        let is_limited = settings.method.limits_joints() && settings.latent_model.is_none();
        let watched = model.views.iter().map(|view| (view.camera.name.clone(), view.sigma_px));
        Ok(Self {
            predictive: Predictive::new(model.views.iter().map(|view| view.camera.name.clone()), settings.noise),
            origins: Origins {
                setup_is_given: settings.setup_is_given,
                person: settings.person,
                body_is_file: matches!(setup.body, setup::Body::File(_)),
                has_outlier_share: matches!(settings.noise, Noise::OutlierFloor { .. }),
            },
            oddities: Oddities::new(watched, pairs),
            held_correlation: held_correlation(setup, settings.fps),
            clocks: Clocks::new(setup, cameras, points.len(), settings.fps),
            partners,
            parts,
            bound_parts: vec![],
            shown: Shown { detections: vec![vec![None; points.len()]; cameras.len()], ..Shown::default() },
            keypoint: shared.iter().map(|(_, k)| *k).collect(),
            point: points,
            following: Following { person: setup.person, ..Following::default() },
            association: association::Config::default(),
            cameras: cameras.to_vec(),
            layout: layout.clone(),
            setup: setup.clone(),
            half_turns: if is_limited { half_turns(tree) } else { vec![] },
            limits: body_limits(motion_ranges(tree), settings.isa).map_err(TrackError::Motion)?,
            model,
        })
    }

    /// State in which tracking starts.
    #[must_use]
    pub fn start(&self) -> &[f64] {
        &self.setup.start_pose
    }

    /// Where the detectors see the keypoints in a state, three numbers each, metres.
    #[must_use]
    pub fn points(&self, state: &[f64]) -> Vec<f64> {
        let mut points = vec![0.0; 3 * self.model.plan.points()];
        point_positions(&self.model.plan, self.model.isa, state, &mut points);
        points
    }

    /// Pixels, bias included, at which each camera should see each point.
    fn expected(&self, points: &[f64]) -> Vec<Vec<Option<[f64; 2]>>> {
        let pixel = |view: &View, point: usize, p: &[f64]| {
            let ([u, v], [du, dv]) = (view.camera.project([p[0], p[1], p[2]]).pixel()?, view.bias_of(point));
            Some([u + du, v + dv])
        };
        let in_view =
            |view: &View| points.chunks_exact(3).enumerate().map(|(point, p)| pixel(view, point, p)).collect();
        self.model.views.iter().map(in_view).collect()
    }

    /// Finds the person in a frame and binds their keypoints; `others` are known to be someone else; `estimate` is the state that the tracker expects. Where they are found for the first time, or again after they were lost, or where `estimate` did not fit the frame before, also the pose that fits what is seen.
    pub fn observe(
        &mut self,
        people: &[Vec<Person>],
        others: &[Vec<Person>],
        estimate: &[f64],
    ) -> (BoundKeypoints, Option<Vec<f64>>) {
        let expected = self.expected_by_layout(estimate);
        let away = !self.following.started || self.following.lost >= self.association.lost_frames;
        let misfit = if away { f64::INFINITY } else { self.misfit(estimate) };
        let turned = !away && self.is_turned(estimate);
        let found = follow(&mut self.following, &self.cameras, people, Some(&expected), &self.association);
        for (out, seen) in self.shown.detections.iter_mut().zip(&found.people) {
            for (out, &k) in out.iter_mut().zip(&self.keypoint) {
                *out = seen.get(k).copied().flatten();
            }
        }
        if !self.clocks.are_right() {
            let points = self.points(estimate);
            self.clocks.correct(&mut self.shown.detections, &self.model.views, &points);
        }
        self.shown.elsewhere = elsewhere(&self.model, [people, others], &found, &self.keypoint, &self.association);
        self.shown.odd = self.odd_people(people, &found, &expected);
        if away && self.following.lengths.is_empty() {
            self.following.lengths = setup::limb_lengths(&self.cameras, &self.layout, &found.people, &self.association);
        }
        let may_restart = misfit > MISFIT && found.is_present();
        let straight = || self.straightened(found.people.clone(), estimate);
        let restart = if may_restart { self.better_pose(&straight(), estimate, away, misfit) } else { None };
        let restart = restart.or_else(|| (turned && self.is_turned(estimate)).then(|| self.as_named(&found.people))?);
        let may_turn = !away && found.is_present();
        let restart = restart.or_else(|| may_turn.then(|| self.turned_back(estimate))?);
        let predicted = self.points(restart.as_deref().unwrap_or(estimate));
        self.bind_parts(&predicted);
        (self.model.bind(self.frame(&predicted)), restart)
    }

    /// Takes in where the person is in the current frame, once it is tracked.
    pub fn note(&mut self, state: &[f64], restarted: bool) {
        if self.clocks.are_right() {
            return;
        }
        let points = self.points(state);
        self.clocks.note(&points, restarted);
    }

    /// The current frame, its points expected at these places.
    fn frame<'a>(&'a self, predicted: &'a [f64]) -> KeypointFrame<'a> {
        KeypointFrame { detections: &self.shown.detections, elsewhere: &self.shown.elsewhere, predicted }
    }

    /// Whether the state seems to have exchanged a pair of limbs, rather than the cameras.
    fn is_turned(&self, state: &[f64]) -> bool {
        self.model.is_turned(&self.frame(&self.points(state)))
    }

    /// The pose of the keypoints as they are named, if it fits them.
    fn as_named(&self, people: &Sighted) -> Option<Vec<f64>> {
        let pose = setup::pose_of(&self.setup, &self.cameras, &self.layout, people, None)?;
        (self.misfit(&pose) < MISFIT && !self.is_turned(&pose)).then_some(pose)
    }

    /// What the cameras see, by the layout, with the sides of limbs put right that are exchanged if the person is in a state.
    fn straightened(&self, mut people: Sighted, state: &[f64]) -> Sighted {
        let straight = self.model.straight(&self.frame(&self.points(state)));
        for (seen, straight) in people.iter_mut().zip(&straight) {
            for (&k, detection) in self.keypoint.iter().zip(straight) {
                seen.get_mut(k).into_iter().for_each(|place| *place = *detection);
            }
        }
        people
    }

    /// As [`Scene::expected`], by the keypoints of the layout.
    fn expected_by_layout(&self, state: &[f64]) -> Vec<Vec<Option<[f64; 2]>>> {
        let by_layout = |expected: &Vec<Option<[f64; 2]>>| {
            let mut all = vec![None; self.layout.points.len()];
            for (&k, e) in self.keypoint.iter().zip(expected) {
                all[k] = *e;
            }
            all
        };
        self.expected(&self.points(state)).iter().map(by_layout).collect()
    }

    /// Counts how many people each camera shows, whether the tracked one is among them, and how far the first lies from where the tracked one is expected.
    fn odd_people(
        &mut self,
        people: &[Vec<Person>],
        found: &Associated,
        expected: &[Vec<Option<[f64; 2]>>],
    ) -> Vec<OddPerson> {
        let cameras = people.iter().zip(expected).enumerate();
        let odd = cameras.map(|(c, (people, expected))| {
            let distance = |(d, e): (&Option<Detection>, &Option<[f64; 2]>)| distance_px(*d, *e);
            let first = people.first().map_or(&[][..], Vec::as_slice);
            let mut distances: Vec<f64> = first.iter().zip(expected).filter_map(distance).collect();
            let exchanged = self.partners.iter().filter_map(|&k| expected.get(k));
            let mut crossed: Vec<f64> = first.iter().zip(exchanged).filter_map(distance).collect();
            let is_found = found.members.get(c).is_some_and(Option::is_some);
            self.oddities.people(c, people.len(), is_found, [&mut distances, &mut crossed])
        });
        odd.collect()
    }

    /// Binds the keypoints of each part of the body, for methods with parts.
    fn bind_parts(&mut self, predicted: &[f64]) {
        let Some((part_of, count)) = &self.parts else { return };
        let bound_part = |part: usize| {
            let own = |seen: &Vec<Option<Detection>>| {
                seen.iter().zip(part_of).map(|(d, of)| d.filter(|_| *of == part)).collect()
            };
            let detections: Vec<Vec<_>> = self.shown.detections.iter().map(own).collect();
            self.model.bind(KeypointFrame { detections: &detections, elsewhere: &self.shown.elsewhere, predicted })
        };
        self.bound_parts = (0..*count).map(bound_part).collect();
    }

    /// The likelihoods of the parts of the body in the current frame, taken away; none for methods without parts.
    pub fn parts(&mut self) -> Vec<BoundKeypoints> {
        std::mem::take(&mut self.bound_parts)
    }

    /// The likelihood's model.
    #[must_use]
    pub const fn model(&self) -> &KeypointModel {
        &self.model
    }

    /// What the current frame shows.
    #[must_use]
    pub const fn shown(&self) -> &Shown {
        &self.shown
    }

    /// Points of the body that are keypoints: their indices in the body.
    #[must_use]
    pub fn point_indices(&self) -> &[usize] {
        &self.point
    }

    /// Names of the keypoints that are points of the body.
    #[must_use]
    pub fn keypoints(&self) -> Vec<String> {
        self.keypoint.iter().map(|&k| self.layout.points[k].clone().unwrap_or_default()).collect()
    }

    /// Looks at a frame once it is tracked, `shown` what it showed: `state` is the mean of its posterior, `draws` are some of its draws.
    pub fn check_frame(&mut self, number: u64, shown: &Shown, state: &[f64], draws: &[Vec<f64>]) {
        let points = self.points(state);
        let expected = self.expected(&points);
        let frame = KeypointFrame { detections: &shown.detections, elsewhere: &shown.elsewhere, predicted: &points };
        let straight = self.model.straight(&frame);
        self.check(number, &straight, state, draws);
        let distance = |camera: usize, seen, at| distance_px(shown.detections[camera][seen], expected[camera][at]);
        self.oddities.note(number, &shown.odd, distance);
    }

    /// What the next frame needs of those before it.
    #[must_use]
    pub fn save(&self) -> SceneState {
        let Following { lengths, last_px, lost, started, .. } = self.following.clone();
        let numbers = |d: &Option<Detection>| d.map(Detection::to_array);
        let detections = self.shown.detections.iter().map(|seen| seen.iter().map(numbers).collect()).collect();
        let (oddities, predictive) = (self.oddities.save(), self.predictive.clone());
        let velocities = self.clocks.save();
        SceneState { lengths, last_px, lost, started, velocities, detections, oddities, predictive }
    }

    /// Takes up what a scene of the same set-up gave.
    ///
    /// # Errors
    /// A state of another scene.
    pub fn restore(&mut self, saved: &SceneState) -> Result<(), Problem> {
        let (cameras, keypoints) = (self.cameras.len(), self.layout.points.len());
        check_length(saved.detections.len(), cameras)?;
        saved.detections.iter().try_for_each(|seen| check_length(seen.len(), self.keypoint.len()))?;
        // Nothing is remembered of someone who was never seen.
        check_length(saved.last_px.len(), if saved.last_px.is_empty() { 0 } else { cameras })?;
        saved.last_px.iter().try_for_each(|px| check_length(px.len(), if px.is_empty() { 0 } else { keypoints }))?;
        let known = saved.lengths.iter().filter(|(a, b, _)| *a < keypoints && *b < keypoints).count();
        check_length(saved.lengths.len(), known)?;
        self.clocks.restore(&saved.velocities)?;
        check_length(saved.oddities.len(), cameras)?;
        self.oddities.restore(&saved.oddities);
        check_length(saved.predictive.cameras(), cameras)?;
        self.predictive.clone_from(&saved.predictive);
        self.following = Following {
            person: self.setup.person,
            lengths: saved.lengths.clone(),
            last_px: saved.last_px.clone(),
            lost: saved.lost,
            started: saved.started,
        };
        let detection = |d: &Option<[f64; 4]>| d.map(Detection::from_array);
        self.shown.detections = saved.detections.iter().map(|seen| seen.iter().map(detection).collect()).collect();
        Ok(())
    }

    /// What was odd in the frames so far, and what does not look as the model says.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let doubts = self.doubts();
        self.oddities.warnings().into_iter().chain(doubts.iter().map(|doubt| doubt.describe(self.origins))).collect()
    }

    /// What does not look as the model says.
    #[must_use]
    pub fn doubts(&self) -> Vec<Doubt> {
        let mut doubts = self.predictive.doubts(self.held_correlation);
        doubts.extend(self.calibration_doubt(self.predictive.lengths(&doubts)));
        doubts
    }

    /// Offsets of the set-up that are large against the noise: they hide a shift of the world.
    fn calibration_doubt(&self, lengths: Lengths) -> Option<Doubt> {
        let offset = |camera: &Camera| self.setup.camera.iter().find(|known| known.name == camera.name);
        let known: Vec<&CameraSetup> = self.cameras.iter().filter_map(offset).collect();
        let offsets: Vec<[f64; 2]> = known.iter().map(|known| known.offset_px).collect();
        let size = |known: &CameraSetup| known.offset_px[0].hypot(known.offset_px[1]) / known.sigma_px;
        let large: Vec<_> = known.into_iter().filter(|known| size(known) > predictive::OFFSET).collect();
        let points = self.points(self.start());
        let at = [0, 1, 2].map(|k| points.iter().skip(k).step_by(3).sum::<f64>() / (points.len() / 3) as f64);
        let drawn = setup::lasting_draws::world_shift_sd_m(&self.setup, &self.cameras);
        let is_in_intervals = drawn.is_some();
        let shift_m = drawn.or_else(|| offsets::hidden_shift_m(&self.cameras, &offsets, at))?;
        let cameras: Vec<_> = large.into_iter().map(|known| (known.name.clone(), known.offset_px)).collect();
        (!cameras.is_empty()).then_some(Doubt::Calibration { cameras, shift_m, is_in_intervals, lengths })
    }

    /// Scatter per axis, per camera, of the keypoints about the projection of a pose, pixels: their median distance divided by √(2 ln 2), which is the standard
    /// deviation per axis of Gaussian errors and hardly moved by gross outliers.
    #[must_use]
    pub fn residual_px(&self, shown: &Shown, state: &[f64]) -> Vec<Option<f64>> {
        let expected = self.expected(&self.points(state));
        shown
            .detections
            .iter()
            .zip(&expected)
            .map(|(seen, expected)| {
                let mut distances: Vec<f64> =
                    seen.iter().zip(expected).filter_map(|(d, e)| distance_px(*d, *e)).collect();
                (!distances.is_empty()).then(|| median(&mut distances) / (2.0 * std::f64::consts::LN_2).sqrt())
            })
            .collect()
    }
}
