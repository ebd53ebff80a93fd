//! What is said of errors of readers and of folders that are there.

use insta::assert_snapshot;
use sinew::dynamics::primitives::file;
use sinew::formats::{Error, calibration, camera_name, frame_number, layout, openpose, tidy_csv};
use sinew_input::size_misfit::SizeMisfit;
use sinew_input::{FileError, InputError};
use sinew_motion::learn::LearnError;
use sinew_results::Occupied;
use sinew_words::{exit_code, help};
use std::io;

/// Exit code and advice.
fn said(error: impl Into<sinew_report::Error>) -> String {
    let error = error.into();
    format!("{}: {}", exit_code(&error), help(&error).unwrap_or_default())
}

fn apart(frames: [std::ops::Range<u64>; 2]) -> String {
    let [first, other] = frames;
    said(frame_number::common_range(&[("C1", first), ("C2", other)], false).unwrap_err())
}

#[test]
fn keypoints_of_another_layout() {
    let layout = layout::find("BODY_25").unwrap();
    let options = openpose::OpenposeOptions { frame: Some(12), layout: Some(&layout), ..Default::default() };
    let person = format!(r#"{{"people": [{{"pose_keypoints_2d": [{}]}}]}}"#, ["1"; 51].join(","));
    assert_snapshot!(said(openpose::read("cam01.0012.json", &person, &options).unwrap_err()), @"3: these keypoints may be COCO_17; set `--layout`");
    assert!(said(layout::find("halpe27").unwrap_err()).starts_with("2: a mapping file"));
}

#[test]
fn cameras_that_begin_or_end_apart() {
    assert_snapshot!(apart([0..900, 0..897]), @"3: pass `--trim` to use only the frames that all cameras have; if keypoints are numbered apart, `sinew sync --trim` finds by how much");
    assert_snapshot!(apart([0..60, 3000..3060]), @"3: they share no frame, so that `--trim` would leave nothing: if numbers run on from camera to camera, number each camera's frames by themselves, or say for each what is to be taken off: `--lag C2=3000`; if a camera saw nobody meanwhile, leave it out of `--cameras`");
    assert!(apart([60..120, 0..60]).contains("`--lag C2=-60`"));
    assert!(apart([0..60, 59..120]).starts_with("3: pass `--trim`"));
    let jumps = InputError::NumbersApart { first: 0, last: 9_000_000, files: 3, in_one_file: true };
    assert!(said(jumps).contains("`image_id`"));
}

#[test]
fn files_of_other_programs() {
    let comma = tidy_csv::read_numbers("a.csv", "time_s;x_m\n0,5;1,5\n").unwrap_err();
    assert_snapshot!(said(comma), @"3: export with an English locale, so that numbers read 0.5 and not 0,5");
    let calibration = calibration::read("cameras", "{\"cameras\": []}").unwrap_err();
    assert_snapshot!(said(calibration), @"3: is this the right file? calibrations of these programs are read as they are, and `sinew convert` writes one for another; of other programs write the numbers into a Calib.toml");
    let stranger = camera_name::match_names(&["cam4"], &["cam1", "cam2", "cam3"]).unwrap_err();
    assert!(said(stranger).contains("matched by name"));
    let count = Error::ImpossibleCount { place: Default::default(), claimed: 2, unit: "frames", bytes: 1100 };
    assert_snapshot!(said(count), @"3: the file is damaged or of another kind; write or copy it again");
}

#[test]
fn images_of_another_size() {
    let misfit = |fitting| {
        let (camera, file) = ("cam01".to_owned(), "cam01_000.png".to_owned());
        let misfit =
            SizeMisfit { camera, many: "masks", calibrated: [1088.0, 1920.0], scale: None, size: [540, 960], fitting };
        said(InputError::SizeMisfit { file, misfit })
    };
    assert_snapshot!(misfit(Some(0.5)), @"3: if the masks were resized after the calibration, set `mask_scale = 0.5`");
    assert_snapshot!(misfit(None), @"3: width and height do not fit together: are these the masks of cam01?");
}

#[test]
fn models_are_learned_again() {
    let model = file::read("m.json", "{\"format\": \"sinew motion model\", \"version\": 2}").unwrap_err();
    assert_snapshot!(said(LearnError::Model(model)), @"3: learn the model again with this version of sinew: `sinew learn primitives`");
    let rate = sinew::track::error::TrackError::ModelRate { format: file::FORMAT, learned: 20.0, tracked: 30.0 };
    assert_snapshot!(said(sinew::Error::from(rate)), @"2: learn it at that rate with `sinew learn primitives --fps 30`, or state the recording's with `--fps`");
}

#[test]
fn folders_and_files() {
    let taken = sinew_results::Error::OutputExists { path: "out".into(), found: Occupied::StoppedRun };
    assert_snapshot!(said(taken), @"5: continue it with `--resume`, choose another folder with `-o`, or replace what is there with `--force`");
    let missing = FileError::on("read", "src/lib.rs/below")(io::ErrorKind::NotADirectory.into());
    assert_snapshot!(said(missing), @"5: `src/lib.rs` is a file, not a folder");
}
