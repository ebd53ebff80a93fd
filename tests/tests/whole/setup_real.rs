//! The set-up pass on a real recording of four cameras. Skipped where the shared data are missing.

use sinew::formats::openpose::detections;
use sinew::formats::trc::{self, Trc};
use sinew::input::recording::{Recording, RecordingOptions};
use sinew::observe::association;
use sinew::observe::association::following::{Following, follow};
use sinew::observe::cameras::triangulate::{Config, Seen, triangulate};
use sinew::setup::{self, Setup, SetupRequest};
use sinew_tests::data::shared;
use std::path::{Path, PathBuf};

fn data() -> Option<PathBuf> {
    shared("pose2sim_single")
}

fn open(data: &Path, folder: &str, cameras: Option<&[&str]>) -> Recording {
    let cameras = cameras.map(|names| names.iter().map(|n| (*n).to_owned()).collect());
    let options = RecordingOptions { layout: Some("BODY_25B".into()), cameras, ..RecordingOptions::default() };
    Recording::open(&data.join("Calib.toml"), &data.join("T01_BalancingTrial").join(folder), &options).unwrap()
}

fn reference(data: &Path, name: &str) -> Trc {
    let name = format!("S00_P00_T01_BalancingTrial_0-100{name}.trc");
    let text = std::fs::read_to_string(data.join("T01_BalancingTrial/pose-3d").join(&name)).unwrap();
    trc::read(&name, &text).unwrap()
}

fn set_up(
    recording: &mut Recording,
    frames: std::ops::Range<u64>,
    request: &SetupRequest,
) -> (Setup, Vec<setup::SetupWarning>) {
    let (cameras, layout) = (recording.cameras().to_vec(), recording.layout().clone());
    let frames = frames.map(|n| Ok::<_, sinew::Error>((n, detections(&recording.frame(n)?))));
    setup::set_up(&cameras, &layout, request, frames).unwrap()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn the_reference_recipe_reproduces_the_unfiltered_reference() {
    let Some(data) = data() else { return };
    let mut recording = open(&data, "pose-associated", None);
    let reference = reference(&data, "");
    let config = Config::reference_recipe();
    let mut equal = 0;
    for frame in 0..100 {
        let views = detections(&recording.frame(frame).unwrap());
        for (m, name) in reference.header.markers.iter().enumerate() {
            let k = recording.layout().index(name).unwrap();
            let seen: Vec<Seen<'_>> = recording
                .cameras()
                .iter()
                .zip(&views)
                .filter_map(|(camera, people)| {
                    let d = people.first()?[k]?;
                    Some(Seen { camera, pixel: d.pixel, confidence: d.confidence })
                })
                .collect();
            let expected = reference.point_in_world(usize::try_from(frame).unwrap(), m).unwrap();
            let close = triangulate(&seen, &config).is_some_and(|found| distance(found.point, expected) < 1e-9);
            equal += usize::from(close);
        }
    }
    println!("{equal} of 2100 points equal to 1e-9 m");
    assert!(equal >= 2094);
}

/// In this recording the tracked man is the first person of every file in which they are found; in frame 37 a camera breaks them in two.
#[test]
fn the_man_is_distinguished_from_the_bystanders() {
    let Some(data) = data() else { return };
    let mut recording = open(&data, "pose", None);
    let cameras = recording.cameras().to_vec();
    let mut following = Following::default();
    for frame in 0..100 {
        let people = recording.frame(frame).unwrap();
        let found = follow(&mut following, &cameras, &detections(&people), None, &association::Config::default());
        for (c, people) in people.iter().enumerate() {
            let him = people.iter().find(|p| p.index == 0).map(|p| &p.keypoints);
            let seen: Vec<_> = found.people[c].iter().map(|d| d.map(|d| d.pixel)).collect();
            let whole = him.is_none_or(|him| {
                him.iter().zip(&seen).all(|(k, s)| k.is_none_or(|k| k.confidence < 0.2 || *s == Some([k.x, k.y])))
            });
            assert!(whole, "frame {frame}, camera {c}");
        }
    }
}

#[test]
fn the_set_up_finds_offsets_sizes_and_a_pose() {
    let Some(data) = data() else { return };
    for folder in ["pose", "pose-associated"] {
        let mut recording = open(&data, folder, None);
        let (found, warnings) = set_up(&mut recording, 0..60, &SetupRequest::default());
        println!("{}", found.to_toml().unwrap());
        let lengths = [
            ("thigh", found.proportions.thigh, 0.416),
            ("shin", found.proportions.shin, 0.408),
            ("upper arm", found.proportions.upper_arm, 0.279),
            ("forearm", found.proportions.forearm, 0.252),
            ("shoulders", 2.0 * found.proportions.shoulder_half_width, 0.334),
            ("hips", 2.0 * found.proportions.hip_half_width, 0.204),
        ];
        for (name, found, expected) in lengths {
            assert!((found - expected).abs() < 0.02, "{name} {found} m, the reference has {expected} m");
        }
        let offsets = [[20.0, 4.5], [-5.0, -3.0], [13.0, 11.0], [2.0, -8.0]];
        for (camera, expected) in found.camera.iter().zip(offsets) {
            let apart = (camera.offset_px[0] - expected[0]).hypot(camera.offset_px[1] - expected[1]);
            assert!(apart < 10.0, "{}: {:?}", camera.name, camera.offset_px);
            assert!((4.0..13.0).contains(&camera.sigma_px), "{}: {} px", camera.name, camera.sigma_px);
        }
        assert!((0.002..0.03).contains(&found.model_error_m));
        assert_eq!(found.up_axis, "+z");
        assert_eq!(warnings, []);
        assert_eq!(Setup::from_toml("setup.toml", &found.to_toml().unwrap()).unwrap(), found);
    }
}

/// Each frame fitted by itself, all cameras weighing the same: what a tracker starts from.
#[test]
fn poses_of_later_frames_lie_near_the_reference() {
    let Some(data) = data() else { return };
    let mut recording = open(&data, "pose-associated", None);
    let (cameras, layout) = (recording.cameras().to_vec(), recording.layout().clone());
    let (found, _) = set_up(&mut recording, 0..60, &SetupRequest::default());
    let reference = reference(&data, "_filt_butterworth");
    let tree = found.tree();
    let plan = sinew::body::Plan::with_all_points(&tree);
    let mut positions = vec![0.0; 3 * plan.points()];
    let mut errors = vec![];
    let mut former = None;
    for frame in 60..100 {
        let people = detections(&recording.frame(frame).unwrap());
        let sighted = people.into_iter().map(|mut p| if p.is_empty() { vec![] } else { p.swap_remove(0) }).collect();
        let pose = setup::pose_of(&found, &cameras, &layout, &sighted, former.as_deref()).unwrap();
        sinew::body::point_positions(&plan, sinew::core::lanes::Isa::baseline(), &pose, &mut positions);
        former = Some(pose);
        for joint in ["Shoulder", "Elbow", "Wrist", "Hip", "Knee", "Ankle"] {
            for side in ["L", "R"] {
                let name = format!("{side}{joint}");
                let (k, m) = (tree.point_index(&name).unwrap(), reference.marker_index(&name).unwrap());
                let expected = reference.point_in_world(usize::try_from(frame).unwrap(), m).unwrap();
                errors.push(distance([positions[3 * k], positions[3 * k + 1], positions[3 * k + 2]], expected));
            }
        }
    }
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    println!("frames 60-99: {:.1} mm from the filtered reference", 1e3 * mean);
    assert!(mean < 0.033, "{mean} m");
}

#[test]
fn one_camera_gives_a_pose_of_default_size() {
    let Some(data) = data() else { return };
    let mut recording = open(&data, "pose-associated", Some(&["cam_01"]));
    let (found, warnings) = set_up(&mut recording, 0..10, &SetupRequest::default());
    assert_eq!(warnings, [setup::SetupWarning::OneCamera]);
    assert_eq!(found.camera[0].offset_px, [0.0; 2]);
    let place = [found.start_pose[0], found.start_pose[1]];
    assert!((place[0] + 1.4).hypot(place[1]) < 0.6, "{place:?}");
}
