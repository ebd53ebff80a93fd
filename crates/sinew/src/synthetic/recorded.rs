//! The joints of a motion file, whatever they are called there.
//!
//! A file of points or of a skeleton ([`crate::motion`]) gives the evaluation joints by our names, by those of the usual BVH skeletons (`LeftUpLeg`, `LeftHip`, …; case and what stands before a colon do not
//! matter) or, from ASF/AMC, as [`super::cmu`] takes them. The middle of the hips is computed; toes, heels and nose are taken where they are.
//!
//! BVH files state no unit. Of metres, CMU's unit (0.0254/0.45 m), inches, centimetres and millimetres the first is taken that gives legs of 0.6 to 1.2 m.

use super::cmu::{joints, resampled};
use super::points::Trajectories;
use super::space::{between, distance};
use crate::formats::point_table::PointTable;
use crate::formats::source_text::MAX_TEXT_BYTES;
use crate::formats::{amc, asf};
use crate::motion::{self, Content, Format};
use crate::{Error, files};
use std::path::Path;

/// A motion and what was odd about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// Points at the rate asked for, metres, z up.
    pub motion: Trajectories,
    /// What was odd, and what was assumed.
    pub warnings: Vec<String>,
}

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

/// Reads a motion at a rate; `skeleton` is the ASF file of an AMC file.
///
/// # Errors
/// What [`motion::read`] refuses; [`Error::Input`] for files without points, without one of the joints, or with a joint that is missing in a frame.
pub fn recorded(path: &Path, skeleton: Option<&Path>, rate_hz: f64) -> Result<Recorded, Error> {
    if let (Format::Amc, Some(skeleton)) = (Format::of(path)?, skeleton) {
        let skeleton = asf::read(&skeleton.display().to_string(), &files::read_text(skeleton, MAX_TEXT_BYTES)?)?;
        let motion = amc::read(&path.display().to_string(), &files::read_text(path, MAX_TEXT_BYTES)?, &skeleton)?;
        let warnings = motion.warnings.iter().map(ToString::to_string).collect();
        return Ok(Recorded { motion: joints(&skeleton, &motion, rate_hz), warnings });
    }
    let motion = motion::read(path, skeleton, None)?;
    let name = path.display();
    let refuse = |what: String| Error::Input { message: format!("{name}: {what}"), help: Some(HELP.into()) };
    let table = motion.points().ok_or_else(|| refuse("coordinates without a body tell no points".into()))?;
    if motion.rate_hz.is_nan() || motion.rate_hz <= 0.0 {
        return Err(refuse("a single frame is no motion".into()));
    }
    let mut found = named(&table).map_err(refuse)?;
    let mut warnings = Vec::new();
    if let Content::Skeleton(_) = motion.content {
        let (unit, metres) = unit_of(&found).ok_or_else(|| refuse("legs of no plausible length in any unit".into()))?;
        found.frames.iter_mut().flatten().flatten().for_each(|x| *x *= metres);
        if metres != 1.0 {
            warnings.push(format!("{name} is taken to be in {unit}, by the length of its legs"));
        }
    } else {
        warnings.extend(motion.warnings);
    }
    found.frames = resampled(&found.frames, motion.rate_hz / rate_hz);
    Ok(Recorded { motion: found, warnings })
}

const HELP: &str = "needed are the positions of neck, head, shoulders, elbows, wrists, hips, knees and ankles, as in BVH files or in `truth.trc` of `sinew demo`";

fn named(table: &PointTable) -> Result<Trajectories, String> {
    let theirs: Vec<String> =
        table.names.iter().map(|name| name.rsplit(':').next().unwrap_or(name).trim().to_lowercase()).collect();
    let column = |(_, names): &Names| names.iter().find_map(|name| theirs.iter().position(|their| their == name));
    let missing: Vec<&str> = NEEDED.iter().filter(|names| column(names).is_none()).map(|(name, _)| *name).collect();
    if !missing.is_empty() {
        return Err(format!("no joint is known as {}", missing.join(", ")));
    }
    let columns: Vec<(&str, usize)> =
        NEEDED.iter().chain(&WELCOME).filter_map(|names| Some((names.0, column(names)?))).collect();
    let mut motion = Trajectories {
        names: columns.iter().map(|(name, _)| (*name).to_owned()).chain(["MidHip".to_owned()]).collect(),
        frames: Vec::with_capacity(table.frames.len()),
    };
    let place = |name: &str| columns.iter().position(|(known, _)| *known == name).unwrap_or_default();
    let [left, right] = ["LHip", "RHip"].map(place);
    for (number, frame) in table.frames.iter().enumerate() {
        let mut points = Vec::with_capacity(columns.len() + 1);
        for (name, k) in &columns {
            let point = frame.get(*k).copied().flatten();
            points.push(point.ok_or_else(|| format!("{name} is missing in frame {number}, counted from 0"))?);
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
        assert_eq!(named(&table(&BVH, &points)).unwrap_err(), "no joint is known as RWrist");
        let mut holes = table(&names, &points);
        holes.frames[0][2] = None;
        assert_eq!(named(&holes).unwrap_err(), "LKnee is missing in frame 0, counted from 0");
    }

    #[test]
    fn units_are_told_from_the_legs() {
        for (unit, metres) in UNITS {
            let names = ["LHip", "LKnee", "LAnkle"].map(str::to_owned).to_vec();
            let frame = [0.95, 0.5, 0.08].map(|z| [0.0, 0.0, z / metres]).to_vec();
            assert_eq!(unit_of(&Trajectories { names, frames: vec![frame] }), Some((unit, metres)));
        }
    }
}
