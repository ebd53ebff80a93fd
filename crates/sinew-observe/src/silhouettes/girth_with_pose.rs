//! Girths of a body whose poses are known roughly: both are fitted to masks.
//!
//! A body in a wrong pose covers masks best when it is too thick, so that girths in poses whose joints are 2 cm off come out up to 12 % too large. The joint cost of girths g and poses q_t is
//!
//! Σ_t [(1 − IoU(g, q_t)) / s + ½ Σ_j ((q_tj − start_tj) / sd_j)²] + ½ Σ (ln g / σ)²,
//!
//! with s and σ of the module `girth`. Fitting g and q in turns does not find its least value: a limb that is too thick covers its mask wherever it lies, and hides that it lies wrong. So girths are judged by the cost that is left
//! when the poses have followed (the profile):
//!
//! 1. Poses are fitted with the radii as they are ([`fit_pose_to_masks`]), girths in these poses ([`fit_girth`]).
//! 2. For steps of 0.1 and 0.05 in the logarithm, for each kind, up and down: the girth is changed, all poses are fitted again, and both are kept as long as the cost falls.
//! 3. The profile is rough, since every search for poses stops elsewhere. So its least value is found from far points: for each kind the cost at −0.12, −0.06, 0.06 and 0.12, and the vertex of the parabola through them; all kinds then
//!    go to theirs, at most 0.06 away. Twice.
//!
//! With four cameras, arms of six pixels and joints that are 1 cm off in each coordinate, girths of 0.8 to 1.3 come back within 2 % from masks without errors, and within 6 % from masks with usual ones (8 % where joints are 2 cm off;
//! in the poses as they are 10 and 12 %). The errors are mostly too thick. A local search: poses farther off than some standard deviations are not mended, and neither are their girths.

use crate::Camera;
use crate::ObservationModel as _;
use crate::silhouettes::girth::{Girth, KINDS, LOG_SD, Sight, before_cameras, fit_girth, from_logs, to_logs};
use crate::silhouettes::image_likelihood::{Cues, ImageLikelihood, ImageModel};
use crate::silhouettes::mask_pose::{Effort, fit_pose_to_masks};
use sinew_body::Joint;
use sinew_body::flesh::Flesh;
use sinew_body::{Error, KinematicTree};

/// Girths and poses with what they cost.
#[derive(Clone, Debug, PartialEq)]
pub struct GirthAndPoses {
    /// The girths.
    pub girth: Girth,
    /// The sights in their fitted poses.
    pub sights: Vec<Sight>,
    /// The joint cost.
    pub cost: f64,
}

/// Steps of the logarithm of a girth.
const STEPS: [f64; 2] = [0.1, 0.05];
/// The nearer points of a parabola; the farther ones are twice as far.
const NEAR: f64 = 0.06;
/// How often girths go to the vertices of their parabolas.
const VERTICES: usize = 2;
/// How far poses may be from the poses of keypoints or a file: standard deviations of a position, metres, and of an angle, radians. A joint that is 2 cm off turns a limb of 25 cm by 0.08.
const SD_M: f64 = 0.03;
const SD_RAD: f64 = 0.1;

/// A body's masks and the poses that are known roughly.
struct Fit<'a> {
    tree: &'a KinematicTree,
    flesh: &'a Flesh,
    cameras: &'a [Camera],
    starts: &'a [Sight],
    sd: Vec<f64>,
}

impl Fit<'_> {
    /// Fits the poses with given girths, from poses that were fitted before.
    fn posed(&self, logs: &[f64; KINDS], from: &[Sight], effort: Effort) -> Result<GirthAndPoses, Error> {
        let girth = from_logs(logs);
        let model = before_cameras(self.tree, &girth.applied(self.flesh), self.cameras)?;
        let mut cost = 0.5 * logs.iter().map(|log| (log / LOG_SD).powi(2)).sum::<f64>();
        let mut sights = Vec::with_capacity(from.len());
        for (start, from) in self.starts.iter().zip(from) {
            let found = fit_pose_to_masks(&bound(&model, start), [&start.state, &self.sd, &from.state], effort);
            cost += found.cost;
            sights.push(Sight { state: found.state, ..start.clone() });
        }
        Ok(GirthAndPoses { girth, sights, cost })
    }

    /// The fit with a changed girth.
    fn changed(&self, from: &GirthAndPoses, kind: usize, change: f64) -> Result<GirthAndPoses, Error> {
        let mut logs = to_logs(&from.girth);
        logs[kind] += change;
        self.posed(&logs, &from.sights, Effort::AGAIN)
    }

    /// The fit with all girths at the vertices of their parabolas.
    fn at_vertices(&self, from: &GirthAndPoses) -> Result<GirthAndPoses, Error> {
        let mut logs = to_logs(&from.girth);
        for (kind, log) in logs.iter_mut().enumerate() {
            let cost = |change: f64| Ok(self.changed(from, kind, change)?.cost);
            let costs = [cost(-2.0 * NEAR)?, cost(-NEAR)?, cost(NEAR)?, cost(2.0 * NEAR)?];
            *log += NEAR * vertex(costs).clamp(-1.0, 1.0);
        }
        self.posed(&logs, &from.sights, Effort::AGAIN)
    }
}

fn bound(model: &ImageModel, sight: &Sight) -> ImageLikelihood {
    let cues = |silhouette| Cues { silhouette, edges: None, picture: None };
    model.bind(sight.silhouettes.iter().map(|mask| mask.clone().map(cues)).collect())
}

fn standard_deviations(tree: &KinematicTree) -> Vec<f64> {
    let of = |(_, joint)| if matches!(joint, Joint::Translate(_)) { SD_M } else { SD_RAD };
    tree.joints().map(of).collect()
}

/// Girths, and the poses near the given ones, with which a body fits masks; `cameras` have perfect lenses and the size of the masks.
///
/// # Errors
/// As [`before_cameras`].
pub fn fit_girth_and_poses(
    tree: &KinematicTree,
    flesh: &Flesh,
    cameras: &[Camera],
    sights: &[Sight],
) -> Result<GirthAndPoses, Error> {
    let fit = Fit { tree, flesh, cameras, starts: sights, sd: standard_deviations(tree) };
    let mut best = fit.posed(&[0.0; KINDS], sights, Effort::AFRESH)?;
    let first = fit_girth(tree, flesh, cameras, &best.sights)?;
    let turned = fit.posed(&to_logs(&first.girth), &best.sights, Effort::AGAIN)?;
    if turned.cost < best.cost {
        best = turned;
    }
    for step in STEPS {
        for kind in 0..KINDS {
            for change in [step, -step] {
                loop {
                    let found = fit.changed(&best, kind, change)?;
                    if found.cost >= best.cost {
                        break;
                    }
                    best = found;
                }
            }
        }
    }
    for _ in 0..VERTICES {
        best = fit.at_vertices(&best)?;
    }
    Ok(best)
}

/// Where the parabola of least squares through values at −2, −1, 1 and 2 is least; 0 where it has no least value.
fn vertex([far_below, below, above, far_above]: [f64; 4]) -> f64 {
    let slope = (2.0 * (far_above - far_below) + above - below) / 10.0;
    let curvature = (far_above + far_below - above - below) / 6.0;
    if curvature > 0.0 { -slope / (2.0 * curvature) } else { 0.0 }
}

/// Poses near the given ones in which a body with known girths fits masks.
///
/// # Errors
/// As [`before_cameras`].
pub fn fit_poses(
    tree: &KinematicTree,
    flesh: &Flesh,
    cameras: &[Camera],
    sights: &[Sight],
    girth: Girth,
) -> Result<Vec<Sight>, Error> {
    let fit = Fit { tree, flesh, cameras, starts: sights, sd: standard_deviations(tree) };
    Ok(fit.posed(&to_logs(&girth), sights, Effort::AFRESH)?.sights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_of_parabolas_are_found() {
        for centre in [-1.5, 0.0, 0.7] {
            let found = vertex([-2.0, -1.0, 1.0, 2.0].map(|x: f64| 3.0 * (x - centre).powi(2) + 5.0));
            assert!((found - centre).abs() < 1e-12, "{found} for {centre}");
        }
        assert_eq!([vertex([0.0; 4]), vertex([-4.0, -1.0, -1.0, -4.0]), vertex([f64::NAN; 4])], [0.0; 3]);
    }
}
