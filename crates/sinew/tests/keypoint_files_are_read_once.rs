//! Keypoint files are read once in a run, whatever passes it makes over them.

use sinew::run::listener::Deaf;
use sinew::run::{Request, settings, track};
use sinew_formats::openpose::OpenposePerson;
use sinew_formats::{calib_toml, openpose};
use sinew_simulate::recording::{Script, SyntheticRecording};
use std::fs;

/// Files by which the layout is guessed are read before there is a layout that they could be checked against.
const MOST: f64 = 1.1;

#[test]
fn keypoint_files_are_read_once() {
    let walk = SyntheticRecording::new(&Script { duration_s: 8.0, ..Script::default() }, 1).unwrap();
    let root = tempfile::tempdir().unwrap();
    let at = |name: &str| root.path().join(name);
    fs::write(at("Calib.toml"), calib_toml::write(&walk.cameras)).unwrap();
    let mut files = 0;
    for (camera, frames) in walk.cameras.iter().zip(&walk.keypoints) {
        let folder = at("pose").join(format!("{}_json", camera.name));
        fs::create_dir_all(&folder).unwrap();
        for (number, keypoints) in frames.iter().enumerate() {
            let person = OpenposePerson { index: 0, keypoints: keypoints.clone() };
            fs::write(folder.join(format!("{number:05}.json")), openpose::write(&[person])).unwrap();
            files += 1;
        }
    }
    let given = [
        ("calibration", at("Calib.toml").display().to_string()),
        ("keypoints", at("pose").display().to_string()),
        ("out", at("out").display().to_string()),
        ("fps", "30".to_owned()),
        ("smooth", "true".to_owned()),
        ("chains", "8".to_owned()),
        ("updates", "2".to_owned()),
        ("burn_in", "0".to_owned()),
        ("patience", "1".to_owned()),
    ];
    let resolved = settings::settings(&given, None).unwrap();
    track(&resolved, &Request::default(), &Deaf::default()).unwrap();
    let read = resolved.read_before.files_read();
    assert!(read >= files, "{read} of {files}");
    assert!(read as f64 <= MOST * f64::from(files as u32), "{read} readings of {files} files");
}
