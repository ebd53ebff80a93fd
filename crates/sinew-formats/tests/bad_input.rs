//! What a user reads when an input is bad: one test per row of the table of bad inputs.

use insta::assert_snapshot;
use sinew_formats::*;

fn keypoints(text: &str) -> Error {
    openpose::read("cam01.0012.json", text, &openpose::OpenposeOptions::default()).unwrap_err()
}

fn one_person(numbers: &str) -> String {
    format!("{{\"people\": [{{\"pose_keypoints_2d\": [{numbers}]}}]}}")
}

fn calibration(field: &str, value: &str) -> Result<calib_toml::Calibration, Error> {
    let mut fields = vec![
        ("size", "[1088, 1920]"),
        ("matrix", "[[1681.5, 0, 533.0], [0, 1681.0, 948.0], [0, 0, 1]]"),
        ("distortions", "[-0.1, 0.2, 0.001, 0.002]"),
        ("rotation", "[1.5, 1.0, -0.5]"),
        ("translation", "[0.5, 1.0, 3.0]"),
    ];
    fields.retain(|(name, _)| *name != field);
    fields.push((field, value));
    let lines: Vec<String> = fields.iter().map(|(name, value)| format!("{name} = {value}")).collect();
    calib_toml::read("Calib.toml", &format!("[cam1]\n{}\n", lines.join("\n")))
}

fn trc(change: impl Fn(&str) -> String) -> Result<trc::Trc, Error> {
    let text = "PathFileType\t4\t(X/Y/Z)\ta.trc\n\
        DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n\
        60\t60\t2\t2\tm\t60\t1\t2\nFrame#\tTime\tRHip\t\t\tNose\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n\
        1\t0.0\t1\t2\t3\t4\t5\t6\n2\t0.5\t1\t2\t3\t7\t8\t9\n";
    trc::read("a.trc", &change(text))
}

#[test]
fn empty_people_or_no_file() {
    let mut tally = openpose::Tally::default();
    let empty = openpose::read("a.json", "{\"people\": []}", &openpose::OpenposeOptions::default()).unwrap();
    let person = openpose::read("a.json", &one_person("1, 2, 0.5"), &openpose::OpenposeOptions::default()).unwrap();
    for frame in 0..900 {
        let seen = match frame {
            118 | 200..=230 => Some(&empty),
            300..=304 => None,
            _ => Some(&person),
        };
        tally.add(frame, seen);
    }
    assert_snapshot!(tally.warnings("cam2")[0], @"camera cam2: 37 of 900 frames have no person (first: 118)");
}

#[test]
fn null_or_nan_coordinates() {
    let mut tally = openpose::Tally::default();
    let text = one_person("null, 2, 0.5, 1, NaN, 0.5, null, null, 1, 3, 4, 0.9");
    let frame = openpose::read("a.json", &text, &openpose::OpenposeOptions::default()).unwrap();
    (0..4).for_each(|number| tally.add(number, Some(&frame)));
    assert_snapshot!(tally.warnings("cam1")[0], @"12 points have no coordinates but confidence > 0; treated as missing");
}

#[test]
fn origin_with_confidence() {
    let mut tally = openpose::Tally::default();
    let frame =
        openpose::read("a.json", &one_person("0, 0, 0.8, 0, 0, 0"), &openpose::OpenposeOptions::default()).unwrap();
    assert!(frame.people[0].keypoints[0].is_some() && frame.people[0].keypoints[1].is_none());
    (0..40).for_each(|number| tally.add(number, Some(&frame)));
    assert_snapshot!(tally.warnings("cam1")[0], @"point at exactly (0,0) with confidence 0.8 in 40 frames; is this your tracker's mark for 'not found'?");
}

#[test]
fn confidence_out_of_range() {
    assert_snapshot!(keypoints(&one_person("1, 2, 87.0")), @"cam01.0012.json: confidence 87.0 found; expected 0 to 1; set `confidence_scale = 100`");
    assert_snapshot!(keypoints(&one_person("1, 2, -0.1")), @"cam01.0012.json: confidence -0.1 found; expected 0 to 1; negative confidences have no meaning");
}

#[test]
fn fewer_numbers_than_the_layout_has() {
    let layout = layout::find("body25").unwrap();
    let options =
        openpose::OpenposeOptions { frame: Some(12), layout: Some(&layout), ..openpose::OpenposeOptions::default() };
    let error = openpose::read("cam01.0012.json", &one_person(&["1"; 51].join(",")), &options).unwrap_err();
    assert_snapshot!(error, @"cam01.0012.json (frame 12): 51 numbers, layout `BODY_25` needs 75");
    assert_snapshot!(keypoints(&one_person("1, 2")), @"cam01.0012.json: 2 numbers; keypoints are triples x, y, confidence");
}

#[test]
fn unknown_layout() {
    assert_snapshot!(layout::find("halpe27").unwrap_err(), @"unknown layout `halpe27`; known: BODY_25B, BODY_25, HALPE_26, COCO_17, COCO_133, HALPE_136, MEDIAPIPE_33; or give a mapping file; did you mean `HALPE_26`?");
}

#[test]
fn cameras_that_begin_or_end_apart() {
    let ranges = [("cam1", 0..900), ("cam3", 0..897)];
    let error = frame_number::common_range(&ranges, false).unwrap_err();
    assert_snapshot!(error, @"cam1 has 900 frames, cam3 has 897; difference 3");
    assert_eq!(frame_number::common_range(&ranges, true), Ok(0..897));
}

#[test]
fn cameras_whose_numbers_run_on() {
    let error = frame_number::common_range(&[("C1", 0..60), ("C2", 3000..3060)], false).unwrap_err();
    assert_snapshot!(error, @"C1 has 60 frames, C2 has 60; difference 0, but the first frames differ by +3000 and the last by +3000");
}

#[test]
fn keypoint_files_of_unknown_keys() {
    let error = |text: &str| keypoint_formats::read("cam1.json", text, 1.0).unwrap_err();
    assert_snapshot!(error("{\"frames\": [{\"frame\": 3, \"pose_world_landmarks\": [{\"x\": 1, \"y\": 2, \"visibility\": 1}]}]}"), @"cam1.json (frame 3): the keys `pose_world_landmarks`; expected landmarks under `pose_landmarks`, `poseLandmarks`, `landmarks`, `landmark`, `pose`, `poses`, `people`, `keypoints`");
    assert_snapshot!(error("[{\"image_id\": -1, \"keypoints\": [1, 2, 1]}]"), @r#"cam1.json (entry 1): image_id = -1; must be a whole number from 0, or a name with the frame, as "0012.jpg""#);
    assert_snapshot!(error("{\"joints\": [1, 2]}"), @"cam1.json: the beginning is that of no known keypoint file; expected a file of Caliscope, DeepLabCut, MMPose, RTMLib, AlphaPose, COCO results, MediaPipe; OpenPose and MMPose with a file a frame, in a folder a camera");
}

#[test]
fn entries_that_are_no_people() {
    let coco =
        "[{\"image_id\": 1, \"category_id\": 18, \"keypoints\": [1, 2, 1]}, {\"image_id\": 1, \"keypoints\": null}]";
    let table = keypoint_formats::read("cam1.json", coco, 1.0).unwrap();
    assert_snapshot!(table.warnings[0], @"cam1.json: 1 entry is left out: `category_id` is not 1, a person's");
    assert_snapshot!(table.warnings[1], @"cam1.json: 1 entry is left out: without `keypoints`");
    let animals =
        "scorer,D,D,D,D\nindividuals,a,a,single,single\nbodyparts,nose,nose,box,box\ncoords,x,y,x,y\n0,1,2,3,4\n";
    let table = keypoint_formats::read("cam1.csv", animals, 1.0).unwrap();
    assert_snapshot!(table.warnings[0], @"cam1.csv: `single` (points: 1) is left out: it is DeepLabCut's name for points of no individual");
}

#[test]
fn dropped_frames() {
    let frames: Vec<u64> = (0..400).filter(|frame| ![45, 46, 301].contains(frame)).collect();
    assert_snapshot!(frame_number::holes("cam2", &frames).unwrap(), @"cam2 lacks frames 45, 46, 301");
}

#[test]
fn two_files_of_one_frame() {
    let error = frame_number::order(&["cam1.1.json", "cam1.10.json", "cam1_b.0010.json"]).unwrap_err();
    assert_snapshot!(error, @"two files claim frame 10: cam1.10.json, cam1_b.0010.json");
    assert_snapshot!(frame_number::order(&["keypoints.json"]).unwrap_err(), @"keypoints.json: no frame number in the file name; expected a name like `cam01.0034.json`");
}

#[test]
fn time_that_goes_back() {
    let error = trc(|text| text.replace("2\t0.5", "2\t-0.04")).unwrap_err();
    assert_snapshot!(error, @"a.trc: time goes back at row 2: -0.04 after 0 s");
}

#[test]
fn cameras_without_calibration() {
    let error = camera_name::match_names(&["cam4_json"], &["cam1", "cam2", "cam3"]).unwrap_err();
    assert_snapshot!(error, @"no calibration for `cam4_json`; calibrated: cam1, cam2, cam3");
    let error = camera_name::match_names(&["cam1_json", "cam_01"], &["cam1"]).unwrap_err();
    assert_snapshot!(error, @"cameras `cam1_json` and `cam_01` have the same name but for punctuation, case and leading zeros");
    let matching = camera_name::match_names(&["cam1_json"], &["cam1", "cam2"]).unwrap();
    assert_snapshot!(matching.warnings(&["cam1_json"], &["cam1", "cam2"])[0], @"no keypoints for calibrated camera `cam2`; folders: cam1_json");
}

#[test]
fn millimetres_for_metres() {
    let cameras = calibration("translation", "[0, 0, 4200]").unwrap().cameras;
    assert_snapshot!(calib_toml::far_cameras(&cameras, 1.7).unwrap(), @"cameras stand 4200 units from the origin but the skeleton is 1.7 tall; are translations in millimetres?");
}

#[test]
fn impossible_intrinsics() {
    let matrix = |fx: &str, cx: &str| format!("[[{fx}, 0, {cx}], [0, 1681, 948], [0, 0, 1]]");
    let error = |fx, cx| calibration("matrix", &matrix(fx, cx)).unwrap_err();
    assert_snapshot!(error("0", "533"), @"Calib.toml:6 (cam1): fx = 0; must be positive");
    assert_snapshot!(error("-5", "533"), @"Calib.toml:6 (cam1): fx = -5; must be positive");
    assert_snapshot!(error("nan", "533"), @"Calib.toml (cam1): value out of range at line 6");
    assert_snapshot!(error("5", "9000"), @"Calib.toml:6 (cam1): cx = 9000; must be within one image of the image, -1088 to 2176");
}

#[test]
fn rotations_that_are_none() {
    let matrix = |off: f64| calibration("rotation", &format!("[[1, {off}, 0], [0, 1, 0], [0, 0, 1]]"));
    assert_eq!(matrix(1e-7).unwrap().warnings, []);
    assert_snapshot!(matrix(1e-4).unwrap().warnings[0], @"Calib.toml:6 (cam1): R'R differs from identity by 0.0001; repaired");
    assert_snapshot!(matrix(0.04).unwrap_err(), @"Calib.toml:6 (cam1): R'R differs from identity by 0.04");
    let mirror = calibration("rotation", "[[1, 0, 0], [0, 1, 0], [0, 0, -1]]").unwrap_err();
    assert_snapshot!(mirror, @"Calib.toml:6 (cam1): R is a mirror image (determinant -1); axes are left-handed");
}

#[test]
fn lenses_with_other_numbers_of_coefficients() {
    let of = |count: usize| format!("{:?}", vec![0.25; count]);
    assert_snapshot!(calibration("distortions", &of(12)).unwrap_err(), @"Calib.toml:6 (cam1): distortions = [0.25, 0.25, 0.25, 0.25, 0.25, 0.25, 0.2…; must be 4 or 5 numbers: k1, k2, p1, p2 and perhaps k3, or 8: k1, k2, p1, p2, k3, k4, k5, k6; later ones are thin prisms and tilt, which no lens here has: calibrate without them");
    let fisheye = format!("{}\nfisheye = true", of(5));
    assert_snapshot!(calibration("distortions", &fisheye).unwrap_err(), @"Calib.toml:6 (cam1): distortions = [0.25, 0.25, 0.25, 0.25, 0.25]; must be 4 numbers: k1, k2, k3, k4 of a fisheye lens");
}

#[test]
fn truncated_files() {
    let text = format!("{{\"people\": [{{\"pose_keypoints_2d\": [{}", "1.5,\n".repeat(1202));
    let padded = format!("{text}{}", " ".repeat(40_961 - text.len()));
    assert_snapshot!(keypoints(&padded), @"cam01.0012.json: ends inside an array at byte 40 961 (line 1203)");
    let error = calib_toml::read("Calib.toml", "[cam1]\nsize = [1088,").unwrap_err();
    assert_snapshot!(error, @"Calib.toml: ends inside an array at byte 20 (line 2)");
}

#[test]
fn text_that_is_no_text() {
    let error = source_text::decode("a.trc", b"1\n2\n3\n4\n5\n6\nMarqu\xE9\n", 1000).unwrap_err();
    assert_snapshot!(error, @"a.trc: byte 0xE9 at line 7 is not UTF-8; save as UTF-8");
    let marked = source_text::decode("a.json", b"\xEF\xBB\xBF{\r\n\"people\": []}\r\n", 1000).unwrap();
    assert!(openpose::read("a.json", marked, &openpose::OpenposeOptions::default()).is_ok());
    let error = tidy_csv::read_numbers("a.csv", "time_s;x_m\n0,5;1,5\n").unwrap_err();
    assert_snapshot!(error, @"a.csv:2 (time_s): `0,5` has a decimal comma; expected a decimal point");
}

#[test]
fn files_that_claim_too_much() {
    assert_snapshot!(keypoints(&"[".repeat(100_000)), @"cam01.0012.json:1: nested more than 100 deep");
    let deep = format!("a = {}", "[".repeat(100_000));
    assert!(calib_toml::read("Calib.toml", &deep).is_err());
    let error = source_text::check_size("a.json", 4_000_000_000, source_text::MAX_KEYPOINT_BYTES).unwrap_err();
    assert_snapshot!(error, @"a.json: the file has 4 GB; at most 17 MB are read");
    let error =
        trc(|text| format!("{}{}", text.replace("60\t2\t2", "60\t1000000000\t2"), "\n".repeat(11_770))).unwrap_err();
    assert_snapshot!(error, @"a.trc: file claims 10^9 frames, holds 12 kB");
    let channels = "HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1000000000 Xposition\n";
    assert_snapshot!(bvh::read("a.bvh", channels).unwrap_err(), @"a.bvh:5: CHANNELS = 1000000000; must be 0 to 6");
}

#[test]
fn keys_that_are_unknown_or_there_twice() {
    let body = |text: &str| body_toml::read("body.toml", text).unwrap_err();
    assert_snapshot!(body("[[link]]\nname = \"a\"\noffest = [0, 0, 0]\n"), @"body.toml:3: unknown key `offest`; did you mean `offset`?");
    assert_snapshot!(body("[[link]]\nname = \"a\"\nname = \"b\"\n"), @"body.toml:3: the key `name` is there twice");
    let error = calib_toml::read("Calib.toml", "[cam1]\nsize = [1, 1]\n[cam1]\nsize = [1, 1]\n").unwrap_err();
    assert_snapshot!(error, @"Calib.toml:3: the key `cam1` is there twice");
}

#[test]
fn numbers_out_of_range() {
    assert_snapshot!(keypoints("{\"people\": [\n{\"pose_keypoints_2d\":\n[1e999, 2, 0.5]}]}"), @"cam01.0012.json: value out of range at line 3");
    assert_snapshot!(keypoints("{\"people\": [\n{\"pose_keypoints_2d\":\n[Infinity, 2, 0.5]}]}"), @"cam01.0012.json: value out of range at line 3");
    assert_snapshot!(calibration("translation", "[inf, 0, 0]").unwrap_err(), @"Calib.toml (cam1): value out of range at line 6");
    assert_snapshot!(trc(|text| text.replace("\t7\t", "\t1e999\t")).unwrap_err(), @"a.trc: value out of range at line 8");
}

#[test]
fn odd_trajectory_files() {
    let warning = |change: &dyn Fn(&str) -> String| trc(change).unwrap().warnings[0].to_string();
    assert_eq!(trc(|text| text.replace("7\t8\t9", "\tnan\t")).unwrap().frames[1].points[1], None);
    assert_eq!(trc(|text| text.replace("Nose", "*60 é")).unwrap().header.markers[1], "*60 é");
    assert_snapshot!(warning(&|text| text.replace('\t', " ")), @"a.trc: spaces instead of tabs; names cannot contain spaces then");
    assert_snapshot!(warning(&|text| text.replace("X1", "X25")), @"a.trc: coordinate labels start with `X25` instead of `X1`; taken in order");
    assert_snapshot!(warning(&|text| text.replace("60\t2\t2", "60\t3\t2")), @"a.trc: NumFrames says 3, the file holds 2");
    assert_snapshot!(trc(|text| text.replace("9\n", "9\t10\n")).unwrap_err(), @"a.trc:8: 9 values; expected 8");
}

fn c3d_file(header: &c3d::C3dHeader) -> Vec<u8> {
    let mut out = Vec::new();
    c3d::write(&mut out, header, &[vec![Some([1.0, 2.0, 3.0]); 2], vec![None; 2]]).unwrap();
    out
}

#[test]
fn files_of_laboratories_that_are_damaged() {
    let header = c3d::C3dHeader::new(100.0, ["RHip", "Nose"].map(String::from).to_vec());
    let changed = |at: usize, bytes: &[u8]| {
        let mut file = c3d_file(&header);
        file[at..at + bytes.len()].copy_from_slice(bytes);
        c3d::read("a.c3d", &file)
    };
    let error = |at, bytes| changed(at, bytes).unwrap_err();
    let find = |text: &[u8]| c3d_file(&header).windows(text.len()).position(|window| window == text).unwrap();
    assert_snapshot!(c3d::read("a.c3d", b"PathFileType").unwrap_err(), @"a.c3d (byte 2): 0x61; expected 0x50, which marks a C3D file");
    assert_snapshot!(error(0, &[0]), @"a.c3d: the block of the parameters = 0; must be 1 or more");
    assert_snapshot!(error(515, &[87]), @"a.c3d: the processor = 87; must be 84 (Intel), 85 (DEC) or 86 (MIPS)");
    assert_snapshot!(error(12, &[0; 4]), @"a.c3d: the scale of the points = 0; must be a number other than 0");
    assert_snapshot!(error(4, &[7, 0, 1, 0, 2, 0, 0, 0, 0, 0, 0x80, 0xbf, 3, 0, 2, 0]), @"a.c3d: the number of analog samples = 7 in a frame, 2 of a channel; must be a multiple");
    assert_snapshot!(error(find(b"RATE") + 8, &[0, 0, 0x80, 0xff]), @"a.c3d: POINT:RATE = -inf; must be positive");
    assert_snapshot!(error(find(b"UNITS") + 10, b"f"), @"a.c3d: POINT:UNITS = f; must be m, cm or mm");
    assert_snapshot!(error(find(b"Y_SCREEN") + 13, b"up"), @"a.c3d: POINT:Y_SCREEN = up; must be +X, -X, +Y, -Y, +Z or -Z");
    assert_snapshot!(error(find(b"LABELS") + 8, &[3]), @"a.c3d (byte 630): the type of LABELS = 3; must be -1, 1, 2 or 4");
    assert_snapshot!(error(find(b"LABELS") + 6, &[5]), @"a.c3d (byte 628): behind LABELS comes byte 633; expected byte 643 or a later one, behind its values");
    let file = c3d_file(&header);
    let cut = |end: usize| c3d::read("a.c3d", &file[..end]).unwrap_err();
    assert_snapshot!(cut(300), @"a.c3d: ends inside the parameter section at byte 300");
    assert_snapshot!(cut(700), @"a.c3d: ends inside the parameter section at byte 700");
    assert_snapshot!(cut(1024 + 31), @"a.c3d: file claims 2 frames, holds 1.1 kB");
    let warning = |at, bytes: &[u8]| changed(at, bytes).unwrap().warnings[0].to_string();
    assert_snapshot!(warning(find(b"USED") + 8, &[3]), @"a.c3d: POINT:USED says 3, the file holds 2");
    assert_snapshot!(warning(find(b"FRAMES") + 10, &[1]), @"a.c3d: POINT:FRAMES says 1, the file holds 2");
    assert_snapshot!(warning(find(b"UNITS") + 10, b" "), @"a.c3d: POINT:UNITS is not given; mm assumed");
    assert_snapshot!(warning(find(b"Y_SCREEN"), b"Z_SCREEN"), @"a.c3d: POINT:Y_SCREEN is not given; +Z (up) assumed");
    assert_snapshot!(warning(find(b"Nose"), b"RHip"), @"a.c3d: marker `RHip` is there twice; the first one is taken where it is named");
    let longer = c3d::read("a.c3d", &[file, vec![0; 4096]].concat()).unwrap();
    assert_snapshot!(longer.warnings[0], @"a.c3d: 2 of 144 possible frames are read");
}

fn any_calibration(text: &str) -> Error {
    calibration::read("cameras", text).unwrap_err()
}

#[test]
fn calibrations_of_no_known_program() {
    let error = any_calibration("{\"cameras\": []}");
    assert_snapshot!(error, @"cameras: JSON; expected a calibration of Pose2Sim, Caliscope, Anipose, FreeMoCap, Qualisys or OpenCV");
    assert_snapshot!(any_calibration("<vicon/>"), @"cameras: XML with the element <vicon>; expected a calibration of Pose2Sim, Caliscope, Anipose, FreeMoCap, Qualisys or OpenCV");
}

#[test]
fn calibrations_of_caliscope() {
    let file = include_str!("golden/camera_array.toml");
    assert_snapshot!(any_calibration(&file.replace("0.5]\nrotation = [", "0.5]\nrotation = [\"x\", ")), @"cameras:17 (cam_1): rotation = [\"x\", 1.5707963267948963, 0.0, 0.0]; must be a Rodrigues vector of 3 numbers or a 3 x 3 matrix");
    assert_snapshot!(any_calibration("[cameras.0]\nsize = [640, 480]\n"), @"cameras:1: `[cameras.N] with matrix, rotation and translation` is missing");
}

#[test]
fn calibrations_of_anipose() {
    let file = include_str!("golden/calibration.toml");
    assert_snapshot!(any_calibration(&file.replace("\"mm\"", "\"inch\"")), @"cameras:22 (metadata): unit = \"inch\"; must be \"m\", \"cm\" or \"mm\"");
    let far =
        calibration::read("calibration.toml", &file.replace("error = 0.0\nunit = \"mm\"", "error = 0.3")).unwrap();
    assert_snapshot!(far.warnings[0], @"calibration.toml: no unit is stated and a camera stands 3043 units from the origin; millimetres assumed (`unit = \"m\"` states metres)");
    assert_eq!(far.cameras[0].translation, [0.3, 0.95, 2.875]);
}

#[test]
fn calibrations_of_qualisys() {
    let file = include_str!("golden/Calib.qca.txt");
    let changed = |from: &str, to: &str| any_calibration(&file.replace(from, to));
    assert_snapshot!(changed("sensorMaxU=\"69631.0\"", "sensorMaxU=\"1088\""), @"cameras:8 (cam_01): sensorMaxU = 1088; must be 64 for each of the 1088 pixels of the video");
    assert_snapshot!(changed("<fov_video ", "<fov_marker "), @"cameras: `<camera> that is active and has <fov_video>, <transform> and <intrinsic>` is missing");
    assert_snapshot!(changed("r11=\"1.0\"", "r11=\"1.5\""), @"cameras:7 (cam_01): R'R differs from identity by 1.2");
    assert_snapshot!(changed("radialDistortion3", "radialDistortion4"), @"cameras:8 (cam_01): `radialDistortion3` is missing");
    assert_snapshot!(changed("<calibration ", "<!DOCTYPE a [<!ENTITY b \"c\">]><calibration "), @"cameras: a document type in XML is not supported");
    assert_snapshot!(any_calibration(&file[..900]), @"cameras: ends inside an element at byte 900 (line 11)");
    let turned =
        calibration::read("Calib.qca.txt", &file.replace("viewrotation=\"0\"", "viewrotation=\"90\"")).unwrap();
    assert_snapshot!(turned.warnings[0], @"Calib.qca.txt:4 (cam_01): the view is turned by 90 degrees; the calibration is that of the picture as it is recorded, not turned");
}

#[test]
fn calibrations_of_opencv() {
    let file = include_str!("golden/cameras.yml");
    let changed = |from: &str, to: &str| any_calibration(&file.replace(from, to));
    assert_snapshot!(changed("-0.0007, 0.0022, 9.5e-6, 1.1e-5]", "0.1, 0, 0, 0, 0, 0, 0, 0, 0.25, 0, 0, 0]"), @"cameras:6 (cam_01): distortion_coefficients = [0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0,…; must be 4 or 5 numbers: k1, k2, p1, p2 and perhaps k3, or 8: k1, k2, p1, p2, k3, k4, k5, k6; later ones are thin prisms and tilt, which no lens here has: calibrate without them");
    assert_snapshot!(changed("tvec:", "centre:"), @"cameras:6 (cam_01): `tvec` is missing");
    assert_snapshot!(changed("cameras:", "views:"), @"cameras: `cameras (or Ks, names, M1, camera_matrix)` is missing");
    assert_snapshot!(changed("image_width: 1088", "image_width: wide"), @"cameras:7 (cam_01): `wide`; expected a number");
    let unsized_file = file.replace("image_width", "width_of_image");
    assert_snapshot!(calibration::read("cameras.yml", &unsized_file).unwrap().warnings[0], @"cameras.yml:6 (cam_01): image size is not given; 1066 x 1896 px, twice the principal point, assumed");
}

#[test]
fn cameras_that_a_format_cannot_hold() {
    let file = include_str!("golden/cameras.yml").replace("fisheye: 0", "fisheye: 1").replace(", 0.5]", "]");
    let cameras = calibration::read("cameras.yml", &file).unwrap().cameras;
    let error = calibration::write(&cameras, calibration::CalibrationFormat::Qualisys).unwrap_err();
    assert_snapshot!(error, @"camera `cam_01` cannot be written for Qualisys: its lens is neither perfect nor one with k1, k2, k3, p1 and p2");
}
