//! Whether the colours of a set-up are compared, and what set-up and pictures lack of each other.

use crate::Error;
use crate::config::settings::Settings;
use crate::input::flag::flag;
use crate::input::source::FrameSource;
use crate::setup::{MeasuredColours, Setup};

/// The set-up's colours, where the frames to be tracked have pictures with which the score compares them.
pub(super) fn compared_colours(
    setup: &Setup,
    source: &dyn FrameSource,
    settings: &Settings,
) -> Option<MeasuredColours> {
    let colours = setup.colours.as_ref().filter(|_| settings.compares_colours() && has_pictures(source));
    colours.cloned()
}

fn has_pictures(source: &dyn FrameSource) -> bool {
    !source.pictured(&source.frames()).is_empty()
}

/// Whether no pixel has a colour in the first, the middle and the last frame that has pictures: one alone may show too little.
fn are_grey(source: &mut dyn FrameSource) -> Result<bool, Error> {
    let numbers = source.pictured(&source.frames());
    for &number in numbers.iter().step_by(numbers.len().div_ceil(2).max(1)).chain(numbers.last()) {
        let pictures = source.pictures(number)?;
        let mut pixels = pictures.iter().flatten().flat_map(|picture| &picture.pixels);
        if pixels.any(|[red, green, blue]| red != green || green != blue) {
            return Ok(false);
        }
    }
    Ok(true)
}

/// What to say where colours are to be compared and one of the two is missing, or has no colour.
///
/// # Errors
/// A picture that cannot be read.
pub(super) fn colour_warning(
    setup: &Setup,
    source: &mut dyn FrameSource,
    settings: &Settings,
) -> Result<Option<String>, Error> {
    if !settings.compares_colours() {
        return Ok(None);
    }
    let warning = match (&setup.colours, has_pictures(source)) {
        (None, true) if settings.setup_is_given => {
            let left_out = flag("setup");
            format!(
                "the set-up has no colours, so images give edges only; leave out {left_out}, and colours are learned from the images of the first second"
            )
        }
        (None, true) => {
            "no image of the first second shows the person in a known pose: no colours are learned, and images give edges only"
                .into()
        }
        (Some(_), false) => {
            format!("the set-up has colours, but the frames have no images ({}); colours are not compared", flag("images"))
        }
        (Some(colours), true) if colours.are_grey() => {
            "the images from which colours were learned are grey: they tell light from dark only; give images in colour, if there are any"
                .into()
        }
        (Some(_), true) if settings.setup_is_given && are_grey(source)? => {
            let left_out = flag("setup");
            format!(
                "the set-up has colours, but the images are grey, so that no part looks as it should; give images in colour, or leave out {left_out}, and what is light and dark is learned from these"
            )
        }
        _ => return Ok(None),
    };
    Ok(Some(warning))
}
