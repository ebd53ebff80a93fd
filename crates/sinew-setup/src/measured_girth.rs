//! Girths of the subject, from masks and rough poses of the first second.
//!
//! One camera does not tell a thick person from a near one: then girths stay as they are.
//!
//! 1. Of some frames of that second every other one is fitted, poses and girths together ([`fit_girth_and_poses`]), for keypoints or a file give the poses roughly; the rest is held out.
//! 2. In the frames held out, poses follow the masks twice, with the radii that people usually have and with the girths ([`fit_poses`]). Girths that do not match these masks better are not kept.
//!
//! The fitted poses serve the girths alone.

use super::first_second::{FRAMES, FirstSecond};
use super::girth::MeasuredGirth;
use super::setup_error::SetupError;
use super::stored::Setup;
use crate::Error;
use sinew_input::source::FrameSource;
use sinew_observe::silhouettes::girth::{Girth, Sight, before_cameras, intersection_over_union, mask_overlap};
use sinew_observe::silhouettes::girth_with_pose::{fit_girth_and_poses, fit_poses};

/// Measures girths; none where fewer than two cameras have masks, nobody is on them or nothing is gained.
pub(super) fn measured_girth(
    setup: &Setup,
    source: &mut dyn FrameSource,
    second: &FirstSecond,
) -> Result<Option<MeasuredGirth>, Error> {
    if second.rasters.len() < 2 {
        return Ok(None);
    }
    let FirstSecond { frames, poses, rasters } = second;
    let every = (frames.end - frames.start).div_ceil(FRAMES).max(1);
    let mut sights: Vec<Sight> = vec![];
    for (&number, state) in poses.iter().filter(|(number, _)| (*number - frames.start).is_multiple_of(every)) {
        let masks = source.masks(number)?;
        let silhouettes = rasters.iter().zip(&masks).map(|(raster, mask)| Some(raster.silhouette(mask.as_ref()?)));
        sights.push(Sight { state: state.clone(), silhouettes: silhouettes.collect() });
    }
    let with = |rest: usize| sights.iter().skip(rest).step_by(2).cloned().collect::<Vec<Sight>>();
    let (fitted, held_out) = (with(0), with(1));
    if sights.iter().flat_map(|sight| &sight.silhouettes).flatten().all(|mask| mask.count() == 0) {
        return Ok(None);
    }
    let cameras = second.cameras();
    let (tree, flesh) = (setup.tree(), setup.flesh()?);
    let no_flesh = SetupError::NoFlesh;
    let Girth { trunk, arms, legs } = fit_girth_and_poses(&tree, &flesh, &cameras, &fitted).map_err(no_flesh)?.girth;
    let iou = |girth: Girth| {
        let model = before_cameras(&tree, &girth.applied(&flesh), &cameras).map_err(no_flesh)?;
        let posed = fit_poses(&tree, &flesh, &cameras, &held_out, girth).map_err(no_flesh)?;
        Ok::<f64, Error>(intersection_over_union(posed.iter().map(|sight| mask_overlap(&model, sight)).sum()))
    };
    let held_out_iou = [iou(Girth::default())?, iou(Girth { trunk, arms, legs })?];
    let gained = held_out_iou[1] > held_out_iou[0];
    Ok(gained.then_some(MeasuredGirth { trunk, arms, legs, held_out_iou }))
}
