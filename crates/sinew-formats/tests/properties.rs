//! Laws of readers and writers: what is written reads back equal, and no input makes a reader panic.

use proptest::prelude::*;
use sinew_body::flesh::{Flesh, Solid};
use sinew_body::frustum::Frustum;
use sinew_body::{Axis, Joint, KinematicTree, Link, Point};
use sinew_formats::calibration::CalibrationFormat;
use sinew_formats::rotation::from_rodrigues;
use sinew_formats::tidy_csv::Cell;
use sinew_formats::*;
use sinew_observe::cameras::lens::{Brown, Lens};
use sinew_observe::silhouettes::bit_image::BitImage;
use sinew_observe::{Camera, Intrinsics, RgbImage};

/// Finite numbers of every kind: zeros of both signs, denormals, 1e±300, ordinary ones.
fn number() -> impl Strategy<Value = f64> {
    use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    prop_oneof![-10.0..10.0f64, POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO, Just(1e300), Just(-1e-300)]
}

fn vector() -> impl Strategy<Value = [f64; 3]> {
    [number(), number(), number()]
}

fn same_bits(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// Rising times.
fn times(frames: usize) -> Vec<f64> {
    (0..frames).map(|i| i as f64 / 59.94).collect()
}

prop_compose! {
    fn trc_file()(names in prop::collection::btree_set("[A-Za-z*_][A-Za-z0-9 _é]{0,6}[A-Za-z0-9]", 1..4))(
        frames in prop::collection::vec(prop::collection::vec(prop::option::of(vector()), names.len()), 0..5),
        rate_hz in prop_oneof![Just(60.0), 1e-3..1e6f64],
        start_frame in 0..1_000_000i64,
        units in prop_oneof![Just(trc::Units::Metres), Just(trc::Units::Centimetres), Just(trc::Units::Millimetres)],
        names in Just(Vec::from_iter(names)),
    ) -> trc::Trc {
        let frames = frames.into_iter().zip(times(5)).enumerate();
        let frames = frames.map(|(i, (points, time_s))| trc::TrcFrame { number: i as i64 + 1, time_s, points });
        let header = trc::Header { file_name: "a b.trc".into(), rate_hz, units, start_frame, markers: names };
        trc::Trc { header, frames: frames.collect(), warnings: Vec::new() }
    }
}

prop_compose! {
    fn bvh_file()(shape in prop::collection::vec((any::<prop::sample::Index>(), vector(), prop::option::of(vector())), 1..6))(
        channels in prop::collection::vec(prop::sample::subsequence(vec![0usize, 1, 2, 3, 4, 5], 0..=6).prop_shuffle(), shape.len()),
        frames in 0..4usize,
        shape in Just(shape),
        values in prop::collection::vec(number(), 4 * 6 * 6),
    ) -> bvh::Bvh {
        let channel = |i: usize| if i < 3 { bvh::Channel::Position(i) } else { bvh::Channel::Rotation(i - 3) };
        // A depth-first order: each joint hangs on the last one or on one of its ancestors.
        let mut joints: Vec<bvh::BvhJoint> = Vec::new();
        for (i, ((pick, offset, end_site), channels)) in shape.into_iter().zip(channels).enumerate() {
            let mut ancestors = Vec::new();
            let mut at = i.checked_sub(1);
            while let Some(joint) = at {
                ancestors.push(joint);
                at = joints[joint].parent;
            }
            let parent = (!ancestors.is_empty()).then(|| ancestors[pick.index(ancestors.len())]);
            let channels = channels.into_iter().map(channel).collect();
            joints.push(bvh::BvhJoint { name: format!("joint {i}"), parent, offset, channels, end_site });
        }
        let width: usize = joints.iter().map(|joint| joint.channels.len()).sum();
        let frames = if width == 0 { 0 } else { frames };
        let frames = (0..frames).map(|f| values[f * 36..f * 36 + width].to_vec()).collect();
        bvh::Bvh { joints, frame_time_s: 0.008_333_3, frames, warnings: Vec::new() }
    }
}

prop_compose! {
    fn body()(links in prop::collection::vec((any::<prop::sample::Index>(), "[ -~é\n]{0,5}", vector(), prop::collection::vec(0..8usize, 0..6)), 1..6))(
        points in prop::collection::vec((0..links.len(), "[ -~]{0,5}", vector()), 0..4),
        links in Just(links),
    ) -> KinematicTree {
        let axes = [Axis::X, Axis::Y, Axis::Z];
        let free = Axis::along([0.3, -0.2, 0.7]).unwrap();
        let axes = |j: usize| axes.get(j).copied().unwrap_or(free);
        let joint = |j: usize| if j < 4 { Joint::Translate(axes(j)) } else { Joint::Rotate(axes(j - 4)) };
        let links = links.into_iter().enumerate().map(|(i, (parent, name, offset, joints))| {
            let parent = (i > 0).then(|| parent.index(i));
            let quarter = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
            let rest = name.len().is_multiple_of(3).then_some(quarter);
            Link { rest, ..Link::new(format!("{i}{name}"), parent, offset, joints.into_iter().map(joint).collect()) }
        });
        let points = points.into_iter().enumerate();
        let points = points.map(|(i, (link, name, offset))| Point { name: format!("{name}{i}"), link, offset });
        KinematicTree::new(links.collect(), points.collect()).unwrap()
    }
}

prop_compose! {
    fn cameras()(cameras in prop::collection::vec(
        ("[ -~é]{0,6}", [1.0..5000.0f64, 1.0..5000.0], [1e-3..1e5f64, 1e-3..1e5], [-1.0..2.0f64, -1.0..2.0],
         [number(), number(), number(), number(), number()], [-3.0..3.0f64, -3.0..3.0, -3.0..3.0], vector()), 1..4,
    )) -> Vec<Camera> {
        cameras.into_iter().enumerate().map(|(i, (name, size, [fx, fy], [cx, cy], [k1, k2, p1, p2, k3], turn, translation))| Camera {
            name: format!("{name}{i}"),
            image_size_px: size,
            intrinsics: Intrinsics { fx, fy, cx: cx * size[0], cy: cy * size[1] },
            lens: Brown { k1, k2, p1, p2, k3 }.into(),
            rotation: from_rodrigues(turn),
            translation,
        }).collect()
    }
}

/// A rig as people have: lenses of every kind, cameras that see the origin.
fn rig() -> impl Strategy<Value = Vec<Camera>> {
    let lens = prop_oneof![
        [-0.3..0.3f64, -0.1..0.1, -0.01..0.01, -0.01..0.01, -0.1..0.1].prop_map(|k| (false, k.to_vec())),
        [-0.3..0.3f64, -0.1..0.1, -0.01..0.01, -0.01..0.01, -0.1..0.1, -0.3..0.3, -0.1..0.1, -0.1..0.1]
            .prop_map(|k| (false, k.to_vec())),
        [-0.1..0.1f64, -0.05..0.05, -0.01..0.01, -0.01..0.01].prop_map(|k| (true, k.to_vec())),
    ];
    let camera = (
        lens,
        [400.0..2000.0f64, 0.99..1.01],
        [0.4..0.6f64, 0.4..0.6],
        [-3.0..3.0f64, -3.0..3.0, -3.0..3.0],
        2.0..9.0f64,
    );
    prop::collection::vec(camera, 1..5).prop_map(|cameras| {
        let made =
            cameras.into_iter().enumerate().map(|(i, ((is_fisheye, k), [fx, aspect], [cx, cy], turn, depth))| Camera {
                name: format!("cam_{i}"),
                image_size_px: [1920.0, 1080.0],
                intrinsics: Intrinsics { fx, fy: aspect * fx, cx: cx * 1920.0, cy: cy * 1080.0 },
                lens: Lens::from_coefficients(is_fisheye, &k).unwrap(),
                rotation: from_rodrigues(turn),
                translation: [0.1, -0.2, depth],
            });
        made.collect()
    })
}

/// Both show the same point at the same pixel, to a billionth.
fn check_same_pixels(a: &[Camera], b: &[Camera], point: [f64; 3]) {
    assert_eq!(a.len(), b.len());
    for (a, b) in a.iter().zip(b) {
        assert_eq!((&a.name, a.image_size_px), (&b.name, b.image_size_px));
        match (a.project(point).pixel(), b.project(point).pixel()) {
            (Some(a), Some(b)) => assert!((a[0] - b[0]).hypot(a[1] - b[1]) < 1e-9, "{a:?} {b:?}"),
            (a, b) => assert_eq!(a, b),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig {
        failure_persistence: Some(Box::new(proptest::test_runner::FileFailurePersistence::Direct("tests/properties.proptest-regressions"))),
        ..ProptestConfig::default()
    })]

    #[test]
    fn masks_and_pictures_come_back(width in 1..70_usize, height in 1..9_usize, pixels in prop::collection::vec(any::<[u8; 3]>(), 70 * 9)) {
        let silhouette = BitImage::from_fn(width, height, |x, y| pixels[y * width + x][0] % 2 == 1);
        let mut file = Vec::new();
        mask::write(&mut file, &silhouette).unwrap();
        prop_assert_eq!(mask::read("a.png", &file).unwrap().image, silhouette);
        let image = RgbImage { width, height, pixels: pixels[..width * height].to_vec() };
        let mut file = Vec::new();
        picture::write_png(&mut file, &image).unwrap();
        prop_assert_eq!(picture::read("a.png", &file).unwrap(), image);
    }

    #[test]
    fn no_bytes_make_the_readers_of_images_panic(
        bytes in prop::collection::vec(any::<u8>(), 0..200),
        start in prop::sample::select(vec![&b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"[..], b"\xFF\xD8\xFF\xC0\0\x0b\x08", b""]),
    ) {
        let file = [start, &bytes].concat();
        let _ = mask::read("a.png", &file);
        let _ = picture::read("a.jpg", &file);
    }

    #[test]
    fn trc_reads_back_equal(file in trc_file()) {
        let mut out = Vec::new();
        trc::write(&mut out, &file).unwrap();
        let read = trc::read("a.trc", text(&out)).unwrap();
        for (a, b) in file.frames.iter().zip(&read.frames) {
            for (a, b) in a.points.iter().flatten().flatten().zip(b.points.iter().flatten().flatten()) {
                prop_assert!(same_bits(*a, *b));
            }
        }
        prop_assert_eq!(read, file);
    }

    #[test]
    fn mot_reads_back_equal(
        columns in prop::collection::vec("[a-z_]{1,8}", 0..4),
        rows in prop::collection::vec(prop::collection::vec(prop_oneof![number(), Just(f64::NAN)], 4), 0..5),
    ) {
        let mut out = Vec::new();
        mot::write_header(&mut out, "Coordinates", &columns, rows.len() as u32).unwrap();
        for (row, time_s) in rows.iter().zip(times(5)) {
            mot::write_row(&mut out, time_s, &row[..columns.len()]).unwrap();
        }
        let read = mot::read("a.mot", text(&out)).unwrap();
        prop_assert_eq!(&read.columns, &columns);
        prop_assert!(read.warnings.is_empty() && read.in_degrees);
        prop_assert_eq!(&read.time_s, &times(rows.len()));
        for (a, b) in rows.iter().zip(&read.rows) {
            prop_assert!(a[..columns.len()].iter().zip(b).all(|(a, b)| same_bits(*a, *b)) && b.len() == columns.len());
        }
    }

    #[test]
    fn bvh_reads_back_equal(file in bvh_file()) {
        let mut out = Vec::new();
        bvh::write(&mut out, &file).unwrap();
        let read = bvh::read("a.bvh", text(&out)).unwrap();
        for (a, b) in file.frames.iter().flatten().zip(read.frames.iter().flatten()) {
            prop_assert!(same_bits(*a, *b));
        }
        prop_assert_eq!(read, file);
    }

    #[test]
    fn csv_reads_back_equal(
        columns in prop::collection::vec("[ -~é\n\r\t]{0,6}", 1..5),
        rows in prop::collection::vec(prop::collection::vec(prop_oneof![number(), Just(f64::NAN)], 5), 0..5),
    ) {
        let mut out = Vec::new();
        tidy_csv::write_header(&mut out, &columns).unwrap();
        for row in &rows {
            let cells: Vec<Cell<'_>> = row[..columns.len()].iter().map(|&value| Cell::Number(value)).collect();
            tidy_csv::write_row(&mut out, &cells).unwrap();
        }
        let read = tidy_csv::read_numbers("a.csv", text(&out)).unwrap();
        prop_assert_eq!(&read.columns, &columns);
        prop_assert_eq!(read.rows.len(), rows.len());
        for (a, b) in rows.iter().zip(&read.rows) {
            prop_assert!(a.iter().zip(b).all(|(a, b)| same_bits(*a, *b)));
        }
    }

    #[test]
    fn body_reads_back_equal(tree in body(), sizes in proptest::array::uniform4(1e-3..1e3f64), turn in -3.0..3.0f64) {
        let [height, below, above, ratio] = sizes;
        let (sin, cos) = turn.sin_cos();
        let solid = Solid {
            name: "a \"b\"".into(),
            link: tree.links().len() - 1,
            base: [turn, 0.0, -height],
            axes: [[cos, 0.0, sin], [0.0, 1.0, 0.0], [-sin, 0.0, cos]],
            frustum: Frustum { height, radii: [below, above], ratio },
        };
        let flesh = Flesh::new(&tree, vec![solid]).unwrap();
        let both = body_toml::read("body.toml", &body_toml::write(&tree, Some(&flesh))).unwrap();
        prop_assert_eq!(both, body_toml::BodyDefinition { tree: tree.clone(), flesh: Some(flesh) });
        let body_toml::BodyDefinition { tree: read, flesh } = body_toml::read("body.toml", &body_toml::write(&tree, None)).unwrap();
        prop_assert_eq!(flesh, None);
        let bits = |tree: &KinematicTree| -> Vec<u64> {
            let offsets = tree.links().iter().map(|link| link.offset).chain(tree.points().iter().map(|point| point.offset));
            offsets.flatten().map(f64::to_bits).collect()
        };
        prop_assert_eq!(bits(&read), bits(&tree));
        prop_assert_eq!(read, tree);
    }

    #[test]
    fn calibration_reads_back_equal(cameras in cameras()) {
        let mut read = calib_toml::read("Calib.toml", &calib_toml::write(&cameras)).unwrap();
        prop_assert!(read.warnings.is_empty());
        prop_assert_eq!(read.cameras.len(), cameras.len());
        for (a, b) in cameras.iter().zip(&mut read.cameras) {
            for (a, b) in a.rotation.iter().flatten().zip(b.rotation.iter().flatten()) {
                prop_assert!((a - b).abs() <= 2e-15, "{} {}", a, b);
            }
            b.rotation = a.rotation;
        }
        prop_assert_eq!(read.cameras, cameras);
    }

    #[test]
    fn calibrations_survive_every_format(cameras in rig(), point in [-1.0..1.0f64, -1.0..1.0, -1.0..1.0]) {
        let mut passed_on = cameras.clone();
        for format in [CalibrationFormat::Caliscope, CalibrationFormat::OpenCv, CalibrationFormat::Qualisys, CalibrationFormat::Anipose, CalibrationFormat::Pose2Sim] {
            let Ok(written) = calibration::write(&cameras, format) else {
                // Qualisys has one kind of lens.
                let is_brown = |camera: &Camera| !camera.lens.is_fisheye() && camera.lens.coefficients().len() < 8;
                prop_assert!(format == CalibrationFormat::Qualisys && !cameras.iter().all(is_brown));
                continue;
            };
            prop_assert_eq!(calibration::recognised("a", &written), Ok(format));
            let read = calibration::read("a", &written).unwrap();
            prop_assert_eq!(read.warnings, []);
            check_same_pixels(&cameras, &read.cameras, point);
            passed_on = calibration::read("a", &calibration::write(&passed_on, format).unwrap()).unwrap().cameras;
        }
        check_same_pixels(&cameras, &passed_on, point);
    }

    #[test]
    fn keypoints_read_back_equal(people in prop::collection::vec(
        (0..3usize, prop::collection::vec(prop::option::of((number(), number(), 1e-6..=1.0f64)), 1..30)), 0..4,
    )) {
        let mut index = 0;
        let mut written = Vec::new();
        for (absent, points) in people {
            index += absent;
            let keypoint = |(x, y, confidence)| openpose::Keypoint { x, y, confidence };
            let keypoints = points.into_iter().map(|point| point.map(keypoint)).collect();
            written.push(openpose::OpenposePerson { index, keypoints });
            index += 1;
        }
        let read = openpose::read("a.json", &openpose::write(&written), &openpose::OpenposeOptions::default()).unwrap();
        prop_assert_eq!(read.people, written);
    }

    #[test]
    fn arbitrary_text_is_refused_or_read(input in any::<Vec<u8>>(), wanted in "[\\PC\n\t]{0,200}") {
        let _ = source_text::decode("a", &input, 1 << 20).map(read_all);
        read_all(&wanted);
    }

    #[test]
    fn damaged_files_are_refused_or_read(file in 0..FILES.len(), place in any::<prop::sample::Index>(), bytes in prop::collection::vec(any::<u8>(), 0..4), cut in 0..3usize) {
        let mut damaged = FILES[file].as_bytes().to_vec();
        let start = place.index(damaged.len());
        let end = (start + cut).min(damaged.len());
        damaged.splice(start..end, bytes);
        let _ = source_text::decode("a", &damaged, 1 << 20).map(read_all);
    }

    #[test]
    fn names_are_matched_or_refused(names in prop::collection::vec("\\PC{0,12}", 0..6), others in prop::collection::vec("[a-z0-9_]{0,6}", 0..6)) {
        let _ = frame_number::order(&names);
        let _ = camera_name::match_names(&names, &others);
        for name in &names {
            let _ = (layout::find(name), nearest::nearest(name, others.iter().map(String::as_str)), tidy_csv::unit(name));
            prop_assert!(!camera_name::fold(name).is_empty() || name.is_empty());
        }
    }
}

/// Gives a text to every reader.
fn read_all(text: &str) {
    let skeleton = asf::read("a.asf", ASF).unwrap();
    let outcomes = [
        openpose::read("a.json", text, &openpose::OpenposeOptions::default()).err(),
        live_frame::read("line 1", text, &openpose::OpenposeOptions::default()).err(),
        caliscope_xy::read("a.csv", text, 1.0).err(),
        coco_results::read("a.json", text, 1.0).err(),
        deeplabcut_csv::read("a.csv", text, 1.0).err(),
        mediapipe_json::read("a.json", text, 1.0).err(),
        mmpose_json::read("a.json", text, 1.0).err(),
        rtmlib_json::read("a.json", text, 1.0).err(),
        keypoint_formats::read_frame("a.json", text, &openpose::OpenposeOptions::default()).err(),
        keypoint_formats::read("a", text, 1.0).err(),
        layout::read("a.toml", text).err(),
        calibration::read("a.toml", text).err(),
        qualisys_cameras::read("a.qca.txt", text).err(),
        opencv_cameras::read("a.yml", text).err(),
        body_toml::read("a.toml", text).err(),
        trc::read("a.trc", text).err(),
        mot::read("a.mot", text).err(),
        bvh::read("a.bvh", text).map(|file| drop(file.positions(0))).err(),
        asf::read("a.asf", text).map(|file| drop(file.bone_ends_m(&[1.0; 4]))).err(),
        amc::read("a.amc", text, &skeleton)
            .map(|file| file.frames.iter().for_each(|f| drop(skeleton.bone_ends_m(&f.values))))
            .err(),
        tidy_csv::read_numbers("a.csv", text).map(|table| drop(point_table::from_numbers("a.csv", &table))).err(),
    ];
    for error in outcomes.into_iter().flatten() {
        assert!(!error.to_string().is_empty());
    }
}

const ASF: &str = "# skeleton\n:version 1.10\n:units\n length 0.45\n angle deg\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n position 0 0 0\n orientation 0 0 5\n:bonedata\n begin\n id 1\n name a\n direction 0 -1 0\n length 7\n axis 0 0 20 XYZ\n dof rx rz\n limits (-10.0 170.0)\n (0 1)\n end\n begin\n name b\n direction 0 -1 0\n length 7\n axis 0 0 20 ZYX\n end\n:hierarchy\n begin\n root a\n a b\n end\n";

const FILES: [&str; 19] = [
    "{\"version\":1.3,\"people\":[{\"person_id\":[-1],\"pose_keypoints_2d\":[505.232,431.63,0.664216,null,NaN,0.60741,0,0,0]},{}],\"x\":\"a\\\"}[\"}",
    "name = \"mine\"\npoints = [\"Nose\", \"\", \"LHip\"]\n",
    "[cam_01]\nname = \"cam_01\"\nsize = [ 1088.0, 1920.0]\nmatrix = [ [ 1681.2, 0.0, 532.9], [ 0.0, 1681.0, 948.1], [ 0.0, 0.0, 1.0]]\ndistortions = [ -0.0007, 0.002, 9.5e-06, 1.0e-05]\nrotation = [[1, 0, 0.0001], [0, 1, 0], [0, 0, 1]]\ntranslation = [ 0.3, 0.9, 2.8]\nfisheye = false\n\n[metadata]\nadjusted = false\n",
    "[[link]]\nname = \"pelvis\"\njoints = [\"tx\", \"rz\"]\n[[link]]\nname = \"thigh\"\nparent = \"pelvis\"\noffset = [0.1, 0.0, -0.1]\n[[point]]\nname = \"LKnee\"\nlink = \"thigh\"\noffset = [0.0, 0.0, -0.43]\n[[solid]]\nname = \"thigh\"\nlink = \"thigh\"\naxes = [[-1, 0, 0], [0, 1, 0], [0, 0, -1]]\nheight = 0.4\nradii = [0.09, 0.06]\n",
    "PathFileType\t4\t(X/Y/Z)\ta.trc\nDataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n60\t60\t2\t2\tmm\t60\t1\t2\nFrame#\tTime\tR Hip\t\t\tNose\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n1\t0.0\t1\t2\t3\t4\t5\t6\n2\t0.5\t\t\t\t7\tNaN\t9\n",
    "Coordinates\nversion=1\nnRows=2\nnColumns=3\ninDegrees=yes\n\nendheader\ntime\ta\tb\n0.0\t1.5\t-2\n0.5\tnan\t3\n",
    "HIERARCHY\nROOT Hips\n{\n\tOFFSET 0 0 0\n\tCHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation\n\tJOINT Leg\n\t{\n\t\tOFFSET 0 -1 0\n\t\tCHANNELS 1 Zrotation\n\t\tEnd Site\n\t\t{\n\t\t\tOFFSET 0 -2 0\n\t\t}\n\t}\n}\nMOTION\nFrames: 1\nFrame Time: .0083333\n1 2 3 90 0 0 45\n",
    ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 1 2 3 4 5 6\na 7 8\n2\na 7 -9.5e-15\nroot 1 2 3 4 5 6\n",
    "time_s,RHip_x_m,\"RHip_y_m\",RHip_z_m\r\n0.0,1,2,3\r\n0.1,\"1\",NaN,\r\n",
    include_str!("golden/camera_array.toml"),
    include_str!("golden/Calib.qca.txt"),
    include_str!("golden/cameras.yml"),
    "sync_index,port,frame_index,frame_time,point_id,img_loc_x,img_loc_y,obj_loc_x,obj_loc_y\r\n0,0,0,9.1,11,520,193,,\n0,1,0,9.1,24,1.5,NaN,,\n",
    "scorer,D,D,D,D,D,D\nindividuals,a,a,a,b,b,b\nbodyparts,nose,nose,nose,nose,nose,nose\ncoords,x,y,likelihood,x,y,likelihood\n0,1,2,0.5,,,\nimg1.png,,,,3,4,1\n",
    "{\"meta_info\":{},\"instance_info\":[{\"frame_id\":1,\"instances\":[{\"keypoints\":[[1.5,2],[3,NaN]],\"keypoint_scores\":[1.1,0.5],\"bbox\":[[1,2,3,4]]}]}]}",
    "[{\"image_id\":\"12.jpg\",\"category_id\":1,\"keypoints\":[10,20,1.1,null,2,0.5],\"score\":2.9},{\"image_id\":3,\"keypoints\":[]}]",
    "{\"frames\":[{\"frame\":7,\"pose_landmarks\":[]},null,{\"landmarks\":{\"landmark\":[]}}]}",
    "[{\"frame\":3,\"keypoints\":[[[1,2],[3,NaN]]],\"scores\":[[1.1,0.5]]},{\"keypoints\":[],\"scores\":[]}]",
    "[{\"keypoints\":[[1.5,2],[3,NaN]],\"keypoint_scores\":[1.1,0.5],\"bbox\":[[1,2,3,4]]}]",
];

/// Which reader takes which of the files.
#[test]
fn the_files_are_valid() {
    let skeleton = asf::read("a.asf", ASF).unwrap();
    assert!(openpose::read("a", FILES[0], &openpose::OpenposeOptions::default()).is_ok());
    assert!(layout::read("a", FILES[1]).is_ok());
    assert!(calib_toml::read("a", FILES[2]).is_ok());
    assert!(body_toml::read("a", FILES[3]).is_ok());
    assert!(trc::read("a", FILES[4]).is_ok());
    assert!(mot::read("a", FILES[5]).is_ok());
    assert!(bvh::read("a", FILES[6]).is_ok());
    assert!(amc::read("a", FILES[7], &skeleton).is_ok());
    assert!(point_table::from_numbers("a", &tidy_csv::read_numbers("a", FILES[8]).unwrap()).is_ok());
    assert!(caliscope_cameras::read("a", FILES[9]).is_ok());
    assert!(qualisys_cameras::read("a", FILES[10]).is_ok());
    assert!(opencv_cameras::read("a", FILES[11]).is_ok());
    let formats =
        ["Caliscope", "DeepLabCut", "MMPose", "AlphaPose, COCO results"].into_iter().chain(["RTMLib", "MMPose"]);
    for (text, format) in FILES[12..16].iter().chain(&FILES[17..]).zip(formats) {
        assert_eq!(keypoint_formats::recognised(text).unwrap().name, format);
        let table = keypoint_formats::read("a", text, 1.0).unwrap();
        let people = table.cameras.iter().flat_map(|camera| camera.frames.values()).map(|frame| frame.people.len());
        assert!(people.sum::<usize>() > 0, "{format}");
    }
    assert_eq!(mediapipe_json::read("a", FILES[16], 1.0).unwrap().cameras[0].frames.len(), 3);
}

#[test]
fn files_cut_at_every_byte_are_refused_or_read() {
    for file in FILES.iter().chain(&[ASF]) {
        for end in 0..file.len() {
            if let Some(cut) = file.get(..end) {
                read_all(cut);
            }
        }
    }
}

/// A truncated JSON or TOML file says so, wherever it is cut inside a bracket or string.
#[test]
fn truncated_keypoints_are_called_truncated() {
    for end in 0..FILES[0].len() {
        let error = openpose::read("a.json", &FILES[0][..end], &openpose::OpenposeOptions::default()).unwrap_err();
        assert!(matches!(error, Error::Truncated { offset, .. } if offset == end), "{end}: {error}");
    }
}

/// A megabyte of what costs most per byte is handled in well under the limit, which allows for busy machines.
#[test]
fn a_megabyte_of_nonsense_is_no_burden() {
    let megabyte = |start: &str, unit: &dyn Fn(usize) -> String| {
        let mut text = start.to_owned();
        (0..)
            .map(unit)
            .take_while(|unit| {
                text.push_str(unit);
                text.len() < 1 << 20
            })
            .for_each(drop);
        text
    };
    let trc_header = FILES[4].split("\n1\t").next().unwrap();
    let many_markers = (0..30_000).map(|i| format!("m{i}\t\t\t")).collect::<String>();
    for text in [
        megabyte("HIERARCHY\n", &|i| format!("ROOT {i}\n{{\n}}\n")),
        megabyte("HIERARCHY\nROOT r {\n", &|i| format!("JOINT {i}\n{{\n")),
        megabyte(":bonedata\n", &|i| format!("begin\nname {i}\nend\n")),
        megabyte("", &|i| format!("[[link]]\nname=\"{i}\"\n")),
        megabyte("", &|i| format!("[c{i}]\n")),
        megabyte("points = [", &|i| format!("\"{i}\",")),
        megabyte("{\"people\":[", &|_| "{},".into()),
        megabyte("{\"people\":[{\"pose_keypoints_2d\":[", &|_| "NaN,".into()),
        megabyte(&trc_header.replace("R Hip\t\t\t", &many_markers), &|i| format!("{i}\t{i}\n")),
        megabyte("<calibration><cameras>", &|i| format!("<camera serial='{i}'/>")),
        megabyte("<calibration ", &|i| format!("a{i}='&&' ")),
        megabyte("%YAML:1.0\n", &|i| format!("a{i}:\n- b\n")),
        megabyte("%YAML:1.0\na: [", &|_| "1,".into()),
        megabyte("%YAML:1.0\nnames:\n", &|i| format!("- {i}\n")),
        megabyte("[", &|i| format!("{{\"image_id\":{i},\"keypoints\":[1,1,1]}},")),
        megabyte("[{\"image_id\":1,\"keypoints\":[", &|_| "1,".into()),
        megabyte("[", &|_| "[],".into()),
        megabyte("sync_index,port,point_id,img_loc_x,img_loc_y\n", &|i| format!("{i},{i},1,1,1\n")),
        megabyte("bodyparts", &|i| format!(",{i}")),
        megabyte("a\n", &|_| "1\n".into()),
        megabyte("", &|_| ",".into()),
        megabyte("", &|_| "\"\"".into()),
    ] {
        let start = std::time::Instant::now();
        read_all(&text);
        assert!(start.elapsed().as_secs() < 20, "{:.60} took {:?}", text, start.elapsed());
    }
}
