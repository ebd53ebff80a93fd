//! The fixed benchmark problem: one frame of a 28-DOF marker problem with a mixture prior of ten components.
//!
//! Body, camera, observations and three reference points with log density and gradient come from `data/problem28.json`, which other systems are measured on too; the
//! posterior's moments from `data/posterior_long_run.json` (80 chains of 20 000 states). The reference density leaves out all constants:
//!
//! ```text
//! log p = −½ Σ ((z − ẑ)/σ)² + log (1/M) Σ_m exp(−½ Σ_j ((s_j − c_mj)/sd_j)²)
//! ```

use serde::Deserialize;
use sinew::body::{Axis, Joint, KinematicTree, Link, Plan, Point};
use sinew::core::combinators::Sum;
use sinew::core::density::Lanes;
use sinew::core::lanes::Isa;
use sinew::dynamics::mixture::Mixture;
use sinew::observe::ObservationModel;
use sinew_markers::{MarkerLikelihood, MarkerModel, MarkerView, MarkerViewsLikelihood, MarkerViewsModel};
use std::sync::Arc;

/// The posterior of the problem.
pub type Target = Sum<Lanes<MarkerLikelihood>, Lanes<Mixture>>;

/// A reference point.
#[derive(Clone, Debug, Deserialize)]
pub struct Reference {
    /// The state.
    pub state: Vec<f64>,
    /// Log density without constants.
    pub logpdf: f64,
    /// Its gradient.
    pub grad: Vec<f64>,
}

/// Moments of the posterior from a very long run.
#[derive(Clone, Debug, Deserialize)]
pub struct LongRun {
    /// Posterior means.
    pub mean: Vec<f64>,
    /// Posterior standard deviations.
    pub sd: Vec<f64>,
    /// Monte Carlo errors of the means.
    pub mcse: Vec<f64>,
}

/// The problem as read from its file.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The body; its points are the markers.
    pub tree: KinematicTree,
    /// Camera centre, metres; the camera looks along +Y.
    pub camera_centre: [f64; 3],
    /// Standard deviation of the markers' image coordinates.
    pub sigma: f64,
    /// Observed image positions.
    pub observations: Vec<[f64; 2]>,
    /// Centres of the prior's components.
    pub prior_centres: Vec<Vec<f64>>,
    /// Standard deviations of the prior's components.
    pub prior_sd: Vec<f64>,
    /// The pose that the observations were made from.
    pub true_pose: Vec<f64>,
    /// Reference points.
    pub references: Vec<Reference>,
}

#[derive(Deserialize)]
struct File {
    bodies: Vec<FileBody>,
    markers: Vec<FileMarker>,
    camera: FileCamera,
    sigma: f64,
    prior_sd: Vec<f64>,
    true_pose: Vec<f64>,
    observations: Vec<[f64; 2]>,
    prior_centres: Vec<Vec<f64>>,
    reference: Vec<Reference>,
}

#[derive(Deserialize)]
struct FileBody {
    name: String,
    parent: i64,
    offset: [f64; 3],
    joints: Vec<FileJoint>,
}

#[derive(Deserialize)]
struct FileJoint {
    kind: FileKind,
    axis: FileAxis,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum FileKind {
    Trans,
    Rot,
}

#[derive(Deserialize)]
#[serde(rename_all = "lowercase")]
enum FileAxis {
    X,
    Y,
    Z,
}

#[derive(Deserialize)]
struct FileMarker {
    name: String,
    body: usize,
    offset: [f64; 3],
}

#[derive(Deserialize)]
struct FileCamera {
    centre: [f64; 3],
}

const EMBEDDED: &str = "the embedded file is valid, as the tests of this module show";

/// Reads the problem that is embedded in this crate.
#[must_use]
pub fn load() -> Problem {
    let file: File = serde_json::from_str(include_str!("data/problem28.json")).expect(EMBEDDED);
    let links = file
        .bodies
        .into_iter()
        .map(|body| {
            let joint = |joint: FileJoint| {
                let axis = match joint.axis {
                    FileAxis::X => Axis::X,
                    FileAxis::Y => Axis::Y,
                    FileAxis::Z => Axis::Z,
                };
                match joint.kind {
                    FileKind::Trans => Joint::Translate(axis),
                    FileKind::Rot => Joint::Rotate(axis),
                }
            };
            let joints = body.joints.into_iter().map(joint).collect();
            Link::new(body.name, usize::try_from(body.parent).ok(), body.offset, joints)
        })
        .collect();
    let points = file.markers.into_iter().map(|m| Point { name: m.name, link: m.body, offset: m.offset }).collect();
    Problem {
        tree: KinematicTree::new(links, points).expect(EMBEDDED),
        camera_centre: file.camera.centre,
        sigma: file.sigma,
        observations: file.observations,
        prior_centres: file.prior_centres,
        prior_sd: file.prior_sd,
        true_pose: file.true_pose,
        references: file.reference,
    }
}

/// Reads the moments of the posterior.
#[must_use]
pub fn long_run() -> LongRun {
    serde_json::from_str(include_str!("data/posterior_long_run.json")).expect(EMBEDDED)
}

impl Problem {
    /// The likelihood alone.
    #[must_use]
    pub fn likelihood(&self, isa: Isa) -> Lanes<MarkerLikelihood> {
        let plan = Arc::new(Plan::with_all_points(&self.tree));
        let frame: Vec<_> = self.observations.iter().copied().map(Some).collect();
        MarkerModel { plan, centre: self.camera_centre, sigma: self.sigma, isa }.bind(&frame)
    }

    /// The same likelihood by the model of any number of cameras anywhere: what one fixed camera saves.
    #[must_use]
    pub fn likelihood_by_views(&self, isa: Isa) -> Lanes<MarkerViewsLikelihood> {
        let plan = Arc::new(Plan::with_all_points(&self.tree));
        let frame: Vec<_> = self.observations.iter().copied().map(Some).collect();
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let views = vec![MarkerView { centre: self.camera_centre, axes }];
        MarkerViewsModel { plan, views, sigma: self.sigma, isa }.bind(&[frame])
    }

    /// The prior alone.
    #[must_use]
    pub fn prior(&self, isa: Isa) -> Lanes<Mixture> {
        Lanes { leaf: Mixture::new(self.prior_centres.clone(), &self.prior_sd).expect(EMBEDDED), isa }
    }

    /// The posterior, with all constants.
    #[must_use]
    pub fn target(&self, isa: Isa) -> Target {
        Sum(self.likelihood(isa), self.prior(isa))
    }

    /// What the posterior's log density has more than the reference: the constants of the likelihood and of the prior's components.
    #[must_use]
    pub fn constant(&self) -> f64 {
        let log_tau = std::f64::consts::TAU.ln();
        let likelihood = self.observations.len() as f64 * (log_tau + 2.0 * self.sigma.ln());
        let prior: f64 = self.prior_sd.iter().map(|sd| 0.5 * log_tau + sd.ln()).sum();
        -likelihood - prior
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew::core::density::{GradLogDensity, LogDensity};
    use sinew::core::lanes::Block;

    #[test]
    fn reference_points_are_reproduced_by_one_state_and_by_blocks_on_every_instruction_set() {
        let problem = load();
        for isa in Isa::available() {
            let target = problem.target(isa);
            for reference in &problem.references {
                let mut grad = vec![0.0; 28];
                let value = target.log_density_grad(&reference.state, &mut grad) - problem.constant();
                assert!((value - reference.logpdf).abs() <= 1e-9 * reference.logpdf.abs(), "{value}");
                let block: Vec<Block> = reference.state.iter().map(|&x| Block::splat(x)).collect();
                let mut grad_block = vec![Block::ZERO; 28];
                let mut ws = vec![Block::ZERO; target.workspace()];
                let values = target.log_density_grad_block(&block, &mut grad_block, &mut ws);
                assert!((values.0[6] - problem.constant() - reference.logpdf).abs() <= 1e-9 * reference.logpdf.abs());
                let largest = reference.grad.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
                for j in 0..28 {
                    assert!((grad[j] - reference.grad[j]).abs() <= 1e-8 * largest, "coordinate {j}");
                    assert!((grad_block[j].0[1] - reference.grad[j]).abs() <= 1e-8 * largest, "coordinate {j}");
                }
            }
        }
    }
}
