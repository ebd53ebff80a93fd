//! Frame numbers from file names.
//!
//! The number is the last run of digits in the name without its extension: `cam01.0034.json` is frame 34,
//! `cam01_000000000034_keypoints.json` too. A version or size tag in a trailing word such as `_keypoints` does not
//! count unless it has digits of its own. Frames are ordered by number (1, 2, 10), never by name (1, 10, 2).
//!
//! ```
//! use sinew_formats::frame_number::{order, parse};
//! assert_eq!(parse("cam01.0034.json"), Some(34));
//! let frames = order(&["c.10.json", "c.1.json", "c.2.json"])?;
//! assert_eq!(frames, [(1, 1), (2, 2), (10, 0)]);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::{Error, Warning};
use std::collections::BTreeMap;
use std::ops::Range;

/// Frame number in a file name.
#[must_use]
pub fn parse(file_name: &str) -> Option<u64> {
    file_name[place(file_name)?].parse().ok()
}

/// Place of the digits of the frame number in a file name.
#[must_use]
pub fn place(file_name: &str) -> Option<Range<usize>> {
    let stem = match file_name.rsplit_once('.') {
        Some((stem, extension)) if !stem.is_empty() && !extension.bytes().all(|b| b.is_ascii_digit()) => stem,
        _ => file_name,
    };
    let end = stem.rfind(|c: char| c.is_ascii_digit())? + 1;
    let start = stem[..end]
        .rfind(|c: char| !c.is_ascii_digit())
        .map_or(0, |at| at + stem[at..].chars().next().map_or(1, char::len_utf8));
    Some(start..end)
}

/// Frame numbers in rising order, each with the index of its file in the list.
///
/// # Errors
/// [`Error::NoFrameNumber`] for a name without digits (or with more than a number holds), [`Error::DuplicateFrame`] for
/// two files of one frame.
pub fn order(file_names: &[impl AsRef<str>]) -> Result<Vec<(u64, usize)>, Error> {
    let mut frames: BTreeMap<u64, usize> = BTreeMap::new();
    for (index, name) in file_names.iter().enumerate() {
        let name = name.as_ref();
        let frame = parse(name).ok_or_else(|| Error::NoFrameNumber { name: name.into() })?;
        if let Some(first) = frames.insert(frame, index) {
            let first = file_names.get(first).map(|name| name.as_ref().to_owned()).unwrap_or_default();
            return Err(Error::DuplicateFrame { frame, first, second: name.into() });
        }
    }
    Ok(frames.into_iter().collect())
}

/// Holes in rising frame numbers, as a warning; at most a thousand are listed.
#[must_use]
pub fn holes(camera: &str, frames: &[u64]) -> Option<Warning> {
    const LISTED: usize = 1000;
    let gaps = frames.windows(2).filter_map(|pair| Some(pair.first()?.saturating_add(1)..*pair.get(1)?));
    let missing: Vec<u64> = gaps.flatten().take(LISTED).collect();
    (!missing.is_empty()).then(|| Warning::LacksFrames { camera: camera.into(), frames: missing })
}

/// The frames that all cameras have, from the first to the last number of each.
///
/// With `trim`, cameras may begin and end apart, and the common range is returned (it may be empty).
///
/// # Errors
/// [`Error::FrameRanges`] without `trim`, naming the first camera and the one that differs most from it.
pub fn common_range(cameras: &[(&str, Range<u64>)], trim: bool) -> Result<Range<u64>, Error> {
    let Some((name, range)) = cameras.first() else { return Ok(0..0) };
    let apart = |other: &Range<u64>| other.start.abs_diff(range.start).saturating_add(other.end.abs_diff(range.end));
    let farthest = cameras.iter().max_by_key(|(_, other)| apart(other));
    if let Some((other, other_range)) = farthest.filter(|(_, other)| !trim && apart(other) > 0) {
        return Err(Error::FrameRanges {
            camera: (*name).into(),
            frames: range.end.saturating_sub(range.start),
            other: (*other).into(),
            other_frames: other_range.end.saturating_sub(other_range.start),
            ends: (other_range.start.wrapping_sub(range.start) as i64, other_range.end.wrapping_sub(range.end) as i64),
        });
    }
    let start = cameras.iter().map(|(_, range)| range.start).max().unwrap_or_default();
    let end = cameras.iter().map(|(_, range)| range.end).min().unwrap_or_default();
    Ok(start..end.max(start))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_run_of_digits_counts() {
        for (name, frame) in [
            ("cam01.0034.json", Some(34)),
            ("cam01_000000000034_keypoints.json", Some(34)),
            ("0007.json", Some(7)),
            ("cam1", Some(1)),
            ("img.0012", Some(12)),
            ("keypoints.json", None),
            ("99999999999999999999999.json", None),
            ("", None),
            (".json", None),
        ] {
            assert_eq!(parse(name), frame, "{name}");
        }
    }

    #[test]
    fn two_files_of_one_frame_are_refused() {
        let error = order(&["a.10.json", "a.010.json"]).unwrap_err();
        assert_eq!(error.to_string(), "two files claim frame 10: a.10.json, a.010.json");
    }

    #[test]
    fn holes_are_listed() {
        let text = holes("cam2", &[43, 44, 47, 300, 302]).unwrap().to_string();
        assert!(text.starts_with("cam2 lacks frames 45, 46, 48, 49,"), "{text}");
        assert_eq!(holes("cam2", &[44, 47, 48]).unwrap().to_string(), "cam2 lacks frames 45, 46");
        assert!(holes("cam2", &[1, 2, 3]).is_none());
        assert!(holes("cam2", &[0, u64::MAX]).is_some());
    }

    #[test]
    fn ranges_must_agree_unless_trimmed() {
        let cameras = [("cam1", 0..900), ("cam2", 0..900), ("cam3", 0..897)];
        let error = common_range(&cameras, false).unwrap_err();
        assert_eq!(error.to_string(), "cam1 has 900 frames, cam3 has 897; difference 3");
        assert_eq!(common_range(&cameras, true).unwrap(), 0..897);
        let shifted = [("cam1", 0..900), ("cam2", 4..904)];
        let error = common_range(&shifted, false).unwrap_err();
        assert_eq!(
            error.to_string(),
            "cam1 has 900 frames, cam2 has 900; difference 0, but the first frames differ by +4 and the last by +4"
        );
    }
}
