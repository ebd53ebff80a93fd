//! How implausible angles outside the nominal ranges of their joints are.
//!
//! log ψ(p) = −(1/τ) Σ_j e_j, with e_j the distance of coordinate j outside its range, radians. Husz, Wallace & Green (2007) let ψ decay exponentially and print no more; τ = 0.1 rad is our choice.
//!
//! A penalty of a search, not a prior with a normalisation: ψ is 1 inside of all ranges.

use crate::Error;
use sinew_core::lanes::Block;

/// τ, radians.
pub const TAU_RAD: f64 = 0.1;

/// Nominal ranges of the coordinates of a state.
#[derive(Clone, Debug, PartialEq)]
pub struct JointRanges(Vec<Option<[f64; 2]>>);

impl JointRanges {
    /// Ranges by coordinate, radians; `None` for coordinates without.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a lower end that is not below the upper one.
    pub fn new(ranges: Vec<Option<[f64; 2]>>) -> Result<Self, Error> {
        let is_bad =
            |range: &Option<[f64; 2]>| range.is_some_and(|[low, high]| low.is_nan() || high.is_nan() || low >= high);
        match ranges.iter().position(is_bad) {
            Some(index) => {
                let value = ranges[index].map_or(f64::NAN, |[low, _]| low);
                let expected = "must be below the upper end of its range";
                Err(Error::OutOfRange { name: "joint range", index, value, expected })
            }
            None => Ok(Self(ranges)),
        }
    }

    /// Coordinates without ranges.
    #[must_use]
    pub fn none(dim: usize) -> Self {
        Self(vec![None; dim])
    }

    /// Number of coordinates.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.0.len()
    }

    /// Ranges by coordinate, radians.
    #[must_use]
    pub fn all(&self) -> &[Option<[f64; 2]>] {
        &self.0
    }

    /// log ψ of some coordinates of eight states, d blocks.
    #[must_use]
    pub fn log_plausibility_block(&self, coordinates: &[usize], x: &[Block]) -> Block {
        let mut out = Block::ZERO;
        for &j in coordinates {
            let Some([low, high]) = self.0[j] else { continue };
            for (out, x) in out.0.iter_mut().zip(x[j].0) {
                *out -= (low - x).max(x - high).max(0.0) / TAU_RAD;
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_decay_outside_their_ranges() {
        let ranges = JointRanges::new(vec![None, Some([-0.5, 1.0]), Some([0.0, 2.0])]).expect("valid");
        let x = [9.0, -0.7, 2.3].map(Block::splat);
        let log = |coordinates: &[usize]| ranges.log_plausibility_block(coordinates, &x).0[5];
        assert!((log(&[1]) + 2.0).abs() < 1e-12 && (log(&[2]) + 3.0).abs() < 1e-12);
        assert!((log(&[0, 1, 2]) + 5.0).abs() < 1e-12 && log(&[0]) == 0.0);
        let inside = [9.0, 1.0, 0.0].map(Block::splat);
        assert_eq!(ranges.log_plausibility_block(&[0, 1, 2], &inside), Block::ZERO);
    }

    /// The product of exp(−e/τ) over the built-in body's angles, by its definition.
    #[test]
    fn it_is_the_product_over_joints() {
        let table: Vec<Option<[f64; 2]>> = (0..24).map(|j| (j > 3).then(|| [-0.1 * j as f64, 0.3])).collect();
        let ranges = JointRanges::new(table.clone()).expect("valid");
        let x: Vec<Block> = (0..24)
            .map(|j| Block(core::array::from_fn(|lane| (1.7 * j as f64 + 0.9 * lane as f64).sin() * 3.0)))
            .collect();
        let all: Vec<usize> = (0..24).collect();
        let found = ranges.log_plausibility_block(&all, &x);
        for lane in 0..8 {
            let factor = |(range, x): (&Option<[f64; 2]>, &Block)| match range {
                Some([low, _]) if x.0[lane] < *low => (-(low - x.0[lane]) / 0.1).exp(),
                Some([_, high]) if x.0[lane] > *high => (-(x.0[lane] - high) / 0.1).exp(),
                _ => 1.0,
            };
            let log: f64 = table.iter().zip(&x).map(|pair| factor(pair).ln()).sum();
            assert!((found.0[lane] - log).abs() < 1e-9 * log.abs().max(1.0), "{} for {log}", found.0[lane]);
        }
    }

    #[test]
    fn ranges_are_checked() {
        for range in [[1.0, 1.0], [2.0, 1.0], [f64::NAN, 1.0]] {
            assert!(JointRanges::new(vec![None, Some(range)]).is_err());
        }
        assert_eq!(JointRanges::none(4).dim(), 4);
    }
}
