//! Colours of the subject's parts, from pictures of the first second and the poses that keypoints give there.
//!
//! For each camera and part the colours at the visible region points are counted, as the likelihood counts them ([`sinew_observe::silhouettes::colour_histogram`]), over at most twelve frames that have a picture. Husz, Wallace & Green (2007) take
//! the first frame; sparse pictures may lack it.

use super::colours::{MeasuredColours, PartColours, VERSION};
use super::first_second::{FRAMES, FirstSecond};
use super::setup_error::SetupError;
use super::stored::Setup;
use crate::Error;
use sinew_body::flesh::Solid;
use sinew_input::source::FrameSource;
use sinew_observe::silhouettes::colour_histogram::Counts;
use sinew_observe::silhouettes::girth::before_cameras;

/// Counts colours; none where no picture of that second shows a part in a known pose.
pub(super) fn measured_colours(
    setup: &Setup,
    source: &mut dyn FrameSource,
    second: &FirstSecond,
) -> Result<Option<MeasuredColours>, Error> {
    let FirstSecond { frames, poses, rasters } = second;
    let (flesh, cameras) = (setup.flesh()?, second.cameras());
    let model = before_cameras(&setup.tree(), &flesh, &cameras).map_err(SetupError::NoFlesh)?;
    let mut counts = vec![vec![Counts::default(); flesh.solids().len()]; cameras.len()];
    let mut known = source.pictured(frames);
    known.retain(|number| poses.contains_key(number));
    let every = known.len().div_ceil(FRAMES as usize).max(1);
    let chosen: Vec<u64> = known.into_iter().step_by(every).collect();
    for number in &chosen {
        for (camera, picture) in source.pictures(*number)?.iter().enumerate() {
            let Some(picture) = picture else { continue };
            let seen = model.colours_of(camera, &poses[number], &rasters[camera].picture(picture));
            counts[camera].iter_mut().zip(&seen).for_each(|(counts, seen)| counts.merge(seen));
        }
    }
    let pairs = cameras.iter().zip(&counts).flat_map(|(camera, counts)| {
        let part = |(solid, counts): (&Solid, &Counts)| PartColours::of(&camera.name, &solid.name, counts);
        flesh.solids().iter().zip(counts).filter(|(_, counts)| counts.total() > 0).map(part).collect::<Vec<_>>()
    });
    let part: Vec<PartColours> = pairs.collect();
    Ok((!part.is_empty()).then_some(MeasuredColours { version: VERSION, frames: chosen, part }))
}
