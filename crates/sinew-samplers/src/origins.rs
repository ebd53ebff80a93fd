//! What goes with a part of some states: its values before, and how the motion moved it.
//!
//! Kept beside the states while a frame moves and resamples them part by part ([`crate::levels`]); no part of what a tracker remembers.

use crate::particles::Particles;
use sinew_core::lanes::LANES;
use sinew_core::transition::Choices;
use std::collections::BTreeMap;

/// The origins of all parts of some states.
#[derive(Clone, Debug)]
pub struct PartOrigins {
    pub(crate) before: Particles,
    pub(crate) choices: Vec<Choices>,
    pub(crate) parts: usize,
}

impl PartOrigins {
    /// The states `before` of a frame that has not begun, of one part at least.
    #[must_use]
    pub fn new(before: Particles, parts: usize) -> Self {
        let choices = vec![[0; LANES]; parts * before.states.len() / before.dim()];
        Self { before, choices, parts }
    }

    /// Of each part the choices of its motion that states have, in ascending order, with the share of the states that each has.
    #[must_use]
    pub fn shares(&self) -> Vec<Vec<(u32, f64)>> {
        let count = self.before.count();
        let counted = |part: usize| {
            let mut found: BTreeMap<u32, usize> = BTreeMap::new();
            let numbers = self.choices.iter().skip(part).step_by(self.parts).flatten().take(count);
            numbers.for_each(|number| *found.entry(*number).or_default() += 1);
            found.into_iter().map(|(number, states)| (number, states as f64 / count as f64)).collect()
        };
        (0..self.parts).map(counted).collect()
    }

    /// Gives each state what goes with some parts of its ancestor, which have these coordinates.
    pub(crate) fn take(&mut self, parts: &[usize], coordinates: &[usize], ancestors: &[usize]) {
        let d = self.before.dim();
        coordinates.iter().for_each(|&j| take_row(&mut self.before.states, d, j, ancestors, |block| &mut block.0));
        parts.iter().for_each(|&part| take_row(&mut self.choices, self.parts, part, ancestors, |block| block));
    }
}

/// Gives each state one of its ancestor's rows, of `rows` that each block of eight states has.
pub(crate) fn take_row<B, T: Copy>(
    blocks: &mut [B],
    rows: usize,
    row: usize,
    ancestors: &[usize],
    lanes: impl Fn(&mut B) -> &mut [T; LANES],
) {
    let column: Vec<T> = blocks.iter_mut().skip(row).step_by(rows).flat_map(|block| *lanes(block)).collect();
    for (slot, &ancestor) in ancestors.iter().enumerate().filter(|(slot, ancestor)| slot != *ancestor) {
        lanes(&mut blocks[slot / LANES * rows + row])[slot % LANES] = column[ancestor];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eleven states of two parts: the choices of a part go with its ancestors, the other keeps its own, and lanes beyond the last state do not count.
    #[test]
    fn choices_go_with_their_part_and_are_counted() {
        let before = Particles::new(&[0.0, 1.0, 2.0], 11).expect("not empty");
        let mut origins = PartOrigins::new(before, 2);
        assert_eq!(origins.shares(), [[(0, 1.0)], [(0, 1.0)]]);
        for slot in 0..16 {
            origins.choices[slot / LANES * 2][slot % LANES] = slot as u32 % 2;
            origins.choices[slot / LANES * 2 + 1][slot % LANES] = 7 + slot as u32 / 8;
        }
        let shares = |of: [usize; 2], numbers: [u32; 2]| {
            [(numbers[0], of[0] as f64 / 11.0), (numbers[1], of[1] as f64 / 11.0)].to_vec()
        };
        assert_eq!(origins.shares(), [shares([6, 5], [0, 1]), shares([8, 3], [7, 8])]);
        let ancestors = [0, 1, 2, 3, 9, 10, 9, 10, 8, 9, 10];
        origins.take(&[1], &[2], &ancestors);
        assert_eq!(origins.shares(), [shares([6, 5], [0, 1]), shares([4, 7], [7, 8])]);
    }
}
