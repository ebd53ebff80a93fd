//! A body that is known by name, in a person's size, and its states along a recorded motion.
//!
//! Bodies get the lengths of the person's segments: the standard ones by [`crate::retarget`], HPPF24 and HAPF31 by [`median_lengths`]. These two then stay near the pose before ([`crate::damped_fit`]), so that twists of straight limbs do not
//! wander.

use crate::FollowError;
use crate::damped_fit::{MotionFollowing, states};
use crate::median_lengths::median_lengths;
use crate::retarget::retarget_to;
use sinew_body::points::{Trajectories, mean_distance, points_of_states};
use sinew_body::standard::{EVALUATION_JOINTS, cf28, h32};
use sinew_body::{KinematicTree, Proportions, hapf31, hppf24};

/// A body that follows motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NamedBody {
    /// The standard body, 32 degrees of freedom.
    H32,
    /// The body of Choo & Fleet (2001), 28.
    Cf28,
    /// The body of Husz, Wallace & Green (2007), 24.
    Hppf24,
    /// The body of Raskin, Rudzsky & Rivlin (2011), 31.
    Hapf31,
}

impl NamedBody {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::H32, Self::Cf28, Self::Hppf24, Self::Hapf31];

    /// Coordinates of the horizontal position.
    pub const HORIZONTAL: [usize; 2] = [0, 1];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::H32 => "h32",
            Self::Cf28 => "cf28",
            Self::Hppf24 => "hppf24",
            Self::Hapf31 => "hapf31",
        }
    }

    /// The body of that name.
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|body| body.name() == name)
    }

    /// The body in the size of an adult of 1.75 m.
    #[must_use]
    pub fn tree(self) -> KinematicTree {
        match self {
            Self::H32 => h32(&Proportions::default()),
            Self::Cf28 => cf28(&Proportions::default()),
            Self::Hppf24 => hppf24::tree(1.0),
            Self::Hapf31 => hapf31::sized(&Proportions::default()),
        }
    }
}

/// A body along a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Followed {
    /// The body in the person's size.
    pub body: KinematicTree,
    /// States, one a frame; angles are continuous in time.
    pub states: Vec<Vec<f64>>,
    /// Mean distance of the 15 joints of evaluation to their recorded positions, metres.
    pub mean_error_m: f64,
}

/// Twists of straight limbs stay where they are, and joints lag by less than a millimetre.
const FOLLOWING: MotionFollowing = MotionFollowing { damping: 1e-3, first_refits: 20 };

/// Makes a body follow a motion, frame by frame.
///
/// # Errors
/// [`FollowError::NoFrames`], [`FollowError::Body`] where a joint of evaluation is missing, [`FollowError::NoPose`] where the first frame does not determine a pose.
pub fn follow(body: NamedBody, motion: &Trajectories) -> Result<Followed, FollowError> {
    if motion.frames.is_empty() {
        return Err(FollowError::NoFrames);
    }
    if let Some(missing) = EVALUATION_JOINTS.iter().find(|joint| motion.index(joint).is_none()) {
        return Err(sinew_body::Error::NoPoint((*missing).to_owned()).into());
    }
    let found = match body {
        NamedBody::H32 => standard(h32, motion)?,
        NamedBody::Cf28 => standard(cf28, motion)?,
        NamedBody::Hppf24 => with_thickness(hppf24::sized(&median_lengths(motion, 0.0)?), motion)?,
        NamedBody::Hapf31 => with_thickness(hapf31::sized(&median_lengths(motion, waist())?), motion)?,
    };
    if found.states.iter().flatten().all(|x| x.is_finite()) { Ok(found) } else { Err(FollowError::NoPose) }
}

/// How far up an adult's trunk, from hips to shoulders, the waist is.
fn waist() -> f64 {
    let Proportions { pelvis_drop, shoulder_height, .. } = Proportions::default();
    pelvis_drop / (pelvis_drop + shoulder_height)
}

fn standard(build: fn(&Proportions) -> KinematicTree, motion: &Trajectories) -> Result<Followed, FollowError> {
    let found = retarget_to(build, motion).ok_or(FollowError::NoPose)?;
    Ok(Followed { body: found.body, states: found.states, mean_error_m: found.mean_error_m })
}

fn with_thickness(body: KinematicTree, motion: &Trajectories) -> Result<Followed, FollowError> {
    let recorded = motion.select(&EVALUATION_JOINTS);
    let states = states(&body, &recorded, &FOLLOWING)?;
    let reached = points_of_states(&body, &states).select(&EVALUATION_JOINTS);
    Ok(Followed { mean_error_m: mean_distance(&reached, &recorded), body, states })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cmu::joints;
    use crate::cmu::tests::{shared_data, trial};
    use crate::recorded::from_points;
    use sinew_formats::bvh::{self, forward_kinematics, world_from_bvh};
    use sinew_formats::point_table::PointTable;

    /// Mean error over the joints that a conversion may have, millimetres.
    const MOST_MM: f64 = 30.0;

    /// A BVH file of the shared recordings, 20 frames a second.
    fn skeleton_motion(name: &str) -> Option<Trajectories> {
        let text = std::fs::read_to_string(shared_data::shared("cmu_bvh")?.join(name)).unwrap();
        let bvh = bvh::read(name, &text).unwrap();
        let points = |row: &Vec<f64>| {
            forward_kinematics(&bvh.joints, row).into_iter().map(|point| Some(world_from_bvh(point))).collect()
        };
        let table = PointTable {
            names: bvh.point_names(),
            time_s: (0..bvh.frames.len()).map(|i| i as f64 * bvh.frame_time_s).collect(),
            frames: bvh.frames.iter().map(points).collect(),
        };
        Some(from_points(&table, bvh.frame_time_s.recip(), false, 20.0).unwrap().0)
    }

    fn check(name: &str, body: NamedBody, motion: &Trajectories) {
        let found = follow(body, motion).unwrap();
        assert_eq!(found.states.len(), motion.frames.len(), "{name}");
        let millimetres = 1000.0 * found.mean_error_m;
        println!("{name}, {}: {millimetres:.1} mm", body.name());
        assert!(millimetres < MOST_MM, "{name}, {}: {millimetres} mm", body.name());
    }

    #[test]
    fn every_body_follows_acclaim_files() {
        for name in ["07_01", "09_06", "131_04"] {
            let Some((skeleton, motion)) = trial(name) else { return };
            let motion = joints(&skeleton, &motion, 6.0);
            NamedBody::ALL.into_iter().for_each(|body| check(name, body, &motion));
        }
    }

    /// Without the feet, of which recordings show one point: it does not say how they roll.
    #[test]
    fn walks_of_one_person_have_the_same_angles_in_every_recording() {
        for (body, angles) in
            [(NamedBody::H32, 6..28), (NamedBody::Cf28, 6..28), (NamedBody::Hppf24, 6..24), (NamedBody::Hapf31, 6..31)]
        {
            let mut means: Vec<Vec<f64>> = vec![];
            for name in ["07_01", "07_02", "07_05", "07_10"] {
                let Some((skeleton, motion)) = trial(name) else { return };
                let states = follow(body, &joints(&skeleton, &motion, 2.0)).unwrap().states;
                let mean = |i: usize| states.iter().map(|state| state[i]).sum::<f64>() / states.len() as f64;
                means.push(angles.clone().map(mean).collect());
            }
            for (i, first) in angles.zip(&means[0]) {
                let apart = means.iter().map(|mean| (mean[i - 6] - first).abs()).fold(0.0, f64::max);
                assert!(apart < 0.5, "{}, coordinate {i}: {apart} rad", body.name());
            }
        }
    }

    #[test]
    fn every_body_follows_bvh_files() {
        for name in ["01_01.bvh", "131_01.bvh"] {
            let Some(motion) = skeleton_motion(name) else { return };
            NamedBody::ALL.into_iter().for_each(|body| check(name, body, &motion));
        }
    }

    #[test]
    fn bodies_have_their_names() {
        for body in NamedBody::ALL {
            assert_eq!(NamedBody::find(body.name()), Some(body));
        }
        assert_eq!(NamedBody::ALL.map(|body| body.tree().dof()), [32, 28, 24, 31]);
        assert_eq!(NamedBody::find("h31"), None);
    }

    #[test]
    fn motion_without_frames_or_joints_is_refused() {
        let body = hppf24::tree(1.0);
        let mut motion = points_of_states(&body, &[vec![0.0; body.dof()]]).select(&EVALUATION_JOINTS);
        assert_eq!(follow(NamedBody::H32, &Trajectories::default()), Err(FollowError::NoFrames));
        motion.names[10] = "elsewhere".into();
        for body in NamedBody::ALL {
            assert!(
                matches!(follow(body, &motion), Err(FollowError::Body(sinew_body::Error::NoPoint(joint))) if joint == EVALUATION_JOINTS[10])
            );
        }
    }
}
