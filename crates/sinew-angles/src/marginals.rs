//! Marginals of joint angles and of their rates of change, from the draws of a frame.
//!
//! Every draw of the state is decomposed ([`JointAngles`]), on the branch nearest to the angles of the mean pose; the mean pose is on the branch nearest to that of the frame before. An angle of an interval's end is thus never a turn away, and
//! the mean of an angle is that of its draws, not the angle of the mean pose, which is given beside it. They are of one branch and differ where the posterior is wide.
//!
//! A rate is the change of an angle between two frames over the time between them, draw by draw of their joint posterior ([`crate::fixed_lag`], or trajectories of a smoother).

use crate::{AngleZero, JointAngles};
use rayon::prelude::*;
use sinew_core::lanes::{Block, LANES, get_lane};
use sinew_tracking::posterior::Posterior;
use sinew_tracking::series::describe;

/// An angle of a joint, radians; all on one branch, continuous within a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AngleMarginal {
    /// In the mean pose.
    pub pose: f64,
    /// Mean.
    pub mean: f64,
    /// 5 % quantile.
    pub q05: f64,
    /// 95 % quantile.
    pub q95: f64,
    /// Its mean change over the frames around, radians a second: mean, 5 % and 95 % quantiles. None where tracking began in this frame and no later one counts.
    pub rate: Option<[f64; 3]>,
}

/// Draws of the states of two frames, each with itself, and the time between the frames.
#[derive(Clone, Debug)]
pub struct AngleChange {
    /// States in the earlier frame.
    pub earlier: Vec<Block>,
    /// The later frame.
    pub later: LaterFrame,
    /// Time between them.
    pub seconds: f64,
}

/// The later one of two frames.
#[derive(Clone, Debug)]
pub enum LaterFrame {
    /// The present one, with the index of each draw.
    Present(Vec<usize>),
    /// Another one.
    States(Vec<Block>),
}

/// Angles of a body, frame after frame.
pub struct AngleMarginals {
    angles: JointAngles,
    /// What a standing trial takes off them.
    zero: Option<AngleZero>,
    /// Angles of the mean pose in the frame before, without signs; empty before the first.
    before: Vec<f64>,
    /// Angles of the present frame's draws likewise, draw after draw.
    draws: Vec<f64>,
}

impl AngleMarginals {
    /// Before the first frame; `zero` is taken off.
    #[must_use]
    pub const fn new(angles: JointAngles, zero: Option<AngleZero>) -> Self {
        Self { angles, zero, before: vec![], draws: vec![] }
    }

    /// What is taken off.
    #[must_use]
    pub const fn zero(&self) -> Option<&AngleZero> {
        self.zero.as_ref()
    }

    /// The angles.
    #[must_use]
    pub const fn angles(&self) -> &JointAngles {
        &self.angles
    }

    /// What the next frame needs of this one.
    #[must_use]
    pub fn before(&self) -> &[f64] {
        &self.before
    }

    /// Continues behind a frame; false for angles of another body.
    pub fn continue_behind(&mut self, before: &[f64]) -> bool {
        self.before = before.to_vec();
        before.is_empty() || before.len() == self.angles.raw_count()
    }

    /// Marginals of the angles in a frame, with their rates where a change is given.
    pub fn of(&mut self, mean: &[f64], posterior: &Posterior<'_>, change: Option<&AngleChange>) -> Vec<AngleMarginal> {
        let mut marginals = self.without_rates(mean, posterior);
        if let Some(change) = change {
            self.add_rates(&mut marginals, change, posterior.dim);
        }
        marginals
    }

    /// Marginals of the angles in a frame, whose rates [`AngleMarginals::add_rates`] adds.
    pub fn without_rates(&mut self, mean: &[f64], posterior: &Posterior<'_>) -> Vec<AngleMarginal> {
        let (angles, width, dim) = (&self.angles, self.angles.raw_count(), posterior.dim);
        let mut pose = vec![0.0; width];
        angles.raw(mean, Some(&self.before[..]).filter(|before| !before.is_empty()), &mut pose);
        let mut now = raw_of_draws(angles, posterior.states, dim, |_| &pose);
        now.truncate(posterior.count() * width);
        let equal = posterior.weights.windows(2).all(|pair| pair[0] == pair[1]);
        let of = |angle: usize| {
            let series: Vec<f64> = now.chunks_exact(width).map(|raw| angles.signed(angle, raw)).collect();
            let [mean, _, q05, q95] = match &self.zero {
                None => describe(&series, posterior.weights, equal),
                Some(zero) => {
                    let (series, weights) = zeroed(&series, posterior.weights, zero, angle);
                    describe(&series, &weights, equal)
                }
            };
            let in_pose = angles.signed(angle, &pose) - self.zero.as_ref().map_or(0.0, |zero| zero.means[angle]);
            AngleMarginal { pose: in_pose, mean, q05, q95, rate: None }
        };
        let marginals = (0..angles.names().len()).into_par_iter().map(of).collect();
        (self.before, self.draws) = (pose, now);
        marginals
    }

    /// Adds the rates of the frame at hand to its marginals; states have `dim` coordinates.
    pub fn add_rates(&self, marginals: &mut [AngleMarginal], change: &AngleChange, dim: usize) {
        let (angles, width) = (&self.angles, self.angles.raw_count());
        let later = match &change.later {
            LaterFrame::Present(draws) => {
                draws.iter().flat_map(|draw| &self.draws[draw * width..][..width]).copied().collect()
            }
            LaterFrame::States(states) => raw_of_draws(angles, states, dim, |_| &self.before),
        };
        let earlier = raw_of_draws(angles, &change.earlier, dim, |draw| &later[draw * width..][..width]);
        marginals.par_iter_mut().enumerate().for_each(|(angle, marginal)| {
            let both = earlier.chunks_exact(width).zip(later.chunks_exact(width));
            let rate = |(a, b): (&[f64], &[f64])| (angles.signed(angle, b) - angles.signed(angle, a)) / change.seconds;
            let rates: Vec<f64> = both.map(rate).collect();
            let [mean, _, q05, q95] = describe(&rates, &[], true);
            marginal.rate = Some([mean, q05, q95]);
        });
    }
}

/// Draws of an angle less their draws of its zero, and their weights.
fn zeroed(series: &[f64], weights: &[f64], zero: &AngleZero, angle: usize) -> (Vec<f64>, Vec<f64>) {
    let less = |(draw, (x, weight)): (usize, (&f64, &f64))| {
        let partner = zero.partner(draw)?;
        Some((x - zero.means[angle] - zero.deviations[angle][partner], *weight))
    };
    series.iter().zip(weights).enumerate().filter_map(less).unzip()
}

/// Angles without signs of each draw, those nearest to the angles that `about` gives for it.
fn raw_of_draws<'a>(
    angles: &JointAngles,
    states: &[Block],
    dim: usize,
    about: impl Fn(usize) -> &'a [f64] + Sync,
) -> Vec<f64> {
    let width = angles.raw_count();
    let mut raw = vec![0.0; states.len() / dim * LANES * width];
    let blocks = states.par_chunks_exact(dim).zip(raw.par_chunks_exact_mut((LANES * width).max(1))).enumerate();
    let scratch = || vec![0.0; dim];
    blocks.for_each_init(scratch, |state, (block, (states, out))| {
        for (lane, out) in out.chunks_exact_mut(width).enumerate() {
            get_lane(states, lane, state);
            angles.raw(state, Some(about(block * LANES + lane)), out);
        }
    });
    raw
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Convention;
    use sinew_body::{Proportions, standard};
    use sinew_core::lanes::set_lane;

    /// Draws of someone who turns, spread by 0.1 rad about 3.1 rad, where half a turn is: angles lie about the mean pose's, and the next frame continues from there.
    #[test]
    fn intervals_are_not_cut_at_half_a_turn() {
        let body = standard::h32(&Proportions::default());
        let dim = body.dof();
        let turn = body.dof_names().iter().position(|name| name == "pelvis.rz").unwrap();
        let angles = JointAngles::new(&body, &[], false, Convention::OpenSim);
        let index = angles.names().iter().position(|name| name == "pelvis_rotation").unwrap();
        let mut marginals = AngleMarginals::new(angles, None);
        let draws = 400;
        let weights = vec![1.0 / f64::from(draws); draws as usize];
        let states = |centre: f64, spread: f64| {
            let mut states = vec![Block::ZERO; draws as usize / LANES * dim];
            for draw in 0..draws as usize {
                let mut state = vec![0.0; dim];
                state[turn] = centre + spread * ((draw as f64 + 0.5) / f64::from(draws) - 0.5);
                set_lane(&mut states[draw / LANES * dim..][..dim], draw % LANES, &state);
            }
            states
        };
        for frame in 0..8 {
            let centre = 3.1 + 0.7 * f64::from(frame);
            let now = states(centre, 0.2);
            let mut mean = vec![0.0; dim];
            mean[turn] = centre;
            let posterior = Posterior { dim, states: &now, weights: &weights, effective: 1.0, chain_stats: &[] };
            // Each draw turned by 0.5 rad less the whole of its own deviation.
            let change = AngleChange {
                earlier: states(centre - 0.5, 0.0),
                later: LaterFrame::States(now.clone()),
                seconds: 0.25,
            };
            let found = marginals.of(&mean, &posterior, Some(&change))[index];
            assert!((found.pose - centre).abs() < 1e-9 && (found.mean - centre).abs() < 1e-9, "{found:?}");
            assert!((found.q95 - found.q05 - 0.18).abs() < 1e-3, "{found:?}");
            let [mean, low, high] = found.rate.unwrap();
            assert!((mean - 2.0).abs() < 1e-9 && (high - low - 0.72).abs() < 4e-3, "{found:?}");
        }
    }

    /// The zero of a knee errs with each draw as the knee does, by half of it: what both share goes, the rest stays.
    #[test]
    fn errors_that_zero_and_angle_share_cancel() {
        let body = standard::h32(&Proportions::default());
        let dim = body.dof();
        let shin = body.dof_names().iter().position(|name| name == "r_shin.rx").unwrap();
        let angles = JointAngles::new(&body, &[], false, Convention::OpenSim);
        let (count, knee) =
            (angles.names().len(), angles.names().iter().position(|name| name == "knee_angle_r").unwrap());
        let draws = 400;
        let error = |draw: usize| 0.2 * ((draw as f64 + 0.5) / draws as f64 - 0.5);
        let mut states = vec![Block::ZERO; draws / LANES * dim];
        for draw in 0..draws {
            states[draw / LANES * dim + shin].0[draw % LANES] = -(0.9 + error(draw));
        }
        let mut deviations = vec![vec![0.0; draws]; count];
        deviations[knee] = (0..draws).map(|draw| 0.5 * error(draw)).collect();
        let mut means = vec![0.0; count];
        means[knee] = 0.3;
        let zero = AngleZero { means, deviations, draws, shared: Some(draws) };
        let mut mean = vec![0.0; dim];
        mean[shin] = -0.9;
        let weights = vec![1.0 / draws as f64; draws];
        let posterior = Posterior { dim, states: &states, weights: &weights, effective: 1.0, chain_stats: &[] };
        let found = AngleMarginals::new(angles, Some(zero)).of(&mean, &posterior, None)[knee];
        assert!((found.pose - 0.6).abs() < 1e-12 && (found.mean - 0.6).abs() < 1e-9, "{found:?}");
        assert!((found.q95 - found.q05 - 0.09).abs() < 1e-3 && found.rate.is_none(), "{found:?}");
    }
}
