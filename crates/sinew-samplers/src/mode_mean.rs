//! The mean of the particles that are similar to the mode (Husz, Wallace & Green 2007).
//!
//! 1. The mode m is the state of largest weight among those that meet the most of what was seen: a likelihood may be largest for states that are nowhere near it.
//! 2. Similar are the states with max_j |s_ij − m_j| / B_j ≤ width, B the standard deviations of a step, angles the short way round; the mode is always one of them.
//! 3. The mean is Σ W_i s_i / Σ W_i over these.
//!
//! The paper has the idea; the measure and the width (3) are ours. Of a population that is far from the target in many dimensions only the mode may be similar to itself: the number of similar states says how much of a mean it is.

use crate::Error;
use crate::particles::Particles;
use crate::weights::{largest, normalise};
use sinew_core::transition::LevelMotion;

/// The mode of a set of particles, with those similar to it.
#[derive(Clone, Debug, PartialEq)]
pub struct ModeMean {
    /// Place of the mode.
    pub mode: usize,
    /// Places of the similar states, ascending.
    pub similar: Vec<usize>,
    /// Their weighted mean.
    pub mean: Vec<f64>,
    /// States that meet less of what was seen than the mode.
    pub astray: usize,
}

/// The weighted mean of the particles that are similar to the mode; `met` says of each how much of what was seen it meets.
///
/// # Errors
/// [`Error::AllWeightsZero`] where the states that meet the most have no weight.
pub fn mode_mean<M: LevelMotion + ?Sized>(
    particles: &Particles,
    met: &[f64],
    motion: &M,
    width: f64,
) -> Result<ModeMean, Error> {
    let log_weights = particles.log_weights();
    let (_, most) = largest(met);
    let eligible = |(log, met): (&f64, &f64)| if *met == most { *log } else { f64::NEG_INFINITY };
    let (mode, heaviest) = largest(&log_weights.iter().zip(met).map(eligible).collect::<Vec<_>>());
    if heaviest == f64::NEG_INFINITY {
        return Err(Error::AllWeightsZero { count: particles.count() });
    }
    let centre = particles.state(mode);
    let changes = |state: &[f64]| -> Vec<f64> {
        let pairs = centre.iter().zip(state).enumerate();
        pairs.map(|(j, (&from, &to))| motion.change(j, from, to)).collect()
    };
    let mut similar = vec![];
    let mut away = vec![];
    for i in 0..particles.count() {
        let change = changes(&particles.state(i));
        if i == mode || change.iter().zip(motion.step_sd()).all(|(change, sd)| change.abs() <= width * sd) {
            similar.push(i);
            away.push(change);
        }
    }
    let mut weights = vec![];
    normalise(&similar.iter().map(|&i| log_weights[i]).collect::<Vec<_>>(), &mut weights)?;
    let mut mean = centre;
    for (weight, away) in weights.iter().zip(&away) {
        mean.iter_mut().zip(away).for_each(|(mean, away)| *mean += weight * away);
    }
    let astray = met.iter().filter(|met| **met < most).count();
    Ok(ModeMean { mode, similar, mean, astray })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::select;
    use sinew_core::lanes::Block;
    use sinew_core::random::BlockRng;
    use sinew_core::transition::{Choices, MotionModel};

    /// The second coordinate turns.
    struct Turning;
    impl MotionModel for Turning {
        fn dim(&self) -> usize {
            2
        }
    }
    impl LevelMotion for Turning {
        fn sample_level_block(&self, _: usize, _: &[Block], _: &mut [Block], _: &mut [Choices], _: &mut BlockRng) {}
        fn step_sd(&self) -> &[f64] {
            &[0.1, 0.2]
        }
        fn change(&self, j: usize, from: f64, to: f64) -> f64 {
            let change = to - from;
            if j == 1 { change - std::f64::consts::TAU * (change / std::f64::consts::TAU).round() } else { change }
        }
    }

    fn particles(states: &[[f64; 2]], weights: &[f64]) -> Particles {
        let mut particles = Particles::new(&[0.0; 2], states.len()).expect("not empty");
        for (i, state) in states.iter().enumerate() {
            for (j, x) in state.iter().enumerate() {
                particles.states[i / 8 * 2 + j].0[i % 8] = *x;
            }
        }
        let logs: Vec<f64> = weights.iter().map(|w| w.ln()).collect();
        select(&mut particles, (0..states.len()).collect(), &logs).expect("weights");
        particles
    }

    #[test]
    fn the_mean_is_that_of_what_is_near_the_mode() {
        let states = [[1.0, 3.1], [1.2, -3.1], [1.31, 3.1], [1.0, 2.4], [9.0, 3.1]];
        let set = particles(&states, &[0.3, 0.1, 0.2, 0.1, 0.3]);
        let found = mode_mean(&set, &[1.0; 5], &Turning, 3.0).expect("weights");
        assert_eq!((found.mode, &found.similar[..], found.astray), (0, &[0, 1][..], 0));
        let round = std::f64::consts::TAU - 6.2;
        assert!((found.mean[0] - (1.0 + 0.25 * 0.2)).abs() < 1e-12);
        assert!((found.mean[1] - (3.1 + 0.25 * round)).abs() < 1e-12, "the short way round");
    }

    /// K14b: a state that meets nothing of what was seen may have the largest weight and is not the mode.
    #[test]
    fn a_state_astray_is_never_the_mode() {
        let set = particles(&[[1.0, 0.0], [5.0, 0.0], [1.1, 0.0]], &[0.2, 0.7, 0.1]);
        let found = mode_mean(&set, &[4.0, 0.0, 4.0], &Turning, 3.0).expect("weights");
        assert_eq!((found.mode, found.astray, found.similar), (0, 1, vec![0, 2]));
        let nobody = mode_mean(&set, &[0.0; 3], &Turning, 3.0).expect("weights");
        assert_eq!((nobody.mode, nobody.astray), (1, 0));
        let weightless = particles(&[[1.0, 0.0], [5.0, 0.0]], &[0.0, 1.0]);
        assert!(mode_mean(&weightless, &[1.0, 0.0], &Turning, 3.0).is_err());
    }
}
