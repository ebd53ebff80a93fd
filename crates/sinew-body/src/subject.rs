//! The sizes of a subject from measured points: segment lengths and widths.
//!
//! [`from_distances`] takes robust medians over the frames of the distances between joints, left and right pooled. What no distance measures keeps its default ratio to
//! what was measured, and is listed. The offsets of the face and foot points need poses: see [`crate::bundle`], which refines all sizes. Medians of distances are a
//! start only: noise of σ per axis makes a segment longer by about σ²/length.
//!
//! ```
//! let frames = vec![vec![Some([0.1, 0.0, 0.9]), Some([0.1, 0.0, 0.45]), None]];
//! let found = sinew_body::subject::from_distances(&["LHip", "LKnee", "LAnkle"], &frames);
//! assert!((found.proportions.thigh - 0.45).abs() < 1e-12);
//! assert!(found.unmeasured.contains(&"shin"));
//! ```

pub use crate::sizes::{SIZES, Size, scaled};
use crate::standard::Proportions;
use sinew_core::estimators::{mean, median};

/// Sizes with what is known about them.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// The sizes, metres.
    pub proportions: Proportions,
    /// Names of sizes that nothing measured; they were scaled with the others.
    pub unmeasured: Vec<&'static str>,
    /// Mean ratio of the measured lengths to the default body's.
    pub scale: f64,
}

/// Measured points by name, frame after frame.
struct Points<'a> {
    names: &'a [&'a str],
    frames: &'a [Vec<Option<[f64; 3]>>],
}

fn between(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

impl Points<'_> {
    fn at(&self, frame: &[Option<[f64; 3]>], name: &str) -> Option<[f64; 3]> {
        let k = self.names.iter().position(|n| *n == name)?;
        frame.get(k).copied().flatten()
    }

    fn middle(&self, frame: &[Option<[f64; 3]>], a: &str, b: &str) -> Option<[f64; 3]> {
        let (a, b) = (self.at(frame, a)?, self.at(frame, b)?);
        Some([0, 1, 2].map(|k: usize| 0.5 * (a[k] + b[k])))
    }

    fn shoulders(&self, frame: &[Option<[f64; 3]>]) -> Option<[f64; 3]> {
        self.middle(frame, "LShoulder", "RShoulder")
    }

    fn hips(&self, frame: &[Option<[f64; 3]>]) -> Option<[f64; 3]> {
        self.middle(frame, "LHip", "RHip").or_else(|| self.at(frame, "MidHip"))
    }

    /// Median over the frames that have a value.
    fn typical(&self, value: impl Fn(&[Option<[f64; 3]>]) -> Option<f64>) -> Option<f64> {
        let mut values: Vec<f64> = self.frames.iter().filter_map(|frame| value(frame)).collect();
        values.retain(|x| x.is_finite());
        (!values.is_empty()).then(|| median(&mut values))
    }

    fn length(&self, a: &str, b: &str) -> Option<f64> {
        self.typical(|f| Some(between(self.at(f, a)?, self.at(f, b)?)))
    }

    /// Mean of the left and the right side, or the one that was measured.
    fn both(&self, a: &str, b: &str) -> Option<f64> {
        let sides: Vec<f64> =
            ["L", "R"].iter().filter_map(|s| self.length(&format!("{s}{a}"), &format!("{s}{b}"))).collect();
        (!sides.is_empty()).then(|| mean(&sides))
    }

    fn trunk(&self) -> Option<f64> {
        self.typical(|f| Some(between(self.shoulders(f)?, self.hips(f)?)))
    }

    /// Height of the neck above the shoulders, along the trunk.
    fn neck(&self) -> Option<f64> {
        self.typical(|f| {
            let (neck, top, bottom) = (self.at(f, "Neck")?, self.shoulders(f)?, self.hips(f)?);
            let length = between(top, bottom);
            Some((0..3).map(|k| (neck[k] - top[k]) * (top[k] - bottom[k])).sum::<f64>() / length)
        })
    }

    /// Points whose offsets no frame can show.
    fn unseen(&self) -> impl Iterator<Item = &'static str> {
        let seen = |name: &str| self.frames.iter().any(|f| self.at(f, name).is_some());
        let either = |name: &str| seen(&format!("L{name}")) || seen(&format!("R{name}"));
        let offsets = [
            ("head_top", seen("Head")),
            ("nose", seen("Nose")),
            ("eye", either("Eye")),
            ("ear", either("Ear")),
            ("heel", either("Heel")),
            ("big_toe", either("BigToe")),
            ("small_toe", either("SmallToe")),
        ];
        offsets.into_iter().filter(|(_, seen)| !seen).map(|(name, _)| name)
    }
}

/// Sizes from the distances of points whose `names` are the standard bodies'; each frame has one entry per name.
#[must_use]
pub fn from_distances(names: &[&str], frames: &[Vec<Option<[f64; 3]>>]) -> Measured {
    let points = Points { names, frames };
    let trunk = points.trunk();
    let default = Proportions::default();
    let default_trunk = default.pelvis_drop + default.shoulder_height;
    let found = [
        (points.both("Shoulder", "Elbow"), default.upper_arm),
        (points.both("Elbow", "Wrist"), default.forearm),
        (points.both("Hip", "Knee"), default.thigh),
        (points.both("Knee", "Ankle"), default.shin),
        (points.length("LShoulder", "RShoulder").map(|w| 0.5 * w), default.shoulder_half_width),
        (points.length("LHip", "RHip").map(|w| 0.5 * w), default.hip_half_width),
        (trunk, default_trunk),
    ];
    let (mut sum, mut of) = (0.0, 0.0);
    for (found, default) in found {
        if let Some(found) = found {
            sum += found;
            of += default;
        }
    }
    let scale = if of > 0.0 && sum > 0.0 { sum / of } else { 1.0 };
    let mut p = scaled(&default, scale);
    let mut unmeasured = vec![];
    let mut set = |name, place: &mut f64, found: Option<f64>| match found {
        Some(found) => *place = found,
        None => unmeasured.push(name),
    };
    let [upper_arm, forearm, thigh, shin, shoulder, hip, _] = found;
    set("upper_arm", &mut p.upper_arm, upper_arm.0);
    set("forearm", &mut p.forearm, forearm.0);
    set("thigh", &mut p.thigh, thigh.0);
    set("shin", &mut p.shin, shin.0);
    set("shoulder_half_width", &mut p.shoulder_half_width, shoulder.0);
    set("hip_half_width", &mut p.hip_half_width, hip.0);
    let ratio = trunk.map(|t| t / default_trunk);
    set("pelvis_drop", &mut p.pelvis_drop, ratio.map(|r| r * default.pelvis_drop));
    set("shoulder_height", &mut p.shoulder_height, ratio.map(|r| r * default.shoulder_height));
    let neck = points.neck();
    let above = neck.unwrap_or(scale * (default.spine - default.shoulder_height));
    p.spine = p.shoulder_height + above;
    if neck.is_none() {
        unmeasured.push("spine");
    }
    unmeasured.extend(points.unseen());
    Measured { proportions: p, unmeasured, scale }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_seen_scales_with_what_is() {
        let names = ["LShoulder", "RShoulder", "LHip", "RHip", "LKnee", "LAnkle"];
        let frame = [
            [-0.2, 0.0, 1.5],
            [0.2, 0.0, 1.5],
            [-0.1, 0.0, 0.9],
            [0.1, 0.0, 0.9],
            [-0.1, 0.0, 0.45],
            [-0.1, 0.0, 0.05],
        ];
        let mut frames = vec![frame.map(Some).to_vec(); 9];
        frames[4][4] = Some([5.0, 5.0, 5.0]);
        frames[5][4] = None;
        let found = from_distances(&names, &frames);
        let p = found.proportions;
        assert!((p.thigh - 0.45).abs() < 1e-12 && (p.shin - 0.40).abs() < 1e-12);
        assert!((p.shoulder_half_width - 0.2).abs() < 1e-12 && (p.hip_half_width - 0.1).abs() < 1e-12);
        assert!((p.pelvis_drop + p.shoulder_height - 0.6).abs() < 1e-12);
        let scale = (0.45 + 0.40 + 0.2 + 0.1 + 0.6) / (0.43 + 0.42 + 0.18 + 0.09 + 0.52);
        assert!((found.scale - scale).abs() < 1e-12);
        assert!((p.forearm - 0.26 * scale).abs() < 1e-12 && (p.nose[1] - 0.10 * scale).abs() < 1e-12);
        for name in ["upper_arm", "forearm", "spine", "head_top", "nose", "eye", "ear", "heel", "big_toe", "small_toe"]
        {
            assert!(found.unmeasured.contains(&name), "{name}");
        }
        assert_eq!(found.unmeasured.len(), 10);
    }

    /// The points of a standing body of known sizes, through its own joints.
    #[test]
    fn a_whole_body_shows_all_its_lengths() {
        let truth = Proportions { upper_arm: 0.33, forearm: 0.24, spine: 0.5, ..scaled(&Proportions::default(), 1.1) };
        let tree = crate::standard::h32(&truth);
        let plan = crate::Plan::with_all_points(&tree);
        let mut at = vec![0.0; 3 * plan.points()];
        crate::point_positions(&plan, sinew_core::lanes::Isa::baseline(), &vec![0.0; tree.dof()], &mut at);
        let names: Vec<&str> = tree.points().iter().map(|p| p.name.as_str()).collect();
        let frame: Vec<_> = at.chunks(3).map(|p| Some([p[0], p[1], p[2]])).collect();
        let place = |name: &str| names.iter().position(|n| *n == name).unwrap();
        let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12, "{found} for {expected}");
        let found = from_distances(&names, std::slice::from_ref(&frame));
        let p = found.proportions;
        assert!(found.unmeasured.is_empty(), "{:?}", found.unmeasured);
        for (found, expected) in [
            (p.upper_arm, 0.33),
            (p.forearm, 0.24),
            (p.thigh, truth.thigh),
            (p.shin, truth.shin),
            (p.shoulder_half_width, truth.shoulder_half_width),
            (p.hip_half_width, truth.hip_half_width),
            (p.pelvis_drop, truth.pelvis_drop),
            (p.shoulder_height, truth.shoulder_height),
            (p.spine, 0.5),
        ] {
            near(found, expected);
        }
        // Left and right are pooled; one side alone will do. Without hips the middle one serves. Medians of two frames are means.
        let mut other = frame.clone();
        other[place("LWrist")].as_mut().unwrap()[2] -= 0.04;
        near(from_distances(&names, std::slice::from_ref(&other)).proportions.forearm, 0.26);
        near(from_distances(&names, &[frame.clone(), other.clone()]).proportions.forearm, 0.25);
        other[place("RWrist")] = None;
        near(from_distances(&names, std::slice::from_ref(&other)).proportions.forearm, 0.28);
        other[place("LHip")] = None;
        let found = from_distances(&names, std::slice::from_ref(&other));
        near(found.proportions.pelvis_drop, truth.pelvis_drop);
        assert_eq!(found.unmeasured, ["hip_half_width"]);
        near(found.proportions.hip_half_width, found.scale * Proportions::default().hip_half_width);
        other[place("LWrist")] = Some([f64::NAN; 3]);
        assert!(from_distances(&names, std::slice::from_ref(&other)).unmeasured.contains(&"forearm"));
    }

    #[test]
    fn nothing_seen_leaves_the_default() {
        let found = from_distances(&[], &[]);
        assert_eq!(found.proportions, Proportions::default());
        assert_eq!(found.scale, 1.0);
    }
}
