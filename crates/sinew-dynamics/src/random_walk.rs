//! Gaussian random walk (Choo & Fleet 2001): s_t ~ N(s_{t−1}, Σ), Σ diagonal.
//!
//! Standard deviations are given per square-root second, so that the variance grows with time and not with the number of frames: σ_j = rate_j √Δt. The paper's 0.015 m and 0.15 rad per frame are taken at 30 frames a second.
//!
//! As [`Predict`] it offers both priors between frames: [`Between::Mixture`], the paper's (1/M) Σ_i N(·; s^(i), Σ) over the last states of the M chains (eq. 9), which under-covers unless M is large or the noise wide; and
//! [`Between::Gaussian`], N(m, C + Σ) with the mean and shrunk covariance of all draws. Angles are not wrapped; there are no joint limits.

use crate::Error;
use crate::gaussian::Gaussian;
use crate::mixture::Mixture;
use crate::prior::Prior;
use core::f64::consts::TAU;
use sinew_core::density::Lanes;
use sinew_core::lanes::{Block, Isa, Kernel, LANES, Real, dispatch};
use sinew_core::part::Part;
use sinew_core::random::BlockRng;
use sinew_core::transition::{Cloud, GradTransition, MotionModel, PartTransition, Predict, Transition};

/// How the posterior of one frame becomes the prior of the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Between {
    /// The paper's mixture over the last states of the chains.
    #[default]
    Mixture,
    /// One Gaussian with the moments of all draws.
    Gaussian,
}

/// The random walk of one recording, at its frame rate.
#[derive(Clone, Debug, PartialEq)]
pub struct RandomWalk {
    sd: Vec<f64>,
    initial_sd: Vec<f64>,
    between: Between,
    isa: Isa,
}

fn check(name: &'static str, values: &[f64]) -> Result<(), Error> {
    match values.iter().position(|v| !(*v > 0.0 && v.is_finite())) {
        Some(index) => {
            Err(Error::OutOfRange { name, index, value: values[index], expected: "must be positive and finite" })
        }
        None => Ok(()),
    }
}

impl RandomWalk {
    /// A walk with standard deviations per square-root second, for frames `dt` seconds apart. The first frame's spread about its given centre is that of one step.
    ///
    /// # Errors
    /// [`Error::Shape`] without coordinates, [`Error::OutOfRange`] unless all numbers are positive and finite.
    pub fn new(sd_per_root_second: &[f64], dt: f64, between: Between, isa: Isa) -> Result<Self, Error> {
        if sd_per_root_second.is_empty() {
            return Err(Error::Shape { name: "random walk", found: 0, expected: 1 });
        }
        check("time step", &[dt])?;
        let sd: Vec<f64> = sd_per_root_second.iter().map(|rate| rate * dt.sqrt()).collect();
        check("standard deviation", &sd)?;
        Ok(Self { initial_sd: sd.clone(), sd, between, isa })
    }

    /// The paper's values for a state of three translations and `dim` − 3 angles: 0.015 m and 0.15 rad a frame at 30 frames a second.
    ///
    /// # Errors
    /// As [`RandomWalk::new`].
    pub fn choo_fleet(dim: usize, dt: f64, between: Between, isa: Isa) -> Result<Self, Error> {
        let rate = 30.0_f64.sqrt();
        let sd: Vec<f64> = (0..dim).map(|j| rate * if j < 3 { 0.015 } else { 0.15 }).collect();
        Self::new(&sd, dt, between, isa)
    }

    /// The same walk with another spread of the first frame about its centre.
    ///
    /// # Errors
    /// [`Error::Shape`] or [`Error::OutOfRange`].
    pub fn with_initial_sd(self, initial_sd: Vec<f64>) -> Result<Self, Error> {
        if initial_sd.len() != self.sd.len() {
            return Err(Error::Shape { name: "initial sd", found: initial_sd.len(), expected: self.sd.len() });
        }
        check("initial sd", &initial_sd)?;
        Ok(Self { initial_sd, ..self })
    }

    /// Standard deviations of one step.
    #[must_use]
    pub fn sd(&self) -> &[f64] {
        &self.sd
    }

    /// Standard deviations of the first frame about its centre.
    #[must_use]
    pub fn initial_sd(&self) -> &[f64] {
        &self.initial_sd
    }

    fn add_noise(&self, previous: &[Block], sd: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        rng.fill_normal(self.isa, next);
        dispatch(self.isa, Diffuse { previous, sd, next });
    }

    fn add_noise_to_part(&self, part: &Part, sd: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        let mut noise = vec![Block::ZERO; part.indices().len()];
        rng.fill_normal(self.isa, &mut noise);
        for (&j, z) in part.indices().iter().zip(&noise) {
            for (x, z) in next[j].0.iter_mut().zip(z.0) {
                *x += sd[j] * z;
            }
        }
    }
}

/// Turns the standard normal deviates in `next` into states around the previous ones.
struct Diffuse<'a> {
    previous: &'a [Block],
    sd: &'a [f64],
    next: &'a mut [Block],
}

impl Kernel<Block> for Diffuse<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        for ((x, p), &sd) in self.next.iter_mut().zip(self.previous).zip(self.sd) {
            V::load(x).fma(V::splat(sd), V::load(p)).store(x);
        }
    }
}

impl MotionModel for RandomWalk {
    fn dim(&self) -> usize {
        self.sd.len()
    }
}

impl Transition for RandomWalk {
    fn sample_block(&self, previous: &[Block], next: &mut [Block], rng: &mut BlockRng) {
        self.add_noise(previous, &self.sd, next, rng);
    }

    fn sample_initial_block(&self, centre: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        let centre: Vec<Block> = centre.iter().map(|&x| Block::splat(x)).collect();
        self.add_noise(&centre, &self.initial_sd, next, rng);
    }

    fn log_density(&self, previous: &[f64], next: &[f64]) -> f64 {
        let steps = previous.iter().zip(next).zip(&self.sd);
        steps.map(|((p, n), sd)| -0.5 * ((n - p) / sd).powi(2) - 0.5 * TAU.ln() - sd.ln()).sum()
    }
}

impl GradTransition for RandomWalk {
    fn log_density_grad(&self, previous: &[f64], next: &[f64], grad: &mut [f64]) -> f64 {
        for (((g, p), n), sd) in grad.iter_mut().zip(previous).zip(next).zip(&self.sd) {
            *g = (p - n) / (sd * sd);
        }
        self.log_density(previous, next)
    }
}

impl PartTransition for RandomWalk {
    fn sample_part_block(&self, part: &Part, next: &mut [Block], rng: &mut BlockRng) {
        self.add_noise_to_part(part, &self.sd, next, rng);
    }

    fn sample_initial_part_block(&self, part: &Part, centre: &[f64], next: &mut [Block], rng: &mut BlockRng) {
        for &j in part.indices() {
            next[j] = Block::splat(centre[j]);
        }
        self.add_noise_to_part(part, &self.initial_sd, next, rng);
    }
}

impl Predict for RandomWalk {
    type Prior = Prior;
    type Error = Error;

    fn predict(&self, cloud: Cloud<'_>) -> Result<Prior, Error> {
        let d = self.sd.len();
        match self.between {
            Between::Mixture => {
                let state = |i: usize| cloud.last[i / LANES * d..][..d].iter().map(|b| b.0[i % LANES]).collect();
                let leaf = Mixture::new((0..cloud.count).map(state).collect(), &self.sd)?;
                Ok(Prior::Mixture(Lanes { leaf, isa: self.isa }))
            }
            Between::Gaussian => {
                let leaf = Gaussian::widened(cloud.moments, &self.sd)?;
                Ok(Prior::Gaussian(Lanes { leaf, isa: self.isa }))
            }
        }
    }

    fn initial(&self, centre: &[f64]) -> Result<Prior, Error> {
        let leaf = Mixture::new(vec![centre.to_vec()], &self.initial_sd)?;
        Ok(Prior::Mixture(Lanes { leaf, isa: self.isa }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_core::density::{GradLogDensity, LogDensity};
    use sinew_core::random::Stage;
    use sinew_core::transition::{FramePrior, Moments};

    fn walk(between: Between) -> RandomWalk {
        RandomWalk::new(&[0.5, 1.0, 2.0], 0.25, between, Isa::best()).expect("valid")
    }

    #[test]
    fn noise_is_scaled_to_the_frame_rate() {
        assert_eq!(walk(Between::Mixture).sd(), [0.25, 0.5, 1.0]);
        let sd = RandomWalk::choo_fleet(5, 1.0 / 60.0, Between::Mixture, Isa::best()).expect("valid").sd;
        for (sd, expected) in sd.iter().zip([0.015, 0.015, 0.015, 0.15, 0.15]) {
            assert!((sd - expected / 2.0_f64.sqrt()).abs() < 1e-15);
        }
    }

    #[test]
    fn gradient_matches_differences() {
        let (w, p, n) = (walk(Between::Mixture), [0.1, 0.2, 0.3], [0.4, 0.1, -0.9]);
        let mut grad = [0.0; 3];
        GradTransition::log_density_grad(&w, &p, &n, &mut grad);
        for j in 0..3 {
            let at = |h: f64| {
                let mut n = n;
                n[j] += h;
                Transition::log_density(&w, &p, &n)
            };
            assert!(((at(1e-5) - at(-1e-5)) / 2e-5 - grad[j]).abs() < 1e-8);
        }
    }

    #[test]
    fn a_part_moves_alone() {
        let part = Part::new(vec![1, 2], 3).expect("valid");
        let mut next = [Block::splat(7.0); 3];
        walk(Between::Mixture).sample_part_block(&part, &mut next, &mut Stage::new(1, "part").whole());
        let mut noise = [Block::ZERO; 2];
        Stage::new(1, "part").whole().fill_normal(Isa::best(), &mut noise);
        let moved = |z: Block, sd: f64| Block(z.0.map(|z| 7.0 + sd * z));
        assert_eq!(next, [Block::splat(7.0), moved(noise[0], 0.5), moved(noise[1], 1.0)]);
        let wide = walk(Between::Mixture).with_initial_sd(vec![9.0, 3.0, 4.0]).expect("valid");
        let mut first = [Block::splat(-1.0); 3];
        wide.sample_initial_part_block(&part, &[7.0; 3], &mut first, &mut Stage::new(1, "part").whole());
        assert_eq!(first, [Block::splat(-1.0), moved(noise[0], 3.0), moved(noise[1], 4.0)]);
    }

    /// With one chain and no spread both priors are the transition's density.
    #[test]
    fn both_priors_agree_with_the_transition_from_one_state() {
        let centre = [0.1, 0.2, 0.3];
        let last: Vec<Block> = centre.iter().map(|&x| Block::splat(x)).collect();
        let moments = Moments { mean: centre.to_vec(), covariance: vec![0.0; 9] };
        let x = [0.3, -0.4, 0.9];
        let exact = Transition::log_density(&walk(Between::Mixture), &centre, &x);
        for between in [Between::Mixture, Between::Gaussian] {
            let prior = walk(between).predict(Cloud { last: &last, count: 1, moments: &moments }).expect("valid");
            assert!((prior.log_density(&x) - exact).abs() < 1e-13, "{between:?}");
            let (mut grad, mut force) = ([0.0; 3], [0.0; 3]);
            assert!((prior.log_density_grad(&x, &mut grad) - exact).abs() < 1e-13, "{between:?}");
            GradTransition::log_density_grad(&walk(between), &centre, &x, &mut force);
            assert!(grad.iter().zip(force).all(|(g, f)| (g - f).abs() < 1e-12 * f.abs()), "{grad:?} for {force:?}");
            let (block, mut grads) = (x.map(Block::splat), [Block::ZERO; 3]);
            let mut ws = vec![Block::ZERO; prior.workspace()];
            for values in
                [prior.log_density_block(&block, &mut ws), prior.log_density_grad_block(&block, &mut grads, &mut ws)]
            {
                assert!(values.0.iter().all(|value| (value - exact).abs() < 1e-13), "{between:?}");
            }
            assert!(grads.iter().zip(force).all(|(g, f)| (g.0[6] - f).abs() < 1e-12 * f.abs()));
            let bound = prior.precision();
            assert!(
                (0..9).all(|k| (bound[k] - [16.0, 4.0, 1.0][k / 3] * f64::from(u8::from(k % 4 == 0))).abs() < 1e-12)
            );
            assert!((prior.precision_diagonal()[0] - 16.0).abs() < 1e-12);
            let initial = walk(between).initial(&centre).expect("valid");
            assert!((initial.log_density(&x) - exact).abs() < 1e-13);
        }
    }

    #[test]
    fn the_mixture_takes_its_components_in_turn() {
        let last: Vec<Block> = (0..6)
            .map(|k| Block(core::array::from_fn(|lane| if k % 3 == 0 { (k / 3 * 8 + lane) as f64 * 1e3 } else { 0.0 })))
            .collect();
        let moments = Moments { mean: vec![0.0; 3], covariance: vec![0.0; 9] };
        let prior = walk(Between::Mixture).predict(Cloud { last: &last, count: 10, moments: &moments }).expect("valid");
        let mut out = [Block::ZERO; 3];
        let mut visited = vec![];
        for block in 0..5 {
            prior.sample_block(block, &mut out, &mut Stage::new(1, "turn").block(block as u32));
            visited.extend(out[0].0.map(|x| (x / 1e3).round() as usize));
        }
        assert!(visited.iter().copied().eq((0..40).map(|i| i % 10)));
    }

    #[test]
    fn bad_numbers_are_refused() {
        let new = |sd: &[f64], dt: f64| RandomWalk::new(sd, dt, Between::Mixture, Isa::best());
        assert!(new(&[], 0.1).is_err() && new(&[0.0], 0.1).is_err() && new(&[1.0], 0.0).is_err());
        assert!(new(&[f64::NAN], 0.1).is_err() && new(&[1.0], f64::INFINITY).is_err());
        let w = new(&[1.0], 0.1).expect("valid");
        assert!(w.clone().with_initial_sd(vec![-1.0]).is_err() && w.with_initial_sd(vec![]).is_err());
    }
}
