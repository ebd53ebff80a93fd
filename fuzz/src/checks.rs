//! One check per reader of `sinew-formats`.
//! Whatever the bytes, it returns a value or an error with words in it, and what its writer makes of a value it reads again.
//!
//! Used by the fuzz targets and, with the corpus, by an ordinary test (`tests/tests/whole/corpus.rs`).

use sinew::formats::keypoint_table::KeypointTable;
use sinew::formats::source_text::decode;
use sinew::formats::{
    Error, amc, asf, body_toml, bvh, c3d, calib_toml, calibration, caliscope_xy, camera_name, coco_results,
    deeplabcut_csv, frame_number, keypoint_formats, layout, live_frame, mask, mediapipe_json, mmpose_json, mot,
    openpose, osim_model, picture, point_mapping, rtmlib_json, tidy_csv, trc,
};
use std::fmt::Display;

/// Larger inputs are refused before they are decoded.
const LIMIT: u64 = 1 << 24;

/// The text of an input, if it is one; an error has a message and perhaps advice.
fn text<'a>(name: &str, data: &'a [u8]) -> Option<&'a str> {
    accepted(decode(name, data, LIMIT))
}

fn accepted<T>(result: Result<T, Error>) -> Option<T> {
    match result {
        Ok(value) => Some(value),
        Err(error) => {
            assert!(!error.to_string().is_empty());
            assert!(sinew_words::help(&error.into()).is_none_or(|help| !help.is_empty()));
            None
        }
    }
}

/// Warnings can be shown.
fn shown(warnings: &[impl Display]) {
    assert!(warnings.iter().all(|warning| !warning.to_string().is_empty()));
}

/// What a writer wrote must be read without an error.
fn reread<T>(written: &[u8], read: impl Fn(&str, &str) -> Result<T, Error>) {
    let text = std::str::from_utf8(written).expect("writers write UTF-8");
    if let Err(error) = read("written", text) {
        panic!("{error} in what was written:\n{text}");
    }
}

/// Keypoint files, with and without a layout.
pub fn openpose(data: &[u8]) {
    let Some(text) = text("cam1.0001.json", data) else { return };
    let layout = layout::find("BODY_25B").ok();
    for options in [
        openpose::OpenposeOptions::default(),
        openpose::OpenposeOptions { frame: Some(1), layout: layout.as_ref(), confidence_scale: 100.0 },
    ] {
        if let Some(frame) = accepted(openpose::read("cam1.0001.json", text, &options)) {
            let mut tally = openpose::Tally::default();
            tally.add(1, Some(&frame));
            shown(&tally.warnings("cam1"));
            let keypoints = frame.people.iter().flat_map(|person| person.keypoints.iter().flatten());
            for keypoint in keypoints {
                assert!(keypoint.x.is_finite() && keypoint.y.is_finite());
                assert!((0.0..=1.0).contains(&keypoint.confidence));
            }
        }
    }
}

/// Lines of a live run.
pub fn live_frame(data: &[u8]) {
    let Some(text) = text("line 1", data) else { return };
    let Some(frame) = accepted(live_frame::read("line 1", text, &openpose::OpenposeOptions::default())) else { return };
    let mut names: Vec<&str> = frame.cameras.iter().map(|(name, _)| name.as_str()).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count, "every camera is there once");
    let people = frame.cameras.iter().filter_map(|(_, seen)| seen.as_ref()).flat_map(|seen| &seen.people);
    for keypoint in people.flat_map(|person| person.keypoints.iter().flatten()) {
        assert!(keypoint.x.is_finite() && keypoint.y.is_finite() && (0.0..=1.0).contains(&keypoint.confidence));
    }
}

/// Files of many frames, by each reader and by the one that recognises them.
fn keypoint_file(data: &[u8], read: fn(&str, &str, f64) -> Result<KeypointTable, Error>) {
    let Some(text) = text("cam1.json", data) else { return };
    for read in [read, keypoint_formats::read] {
        for scale in [1.0, 100.0] {
            let Some(table) = accepted(read("cam1.json", text, scale)) else { continue };
            shown(&table.warnings);
            let frames = table.cameras.iter().flat_map(|camera| &camera.frames);
            for (number, frame) in frames {
                let mut tally = openpose::Tally::default();
                tally.add(*number, Some(frame));
                shown(&tally.warnings("cam1"));
                for person in &frame.people {
                    let points = table.layout.as_ref().map_or(person.keypoints.len(), |layout| layout.points.len());
                    assert_eq!(person.keypoints.len(), points);
                    for keypoint in person.keypoints.iter().flatten() {
                        assert!(keypoint.x.is_finite() && keypoint.y.is_finite());
                        assert!(keypoint.confidence > 0.0 && keypoint.confidence <= 1.0);
                    }
                }
            }
        }
    }
}

/// Caliscope's tables.
pub fn caliscope_xy(data: &[u8]) {
    keypoint_file(data, caliscope_xy::read);
}

/// COCO results and AlphaPose.
pub fn coco_results(data: &[u8]) {
    keypoint_file(data, coco_results::read);
}

/// DeepLabCut's tables.
pub fn deeplabcut_csv(data: &[u8]) {
    keypoint_file(data, deeplabcut_csv::read);
}

/// Landmarks of MediaPipe.
pub fn mediapipe_json(data: &[u8]) {
    keypoint_file(data, mediapipe_json::read);
}

/// Predictions of MMPose.
pub fn mmpose_json(data: &[u8]) {
    keypoint_file(data, mmpose_json::read);
    let Some(text) = text("a.json", data) else { return };
    let _ = accepted(keypoint_formats::read_frame("a.json", text, &openpose::OpenposeOptions::default()));
}

/// What RTMLib returns.
pub fn rtmlib_json(data: &[u8]) {
    keypoint_file(data, rtmlib_json::read);
}

/// Calibrations.
pub fn calib_toml(data: &[u8]) {
    let Some(text) = text("Calib.toml", data) else { return };
    if let Some(calibration) = accepted(calib_toml::read("Calib.toml", text)) {
        shown(&calibration.warnings);
        reread(calib_toml::write(&calibration.cameras).as_bytes(), calib_toml::read);
    }
}

/// Calibrations of any program.
pub fn calibration(data: &[u8]) {
    use calibration::CalibrationFormat;
    let Some(text) = text("cameras", data) else { return };
    let Some(read) = accepted(calibration::read("cameras", text)) else { return };
    shown(&read.warnings);
    // Beyond these numbers other units overflow, and last pixels are lost to rounding.
    let is_ordinary = |camera: &sinew::observe::Camera| {
        let [width, height] = camera.image_size_px;
        let numbers = [&camera.translation[..], &[camera.intrinsics.fx, camera.intrinsics.fy]].concat();
        let is_whole = |pixels: f64| pixels.fract() == 0.0 && (1.0..1e9).contains(&pixels);
        is_whole(width) && is_whole(height) && numbers.iter().all(|number| number.abs() < 1e100)
    };
    if read.cameras.iter().all(is_ordinary) {
        for format in [
            CalibrationFormat::Pose2Sim,
            CalibrationFormat::Caliscope,
            CalibrationFormat::Anipose,
            CalibrationFormat::OpenCv,
            CalibrationFormat::Qualisys,
        ] {
            if let Some(written) = accepted(calibration::write(&read.cameras, format)) {
                assert_eq!(calibration::recognised("written", &written), Ok(format));
                reread(written.as_bytes(), calibration::read);
            }
        }
    }
}

/// Layout mapping files.
pub fn layout(data: &[u8]) {
    let Some(text) = text("layout.toml", data) else { return };
    accepted(layout::find(text));
    if let Some(layout) = accepted(layout::read("layout.toml", text)) {
        assert!(layout.left_right_pairs().len() <= layout.points.len());
    }
}

/// Body files.
pub fn body_toml(data: &[u8]) {
    let Some(text) = text("body.toml", data) else { return };
    if let Some(body) = accepted(body_toml::read("body.toml", text)) {
        reread(body_toml::write(&body.tree, body.flesh.as_ref()).as_bytes(), body_toml::read);
    }
}

/// TRC files.
pub fn trc(data: &[u8]) {
    let Some(text) = text("a.trc", data) else { return };
    if let Some(trc) = accepted(trc::read("a.trc", text)) {
        shown(&trc.warnings);
        let mut written = Vec::new();
        if trc::write(&mut written, &trc).is_ok() {
            reread(&written, trc::read);
        }
    }
}

/// C3D files; their points come back from what is written of them.
pub fn c3d(data: &[u8]) {
    let Some(file) = accepted(c3d::read("a.c3d", data)) else { return };
    shown(&file.warnings);
    assert!(file.frames.iter().all(|frame| frame.len() == file.header.markers.len()));
    let positions = |file: &c3d::C3d| -> Vec<Vec<Option<[f64; 3]>>> {
        // What is written has four bytes.
        let short = |position: [f64; 3]| position.map(|x| f64::from(x as f32));
        file.frames.iter().map(|frame| frame.iter().map(|point| point.map(|p| short(p.position))).collect()).collect()
    };
    let mut written = Vec::new();
    let before = positions(&file);
    if c3d::write(&mut written, &file.header, &before).is_ok() {
        let again = c3d::read("written", &written).unwrap_or_else(|error| panic!("{error} in what was written"));
        assert_eq!((again.header.first_frame, positions(&again)), (file.header.first_frame, before));
    }
    let mut whole = Vec::new();
    if c3d::write_whole(&mut whole, &file).is_ok() {
        let again = c3d::read("written", &whole).unwrap_or_else(|error| panic!("{error} in what was written"));
        assert_eq!((again.frames.len(), &again.header.markers), (file.frames.len(), &file.header.markers));
    }
}

/// Mappings of points.
pub fn point_mapping(data: &[u8]) {
    let Some(text) = text("names.toml", data) else { return };
    if let Some(points) = accepted(point_mapping::read("names.toml", text)) {
        assert!(!points.is_empty() && points.iter().all(|point| !point.from.is_empty()));
    }
}

/// Models of OpenSim.
pub fn osim_model(data: &[u8]) {
    let Some(text) = text("a.osim", data) else { return };
    if let Some(model) = accepted(osim_model::read("a.osim", text)) {
        assert!(!model.bodies.is_empty());
    }
}

/// MOT files.
pub fn mot(data: &[u8]) {
    let Some(text) = text("a.mot", data) else { return };
    if let Some(mot) = accepted(mot::read("a.mot", text)) {
        shown(&mot.warnings);
        let mut written = Vec::new();
        let mut write = || -> std::io::Result<()> {
            mot::write_header(&mut written, &mot.title, &mot.columns, mot.rows.len() as u32)?;
            let mut rows = mot.time_s.iter().zip(&mot.rows);
            rows.try_for_each(|(&time_s, row)| mot::write_row(&mut written, time_s, row))
        };
        if write().is_ok() {
            reread(&written, mot::read);
        }
    }
}

/// BVH files.
pub fn bvh(data: &[u8]) {
    let Some(text) = text("a.bvh", data) else { return };
    if let Some(bvh) = accepted(bvh::read("a.bvh", text)) {
        shown(&bvh.warnings);
        let mut written = Vec::new();
        if bvh::write(&mut written, &bvh).is_ok() {
            reread(&written, bvh::read);
        }
    }
}

/// A skeleton, and after a line `%%%` a motion.
pub fn asf_amc(data: &[u8]) {
    let Some(text) = text("a.asf", data) else { return };
    let (skeleton, motion) = text.split_once("%%%\n").unwrap_or((text, ""));
    let Some(skeleton) = accepted(asf::read("a.asf", skeleton)) else { return };
    let points = skeleton.point_names().len();
    assert_eq!(skeleton.bone_ends_m(&vec![0.0; skeleton.channels()]).len(), points);
    if let Some(motion) = accepted(amc::read("a.amc", motion, &skeleton)) {
        shown(&motion.warnings);
        for frame in &motion.frames {
            assert_eq!(skeleton.bone_ends_m(&frame.values).len(), points);
        }
    }
}

/// Masks.
pub fn mask(data: &[u8]) {
    if let Some(read) = accepted(mask::read("cam1_0001.png", data)) {
        assert!(read.between <= (read.image.width() * read.image.height()) as u64);
        let mut written = Vec::new();
        mask::write(&mut written, &read.image).expect("a mask that was read is written");
        assert_eq!(mask::read("written", &written).expect("what was written is read").image, read.image);
    }
}

/// Pictures.
pub fn picture(data: &[u8]) {
    if let Some(read) = accepted(picture::read("cam1_0001.jpg", data)) {
        assert_eq!(read.pixels.len(), read.width * read.height);
        let mut written = Vec::new();
        picture::write_png(&mut written, &read).expect("a picture that was read is written");
        assert_eq!(picture::read("written", &written).expect("what was written is read"), read);
    }
}

/// Tables, as cells and as numbers.
pub fn tidy_csv(data: &[u8]) {
    let Some(text) = text("a.csv", data) else { return };
    accepted(tidy_csv::read_cells("a.csv", text));
    accepted(tidy_csv::read_numbers("a.csv", text));
}

/// Names of files and cameras, one a line.
pub fn file_names(data: &[u8]) {
    let Some(text) = text("names", data) else { return };
    let names: Vec<&str> = text.lines().collect();
    accepted(frame_number::order(&names));
    let (folders, cameras) = names.split_at(names.len() / 2);
    for name in folders {
        for found in [camera_name::held(name, cameras), camera_name::numbered(name, cameras)] {
            assert!(found.is_none_or(|index| index < cameras.len()));
        }
    }
    if let Some(matching) = accepted(camera_name::match_names(folders, cameras)) {
        shown(&matching.warnings(folders, cameras));
    }
}
