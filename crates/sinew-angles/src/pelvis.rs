//! Angles of the pelvis against the ground, by two conventions.
//!
//! | names | rotation | |
//! |---|---|---|
//! | `pelvis_tilt`, `pelvis_list`, `pelvis_rotation` | R_x(tilt) R_y(list) R_z(rotation) | OpenSim's `ground_pelvis`: about axes of the ground, so that tilt and list depend on where somebody faces |
//! | `pelvic_tilt`, `pelvic_obliquity`, `pelvic_rotation` | R_z(rotation) R_y(obliquity) R_x(−tilt) | Baker, Gait & Posture 13 (2001) 1–6: tilt and obliquity do not |
//!
//! Three angles determine the rotation, so that either come from the other.

use crate::decomposition::{AngleSequence, near, turned};

/// Names in OpenSim's models: tilt, list, rotation.
pub const OPENSIM_PELVIS: [&str; 3] = ["pelvis_tilt", "pelvis_list", "pelvis_rotation"];

/// Names after Baker: tilt, obliquity, rotation.
pub const ISB_PELVIS: [&str; 3] = ["pelvic_tilt", "pelvic_obliquity", "pelvic_rotation"];

/// Signs of Baker's angles against turns about right, forward and up: the top forward is a positive tilt.
pub(crate) const ISB_SIGNS: [f64; 3] = [-1.0, 1.0, 1.0];

const IDENTITY: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Baker's angles from OpenSim's, radians, nearest to the angles of the frame before where there is one.
#[must_use]
pub fn baker_from_opensim(opensim: [f64; 3], before: Option<[f64; 3]>) -> [f64; 3] {
    let m = (0..3).fold(IDENTITY, |m, axis| turned(m, axis, opensim[axis]));
    let sequence = AngleSequence::RotationObliquityTilt;
    let signed = |angles: [f64; 3]| [0, 1, 2].map(|k: usize| ISB_SIGNS[k] * angles[k]);
    let raw = sequence.angles(&m);
    signed(before.map_or(raw, |before| near(sequence, raw, signed(before))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Convention, JointAngles};
    use sinew_body::{KinematicTree, Proportions, standard};

    fn pelvis(body: &KinematicTree, state: &[f64], convention: Convention, wanted: [&str; 3]) -> [f64; 3] {
        let angles = JointAngles::new(body, &[], false, convention);
        let mut raw = vec![0.0; angles.raw_count()];
        angles.raw(state, None, &mut raw);
        wanted.map(|wanted| angles.signed(angles.names().iter().position(|name| name == wanted).unwrap(), &raw))
    }

    /// A world turned about the vertical, of somebody who leans forward and to the right; both bodies.
    #[test]
    fn a_turned_world_changes_the_rotation_alone_and_opensims_angles_lead_there() {
        for body in [standard::h32(&Proportions::default()), standard::cf28(&Proportions::default())] {
            let names = body.dof_names();
            let root = names.iter().position(|name| name.ends_with(".rz")).unwrap();
            let mut found = vec![];
            for turn in [0.0, 90.0_f64, 180.0, -90.0] {
                let mut state = vec![0.0; body.dof()];
                for (dof, name) in names.iter().enumerate().filter(|(_, name)| name.starts_with(&names[root][..3])) {
                    state[dof] =
                        if name.ends_with("ry") { 0.1 } else { 0.0 } - if name.ends_with("rx") { 0.3 } else { 0.0 };
                }
                state[root] += 0.2 + turn.to_radians();
                let baker = pelvis(&body, &state, Convention::Isb, ISB_PELVIS);
                let opensim = pelvis(&body, &state, Convention::OpenSim, OPENSIM_PELVIS);
                let led = baker_from_opensim(opensim, Some(baker));
                assert!(led.iter().zip(baker).all(|(a, b)| (a - b).abs() < 1e-9), "{led:?} {baker:?}");
                let [tilt, obliquity, rotation] = baker;
                let away = rotation - turn.to_radians();
                found.push([tilt, obliquity, away.sin(), away.cos()]);
            }
            assert!((found[0][0] - 0.3).abs() < 1e-9 && (found[0][1] - 0.1).abs() < 1e-9, "{found:?}");
            for other in &found[1..] {
                assert!(other.iter().zip(&found[0]).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
            }
        }
    }
}
