//! `sinew track --write-calibration`: what is written shows points where the refined cameras do, and nothing is overwritten by mistake.

use crate::common::trial;
use sinew::formats::calib_toml;
use sinew::observe::Camera;
use sinew::setup::Setup;
use sinew_setup::refined_calibration::RefinedCalibration;
use std::fs;
use std::path::Path;

fn cameras(path: &Path) -> Vec<Camera> {
    calib_toml::read("Calib.toml", &fs::read_to_string(path).unwrap()).unwrap().cameras
}

/// The farthest that two sets of cameras show points apart, pixels.
fn apart(some: &[Camera], others: &[Camera]) -> f64 {
    assert_eq!(some.len(), others.len());
    let points = (0..27).map(|k| [0.5 * f64::from(k % 3) - 0.5, f64::from(k / 3 % 3) - 1.0, 0.9 * f64::from(k / 9)]);
    let pixel = |camera: &Camera, point| camera.project(point).pixel().unwrap();
    let distance = |(a, b): (&Camera, &Camera), point| {
        let ([u, v], [x, y]) = (pixel(a, point), pixel(b, point));
        (u - x).hypot(v - y)
    };
    points.flat_map(|point| some.iter().zip(others).map(move |pair| distance(pair, point))).fold(0.0, f64::max)
}

#[test]
fn a_written_calibration_shows_points_where_the_refined_cameras_do() {
    let trial = trial(1.0);
    trial.edit(&trial.path("Calib.toml"), |text| {
        text.replacen("distortions = [0.0, 0.0, 0.0, 0.0]", "distortions = [-0.02, 0.003, 1e-4, -2e-4]", 1)
    });
    let output = trial.track(&["--cameras", "C1,C2,C3", "--write-calibration", "refined.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", trial.printed(&output));
    let printed = trial.printed(&output);
    assert!(printed.contains("the calibration as the set-up refined it is in refined.toml"), "{printed}");
    assert!(printed.contains("not in the set-up and as they were: C4"), "{printed}");

    let setup = Setup::from_toml("", &fs::read_to_string(trial.path("out/setup.toml")).unwrap()).unwrap();
    let (calibrated, written) = (cameras(&trial.path("Calib.toml")), cameras(&trial.path("refined.toml")));
    assert!(apart(&written, &setup.as_they_are(&calibrated, 1.0)) < 1e-9);
    assert!(apart(&written[..3], &calibrated[..3]) > 0.1 && apart(&written[3..], &calibrated[3..]) < 1e-9);

    // Images of half the size, and a set-up that knows offsets alone: the file is in pixels of the calibrated size.
    let offsets_alone = Setup { lasting: None, ..setup.clone() };
    let half = |cameras: &[Camera]| cameras.iter().map(|camera| camera.resized(0.5)).collect::<Vec<_>>();
    for setup in [&setup, &offsets_alone] {
        let refined = RefinedCalibration::read(&trial.path("Calib.toml"), setup, 0.5).unwrap();
        assert!(apart(&half(&refined.cameras), &setup.as_they_are(&half(&calibrated), 1.0)) < 1e-9);
    }
}

#[test]
fn a_file_that_exists_stays() {
    let trial = trial(0.2);
    fs::write(trial.path("there.toml"), "").unwrap();
    let refused = |file: &str| trial.track_printed(&["--write-calibration", file]);
    insta::assert_snapshot!("there", refused("there.toml"));
    insta::assert_snapshot!("input", refused("Calib.toml"));
    insta::assert_snapshot!("result", refused("out/setup.toml"));
    insta::assert_snapshot!("no_folder", refused("nowhere/refined.toml"));
    assert!(!trial.path("out").exists());
}
