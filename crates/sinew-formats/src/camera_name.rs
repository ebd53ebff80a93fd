//! Keypoint folders matched to calibrated cameras by name, never by order.
//!
//! A folder `cam01_json` and a camera `cam_1` are the same camera: the suffix `_json`, punctuation, letter case and
//! leading zeros do not count. Two names that cannot be distinguished then are an error, and so is a folder without a
//! calibration; a calibrated camera without a folder is only reported.
//!
//! ```
//! use sinew_formats::camera_name::{fold, match_names};
//! assert_eq!(fold("Cam_01"), fold("cam1_json"));
//! let matching = match_names(&["cam02_json"], &["cam_01", "cam_02"])?;
//! assert_eq!(matching.pairs, [(0, 1)]);
//! assert_eq!(matching.without_folder, [0]);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::{Error, Warning};
use std::collections::BTreeMap;

/// What is left of a camera's name for matching.
#[must_use]
pub fn fold(name: &str) -> String {
    let lower = name.to_lowercase();
    let stem = lower.strip_suffix("_json").filter(|stem| !stem.is_empty()).unwrap_or(&lower);
    let mut out = String::new();
    let mut zeros = 0;
    let mut in_number = false;
    for c in stem.chars() {
        if c == '0' && !in_number {
            zeros += 1;
            continue;
        }
        if zeros > 0 && !c.is_ascii_digit() {
            out.push('0');
        }
        zeros = 0;
        in_number = c.is_ascii_digit();
        if c.is_alphanumeric() {
            out.push(c);
        }
    }
    if zeros > 0 {
        out.push('0');
    }
    if out.is_empty() { lower } else { out }
}

/// The camera whose name a longer name holds, as that of a file: `trial3_cam01DLC` holds `cam_01`. Of several the longest.
///
/// `None` where it holds none, or two of one length.
#[must_use]
pub fn held(name: &str, cameras: &[impl AsRef<str>]) -> Option<usize> {
    let folded = fold(name);
    let holds = |camera: &str| {
        let is_digit = |c: Option<char>| c.is_some_and(|c| c.is_ascii_digit());
        folded.match_indices(camera).any(|(at, _)| {
            let before = folded.get(..at).and_then(|text| text.chars().next_back());
            let after = folded.get(at + camera.len()..).and_then(|text| text.chars().next());
            let cuts_number = (is_digit(before) && is_digit(camera.chars().next()))
                || (is_digit(after) && is_digit(camera.chars().next_back()));
            !cuts_number
        })
    };
    let folded_cameras = cameras.iter().map(|camera| fold(camera.as_ref())).enumerate();
    only_longest(folded_cameras.filter(|(_, camera)| holds(camera)))
}

/// The camera that is called by a number alone elsewhere: `3` is `cam_3`, `port 3` or `3`.
///
/// `None` where there is none, or several.
#[must_use]
pub fn numbered(number: &str, cameras: &[impl AsRef<str>]) -> Option<usize> {
    let wanted = fold(number);
    let is_it = |camera: &str| camera.trim_start_matches(|c: char| !c.is_ascii_digit()) == wanted;
    let mut found = cameras.iter().enumerate().filter(|(_, camera)| is_it(&fold(camera.as_ref())));
    found.next().map(|(index, _)| index).filter(|_| found.next().is_none())
}

fn only_longest(found: impl Iterator<Item = (usize, String)>) -> Option<usize> {
    let mut found: Vec<(usize, usize)> = found.map(|(index, name)| (name.len(), index)).collect();
    found.sort_unstable();
    match found.as_slice() {
        [.., (second, _), (first, _)] if second == first => None,
        [.., (_, index)] => Some(*index),
        [] => None,
    }
}

/// Which folder belongs to which camera.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Matching {
    /// (index of the folder, index of the camera), in the order of the cameras.
    pub pairs: Vec<(usize, usize)>,
    /// Indices of cameras without a folder.
    pub without_folder: Vec<usize>,
}

impl Matching {
    /// One warning for each camera without a folder.
    #[must_use]
    pub fn warnings(&self, folders: &[impl AsRef<str>], cameras: &[impl AsRef<str>]) -> Vec<Warning> {
        let folders: Vec<String> = folders.iter().map(|name| name.as_ref().to_owned()).collect();
        let lacking = self.without_folder.iter().filter_map(|&i| cameras.get(i));
        lacking
            .map(|camera| Warning::NoKeypoints { camera: camera.as_ref().into(), folders: folders.clone() })
            .collect()
    }
}

/// Matches folders to calibrated cameras.
///
/// # Errors
/// [`Error::CameraCollision`] for two folders or two cameras of one folded name, [`Error::NoCalibration`] for a folder
/// whose camera is not calibrated.
pub fn match_names(folders: &[impl AsRef<str>], cameras: &[impl AsRef<str>]) -> Result<Matching, Error> {
    let mut folder_of = by_folded_name(folders)?;
    let camera_of = by_folded_name(cameras)?;
    for (folded, &folder) in &folder_of {
        if !camera_of.contains_key(folded) {
            let name = folders.get(folder).map(|name| name.as_ref().to_owned()).unwrap_or_default();
            let calibrated: Vec<String> = cameras.iter().map(|name| name.as_ref().to_owned()).collect();
            return Err(Error::NoCalibration { name, calibrated });
        }
    }
    let mut matching = Matching::default();
    for (index, camera) in cameras.iter().enumerate() {
        match folder_of.remove(&fold(camera.as_ref())) {
            Some(folder) => matching.pairs.push((folder, index)),
            None => matching.without_folder.push(index),
        }
    }
    Ok(matching)
}

fn by_folded_name(names: &[impl AsRef<str>]) -> Result<BTreeMap<String, usize>, Error> {
    let mut found: BTreeMap<String, usize> = BTreeMap::new();
    for (index, name) in names.iter().enumerate() {
        if let Some(first) = found.insert(fold(name.as_ref()), index) {
            let first = names.get(first).map(|name| name.as_ref().to_owned()).unwrap_or_default();
            return Err(Error::CameraCollision { first, second: name.as_ref().into() });
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_fold_to_what_matters() {
        for (name, folded) in [
            ("cam_01", "cam1"),
            ("Cam-1_json", "cam1"),
            ("cam10", "cam10"),
            ("cam100", "cam100"),
            ("00", "0"),
            ("cam0", "cam0"),
            ("cam_00_left", "cam0left"),
            ("_json", "json"),
            ("___", "___"),
        ] {
            assert_eq!(fold(name), folded, "{name}");
        }
    }

    #[test]
    fn names_of_files_hold_names_of_cameras() {
        let cameras = ["cam_01", "cam_02", "cam_010", "left"];
        for (name, camera) in [
            ("trial3_cam01DLC_resnet50_shuffle1", Some(0)),
            ("results_cam10", Some(2)),
            ("cam2", Some(1)),
            ("left-predictions", Some(3)),
            ("cam011", None),
            ("cam1_cam2", None),
            ("video", None),
        ] {
            assert_eq!(held(name, &cameras), camera, "{name}");
        }
        assert_eq!(held("cam_left_top", &["left", "left_top"]), Some(1));
    }

    #[test]
    fn numbers_mean_the_only_camera_that_ends_with_them() {
        assert_eq!(numbered("0", &["cam_1", "cam_0"]), Some(1));
        assert_eq!(numbered("3", &["port 03", "port 13"]), Some(0));
        assert_eq!(numbered("1", &["a1", "b1"]), None);
        assert_eq!(numbered("7", &["cam1"]), None);
    }

    #[test]
    fn collisions_and_strangers_are_refused() {
        let error = match_names(&["cam1_json", "cam_01_json"], &["cam1"]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "cameras `cam1_json` and `cam_01_json` have the same name but for punctuation, case and leading zeros"
        );
        let error = match_names(&["cam4"], &["cam1", "cam2", "cam3"]).unwrap_err();
        assert_eq!(error.to_string(), "no calibration for `cam4`; calibrated: cam1, cam2, cam3");
    }

    #[test]
    fn order_does_not_matter() {
        let matching = match_names(&["b_json", "a_json"], &["a", "b", "c"]).unwrap();
        assert_eq!(matching.pairs, [(1, 0), (0, 1)]);
        let warnings = matching.warnings(&["b_json", "a_json"], &["a", "b", "c"]);
        assert_eq!(warnings[0].to_string(), "no keypoints for calibrated camera `c`; folders: b_json, a_json");
    }
}
