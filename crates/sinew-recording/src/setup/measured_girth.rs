//! Girths of the subject, from masks of the first second and the poses that keypoints give there.
//!
//! One camera does not tell a thick person from a near one: then girths stay as they are.
//!
//! Of some frames of that second every other one is fitted ([`fit_girth`]), the rest is held out. Girths that do not match the held-out masks better than the radii that people usually have are not kept.

use super::girth::MeasuredGirth;
use super::pose_fit::pose_of;
use super::stored::Setup;
use crate::Error;
use crate::input::source::FrameSource;
use sinew_observe::association;
use sinew_observe::following::{Following, follow};
use sinew_observe::girth::{Girth, Sight, before_cameras, fit_girth, intersection_over_union, mask_overlap};
use sinew_observe::{Camera, WorkingRaster};
use std::ops::Range;

/// Frames whose masks are compared.
const FRAMES: u64 = 12;
/// Longest side of the raster in which masks are compared, pixels.
const RASTER: usize = 640;
/// Measures girths in the first second of some frames; none where fewer than two cameras have masks, nobody is on them or nothing is gained.
///
/// # Errors
/// Errors of the source; a body without solids.
pub fn measure_girth(
    setup: &Setup,
    source: &mut dyn FrameSource,
    numbers: Range<u64>,
    fps: f64,
) -> Result<Option<MeasuredGirth>, Error> {
    let Some(sized) = source.image_cameras().filter(|cameras| cameras.len() > 1) else { return Ok(None) };
    let (cameras, layout) = (source.cameras().to_vec(), source.layout().clone());
    let scale = sized.iter().zip(&cameras).next().map_or(1.0, |(a, b)| a.image_size_px[0] / b.image_size_px[0]);
    let raster = |camera: &Camera| WorkingRaster::new(camera, WorkingRaster::factor_for(camera, RASTER));
    let rasters: Vec<WorkingRaster> = setup.with_offsets(&sized, scale).iter().map(raster).collect();
    let second = numbers.start..numbers.end.min(numbers.start + fps.ceil() as u64);
    let every = (second.end - second.start).div_ceil(FRAMES).max(1);
    let (mut sights, mut former): (Vec<Sight>, Option<Vec<f64>>) = (vec![], None);
    let mut following = Following { person: setup.person, ..Following::default() };
    for number in second.clone() {
        let people = source.people(number)?;
        let found = follow(&mut following, &cameras, &people, None, &association::Config::default());
        former = pose_of(setup, &cameras, &layout, &found.people, former.as_deref());
        let Some(state) = former.clone().filter(|_| (number - second.start).is_multiple_of(every)) else { continue };
        let masks = source.masks(number)?;
        let silhouettes = rasters.iter().zip(&masks).map(|(raster, mask)| Some(raster.silhouette(mask.as_ref()?)));
        sights.push(Sight { state, silhouettes: silhouettes.collect() });
    }
    let with = |rest: usize| sights.iter().skip(rest).step_by(2).cloned().collect::<Vec<Sight>>();
    let (fitted, held_out) = (with(0), with(1));
    if sights.iter().flat_map(|sight| &sight.silhouettes).flatten().all(|mask| mask.count() == 0) {
        return Ok(None);
    }
    let cameras: Vec<Camera> = rasters.iter().map(|raster| raster.camera().clone()).collect();
    let (tree, flesh) = (setup.tree(), setup.flesh()?);
    let no_flesh = super::error::SetupError::NoFlesh;
    let Girth { trunk, arms, legs } = fit_girth(&tree, &flesh, &cameras, &fitted).map_err(no_flesh)?.girth;
    let iou = |girth: Girth| {
        let model = before_cameras(&tree, &girth.applied(&flesh), &cameras).map_err(no_flesh)?;
        Ok::<f64, Error>(intersection_over_union(held_out.iter().map(|sight| mask_overlap(&model, sight)).sum()))
    };
    let held_out_iou = [iou(Girth::default())?, iou(Girth { trunk, arms, legs })?];
    let gained = held_out_iou[1] > held_out_iou[0];
    Ok(gained.then_some(MeasuredGirth { trunk, arms, legs, held_out_iou }))
}
