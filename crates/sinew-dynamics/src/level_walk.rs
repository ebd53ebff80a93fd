//! Motion of a body level by level down its parts, at random or by action primitives.
//!
//! (Husz, Wallace & Green 2007.)
//!
//! At level l, for each part x of depth l on its own, with p_x its coordinates as they stand, and the part's own values p'_x of the frame before:
//!
//! - with probability ⅓ each p_x ← M_NBFV + L e (6), p_x ← p'_x + M* + L* e (7), or p_x ← p_x + B e (8), by the cluster nearest to the last D − 1 estimates with p'_x as the newest ([`crate::primitives::switching`]);
//! - coordinates that no feature vector covers, as the root's, always move by (8);
//! - all coordinates of the parts above level l are slightly tuned: p ← p + 0.2 B e.
//!
//! Which action primitives at which level the paper leaves open. [`LevelPrimitives::Nested`]: a part moves by the feature vector of itself with all that hangs on it, so that the first level proposes all angles and the level of upper limbs
//! whole limbs; under (8) what hangs on a part stays where it is, as its turn comes. [`LevelPrimitives::OwnParts`]: a part moves by the feature vector of its own coordinates. While there are fewer than D estimates, and
//! without a model, everything walks at random by (8); in the first frame with the spread of the start.
//!
//! It is no transition with a density: a coordinate moves up to once a level, and later levels overwrite what earlier ones proposed.

use crate::Error;
use crate::joint_ranges::JointRanges;
use crate::primitives::model::PrimitiveModel;
use crate::primitives::motion::check_rate;
use crate::primitives::switching::{Branch, Choice, Switching};
use core::f64::consts::TAU;
use sinew_core::lanes::{Block, Isa, LANES};
use sinew_core::part::PartTree;
use sinew_core::random::BlockRng;
use sinew_core::transition::{Choices, LevelMotion, MotionModel};

/// Steps of the parts above a level, in units of B.
pub const TUNED: f64 = 0.2;

/// Which action primitives move a part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LevelPrimitives {
    /// A feature vector of the part with all that hangs on it, where there is one; for parts without a parent also of what hangs on it alone.
    #[default]
    Nested,
    /// A feature vector of the part's own coordinates.
    OwnParts,
}

/// A part at its level.
#[derive(Clone, Debug)]
struct Moved {
    /// Its number.
    part: usize,
    /// Its own coordinates.
    own: Vec<usize>,
    /// The coordinates of the feature vector that moves it, and its models.
    primitives: Option<(Vec<usize>, Switching)>,
}

/// The motion of one recording.
#[derive(Clone, Debug)]
pub struct LevelWalk {
    tree: PartTree,
    levels: Vec<Vec<Moved>>,
    /// The coordinates of all parts above each level.
    above: Vec<Vec<usize>>,
    sd: Vec<f64>,
    initial_sd: Vec<f64>,
    ranges: JointRanges,
    /// Coordinates that are angles.
    turning: Vec<bool>,
    /// The last D estimates, the oldest first; none without a model.
    past: Vec<f64>,
    /// Estimates taken in, up to D, at least to 1.
    seen: usize,
    isa: Isa,
}

fn check(name: &'static str, values: &[f64], dim: usize) -> Result<(), Error> {
    if values.len() != dim {
        return Err(Error::Shape { name, found: values.len(), expected: dim });
    }
    match values.iter().position(|v| !(*v > 0.0 && v.is_finite())) {
        Some(index) => {
            Err(Error::OutOfRange { name, index, value: values[index], expected: "must be positive and finite" })
        }
        None => Ok(()),
    }
}

impl LevelWalk {
    /// A random walk with standard deviations B of a step, and others of the first frame about its start, one each a coordinate of `tree`.
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`] unless all are positive and finite.
    pub fn new(tree: PartTree, sd: Vec<f64>, initial_sd: Vec<f64>, isa: Isa) -> Result<Self, Error> {
        let by_depth = tree.levels();
        let all: Vec<usize> = (0..tree.parents().len()).collect();
        let dim = tree.coordinates(&all).len();
        check("standard deviation", &sd, dim)?;
        check("initial sd", &initial_sd, dim)?;
        let moved = |&part: &usize| Moved { part, own: tree.coordinates(&[part]), primitives: None };
        let levels = by_depth.iter().map(|parts| parts.iter().map(moved).collect()).collect();
        let above = (0..by_depth.len()).map(|level| tree.coordinates(&by_depth[..level].concat())).collect();
        let (ranges, turning) = (JointRanges::none(dim), vec![false; dim]);
        Ok(Self { tree, levels, above, sd, initial_sd, ranges, turning, past: vec![], seen: 0, isa })
    }

    /// The same with nominal ranges of its joints.
    ///
    /// # Errors
    /// [`Error::Shape`].
    pub fn with_ranges(self, ranges: JointRanges) -> Result<Self, Error> {
        match ranges.dim() == self.dim() {
            true => Ok(Self { ranges, ..self }),
            false => Err(Error::Shape { name: "joint ranges", found: ranges.dim(), expected: self.dim() }),
        }
    }

    /// The same where the coordinates from `first` on are angles.
    #[must_use]
    pub fn with_angles_from(mut self, first: usize) -> Self {
        self.turning.iter_mut().enumerate().for_each(|(j, turns)| *turns = j >= first);
        self
    }

    /// The same by action primitives, for frames `dt` seconds apart, with the model's own random walk.
    ///
    /// # Errors
    /// [`Error::Shape`] for a model of another state, [`Error::OutOfRange`] where `dt` is more than 1 % off the frame time of the training motion, and as [`Switching::new`].
    pub fn with_primitives(mut self, model: &PrimitiveModel, dt: f64, which: LevelPrimitives) -> Result<Self, Error> {
        check_rate(model, dt)?;
        if model.dim != self.dim() {
            return Err(Error::Shape { name: "motion model's state", found: model.dim, expected: self.dim() });
        }
        check("noise", &model.noise_sd, model.dim)?;
        for (level, parts) in self.tree.levels().into_iter().enumerate() {
            for (moved, part) in self.levels[level].iter_mut().zip(parts) {
                let below = self.tree.coordinates(&self.tree.descendants(part));
                let whole = [&moved.own[..], &below].concat();
                let candidates = match which {
                    LevelPrimitives::Nested if level == 0 => vec![&whole, &below, &moved.own],
                    LevelPrimitives::Nested => vec![&whole, &moved.own],
                    LevelPrimitives::OwnParts => vec![&moved.own],
                };
                let found = candidates.into_iter().find_map(|candidate| switching(model, candidate, self.isa));
                moved.primitives = found.transpose()?;
            }
        }
        self.sd.clone_from(&model.noise_sd);
        self.past = vec![0.0; model.length * model.dim];
        Ok(self)
    }

    fn is_matching(&self) -> bool {
        !self.past.is_empty() && self.seen == self.past.len() / self.dim()
    }

    /// The values of some coordinates in the D − 1 estimates before the last.
    fn older(&self, coordinates: &[usize]) -> Vec<f64> {
        let d = self.dim();
        let estimates = self.past[..self.past.len() - d].chunks_exact(d);
        estimates.flat_map(|estimate| coordinates.iter().map(|&j| estimate[j])).collect()
    }

    /// Adds `share` · B e to some coordinates.
    fn step(&self, coordinates: &[usize], share: f64, next: &mut [Block], rng: &mut BlockRng) {
        let sd = if self.seen == 0 { &self.initial_sd } else { &self.sd };
        let mut noise = vec![Block::ZERO; coordinates.len()];
        rng.fill_normal(self.isa, &mut noise);
        for (&j, noise) in coordinates.iter().zip(&noise) {
            next[j].0.iter_mut().zip(noise.0).for_each(|(x, z)| *x += share * sd[j] * z);
        }
    }

    /// Moves a part, and says how.
    fn move_part(&self, moved: &Moved, before: &[Block], next: &mut [Block], rng: &mut BlockRng) -> Choices {
        self.step(&moved.own, 1.0, next, rng);
        let Some((coordinates, switching)) = moved.primitives.as_ref().filter(|_| self.is_matching()) else {
            return [0; LANES];
        };
        let own: Vec<Block> = coordinates.iter().map(|&j| before[j]).collect();
        let mut drawn = vec![Block::ZERO; own.len()];
        let choices = switching.sample_block(&self.older(coordinates), &own, &mut drawn, rng);
        for (lane, _) in choices.iter().enumerate().filter(|(_, choice)| choice.branch != Branch::Walk) {
            coordinates.iter().zip(&drawn).for_each(|(&j, drawn)| next[j].0[lane] = drawn.0[lane]);
        }
        choices.map(Choice::number)
    }
}

/// The models of the feature vector that has exactly these coordinates, in its own order; `None` if there is none.
fn switching(
    model: &PrimitiveModel,
    coordinates: &[usize],
    isa: Isa,
) -> Option<Result<(Vec<usize>, Switching), Error>> {
    let is_same = |own: &[usize]| own.len() == coordinates.len() && own.iter().all(|j| coordinates.contains(j));
    let primitives = model.primitives.iter().find(|p| !coordinates.is_empty() && is_same(&p.feature.coordinates))?;
    let own = primitives.feature.coordinates.clone();
    let sd: Vec<f64> = own.iter().map(|&j| model.noise_sd[j]).collect();
    let switching = Switching::new(primitives, &sd, isa).and_then(|switching| {
        let (found, expected) = (switching.matcher().older_len(), (model.length - 1) * own.len());
        match found == expected {
            true => Ok((own, switching)),
            false => Err(Error::Shape { name: "older feature vectors", found, expected }),
        }
    });
    Some(switching)
}

impl MotionModel for LevelWalk {
    fn dim(&self) -> usize {
        self.sd.len()
    }

    fn follow(&mut self, _before: Option<&[f64]>, estimate: &[f64]) {
        let d = self.dim();
        if !self.past.is_empty() {
            self.past.rotate_left(d);
            let newest = self.past.len() - d;
            self.past[newest..].copy_from_slice(estimate);
        }
        self.seen = (self.seen + 1).min((self.past.len() / d).max(1));
    }

    fn memory(&self) -> Vec<f64> {
        [&self.past[..], &[self.seen as f64]].concat()
    }

    fn recall(&mut self, memory: &[f64]) {
        if let Some((&seen, past)) = memory.split_last() {
            self.past.copy_from_slice(past);
            self.seen = (seen as usize).min((self.past.len() / self.dim()).max(1));
        }
    }
}

impl LevelMotion for LevelWalk {
    /// The choices are [`Choice::number`].
    fn sample_level_block(
        &self,
        level: usize,
        before: &[Block],
        next: &mut [Block],
        choices: &mut [Choices],
        rng: &mut BlockRng,
    ) {
        for moved in &self.levels[level] {
            choices[moved.part] = self.move_part(moved, before, next, rng);
        }
        self.step(&self.above[level], TUNED, next, rng);
    }

    fn step_sd(&self) -> &[f64] {
        &self.sd
    }

    fn change(&self, coordinate: usize, from: f64, to: f64) -> f64 {
        let change = to - from;
        if self.turning[coordinate] { change - TAU * (change / TAU).round() } else { change }
    }

    fn log_plausibility_block(&self, coordinates: &[usize], x: &[Block]) -> Block {
        self.ranges.log_plausibility_block(coordinates, x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::primitives::made_up::model;
    use sinew_core::part::{Part, Partition};
    use sinew_core::random::Stage;

    const BLOCKS: u32 = 2000;

    fn tree(parts: &[&[usize]], parents: &[Option<usize>]) -> PartTree {
        let dim = parts.iter().map(|part| part.len()).sum();
        let parts = parts.iter().map(|part| Part::new(part.to_vec(), dim).expect("valid")).collect();
        PartTree::new(Partition::new(parts, dim).expect("covers"), parents.to_vec()).expect("parents first")
    }

    /// A root with a limb that swings, as the made-up motion does.
    fn swinging() -> PartTree {
        tree(&[&[0, 2], &[1, 3]], &[None, Some(0)])
    }

    fn walk(tree: PartTree) -> LevelWalk {
        let d = tree.coordinates(&(0..tree.parents().len()).collect::<Vec<_>>()).len();
        let sd: Vec<f64> = (0..d).map(|j| 0.1 * (j + 1) as f64).collect();
        let initial = sd.iter().map(|sd| 3.0 * sd).collect();
        LevelWalk::new(tree, sd, initial, Isa::best()).expect("valid")
    }

    fn with_model(which: LevelPrimitives) -> LevelWalk {
        let model = model();
        let mut walk = walk(swinging()).with_primitives(&model, 0.05, which).expect("its state");
        for t in 0..model.length {
            walk.follow(None, &[0.1 * t as f64, 0.3, -0.2, 0.5]);
        }
        walk
    }

    const AT: [f64; 4] = [0.2, 0.4, -0.3, 0.45];

    /// What one level makes of states that stood at [`AT`], minus that.
    fn changes(walk: &LevelWalk, level: usize, d: usize) -> Vec<Vec<f64>> {
        let before: Vec<Block> = (0..d).map(|j| Block::splat(AT[j % 4])).collect();
        let mut out = vec![vec![]; d];
        for block in 0..BLOCKS {
            let (mut next, mut choices) = (before.clone(), vec![[0; LANES]; walk.tree.parents().len()]);
            let rng = &mut Stage::new(1, "level").block(block);
            walk.sample_level_block(level, &before, &mut next, &mut choices, rng);
            for (out, (next, before)) in out.iter_mut().zip(next.iter().zip(&before)) {
                out.extend((0..LANES).map(|lane| next.0[lane] - before.0[lane]));
            }
        }
        out
    }

    fn sd(values: &[f64]) -> f64 {
        (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
    }

    /// Update of a level (A10): a level moves its own parts by B and those above it by 0.2 B, and nothing else; 16 000 draws, 5 standard errors.
    #[test]
    fn a_level_moves_its_parts_and_tunes_those_above() {
        let mut walk = walk(tree(&[&[0], &[1, 4], &[2], &[3]], &[None, Some(0), Some(0), Some(1)]));
        for started in [false, true] {
            let scale = if started { 1.0 } else { 3.0 };
            for (level, shares) in [[1.0, 0.0, 0.0, 0.0, 0.0], [0.2, 1.0, 1.0, 0.0, 1.0], [0.2, 0.2, 0.2, 1.0, 0.2]]
                .into_iter()
                .enumerate()
            {
                for (j, (changes, share)) in changes(&walk, level, 5).iter().zip(shares).enumerate() {
                    let expected = scale * share * 0.1 * (j + 1) as f64;
                    let error = (sd(changes) - expected).abs();
                    assert!(error <= 5.0 * expected / 32_000_f64.sqrt(), "level {level}, coordinate {j}");
                }
            }
            walk.follow(None, &[0.0; 5]);
        }
        // A part of the level that is tuned as well would move by 2 % more, less than the draws are sure to show.
        assert_eq!(walk.above, [vec![], vec![0], vec![0, 1, 4, 2]]);
    }

    fn parts_with_primitives(walk: &LevelWalk) -> usize {
        walk.levels.iter().flatten().filter(|moved| moved.primitives.is_some()).count()
    }

    /// A third of the states stay under (8) where the whole body is proposed, and none where the part's own turn has come.
    #[test]
    fn action_primitives_move_two_states_of_three() {
        let walk = with_model(LevelPrimitives::Nested);
        assert_eq!(parts_with_primitives(&walk), 2);
        let (proposed, own) = (changes(&walk, 0, 4), changes(&walk, 1, 4));
        for j in [1, 3] {
            let stayed = proposed[j].iter().filter(|change| **change == 0.0).count() as f64 / 16_000.0;
            let z = (stayed - 1.0 / 3.0) / (2.0 / 9.0 / 16_000.0_f64).sqrt();
            assert!(z.abs() < 4.0, "coordinate {j}: {stayed}, z = {z}, bound 4, seed 1");
            assert!(own[j].iter().all(|change| *change != 0.0));
        }
        let root = with_model(LevelPrimitives::OwnParts);
        assert_eq!(parts_with_primitives(&root), 1);
        let left_out = changes(&root, 0, 4);
        assert!([1, 3].iter().all(|&j| left_out[j].iter().all(|change| *change == 0.0)));
        // The root walks by the model's B in any case.
        for j in [0, 2] {
            let expected = model().noise_sd[j];
            assert!((sd(&proposed[j]) - expected).abs() < 5.0 * expected / 32_000_f64.sqrt());
        }
    }

    /// The states that models (6) and (7) move lie where the cluster says: their mean is that of both.
    #[test]
    fn proposals_are_drawn_from_the_switching_models() {
        let walk = with_model(LevelPrimitives::Nested);
        let (coordinates, switching) = walk.levels[0][0].primitives.as_ref().expect("it has some");
        assert_eq!(coordinates, &[3, 1]);
        let own: Vec<f64> = coordinates.iter().map(|&j| AT[j]).collect();
        let [next, step] = switching.expected(&walk.older(coordinates), &own);
        let proposed = changes(&walk, 0, 4);
        for (k, &j) in coordinates.iter().enumerate() {
            let moved: Vec<f64> = proposed[j].iter().copied().filter(|change| *change != 0.0).collect();
            let mean = moved.iter().sum::<f64>() / moved.len() as f64;
            let expected = 0.5 * (next[k] + step[k]) - AT[j];
            let error = sd(&moved.iter().map(|x| x - mean).collect::<Vec<_>>()) / (moved.len() as f64).sqrt();
            assert!((mean - expected).abs() < 4.5 * error, "{mean} for {expected}, standard error {error}, seed 1");
        }
    }

    /// Models (6) and (7) start from the frame before, wherever the levels above have put the part; with 2000 draws none of them is near there.
    #[test]
    fn proposals_start_from_the_frame_before() {
        let walk = with_model(LevelPrimitives::Nested);
        let before: Vec<Block> = AT.map(Block::splat).to_vec();
        let mut moved = 0;
        for block in 0..BLOCKS / LANES as u32 {
            let mut next: Vec<Block> = AT.map(|x| Block::splat(x + 100.0)).to_vec();
            let mut choices = vec![[0; LANES]; 2];
            walk.sample_level_block(1, &before, &mut next, &mut choices, &mut Stage::new(1, "moved").block(block));
            for (lane, number) in choices[1].into_iter().enumerate() {
                let is_proposed = Choice::from_number(number).1 != Branch::Walk;
                assert!([1, 3].iter().all(|&j| (next[j].0[lane] < 50.0) == is_proposed));
                moved += usize::from(is_proposed);
            }
        }
        assert!(moved > 1000, "{moved} of 2000");
    }

    /// The action primitive of a state: the D − 1 estimates before the last, the oldest first, in the order of the feature vector.
    #[test]
    fn older_estimates_end_before_the_last() {
        let mut walk = with_model(LevelPrimitives::Nested);
        let estimates: Vec<Vec<f64>> = (0..5).map(|t| (0..4).map(|j| f64::from(10 * t + j)).collect()).collect();
        estimates.iter().for_each(|estimate| walk.follow(None, estimate));
        assert_eq!((model().length, walk.older(&[3, 1])), (3, vec![23.0, 21.0, 33.0, 31.0]));
    }

    /// Of the part's own primitives a third each by models (6), (7) and (8), of the cluster that its values before match; |z| < 4 with 16 000 states.
    #[test]
    fn choices_say_which_cluster_and_model_moved_a_part() {
        let walk = with_model(LevelPrimitives::Nested);
        let (coordinates, switching) = walk.levels[0][0].primitives.as_ref().expect("it has some");
        let own: Vec<Block> = coordinates.iter().map(|&j| Block::splat(AT[j])).collect();
        let nearest = switching.matcher().nearest_block(&walk.older(coordinates), &own)[0];
        let before: Vec<Block> = AT.map(Block::splat).to_vec();
        let mut counts = [0.0; 3];
        for block in 0..BLOCKS {
            let (mut next, mut choices) = (before.clone(), vec![[0; LANES]; 2]);
            walk.sample_level_block(0, &before, &mut next, &mut choices, &mut Stage::new(1, "choices").block(block));
            assert_eq!(choices[1], [0; LANES], "its level has not come");
            for (lane, number) in choices[0].into_iter().enumerate() {
                let (cluster, branch) = Choice::from_number(number);
                let stayed = next[1].0[lane] == AT[1];
                assert_eq!((cluster, stayed), (Some(nearest), branch == Branch::Walk));
                counts[branch as usize] += 1.0;
            }
        }
        for count in counts {
            let z = (count - 16_000.0 / 3.0) / (16_000.0_f64 * 2.0 / 9.0).sqrt();
            assert!(z.abs() < 4.0, "{counts:?}, z = {z}, bound 4, seed 1");
        }
    }

    #[test]
    fn too_few_estimates_walk_at_random() {
        let mut walk = walk(swinging()).with_primitives(&model(), 0.05, LevelPrimitives::Nested).expect("its state");
        for _ in 1..model().length {
            walk.follow(None, &AT);
            assert!(!walk.is_matching() && changes(&walk, 0, 4)[1].iter().all(|change| *change == 0.0));
        }
        walk.follow(None, &AT);
        assert!(walk.is_matching());
    }

    /// Law `memory_resumes`.
    #[test]
    fn a_memory_resumes() {
        let walk = with_model(LevelPrimitives::Nested);
        let mut other = with_model(LevelPrimitives::Nested);
        other.follow(None, &AT);
        assert!(other.memory() != walk.memory() && other.memory().len() == walk.memory().len());
        other.recall(&walk.memory());
        assert_eq!(changes(&walk, 0, 4), changes(&other, 0, 4));
        assert_eq!(other.memory(), walk.memory());
    }

    #[test]
    fn misfits_are_refused() {
        let bare = || walk(swinging());
        assert!(bare().with_primitives(&model(), 0.06, LevelPrimitives::Nested).is_err());
        let other = PrimitiveModel { dim: 5, ..model() };
        assert!(bare().with_primitives(&other, 0.05, LevelPrimitives::Nested).is_err());
        assert!(bare().with_ranges(JointRanges::none(3)).is_err());
        assert!(LevelWalk::new(swinging(), vec![0.1; 4], vec![0.0; 4], Isa::best()).is_err());
        let around = bare().with_angles_from(1);
        assert!((around.change(1, 3.0, -3.0) - (TAU - 6.0)).abs() < 1e-12 && around.change(0, 3.0, -3.0) == -6.0);
    }
}
