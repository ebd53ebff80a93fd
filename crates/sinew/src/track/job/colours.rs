//! Whether the colours of a set-up are compared, and what set-up and pictures lack of each other.

use crate::config::settings::Settings;
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

/// What to say where colours are to be compared and one of the two is missing, or has no colour.
pub(super) fn colour_warning(setup: &Setup, source: &dyn FrameSource, settings: &Settings) -> Option<String> {
    if !settings.compares_colours() {
        return None;
    }
    let warning = match (&setup.colours, has_pictures(source)) {
        (None, true) if settings.setup_is_given => {
            "the set-up has no colours, so images give edges only; leave out `--setup`, and colours are learned from the images of the first second"
        }
        (None, true) => {
            "no image of the first second shows the person in a known pose: no colours are learned, and images give edges only"
        }
        (Some(_), false) => {
            "the set-up has colours, but the frames have no images (`--images`); colours are not compared"
        }
        (Some(colours), true) if colours.are_grey() => {
            "the images from which colours were learned are grey: they tell light from dark only"
        }
        _ => return None,
    };
    Some(warning.into())
}
