//! An arm of three links in one orthographic camera, with eight modes (`exact/depth_flip_a.json`).
//!
//! The sign of each angle is seen only through the prior.
//!
//! a_j ~ N(pm_j, ps_j²), y_j = Σ_{i ≤ j} l_i cos a_i + N(0, s²).

use crate::quadrature::{Axis, Exact, integrate};
use crate::stored::{number, numbers, stored};
use serde_json::Value;
use sinew::core::combinators::Sum;
use sinew::core::density::{GaussNewton, GradLogDensity, Lanes, LogDensity};
use sinew::core::lanes::{Block, Isa, LANES, triangle};
use sinew::dynamics::gaussian::Gaussian;
use sinew::dynamics::prior::Prior;
use std::f64::consts::{PI, TAU};

/// What is stored.
#[derive(Clone, Debug)]
pub struct Arm {
    /// Means of the prior.
    pub centre: Vec<f64>,
    /// Its standard deviations.
    pub sd: Vec<f64>,
    /// The observation.
    pub sight: Sight,
    /// The angles that made it.
    pub truth: Vec<f64>,
    /// Log evidence.
    pub log_evidence: f64,
    /// Mass of the mode of each [`octant`].
    pub masses: Vec<f64>,
    /// The whole file.
    pub stored: Value,
}

/// Number of a mode: bit j is set where angle j is positive.
#[must_use]
pub fn octant(angles: &[f64]) -> usize {
    angles.iter().enumerate().map(|(j, a)| usize::from(*a > 0.0) << j).sum()
}

impl Arm {
    /// The stored arm; `None`, with a note, where the data folder is missing.
    #[must_use]
    pub fn stored() -> Option<Self> {
        let v = stored("exact/depth_flip_a.json")?;
        let sign = |mode: usize, j: usize| if mode >> j & 1 == 1 { '+' } else { '-' };
        let mass = |mode: usize| number(&v["mode_mass"][(0..3).map(|j| sign(mode, j)).collect::<String>()]);
        Some(Self {
            centre: numbers(&v["pm"]),
            sd: numbers(&v["ps"]),
            sight: Sight { lengths: numbers(&v["l"]), y: numbers(&v["y"]), sigma: number(&v["s"]) },
            truth: numbers(&v["a_true"]),
            log_evidence: number(&v["log_evidence"]),
            masses: (0..8).map(mass).collect(),
            stored: v,
        })
    }

    /// The prior of the angles.
    #[must_use]
    pub fn prior(&self) -> Prior {
        let covariance: Vec<f64> = (0..9).map(|e| if e / 3 == e % 3 { self.sd[e / 3].powi(2) } else { 0.0 }).collect();
        let leaf = Gaussian::new(self.centre.clone(), &covariance).expect("positive definite");
        Prior::Gaussian(Lanes { leaf, isa: Isa::best() })
    }

    /// Posterior by quadrature with 8 · `parts` nodes on each side of 0.
    #[must_use]
    pub fn exact(&self, parts: usize) -> Exact {
        let axis = Axis::new(&[-PI, 0.0, PI], parts);
        integrate(&Sum(&self.sight, &self.prior()), &[axis.clone(), axis.clone(), axis], 8, octant)
    }
}

/// One observation as a density of the angles.
#[derive(Clone, Debug)]
pub struct Sight {
    /// Lengths of the links.
    pub lengths: Vec<f64>,
    /// Where their ends are seen.
    pub y: Vec<f64>,
    /// Standard deviation of the errors.
    pub sigma: f64,
}

impl LogDensity for Sight {
    fn dim(&self) -> usize {
        3
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut [0.0; 3])
    }
}

impl GradLogDensity for Sight {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let (mut end, mut value) = (0.0, -3.0 * (0.5 * TAU.ln() + self.sigma.ln()));
        let mut error = [0.0; 3];
        for j in 0..3 {
            end += self.lengths[j] * x[j].cos();
            error[j] = (self.y[j] - end) / (self.sigma * self.sigma);
            value -= 0.5 * (self.sigma * error[j]).powi(2);
        }
        for j in 0..3 {
            grad[j] = -self.lengths[j] * x[j].sin() * error[j..].iter().sum::<f64>();
        }
        value
    }
}

impl GaussNewton for Sight {
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], _ws: &mut [Block]) {
        for (j, d) in diagonal.iter_mut().enumerate() {
            let slope = |x: f64| (3 - j) as f64 * (self.lengths[j] * x.sin() / self.sigma).powi(2);
            *d = Block(x[j].0.map(slope));
        }
    }
    fn gauss_newton_block(&self, x: &[Block], matrix: &mut [Block], _ws: &mut [Block]) {
        for i in 0..3 {
            for j in 0..=i {
                for lane in 0..LANES {
                    let slope = |k: usize| self.lengths[k] * x[k].0[lane].sin() / self.sigma;
                    matrix[triangle(i, j)].0[lane] = (3 - i) as f64 * slope(i) * slope(j);
                }
            }
        }
    }
}
