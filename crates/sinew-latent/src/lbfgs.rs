//! Limited-memory BFGS with a line search for the strong Wolfe conditions.
//!
//! Nocedal & Wright, *Numerical Optimization* (2006), algorithms 7.4, 7.5, 3.5 and 3.6, with memory 10, c₁ = 10⁻⁴, c₂ = 0.9 and cubic interpolation. Value and gradient come together, so that nothing is evaluated twice. The state
//! is plain data: what is stored and read again goes on as if never interrupted.

use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Pairs of steps and changes of the gradient that are kept.
const MEMORY: usize = 10;
const SUFFICIENT_DECREASE: f64 = 1e-4;
const CURVATURE: f64 = 0.9;
/// Evaluations of one line search at most.
const TRIALS: usize = 30;

/// A function to be minimised.
pub trait Objective {
    /// The value at `x`, its gradient written to `gradient`; infinite where the function is not defined.
    fn evaluate(&mut self, x: &[f64], gradient: &mut [f64]) -> f64;
}

/// Where a minimisation stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lbfgs {
    /// The best point so far.
    pub x: Vec<f64>,
    /// Its value.
    pub value: f64,
    /// Its gradient.
    pub gradient: Vec<f64>,
    /// Steps made.
    pub iterations: usize,
    /// Evaluations of the function.
    pub evaluations: usize,
    /// Steps s and changes y of the gradient, oldest first.
    pairs: VecDeque<(Vec<f64>, Vec<f64>)>,
}

struct Trial {
    length: f64,
    value: f64,
    slope: f64,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Lbfgs {
    /// A minimisation that starts at `x`.
    pub fn new(objective: &mut impl Objective, x: Vec<f64>) -> Self {
        let mut gradient = vec![0.0; x.len()];
        let value = objective.evaluate(&x, &mut gradient);
        Self { x, value, gradient, iterations: 0, evaluations: 1, pairs: VecDeque::new() }
    }

    /// Largest entry of the gradient.
    #[must_use]
    pub fn steepness(&self) -> f64 {
        self.gradient.iter().fold(0.0, |largest: f64, g| largest.max(g.abs()))
    }

    /// Makes one step; false where no lower point is found.
    pub fn step(&mut self, objective: &mut impl Objective) -> bool {
        if !self.value.is_finite() || self.steepness() == 0.0 {
            return false;
        }
        if self.line_search(objective) {
            return true;
        }
        // What the pairs say of the curvature may be at fault: once more, straight down.
        let remembered = !self.pairs.is_empty();
        self.pairs.clear();
        remembered && self.line_search(objective)
    }

    /// −H g by the two loops over the pairs, H scaled by the newest.
    fn direction(&self) -> Vec<f64> {
        let mut direction: Vec<f64> = self.gradient.iter().map(|g| -g).collect();
        let mut along = Vec::with_capacity(self.pairs.len());
        for (s, y) in self.pairs.iter().rev() {
            let a = dot(s, &direction) / dot(s, y);
            direction.iter_mut().zip(y).for_each(|(d, y)| *d -= a * y);
            along.push(a);
        }
        if let Some((s, y)) = self.pairs.back() {
            let scale = dot(s, y) / dot(y, y);
            direction.iter_mut().for_each(|d| *d *= scale);
        }
        for ((s, y), a) in self.pairs.iter().zip(along.iter().rev()) {
            let b = dot(y, &direction) / dot(s, y);
            direction.iter_mut().zip(s).for_each(|(d, s)| *d += (a - b) * s);
        }
        direction
    }

    fn line_search(&mut self, objective: &mut impl Objective) -> bool {
        let direction = self.direction();
        let slope = dot(&direction, &self.gradient);
        if slope >= 0.0 || !slope.is_finite() {
            return false;
        }
        let first = if self.pairs.is_empty() {
            (1.0 / self.gradient.iter().map(|g| g.abs()).sum::<f64>()).min(1.0)
        } else {
            1.0
        };
        let (mut x, mut gradient) = (self.x.clone(), self.gradient.clone());
        let mut low = Trial { length: 0.0, value: self.value, slope };
        let mut best = (self.x.clone(), self.gradient.clone());
        let (mut high, mut length) = (None::<Trial>, first);
        for _ in 0..TRIALS {
            x.iter_mut().zip(&self.x).zip(&direction).for_each(|((x, from), d)| *x = length.mul_add(*d, *from));
            let value = objective.evaluate(&x, &mut gradient);
            self.evaluations += 1;
            let trial = Trial { length, value, slope: dot(&direction, &gradient) };
            let falls = value <= self.value + SUFFICIENT_DECREASE * length * slope && value < low.value;
            if !falls {
                high = Some(trial);
            } else {
                let done = trial.slope.abs() <= -CURVATURE * slope;
                best.0.copy_from_slice(&x);
                best.1.copy_from_slice(&gradient);
                let ahead = high.as_ref().map_or(1.0, |high| high.length - trial.length);
                let previous = std::mem::replace(&mut low, trial);
                if done {
                    break;
                }
                if low.slope * ahead >= 0.0 {
                    high = Some(previous);
                }
            }
            length = next_length(&low, high.as_ref());
        }
        if low.length == 0.0 {
            return false;
        }
        self.accept(best.0, low.value, best.1);
        true
    }

    fn accept(&mut self, x: Vec<f64>, value: f64, gradient: Vec<f64>) {
        let s: Vec<f64> = x.iter().zip(&self.x).map(|(a, b)| a - b).collect();
        let y: Vec<f64> = gradient.iter().zip(&self.gradient).map(|(a, b)| a - b).collect();
        (self.x, self.value, self.gradient) = (x, value, gradient);
        self.iterations += 1;
        if dot(&s, &y) > 1e-12 * dot(&y, &y).sqrt() * dot(&s, &s).sqrt() {
            if self.pairs.len() == MEMORY {
                self.pairs.pop_front();
            }
            self.pairs.push_back((s, y));
        }
    }
}

/// Farther on while nothing rises; else where the cubic through both ends is least, not too near to either.
fn next_length(low: &Trial, high: Option<&Trial>) -> f64 {
    let Some(high) = high else { return 2.0 * low.length };
    let width = high.length - low.length;
    let middle = low.length + 0.5 * width;
    let d = low.slope + high.slope - 3.0 * (high.value - low.value) / width;
    let root = (d * d - low.slope * high.slope).sqrt().copysign(width);
    let place = low.length + width * (1.0 - (high.slope + root - d) / (high.slope - low.slope + 2.0 * root));
    let (near, far) = (low.length + 0.1 * width, low.length + 0.9 * width);
    if place.is_finite() && high.value.is_finite() { place.clamp(near.min(far), near.max(far)) } else { middle }
}
