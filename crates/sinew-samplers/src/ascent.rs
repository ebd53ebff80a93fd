//! Ascent of scattered starts into the bulk of their target, by L-BFGS with a line search.
//!
//! Far out in a tail a log density may be −10¹⁰⁰ and more. There the energy error of any trajectory is rounding, and no step size accepts half of them; an ascent needs only that the log density grows. Each state climbs on its own, eight
//! of them with one call of the target:
//!
//! 1. v = H ∇ log p, with H from the last steps and differences of gradients (Nocedal 1980), or, without any or where v does not point uphill, v = ∇ log p / max |∇ log p|
//! 2. the climb ends where three quadratic models in a row (one may not know a direction yet) promise a gain ½ v·∇ log p below d: in a bulk of dimension d log densities lie about d / 2 below the peak, and starts are
//!    better there, apart, than all at the peak
//! 3. x ← x + t v with the first t = 1, ½, ¼ … that gains at least 10⁻⁴ t v·∇ log p (Armijo); where there is none down to 2⁻⁶⁰, the climb starts again without a history, and ends where that did not help
//!
//! A search and not a sampler: what it leaves is a start of a warm-up.

use crate::Error;
use rayon::prelude::*;
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, LANES, get_lane, set_lane};
use std::collections::VecDeque;

/// Steps that make H.
const MEMORY: usize = 8;
/// Part of the linear gain that a step must have.
const ARMIJO: f64 = 1e-4;
/// Halvings of one step.
const HALVINGS: i32 = 60;
/// Models in a row that must promise little.
const CALM: usize = 3;

/// A step s and the change y of −∇ log p along it, with 1 / y·s.
struct Pair {
    s: Vec<f64>,
    y: Vec<f64>,
    rho: f64,
}

/// One climb.
struct Climb {
    x: Vec<f64>,
    log_density: f64,
    gradient: Vec<f64>,
    pairs: VecDeque<Pair>,
    direction: Vec<f64>,
    /// v·∇ log p.
    slope: f64,
    halvings: i32,
    calm: usize,
    done: bool,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Climb {
    fn new(x: Vec<f64>, log_density: f64, gradient: Vec<f64>) -> Self {
        let direction = vec![0.0; x.len()];
        let pairs = VecDeque::new();
        let (slope, halvings, calm, done) = (0.0, 0, 0, false);
        let mut climb = Self { x, log_density, gradient, pairs, direction, slope, halvings, calm, done };
        climb.turn();
        climb
    }

    /// H ∇ log p (two-loop recursion).
    fn newton(&self) -> Vec<f64> {
        let mut v = self.gradient.clone();
        let mut shares = Vec::with_capacity(self.pairs.len());
        for pair in self.pairs.iter().rev() {
            let share = pair.rho * dot(&pair.s, &v);
            v.iter_mut().zip(&pair.y).for_each(|(v, y)| *v -= share * y);
            shares.push(share);
        }
        if let Some(last) = self.pairs.back() {
            let scale = 1.0 / (last.rho * dot(&last.y, &last.y));
            v.iter_mut().for_each(|v| *v *= scale);
        }
        for (pair, share) in self.pairs.iter().zip(shares.into_iter().rev()) {
            let change = share - pair.rho * dot(&pair.y, &v);
            v.iter_mut().zip(&pair.s).for_each(|(v, s)| *v += change * s);
        }
        v
    }

    /// Chooses the next direction, or ends the climb.
    fn turn(&mut self) {
        self.halvings = 0;
        if !self.pairs.is_empty() {
            self.direction = self.newton();
            self.slope = dot(&self.direction, &self.gradient);
            if !(self.slope > 0.0 && self.slope.is_finite()) {
                self.pairs.clear();
            }
        }
        if self.pairs.is_empty() {
            let largest = self.gradient.iter().fold(0.0, |a: f64, g| a.max(g.abs()));
            self.direction = self.gradient.iter().map(|g| g / largest).collect();
            self.slope = dot(&self.direction, &self.gradient);
        }
        self.calm = if 0.5 * self.slope < self.x.len() as f64 { self.calm + 1 } else { 0 };
        self.done = self.slope.is_nan() || self.calm == CALM;
    }

    /// The state to try next.
    fn trial(&self) -> Vec<f64> {
        let t = 0.5_f64.powi(self.halvings);
        self.x.iter().zip(&self.direction).map(|(x, v)| x + t * v).collect()
    }

    /// Takes in what the target says of the trial.
    fn take(&mut self, x: Vec<f64>, log_density: f64, gradient: Vec<f64>) {
        let t = 0.5_f64.powi(self.halvings);
        let is_finite = log_density.is_finite() && gradient.iter().all(|g| g.is_finite());
        let enough = log_density > self.log_density && log_density >= self.log_density + ARMIJO * t * self.slope;
        if !(is_finite && enough) {
            self.halvings += 1;
            if self.halvings > HALVINGS {
                self.done = self.pairs.is_empty();
                self.pairs.clear();
                if !self.done {
                    self.turn();
                }
            }
            return;
        }
        let s: Vec<f64> = x.iter().zip(&self.x).map(|(new, old)| new - old).collect();
        let y: Vec<f64> = self.gradient.iter().zip(&gradient).map(|(old, new)| old - new).collect();
        let (curvature, square) = (dot(&s, &y), dot(&y, &y));
        if curvature > f64::EPSILON * square && square.is_finite() {
            if self.pairs.len() == MEMORY {
                self.pairs.pop_front();
            }
            self.pairs.push_back(Pair { s, y, rho: 1.0 / curvature });
        }
        (self.x, self.log_density, self.gradient) = (x, log_density, gradient);
        self.turn();
    }
}

/// Moves each state of `states` (blocks of the target's dimension) uphill, with at most `gradients` calls of the target for each block.
///
/// # Errors
/// [`Error::BadStart`] where a log density or gradient is not finite.
pub fn ascend<T: GradLogDensity + ?Sized>(target: &T, states: &mut [Block], gradients: usize) -> Result<(), Error> {
    states.par_chunks_mut(target.dim()).try_for_each(|block| ascend_block(target, block, gradients))
}

fn ascend_block<T: GradLogDensity + ?Sized>(target: &T, block: &mut [Block], gradients: usize) -> Result<(), Error> {
    let d = block.len();
    let (mut gradient, mut workspace) = (vec![Block::ZERO; d], vec![Block::ZERO; target.workspace()]);
    let lane_of = |block: &[Block], lane: usize| {
        let mut state = vec![0.0; d];
        get_lane(block, lane, &mut state);
        state
    };
    let log_density = target.log_density_grad_block(block, &mut gradient, &mut workspace);
    let start = |lane: usize| {
        let (value, gradient) = (log_density.0[lane], lane_of(&gradient, lane));
        let is_finite = value.is_finite() && gradient.iter().all(|g| g.is_finite());
        let climb = || Climb::new(lane_of(block, lane), value, gradient);
        is_finite.then(climb).ok_or(Error::BadStart { lane, value })
    };
    let mut climbs = (0..LANES).map(start).collect::<Result<Vec<_>, _>>()?;
    for _ in 1..gradients {
        if climbs.iter().all(|climb| climb.done) {
            break;
        }
        for (lane, climb) in climbs.iter().enumerate() {
            set_lane(block, lane, &if climb.done { climb.x.clone() } else { climb.trial() });
        }
        let log_density = target.log_density_grad_block(block, &mut gradient, &mut workspace);
        for (lane, climb) in climbs.iter_mut().enumerate().filter(|(_, climb)| !climb.done) {
            climb.take(lane_of(block, lane), log_density.0[lane], lane_of(&gradient, lane));
        }
    }
    climbs.iter().enumerate().for_each(|(lane, climb)| set_lane(block, lane, &climb.x));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::density::{Lanes, LogDensity};
    use sinew_core::lanes::Isa;
    use sinew_core::toy::Quadratic;

    /// Σ k x_j − exp x_j: a likelihood of counts, whose tail to the right is beyond all bounds.
    struct Counts;
    impl LogDensity for Counts {
        fn dim(&self) -> usize {
            2
        }
        fn log_density(&self, x: &[f64]) -> f64 {
            x.iter().map(|x| 20.0 * x - x.exp()).sum()
        }
    }
    impl GradLogDensity for Counts {
        fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
            grad.iter_mut().zip(x).for_each(|(g, x)| *g = 20.0 - x.exp());
            self.log_density(x)
        }
    }

    #[test]
    fn every_lane_climbs_from_its_own_tail_and_stops_before_the_peak() {
        let mut states = vec![
            Block([300.0, 40.0, 2.0, -1e4, 20.0_f64.ln(), 3.1, -3.0, 100.0]),
            Block([300.0, -5.0, 3.0, 3.0, 20.0_f64.ln(), 3.0, 4.0, 2.0]),
        ];
        ascend(&Counts, &mut states, 1000).expect("finite");
        let peak = Counts.log_density(&[20.0_f64.ln(); 2]);
        for lane in 0..LANES {
            let below = peak - Counts.log_density(&[states[0].0[lane], states[1].0[lane]]);
            assert!((0.0..20.0).contains(&below), "lane {lane}: {below}");
        }
    }

    #[test]
    fn a_narrow_valley_is_climbed_and_a_bad_start_refused() {
        let precision = vec![1e8, 1.0, 1e-4];
        let target = Lanes { leaf: Quadratic { centre: vec![0.5; 3], precision }, isa: Isa::best() };
        let mut states = vec![Block::splat(-100.0); 3];
        ascend(&target, &mut states, 1000).expect("finite");
        let reached: Vec<f64> = states.iter().map(|b| b.0[0]).collect();
        assert!(target.log_density(&reached) > -10.0, "{reached:?}");
        let mut states = vec![Block([0.0, 0.0, 800.0, 0.0, 0.0, 0.0, 0.0, 0.0]); 2];
        assert!(matches!(ascend(&Counts, &mut states, 10), Err(Error::BadStart { lane: 2, .. })));
    }
}
