//! The frames that all cameras have, with their lags, and the chosen ones among them.

use super::listing::CameraFiles;
use crate::Error;
use crate::input_error::InputError;
use crate::lag::ClockLag;
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

/// The error for a camera that is so late that the cameras have no frame in common.
fn lags_leave_none(listed: &[impl Borrow<CameraFiles>]) -> InputError {
    let files = listed.iter().map(Borrow::borrow);
    let latest = files.max_by(|a, b| a.lag.frames.abs().total_cmp(&b.lag.frames.abs()));
    let Some(latest) = latest else { return InputError::NoCommonFrame };
    let in_names = latest.range_in_names();
    let frames = in_names.end.saturating_sub(in_names.start);
    InputError::LagLeavesNoFrame { camera: latest.camera.clone(), lag: latest.lag, frames }
}

/// First to last frame of each camera that says when the recording began and ended.
///
/// Of files that leave out frames without people, a missing frame says nothing. Where all are such files, all cameras have the frames from the first that one of them has to the last.
///
/// # Errors
/// A camera with such files whose frames overlap with those of no other camera.
pub(super) fn spans<'a>(
    listed: &'a [impl Borrow<CameraFiles>],
    range: impl Fn(&CameraFiles) -> Range<u64>,
) -> Result<Vec<(&'a str, Range<u64>)>, Error> {
    let files = || listed.iter().map(|files| -> &CameraFiles { files.borrow() });
    let span = |files: &'a CameraFiles| (files.camera.as_str(), range(files));
    if files().any(|files| !files.leaves_out_nobody) {
        return Ok(files().filter(|files| !files.leaves_out_nobody).map(span).collect());
    }
    let seen: Vec<(&str, Range<u64>)> = files().map(span).filter(|(_, range)| !range.is_empty()).collect();
    shared(&seen)?;
    let start = seen.iter().map(|(_, range)| range.start).min().unwrap_or_default();
    let end = seen.iter().map(|(_, range)| range.end).max().unwrap_or_default();
    Ok(files().map(|files| (files.camera.as_str(), start..end)).collect())
}

/// Refuses a camera whose frames no other has: nothing that it saw could be placed in space.
fn shared(seen: &[(&str, Range<u64>)]) -> Result<(), Error> {
    let meet = |a: &Range<u64>, b: &Range<u64>| a.start < b.end && b.start < a.end;
    let is_alone = |(camera, range): &&(&str, Range<u64>)| {
        !seen.iter().any(|(other, theirs)| other != camera && meet(range, theirs))
    };
    match seen {
        [first, rest @ ..] => match rest.iter().find(is_alone) {
            Some(other) => Ok(frame_number::common_range(&[first.clone(), other.clone()], false).map(drop)?),
            None => Ok(()),
        },
        [] => Ok(()),
    }
}

/// Frames that exist and frames to be tracked.
pub fn ranges(
    listed: &[impl Borrow<CameraFiles>],
    asked: Option<&Range<u64>>,
    trim: bool,
) -> Result<(Range<u64>, Range<u64>), Error> {
    let whole = spans(listed, CameraFiles::range)?;
    let available = frame_number::common_range(&whole, true)?;
    let has_lags = listed.iter().any(|files| files.borrow().lag != ClockLag::default());
    if has_lags && asked.is_none() && listed.iter().any(|files| !files.borrow().leaves_out_nobody) {
        frame_number::common_range(&spans(listed, CameraFiles::range_in_names)?, trim)?;
    }
    let whole = if trim { own(listed) } else { whole };
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
    check_numbers(listed, &frames)?;
    Ok((available, frames))
}

/// Refuses numbers that are too large for the number of files.
pub(super) fn check_numbers(listed: &[impl Borrow<CameraFiles>], frames: &Range<u64>) -> Result<(), InputError> {
    let most = listed.iter().map(|files| files.borrow().len()).max().unwrap_or_default() as u64;
    if frames.end - frames.start <= 1000 * (most + 1) {
        return Ok(());
    }
    let in_one_file = listed.iter().any(|files| files.borrow().file().is_some());
    Err(InputError::NumbersApart { first: frames.start, last: frames.end - 1, files: most, in_one_file })
}

/// First to last frame that each camera itself has; cameras without any left out.
fn own(listed: &[impl Borrow<CameraFiles>]) -> Vec<(&str, Range<u64>)> {
    let files = listed.iter().map(|files| -> &CameraFiles { files.borrow() }).filter(|files| files.len() > 0);
    files.map(|files| (files.camera.as_str(), files.range())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn camera(name: &str, numbers: &[u64], leaves_out_nobody: bool) -> CameraFiles {
        CameraFiles::one_file(name, Path::new("k/a.json"), numbers.iter().copied(), leaves_out_nobody)
    }

    fn frames(listed: &[CameraFiles], trim: bool) -> Result<Range<u64>, String> {
        ranges(listed, None, trim).map(|(_, frames)| frames).map_err(|error| error.to_string())
    }

    #[test]
    fn a_missing_image_shows_nobody() {
        let listed = [camera("C1", &[0, 1, 59], true), camera("C2", &[10, 40], true), camera("C3", &[], true)];
        assert_eq!(frames(&listed, false), Ok(0..60));
        assert_eq!(frames(&listed, true), Ok(10..41));
        let asked = ranges(&listed, Some(&(20..100)), false).unwrap();
        assert_eq!(asked, (0..60, 20..60));
        let with_all = [camera("C1", &[0, 1, 2, 3], false), camera("C2", &[2, 9], true)];
        assert_eq!(frames(&with_all, false), Ok(0..4));
        assert_eq!(
            frames(&[camera("C1", &[0, 1], false), camera("C2", &[0], false)], false).unwrap_err(),
            "C1 has 2 frames, C2 has 1; difference 1"
        );
    }

    #[test]
    fn numbers_that_run_on_from_camera_to_camera_are_refused() {
        let (first, second) = ([0, 30, 59], [3000, 3030, 3059]);
        let listed = [camera("C1", &first, true), camera("C2", &second, true)];
        for trim in [false, true] {
            let error = ranges(&listed, None, trim).unwrap_err();
            assert!(matches!(error, Error::Format(sinew_formats::Error::FrameRanges { .. })), "{error}");
        }
        let mended = [camera("C1", &first, true), camera("C2", &second, true).late_by(ClockLag::whole(3000))];
        assert_eq!(frames(&mended, false), Ok(0..60));
        // Each camera meets another: who walks from one to the next is no error.
        let along = [camera("C1", &[0, 30], true), camera("C2", &[20, 60], true), camera("C3", &[50, 90], true)];
        assert_eq!(frames(&along, false), Ok(0..91));
    }

    #[test]
    fn a_number_that_jumps_is_named() {
        let error = ranges(&[camera("C1", &[0, 1, 9_000_000], true)], None, false).unwrap_err();
        assert_eq!(
            error.to_string(),
            "frame numbers run from 0 to 9000000, but there are only 3 frames in the file of a camera"
        );
    }
}
