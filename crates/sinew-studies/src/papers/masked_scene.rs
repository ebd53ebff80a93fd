//! A motion that is tracked, the body that follows it, and what one seed's cameras see of it.
//!
//! A seed dresses another person and draws other errors of segmentation. The tracker's body has the lengths of the person's segments and the girths that masks show of the pose that tracking starts from.

use crate::support::outcome::Outcome;
use sinew::body::flesh::Flesh;
use sinew::body::{KinematicTree, hapf31, hppf24};
use sinew::core::lanes::Isa;
use sinew::core::part::PartTree;
use sinew::core::random::Stage;
use sinew::observe::Camera;
use sinew::observe::ObservationModel as _;
use sinew::observe::RgbImage;
use sinew::observe::silhouettes::bit_image::BitImage;
use sinew::observe::silhouettes::colour_histogram::{Counts, Reference};
use sinew::observe::silhouettes::contour_map::contour_map;
use sinew::observe::silhouettes::girth::{FittedGirth, Sight, fit_girth};
use sinew::observe::silhouettes::image_likelihood::{Cues, ImageLikelihood, ImageModel};
use sinew::observe::silhouettes::image_score::ImageScore;
use sinew::observe::silhouettes::solid_body::{SolidBody, part_tree};
use sinew_body::points::Trajectories;
use sinew_motion::follow::{NamedBody, follow};
use sinew_simulate::footage::SyntheticFootage;
use sinew_simulate::ring::Ring;
use sinew_simulate::segmentation_noise::{Level, segmented};
use std::sync::Arc;

/// Segments whose lengths determine the scale of a body: trunk and head, then the limbs.
pub(super) const SEGMENTS: [(&str, &str); 10] = [
    ("MidHip", "Neck"),
    ("Neck", "Head"),
    ("LShoulder", "LElbow"),
    ("RShoulder", "RElbow"),
    ("LElbow", "LWrist"),
    ("RElbow", "RWrist"),
    ("LHip", "LKnee"),
    ("RHip", "RKnee"),
    ("LKnee", "LAnkle"),
    ("RKnee", "RAnkle"),
];

/// What the likelihood of a part looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CueSet {
    Silhouette,
    WithEdges,
    /// Silhouette, edges, and colours as each part has them in the pose that tracking starts from.
    WithColour,
}

/// Who is before the cameras.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Person {
    /// The evaluation body, which shares no shape with the tracker's.
    Dressed,
    /// The tracker's own body at the fitted true pose: the inverse crime.
    Tracked,
}

/// How a motion is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    /// Numbers of the cameras.
    pub(super) cameras: &'static [usize],
    pub(super) level: Level,
    pub(super) cues: CueSet,
    pub(super) person: Person,
    /// How bodies are compared with it; names do not tell.
    pub(super) score: ImageScore,
}

impl View {
    /// All cameras, `normal` errors, silhouettes and their edges.
    pub(super) const USUAL: Self = Self {
        cameras: &[0, 1, 2, 3],
        level: Level::Normal,
        cues: CueSet::WithEdges,
        person: Person::Dressed,
        score: ImageScore::Parts,
    };

    /// Its name in tables and keys.
    pub(super) fn name(&self) -> String {
        let level = Level::ALL.iter().find(|(_, level)| *level == self.level).map_or("", |(name, _)| name);
        let cameras: Vec<String> = self.cameras.iter().map(|camera| format!("C{}", camera + 1)).collect();
        let cues = match self.cues {
            CueSet::Silhouette => ", silhouette alone",
            CueSet::WithEdges => "",
            CueSet::WithColour => ", with colour",
        };
        let person = if self.person == Person::Tracked { ", own body seen" } else { "" };
        format!("{} {level}{cues}{person}", cameras.join(" "))
    }
}

/// A motion at the tracked rate.
pub(super) struct Scene {
    pub(super) name: String,
    pub(super) motion: Trajectories,
    pub(super) rate_hz: f64,
    /// The body in the person's size.
    pub(super) tree: KinematicTree,
    /// States that follow the joints.
    pub(super) truth: Vec<Vec<f64>>,
    /// Mean distance of the body's joints to the recorded ones, metres.
    pub(super) fit_error_m: f64,
    /// The tracker's body before its girths are known.
    flesh: Flesh,
}

impl Scene {
    /// Makes a body with solids follow a motion.
    pub(super) fn new(name: &str, body: NamedBody, motion: Trajectories, rate_hz: f64) -> Outcome<Self> {
        let found = follow(body, &motion)?;
        let (tree, truth, fit_error_m) = (found.body, found.states, found.mean_error_m);
        let flesh = match body {
            NamedBody::Hapf31 => hapf31::flesh_on(&tree)?,
            _ => hppf24::flesh_on(&tree)?,
        };
        Ok(Self { name: name.into(), motion, rate_hz, tree, truth, fit_error_m, flesh })
    }
}

/// What cameras see of a person, frame by frame, with the tracker's body before them.
pub(super) struct Seen {
    /// By frame and camera.
    cues: Vec<Vec<Cues>>,
    pub(super) model: ImageModel,
    pub(super) parts: PartTree,
    pub(super) girth: FittedGirth,
}

impl Seen {
    /// Draws a person and the errors of a level; `start` is the frame whose pose is known.
    pub(super) fn new(scene: &Scene, view: &View, start: usize, seed: u64, isa: Isa) -> Outcome<Self> {
        let footage = SyntheticFootage::new(scene.motion.clone(), scene.rate_hz, &Ring::SMALL_PICTURES, seed)?;
        let cameras: Vec<Camera> = view.cameras.iter().map(|&camera| footage.cameras[camera].clone()).collect();
        let usual = &scene.flesh;
        let model = |flesh: &Flesh| -> Outcome<ImageModel> {
            let (body, cameras) = (Arc::new(SolidBody::new(&scene.tree, flesh)?), cameras.clone());
            Ok(ImageModel { body, cameras, score: view.score, colours: Arc::default(), isa })
        };
        let own = model(usual)?;
        let masks = |frame: usize| -> Vec<BitImage> {
            let stage = |camera| Stage::new(seed, "own body").round(camera).at_frame(frame as u32);
            match view.person {
                Person::Dressed => view.cameras.iter().map(|&k| footage.mask(k, frame, view.level)).collect(),
                Person::Tracked => {
                    let silhouettes = own.silhouettes(&scene.truth[frame]).into_iter().zip(view.cameras);
                    silhouettes.map(|(whole, &k)| segmented(&whole, None, view.level, stage(k))).collect()
                }
            }
        };
        let with_picture = view.cues == CueSet::WithColour;
        let cues = |frame: usize| -> Vec<Cues> {
            let seen = masks(frame).into_iter().zip(view.cameras).map(|(silhouette, &camera)| Cues {
                edges: (view.cues != CueSet::Silhouette).then(|| contour_map(&silhouette)),
                picture: with_picture.then(|| footage.picture(camera, frame)),
                silhouette,
            });
            seen.collect()
        };
        let cues: Vec<Vec<Cues>> = (0..scene.truth.len()).map(cues).collect();
        let silhouettes = cues[start].iter().map(|cues| Some(cues.silhouette.clone())).collect();
        let first = Sight { state: scene.truth[start].clone(), silhouettes };
        let girth = fit_girth(&scene.tree, usual, &cameras, &[first])?;
        let flesh = girth.girth.applied(usual);
        let mut model = model(&flesh)?;
        let colours = |(camera, seen): (usize, &RgbImage)| {
            let counts = model.colours_of(camera, &scene.truth[start], seen);
            counts.iter().map(Counts::reference).collect::<Vec<Option<Reference>>>()
        };
        let pictures = cues[start].iter().filter_map(|cues| cues.picture.as_ref()).enumerate();
        model.colours = Arc::new(pictures.map(colours).collect());
        Ok(Self { cues, parts: part_tree(&scene.tree, &flesh)?, model, girth })
    }

    /// The likelihood of a frame.
    pub(super) fn bind(&self, frame: usize) -> ImageLikelihood {
        self.model.bind(self.cues[frame].iter().cloned().map(Some).collect())
    }

    /// The likelihood of a frame in whose masks nobody is seen.
    pub(super) fn bind_blank(&self, frame: usize) -> ImageLikelihood {
        let blank = |cues: &Cues| {
            let silhouette = BitImage::new(cues.silhouette.width(), cues.silhouette.height());
            Some(Cues { edges: cues.edges.as_ref().map(|_| contour_map(&silhouette)), picture: None, silhouette })
        };
        self.model.bind(self.cues[frame].iter().map(blank).collect())
    }
}
