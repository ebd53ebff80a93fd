//! What a standing trial takes off angles: the posterior of where they are in standing.
//!
//! Of each draw, the angles of all frames of the trial have a mean direction on the circle:
//!
//! ```text
//! o_i = arg Σ_t exp(j θ_i(t))            zeroed draw: θ_k − o_i
//! ```
//!
//! Where both runs share draws of what is constant, draw i of the one belongs to draw i of the other, and what lasts goes with the difference; else draws are paired as they come.

use crate::JointAngles;
use crate::circle::{TURN_RAD, direction, near};
use crate::pelvis::{ISB_PELVIS, OPENSIM_PELVIS};

/// Whether a standing trial has a zero of an angle of that name.
///
/// None of where somebody faces, and none of OpenSim's angles of the pelvis, which depend on it: who stands facing elsewhere has others.
#[must_use]
pub fn has_zero(name: &str) -> bool {
    !OPENSIM_PELVIS.contains(&name) && name != ISB_PELVIS[2]
}

/// Mean directions of the angles of some frames, radians: `frames` gives each state, one after the other.
pub fn mean_directions<'a>(angles: &JointAngles, frames: impl Iterator<Item = &'a [f64]>) -> Vec<f64> {
    let mut raw = vec![0.0; angles.raw_count()];
    let mut sums = vec![[0.0; 2]; angles.names().len()];
    for state in frames {
        angles.raw(state, None, &mut raw);
        for (angle, sum) in sums.iter_mut().enumerate() {
            let (sin, cos) = angles.signed(angle, &raw).sin_cos();
            *sum = [sum[0] + sin, sum[1] + cos];
        }
    }
    sums.iter().map(|[sin, cos]| sin.atan2(*cos)).collect()
}

/// What is taken off some angles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AngleZero {
    /// Mean of each zero, radians; 0 where there is none.
    pub means: Vec<f64>,
    /// Deviation of each draw from it, for each angle.
    pub deviations: Vec<Vec<f64>>,
    /// Draws.
    pub draws: usize,
    /// Draws of what is constant that both runs share; none where they do not.
    pub shared: Option<usize>,
}

impl AngleZero {
    /// The zero of some angles: `drawn` holds a row for each draw of a standing trial with a number for each of its `names`, radians.
    #[must_use]
    pub fn new(angles: &JointAngles, names: &[String], drawn: &[f64], shared: Option<usize>) -> Self {
        let draws = drawn.len() / names.len().max(1);
        let column = |name: &String| names.iter().position(|own| own == name).filter(|_| has_zero(name));
        let of = |name: &String| {
            let column = column(name);
            let at = |draw: usize| column.map_or(0.0, |column| drawn[draw * names.len() + column]);
            let middle = if column.is_some() { direction((0..draws).map(at), TURN_RAD) } else { 0.0 };
            let apart = (0..draws).map(|draw| near(at(draw) - middle, 0.0, TURN_RAD));
            (middle, apart.collect::<Vec<f64>>())
        };
        let (means, deviations) = angles.names().iter().map(of).unzip();
        Self { means, deviations, draws, shared }
    }

    /// The draw of the zero that belongs to a draw of the run; none where its constants have none.
    #[must_use]
    pub fn partner(&self, draw: usize) -> Option<usize> {
        let draw = draw % self.shared.unwrap_or(self.draws).max(1);
        Some(draw).filter(|draw| *draw < self.draws)
    }

    /// Standard deviation of the zero of an angle, radians.
    #[must_use]
    pub fn sd(&self, angle: usize) -> f64 {
        let deviations = &self.deviations[angle];
        (deviations.iter().map(|x| x * x).sum::<f64>() / deviations.len().max(1) as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Convention;
    use sinew_body::{Proportions, standard};

    /// Two draws about half a turn, 0.2 rad apart: their middle is half a turn and not 0.
    #[test]
    fn zeros_are_taken_round_the_circle_and_what_depends_on_the_heading_has_none() {
        let angles = JointAngles::new(&standard::h32(&Proportions::default()), &[], false, Convention::OpenSim);
        let names = vec!["knee_angle_r".to_owned(), "pelvis_tilt".to_owned()];
        let half = std::f64::consts::PI;
        let drawn = [half - 0.1, 0.7, 0.1 - half, 0.7];
        let zero = AngleZero::new(&angles, &names, &drawn, None);
        let index = |name: &str| angles.names().iter().position(|own| own == name).unwrap();
        let knee = index("knee_angle_r");
        assert!((zero.means[knee].abs() - half).abs() < 1e-12, "{}", zero.means[knee]);
        assert!((zero.sd(knee) - 0.1).abs() < 1e-12 && zero.deviations[knee].iter().sum::<f64>().abs() < 1e-12);
        for name in ["pelvis_tilt", "knee_angle_l"] {
            assert_eq!((zero.means[index(name)], zero.sd(index(name))), (0.0, 0.0), "{name}");
        }
        let isb = JointAngles::new(&standard::h32(&Proportions::default()), &[], false, Convention::Isb);
        let without: Vec<&String> = isb.names().iter().filter(|name| !has_zero(name)).collect();
        assert_eq!(without, ["pelvic_rotation"]);
        // Draws belong together where the constants are the same, and those without a partner are left out.
        assert_eq!([0, 1, 2, 3].map(|draw| zero.partner(draw)), [Some(0), Some(1), Some(0), Some(1)]);
        let shared = AngleZero::new(&angles, &names, &drawn, Some(3));
        assert_eq!([0, 1, 2, 3].map(|draw| shared.partner(draw)), [Some(0), Some(1), None, Some(0)]);
    }

    /// A knee that flexes and extends by as much about 0.3 rad.
    #[test]
    fn directions_are_means_over_the_frames() {
        let body = standard::h32(&Proportions::default());
        let angles = JointAngles::new(&body, &[], false, Convention::OpenSim);
        let shin = body.dof_names().iter().position(|name| name == "r_shin.rx").unwrap();
        let states: Vec<Vec<f64>> = [-0.4, -0.3, -0.2]
            .map(|angle| (0..body.dof()).map(|dof| if dof == shin { angle } else { 0.0 }).collect())
            .into();
        let found = mean_directions(&angles, states.iter().map(Vec::as_slice));
        let knee = angles.names().iter().position(|name| name == "knee_angle_r").unwrap();
        assert!((found[knee] - 0.3).abs() < 1e-12 && found.iter().map(|x| x.abs()).sum::<f64>() < 0.3 + 1e-12);
    }
}
