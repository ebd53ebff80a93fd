//! Particles level by level: the parts of one depth move, are weighed and resampled on their own.
//!
//! (Husz, Wallace & Green 2007.)
//!
//! - [`predict_level`] moves one level of the states.
//! - [`log_plausibilities`] is what some coordinates are worth by themselves.
//! - [`resample_part`] gives each state the coordinates of one part from an ancestor of its own and leaves the others, so that good limbs of different states meet, as by [`crate::crossover`].
//! - [`log_global`] compares whole states.
//!
//! None of them keeps a distribution but [`predict_level`]: truncation has a bias on purpose, and a state put together from several has lost what its parts knew of each other. They are part of a search.

use crate::Error;
use crate::origins::{PartOrigins, take_row};
use crate::particles::Particles;
use crate::resample::{Truncation, shuffle};
use crate::weights::{effective_number, normalise};
use rayon::prelude::*;
use sinew_core::density::{Global, PartLogDensity};
use sinew_core::lanes::Block;
use sinew_core::random::Stage;
use sinew_core::transition::LevelMotion;

/// How the survivors of a level are chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Selection {
    /// The reading of "only the highest survive".
    pub truncation: Truncation,
    /// The share that does: 0.8 in the paper.
    pub surviving: f64,
}

impl Default for Selection {
    fn default() -> Self {
        Self { truncation: Truncation::default(), surviving: 0.8 }
    }
}

impl Selection {
    /// Ancestors by these normalised weights. Where they come sorted they are put in random order, so that parts which are resampled one after the other do not meet by their place.
    #[must_use]
    pub fn ancestors(self, weights: &[f64], stage: Stage) -> Vec<usize> {
        let rng = &mut stage.whole();
        let mut ancestors = self.truncation.ancestors(weights, self.surviving, rng);
        if self.truncation == Truncation::TruncateThenSystematic {
            shuffle(&mut ancestors, rng);
        }
        ancestors
    }
}

/// Moves one level of the states, each part from its origin, which keeps how it was moved.
pub fn predict_level<M: LevelMotion + ?Sized>(
    particles: &mut Particles,
    origins: &mut PartOrigins,
    motion: &M,
    level: usize,
    stage: Stage,
) {
    let d = particles.dim();
    let PartOrigins { before, choices, parts } = origins;
    let blocks = particles.states.par_chunks_mut(d).zip(before.states.par_chunks(d));
    blocks.zip(choices.par_chunks_mut(*parts)).enumerate().for_each(|(block, ((states, before), choices))| {
        motion.sample_level_block(level, before, states, choices, &mut stage.block(block as u32));
    });
}

/// Log ψ of some coordinates of each state.
#[must_use]
pub fn log_plausibilities<M: LevelMotion + ?Sized>(
    particles: &Particles,
    motion: &M,
    coordinates: &[usize],
) -> Vec<f64> {
    let blocks = particles.states.chunks_exact(particles.dim());
    let values = blocks.flat_map(|states| motion.log_plausibility_block(coordinates, states).0);
    values.take(particles.count()).collect()
}

/// Draws an ancestor for each state by these weights and gives it the ancestor's `coordinates`; the others stay where they are. Some `parts` bring their origin along: the coordinates in the frame before, and how they were moved. Returns
/// the survival diagnostic D = 1 / Σ W².
///
/// # Errors
/// [`Error::AllWeightsZero`], [`Error::BadWeight`]; nothing has changed then.
pub fn resample_part(
    particles: &mut Particles,
    origins: &mut PartOrigins,
    parts: &[usize],
    coordinates: &[usize],
    log_weights: &[f64],
    selection: Selection,
    stage: Stage,
) -> Result<f64, Error> {
    let mut weights = Vec::new();
    normalise(log_weights, &mut weights)?;
    let ancestors = selection.ancestors(&weights, stage);
    let d = particles.dim();
    coordinates.iter().for_each(|&j| take_row(&mut particles.states, d, j, &ancestors, |block| &mut block.0));
    origins.take(parts, coordinates, &ancestors);
    Ok(effective_number(&weights))
}

/// What each whole state is worth beside the others: log likelihoods, and in how many observations it meets anything of what was seen.
#[must_use]
pub fn log_global<D: PartLogDensity + ?Sized>(particles: &Particles, density: &D) -> [Vec<f64>; 2] {
    let scratch = || vec![Block::ZERO; density.workspace()];
    let blocks: Vec<Global> = particles
        .states
        .par_chunks(particles.dim())
        .map_init(scratch, |ws, states| density.global_block(states, ws))
        .collect();
    let values = |of: fn(&Global) -> Block| blocks.iter().flat_map(|b| of(b).0).take(particles.count()).collect();
    [values(|global| global.log_likelihood), values(|global| global.met)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diffusion::diffuse;
    use sinew_core::lanes::Isa;
    use sinew_core::random::BlockRng;
    use sinew_core::transition::{Choices, MotionModel};

    const COUNT: usize = 50;

    fn cloud(purpose: &str) -> Particles {
        let mut particles = Particles::new(&[0.0; 5], COUNT).expect("not empty");
        diffuse(&mut particles, None, &[1.0; 5], Isa::best(), Stage::new(1, purpose));
        particles
    }

    /// Update of a level (A10): only the part's coordinates change, and state i has them from one state; with the other reading of survival, too.
    #[test]
    fn a_part_comes_from_one_ancestor_and_the_rest_stays() {
        let log_weights: Vec<f64> = (0..COUNT).map(|i| ((i * 37) % COUNT) as f64 * 0.2).collect();
        for truncation in [Truncation::KeepOnceRefill, Truncation::TruncateThenSystematic] {
            let (now, then) = (cloud("now"), cloud("then"));
            let (mut particles, mut origins) = (now.clone(), PartOrigins::new(then.clone(), 1));
            let selection = Selection { truncation, surviving: 0.8 };
            let stage = Stage::new(2, "part");
            let d = resample_part(&mut particles, &mut origins, &[0], &[3, 1], &log_weights, selection, stage);
            assert!((1.0..50.0).contains(&d.expect("weights")));
            let before = origins.before;
            let mut kept = 0;
            for slot in 0..COUNT {
                let (new, old) = (particles.state(slot), now.state(slot));
                assert!([0, 2, 4].iter().all(|&j| new[j] == old[j]));
                let ancestor = (0..COUNT).find(|&a| now.state(a)[3] == new[3]).expect("someone's");
                assert_eq!(now.state(ancestor)[1], new[1], "both coordinates of one state");
                assert!(log_weights[ancestor] >= 0.2 * 10.0, "the lowest fifth has no offspring");
                let past = [1, 3].map(|j| before.state(slot)[j]);
                assert_eq!(past, [1, 3].map(|j| then.state(ancestor)[j]), "its past goes with it");
                assert!([0, 2, 4].iter().all(|&j| before.state(slot)[j] == then.state(slot)[j]));
                kept += usize::from(ancestor == slot);
            }
            assert_eq!(kept >= 40, truncation == Truncation::KeepOnceRefill, "{kept}");
        }
    }

    /// Two parts that are resampled one after the other by equal weights come from ancestors that have nothing to do with each other: rank correlation below 4 / √50, seed 2.
    #[test]
    fn parts_do_not_meet_by_their_place() {
        let weights = vec![1.0 / COUNT as f64; COUNT];
        let selection = Selection { truncation: Truncation::TruncateThenSystematic, surviving: 1.0 };
        let [a, b] = [0, 1].map(|round| selection.ancestors(&weights, Stage::new(2, "two parts").round(round)));
        let middle = 0.5 * (COUNT - 1) as f64;
        let product = |a: &[usize], b: &[usize]| -> f64 {
            a.iter().zip(b).map(|(&a, &b)| (a as f64 - middle) * (b as f64 - middle)).sum()
        };
        let correlation = product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt();
        assert!(correlation.abs() < 4.0 / (COUNT as f64).sqrt(), "{correlation}");
    }

    #[test]
    fn a_part_that_nothing_explains_is_an_error_and_changes_nothing() {
        let (now, selection) = (cloud("now"), Selection::default());
        let (mut particles, mut origins) = (now.clone(), PartOrigins::new(now.clone(), 1));
        let none = vec![f64::NEG_INFINITY; COUNT];
        let error = resample_part(&mut particles, &mut origins, &[0], &[0], &none, selection, Stage::new(2, "part"));
        assert_eq!(error, Err(Error::AllWeightsZero { count: COUNT }));
        assert_eq!((particles.states(), origins.before.states()), (now.states(), now.states()));
    }

    /// Adds the level and what the state was, chooses by the signs of coordinate 0, and finds coordinate 2 implausible.
    struct Lift;
    impl MotionModel for Lift {
        fn dim(&self) -> usize {
            5
        }
    }
    impl LevelMotion for Lift {
        fn sample_level_block(
            &self,
            level: usize,
            before: &[Block],
            next: &mut [Block],
            choices: &mut [Choices],
            _rng: &mut BlockRng,
        ) {
            next[level].0.iter_mut().zip(before[level].0).for_each(|(x, before)| *x += before + level as f64);
            choices[1] = core::array::from_fn(|lane| if before[0].0[lane] > 0.0 { 2 } else { 1 });
        }
        fn step_sd(&self) -> &[f64] {
            &[1.0; 5]
        }
        fn log_plausibility_block(&self, coordinates: &[usize], x: &[Block]) -> Block {
            if coordinates.contains(&2) { x[2] } else { Block::ZERO }
        }
    }

    #[test]
    fn a_level_sees_the_states_before() {
        let (mut particles, before) = (cloud("now"), cloud("then"));
        let (now, mut origins) = (particles.clone(), PartOrigins::new(before.clone(), 2));
        predict_level(&mut particles, &mut origins, &Lift, 3, Stage::new(3, "level"));
        let positive = (0..COUNT).filter(|&i| before.state(i)[0] > 0.0).count() as f64 / COUNT as f64;
        assert!((1..COUNT).contains(&((positive * COUNT as f64) as usize)));
        let chosen = origins.shares();
        assert!(chosen[0] == [(0, 1.0)] && chosen[1][1] == (2, positive), "{chosen:?}");
        for i in 0..COUNT {
            let (new, old) = (particles.state(i), now.state(i));
            assert!([0, 1, 2, 4].iter().all(|&j| new[j] == old[j]));
            assert_eq!(new[3], old[3] + (before.state(i)[3] + 3.0));
        }
        assert_eq!(log_plausibilities(&particles, &Lift, &[0, 1]), [0.0; COUNT]);
        let by_coordinate: Vec<f64> = (0..COUNT).map(|i| now.state(i)[2]).collect();
        assert_eq!(log_plausibilities(&particles, &Lift, &[4, 2]), by_coordinate);
    }
}
