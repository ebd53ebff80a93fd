//! The three switching models of Husz, Wallace & Green (2007, eqs. 6–8) for one feature vector.
//!
//! With probability ⅓ each, drawn for every state on its own, and k the cluster of the state's action primitive ([`crate::primitives::matching`]):
//!
//! - (6) p' = M_NBFV + L_NBFV e, what follows in the cluster;
//! - (7) p' = p + M*_NBFV + L*_NBFV e, the step that follows in the cluster;
//! - (8) p' = p + B e, a random walk,
//!
//! L Lᵀ = Σ of cluster k and e ~ N(0, I). The paper prints Σ e for L e, which would have another covariance than Σ.

use crate::Error;
use crate::factor::{cholesky, inverse_lower};
use crate::primitives::matching::Matcher;
use crate::primitives::model::{Normal, Primitives};
use core::f64::consts::TAU;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::random::BlockRng;

/// Which of the three models moves a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// Model (6): what follows in the cluster.
    Next,
    /// Model (7): the step that follows in the cluster.
    Step,
    /// Model (8): a random walk.
    Walk,
}

/// The cluster of a state and the model that moves it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// Number of the cluster.
    pub cluster: usize,
    /// The model.
    pub branch: Branch,
}

impl Branch {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Next, Self::Step, Self::Walk];

    /// Name in files.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Next => "next",
            Self::Step => "step",
            Self::Walk => "walk",
        }
    }
}

impl Choice {
    /// Its number among all choices, from 1 on; 0 is a walk without clusters.
    #[must_use]
    pub const fn number(self) -> u32 {
        (1 + Branch::ALL.len() * self.cluster + self.branch as usize) as u32
    }

    /// The cluster, where there was one, and the model that a number stands for.
    #[must_use]
    pub const fn from_number(number: u32) -> (Option<usize>, Branch) {
        match (number as usize).checked_sub(1) {
            None => (None, Branch::Walk),
            Some(number) => (Some(number / Branch::ALL.len()), Branch::ALL[number % Branch::ALL.len()]),
        }
    }
}

/// A normal distribution with its factors, of a cluster and one of the models (6) and (7).
#[derive(Clone, Debug)]
pub(crate) struct Factored {
    pub(crate) mean: Vec<f64>,
    /// L, F × F.
    pub(crate) lower: Vec<f64>,
    /// L⁻¹, F × F.
    pub(crate) whitening: Vec<f64>,
    /// Log density at the mean.
    pub(crate) log_norm: f64,
}

impl Factored {
    fn new(normal: &Normal, dim: usize) -> Result<Self, Error> {
        if normal.mean.len() != dim {
            return Err(Error::Shape { name: "mean of a cluster", found: normal.mean.len(), expected: dim });
        }
        let lower = cholesky("covariance of a cluster", &normal.covariance, dim)?.lower;
        let log_norm = -(0..dim).map(|i| lower[i * (dim + 1)].ln() + 0.5 * TAU.ln()).sum::<f64>();
        Ok(Self { mean: normal.mean.clone(), whitening: inverse_lower(&lower, dim), lower, log_norm })
    }
}

/// The models of one feature vector of F coordinates.
#[derive(Clone, Debug)]
pub struct Switching {
    matcher: Matcher,
    pub(crate) next: Vec<Factored>,
    pub(crate) step: Vec<Factored>,
    noise_sd: Vec<f64>,
    isa: Isa,
}

impl Switching {
    /// The models of the clusters, and a random walk with the standard deviations `noise_sd` of the F coordinates.
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`], and as [`cholesky`].
    pub fn new(primitives: &Primitives, noise_sd: &[f64], isa: Isa) -> Result<Self, Error> {
        let dim = primitives.feature.coordinates.len();
        if noise_sd.len() != dim {
            return Err(Error::Shape { name: "noise", found: noise_sd.len(), expected: dim });
        }
        if let Some(index) = noise_sd.iter().position(|sd| !(*sd > 0.0 && sd.is_finite())) {
            let expected = "must be positive and finite";
            return Err(Error::OutOfRange { name: "noise", index, value: noise_sd[index], expected });
        }
        let matcher = Matcher::new(primitives, isa)?;
        let next = primitives.clusters.iter().map(|cluster| Factored::new(&cluster.next, dim));
        let step = primitives.clusters.iter().map(|cluster| Factored::new(&cluster.step, dim));
        let (next, step) = (next.collect::<Result<_, _>>()?, step.collect::<Result<_, _>>()?);
        Ok(Self { matcher, next, step, noise_sd: noise_sd.to_vec(), isa })
    }

    /// The clusters, ready to be matched.
    #[must_use]
    pub fn matcher(&self) -> &Matcher {
        &self.matcher
    }

    /// Draws for each lane which model moves it, and finds its cluster; `older` and `own` as in [`Matcher::nearest_block`].
    pub fn choose_block(&self, older: &[f64], own: &[Block], rng: &mut BlockRng) -> [Choice; LANES] {
        Self::branches(self.matcher.nearest_block(older, own), rng)
    }

    /// Draws for each lane which model of its cluster moves it.
    pub(crate) fn branches(clusters: [usize; LANES], rng: &mut BlockRng) -> [Choice; LANES] {
        let mut uniform = [Block::ZERO];
        rng.fill_uniform(&mut uniform);
        let branch = |u: f64| match (3.0 * u) as usize {
            0 => Branch::Next,
            1 => Branch::Step,
            _ => Branch::Walk,
        };
        core::array::from_fn(|lane| Choice { cluster: clusters[lane], branch: branch(uniform[0].0[lane]) })
    }

    /// Draws the next feature vector of each lane from the model chosen for it, F blocks.
    pub fn draw_block(&self, choices: &[Choice; LANES], own: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        let dim = self.noise_sd.len();
        let mut noise = vec![Block::ZERO; dim];
        rng.fill_normal(self.isa, &mut noise);
        for (lane, Choice { cluster, branch }) in choices.iter().enumerate() {
            let (normal, from_own) = match branch {
                Branch::Next => (&self.next[*cluster], 0.0),
                Branch::Step => (&self.step[*cluster], 1.0),
                Branch::Walk => {
                    for j in 0..dim {
                        next[j].0[lane] = own[j].0[lane] + self.noise_sd[j] * noise[j].0[lane];
                    }
                    continue;
                }
            };
            for (i, row) in normal.lower.chunks_exact(dim).enumerate() {
                let spread: f64 = row[..=i].iter().zip(&noise).map(|(l, z)| l * z.0[lane]).sum();
                next[i].0[lane] = from_own * own[i].0[lane] + normal.mean[i] + spread;
            }
        }
    }

    /// Draws the next feature vector of each lane, and says by which model.
    pub fn sample_block(
        &self,
        older: &[f64],
        own: &[Block],
        next: &mut [Block],
        rng: &mut BlockRng,
    ) -> [Choice; LANES] {
        let choices = self.choose_block(older, own, rng);
        self.draw_block(&choices, own, next, rng);
        choices
    }

    /// The means of models (6) and (7) for one feature vector.
    #[must_use]
    pub fn expected(&self, older: &[f64], own: &[f64]) -> [Vec<f64>; 2] {
        let block: Vec<Block> = own.iter().map(|&x| Block::splat(x)).collect();
        let cluster = self.matcher.nearest_block(older, &block)[0];
        let step = own.iter().zip(&self.step[cluster].mean).map(|(x, step)| x + step).collect();
        [self.next[cluster].mean.clone(), step]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::made_up::primitives;
    use sinew_core::random::Stage;

    const DRAWS: usize = 48_000;

    fn models() -> (Switching, Vec<f64>, Vec<Block>) {
        let learned = primitives();
        let switching = Switching::new(&learned, &[0.2, 0.5], Isa::best()).expect("valid");
        let older = vec![0.3; switching.matcher().older_len()];
        let own = [0.4, -0.2].map(|x| Block(core::array::from_fn(|lane| x + 0.3 * lane as f64)));
        (switching, older, own.to_vec())
    }

    /// Switching of models (M5): the share of each model among 48 000 draws, |z| < 4.
    #[test]
    fn each_model_has_a_third_of_the_draws() {
        let (switching, older, own) = models();
        let (mut rng, mut counts) = (Stage::new(1, "switch").whole(), [0.0; 3]);
        for _ in 0..DRAWS / LANES {
            for choice in switching.choose_block(&older, &own, &mut rng) {
                counts[choice.branch as usize] += 1.0;
            }
        }
        let n = DRAWS as f64;
        for (branch, count) in counts.into_iter().enumerate() {
            let z = (count - n / 3.0) / (n * 2.0 / 9.0).sqrt();
            assert!(z.abs() < 4.0, "model {branch}: {count} of {n}, z = {z}, bound 4, seed 1");
        }
    }

    /// Mean and covariance of each model in each lane, from a cluster that is its own: 3 · 8 · 5 statistics at |z| < 4.5, seed 2.
    #[test]
    fn draws_have_the_moments_of_their_model() {
        let (switching, _, own) = models();
        let mut rng = Stage::new(2, "moments").whole();
        for branch in [Branch::Next, Branch::Step, Branch::Walk] {
            let choices = core::array::from_fn(|lane| Choice { cluster: lane % switching.next.len(), branch });
            let (mut next, mut sums, n) = (vec![Block::ZERO; 2], [[0.0; 5]; LANES], 20_000.0);
            let moments = |lane: usize| {
                let at = [own[0].0[lane], own[1].0[lane]];
                let (normal, mean) = match branch {
                    Branch::Next => (&switching.next[lane % switching.next.len()], [0.0; 2]),
                    Branch::Step => (&switching.step[lane % switching.next.len()], at),
                    Branch::Walk => return (at, [0.04, 0.0, 0.25]),
                };
                let l = &normal.lower;
                let covariance = [l[0] * l[0], l[0] * l[2], l[2] * l[2] + l[3] * l[3]];
                ([mean[0] + normal.mean[0], mean[1] + normal.mean[1]], covariance)
            };
            for _ in 0..20_000 {
                switching.draw_block(&choices, &own, &mut next, &mut rng);
                for (lane, sums) in sums.iter_mut().enumerate() {
                    let mean = moments(lane).0;
                    let [x, y] = [0, 1].map(|j| next[j].0[lane] - mean[j]);
                    sums.iter_mut().zip([x, y, x * x, x * y, y * y]).for_each(|(sum, value)| *sum += value / n);
                }
            }
            for (lane, sums) in sums.into_iter().enumerate() {
                let [xx, xy, yy] = moments(lane).1;
                let exact = [(0.0, xx), (0.0, yy), (xx, 2.0 * xx * xx), (xy, xx * yy + xy * xy), (yy, 2.0 * yy * yy)];
                for (k, (sum, (mean, variance))) in sums.into_iter().zip(exact).enumerate() {
                    let z = (sum - mean) / f64::sqrt(variance / n);
                    assert!(z.abs() < 4.5, "{branch:?}, lane {lane}, moment {k}: z = {z}, bound 4.5, seed 2");
                }
            }
        }
    }

    #[test]
    fn choices_have_numbers_of_their_own() {
        assert_eq!(Choice::from_number(0), (None, Branch::Walk));
        let all = (0..100).flat_map(|cluster| Branch::ALL.map(|branch| Choice { cluster, branch }));
        for (place, choice) in all.enumerate() {
            assert_eq!(choice.number() as usize, place + 1);
            assert_eq!(Choice::from_number(choice.number()), (Some(choice.cluster), choice.branch));
        }
    }

    #[test]
    fn noise_without_width_is_refused() {
        let learned = primitives();
        for sd in [&[0.2][..], &[0.2, 0.0], &[0.2, f64::NAN]] {
            assert!(Switching::new(&learned, sd, Isa::best()).is_err());
        }
    }
}
