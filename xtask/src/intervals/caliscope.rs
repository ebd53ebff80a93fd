//! A recording that no tuning has touched, in the files that `sinew track` reads.
//!
//! `camera_array.toml` and `xy_HOLISTIC.csv` of Caliscope become `Calib.toml` and keypoints of OpenPose.
//!
//! No axis of its world points up. `xyz_HOLISTIC.csv`, points in space as Caliscope has them, says where up is, and nothing else is taken from it.

use super::left_out::median;
use super::protocol::{LAYOUT, Recording, UNTOUCHED};
use crate::outcome::Outcome;
use sinew::formats::openpose::Keypoint;
use sinew::formats::rotation::{Matrix, about_axis, product, transpose};
use sinew::formats::{calib_toml, layout, tidy_csv};
use sinew::observe::Camera;
use sinew_simulate::recording::keypoint_files;
use std::fs;
use std::path::Path;

/// Cameras by the number that the files give them.
const CAMERAS: [&str; 4] = ["cam_1", "cam_2", "cam_3", "cam_4"];

/// Frames that all cameras share.
const FRAMES: usize = 267;

/// Confidence of what was seen: the files have none.
const CONFIDENCE: f64 = 0.9;

/// MediaPipe's numbers of the keypoints that the layout has as well. Its foot index is taken for the big toe.
const POINTS: [(&str, usize); 21] = [
    ("Nose", 0),
    ("LEye", 2),
    ("REye", 5),
    ("LEar", 7),
    ("REar", 8),
    ("LShoulder", 11),
    ("RShoulder", 12),
    ("LElbow", 13),
    ("RElbow", 14),
    ("LWrist", 15),
    ("RWrist", 16),
    ("LHip", 23),
    ("RHip", 24),
    ("LKnee", 25),
    ("RKnee", 26),
    ("LAnkle", 27),
    ("RAnkle", 28),
    ("LHeel", 29),
    ("RHeel", 30),
    ("LBigToe", 31),
    ("RBigToe", 32),
];
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
        median(points.iter().filter(|row| row[0] as usize == point).map(|row| row[1 + axis]).collect())
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
    let (name, array) = (path.display().to_string(), fs::read_to_string(path)?.parse::<toml::Table>()?);
    let mut named = toml::Table::new();
    for (number, camera) in CAMERAS.iter().enumerate() {
        let found = array.get("cameras").and_then(|cameras| cameras.get(number.to_string()));
        named.insert((*camera).into(), found.ok_or_else(|| format!("{name}: no camera {number}"))?.clone());
    }
    let mut cameras = calib_toml::read(&name, &toml::to_string(&named)?)?.cameras;
    for camera in &mut cameras {
        camera.rotation = product(&camera.rotation, &transpose(turn));
    }
    Ok(cameras)
}

/// Of each camera and frame the keypoints of the layout.
fn keypoints(path: &Path) -> Outcome<Vec<Vec<Vec<Option<Keypoint>>>>> {
    let layout = layout::find(LAYOUT)?;
    let place = |number: usize| layout.index(POINTS.iter().find(|(_, point)| *point == number)?.0);
    let mut seen = vec![vec![vec![None; layout.points.len()]; FRAMES]; CAMERAS.len()];
    for [camera, frame, point, x, y] in columns(path, ["port", "sync_index", "point_id", "img_loc_x", "img_loc_y"])? {
        let own = seen.get_mut(camera as usize).and_then(|frames| frames.get_mut(frame as usize));
        let own = own.ok_or_else(|| format!("{}: camera {camera}, frame {frame}", path.display()))?;
        if let Some(place) = place(point as usize) {
            own[place] = Some(Keypoint { x, y, confidence: CONFIDENCE });
        }
    }
    Ok(seen)
}

/// Writes the recording into a folder.
pub(super) fn converted(source: &Path, folder: &Path) -> Outcome<()> {
    let points = columns(&source.join("xyz_HOLISTIC.csv"), ["point_id", "x_coord", "y_coord", "z_coord"])?;
    let cameras = cameras(&source.join("camera_array.toml"), &upright(up(&points)))?;
    fs::create_dir_all(folder)?;
    fs::write(folder.join("Calib.toml"), calib_toml::write(&cameras))?;
    for (name, text) in keypoint_files(&cameras, &keypoints(&source.join("xy_HOLISTIC.csv"))?) {
        let path = folder.join("pose").join(name);
        fs::create_dir_all(path.parent().unwrap_or(folder))?;
        fs::write(path, text)?;
    }
    Ok(())
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

    #[test]
    fn up_is_turned_to_z() {
        for up in [[0.0, 0.0, 2.0], [2.0, 0.0, 0.0], [-0.4, 1.2, -1.1], [0.0, 0.0, -1.0]] {
            let [x, y, z] = apply(&upright(up), up);
            let length = up.iter().map(|x| x * x).sum::<f64>().sqrt();
            assert!(x.abs() < 1e-15 && y.abs() < 1e-15 && (z - length).abs() < 1e-15, "{up:?}: {x} {y} {z}");
        }
    }
}
