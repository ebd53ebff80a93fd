//! A recording of Caliscope's from its own two files, in one command.

use crate::common::{QUICK, Trial};
use sinew::formats::trc;
use std::fs;

/// First frames of the recording that are tracked.
const FRAMES: usize = 12;

#[test]
fn two_files_of_caliscope_are_tracked_in_one_command() {
    let Some(data) = sinew_tests::data::shared("caliscope_gesture") else { return };
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let file = |flag: &str, name: &str| format!("--{flag}={}", data.join(name).display());
    let inputs = [file("calibration", "camera_array.toml"), file("keypoints", "xy_HOLISTIC.csv")];
    let frames = format!("--frames=0..{FRAMES}");
    let rest = ["track", &inputs[0], &inputs[1], &frames, "--fps=30", "--up=auto", "--people=1", "-oout"];
    let output = trial.run(&[&rest[..], &QUICK, &["--no-progress"]].concat());
    // Legs that cameras hardly see may leave chains apart, which code 4 says.
    assert!(matches!(output.status.code(), Some(0 | 4)), "{}", trial.printed(&output));
    let markers = fs::read_to_string(trial.path("out/markers.trc")).unwrap();
    let markers = trc::read("markers.trc", &markers).unwrap();
    assert_eq!(markers.frames.len(), FRAMES);
    let at = |name: &str, frame: usize| markers.point_in_world(frame, markers.marker_index(name).unwrap()).unwrap();
    for frame in 0..FRAMES {
        let [shoulder, hip] = ["RShoulder", "RHip"].map(|name| at(name, frame));
        assert!(shoulder[2] - hip[2] > 0.3, "frame {frame}: {shoulder:?} over {hip:?}");
    }
    // Caliscope's own triangulation: distances do not depend on the world.
    let theirs = fs::read_to_string(data.join("xyz_HOLISTIC.csv")).unwrap();
    let header: Vec<&str> = theirs.lines().next().unwrap().split(',').collect();
    let column = |name: &str| header.iter().position(|known| *known == name).unwrap();
    let [frame, point, x, y, z] = ["sync_index", "point_id", "x_coord", "y_coord", "z_coord"].map(column);
    let place = |wanted_frame: usize, wanted: usize| {
        theirs.lines().skip(1).find_map(|line| {
            let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
            let is_it = cells[frame] as usize == wanted_frame && cells[point] as usize == wanted;
            is_it.then(|| [cells[x], cells[y], cells[z]])
        })
    };
    let apart = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
    let mut compared = 0;
    for number in 0..FRAMES {
        // From the left shoulder to both wrists and the right hip.
        for (name, index) in [("LWrist", 15), ("RWrist", 16), ("RHip", 24)] {
            let (Some(from), Some(to)) = (place(number, 11), place(number, index)) else { continue };
            let (ours, theirs) = (apart(at("LShoulder", number), at(name, number)), apart(from, to));
            assert!((ours - theirs).abs() < 0.08, "frame {number}: {name} {ours:.3} m, Caliscope has {theirs:.3} m");
            compared += 1;
        }
    }
    assert!(compared >= FRAMES, "{compared}");
}
