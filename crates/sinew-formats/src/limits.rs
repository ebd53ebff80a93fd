//! How much of one file is read: counts that no recording of people has, and with which what follows would take minutes, or memory without bound.

use crate::{Error, Place};

/// Joints, bones or links of a skeleton (BVH, ASF, URDF).
pub const MAX_JOINTS: usize = 2000;

/// Named points of a motion file (TRC, CSV).
pub const MAX_POINTS: usize = 10_000;

/// People whom a camera sees in a frame; many detectors list their 100 best.
pub const MAX_PEOPLE: usize = 100;

/// Cameras in a live line.
pub const MAX_LIVE_CAMERAS: usize = 1000;

/// Refuses more than `limit` of something, which is called `what` in the plural.
///
/// # Errors
/// [`Error::TooMany`].
pub(crate) fn check_count(
    place: impl FnOnce() -> Place,
    found: usize,
    what: &'static str,
    limit: usize,
) -> Result<(), Error> {
    if found <= limit { Ok(()) } else { Err(Error::TooMany { place: place(), what, limit }) }
}
