//! A state's coordinates divided into a finite number of values, for the coarse level of a coarse-to-fine search.
//!
//! A coordinate between θ_L and θ_H with steps of δ has ⌈(θ_H − θ_L) / δ⌉ partitions of equal width; its values are their centres. A coordinate that wraps (a heading) has a range of one turn, whose ends are one
//! point; one that does not is held at its outermost centres.
//!
//! The step is learned from how much a coordinate changes between consecutive frames, at the frame rate that is tracked: δ = c √mean (θ(t+1) − θ(t))², at least 10⁻³ rad or m. What is printed is the variance; the units
//! ask for its root. It is taken about zero: the deviation about the mean of a walk straight ahead leaves out the walking. [`Width::MeanSquareLiteral`] keeps the printed unit for comparison.
//!
//! ```
//! use sinew_samplers::grid::GridAxis;
//! let axis = GridAxis::new(-1.0, 1.0, 0.3, false)?;
//! assert_eq!(axis.count(), 7);
//! assert!((axis.snap(0.1) - 0.0).abs() < 1e-15 && axis.snap(9.0) == axis.centre(6));
//! # Ok::<(), sinew_samplers::Error>(())
//! ```

use crate::Error;
use core::f64::consts::PI;

/// Least step, in radians or metres.
pub const LEAST_WIDTH: f64 = 1e-3;

/// The values of one coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridAxis {
    low: f64,
    high: f64,
    width: f64,
    wraps: bool,
}

impl GridAxis {
    /// Partitions of `width` at most between `low` and `high`, in radians or metres; if the coordinate `wraps`, both ends are the same point.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] unless low ≤ high, below it where the coordinate wraps, and width > 0, all finite.
    pub fn new(low: f64, high: f64, width: f64, wraps: bool) -> Result<Self, Error> {
        let range = |name, value, inside: bool, expected| {
            if inside { Ok(()) } else { Err(Error::OutOfRange { name, value, expected }) }
        };
        let is_range = (high - low).is_finite() && (low < high || low == high && !wraps);
        range("end of a range", high, is_range, "must be finite and not below its start")?;
        range("width of a partition", width, width > 0.0 && width.is_finite(), "must be positive and finite")?;
        Ok(Self { low, high, width, wraps })
    }

    /// Number of partitions.
    #[must_use]
    pub fn count(&self) -> usize {
        (((self.high - self.low) / self.width).ceil() as usize).max(1)
    }

    /// The requested step δ; a partition is this wide or less.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.width
    }

    /// Centre of a partition.
    #[must_use]
    pub fn centre(&self, partition: usize) -> f64 {
        self.low + (partition as f64 + 0.5) * (self.high - self.low) / self.count() as f64
    }

    /// Centre of the partition in which `x` lies; beyond the ends, where the coordinate does not wrap, the outermost.
    #[must_use]
    pub fn snap(&self, x: f64) -> f64 {
        let length = self.high - self.low;
        let inside = if self.wraps { (x - self.low).rem_euclid(length) } else { x - self.low };
        let count = self.count();
        let partition = (inside / length * count as f64) as usize;
        self.centre(partition.min(count - 1))
    }

    /// `to` − `from`, the short way round where the coordinate wraps.
    #[must_use]
    pub fn difference(&self, to: f64, from: f64) -> f64 {
        if !self.wraps {
            return to - from;
        }
        let turn = self.high - self.low;
        (to - from + 0.5 * turn).rem_euclid(turn) - 0.5 * turn
    }
}

/// How a step follows from the changes between consecutive frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Width {
    /// A number of root mean squares.
    RootMeanSquares(f64),
    /// The number of their mean square, as printed.
    MeanSquareLiteral,
}

impl Default for Width {
    fn default() -> Self {
        Self::RootMeanSquares(1.0)
    }
}

/// Learns the axes of a state from sequences of states at the tracked frame rate: ranges from their extremes, or a turn from −π where a coordinate `wraps`, and steps by `width`. Differences are never taken across
/// the end of a sequence.
///
/// # Errors
/// [`Error::Empty`] without two consecutive states, [`Error::OutOfRange`] for numbers that are not finite or states of another dimension than `wraps`.
pub fn train(sequences: &[Vec<Vec<f64>>], wraps: &[bool], width: Width) -> Result<Vec<GridAxis>, Error> {
    let dim = wraps.len();
    for state in sequences.iter().flatten() {
        if state.len() != dim {
            let expected = "must be the number of coordinates";
            return Err(Error::OutOfRange { name: "dimension of a state", value: state.len() as f64, expected });
        }
    }
    let pairs = || sequences.iter().flat_map(|sequence| sequence.windows(2));
    let count = pairs().count();
    if count == 0 || dim == 0 {
        return Err(Error::Empty { count, dim });
    }
    let axis = |(j, &wraps): (usize, &bool)| {
        let values = || sequences.iter().flatten().map(|state| state[j]);
        let [low, high] = if wraps {
            [-PI, PI]
        } else {
            [values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max)]
        };
        let range = GridAxis::new(low, high, LEAST_WIDTH, wraps)?;
        let squares = pairs().map(|pair| range.difference(pair[1][j], pair[0][j]).powi(2));
        let mean_square = squares.sum::<f64>() / count as f64;
        let learned = match width {
            Width::RootMeanSquares(factor) => factor * mean_square.sqrt(),
            Width::MeanSquareLiteral => mean_square,
        };
        if learned.is_nan() {
            return Err(Error::OutOfRange { name: "learned width", value: learned, expected: "must be a number" });
        }
        GridAxis::new(low, high, learned.max(LEAST_WIDTH), wraps)
    };
    wraps.iter().enumerate().map(axis).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Number of values of a grid axis (coarse to fine, first half of A12).
    #[test]
    fn there_are_as_many_values_as_steps_fit_in() {
        for (low, high, width) in [(-1.0, 1.0, 0.3), (0.0, 1.0, 0.25), (-0.2, 3.0, 7.0), (0.0, 1.0, 1e-3)] {
            for wraps in [false, true] {
                let axis = GridAxis::new(low, high, width, wraps).expect("valid");
                let count = f64::ceil((high - low) / width) as usize;
                assert_eq!(axis.count(), count);
                let step = (high - low) / count as f64;
                assert!(step <= width);
                for i in 0..count {
                    let centre = axis.centre(i);
                    assert!((centre - (low + (i as f64 + 0.5) * step)).abs() < 1e-12);
                    assert_eq!(axis.snap(centre), centre);
                    assert_eq!(axis.snap(centre + 0.49 * step), centre);
                    assert_eq!(axis.snap(centre - 0.49 * step), centre);
                }
            }
        }
    }

    #[test]
    fn ends_hold_or_meet() {
        let heading = GridAxis::new(-PI, PI, 0.5, true).expect("valid");
        assert_eq!(heading.snap(PI + 0.01), heading.centre(0));
        assert_eq!(heading.snap(-PI - 0.01), heading.centre(heading.count() - 1));
        assert_eq!(heading.snap(0.3 + 20.0 * PI), heading.snap(0.3));
        assert!((heading.difference(-3.0, 3.0) - (2.0 * PI - 6.0)).abs() < 1e-12);
        let height = GridAxis::new(0.0, 2.0, 0.5, false).expect("valid");
        assert_eq!((height.snap(7.0), height.snap(-7.0)), (1.75, 0.25));
        assert_eq!(height.difference(-3.0, 3.0), -6.0);
        let locked = GridAxis::new(0.4, 0.4, 0.1, false).expect("valid");
        assert_eq!((locked.count(), locked.snap(9.0)), (1, 0.4));
    }

    #[test]
    fn steps_are_learned_from_changes_within_sequences() {
        // Changes of the first coordinate: ±0.1 about a mean of 0; of the second, across the turn, ±0.2, three of four forwards.
        let walk = |x: [f64; 3], y: [f64; 3]| x.into_iter().zip(y).map(|(x, y)| vec![x, y, 5.0]).collect::<Vec<_>>();
        let sequences =
            vec![walk([0.0, 0.1, 0.0], [3.0, 3.2 - 2.0 * PI, 3.4 - 2.0 * PI]), walk([9.0, 9.1, 9.0], [0.0, 0.2, 0.0])];
        let axes = train(&sequences, &[false, true, false], Width::RootMeanSquares(2.0)).expect("valid");
        assert!((axes[0].width() - 0.2).abs() < 1e-12 && (axes[0].low, axes[0].high) == (0.0, 9.1));
        assert!((axes[1].width() - 2.0 * 0.04_f64.sqrt()).abs() < 1e-12 && axes[1].high == PI);
        assert_eq!((axes[2].width(), axes[2].count()), (LEAST_WIDTH, 1));
        let literal = train(&sequences, &[false, true, false], Width::MeanSquareLiteral).expect("valid");
        assert!((literal[0].width() - 0.01).abs() < 1e-12);
    }

    #[test]
    fn what_is_no_grid_is_refused() {
        for (low, high, width) in [(1.0, 0.0, 0.1), (0.0, f64::NAN, 0.1), (0.0, 1.0, 0.0), (0.0, f64::INFINITY, 1.0)] {
            assert!(GridAxis::new(low, high, width, false).is_err());
        }
        assert!(GridAxis::new(0.0, 0.0, 0.1, true).is_err() && GridAxis::new(0.0, 1.0, f64::NAN, false).is_err());
        assert!(matches!(
            train(&[vec![vec![0.0]]], &[false], Width::default()),
            Err(Error::Empty { count: 0, dim: 1 })
        ));
        assert!(train(&[vec![vec![0.0], vec![f64::NAN]]], &[true], Width::default()).is_err());
        assert!(train(&[vec![vec![0.0], vec![]]], &[true], Width::default()).is_err());
    }
}
