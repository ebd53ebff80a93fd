//! The joints of recordings of the CMU database, from ASF/AMC files.
//!
//! Positions of the evaluation joints in our world, `(x, y, z) → (x, −z, y)`, in metres, resampled linearly to a lower rate. The names mean
//! the *ends* of CMU's bones: hips and shoulders are the ends of the hip joints and clavicles, elbow, wrist, knee and ankle the ends of humerus, radius, femur and tibia, the
//! neck base that of the thorax, the head top that of the head; `MidHip` is the middle of the hips and `Spine` the root. The balls of the feet (`LBigToe`, `RBigToe`) go beyond
//! the fifteen: without them the feet's angles mean nothing.
//!
//! The database: "The data used in this project was obtained from mocap.cs.cmu.edu. The database was created with funding from NSF EIA-0196217."

use sinew_body::points::{Trajectories, between};
use sinew_formats::amc::Amc;
use sinew_formats::asf::Asf;

/// Frames per second of the database's recordings.
pub const RATE_HZ: f64 = 120.0;

/// Our name and the bones whose ends it is the middle of.
const JOINTS: [(&str, &[&str]); 18] = [
    ("MidHip", &["lhipjoint", "rhipjoint"]),
    ("Neck", &["thorax"]),
    ("LShoulder", &["lclavicle"]),
    ("RShoulder", &["rclavicle"]),
    ("LElbow", &["lhumerus"]),
    ("RElbow", &["rhumerus"]),
    ("LWrist", &["lradius"]),
    ("RWrist", &["rradius"]),
    ("LHip", &["lhipjoint"]),
    ("RHip", &["rhipjoint"]),
    ("LKnee", &["lfemur"]),
    ("RKnee", &["rfemur"]),
    ("LAnkle", &["ltibia"]),
    ("RAnkle", &["rtibia"]),
    ("Head", &["head"]),
    ("LBigToe", &["lfoot"]),
    ("RBigToe", &["rfoot"]),
    ("Spine", &["root"]),
];

/// Positions of the joints that the skeleton has, every `step`-th frame (a fraction of a frame is interpolated).
#[must_use]
pub fn joints(skeleton: &Asf, motion: &Amc, step: f64) -> Trajectories {
    let bones = skeleton.point_names();
    let sources: Vec<(&str, Vec<usize>)> = JOINTS
        .iter()
        .filter_map(|(name, ends)| {
            let ends = ends.iter().map(|end| bones.iter().position(|bone| bone == end));
            Some((*name, ends.collect::<Option<Vec<_>>>()?))
        })
        .collect();
    let recorded: Vec<Vec<[f64; 3]>> = motion
        .frames
        .iter()
        .map(|frame| {
            let ends = skeleton.bone_ends_m(&frame.values);
            let middle = |from: &[usize]| {
                let sum = |i: usize| from.iter().map(|&end| ends[end][i]).sum::<f64>() / from.len() as f64;
                [sum(0), -sum(2), sum(1)]
            };
            sources.iter().map(|(_, from)| middle(from)).collect()
        })
        .collect();
    let names = sources.iter().map(|(name, _)| (*name).to_owned()).collect();
    Trajectories { names, frames: resampled(&recorded, step) }
}

/// Every `step`-th frame (a fraction of a frame is interpolated), starting with the first.
pub(crate) fn resampled(frames: &[Vec<[f64; 3]>], step: f64) -> Vec<Vec<[f64; 3]>> {
    let mut out = Vec::new();
    if !(step > 0.0 && step.is_finite()) {
        return out;
    }
    loop {
        let place = out.len() as f64 * step;
        let index = place as usize;
        let part = place - index as f64;
        let Some(here) = frames.get(index) else { return out };
        let next = match frames.get(index + 1) {
            Some(next) => next,
            None if part == 0.0 => here,
            None => return out,
        };
        out.push(here.iter().zip(next).map(|(a, b)| between(*a, *b, part)).collect());
    }
}

#[cfg(test)]
#[path = "../../../tests/src/data.rs"]
pub(crate) mod shared_data;

#[cfg(test)]
pub(crate) mod tests {
    pub(crate) use super::shared_data;
    use super::*;
    use sinew_body::standard::EVALUATION_JOINTS;
    use sinew_formats::{amc, asf};

    /// Skeleton and motion of a trial of the shared recordings, if they are there.
    pub(crate) fn trial(name: &str) -> Option<(Asf, Amc)> {
        let folder = shared_data::shared("cmu_amc")?;
        let subject = name.split('_').next().unwrap();
        let text = |file: String| std::fs::read_to_string(folder.join(file)).unwrap();
        let skeleton = asf::read("a.asf", &text(format!("{subject}.asf"))).unwrap();
        let motion = amc::read("a.amc", &text(format!("{name}.amc")), &skeleton).unwrap();
        Some((skeleton, motion))
    }

    #[test]
    fn recorded_joints_stand_upright_in_our_world() {
        let Some((skeleton, motion)) = trial("07_01") else { return };
        let points = joints(&skeleton, &motion, 4.0);
        assert_eq!(points.frames.len(), 79);
        assert_eq!(&points.names[..15], EVALUATION_JOINTS);
        let head = points.index("Head").unwrap();
        let first = points.frames[0][head];
        for (found, expected) in first.into_iter().zip([0.505618, 1.836491, 1.511681]) {
            assert!((found - expected).abs() < 1e-5, "{first:?}");
        }
        let [low, high] = points.bounds().unwrap();
        assert!(low[2] > -0.06 && high[2] < 1.8);
    }

    #[test]
    fn resampling_interpolates() {
        let frames: Vec<_> = (0..9).map(|i| vec![[f64::from(i), 0.0, 0.0]]).collect();
        let times = |step| resampled(&frames, step).iter().map(|frame| frame[0][0]).collect::<Vec<_>>();
        assert_eq!(times(4.0), [0.0, 4.0, 8.0]);
        assert_eq!(times(2.5), [0.0, 2.5, 5.0, 7.5]);
        assert!(times(0.0).is_empty());
        assert!(times(f64::NAN).is_empty());
    }
}
