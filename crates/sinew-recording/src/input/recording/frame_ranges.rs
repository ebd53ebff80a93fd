//! The frames that all cameras have, with their lags, and the chosen ones among them.

use super::listing::CameraFiles;
use crate::Error;
use crate::input::error::InputError;
use crate::input::lag::ClockLag;
use sinew_formats::{camera_name, frame_number};
use std::borrow::Borrow;
use std::ops::Range;

/// Refuses lags of cameras that are not calibrated.
pub fn check_lags(lags: &[(String, ClockLag)], calibrated: &[String]) -> Result<(), InputError> {
    let is_known = |name: &str| calibrated.iter().any(|known| camera_name::fold(known) == camera_name::fold(name));
    match lags.iter().find(|(name, _)| !is_known(name)) {
        None => Ok(()),
        Some((name, _)) => Err(InputError::LagOfNoCamera { name: name.clone(), calibrated: calibrated.to_vec() }),
    }
}

/// How late a camera is.
pub fn lag_of(lags: &[(String, ClockLag)], camera: &str) -> ClockLag {
    let is_it = |(name, _): &&(String, ClockLag)| camera_name::fold(name) == camera_name::fold(camera);
    lags.iter().find(is_it).map_or(ClockLag::default(), |(_, lag)| *lag)
}

pub(super) fn no_such_frames(asked: &Range<u64>, available: &Range<u64>) -> Error {
    InputError::NoSuchFrames { asked: asked.clone(), available: available.clone() }.into()
}

/// That a camera is so late that no frame is in all.
fn lags_leave_none(listed: &[impl Borrow<CameraFiles>]) -> InputError {
    let files = listed.iter().map(Borrow::borrow);
    let latest = files.max_by(|a, b| a.lag.frames.abs().total_cmp(&b.lag.frames.abs()));
    let Some(latest) = latest else { return InputError::NoCommonFrame };
    let in_names = latest.range_in_names();
    let frames = in_names.end.saturating_sub(in_names.start);
    InputError::LagLeavesNoFrame { camera: latest.camera.clone(), lag: latest.lag, frames }
}

/// Frames that exist and frames to be tracked.
pub fn ranges(
    listed: &[impl Borrow<CameraFiles>],
    asked: Option<&Range<u64>>,
    trim: bool,
) -> Result<(Range<u64>, Range<u64>), Error> {
    let whole: Vec<(&str, Range<u64>)> =
        listed.iter().map(Borrow::borrow).map(|files: &CameraFiles| (files.camera.as_str(), files.range())).collect();
    let available = frame_number::common_range(&whole, true)?;
    let has_lags = listed.iter().any(|files| files.borrow().lag != ClockLag::default());
    if has_lags && asked.is_none() {
        let in_names: Vec<(&str, Range<u64>)> =
            listed.iter().map(Borrow::borrow).map(|files| (files.camera.as_str(), files.range_in_names())).collect();
        frame_number::common_range(&in_names, trim)?;
    }
    let trim = trim || has_lags;
    let frames = match asked {
        None => frame_number::common_range(&whole, trim)?,
        Some(asked) => {
            let cut = |range: &Range<u64>| {
                let start = range.start.max(asked.start);
                start..range.end.min(asked.end).max(start)
            };
            let cut: Vec<(&str, Range<u64>)> = whole.iter().map(|(name, range)| (*name, cut(range))).collect();
            frame_number::common_range(&cut, trim)?
        }
    };
    if available.is_empty() && has_lags {
        return Err(lags_leave_none(listed).into());
    }
    if frames.is_empty() {
        return Err(match asked {
            Some(asked) => no_such_frames(asked, &available),
            None => InputError::NoCommonFrame.into(),
        });
    }
    let most = listed.iter().map(|files| files.borrow().len()).max().unwrap_or_default() as u64;
    if frames.end - frames.start > 1000 * (most + 1) {
        return Err(InputError::NumbersApart { first: frames.start, last: frames.end - 1, files: most }.into());
    }
    Ok((available, frames))
}
