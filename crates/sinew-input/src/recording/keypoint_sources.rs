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
use crate::folder_contents::is_video;
use crate::input_error::InputError;
use crate::{Error, files};
use sinew_formats::keypoint_table::{Frames, TableCamera};
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_formats::{Layout, camera_name};
use sinew_formats::{caliscope_xy, coco_results, keypoint_formats};
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
    /// What is odd about its file.
    pub warnings: Vec<String>,
    place: SourcePlace,
}

enum SourcePlace {
    Folder(Folder),
    Table { file: PathBuf, frames: Frames, layout: Option<Layout>, in_image_shares: bool, leaves_out_nobody: bool },
}

impl KeypointSource {
    /// Frames in memory of the camera of that name.
    #[must_use]
    pub fn given(name: &str, frames: Frames, layout: Option<Layout>) -> Self {
        let place =
            SourcePlace::Table { file: name.into(), frames, layout, in_image_shares: false, leaves_out_nobody: false };
        Self { name: name.into(), warnings: vec![], place }
    }

    /// Keypoints of a camera of that name; coordinates that are shares of the image become pixels of `camera`.
    ///
    /// # Errors
    /// Files without a frame number or twice for a frame, no files.
    pub fn keypoints(self, name: &str, camera: Option<&Camera>) -> Result<KeypointCamera, Error> {
        match self.place {
            SourcePlace::Folder(folder) => Ok(KeypointCamera::folder(listing::files(folder, name, "keypoint files")?)),
            SourcePlace::Table { file, frames, in_image_shares, leaves_out_nobody, .. } => {
                if frames.is_empty() && !leaves_out_nobody {
                    return Err(InputError::NoFrames { file }.into());
                }
                let files = CameraFiles::one_file(name, &file, frames.keys().copied(), leaves_out_nobody);
                Ok(KeypointCamera::table(files, frames, camera.filter(|_| in_image_shares)))
            }
        }
    }

    /// Whether coordinates are shares of the image.
    #[must_use]
    pub const fn in_image_shares(&self) -> bool {
        matches!(self.place, SourcePlace::Table { in_image_shares: true, .. })
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
        let source = |folder: Folder| KeypointSource {
            name: folder.name.clone(),
            warnings: vec![],
            place: SourcePlace::Folder(folder),
        };
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

/// Frames per second by the times in the keypoints, where a file has such: Caliscope's. A whole number where one is within half a percent, else two decimals.
///
/// # Errors
/// A folder or file that cannot be read.
pub fn stated_rate(keypoints: &Path) -> Result<Option<f64>, Error> {
    let files =
        if keypoints.is_file() { vec![(stem(keypoints), keypoints.to_owned())] } else { table_files(keypoints)? };
    for (_, file) in files {
        if !caliscope_xy::recognises(&files::read_beginning(&file)?) {
            continue;
        }
        let text = files::read_text(&file, MAX_TEXT_BYTES)?;
        let rate = caliscope_xy::read(&file.display().to_string(), &text, 1.0)?.rate_hz;
        let rounded = |rate: f64| {
            if (rate.round() / rate - 1.0).abs() < 0.005 { rate.round() } else { (100.0 * rate).round() / 100.0 }
        };
        return Ok(rate.map(rounded).filter(|rate| *rate > 0.0));
    }
    Ok(None)
}

/// What is said of a file that is of no format with many frames.
#[must_use]
pub fn refused(file: &Path, beginning: &str) -> InputError {
    if keypoint_formats::is_frame(beginning) {
        return InputError::FileForFolder { file: file.to_owned(), many: "keypoints", is_video: false };
    }
    InputError::unknown_keypoint_file(file)
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
    let mut is_empty = true;
    for path in entries(folder)? {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let lone = if path.is_dir() { entries(&path).unwrap_or_default() } else { vec![path.clone()] };
        let mut files = lone.into_iter().filter(|file| file.is_file() && has_extension(file.as_os_str(), &EXTENSIONS));
        let (Some(file), None) = (files.next(), files.next()) else { continue };
        let beginning = files::read_beginning(&file)?;
        // A list of one image's people, beside others of its camera.
        let is_image = !path.is_dir() && keypoint_formats::is_frame(&beginning);
        if keypoint_formats::recognised(&beginning).is_some() && !is_image {
            is_empty &= coco_results::is_empty_list(&beginning);
            found.push((if path.is_dir() { name } else { stem(&path) }, file));
        }
    }
    // Empty lists alone are of no known kind.
    Ok(if is_empty { vec![] } else { found })
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
        return Err(refused(file, &text).into());
    }
    let table = keypoint_formats::read(&file.display().to_string(), &text, confidence_scale)?;
    let named = |camera: Option<usize>, else_named: &str| {
        camera.and_then(|camera| calibrated.get(camera)).map_or_else(|| else_named.to_owned(), Clone::clone)
    };
    let mut warnings: Vec<String> = table.warnings.iter().map(ToString::to_string).collect();
    let (in_image_shares, leaves_out_nobody) = (table.in_image_shares, table.leaves_out_nobody);
    let source = |camera: TableCamera| {
        let name = match &camera.name {
            Some(number) => named(camera_name::numbered(number, calibrated), number),
            None => named(camera_name::held(label, calibrated), label),
        };
        let (file, layout, frames) = (file.to_owned(), table.layout.clone(), camera.frames);
        let place = SourcePlace::Table { file, frames, layout, in_image_shares, leaves_out_nobody };
        KeypointSource { name, warnings: std::mem::take(&mut warnings), place }
    };
    Ok(table.cameras.into_iter().map(source).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::survey::survey;
    use crate::recording::{Recording, RecordingOptions};

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
            let all = open(root.path(), keypoints, &RecordingOptions::default()).unwrap();
            assert_eq!(all.frames(), 4..6);
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
    fn times_say_the_frame_rate() {
        let rate = |text: &str| {
            let root = folder(&["cam_1"], &[("xy_POSE.csv", text)]);
            let [folder, file] = ["keypoints", "keypoints/xy_POSE.csv"].map(|name| root.path().join(name));
            assert_eq!(stated_rate(&folder).unwrap(), stated_rate(&file).unwrap());
            stated_rate(&file).unwrap()
        };
        let row = |frame: u32, time_s: f64| format!("{frame},1,0,{time_s},11,101,51\n");
        let header = CALISCOPE.lines().next().unwrap();
        let rows = |rate: f64| format!("{header}\n{}{}", row(4, 100.0), row(104, 100.0 + 100.0 / rate));
        assert_eq!([29.98, 59.94, 12.34].map(|hz| rate(&rows(hz))), [Some(30.0), Some(60.0), Some(12.34)]);
        assert_eq!((rate(CALISCOPE), rate(&deeplabcut(1.0))), (Some(10.0), None));
    }

    #[test]
    fn files_without_people_belong_to_the_recording() {
        let coco = |ids: &[u32]| {
            let entry = |id: &u32| {
                format!("{{\"image_id\":{id},\"category_id\":1,\"keypoints\":[{}]}}", vec!["5,6,0.5"; 17].join(","))
            };
            format!("[{}]", ids.iter().map(entry).collect::<Vec<_>>().join(","))
        };
        let (first, second) = (coco(&[0, 1, 5]), coco(&[2, 3]));
        let files = [("C1.json", first.as_str()), ("C2.json", &second), ("C3.json", "[]")];
        let root = folder(&["C1", "C2", "C3"], &files);
        let mut recording = open(root.path(), "keypoints", &RecordingOptions::default()).unwrap();
        assert_eq!((recording.frames(), recording.cameras().len()), (0..6, 3));
        assert_eq!(recording.folders()[2], root.path().join("keypoints/C3.json"));
        for number in 0..6 {
            recording.people(number).unwrap();
        }
        let wanted = [
            "camera C1: 3 of 6 frames have no person (first: 2)",
            "camera C2: 4 of 6 frames have no person (first: 0)",
            "camera C3: 6 of 6 frames have no person (first: 0)",
        ];
        assert_eq!(recording.oddities(), wanted);
        let shown = survey(&root.path().join("keypoints"), &RecordingOptions::default()).unwrap();
        let rows: Vec<_> = shown.cameras.iter().map(|c| (c.name.as_str(), c.files, c.first, c.end, c.empty)).collect();
        assert_eq!(rows, [("C1", 3, 0, 6, 3), ("C2", 2, 0, 6, 4), ("C3", 0, 0, 6, 6)]);
        let alone = folder(&["C1"], &[("C1.json", "[]"), ("notes.txt", "")]);
        assert!(
            open(alone.path(), "keypoints", &RecordingOptions::default())
                .unwrap_err()
                .contains("no keypoint file of a known kind")
        );
    }

    #[test]
    fn a_file_an_image_lies_in_folders_of_the_cameras() {
        let person = format!(
            "{{\"keypoints\":[{}],\"keypoint_scores\":[{}]}}",
            vec!["[7,8]"; 17].join(","),
            vec!["0.9"; 17].join(",")
        );
        let image = format!("[{person}]");
        let files =
            [("C1/000.json", image.as_str()), ("C1/001.json", "[]"), ("C2/000.json", "[]"), ("C2/001.json", &image)];
        let root = folder(&["C1", "C2"], &files);
        let mut recording = open(root.path(), "keypoints", &RecordingOptions::default()).unwrap();
        assert_eq!((recording.frames(), recording.layout().name.as_str()), (0..2, "COCO_17"));
        assert_eq!(seen(&mut recording, 0), [("C1".into(), Some([7.0, 8.0])), ("C2".into(), None)]);
        let loose = folder(&["C1", "C2"], &[("C1_000.json", image.as_str()), ("C1_001.json", &image)]);
        let error = open(loose.path(), "keypoints", &RecordingOptions::default()).unwrap_err();
        assert_eq!(error, "`R/keypoints` holds 2 keypoint files itself; expected a folder for each camera");
        let unknown = folder(&["C1"], &[("C1_000.json", "{\"joints\":[]}"), ("C1_001.json", "{}")]);
        let error = open(unknown.path(), "keypoints", &RecordingOptions::default()).unwrap_err();
        assert!(error.starts_with("`R/keypoints/C1_000.json` is no keypoint file of a known kind"), "{error}");
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
            "`R/keypoints/a.csv` is no keypoint file of a known kind; known: Caliscope, DeepLabCut, MMPose, RTMLib, AlphaPose, COCO results, MediaPipe; OpenPose and MMPose with a file a frame, in a folder a camera",
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
