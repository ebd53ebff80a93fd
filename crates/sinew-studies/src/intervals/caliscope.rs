//! A recording that no tuning has touched, in the files that `sinew track` reads.
//!
//! `camera_array.toml` and `xy_HOLISTIC.csv` of Caliscope become `Calib.toml` and keypoints of OpenPose.
//!
//! No axis of its world points up. `xyz_HOLISTIC.csv`, points in space as Caliscope has them, says where up is, and nothing else is taken from it.

use super::protocol::{LAYOUT, Recording, UNTOUCHED};
use crate::support::outcome::Outcome;
use crate::support::program::write_recording;
use crate::support::statistics::median;
use sinew::formats::keypoint_table::TableCamera;
use sinew::formats::openpose::Keypoint;
use sinew::formats::rotation::{Matrix, about_axis, product, transpose};
use sinew::formats::{calib_toml, calibration, caliscope_xy, layout, tidy_csv};
use sinew::observe::Camera;
use sinew_simulate::recording::keypoint_files;
use std::fs;
use std::path::Path;

/// Names of the cameras here, in the order of the numbers that the files give them.
const CAMERAS: [&str; 4] = ["cam_1", "cam_2", "cam_3", "cam_4"];

/// Frames that all cameras share.
const FRAMES: usize = 267;

/// Confidence of what was seen: the files have none.
const CONFIDENCE: f64 = 0.9;

const SHOULDERS: [usize; 2] = [11, 12];
const HIPS: [usize; 2] = [23, 24];

/// Some columns of a table.
fn columns<const N: usize>(path: &Path, names: [&str; N]) -> Outcome<Vec<[f64; N]>> {
    let name = path.display().to_string();
    let table = tidy_csv::read_numbers(&name, &fs::read_to_string(path)?)?;
    let mut places = [0; N];
    for (place, column) in places.iter_mut().zip(names) {
        *place = table.column(column).ok_or_else(|| format!("{name}: no column {column}"))?;
    }
    Ok(table.rows.iter().map(|row| places.map(|place| row[place])).collect())
}

/// From the middle of the hips to that of the shoulders, by the medians over all frames.
fn up(points: &[[f64; 4]]) -> [f64; 3] {
    let place = |point: usize, axis: usize| {
        median(points.iter().filter(|row| row[0] as usize == point).map(|row| row[1 + axis]))
    };
    let both = |points: [usize; 2], axis: usize| points.map(|point| place(point, axis)).iter().sum::<f64>();
    [0, 1, 2].map(|axis: usize| both(SHOULDERS, axis) - both(HIPS, axis))
}

/// The rotation of the world that takes a direction to z.
fn upright([x, y, z]: [f64; 3]) -> Matrix {
    product(&about_axis(1, -x.hypot(y).atan2(z)), &about_axis(2, -y.atan2(x)))
}

/// The cameras, in a world that is turned.
fn cameras(path: &Path, turn: &Matrix) -> Outcome<Vec<Camera>> {
    let mut cameras = calibration::read(&path.display().to_string(), &fs::read_to_string(path)?)?.cameras;
    cameras.sort_by(|a, b| a.name.cmp(&b.name));
    if cameras.len() != CAMERAS.len() {
        return Err(format!("{}: {} cameras", path.display(), cameras.len()).into());
    }
    for (camera, name) in cameras.iter_mut().zip(CAMERAS) {
        camera.name = name.into();
        camera.rotation = product(&camera.rotation, &transpose(turn));
    }
    Ok(cameras)
}

/// Of each camera and frame the keypoints of the layout, by name: MediaPipe's foot index is taken for the big toe.
fn keypoints(path: &Path) -> Outcome<Vec<Vec<Vec<Option<Keypoint>>>>> {
    let table = caliscope_xy::read(&path.display().to_string(), &fs::read_to_string(path)?, 1.0)?;
    let theirs = table.layout.ok_or("a table without a layout")?;
    let places: Vec<Option<usize>> =
        layout::find(LAYOUT)?.points.iter().map(|name| theirs.index(name.as_deref()?)).collect();
    let frame = |camera: &TableCamera, number: usize| {
        let person = camera.frames.get(&(number as u64)).and_then(|frame| frame.people.first());
        let seen = |place: &Option<usize>| {
            let keypoint = person?.keypoints.get((*place)?).copied().flatten()?;
            Some(Keypoint { confidence: CONFIDENCE, ..keypoint })
        };
        places.iter().map(seen).collect()
    };
    Ok(table.cameras.iter().map(|camera| (0..FRAMES).map(|number| frame(camera, number)).collect()).collect())
}

/// Writes the recording into a folder.
pub(super) fn converted(source: &Path, folder: &Path) -> Outcome<()> {
    let points = columns(&source.join("xyz_HOLISTIC.csv"), ["point_id", "x_coord", "y_coord", "z_coord"])?;
    let cameras = cameras(&source.join("camera_array.toml"), &upright(up(&points)))?;
    let keypoints = keypoints(&source.join("xy_HOLISTIC.csv"))?;
    write_recording(folder, &calib_toml::write(&cameras), "pose", keypoint_files(&cameras, &keypoints))
}

/// The recording, where [`converted`] writes it.
pub(super) fn recording(folder: &Path) -> Recording {
    Recording {
        calibration: folder.join("Calib.toml"),
        keypoints: folder.join("pose"),
        cameras: CAMERAS,
        files: CAMERAS,
        fps: 30.0,
        frames: FRAMES,
        cells: "caliscope",
        bounds: UNTOUCHED,
        each: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::formats::rotation::apply;

    /// The points of the files, by their numbers there.
    #[test]
    fn keypoints_come_from_the_table() {
        let Some(data) = sinew_tests::data::shared("caliscope_gesture") else { return };
        let table = data.join("xy_HOLISTIC.csv");
        let found = keypoints(&table).unwrap();
        let layout = layout::find(LAYOUT).unwrap();
        let names = [(0, "Nose"), (12, "RShoulder"), (25, "LKnee"), (32, "RBigToe")];
        let mut compared = 0;
        for [camera, frame, point, x, y] in
            columns(&table, ["port", "sync_index", "point_id", "img_loc_x", "img_loc_y"]).unwrap()
        {
            let Some((_, name)) = names.iter().find(|(number, _)| *number == point as usize) else { continue };
            let own = found[camera as usize][frame as usize][layout.index(name).unwrap()];
            assert_eq!(own, Some(Keypoint { x, y, confidence: CONFIDENCE }), "{camera} {frame} {name}");
            compared += 1;
        }
        let seen =
            |name: &str| found.iter().flatten().filter(|frame| frame[layout.index(name).unwrap()].is_some()).count();
        assert_eq!(compared, names.iter().map(|(_, name)| seen(name)).sum::<usize>());
        assert!(compared > FRAMES, "{compared}");
    }

    #[test]
    fn up_is_turned_to_z() {
        for up in [[0.0, 0.0, 2.0], [2.0, 0.0, 0.0], [-0.4, 1.2, -1.1], [0.0, 0.0, -1.0]] {
            let [x, y, z] = apply(&upright(up), up);
            let length = up.iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!(x.abs() < 1e-15 && y.abs() < 1e-15 && (z - length).abs() < 1e-15, "{up:?}: {x} {y} {z}");
        }
    }
}
