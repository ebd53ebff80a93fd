//! Every writer against a file in `tests/golden/`, and those files in the programs they are made for.
//!
//! `SINEW_WRITE_GOLDEN=1` writes the files again; look at the difference before you keep it. The programs are named in
//! the Python named by `SINEW_PYTHON`, or `python3`.

use sinew_body::flesh::{DOWNWARDS, Flesh, Solid};
use sinew_body::frustum::Frustum;
use sinew_body::{Axis, Joint, KinematicTree, Link, Point};
use sinew_formats::calibration::{self, CalibrationFormat};
use sinew_formats::rotation::{IDENTITY, Matrix};
use sinew_formats::tidy_csv::Cell;
use sinew_formats::zarr::inference_data::{DrawsKind, Run, posterior, schema};
use sinew_formats::zarr::{FrameValues, MemoryStore, Writer};
use sinew_formats::{body_toml, bvh, c3d, calib_toml, layout, mot, tidy_csv, trc};
use sinew_observe::cameras::lens::Brown;
use sinew_observe::{Camera, Intrinsics};
use std::path::{Path, PathBuf};
use std::process::Command;

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(name)
}

fn check(name: &str, written: &[u8]) {
    if std::env::var_os("SINEW_WRITE_GOLDEN").is_some() {
        std::fs::write(golden(name), written).unwrap();
    }
    let expected = std::fs::read(golden(name)).unwrap();
    assert_eq!(String::from_utf8_lossy(written), String::from_utf8_lossy(&expected), "{name}");
    assert!(written == expected, "{name}: the same text, other bytes");
}

fn arm() -> KinematicTree {
    let link = |name: &str, parent, offset, joints| Link::new(name, parent, offset, joints);
    let (tx, rx, ry) = (Joint::Translate(Axis::X), Joint::Rotate(Axis::X), Joint::Rotate(Axis::Y));
    let links = vec![
        link("trunk", None, [0.0; 3], vec![tx, ry]),
        link("upper_arm", Some(0), [0.18, 0.0, 0.42], vec![rx, ry]),
        link("forearm", Some(1), [0.0, 0.0, -0.3], vec![rx]),
    ];
    let point = |name: &str, link, offset| Point { name: name.into(), link, offset };
    let points = vec![point("RShoulder", 1, [0.0; 3]), point("RWrist", 2, [0.0, 0.0, -0.26])];
    KinematicTree::new(links, points).unwrap()
}

#[test]
fn trajectories() {
    let names = ["RHip", "R Wrist"].map(String::from).to_vec();
    let mut out = Vec::new();
    trc::write_header(&mut out, &trc::Header::new("markers.trc", 59.94, names), 2).unwrap();
    let hip = trc::trc_from_world([-0.09, 0.25, 0.92]);
    trc::write_frame(&mut out, 1, 0.0, &[Some(hip), Some([1e-7, -0.0, 1.0 / 3.0])]).unwrap();
    trc::write_frame(&mut out, 2, 1.0 / 59.94, &[Some(hip), None]).unwrap();
    check("markers.trc", &out);
}

#[test]
fn points_of_laboratories() {
    let names = ["RHip", "R Wrist"].map(String::from).to_vec();
    let header = c3d::C3dHeader { first_frame: 7, ..c3d::C3dHeader::new(59.94, names) };
    let hip = trc::trc_from_world([-0.09, 0.25, 0.92]);
    let mut out = Vec::new();
    c3d::write(&mut out, &header, &[vec![Some(hip), Some([1e-7, -0.0, 1.0 / 3.0])], vec![Some(hip), None]]).unwrap();
    check("markers.c3d", &out);
}

#[test]
fn coordinates() {
    let mut out = Vec::new();
    let columns = ["pelvis_tx", "knee_angle_r"].map(String::from);
    mot::write_header(&mut out, "Coordinates", &columns, 2).unwrap();
    mot::write_row(&mut out, 0.0, &[0.25, 60.0]).unwrap();
    mot::write_row(&mut out, 1.0 / 30.0, &[0.2, -1e-9]).unwrap();
    check("angles.mot", &out);
}

/// The trunk stands, the arm hangs and is then raised sideways; the rest pose has it raised.
#[test]
fn skeletons() {
    let raised: Matrix = [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    let skeleton = bvh::export::Skeleton::new(&arm(), &[IDENTITY, raised, raised]);
    let mut out = Vec::new();
    bvh::write_header(&mut out, &skeleton.joints, 1.0 / 30.0, 2).unwrap();
    let root = [1.0, 2.0, 1.02];
    let hanging = skeleton.channels(&[IDENTITY; 3], root, None);
    bvh::write_frame(&mut out, &hanging).unwrap();
    bvh::write_frame(&mut out, &skeleton.channels(&[IDENTITY, raised, raised], root, Some(&hanging))).unwrap();
    check("motion.bvh", &out);
    let read = bvh::read("motion.bvh", std::str::from_utf8(&out).unwrap()).unwrap();
    for (frame, wrist) in [(0, [1.18, 2.0, 0.88]), (1, [1.74, 2.0, 1.44])] {
        let (name, point) = read.positions(frame).unwrap().pop().unwrap();
        assert_eq!(name, "forearm_End");
        let found = bvh::world_from_bvh(point);
        assert!(found.iter().zip(wrist).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    }
}

#[test]
fn tables() {
    let mut out = Vec::new();
    tidy_csv::write_header(&mut out, &["time_s", "person", "name", "mean_deg", "q05_deg", "q95_deg"]).unwrap();
    let numbers = [Cell::Number(12.5), Cell::Number(10.0), Cell::Number(f64::NAN)];
    let row = [&[Cell::Number(0.1), Cell::Integer(0), Cell::Text("knee, left")], &numbers[..]].concat();
    tidy_csv::write_row(&mut out, &row).unwrap();
    check("angles.csv", &out);
}

#[test]
fn calibrations() {
    let camera = |name: &str, k3| Camera {
        name: name.into(),
        image_size_px: [1088.0, 1920.0],
        intrinsics: Intrinsics { fx: 1681.25, fy: 1681.0, cx: 533.0, cy: 948.125 },
        lens: Brown { k1: -0.0007, k2: 0.0022, p1: 9.5e-6, p2: 1.1e-5, k3 }.into(),
        rotation: [[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]],
        translation: [0.3, 0.95, 2.875],
    };
    let cameras = [camera("cam_01", 0.0), camera("left front", 0.5)];
    check("Calib.toml", calib_toml::write(&cameras).as_bytes());
    for (name, format) in [
        ("camera_array.toml", CalibrationFormat::Caliscope),
        ("calibration.toml", CalibrationFormat::Anipose),
        ("cameras.yml", CalibrationFormat::OpenCv),
        ("Calib.qca.txt", CalibrationFormat::Qualisys),
    ] {
        check(name, calibration::write(&cameras, format).unwrap().as_bytes());
    }
}

#[test]
fn bodies_and_layouts() {
    check("arm.toml", body_toml::write(&arm(), None).as_bytes());
    let solid = Solid {
        name: "upper".into(),
        link: 0,
        base: [0.0, 0.0, 0.025],
        axes: DOWNWARDS,
        frustum: Frustum { height: 0.3, radii: [0.055, 0.0425], ratio: 0.9 },
    };
    let flesh = Flesh::new(&arm(), vec![solid]).unwrap();
    check("arm_with_flesh.toml", body_toml::write(&arm(), Some(&flesh)).as_bytes());
    let points = vec![Some("Nose".to_owned()), None, Some("LHip".to_owned())];
    check("layout.toml", layout::write(&layout::Layout { name: "mine".into(), points }).as_bytes());
}

#[test]
fn stores() {
    let run = Run { library_version: "0.1.0", method: "hmc", kind: DrawsKind::Smoothed, seed: 7, created_at: None };
    let mut schema = schema(1, 2, vec!["knee.rx".into()], vec!["Nose".into()]);
    schema.groups.push(posterior(&run));
    let mut writer = Writer::create(MemoryStore::default(), schema).unwrap();
    let values: [&[f64]; 3] = [&[0.1, 0.2], &[1.0; 6], &[2.0; 6]];
    writer.push(0, 0.0, &values.map(FrameValues::Numbers)).unwrap();
    check("posterior.zarr.json", &writer.finish().unwrap().0["zarr.json"]);
}

/// Runs a script with arguments if its module is there.
fn python(module: &str, script: &str, arguments: &[PathBuf]) {
    let python = std::env::var_os("SINEW_PYTHON").unwrap_or_else(|| "python3".into());
    // Some of these programs leave a log in the folder in which they run.
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(&python);
    let found = command.current_dir(&folder).args(["-c", &format!("import {module}")]).output();
    if !found.is_ok_and(|output| output.status.success()) {
        println!("skipped: no {module}");
        return;
    }
    let mut command = Command::new(&python);
    let output = command.current_dir(&folder).args(["-c", script]).args(arguments).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn opensim_opens_trajectories_and_coordinates() {
    let script = "import sys, math, opensim
t = opensim.TimeSeriesTableVec3(sys.argv[1])
assert t.getNumRows() == 2 and list(t.getColumnLabels()) == ['RHip', 'R Wrist'], t.getColumnLabels()
p = t.getDependentColumnAtIndex(0)[0]
assert [p[0], p[1], p[2]] == [0.25, 0.92, -0.09]
assert math.isnan(t.getDependentColumnAtIndex(1)[1][0])
s = opensim.Storage(sys.argv[2])
assert s.getSize() == 2 and s.isInDegrees()
";
    python("opensim", script, &[golden("markers.trc"), golden("angles.mot")]);
}

#[test]
fn ezc3d_opens_points() {
    let script = "import sys, math, ezc3d
c = ezc3d.c3d(sys.argv[1])
point, points, header = c['parameters']['POINT'], c['data']['points'], c['header']['points']
assert points.shape == (4, 2, 2) and point['LABELS']['value'] == ['RHip', 'R Wrist'], points.shape
assert point['UNITS']['value'] == ['m'] and point['Y_SCREEN']['value'] == ['+Y'] and point['FRAMES']['value'][0] == 2
assert abs(header['frame_rate'] - 59.94) < 1e-5 and header['first_frame'] == 6 and header['last_frame'] == 7
assert all(abs(a - b) < 1e-7 for a, b in zip(points[:3, 0, 1], [0.25, 0.92, -0.09])), points[:, 0, 1]
assert math.isnan(points[0, 1, 1]) and abs(points[2, 1, 0] - 1 / 3) < 1e-7
assert c['data']['meta_points']['residuals'][0].T.tolist() == [[0, 0], [0, -1]]
assert c['data']['analogs'].shape[1] == 0 and c['parameters']['FORCE_PLATFORM']['USED']['value'][0] == 0
";
    python("ezc3d", script, &[golden("markers.c3d")]);
}

#[test]
fn blender_opens_skeletons() {
    let script = "import sys, bpy, addon_utils
addon_utils.enable('io_anim_bvh')
bpy.ops.import_anim.bvh(filepath=sys.argv[1])
rig = bpy.context.object
assert sorted(bone.name for bone in rig.pose.bones) == ['forearm', 'trunk', 'upper_arm']
for frame, wrist in [(1, (1.18, 2.0, 0.88)), (2, (1.74, 2.0, 1.44))]:
    bpy.context.scene.frame_set(frame)
    tail = rig.matrix_world @ rig.pose.bones['forearm'].tail
    assert all(abs(a - b) < 1e-5 for a, b in zip(tail, wrist)), (frame, tail)
";
    python("bpy", script, &[golden("motion.bvh")]);
}
