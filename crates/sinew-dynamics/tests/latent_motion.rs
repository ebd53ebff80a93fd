//! Laws of the transitions that latent trackers are given: side by side, and with latents injected.

use sinew_core::Error;
use sinew_core::injection::{Injected, Injection};
use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;
use sinew_core::side_by_side::SideBySide;
use sinew_core::transition::{GradTransition, MotionModel, Transition};
use sinew_dynamics::first_order::FirstOrder;
use sinew_dynamics::random_walk::{Between, RandomWalk};

fn walk(sd: &[f64]) -> RandomWalk {
    RandomWalk::new(sd, 1.0, Between::Mixture, Isa::best()).expect("valid")
}

fn both() -> SideBySide<FirstOrder<RandomWalk>, RandomWalk> {
    SideBySide(FirstOrder::new(walk(&[0.5, 0.2]), 0.5).expect("finite"), walk(&[0.1]))
}

#[test]
fn densities_multiply() {
    let mut motion = both();
    motion.follow(None, &[0.0; 3]);
    motion.follow(Some(&[0.0; 3]), &[1.0, 2.0, 3.0]);
    let (from, to) = ([0.1, 0.2, 0.3], [0.4, 0.9, 0.2]);
    let expected = motion.0.log_density(&from[..2], &to[..2]) + motion.1.log_density(&from[2..], &to[2..]);
    let mut grad = [0.0; 3];
    assert_eq!((motion.dim(), motion.log_density(&from, &to)), (3, expected));
    assert_eq!(motion.log_density_grad(&from, &to, &mut grad), expected);
    for j in 0..3 {
        let at = |h: f64| {
            let mut to = to;
            to[j] += h;
            motion.log_density(&from, &to)
        };
        assert!(((at(1e-5) - at(-1e-5)) / 2e-5 - grad[j]).abs() < 1e-6, "coordinate {j}");
    }
}

/// A part that is none changes nothing; one that is there is itself.
#[test]
fn parts_may_be_missing() {
    let (from, to) = ([0.1, 0.2, 0.3], [0.4, 0.9, 0.2]);
    let drawn = |motion: &dyn Transition| {
        let mut next = [Block::ZERO; 3];
        motion.sample_block(&from.map(Block::splat), &mut next, &mut Stage::new(1, "beside").whole());
        (motion.dim(), next, motion.log_density(&from, &to))
    };
    let bare = both();
    assert_eq!(drawn(&SideBySide(both(), None::<RandomWalk>)), drawn(&bare));
    assert_eq!(drawn(&SideBySide(bare.0.clone(), Some(bare.1.clone()))), drawn(&bare));
}

/// Each part of a state is drawn by its own model, also in the first frame; the law `memory_resumes`.
#[test]
fn parts_move_by_their_own_models() {
    let mut motion = both();
    let moved = |motion: &SideBySide<FirstOrder<RandomWalk>, RandomWalk>| {
        let (mut next, mut first) = ([Block::ZERO; 3], [Block::ZERO; 3]);
        motion.sample_block(&[1.0, 2.0, 3.0].map(Block::splat), &mut next, &mut Stage::new(1, "beside").whole());
        motion.sample_initial_block(&[1.0, 2.0, 3.0], &mut first, &mut Stage::new(1, "beside").whole());
        [next, first]
    };
    let mut rng = Stage::new(1, "beside").whole();
    let mut expected = [Block::ZERO; 3];
    motion.0.sample_block(&[1.0, 2.0].map(Block::splat), &mut expected[..2], &mut rng);
    motion.1.sample_block(&[Block::splat(3.0)], &mut expected[2..], &mut rng);
    assert_eq!(moved(&motion), [expected; 2]);
    motion.follow(None, &[0.0; 3]);
    motion.follow(Some(&[0.0; 3]), &[1.0, 2.0, 3.0]);
    let mut other = both();
    assert_ne!(moved(&motion), moved(&other));
    other.recall(&motion.memory());
    assert_eq!(moved(&motion), moved(&other));
}

/// Law `injection_is_a_mixture`: means of 80 000 draws against integrals of the density; six statistics at |z| < 4.5, false alarm 4e-5. With probability 0 nothing changes.
#[test]
fn injection_is_a_mixture() {
    let latents = vec![2.0, -1.0, 4.0];
    let injected = |probability| {
        Injected::new(walk(&[0.3, 0.2]), Injection { probability, latents: latents.clone() }, 1..2).expect("valid")
    };
    let (motion, from) = (injected(0.4), [0.5, 0.0]);
    let bins = [-10.0, -0.5, 1.0, 3.0, 10.0];
    // The density over its second coordinate, the first integrated as well.
    let cell = 0.01;
    let mut expected = [0.0; 4];
    for i in 0..800 {
        for k in 0..2000 {
            let to = [-3.5 + cell * (f64::from(i) + 0.5), -10.0 + cell * (f64::from(k) + 0.5)];
            let bin = bins.windows(2).position(|bin| to[1] < bin[1]).expect("inside");
            expected[bin] += cell * cell * motion.log_density(&from, &to).exp();
        }
    }
    assert!((expected.iter().sum::<f64>() - 1.0).abs() < 1e-6, "{expected:?}");
    let (mut counts, mut sum) = ([0.0; 4], 0.0);
    for block in 0..10_000 {
        let mut next = [Block::ZERO; 2];
        motion.sample_block(&from.map(Block::splat), &mut next, &mut Stage::new(3, "injection").block(block));
        sum += next[0].0.iter().sum::<f64>();
        next[1].0.iter().for_each(|x| counts[bins.windows(2).position(|bin| *x < bin[1]).expect("inside")] += 1.0);
    }
    let n = 80_000.0_f64;
    for (count, p) in counts.into_iter().zip(expected) {
        let z = (count / n - p) / (p * (1.0 - p) / n).sqrt();
        assert!(z.abs() < 4.5, "{counts:?} for {expected:?}, z = {z}");
    }
    assert!(((sum / n - 0.5) / (0.3 / n.sqrt())).abs() < 4.5, "what is no latent moves on");
    let moved = |motion: &dyn Transition| {
        let mut next = [Block::ZERO; 2];
        motion.sample_block(&from.map(Block::splat), &mut next, &mut Stage::new(1, "none").whole());
        (next, motion.log_density(&from, &[0.1, 0.2]))
    };
    assert_eq!(moved(&injected(0.0)), moved(&walk(&[0.3, 0.2])));
    let refused = |probability, latents: &[f64], latent| {
        Injected::new(walk(&[0.3, 0.2]), Injection { probability, latents: latents.to_vec() }, latent).expect_err("bad")
    };
    assert_eq!(refused(0.1, &[], 1..2), Error::Rows { entries: 0, columns: 1 });
    assert_eq!(refused(0.0, &[1.0], 0..2), Error::Rows { entries: 1, columns: 2 });
    assert_eq!(refused(1.5, &[1.0], 1..2), Error::Probability { value: 1.5 });
    assert!(matches!(refused(f64::NAN, &[1.0], 1..2), Error::Probability { .. }));
}
