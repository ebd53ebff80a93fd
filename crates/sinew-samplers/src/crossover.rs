//! Crossover of resampled particles (Deutscher & Reid 2005).
//!
//! A child takes a stretch of its coordinates from a second parent, so that good limbs of different particles meet.
//!
//! With probability p, independently for each child i of parent a:
//!
//! 1. b is drawn by the weights, independent of a
//! 2. two cuts c₁ < c₂ are drawn uniformly from 0 … d
//! 3. child\[c₁ .. c₂) = b\[c₁ .. c₂)
//!
//! Law `marginals_are_kept`: each coordinate alone has the distribution that resampling without crossover gives it. Correlations are not kept, so this is part of a search and of no sampler.

use crate::particles::{Particles, take};
use crate::resample::{Ancestors, below, multinomial, shuffle};
use sinew_core::lanes::{Block, LANES};
use sinew_core::random::Stage;

/// A child, its second parent and the coordinates that come from it.
struct Mating {
    child: usize,
    mate: usize,
    from: usize,
    to: usize,
}

/// Takes the states of these ancestors, which were drawn by the weights, with equal weights, and crosses the part `probability` of them on average.
pub fn cross(particles: &mut Particles, ancestors: Ancestors, probability: f64, stage: Stage) {
    let (d, count) = (particles.dim(), particles.count());
    let rng = &mut stage.whole();
    let mut mates = multinomial(particles.weights(), count, rng);
    shuffle(&mut mates, rng);
    let mut matings = vec![];
    for (child, mate) in mates.into_iter().enumerate() {
        let mut uniform = [Block::ZERO];
        rng.fill_uniform(&mut uniform);
        let (a, b) = (below(d + 1, rng), below(d, rng));
        let b = if b < a { b } else { b + 1 };
        if uniform[0].0[0] < probability {
            matings.push(Mating { child, mate, from: a.min(b), to: a.max(b) });
        }
    }
    take(particles, ancestors);
    for Mating { child, mate, from, to } in matings {
        for j in from..to {
            let inherited = particles.previous[mate / LANES * d + j].0[mate % LANES];
            particles.states[child / LANES * d + j].0[child % LANES] = inherited;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diffusion::diffuse;
    use sinew_core::lanes::Isa;

    fn moved() -> Particles {
        let mut particles = Particles::new(&[0.0; 4], 50).expect("not empty");
        diffuse(&mut particles, None, &[1.0; 4], Isa::best(), Stage::new(1, "states"));
        particles
    }

    #[test]
    fn a_child_has_one_stretch_of_a_second_parent() {
        let before = moved();
        let ancestors: Vec<usize> = (0..50).map(|i| i / 2).collect();
        for (probability, bounds) in [(0.0, 0..=0), (0.5, 10..=40), (1.0, 48..=50)] {
            let mut crossed = before.clone();
            cross(&mut crossed, ancestors.clone(), probability, Stage::new(2, "cross"));
            let mut changed = 0;
            for (child, parent) in ancestors.iter().enumerate() {
                let (child, parent) = (crossed.state(child), before.state(*parent));
                let foreign: Vec<usize> = (0..4).filter(|&j| child[j] != parent[j]).collect();
                let Some((&first, &last)) = foreign.first().zip(foreign.last()) else { continue };
                assert_eq!(foreign, (first..=last).collect::<Vec<_>>(), "one stretch");
                let mates = (0..50).filter(|&b| (first..=last).all(|j| before.state(b)[j] == child[j]));
                assert_eq!(mates.count(), 1);
                changed += 1;
            }
            assert!(bounds.contains(&changed), "{probability}: {changed}");
            assert!(crossed.weights().iter().all(|w| *w == 0.02));
        }
    }
}
