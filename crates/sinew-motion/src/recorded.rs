//! The joints of a motion file, whatever they are called there.
//!
//! A file of points or of a skeleton gives the evaluation joints by our names, by the names of the usual BVH skeletons (`LeftUpLeg`, `LeftHip`, …; case and what stands before a colon do not
//! matter) or, from ASF/AMC, as [`crate::cmu`] takes them. The middle of the hips is computed; toes, heels and nose are taken where they are.
//!
//! BVH files state no unit. Of metres, CMU's unit (0.0254/0.45 m), inches, centimetres and millimetres the first is taken that gives legs of 0.6 to 1.2 m.

use crate::FollowError;
use crate::cmu::resampled;
use sinew_body::points::{Trajectories, between, distance};
use sinew_formats::point_table::PointTable;

/// Our name and what others call the joint, in lower case, the best name first.
type Names = (&'static str, &'static [&'static str]);

const NEEDED: [Names; 14] = [
    ("Neck", &["neck", "neck1", "lowerneck", "head"]),
    ("LShoulder", &["leftarm", "lshoulder", "l_upper_arm", "leftshoulder"]),
    ("RShoulder", &["rightarm", "rshoulder", "r_upper_arm", "rightshoulder"]),
    ("LElbow", &["lelbow", "leftforearm", "leftelbow", "l_forearm"]),
    ("RElbow", &["relbow", "rightforearm", "rightelbow", "r_forearm"]),
    ("LWrist", &["lwrist", "lefthand", "leftwrist", "l_forearm_end"]),
    ("RWrist", &["rwrist", "righthand", "rightwrist", "r_forearm_end"]),
    ("LHip", &["lhip", "leftupleg", "lefthip", "l_thigh"]),
    ("RHip", &["rhip", "rightupleg", "righthip", "r_thigh"]),
    ("LKnee", &["lknee", "leftleg", "leftknee", "l_shin"]),
    ("RKnee", &["rknee", "rightleg", "rightknee", "r_shin"]),
    ("LAnkle", &["lankle", "leftfoot", "leftankle", "l_foot"]),
    ("RAnkle", &["rankle", "rightfoot", "rightankle", "r_foot"]),
    ("Head", &["head_end", "headtop", "headtop_end", "head"]),
];

const WELCOME: [Names; 5] = [
    ("LBigToe", &["lbigtoe", "lefttoebase", "lefttoe"]),
    ("RBigToe", &["rbigtoe", "righttoebase", "righttoe"]),
    ("LHeel", &["lheel"]),
    ("RHeel", &["rheel"]),
    ("Nose", &["nose"]),
];

/// Units that BVH files are written in, metres.
const UNITS: [(&str, f64); 5] =
    [("metres", 1.0), ("CMU's unit", 0.0254 / 0.45), ("inches", 0.0254), ("centimetres", 0.01), ("millimetres", 0.001)];
/// Plausible length of a leg, metres.
const LEG_M: std::ops::Range<f64> = 0.6..1.2;

/// A motion in points, at a rate, with the unit that was assumed where it is unknown: BVH files do not say it.
///
/// # Errors
/// [`FollowError::SingleFrame`], [`FollowError::UnknownJoints`], [`FollowError::Gap`], [`FollowError::Unit`].
pub fn from_points(
    table: &PointTable,
    recorded_hz: f64,
    is_in_metres: bool,
    rate_hz: f64,
) -> Result<(Trajectories, Option<&'static str>), FollowError> {
    if recorded_hz.is_nan() || recorded_hz <= 0.0 {
        return Err(FollowError::SingleFrame);
    }
    let mut found = named(table)?;
    let mut assumed = None;
    if !is_in_metres {
        let (unit, metres) = unit_of(&found).ok_or(FollowError::Unit)?;
        found.frames.iter_mut().flatten().flatten().for_each(|x| *x *= metres);
        assumed = (metres != 1.0).then_some(unit);
    }
    found.frames = resampled(&found.frames, recorded_hz / rate_hz);
    Ok((found, assumed))
}

/// The joints that are needed and those that are welcome, by our names.
fn named(table: &PointTable) -> Result<Trajectories, FollowError> {
    let theirs: Vec<String> =
        table.names.iter().map(|name| name.rsplit(':').next().unwrap_or(name).trim().to_lowercase()).collect();
    let column = |(_, names): &Names| names.iter().find_map(|name| theirs.iter().position(|their| their == name));
    let missing: Vec<&'static str> =
        NEEDED.iter().filter(|names| column(names).is_none()).map(|(name, _)| *name).collect();
    if !missing.is_empty() {
        return Err(FollowError::UnknownJoints(missing));
    }
    let columns: Vec<(&'static str, usize)> =
        NEEDED.iter().chain(&WELCOME).filter_map(|names| Some((names.0, column(names)?))).collect();
    let mut motion = Trajectories {
        names: columns.iter().map(|(name, _)| (*name).to_owned()).chain(["MidHip".to_owned()]).collect(),
        frames: Vec::with_capacity(table.frames.len()),
    };
    let place = |name: &str| columns.iter().position(|(known, _)| *known == name).unwrap_or_default();
    let [left, right] = ["LHip", "RHip"].map(place);
    for (number, frame) in table.frames.iter().enumerate() {
        let mut points = Vec::with_capacity(columns.len() + 1);
        for &(joint, k) in &columns {
            let point = frame.get(k).copied().flatten();
            points.push(point.ok_or(FollowError::Gap { joint, frame: number })?);
        }
        points.push(between(points[left], points[right], 0.5));
        motion.frames.push(points);
    }
    Ok(motion)
}

/// The unit in which the legs of the first frame are plausible.
fn unit_of(motion: &Trajectories) -> Option<(&'static str, f64)> {
    let first = motion.frames.first()?;
    let at = |name: &str| motion.index(name).map(|k| first[k]);
    let leg = distance(at("LHip")?, at("LKnee")?) + distance(at("LKnee")?, at("LAnkle")?);
    UNITS.into_iter().find(|(_, metres)| LEG_M.contains(&(leg * metres)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(names: &[&str], points: &[[f64; 3]]) -> PointTable {
        PointTable {
            names: names.iter().map(|name| (*name).to_owned()).collect(),
            time_s: vec![0.0],
            frames: vec![points.iter().map(|point| Some(*point)).collect()],
        }
    }

    const BVH: [&str; 16] = [
        "Hips",
        "mixamorig:LeftUpLeg",
        "LeftLeg",
        "LeftFoot",
        "RightUpLeg",
        "RightLeg",
        "RightFoot",
        "Neck",
        "Head",
        "Head_End",
        "LeftShoulder",
        "LeftArm",
        "LeftForeArm",
        "LeftHand",
        "RightArm",
        "RightForeArm",
    ];

    #[test]
    fn joints_are_found_by_the_names_of_others() {
        let mut names = BVH.to_vec();
        names.push("RightHand");
        let points: Vec<[f64; 3]> = (0..names.len()).map(|k| [k as f64, 0.0, 0.0]).collect();
        let found = named(&table(&names, &points)).unwrap();
        let x = |name: &str| found.frames[0][found.index(name).unwrap()][0];
        assert_eq!([x("LHip"), x("LShoulder"), x("Head"), x("Neck"), x("MidHip")], [1.0, 11.0, 9.0, 7.0, 2.5]);
        assert_eq!(named(&table(&BVH, &points)).unwrap_err().to_string(), "no joint is known as RWrist");
        let mut holes = table(&names, &points);
        holes.frames[0][2] = None;
        assert_eq!(named(&holes).unwrap_err().to_string(), "LKnee is missing in frame 0, counted from 0");
    }

    #[test]
    fn units_are_recognised_by_the_legs() {
        for (unit, metres) in UNITS {
            let names = ["LHip", "LKnee", "LAnkle"].map(str::to_owned).to_vec();
            let frame = [0.95, 0.5, 0.08].map(|z| [0.0, 0.0, z / metres]).to_vec();
            assert_eq!(unit_of(&Trajectories { names, frames: vec![frame] }), Some((unit, metres)));
        }
    }
}
