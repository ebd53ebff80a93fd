//! Readers against the check values of the shared recordings.

mod common;

use common::{data, rows, text};
use sinew_formats::calibration::{self, CalibrationFormat};
use sinew_formats::{amc, asf, bvh, calib_toml, camera_name, frame_number, layout, mot, openpose, trc};
use std::collections::BTreeMap;

/// Six decimals are given.
const TOLERANCE_M: f64 = 1e-6;

fn check_point(what: &str, found: [f64; 3], expected: [f64; 3], tolerance: f64) {
    for (a, b) in found.into_iter().zip(expected) {
        assert!((a - b).abs() <= tolerance, "{what}: {found:?}, expected {expected:?}");
    }
}

fn numbers(cells: &[String]) -> [f64; 3] {
    [0, 1, 2].map(|i| cells[i].parse().unwrap())
}

#[test]
fn bone_ends_of_every_acclaim_recording_match_the_table() {
    let Some(folder) = data("cmu_amc") else { return };
    let mut recordings = BTreeMap::new();
    let mut checked = 0;
    for row in rows(&text(&folder.join("expected_joints.csv"))) {
        let (skeleton, motion) = recordings.entry(row[0].clone()).or_insert_with(|| {
            let subject = row[0].split('_').next().unwrap();
            let names = [subject, subject.trim_end_matches('1')].map(|name| folder.join(format!("{name}.asf")));
            let path = names.iter().find(|path| path.exists()).unwrap();
            let skeleton = asf::read(path.to_str().unwrap(), &text(path)).unwrap();
            let motion = amc::read(&row[0], &text(&folder.join(format!("{}.amc", row[0]))), &skeleton).unwrap();
            (skeleton, motion)
        });
        let frame: u64 = row[1].parse().unwrap();
        let values = &motion.frames.iter().find(|f| f.number == frame).unwrap().values;
        let index = skeleton.point_names().iter().position(|name| *name == row[2]).unwrap();
        check_point(&row[..3].join(" "), skeleton.bone_ends_m(values)[index], numbers(&row[3..]), TOLERANCE_M);
        checked += 1;
    }
    assert_eq!((recordings.len(), checked), (10, 10 * 5 * 31));
    let frames = |name: &str| recordings[name].1.frames.len();
    assert_eq!(
        ["07_01", "07_02", "07_05", "09_06", "131_04", "135_06", "49_18", "49_19", "charleston1", "01_01"].map(frames),
        [316, 415, 517, 141, 1086, 3261, 1102, 957, 506, 2751]
    );
}

#[test]
fn joints_of_every_bvh_recording_match_the_table() {
    let Some(folder) = data("cmu_bvh") else { return };
    let mut recordings = BTreeMap::new();
    let mut checked = 0;
    for row in rows(&text(&folder.join("expected_joints.csv"))) {
        let file = recordings
            .entry(row[0].clone())
            .or_insert_with(|| bvh::read(&row[0], &text(&folder.join(&row[0]))).unwrap());
        let frame: usize = row[1].parse().unwrap();
        let points = file.positions(frame - 1).unwrap();
        let (_, found) = points.iter().find(|(name, _)| *name == row[2]).unwrap();
        check_point(&row[..3].join(" "), *found, numbers(&row[3..]), 1e-5);
        checked += 1;
    }
    assert_eq!(checked, 3 * 4 * 38);
    for (name, frames) in [("01_01.bvh", 2752), ("131_01.bvh", 994), ("scaled_131_01.bvh", 995)] {
        let file = &recordings[name];
        assert_eq!((file.frames.len(), file.joints.len(), file.channels()), (frames, 31, 96), "{name}");
        assert_eq!(file.warnings, []);
    }
    check_point("sample", recordings["131_01.bvh"].positions(0).unwrap()[0].1, [5.23, 16.9002, -33.8986], 1e-9);
}

#[test]
fn legs_of_the_bvh_conversion_agree_with_the_acclaim_original() {
    let (Some(amc_folder), Some(bvh_folder)) = (data("cmu_amc"), data("cmu_bvh")) else { return };
    let skeleton = asf::read("01.asf", &text(&amc_folder.join("01.asf"))).unwrap();
    let motion = amc::read("01_01.amc", &text(&amc_folder.join("01_01.amc")), &skeleton).unwrap();
    let converted = bvh::read("01_01.bvh", &text(&bvh_folder.join("01_01.bvh"))).unwrap();
    let knee = skeleton.point_names().iter().position(|name| *name == "lfemur").unwrap();
    let scale = skeleton.metres_per_unit();
    for k in (0..motion.frames.len()).step_by(50) {
        let points = converted.positions(k + 1).unwrap();
        let (_, expected) = points.iter().find(|(name, _)| name == "LeftLeg").unwrap();
        let found = skeleton.bone_ends_m(&motion.frames[k].values)[knee].map(|v| v / scale);
        check_point(&format!("frame {k}"), found, *expected, 1e-4);
    }
}

#[test]
fn cameras_stand_where_the_recording_says() {
    let Some(folder) = data("pose2sim_single") else { return };
    let calibration = calib_toml::read("Calib.toml", &text(&folder.join("Calib.toml"))).unwrap();
    assert_eq!(calibration.warnings, []);
    let expected = [
        ("cam_01", [1.460, -1.909, 1.897]),
        ("cam_02", [2.582, 0.707, 1.691]),
        ("cam_03", [-3.217, 2.231, 2.088]),
        ("cam_04", [-3.759, -1.416, 1.882]),
    ];
    assert_eq!(calibration.cameras.len(), expected.len());
    for (camera, (name, centre)) in calibration.cameras.iter().zip(expected) {
        assert_eq!(camera.name, name);
        let [r0, r1, r2] = camera.rotation;
        let t = camera.translation;
        let found = [0, 1, 2].map(|i| -(r0[i] * t[0] + r1[i] * t[1] + r2[i] * t[2]));
        check_point(name, found, centre, 5.1e-4);
    }
    let again = calib_toml::read("Calib.toml", &calib_toml::write(&calibration.cameras)).unwrap();
    for (a, b) in calibration.cameras.iter().zip(&again.cameras) {
        assert_eq!((a.intrinsics, a.lens, a.translation), (b.intrinsics, b.lens, b.translation));
        for (a, b) in a.rotation.iter().flatten().zip(b.rotation.iter().flatten()) {
            assert!((a - b).abs() <= 1e-15);
        }
    }
}

/// Pose2Sim divides distortions by 64 when it converts a calibration of Qualisys, and nothing else differs.
#[test]
fn the_calibration_of_qualisys_is_that_which_was_converted_but_for_the_lens() {
    let Some(folder) = data("pose2sim_single") else { return };
    let original = text(&folder.join("Calib.qca.txt"));
    assert_eq!(calibration::recognised("Calib.qca.txt", &original), Ok(CalibrationFormat::Qualisys));
    let original = calibration::read("Calib.qca.txt", &original).unwrap();
    let converted = calibration::read("Calib.toml", &text(&folder.join("Calib.toml"))).unwrap();
    assert_eq!((original.warnings, original.cameras.len()), (vec![], 4));
    for (a, b) in original.cameras.iter().zip(converted.cameras) {
        assert_eq!((&a.name, a.image_size_px, a.intrinsics), (&b.name, b.image_size_px, b.intrinsics));
        check_point(&a.name, a.centre(), b.centre(), 1e-7);
        for (a, b) in a.lens.coefficients().iter().zip(b.lens.coefficients()) {
            assert!((a - 64.0 * b).abs() < 1e-12, "{a} {b}");
        }
        let undistorted = sinew_observe::Camera { lens: b.lens, ..a.clone() };
        let [now, then] = [&undistorted, &b].map(|camera| camera.project([0.1, 0.2, 1.0]).pixel().unwrap());
        assert!((now[0] - then[0]).hypot(now[1] - then[1]) < 1e-4, "{now:?} {then:?}");
    }
}

/// The points that Caliscope triangulated lie where its cameras saw them.
#[test]
fn cameras_of_caliscope_show_what_it_triangulated() {
    let Some(folder) = data("caliscope_gesture") else { return };
    let array = text(&folder.join("camera_array.toml"));
    assert_eq!(calibration::recognised("camera_array.toml", &array), Ok(CalibrationFormat::Caliscope));
    let read = calibration::read("camera_array.toml", &array).unwrap();
    assert_eq!(read.warnings, []);
    let names: Vec<&str> = read.cameras.iter().map(|camera| &camera.name[..]).collect();
    assert_eq!(names, ["cam_0", "cam_1", "cam_2", "cam_3"]);
    let table = |name: &str, header: &str| -> Vec<Vec<f64>> {
        let text = text(&folder.join(name));
        assert!(text.starts_with(header), "{name}");
        text.lines().skip(1).take(4000).map(cells).collect()
    };
    let seen = table("xy_HOLISTIC.csv", "sync_index,port,frame_index,frame_time,point_id,img_loc_x,img_loc_y");
    let space = table("xyz_HOLISTIC.csv", ",sync_index,point_id,x_coord,y_coord,z_coord");
    let mut distances: Vec<f64> = seen
        .iter()
        .filter_map(|row| {
            let point = space.iter().find(|point| point[1] == row[0] && point[2] == row[4])?;
            let shown = read.cameras[row[1] as usize].project([point[3], point[4], point[5]]).pixel()?;
            Some((shown[0] - row[5]).hypot(shown[1] - row[6]))
        })
        .collect();
    distances.sort_by(f64::total_cmp);
    assert!(distances.len() > 500, "{}", distances.len());
    assert!(distances[distances.len() / 2] < 12.0, "{}", distances[distances.len() / 2]);
}

fn cells(line: &str) -> Vec<f64> {
    line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()
}

#[test]
fn every_keypoint_file_is_read() {
    let Some(folder) = data("pose2sim_single/T01_BalancingTrial") else { return };
    let body_25b = layout::find("BODY_25B").unwrap();
    for (part, people) in [("pose", 2..=3), ("pose-associated", 0..=1)] {
        let mut cameras: Vec<String> = std::fs::read_dir(folder.join(part))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        cameras.sort();
        let matching = camera_name::match_names(&cameras, &["cam_01", "cam_02", "cam_03", "cam_04"]).unwrap();
        assert_eq!(matching.pairs, [(0, 0), (1, 1), (2, 2), (3, 3)]);
        for camera in &cameras {
            let files: Vec<String> = std::fs::read_dir(folder.join(part).join(camera))
                .unwrap()
                .map(|entry| entry.unwrap().file_name().into_string().unwrap())
                .collect();
            let order = frame_number::order(&files).unwrap();
            assert_eq!(order.iter().map(|(frame, _)| *frame).collect::<Vec<_>>(), (0..100).collect::<Vec<_>>());
            let mut tally = openpose::Tally::default();
            for (number, index) in order {
                let path = folder.join(part).join(camera).join(&files[index]);
                let options = openpose::OpenposeOptions {
                    frame: Some(number),
                    layout: Some(&body_25b),
                    ..openpose::OpenposeOptions::default()
                };
                let frame = openpose::read(&files[index], &text(&path), &options).unwrap();
                tally.add(number, Some(&frame));
                if camera == "cam01_json" {
                    assert!(people.contains(&frame.people.len()), "{part} {number}: {}", frame.people.len());
                }
                if (part, camera.as_str(), number) == ("pose", "cam01_json", 0) {
                    let shoulder = frame.people[0].keypoints[body_25b.index("LShoulder").unwrap()].unwrap();
                    assert_eq!((shoulder.x, shoulder.y, shoulder.confidence), (521.038, 494.789, 0.71398));
                }
            }
            for warning in tally.warnings(camera) {
                assert!(warning.to_string().contains("have no person"), "{warning}");
            }
        }
    }
}

#[test]
fn reference_trajectories_are_read() {
    let Some(folder) = data("pose2sim_single/T01_BalancingTrial/pose-3d") else { return };
    let name = "S00_P00_T01_BalancingTrial_0-100.trc";
    let file = trc::read(name, &text(&folder.join(name))).unwrap();
    assert_eq!((file.frames.len(), file.header.markers.len(), file.header.rate_hz), (100, 21, 60.0));
    assert_eq!(file.warnings, []);
    let point = |frame: usize, marker: &str| file.frames[frame].points[file.marker_index(marker).unwrap()].unwrap();
    for (frame, marker, expected) in [
        (0, "RHip", [-0.06497, 0.90150, -1.40059]),
        (0, "Head", [-0.05644, 1.70242, -1.25171]),
        (0, "LWrist", [0.35463, 0.93776, -1.45809]),
        (0, "RAnkle", [0.04379, 0.14388, -1.59508]),
        (99, "RHip", [-0.05951, 0.90846, -0.65934]),
        (99, "LWrist", [0.45750, 1.54753, -0.38715]),
    ] {
        check_point(marker, point(frame, marker), expected, 5.1e-6);
    }
    let mut out = Vec::new();
    trc::write(&mut out, &file).unwrap();
    assert_eq!(trc::read(name, std::str::from_utf8(&out).unwrap()).unwrap(), file);
    for path in std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
        let file = trc::read(path.to_str().unwrap(), &text(&path)).unwrap();
        assert_eq!(file.frames.len(), 100, "{}", path.display());
    }
}

#[test]
fn coordinates_of_inverse_kinematics_are_read() {
    let Some(folder) = data("pose2sim_single/T01_BalancingTrial/opensim-ik") else { return };
    for path in std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()) {
        let file = mot::read(path.to_str().unwrap(), &text(&path)).unwrap();
        assert_eq!((file.rows.len(), file.in_degrees, file.title.as_str()), (100, true, "Coordinates"));
        assert_eq!(file.warnings, [], "{}", path.display());
        assert_eq!(file.columns[3], "pelvis_tx");
    }
}
