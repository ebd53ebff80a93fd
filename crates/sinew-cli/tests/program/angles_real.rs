//! Angles of a real recording against its own markers, by the documented zeros.
//!
//! The zero pose is upright, arms hanging, feet at right angles: axes of every segment are taken from its markers by hand, the angles from these axes, and the files are read by hand, so that nothing
//! of the program but its two result files takes part.

use std::collections::HashMap;
use std::path::Path;
use std::process::Command;

type V3 = [f64; 3];
/// Right, forward and up axis of a segment in the world.
type Axes = [V3; 3];

fn sub(a: V3, b: V3) -> V3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn middle(a: V3, b: V3) -> V3 {
    [0, 1, 2].map(|k: usize| 0.5 * (a[k] + b[k]))
}

fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(v: V3) -> V3 {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

/// Axes of a segment from its right and its up axis.
fn axes(right: V3, up: V3) -> Axes {
    [right, cross(up, right), up]
}

/// Angles of the second segment from the first about the right, the forward and the up axis, in this order, degrees.
fn ball(from: Axes, to: Axes) -> V3 {
    let m = |i: usize, j: usize| dot(from[i], to[j]);
    [(-m(1, 2)).atan2(m(2, 2)), m(0, 2).atan2(m(0, 0).hypot(m(0, 1))), (-m(0, 1)).atan2(m(0, 0))].map(f64::to_degrees)
}

/// Markers of each frame in our world: (X, Y, Z) of the file is (y, z, x).
fn markers(path: &Path) -> Vec<HashMap<String, V3>> {
    let text = std::fs::read_to_string(path).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let names: Vec<&str> = lines[3].split('\t').skip(2).filter(|name| !name.is_empty()).collect();
    let frame = |line: &&str| {
        let numbers: Vec<f64> = line.split('\t').skip(2).map(|x| x.parse().unwrap()).collect();
        names.iter().zip(numbers.chunks(3)).map(|(name, p)| ((*name).to_owned(), [p[2], p[0], p[1]])).collect()
    };
    lines[5..].iter().filter(|line| !line.trim().is_empty()).map(frame).collect()
}

fn angles(path: &Path) -> Vec<HashMap<String, f64>> {
    let text = std::fs::read_to_string(path).unwrap();
    let lines: Vec<&str> = text.lines().skip_while(|line| !line.starts_with("time")).collect();
    let names: Vec<&str> = lines[0].split('\t').collect();
    let row = |line: &&str| {
        let numbers = line.split('\t').map(|x| x.parse::<f64>().unwrap());
        names.iter().map(|name| (*name).to_owned()).zip(numbers).collect()
    };
    lines[1..].iter().map(row).collect()
}

/// What the markers say of a frame. `girdle_rz` is taken as given: of the turns of spine and shoulders about the same axis markers show the sum.
fn expected(m: &HashMap<String, V3>, girdle: f64) -> HashMap<String, f64> {
    let at = |name: &str| m[name];
    let along = |from: &str, to: &str| unit(sub(at(to), at(from)));
    let mut out = HashMap::new();
    let mut put = |names: [&str; 3], side: &str, angles: V3, signs: V3| {
        for k in 0..3 {
            out.insert(format!("{}{side}", names[k]), signs[k] * angles[k]);
        }
    };
    let hips = middle(at("LHip"), at("RHip"));
    let right = along("LHip", "RHip");
    let pelvis = axes(right, cross(right, unit(cross(sub(at("Neck"), hips), right))));
    let world = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    put(["pelvis_tilt", "pelvis_list", "pelvis_rotation"], "", ball(world, pelvis), [1.0; 3]);
    let up = unit(sub(at("Neck"), middle(at("LShoulder"), at("RShoulder"))));
    let shoulders = axes(along("LShoulder", "RShoulder"), up);
    let [extension, bending, rotation] = ball(pelvis, shoulders);
    put(
        ["lumbar_extension", "lumbar_bending", "lumbar_rotation"],
        "",
        [extension, bending, rotation - girdle],
        [1.0; 3],
    );
    let (sin, cos) = (-girdle).to_radians().sin_cos();
    let turned = [0, 1, 2].map(|k: usize| cos * shoulders[0][k] + sin * shoulders[1][k]);
    // The face: its right axis goes through the eyes. The head's own turn is about the up, the forward and the right axis of the spine, in this order.
    let spine = axes(turned, up);
    let eyes = along("LEye", "REye");
    let [x, y, z] = spine.map(|axis| dot(axis, eyes));
    put(["head_rz", "head_ry", ""], "", [y.atan2(x).to_degrees(), (-z).asin().to_degrees(), 0.0], [1.0; 3]);
    for (side, suffix, sign) in [("R", "_r", 1.0), ("L", "_l", -1.0)] {
        let mirrored = [1.0, sign, sign];
        let name = |point: &str| format!("{side}{point}");
        let part = |from: &str, to: &str| along(&name(from), &name(to));
        let between = |a: V3, b: V3| dot(a, b).clamp(-1.0, 1.0).acos().to_degrees();
        // Hinges: elbows bend forwards, knees backwards.
        let (upper, lower) = (part("Shoulder", "Elbow"), part("Elbow", "Wrist"));
        let arm = axes(unit(cross(upper, lower)), upper.map(|x| -x));
        put(["arm_flex", "arm_add", "arm_rot"], suffix, ball(shoulders, arm), mirrored);
        let (thigh, shin) = (part("Hip", "Knee"), part("Knee", "Ankle"));
        let hinge = unit(cross(shin, thigh));
        put(
            ["hip_flexion", "hip_adduction", "hip_rotation"],
            suffix,
            ball(pelvis, axes(hinge, thigh.map(|x| -x))),
            mirrored,
        );
        // The sole is level at zero.
        let toe = |point: &str| sub(at(&name(point)), at(&name("Heel")));
        let normal = unit(cross(toe("SmallToe"), toe("BigToe"))).map(|x| sign * x);
        let [x, y, z] = axes(hinge, shin.map(|x| -x)).map(|axis| dot(axis, normal));
        put(
            ["elbow_flex", "knee_angle", "ankle_angle"],
            suffix,
            [between(upper, lower), between(thigh, shin), (-y).atan2(z).to_degrees()],
            [1.0; 3],
        );
        let foot = if side == "R" { "r_foot_ry" } else { "l_foot_ry" };
        put([foot, "", ""], "", [x.asin().to_degrees(), 0.0, 0.0], [1.0; 3]);
        // The plainest measure of an ankle is the line from heel to toes, seen along the hinge. Where the toes point out by `out` and the foot is turned by β about its own
        // forward axis, that line rises by atan(tan(out) sin β), with the ankle at zero.
        let line = middle(toe("BigToe"), toe("SmallToe"));
        let [across, y, z] = axes(hinge, shin.map(|x| -x)).map(|axis| dot(axis, line));
        let out_of_line = (across / x.asin().cos() / dot(line, line).sqrt()).asin();
        let rise = (-out_of_line.tan() * x).atan();
        put(["line", "line_rise", ""], suffix, [z.atan2(y).to_degrees(), rise.to_degrees(), 0.0], [1.0; 3]);
    }
    out.remove("");
    out
}

#[test]
fn angles_match_the_markers() {
    let Some(data) = sinew_tests::data::shared("pose2sim_single") else { return };
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let trial = data.join("T01_BalancingTrial/pose");
    let run = Command::new(env!("CARGO_BIN_EXE_sinew"))
        .args([
            "track",
            "--layout",
            "BODY_25B",
            "--fps",
            "60",
            "--seed",
            "1",
            "--simd",
            "baseline",
            "--no-progress",
            "--people",
            "1",
        ])
        .args(["--calibration".as_ref(), data.join("Calib.toml").as_os_str()])
        .args(["--keypoints".as_ref(), trial.as_os_str(), "-o".as_ref(), out.as_os_str()])
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let (markers, angles) = (markers(&out.join("markers.trc")), angles(&out.join("angles.mot")));
    assert_eq!((markers.len(), angles.len()), (100, 100));
    let mut compared = std::collections::BTreeMap::<String, f64>::new();
    let mut line_from_ankle = 0.0_f64;
    for (frame, (markers, found)) in markers.iter().zip(&angles).enumerate() {
        let expected = expected(markers, found["girdle_rz"]);
        for (name, found) in found {
            let Some(expected) = expected.get(name) else { continue };
            let apart = (found - expected).rem_euclid(360.0);
            let apart = apart.min(360.0 - apart);
            assert!(apart < 0.01, "frame {frame}: {name} = {found}, the markers say {expected}");
            let most = compared.entry(name.clone()).or_default();
            *most = most.max(apart);
        }
        for side in ["r", "l"] {
            let ankle = found[&format!("ankle_angle_{side}")];
            let (line, rise) = (expected[&format!("line_{side}")], expected[&format!("line_rise_{side}")]);
            assert!((line - rise - ankle).abs() < 0.01, "frame {frame}: {ankle}, the line has {line}, of this {rise}");
            line_from_ankle = line_from_ankle.max((ankle - line).abs());
        }
    }
    println!("largest differences, degrees: {compared:.4?}; of the line from heel to toes {line_from_ankle:.1}");
    // All but time, the three places of the pelvis, `girdle_rz`, and `head_rx`, for which a face has no zero.
    let left_out: Vec<&String> = angles[0].keys().filter(|name| !compared.contains_key(*name)).collect();
    assert_eq!((compared.len(), left_out.len()), (27, 6), "{left_out:?}");
}
