//! What each angle of a joint is: `docs/images/angles-*.svg`, the drawings of docs/reference/angles.md.
//!
//! Of each angle the standard body at 0° and at 30°, side by side, seen from the side on which it shows. The poses are written down here by the body's own degrees of freedom, and an angle that does not read 30° more in the second
//! than in the first, all others of its joint alike, is an error: drawings cannot say other than the program does.

use crate::support::outcome::Outcome;
use sinew::angles::{Convention, JointAngles};
use sinew::body::{KinematicTree, Proportions, standard};
use sinew::formats::rotation::{about_axis, product};
use sinew_setup::posed_body::pose;
use std::fmt::Write as _;

/// Degrees of freedom of the body, degrees.
type Degrees = &'static [(&'static str, f64)];

/// From where a figure is seen.
#[derive(Clone, Copy)]
enum Seen {
    /// From the person's right: forward is right.
    Right,
    /// From the front: the person's right is left.
    Front,
    /// From above: forward is up.
    Above,
    /// From above, smaller, for arms that are raised.
    AboveAll,
    /// The right foot from the front.
    Foot,
}

impl Seen {
    const fn words(self) -> &'static str {
        match self {
            Self::Right => "from the right",
            Self::Front | Self::Foot => "from the front",
            Self::Above | Self::AboveAll => "from above",
        }
    }

    /// Pixels of a metre.
    const fn scale(self) -> f64 {
        match self {
            Self::Right | Self::Front => 62.0,
            Self::Above => 150.0,
            Self::AboveAll => 99.0,
            Self::Foot => 330.0,
        }
    }

    /// What lies in the middle of a figure, and how far below the top of its cell.
    const fn middle(self) -> (&'static str, f64) {
        match self {
            Self::Right | Self::Front => ("MidHip", 94.0),
            Self::Above | Self::AboveAll => ("MidHip", 104.0),
            Self::Foot => ("RAnkle", 92.0),
        }
    }
}

/// An angle, what a positive one is called, from where it is drawn, and the two poses.
struct Drawing {
    name: &'static str,
    says: &'static str,
    seen: Seen,
    zero: Degrees,
    moved: Degrees,
}

const fn drawing(name: &'static str, says: &'static str, seen: Seen, zero: Degrees, moved: Degrees) -> Drawing {
    Drawing { name, says, seen, zero, moved }
}

/// A sheet of drawings.
pub(super) struct Sheet {
    pub(super) file: &'static str,
    title: &'static str,
    convention: Convention,
    drawings: &'static [Drawing],
}

const BENT: Degrees = &[("r_forearm.rx", 90.0)];
const RAISED: Degrees = &[("r_upper_arm.ry", -60.0)];
const RAISED_AND_BENT: Degrees = &[("r_upper_arm.ry", -60.0), ("r_forearm.rx", 90.0)];

use Seen::{Above, AboveAll, Foot, Front, Right};

/// The sheets.
pub(super) const SHEETS: [Sheet; 3] = [
    Sheet {
        file: "angles-legs.svg",
        title: "Pelvis and leg, at 0° and at +30°",
        convention: Convention::OpenSim,
        drawings: &[
            drawing("pelvis_tilt", "backward", Right, &[], &[("pelvis.rx", 30.0)]),
            drawing("pelvis_list", "right side down", Front, &[], &[("pelvis.ry", 30.0)]),
            drawing("pelvis_rotation", "to the left", Above, &[], &[("pelvis.rz", 30.0)]),
            drawing("hip_flexion_r", "forward", Right, &[], &[("r_thigh.rx", 30.0)]),
            drawing("hip_adduction_r", "inward", Front, &[], &[("r_thigh.ry", 30.0)]),
            drawing("hip_rotation_r", "toes inward", Above, &[], &[("r_thigh.rz", 30.0)]),
            drawing("knee_angle_r", "flexion", Right, &[], &[("r_shin.rx", -30.0)]),
            drawing("ankle_angle_r", "dorsiflexion", Right, &[], &[("r_foot.rx", 30.0)]),
            drawing("r_foot_ry", "right: sole inward", Foot, &[], &[("r_foot.ry", 30.0)]),
        ],
    },
    Sheet {
        file: "angles-trunk.svg",
        title: "Trunk, head and arm, at 0° and at +30°",
        convention: Convention::OpenSim,
        drawings: &[
            drawing("lumbar_bending", "to the right", Front, &[], &[("spine.ry", 30.0)]),
            drawing("lumbar_rotation", "to the left", Above, &[], &[("spine.rz", 30.0)]),
            drawing("girdle_rz", "to the left", Above, &[], &[("girdle.rz", 30.0)]),
            drawing("head_rx", "backward", Right, &[], &[("head.rx", 30.0)]),
            drawing("head_ry", "to the right", Front, &[], &[("head.ry", 30.0)]),
            drawing("head_rz", "to the left", Above, &[], &[("head.rz", 30.0)]),
            drawing("arm_flex_r", "forward", Right, &[], &[("r_upper_arm.rx", 30.0)]),
            drawing("arm_add_r", "inward", Front, &[], &[("r_upper_arm.ry", 30.0)]),
            drawing("arm_rot_r", "inward", Above, BENT, &[("r_upper_arm.rz", 30.0), ("r_forearm.rx", 90.0)]),
            drawing("elbow_flex_r", "flexion", Right, &[], &[("r_forearm.rx", 30.0)]),
        ],
    },
    Sheet {
        file: "angles-isb.svg",
        title: "Where --angles isb differs, at 0° and at +30°",
        convention: Convention::Isb,
        drawings: &[
            drawing("pelvic_tilt", "top forward", Right, &[], &[("pelvis.rx", -30.0)]),
            drawing("pelvic_obliquity", "right side down", Front, &[], &[("pelvis.ry", 30.0)]),
            drawing("pelvic_rotation", "to the left", Above, &[], &[("pelvis.rz", 30.0)]),
            drawing("trunk_bending", "to the right", Front, &[], &[("spine.ry", 30.0)]),
            drawing("trunk_rotation", "to the left", Above, &[], &[("girdle.rz", 30.0)]),
            drawing("ankle_inversion_r", "sole inward", Foot, &[], &[("r_foot.ry", 30.0)]),
            drawing("neck_flexion", "forward", Right, &[], &[("head.rx", -30.0)]),
            drawing("neck_bending", "to the right", Front, &[], &[("head.ry", 30.0)]),
            drawing("neck_rotation", "to the left", Above, &[], &[("head.rz", 30.0)]),
            drawing(
                "shoulder_plane_r",
                "forward, raised 60°",
                AboveAll,
                RAISED,
                &[("r_upper_arm.rz", 30.0), ("r_upper_arm.ry", -60.0)],
            ),
            drawing("shoulder_elevation_r", "raised, from 60°", Front, RAISED, &[("r_upper_arm.ry", -90.0)]),
            drawing("shoulder_rotation_r", "inward, raised 60°", AboveAll, RAISED_AND_BENT, ROTATED),
        ],
    },
];

/// Stands for the arm raised by 60° and turned inward about itself by 30°, whose angles are worked out.
const ROTATED: Degrees = &[("r_forearm.rx", 90.0)];

/// Up–forward–right angles of the arm R_y(−60°) R_z(30°), degrees.
fn rotated_arm() -> [f64; 3] {
    let m = product(&about_axis(1, (-60.0_f64).to_radians()), &about_axis(2, 30.0_f64.to_radians()));
    [m[1][0].atan2(m[0][0]), (-m[2][0]).asin(), m[2][1].atan2(m[2][2])].map(f64::to_degrees)
}

fn state(body: &KinematicTree, degrees: &[(&str, f64)]) -> Outcome<Vec<f64>> {
    let names = body.dof_names();
    let mut state = vec![0.0; body.dof()];
    for (name, angle) in degrees {
        let dof = names.iter().position(|own| own == name).ok_or(format!("no {name}"))?;
        state[dof] = angle.to_radians();
    }
    Ok(state)
}

/// The states of both poses, checked: all angles of the convention but the one that is drawn, and of others those that move with it, read alike.
fn states(body: &KinematicTree, sheet: &Sheet, drawing: &Drawing) -> Outcome<[Vec<f64>; 2]> {
    let angles = JointAngles::new(body, &[], false, sheet.convention);
    let mut moved = drawing.moved.to_vec();
    if drawing.name == "shoulder_rotation_r" {
        moved.extend(["r_upper_arm.rz", "r_upper_arm.ry", "r_upper_arm.rx"].into_iter().zip(rotated_arm()));
    }
    let states = [state(body, drawing.zero)?, state(body, &moved)?];
    let read = |state: &[f64]| {
        let mut raw = vec![0.0; angles.raw_count()];
        angles.raw(state, None, &mut raw);
        (0..angles.names().len()).map(|k| angles.signed(k, &raw).to_degrees()).collect::<Vec<f64>>()
    };
    let joint = drawing.name.split('_').next().unwrap_or_default();
    for ((name, a), b) in angles.names().iter().zip(read(&states[0])).zip(read(&states[1])) {
        let expected = if *name == drawing.name { 30.0 } else { 0.0 };
        let is_of_joint = name.starts_with(joint) && name.ends_with("_r") == drawing.name.ends_with("_r");
        if (*name == drawing.name || is_of_joint) && (b - a - expected).abs() > 1e-9 {
            return Err(format!("{name} goes from {a}° to {b}° where {} is drawn", drawing.name).into());
        }
    }
    if !angles.names().iter().any(|name| name == drawing.name) {
        return Err(format!("no angle {}", drawing.name).into());
    }
    Ok(states)
}

const LINES: [&[&str]; 8] = [
    &["Neck", "Head", "Nose", "Neck", "MidHip"],
    &["LShoulder", "RShoulder"],
    &["LShoulder", "LElbow", "LWrist"],
    &["RShoulder", "RElbow", "RWrist"],
    &["LHip", "RHip"],
    &["LHip", "LKnee", "LAnkle", "LHeel", "LBigToe", "LSmallToe", "LAnkle"],
    &["RHip", "RKnee", "RAnkle", "RHeel", "RBigToe", "RSmallToe", "RAnkle"],
    &["LEye", "REye"],
];

/// The lower end of the shin, which the ankle stands for, and the foot.
const FOOT: [&[&str]; 1] = [&["RAnkle", "RHeel", "RBigToe", "RSmallToe", "RHeel", "RAnkle", "RBigToe"]];

const CELL: [f64; 2] = [236.0, 158.0];
const COLUMNS: usize = 3;
const TOP: f64 = 40.0;

/// Path data of a figure about a place.
fn figure(body: &KinematicTree, state: &[f64], seen: Seen, [x, y]: [f64; 2]) -> Outcome<String> {
    let posed = pose(body, state);
    let at =
        |name: &str| -> Outcome<[f64; 3]> { Ok(posed.points[body.point_index(name).ok_or(format!("no {name}"))?]) };
    let (scale, middle) = (seen.scale(), at(seen.middle().0)?);
    let place = |at: [f64; 3]| {
        let [right, forward, up] = [0, 1, 2].map(|k: usize| scale * (at[k] - middle[k]));
        match seen {
            Seen::Right => [x + forward, y - up],
            Seen::Front | Seen::Foot => [x - right, y - up],
            Seen::Above | Seen::AboveAll => [x + right, y - forward],
        }
    };
    let mut path = String::new();
    let lines = if matches!(seen, Seen::Foot) { &FOOT[..] } else { &LINES };
    for line in lines {
        for (k, name) in line.iter().enumerate() {
            let [x, y] = place(at(name)?);
            write!(path, "{}{x:.0} {y:.0}", if k == 0 { "M" } else { "L" })?;
        }
    }
    Ok(path)
}

const STYLE: &str = "text{font:12px system-ui,sans-serif;fill:#3c4654}.h{font-size:15px;font-weight:600}.c{font-weight:600}\
path{fill:none;stroke-width:2;stroke-linecap:round;stroke-linejoin:round;stroke:#8b96a3}.m{stroke:#0072b2}";

/// A sheet as SVG.
pub(super) fn svg(sheet: &Sheet) -> Outcome<String> {
    let body = standard::h32(&Proportions::default());
    let rows = sheet.drawings.len().div_ceil(COLUMNS);
    let (width, height) = (COLUMNS as f64 * CELL[0], TOP + rows as f64 * CELL[1]);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" role=\"img\" aria-label=\"{}\">\
         <style>{STYLE}</style><rect width=\"{width}\" height=\"{height}\" rx=\"8\" fill=\"#fff\"/><text class=\"h\" x=\"12\" y=\"24\">{}</text>\n",
        sheet.title, sheet.title
    );
    for (k, drawing) in sheet.drawings.iter().enumerate() {
        let [left, top] = [(k % COLUMNS) as f64 * CELL[0], TOP + (k / COLUMNS) as f64 * CELL[1]];
        let (from, middle) = (drawing.seen.words(), top + drawing.seen.middle().1);
        let [zero, moved] = states(&body, sheet, drawing)?;
        writeln!(
            svg,
            "<text class=\"c\" x=\"{}\" y=\"{}\">{}</text><text x=\"{}\" y=\"{}\">{}, {from}</text><path d=\"{}\"/><path class=\"m\" d=\"{}\"/>",
            left + 12.0,
            top + 12.0,
            drawing.name,
            left + 12.0,
            top + 26.0,
            drawing.says,
            figure(&body, &zero, drawing.seen, [left + 62.0, middle])?,
            figure(&body, &moved, drawing.seen, [left + 168.0, middle])?
        )?;
    }
    svg.push_str("</svg>\n");
    Ok(svg)
}
