//! What the subject looks like in the first second: girths from masks, colours from pictures.

use super::first_second::FirstSecond;
use super::measured_colours::measured_colours;
use super::measured_girth::measured_girth;
use super::stored::Setup;
use crate::Error;
use sinew_input::source::FrameSource;
use std::ops::Range;

/// Measures girths where there are masks and the body has no solids of its own, and `with_colours` the colours of its parts where there are pictures, in the first second of some frames.
///
/// # Errors
/// Errors of the source; a body without solids.
pub fn measure_look(
    setup: &mut Setup,
    source: &mut dyn FrameSource,
    numbers: Range<u64>,
    fps: f64,
    with_colours: bool,
) -> Result<(), Error> {
    let Some(sized) = source.image_cameras() else { return Ok(()) };
    let second = FirstSecond::read(setup, source, &sized, numbers, fps)?;
    if !setup.body.has_solids() {
        setup.girth = measured_girth(setup, source, &second)?;
    }
    if with_colours {
        setup.colours = measured_colours(setup, source, &second)?;
    }
    Ok(())
}
