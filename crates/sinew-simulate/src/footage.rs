//! Footage of a motion: silhouettes and pictures of any frame in any camera.
//!
//! With cameras around the motion and the person who makes it.
//!
//! Everything follows from a seed; any image can be made alone and in any order.
//!
//! ```
//! use sinew_simulate::footage::SyntheticFootage;
//! use sinew_simulate::ring::Ring;
//! use sinew_simulate::segmentation_noise::Level;
//! use sinew_body::points::points_of_states;
//! use sinew_simulate::walker::{Gait, Walker, walker_states};
//! let walker = Walker::new(Gait { duration_s: 0.1, ..Gait::default() });
//! let motion = points_of_states(&walker.body, &walker_states(&walker, 30.0));
//! let footage = SyntheticFootage::new(motion, 30.0, &Ring::SMALL_PICTURES, 7)?;
//! let mask = footage.mask(0, 2, Level::Normal);
//! assert_eq!((mask.width(), mask.height()), (320, 240));
//! assert!(mask.count() > 2000);
//! # Ok::<(), sinew_simulate::Error>(())
//! ```

use crate::Error;
use crate::evaluation_body::EvaluationBody;
use crate::render::RayCamera;
use crate::ring::{Ring, around};
use crate::segmentation_noise::{Level, segmented};
use sinew_body::points::Trajectories;
use sinew_core::random::Stage;
use sinew_observe::Camera;
use sinew_observe::RgbImage;
use sinew_observe::silhouettes::bit_image::BitImage;
use std::sync::OnceLock;

/// A motion before cameras.
#[derive(Debug)]
pub struct SyntheticFootage {
    /// The points that move, metres.
    pub motion: Trajectories,
    /// Frames per second.
    pub rate_hz: f64,
    /// Cameras.
    pub cameras: Vec<Camera>,
    /// The person.
    pub body: EvaluationBody,
    views: Vec<RayCamera>,
    rooms: Vec<OnceLock<RgbImage>>,
    seed: u64,
}

/// Half axes of the shadow on the ground, metres, and the direction in which it falls, radians.
const SHADOW_M: [f64; 2] = [0.55, 0.24];
const SHADOW_ANGLE: f64 = 2.5;

impl SyntheticFootage {
    /// Puts cameras around a motion and dresses a person in it.
    ///
    /// # Errors
    /// As [`EvaluationBody::new`]; [`Error::Camera`] for a ring whose numbers are not finite and positive.
    pub fn new(motion: Trajectories, rate_hz: f64, ring: &Ring, seed: u64) -> Result<Self, Error> {
        let cameras = around(&motion, ring)?;
        Self::with_cameras(motion, rate_hz, cameras, seed)
    }

    /// The same with cameras that are there already, with or without distortion.
    ///
    /// # Errors
    /// As [`EvaluationBody::new`].
    pub fn with_cameras(motion: Trajectories, rate_hz: f64, cameras: Vec<Camera>, seed: u64) -> Result<Self, Error> {
        let body = EvaluationBody::new(&motion, Stage::new(seed, "evaluation body"))?;
        let views: Vec<RayCamera> = cameras.iter().map(RayCamera::new).collect();
        let rooms = cameras.iter().map(|_| OnceLock::new()).collect();
        Ok(Self { motion, rate_hz, cameras, body, views, rooms, seed })
    }

    /// Number of frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.body.frames()
    }

    /// The person's pixels in a camera and frame.
    ///
    /// # Panics
    /// For a camera that is not there.
    #[must_use]
    pub fn silhouette(&self, camera: usize, frame: usize) -> BitImage {
        self.views[camera].silhouette(&self.body.solids(frame))
    }

    /// The silhouette as segmentation gives it.
    ///
    /// # Panics
    /// For a camera that is not there.
    #[must_use]
    pub fn mask(&self, camera: usize, frame: usize, level: Level) -> BitImage {
        let shadow = self.body.foothold(frame).filter(|_| level.has_shadow()).map(|[x, y]| {
            let (sin, cos) = SHADOW_ANGLE.sin_cos();
            let centre = [x + 0.8 * SHADOW_M[0] * cos, y + 0.8 * SHADOW_M[0] * sin];
            self.views[camera].ground_ellipse(centre, SHADOW_M, SHADOW_ANGLE)
        });
        let stage = self.stage("segmentation", camera, frame);
        segmented(&self.silhouette(camera, frame), shadow.as_ref(), level, stage)
    }

    /// The picture of a camera in a frame.
    ///
    /// # Panics
    /// For a camera that is not there.
    #[must_use]
    pub fn picture(&self, camera: usize, frame: usize) -> RgbImage {
        let view = &self.views[camera];
        let room = self.rooms[camera].get_or_init(|| view.room(self.seed));
        view.picture(&self.body.solids(frame), room, &self.stage("sensor", camera, frame))
    }

    fn stage(&self, purpose: &str, camera: usize, frame: usize) -> Stage {
        Stage::new(self.seed, purpose).round(camera).at_frame(u32::try_from(frame).unwrap_or(u32::MAX))
    }
}
