//! Ascent of scattered starts into the bulk of their target, by L-BFGS ([`sinew_core::lbfgs`]).
//!
//! Far out in a tail a log density may be −10¹⁰⁰ and more. There the energy error of any trajectory is rounding, and no step size accepts half of them; an ascent needs only that the log density grows. Each state climbs on its own, eight
//! of them with one call of the target, until three quadratic models in a row (one may not know a direction yet) promise a gain below d: in a bulk of dimension d log densities lie about d / 2 below the peak, and starts are better there,
//! apart, than all at the peak. It ends, too, where no higher point is found.
//!
//! A search and not a sampler: what it leaves is a start of a warm-up.

use crate::Error;
use rayon::prelude::*;
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, LANES, get_lane, set_lane};
use sinew_core::lbfgs::{Lbfgs, LineSearch};

/// Models in a row that must promise little.
const CALM: usize = 3;

/// One climb: a search for the least −log p.
struct Climb {
    search: Lbfgs,
    line: LineSearch,
    calm: usize,
    done: bool,
}

impl Climb {
    fn new(x: Vec<f64>, log_density: f64, gradient: Vec<f64>) -> Self {
        let search = Lbfgs::at(x, -log_density, negative(gradient));
        let mut climb = Self { line: search.line_search(), search, calm: 0, done: false };
        climb.look_ahead();
        climb
    }

    fn look_ahead(&mut self) {
        let promises_little = self.line.promised_gain() < self.search.x.len() as f64;
        self.calm = if promises_little { self.calm + 1 } else { 0 };
        self.done = self.calm == CALM;
    }

    /// The state to try next, which is where the climb stands once it is done.
    fn trial(&mut self) -> &[f64] {
        while !self.done && self.line.trial(&self.search).is_none() {
            if self.search.accept(&mut self.line) || self.search.forget() {
                self.line = self.search.line_search();
                self.look_ahead();
            } else {
                self.done = true;
            }
        }
        if self.done { &self.search.x } else { self.line.tried() }
    }
}

fn negative(gradient: Vec<f64>) -> Vec<f64> {
    gradient.into_iter().map(|g| -g).collect()
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
        climbs.iter_mut().enumerate().for_each(|(lane, climb)| set_lane(block, lane, climb.trial()));
        let log_density = target.log_density_grad_block(block, &mut gradient, &mut workspace);
        for (lane, climb) in climbs.iter_mut().enumerate().filter(|(_, climb)| !climb.done) {
            climb.line.take(-log_density.0[lane], &negative(lane_of(&gradient, lane)));
        }
    }
    climbs.iter().enumerate().for_each(|(lane, climb)| set_lane(block, lane, &climb.search.x));
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::density::{Lanes, LogDensity};
    use sinew_core::lanes::Isa;
    use sinew_core::toy::Quadratic;

    /// Σ k x_j − exp x_j: a likelihood of counts, whose tail to the right is beyond all bounds: at 700 the square of its gradient is no number.
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
            Block([300.0, 40.0, 2.0, -1e4, 20.0_f64.ln(), 3.1, -3.0, 700.0]),
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
