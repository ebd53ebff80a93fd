//! Angles of joints as OpenSim or the ISB name them, and their values in a state.
//!
//! The rotation of a link relative to another (or to the ground) is the product of the joints between them. It is read as three angles ([`crate::decomposition`]); which link
//! is read against which, in what order and with what sign, is the list of a [`Convention`] ([`crate::columns`]). docs/reference/angles.md has a drawing of each.
//!
//! Angles are continuous: of all that give the same rotation, those nearest to the angles before. Draws of a posterior take the ones nearest to the angles of its mean pose, so
//! that an interval lies about them and is not cut where an angle begins again at minus half a turn.

use crate::columns::{Convention, columns};
use crate::link_angles::{CoordinateSource, LinkAngles};
use crate::observed;
use sinew_body::KinematicTree;

/// Numbers of an angle before its sign: three for each link.
const RAW: usize = 3;

/// The angles of a body that a run writes.
#[derive(Clone, Debug, PartialEq)]
pub struct JointAngles {
    convention: Convention,
    names: Vec<String>,
    columns: Vec<(Vec<String>, CoordinateSource)>,
    links: Vec<LinkAngles>,
    /// Place among the numbers before signs, and sign, of each angle.
    places: Vec<(usize, f64)>,
}

impl JointAngles {
    /// Angles of a body by a convention. A link of which neither keypoints nor masks show anything has none.
    #[must_use]
    pub fn new(body: &KinematicTree, keypoints: &[String], has_masks: bool, convention: Convention) -> Self {
        let is_shown = |(_, source): &(_, CoordinateSource)| {
            has_masks || keypoints.is_empty() || observed::is_shown(body, keypoints, source)
        };
        let columns: Vec<_> = columns(body, convention).into_iter().filter(is_shown).collect();
        let (mut names, mut links, mut places) = (vec![], vec![], vec![]);
        for (own, source) in &columns {
            let CoordinateSource::Angles(angles) = source else { continue };
            names.extend(own.iter().cloned());
            let kept = (0..RAW).filter(|k| angles.kept[*k]);
            places.extend(kept.map(|k| (RAW * links.len() + k, angles.signs[k])));
            links.push(angles.clone());
        }
        Self { convention, names, columns, links, places }
    }

    /// Whose definitions they follow.
    #[must_use]
    pub const fn convention(&self) -> Convention {
        self.convention
    }

    /// Names and sources of all columns of `angles.mot`, in order.
    #[must_use]
    pub fn columns(&self) -> &[(Vec<String>, CoordinateSource)] {
        &self.columns
    }

    /// Names of the angles.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Numbers before signs: three for each link that is read.
    #[must_use]
    pub fn raw_count(&self) -> usize {
        RAW * self.links.len()
    }

    /// Angles in a state before signs, radians, nearest to those before where there are such; `out` and `before` have [`JointAngles::raw_count`] numbers.
    pub fn raw(&self, state: &[f64], before: Option<&[f64]>, out: &mut [f64]) {
        for (k, (link, out)) in self.links.iter().zip(out.as_chunks_mut().0).enumerate() {
            *out = link.raw(state, before.map(|before| [0, 1, 2].map(|i| before[RAW * k + i])));
        }
    }

    /// One of the angles with its sign, from the numbers before signs.
    #[must_use]
    pub fn signed(&self, angle: usize, raw: &[f64]) -> f64 {
        let (place, sign) = self.places[angle];
        sign * raw[place]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::{Proportions, standard};

    fn h32() -> KinematicTree {
        standard::h32(&Proportions::default())
    }

    fn named(angles: &JointAngles, state: &[f64], name: &str) -> f64 {
        let mut raw = vec![0.0; angles.raw_count()];
        angles.raw(state, None, &mut raw);
        let index = angles.names().iter().position(|own| own == name).unwrap_or_else(|| panic!("{name}"));
        angles.signed(index, &raw)
    }

    /// The state of H32 with some of its angles, by the body's own names, radians.
    fn state(body: &KinematicTree, angles: &[(&str, f64)]) -> Vec<f64> {
        let names = body.dof_names();
        let mut state = vec![0.0; body.dof()];
        for (name, angle) in angles {
            state[names.iter().position(|own| own == name).unwrap()] = *angle;
        }
        state
    }

    /// A movement of each joint as anatomy names it, right and left: the same number on both sides.
    #[test]
    fn movements_of_anatomy_are_positive_and_alike_on_both_sides() {
        let body = h32();
        let t = 0.5;
        // The body's own angles turn by the right hand about right, forward and up. A leg that swings forward turns about right;
        // outward, the right one turns about back, the left one about forward; inward rotation turns the right one about up, the left one about down.
        let movements: [(&str, &str, f64, f64); 8] = [
            ("hip_flexion", "thigh.rx", t, t),
            ("hip_adduction", "thigh.ry", t, -t),
            ("hip_rotation", "thigh.rz", t, -t),
            ("knee_angle", "shin.rx", -t, -t),
            ("ankle_angle", "foot.rx", t, t),
            ("arm_flex", "upper_arm.rx", t, t),
            ("arm_rot", "upper_arm.rz", t, -t),
            ("elbow_flex", "forearm.rx", t, t),
        ];
        let opensim = JointAngles::new(&body, &[], false, Convention::OpenSim);
        for (name, own, right, left) in movements {
            for (prefix, suffix, angle) in [("r_", "_r", right), ("l_", "_l", left)] {
                let state = state(&body, &[(&format!("{prefix}{own}"), angle)]);
                assert!((named(&opensim, &state, &format!("{name}{suffix}")) - t).abs() < 1e-12, "{name}{suffix}");
            }
        }
        let isb = JointAngles::new(&body, &[], false, Convention::Isb);
        // Soles that face each other; a nod; the head to the right shoulder, and turned to the left; the trunk likewise.
        let others = [
            ("ankle_inversion_r", "r_foot.ry", t),
            ("ankle_inversion_l", "l_foot.ry", -t),
            ("neck_flexion", "head.rx", -t),
            ("neck_bending", "head.ry", t),
            ("neck_rotation", "head.rz", t),
            ("trunk_bending", "spine.ry", t),
            ("trunk_rotation", "girdle.rz", t),
        ];
        for (name, own, angle) in others {
            assert!((named(&isb, &state(&body, &[(own, angle)]), name) - t).abs() < 1e-12, "{name}");
        }
    }

    /// An arm raised sideways, forward and backward, and turned inward about itself.
    #[test]
    fn the_plane_of_elevation_is_0_sideways_and_90_degrees_forward() {
        let body = h32();
        let isb = JointAngles::new(&body, &[], false, Convention::Isb);
        let quarter = std::f64::consts::FRAC_PI_2;
        for (prefix, suffix, side) in [("r_", "_r", 1.0), ("l_", "_l", -1.0)] {
            let own = |axis: &str| format!("{prefix}upper_arm.{axis}");
            let read = |state: &[f64]| {
                ["plane", "elevation", "rotation"].map(|what| named(&isb, state, &format!("shoulder_{what}{suffix}")))
            };
            let is_near = |found: [f64; 3], expected: [f64; 3]| {
                let apart = found.iter().zip(expected).map(|(a, b)| (a - b).sin().abs() + (a - b).cos() - 1.0);
                apart.fold(0.0_f64, |most, x| most.max(x.abs())) < 1e-9
            };
            // The right arm goes outward when it turns about back.
            let sideways = state(&body, &[(&own("ry"), -side * 1.2)]);
            assert!(is_near(read(&sideways), [0.0, 1.2, 0.0]), "{:?}", read(&sideways));
            let forward = state(&body, &[(&own("rx"), 1.2)]);
            assert!(is_near(read(&forward), [quarter, 1.2, -quarter]), "{:?}", read(&forward));
            let backward = state(&body, &[(&own("rx"), -0.7)]);
            assert!(is_near(read(&backward), [-quarter, 0.7, quarter]), "{:?}", read(&backward));
        }
    }

    #[test]
    fn angles_follow_a_body_that_turns_twice() {
        let body = h32();
        let angles = JointAngles::new(&body, &[], false, Convention::OpenSim);
        let mut before: Option<Vec<f64>> = None;
        let index = angles.names().iter().position(|name| name == "pelvis_rotation").unwrap();
        for step in 0..60 {
            let turn = 0.2 * f64::from(step);
            let mut raw = vec![0.0; angles.raw_count()];
            angles.raw(&state(&body, &[("pelvis.rz", turn)]), before.as_deref(), &mut raw);
            assert!((angles.signed(index, &raw) - turn).abs() < 1e-9, "{turn}");
            before = Some(raw);
        }
    }
}
