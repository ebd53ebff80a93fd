//! Where keypoints lie: folders of frames, files a camera, or one file of all cameras.
//!
//! | what is given | what is taken |
//! |---|---|
//! | a folder of folders with OpenPose-style files | a folder a camera, by its name |
//! | a folder of files of a [known format](sinew_formats::keypoint_formats) | a file a camera, whose name holds the camera's |
//! | a folder of folders with one such file each | a file a camera, by the name of its folder |
//! | one such file | all cameras that it names, or the one that its name holds |

use super::keypoint_camera::KeypointCamera;
use super::listing::{self, CameraFiles, Folder, has_extension};
use crate::input::error::InputError;
use crate::input::folder_contents::is_video;
use crate::{Error, files};
use sinew_formats::keypoint_formats::{self, FORMATS};
use sinew_formats::keypoint_table::{Frames, KeypointTable};
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_formats::{Layout, camera_name};
use sinew_observe::Camera;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Extensions of files that hold many frames.
const EXTENSIONS: [&str; 2] = ["json", "csv"];

/// Files of a folder that are looked at: cameras are fewer, frames are more.
const LOOKED_AT: usize = 100;

/// The keypoints of a camera, before it is known which one.
pub struct KeypointSource {
    /// Name of the camera, or of its folder or file.
    pub name: String,
    place: SourcePlace,
}

enum SourcePlace {
    Folder(Folder),
    Table { file: PathBuf, frames: Frames, layout: Option<Layout>, in_image_shares: bool },
}

impl KeypointSource {
    /// Keypoints of a camera of that name; coordinates that are shares of the image become pixels of `camera`.
    ///
    /// # Errors
    /// Files without a frame number or twice for a frame, no files.
    pub fn keypoints(self, name: &str, camera: Option<&Camera>) -> Result<KeypointCamera, Error> {
        match self.place {
            SourcePlace::Folder(folder) => Ok(KeypointCamera::folder(listing::files(folder, name, "keypoint files")?)),
            SourcePlace::Table { file, frames, in_image_shares, .. } => {
                if frames.is_empty() {
                    return Err(InputError::NoFrames { file }.into());
                }
                let files = CameraFiles::one_file(name, &file, frames.keys().copied());
                Ok(KeypointCamera::table(files, frames, camera.filter(|_| in_image_shares)))
            }
        }
    }

    /// File of many frames.
    fn file(&self) -> Option<&Path> {
        match &self.place {
            SourcePlace::Folder(_) => None,
            SourcePlace::Table { file, .. } => Some(file),
        }
    }

    fn layout(&self) -> Option<&Layout> {
        match &self.place {
            SourcePlace::Folder(_) => None,
            SourcePlace::Table { layout, .. } => layout.as_ref(),
        }
    }
}

/// The keypoints of each camera, with the names of the cameras in a calibration where names of files hold them.
///
/// # Errors
/// Nothing to read, files of no known format, and names that hold no camera's.
pub fn sources(keypoints: &Path, calibrated: &[String], confidence_scale: f64) -> Result<Vec<KeypointSource>, Error> {
    let files =
        if keypoints.is_file() { vec![(stem(keypoints), keypoints.to_owned())] } else { table_files(keypoints)? };
    if files.is_empty() {
        let folders = listing::camera_folders(keypoints)?.into_iter();
        let source = |folder: Folder| KeypointSource { name: folder.name.clone(), place: SourcePlace::Folder(folder) };
        return Ok(folders.map(source).collect());
    }
    let mut sources = vec![];
    for (label, file) in files {
        sources.extend(from_file(&label, &file, calibrated, confidence_scale)?);
    }
    let is_only = sources.len() == 1 && calibrated.len() == 1;
    for source in &mut sources {
        let is_known = |name: &String| camera_name::fold(name) == camera_name::fold(&source.name);
        if calibrated.is_empty() || calibrated.iter().any(is_known) {
            continue;
        }
        let file = source.file().unwrap_or(keypoints).to_owned();
        match calibrated.first() {
            Some(only) if is_only => source.name.clone_from(only),
            _ => {
                return Err(InputError::FileOfNoCamera {
                    file,
                    camera: source.name.clone(),
                    calibrated: calibrated.to_vec(),
                }
                .into());
            }
        }
    }
    twice(&sources)?;
    Ok(sources)
}

/// Refuses two files of one camera.
fn twice(sources: &[KeypointSource]) -> Result<(), InputError> {
    let mut known: BTreeMap<String, &Path> = BTreeMap::new();
    for source in sources {
        let Some(file) = source.file() else { continue };
        if let Some(first) = known.insert(camera_name::fold(&source.name), file) {
            let (first, second) = (first.to_owned(), file.to_owned());
            return Err(InputError::TwoFiles { camera: source.name.clone(), first, second });
        }
    }
    Ok(())
}

fn stem(path: &Path) -> String {
    path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The keypoints of some cameras.
///
/// # Errors
/// A camera without keypoints.
pub fn chosen(sources: Vec<KeypointSource>, names: &[String]) -> Result<Vec<KeypointSource>, InputError> {
    let wanted: Vec<String> = names.iter().map(|name| camera_name::fold(name)).collect();
    for (name, wanted) in names.iter().zip(&wanted) {
        if !sources.iter().any(|source| camera_name::fold(&source.name) == *wanted) {
            let folders = sources.into_iter().map(|source| source.name).collect();
            return Err(InputError::NoKeypointsOfCamera { name: name.clone(), folders });
        }
    }
    Ok(sources.into_iter().filter(|source| wanted.contains(&camera_name::fold(&source.name))).collect())
}

/// The layout that files of many frames say, which must be one.
///
/// # Errors
/// Two files with other points.
pub fn layout(sources: &[KeypointSource]) -> Result<Option<Layout>, Error> {
    let said = |source: &KeypointSource| Some((source.file()?.to_owned(), source.layout()?.clone()));
    let mut found = sources.iter().filter_map(said);
    let Some((first, layout)) = found.next() else { return Ok(None) };
    match found.find(|(_, other)| *other != layout) {
        Some((second, _)) => Err(InputError::LayoutsDiffer { first, second }.into()),
        None => Ok(Some(layout)),
    }
}

/// Files of a known format in a folder, and lone ones of the folders in it, by the name that holds the camera's.
fn table_files(folder: &Path) -> Result<Vec<(String, PathBuf)>, Error> {
    let mut found = vec![];
    for path in entries(folder)? {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let lone = if path.is_dir() { entries(&path).unwrap_or_default() } else { vec![path.clone()] };
        let mut files = lone.into_iter().filter(|file| file.is_file() && has_extension(file.as_os_str(), &EXTENSIONS));
        let (Some(file), None) = (files.next(), files.next()) else { continue };
        let beginning = files::read_beginning(&file)?;
        if keypoint_formats::recognised(&beginning).is_some() {
            found.push((if path.is_dir() { name } else { stem(&path) }, file));
        }
    }
    Ok(found)
}

/// Some entries of a folder, by name.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let mut paths = vec![];
    for entry in fs::read_dir(folder).map_err(Error::io("read", folder))? {
        paths.push(entry.map_err(Error::io("read", folder))?.path());
        if paths.len() > LOOKED_AT {
            return Ok(vec![]);
        }
    }
    paths.sort();
    Ok(paths)
}

/// The cameras of a file.
fn from_file(
    label: &str,
    file: &Path,
    calibrated: &[String],
    confidence_scale: f64,
) -> Result<Vec<KeypointSource>, Error> {
    if is_video(file) {
        return Err(InputError::FileForFolder { file: file.to_owned(), many: "keypoints", is_video: true }.into());
    }
    let text = files::read_text(file, MAX_TEXT_BYTES)?;
    if keypoint_formats::recognised(&text).is_none() {
        if text.contains("\"people\"") {
            return Err(InputError::FileForFolder { file: file.to_owned(), many: "keypoints", is_video: false }.into());
        }
        let known = FORMATS.map(|format| format.name).to_vec();
        return Err(InputError::UnknownKeypointFile { file: file.to_owned(), known }.into());
    }
    let table = keypoint_formats::read(&file.display().to_string(), &text, confidence_scale)?;
    let KeypointTable { layout, in_image_shares, cameras } = table;
    let named = |camera: Option<usize>, else_named: &str| {
        camera.and_then(|camera| calibrated.get(camera)).map_or_else(|| else_named.to_owned(), Clone::clone)
    };
    let source = |camera: sinew_formats::keypoint_table::TableCamera| {
        let name = match &camera.name {
            Some(number) => named(camera_name::numbered(number, calibrated), number),
            None => named(camera_name::held(label, calibrated), label),
        };
        let (file, layout) = (file.to_owned(), layout.clone());
        KeypointSource { name, place: SourcePlace::Table { file, frames: camera.frames, layout, in_image_shares } }
    };
    Ok(cameras.into_iter().map(source).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::recording::{Recording, RecordingOptions};

    const CALISCOPE: &str = "sync_index,port,frame_index,frame_time,point_id,img_loc_x,img_loc_y\n\
        4,1,0,0.1,11,101,51\n4,2,0,0.1,11,102,52\n5,2,1,0.2,11,103,53\n";

    fn deeplabcut(x: f64) -> String {
        let parts = ["left_hip", "right_hip", "left_shoulder", "right_shoulder"];
        let cells = |cell: &dyn Fn(&str) -> String| parts.map(cell).join(",");
        format!(
            "scorer,{}\nbodyparts,{}\ncoords,{}\n0,{}\n",
            cells(&|_| "D,D,D".into()),
            cells(&|part| format!("{part},{part},{part}")),
            cells(&|_| "x,y,likelihood".into()),
            cells(&|_| format!("{x},50,0.9")),
        )
    }

    fn mediapipe() -> String {
        format!("[[{}]]", vec!["{\"x\":0.25,\"y\":0.5,\"visibility\":0.9}"; 33].join(","))
    }

    /// A folder with a calibration of cameras and some files.
    fn folder(cameras: &[&str], files: &[(&str, &str)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        let camera = |name: &&str| {
            let [centre, target] = [[4.0, 0.0, 1.0], [0.0, 0.0, 1.0]];
            Camera::look_at(name, [640.0, 480.0], 500.0, centre, target).unwrap()
        };
        let cameras: Vec<Camera> = cameras.iter().map(camera).collect();
        fs::write(root.path().join("Calib.toml"), sinew_formats::calib_toml::write(&cameras)).unwrap();
        for (name, text) in files {
            let path = root.path().join("keypoints").join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        root
    }

    fn open(root: &Path, keypoints: &str, options: &RecordingOptions) -> Result<Recording, String> {
        let opened = Recording::open(&root.join("Calib.toml"), &root.join(keypoints), options);
        opened.map_err(|error| error.to_string().replace(&root.display().to_string(), "R"))
    }

    /// For each camera its name and x and y of its first keypoint in a frame.
    fn seen(recording: &mut Recording, number: u64) -> Vec<(String, Option<[f64; 2]>)> {
        let names: Vec<String> = recording.cameras().iter().map(|camera| camera.name.clone()).collect();
        let first = |people: &Vec<sinew_formats::openpose::OpenposePerson>| {
            people.first()?.keypoints.iter().flatten().next().map(|keypoint| [keypoint.x, keypoint.y])
        };
        names.into_iter().zip(recording.frame(number).unwrap().iter().map(first)).collect()
    }

    #[test]
    fn one_file_has_all_cameras_by_their_numbers() {
        let root = folder(&["cam_2", "cam_1"], &[("xy_POSE.csv", CALISCOPE)]);
        for keypoints in ["keypoints/xy_POSE.csv", "keypoints"] {
            assert!(
                open(root.path(), keypoints, &RecordingOptions::default()).is_err_and(|e| e.contains("difference 1"))
            );
            let options = RecordingOptions { trim: true, ..RecordingOptions::default() };
            let mut recording = open(root.path(), keypoints, &options).unwrap();
            assert_eq!((recording.frames(), recording.layout().name.as_str()), (4..5, "MEDIAPIPE_33"));
            let wanted = [("cam_2".into(), Some([102.0, 52.0])), ("cam_1".into(), Some([101.0, 51.0]))];
            assert_eq!(seen(&mut recording, 4), wanted);
            assert_eq!(recording.folders()[0], root.path().join("keypoints/xy_POSE.csv"));
        }
        let message =
            open(folder(&["a", "b"], &[("xy.csv", CALISCOPE)]).path(), "keypoints", &RecordingOptions::default());
        assert_eq!(
            message.unwrap_err(),
            "`R/keypoints/xy.csv`: `1` is or holds no name of one calibrated camera; calibrated: a, b"
        );
    }

    #[test]
    fn files_a_camera_go_by_the_names_that_they_hold() {
        let (one, two) = (deeplabcut(10.0), deeplabcut(20.0));
        let flat = [("t_cam02DLC_x1.csv", two.as_str()), ("t_cam01DLC_x1.csv", &one), ("notes.csv", "a,b\n1,2\n")];
        let deep = [("cam01/results.csv", one.as_str()), ("cam02/results.csv", &two)];
        for files in [&flat[..], &deep] {
            let root = folder(&["cam_01", "cam_02"], files);
            let mut recording = open(root.path(), "keypoints", &RecordingOptions::default()).unwrap();
            let wanted = [("cam_01".into(), Some([10.0, 50.0])), ("cam_02".into(), Some([20.0, 50.0]))];
            assert_eq!(seen(&mut recording, 0), wanted);
            let chosen = RecordingOptions { cameras: Some(vec!["cam_02".into()]), ..RecordingOptions::default() };
            assert_eq!(seen(&mut open(root.path(), "keypoints", &chosen).unwrap(), 0).len(), 1);
        }
    }

    #[test]
    fn shares_of_the_image_become_pixels() {
        let root = folder(&["cam1"], &[("video.json", &mediapipe())]);
        let options = RecordingOptions { image_scale: 0.5, ..RecordingOptions::default() };
        let mut recording = open(root.path(), "keypoints/video.json", &options).unwrap();
        assert_eq!(seen(&mut recording, 0), [("cam1".into(), Some([80.0, 120.0]))]);
    }

    #[test]
    fn what_is_read_is_hashed_frame_by_frame() {
        let hash = |x: f64| {
            let root = folder(&["cam1"], &[("cam1.csv", &deeplabcut(x))]);
            let mut recording = open(root.path(), "keypoints", &RecordingOptions::default()).unwrap();
            let before = recording.input_hashes()["keypoints"].clone();
            recording.frame(0).unwrap();
            recording.frame(0).unwrap();
            assert_ne!(recording.input_hashes()["keypoints"], before);
            recording.input_hashes()["keypoints"].clone()
        };
        assert_eq!(hash(1.0), hash(1.0));
        assert_ne!(hash(1.0), hash(2.0));
    }

    #[test]
    fn what_cannot_be_taken_is_named() {
        let says = |cameras: &[&str], files: &[(&str, &str)], keypoints: &str, message: &str| {
            let root = folder(cameras, files);
            assert_eq!(open(root.path(), keypoints, &RecordingOptions::default()).unwrap_err(), message);
        };
        let (one, json) = (deeplabcut(1.0), mediapipe());
        says(
            &["cam1"],
            &[("a.csv", "a,b\n1,2\n")],
            "keypoints/a.csv",
            "`R/keypoints/a.csv` is no keypoint file of a known kind; known: Caliscope, DeepLabCut, MMPose, COCO results, MediaPipe",
        );
        says(
            &["cam1", "cam2"],
            &[("cam1.csv", &one), ("cam2.json", &json)],
            "keypoints",
            "`R/keypoints/cam1.csv` and `R/keypoints/cam2.json` have other keypoints",
        );
        says(
            &["cam1", "cam2"],
            &[("cam1_a.csv", &one), ("cam1_b.csv", &one)],
            "keypoints",
            "`R/keypoints/cam1_a.csv` and `R/keypoints/cam1_b.csv` are both of camera `cam1`",
        );
        let header = one.split("\n0,").next().unwrap();
        says(&["cam1"], &[("cam1.csv", header)], "keypoints", "`R/keypoints/cam1.csv` holds no frame");
    }
}
