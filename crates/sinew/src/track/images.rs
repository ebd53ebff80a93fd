//! The image side of a pipeline.
//!
//! The body's flesh before cameras that see silhouettes, and how well the tracked poses cover what they saw.

use super::error::TrackError;
use crate::Error;
use crate::config::settings::Settings;
use crate::input::frame::FrameImages;
use crate::methods::BoundImages;
use crate::setup::MeasuredColours;
use serde::{Deserialize, Serialize};
use sinew_body::KinematicTree;
use sinew_body::flesh::Flesh;
use sinew_core::part::PartTree;
use sinew_observe::silhouettes::bit_image::{BitImage, overlap};
use sinew_observe::silhouettes::contour_map::contour_map;
use sinew_observe::silhouettes::edges::{self, edge_map};
use sinew_observe::silhouettes::image_likelihood::{Cues, ImageModel};
use sinew_observe::silhouettes::image_score::precision_and_recall;
use sinew_observe::silhouettes::soft_silhouette::SoftSilhouetteModel;
use sinew_observe::silhouettes::solid_body::{SolidBody, part_tree};
use sinew_observe::{Camera, ObservationModel, WorkingRaster};
use sinew_results::problem::{Problem, check_length};
use sinew_setup::silhouette_overlap::SilhouetteOverlap;
use std::sync::Arc;

/// What the image side remembers from frame to frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ImageState {
    coverage: Vec<SilhouetteOverlap>,
    /// Frames with silhouettes in which the body was in no camera's view: how many, and the first.
    out_of_view: (u64, Option<u64>),
}

/// A body before cameras that see silhouettes.
pub struct Images {
    names: Vec<String>,
    rasters: Vec<WorkingRaster>,
    model: ImageModel,
    /// For methods with gradients.
    soft: Option<SoftSilhouetteModel>,
    tree: PartTree,
    flesh: Flesh,
    /// Silhouettes of the current frame, in the working rasters.
    seen: Vec<Option<BitImage>>,
    state: ImageState,
}

impl Images {
    /// Before the first frame; `cameras` are sized like the masks. Without `colours` pictures give edges only.
    ///
    /// # Errors
    /// Solids that trackers cannot take.
    pub fn new(
        tree: &KinematicTree,
        flesh: Flesh,
        colours: Option<&MeasuredColours>,
        cameras: &[Camera],
        settings: &Settings,
    ) -> Result<Self, Error> {
        let body = SolidBody::new(tree, &flesh).map_err(TrackError::Solids)?;
        let raster = |camera| WorkingRaster::new(camera, WorkingRaster::factor_for(camera, settings.raster));
        let rasters: Vec<WorkingRaster> = cameras.iter().map(raster).collect();
        let model = ImageModel {
            body: Arc::new(body),
            cameras: rasters.iter().map(|raster| raster.camera().clone()).collect(),
            score: settings.score,
            colours: Arc::new(colours.map(|colours| colours.references(cameras, &flesh)).unwrap_or_default()),
            isa: settings.isa,
        };
        let soft = match settings.method.about().needs_gradients {
            true => {
                let cameras = model.cameras.clone();
                let soft = SoftSilhouetteModel::new(tree, &flesh, cameras, CONTOUR_SIGMA_PX, settings.isa);
                Some(soft.map_err(TrackError::Solids)?)
            }
            false => None,
        };
        Ok(Self {
            soft,
            names: cameras.iter().map(|camera| camera.name.clone()).collect(),
            tree: part_tree(tree, &flesh).map_err(TrackError::Parts)?,
            seen: vec![None; cameras.len()],
            state: ImageState { coverage: vec![SilhouetteOverlap::default(); cameras.len()], ..ImageState::default() },
            flesh,
            rasters,
            model,
        })
    }

    /// The parts of the body.
    #[must_use]
    pub const fn part_tree(&self) -> &PartTree {
        &self.tree
    }

    /// The solids of the body.
    #[must_use]
    pub const fn flesh(&self) -> &Flesh {
        &self.flesh
    }

    /// Binds the images of a frame: edges come from the picture where there is one, else from the outline of the mask; without a picture colours say nothing. Cameras without a mask say nothing; where no mask shows anybody, none does, so that the motion model continues alone.
    pub fn bind(&mut self, images: &FrameImages) -> BoundImages {
        let mut cues = Vec::with_capacity(self.rasters.len());
        for (camera, raster) in self.rasters.iter().enumerate() {
            let silhouette =
                images.silhouettes.get(camera).and_then(Option::as_ref).map(|mask| raster.silhouette(mask));
            let picture = images.pictures.get(camera).and_then(Option::as_ref).map(|picture| raster.picture(picture));
            self.seen[camera].clone_from(&silhouette);
            if self.soft.is_some() {
                continue;
            }
            cues.push(silhouette.map(|silhouette| {
                let edges = match &picture {
                    Some(picture) => edge_map(&picture.grey(), &edges::Config::default()),
                    None => contour_map(&silhouette),
                };
                Cues { edges: Some(edges), silhouette, picture }
            }));
        }
        if self.cameras_with_person() == 0 {
            cues.iter_mut().for_each(|cues| *cues = None);
        }
        match &self.soft {
            Some(soft) => BoundImages::Soft(soft.bind(&self.seen)),
            None => BoundImages::Scored(self.model.bind(cues)),
        }
    }

    /// Cameras that showed somebody in the current frame.
    #[must_use]
    pub fn cameras_with_person(&self) -> usize {
        self.seen.iter().flatten().filter(|silhouette| silhouette.count() > 0).count()
    }

    /// Looks at a frame once it is tracked.
    pub fn note(&mut self, number: u64, state: &[f64]) {
        let (mut seen, mut in_view) = (false, false);
        for ((silhouette, body), coverage) in
            self.seen.iter().zip(self.model.silhouettes(state)).zip(&mut self.state.coverage)
        {
            let Some(silhouette) = silhouette else { continue };
            let [precision, recall] = precision_and_recall(overlap(silhouette, &body, 0..body.width()));
            coverage.frames += 1;
            let share = 1.0 / coverage.frames as f64;
            coverage.precision += share * (precision - coverage.precision);
            coverage.recall += share * (recall - coverage.recall);
            seen = true;
            in_view |= body.count() > 0;
        }
        if seen && !in_view {
            self.state.out_of_view.0 += 1;
            self.state.out_of_view.1.get_or_insert(number);
        }
    }

    /// How well the tracked body covers the silhouettes, camera by camera.
    #[must_use]
    pub fn coverage(&self) -> &[SilhouetteOverlap] {
        &self.state.coverage
    }

    /// What was odd in the frames so far.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = vec![];
        if let (count, Some(first)) = self.state.out_of_view {
            warnings.push(format!(
                "in {count} frames with masks (first: {first}) the tracked body is in no camera's view; the person is lost"
            ));
        }
        for (name, coverage) in self.names.iter().zip(&self.state.coverage) {
            let SilhouetteOverlap { frames, precision, recall } = *coverage;
            if frames == 0 {
                warnings.push(format!("{name} has no mask in any frame"));
            } else if precision < LEAST_COVERAGE || recall < LEAST_COVERAGE {
                warnings.push(format!(
                    "{name}: {:.0} % of the tracked body lies in the masks, {:.0} % of the masks on the body; is the person lost, or the calibration another?",
                    100.0 * precision,
                    100.0 * recall
                ));
            }
        }
        warnings
    }

    /// What the next frame needs of those before it.
    #[must_use]
    pub fn save(&self) -> ImageState {
        self.state.clone()
    }

    /// Takes up what the image side of the same cameras gave.
    ///
    /// # Errors
    /// A state of other cameras.
    pub fn restore(&mut self, saved: &ImageState) -> Result<(), Problem> {
        check_length(saved.coverage.len(), self.names.len())?;
        self.state.clone_from(saved);
        Ok(())
    }
}

/// Error of a contour in the working raster, for methods with gradients: that of the segmentation and of the flesh.
const CONTOUR_SIGMA_PX: f64 = 4.0;

/// Share of body or masks below which a camera is warned of: bodies that are where the person is cover more.
const LEAST_COVERAGE: f64 = 0.5;
