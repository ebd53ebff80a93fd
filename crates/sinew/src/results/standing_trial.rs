//! The zero of joint angles from a trial in which the person stands, as `--static` takes it.
//!
//! TRIAL is the result folder of a run of that trial, of the same person. Of each of its draws, the angles of all frames have a mean direction on the circle; over the draws, that is the posterior of where the person's angles are
//! in standing, which becomes their zero:
//!
//! ```text
//! o_i = arg Σ_t exp(j θ_i(t))            zeroed draw: θ_k − o_i
//! ```
//!
//! With the set-up of the standing trial (`--setup TRIAL/setup.toml`) draw i of both runs is of the same constants: what lasts, such as the place of a keypoint on its link, is in both and goes with the difference. With a set-up of its own, draws
//! are paired as they come, and what lasts counts twice. Draws of a smoothed run are trajectories; of a filtered one, draws of different frames share what lasts and nothing else, so that
//! what is left of their own errors in the mean over the trial counts too little. Angles of the pelvis to the ground keep `pelvis_rotation` as it is: where somebody faces is no zero.

use super::error::ResultsError;
use super::joint_angles::{Convention, JointAngles};
use super::stored_array::stored_array;
use crate::setup::{MeasuredErrors, Setup};
use crate::{Error, files};
use sinew_body::Joint;
use sinew_formats::source_text::MAX_CONFIG_BYTES;
use std::f64::consts::TAU;
use std::path::Path;

/// The angle that a standing trial has no zero of.
const HEADING: &str = "pelvis_rotation";

/// Angles of a standing trial.
#[derive(Clone, Debug, PartialEq)]
pub struct StandingTrial {
    names: Vec<String>,
    draws: usize,
    /// Mean directions over the frames, radians: a row for each draw, a number for each name.
    angles: Vec<f64>,
    lasting: Option<MeasuredErrors>,
}

impl StandingTrial {
    /// Reads the run of a standing trial.
    ///
    /// # Errors
    /// A folder without a summary or without draws; files that cannot be read.
    pub fn read(folder: &Path, convention: Convention) -> Result<Self, Error> {
        if !folder.join("summary.json").exists() {
            std::fs::read_dir(folder).map_err(Error::io("read", folder))?;
            return Err(ResultsError::NoSummary(folder.to_owned()).into());
        }
        let path = folder.join("setup.toml");
        let setup = Setup::from_toml(&path.display().to_string(), &files::read_text(&path, MAX_CONFIG_BYTES)?)?;
        let tree = setup.tree();
        let rotations: Vec<usize> = tree
            .joints()
            .enumerate()
            .filter(|(_, (_, joint))| matches!(joint, Joint::Rotate(_)))
            .map(|(dof, _)| dof)
            .collect();
        let drawn = stored_array(folder, "posterior/angle")?;
        let drawn = drawn.filter(|array| array.shape.len() == 4 && array.shape[3] == rotations.len());
        let drawn = drawn.filter(|array| array.shape[..3].iter().all(|size| *size > 0));
        let drawn = drawn.ok_or_else(|| ResultsError::NoDraws(folder.to_owned()))?;
        let (draws, frames) = (drawn.shape[0] * drawn.shape[1], drawn.shape[2]);
        let angles = JointAngles::new(&tree, &[], true, convention);
        let (mut raw, mut state) = (vec![0.0; angles.raw_count()], vec![0.0; tree.dof()]);
        let count = angles.names().len();
        let mut directions = Vec::with_capacity(draws * count);
        for draw in drawn.values.chunks_exact(frames * rotations.len()) {
            let mut sums = vec![[0.0; 2]; count];
            for frame in draw.chunks_exact(rotations.len()) {
                rotations.iter().zip(frame).for_each(|(dof, angle)| state[*dof] = *angle);
                angles.raw(&state, None, &mut raw);
                for (angle, sum) in sums.iter_mut().enumerate() {
                    let (sin, cos) = angles.signed(angle, &raw).sin_cos();
                    (sum[0], sum[1]) = (sum[0] + sin, sum[1] + cos);
                }
            }
            directions.extend(sums.iter().map(|[sin, cos]| sin.atan2(*cos)));
        }
        if directions.iter().any(|angle| !angle.is_finite()) {
            return Err(ResultsError::NoDraws(folder.to_owned()).into());
        }
        Ok(Self { names: angles.names().to_vec(), draws, angles: directions, lasting: setup.lasting })
    }

    /// The zero of some angles, for a run with a set-up that knows this of what is constant.
    #[must_use]
    pub fn zero(&self, angles: &JointAngles, lasting: Option<&MeasuredErrors>) -> AngleZero {
        let columns =
            angles.names().iter().map(|name| self.names.iter().position(|own| own == name).filter(|_| name != HEADING));
        let shared = lasting.filter(|own| Some(*own) == self.lasting.as_ref()).map(MeasuredErrors::draws);
        let drawn = |column: Option<usize>| {
            let of = |draw: usize| column.map_or(0.0, |column| self.angles[draw * self.names.len() + column]);
            let (sin, cos) = (0..self.draws).fold((0.0, 0.0), |(s, c), draw| (s + of(draw).sin(), c + of(draw).cos()));
            let middle = if column.is_some() { f64::atan2(sin, cos) } else { 0.0 };
            let apart = (0..self.draws).map(|draw| of(draw) - middle).map(|x| x - TAU * (x / TAU).round());
            (middle, apart.collect::<Vec<f64>>())
        };
        let (means, deviations) = columns.map(drawn).unzip();
        AngleZero { means, deviations, draws: self.draws, shared }
    }
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
    /// The draw of the zero that belongs to a draw of the run; none where its constants have none.
    #[must_use]
    pub fn partner(&self, draw: usize) -> Option<usize> {
        match self.shared {
            Some(shared) => Some(draw % shared).filter(|draw| *draw < self.draws),
            None => Some(draw % self.draws),
        }
    }

    /// Standard deviation of the zero of an angle, radians.
    #[must_use]
    pub fn sd(&self, angle: usize) -> f64 {
        let deviations = &self.deviations[angle];
        (deviations.iter().map(|x| x * x).sum::<f64>() / deviations.len() as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::lasting_errors::DrawnNumber;
    use sinew_body::{Proportions, standard};

    fn lasting(draws: usize) -> MeasuredErrors {
        let number = DrawnNumber {
            name: "body.thigh_m".into(),
            value: 0.4,
            prior_mean: 0.4,
            prior_sd: 0.02,
            draws: (0..draws).map(|draw| 0.001 * draw as f64).collect(),
        };
        MeasuredErrors {
            version: 5,
            cameras: vec![],
            points: vec![],
            middle_m: [0.0; 3],
            frames: 1,
            worth: 1.0,
            persistence_s: 0.0,
            scale: vec![],
            number: vec![number],
            source: vec![],
        }
    }

    /// Two draws about half a turn, 0.2 rad apart: their middle is half a turn and not 0.
    #[test]
    fn zeros_are_taken_round_the_circle_and_the_heading_has_none() {
        let angles = JointAngles::new(&standard::h32(&Proportions::default()), &[], false, Convention::OpenSim);
        let names = vec!["knee_angle_r".to_owned(), HEADING.to_owned()];
        let half = std::f64::consts::PI;
        let trial = StandingTrial {
            names,
            draws: 2,
            angles: vec![half - 0.1, 0.7, 0.1 - half, 0.7],
            lasting: Some(lasting(3)),
        };
        let zero = trial.zero(&angles, None);
        let index = |name: &str| angles.names().iter().position(|own| own == name).unwrap();
        let knee = index("knee_angle_r");
        assert!((zero.means[knee].abs() - half).abs() < 1e-12, "{}", zero.means[knee]);
        assert!((zero.sd(knee) - 0.1).abs() < 1e-12 && zero.deviations[knee].iter().sum::<f64>().abs() < 1e-12);
        for name in [HEADING, "knee_angle_l"] {
            assert_eq!((zero.means[index(name)], zero.sd(index(name))), (0.0, 0.0), "{name}");
        }
        // Draws belong together where the constants are the same, and those without a partner are left out.
        assert_eq!([0, 1, 2, 3].map(|draw| zero.partner(draw)), [Some(0), Some(1), Some(0), Some(1)]);
        let shared = trial.zero(&angles, Some(&lasting(3)));
        assert_eq!([0, 1, 2, 3].map(|draw| shared.partner(draw)), [Some(0), Some(1), None, Some(0)]);
        assert_eq!(trial.zero(&angles, Some(&lasting(4))).shared, None);
    }
}
