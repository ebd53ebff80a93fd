//! The first second of some frames: poses that keypoints give there, and rasters for its masks and pictures.

use super::pose_fit::pose_of;
use super::stored::Setup;
use crate::Error;
use sinew_input::source::FrameSource;
use sinew_observe::association::following::{Following, follow};
use sinew_observe::{Camera, WorkingRaster, association};
use std::collections::BTreeMap;
use std::ops::Range;

/// Frames whose images are looked at.
pub(super) const FRAMES: u64 = 12;
/// Longest side of the raster in which images are compared, pixels.
const RASTER: usize = 640;

/// What is known of the first second before its images are read.
pub(super) struct FirstSecond {
    pub(super) frames: Range<u64>,
    /// State of the body in the frames in which keypoints give one.
    pub(super) poses: BTreeMap<u64, Vec<f64>>,
    /// In the order of the cameras.
    pub(super) rasters: Vec<WorkingRaster>,
}

impl FirstSecond {
    /// Fits the poses; `sized` are the cameras sized like the masks.
    pub(super) fn read(
        setup: &Setup,
        source: &mut dyn FrameSource,
        sized: &[Camera],
        numbers: Range<u64>,
        fps: f64,
    ) -> Result<Self, Error> {
        let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
        let scale = sized.iter().zip(&cameras).next().map_or(1.0, |(a, b)| a.image_size_px[0] / b.image_size_px[0]);
        let raster = |camera: &Camera| WorkingRaster::new(camera, WorkingRaster::factor_for(camera, RASTER));
        let rasters = setup.as_they_are(sized, scale).iter().map(raster).collect();
        let frames = numbers.start..numbers.end.min(numbers.start + fps.ceil() as u64);
        let (mut poses, mut former): (BTreeMap<u64, Vec<f64>>, Option<Vec<f64>>) = (BTreeMap::new(), None);
        let mut following = Following { person: setup.person, ..Following::default() };
        for number in frames.clone() {
            let people = source.people(number)?;
            let found = follow(&mut following, &cameras, &people, None, &association::Config::default());
            former = pose_of(setup, &cameras, &layout, &found.people, former.as_deref());
            poses.extend(former.clone().map(|state| (number, state)));
        }
        Ok(Self { frames, poses, rasters })
    }

    /// The cameras of the rasters.
    pub(super) fn cameras(&self) -> Vec<Camera> {
        self.rasters.iter().map(|raster| raster.camera().clone()).collect()
    }
}
