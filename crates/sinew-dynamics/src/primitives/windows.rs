//! Windows of consecutive feature vectors, and recordings at a lower rate in all phases.
//!
//! An action primitive is D consecutive feature vectors, b_n, …, b_(n+D−1); with the next one, b_(n+D), they are a window (Husz, Wallace & Green 2007). A window lies within one sequence.
//! A sequence is rows of one length, one after the other, a row a frame.

use crate::Error;
use crate::pca::count_rows;

/// Windows of one feature vector in some sequences.
#[derive(Clone, Debug, PartialEq)]
pub struct Windows {
    /// Numbers in a window: (D + 1) F.
    pub dim: usize,
    /// The windows, one after the other, the oldest feature vector of each first.
    pub rows: Vec<f64>,
    /// Number of windows that each sequence has.
    pub counts: Vec<usize>,
}

impl Windows {
    /// Number of windows.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len() / self.dim
    }

    /// Whether no sequence is long enough for one.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

/// Every `factor`-th row of length `dim`, once from each of the first `factor` rows: a recording of 120 frames a second has six such sequences of 20.
///
/// # Errors
/// [`Error::Shape`] or [`Error::OutOfRange`] for rows that are none, or a factor of 0.
pub fn subsampled(rows: &[f64], dim: usize, factor: usize) -> Result<Vec<Vec<f64>>, Error> {
    let count = count_rows("sequence", rows, dim)?;
    if factor == 0 {
        return Err(Error::Shape { name: "subsampling", found: 0, expected: 1 });
    }
    let phase = |first: usize| rows.chunks_exact(dim).skip(first).step_by(factor).flatten().copied().collect();
    Ok((0..factor.min(count)).map(phase).collect())
}

/// Every D + 1 consecutive values of the `coordinates` of rows of length `dim`, sequence by sequence.
///
/// # Errors
/// [`Error::Shape`] or [`Error::OutOfRange`] for rows that are none and coordinates beyond them.
pub fn windows(sequences: &[Vec<f64>], dim: usize, coordinates: &[usize], older: usize) -> Result<Windows, Error> {
    if let Some(&beyond) = coordinates.iter().find(|&&j| j >= dim) {
        return Err(Error::Shape { name: "row of a sequence", found: dim, expected: beyond + 1 });
    }
    let (mut rows, mut counts) = (Vec::new(), Vec::new());
    for sequence in sequences {
        let count = count_rows("sequence", sequence, dim)?.saturating_sub(older);
        for first in 0..count {
            let frames = sequence[first * dim..][..(older + 1) * dim].chunks_exact(dim);
            rows.extend(frames.flat_map(|row| coordinates.iter().map(|&j| row[j])));
        }
        counts.push(count);
    }
    Ok(Windows { dim: (older + 1) * coordinates.len(), rows, counts })
}

/// Standard deviations of a step: `factor` times the root mean square of the difference of consecutive rows of length `dim`, about zero, and at least `floor`.
///
/// About zero, since the deviation about the mean of a walk straight ahead leaves out the walking.
///
/// # Errors
/// [`Error::Shape`] or [`Error::OutOfRange`] for rows that are none, or fewer than two in each sequence.
pub fn step_sd(sequences: &[Vec<f64>], dim: usize, factor: f64, floor: f64) -> Result<Vec<f64>, Error> {
    let (mut squares, mut count) = (vec![0.0; dim], 0);
    for sequence in sequences {
        count += count_rows("sequence", sequence, dim)? - 1;
        for (i, x) in sequence.iter().enumerate().skip(dim) {
            squares[i % dim] += (x - sequence[i - dim]).powi(2);
        }
    }
    if count == 0 {
        return Err(Error::Shape { name: "steps of all sequences", found: 0, expected: 1 });
    }
    Ok(squares.iter().map(|square| (factor * (square / count as f64).sqrt()).max(floor)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_stay_within_their_sequence() {
        let sequences: Vec<Vec<f64>> = [0.0, 100.0, 200.0]
            .iter()
            .zip([4, 2, 3])
            .map(|(from, n)| (0..n * 2).map(|i| from + i as f64).collect())
            .collect();
        let found = windows(&sequences, 2, &[1], 2).expect("valid");
        assert_eq!((found.dim, found.len(), &found.counts[..]), (3, 3, &[2, 0, 1][..]));
        assert_eq!(found.rows, [1.0, 3.0, 5.0, 3.0, 5.0, 7.0, 201.0, 203.0, 205.0]);
        let turned = windows(&sequences, 2, &[1, 0], 3).expect("valid");
        assert_eq!(turned.rows, [1.0, 0.0, 3.0, 2.0, 5.0, 4.0, 7.0, 6.0]);
        assert!(windows(&sequences, 2, &[0], 4).expect("valid").is_empty());
    }

    #[test]
    fn every_row_is_in_one_phase() {
        let rows: Vec<f64> = (0..14).map(f64::from).collect();
        let phases = subsampled(&rows, 2, 3).expect("valid");
        assert_eq!(phases[0], [0.0, 1.0, 6.0, 7.0, 12.0, 13.0]);
        assert_eq!(phases[1..], [vec![2.0, 3.0, 8.0, 9.0], vec![4.0, 5.0, 10.0, 11.0]]);
        assert_eq!(subsampled(&rows, 2, 1).expect("valid"), vec![rows.clone()]);
        assert_eq!(subsampled(&rows, 2, 100).expect("valid").len(), 7);
    }

    /// Steps 1, 1 and 4 have mean square 6; about their mean it is 2.
    #[test]
    fn steps_are_measured_about_zero_and_never_across_sequences() {
        let sequences = [vec![0.0, 7.0, 1.0, 7.0, 2.0, 7.0], vec![90.0, 7.0, 94.0, 7.0]];
        let sd = step_sd(&sequences, 2, 1.5, 1e-3).expect("valid");
        assert!((sd[0] - 1.5 * 6.0_f64.sqrt()).abs() < 1e-14, "{sd:?}");
        assert_eq!(sd[1], 1e-3);
        assert!(step_sd(&[vec![1.0, 2.0]], 2, 1.5, 1e-3).is_err());
    }

    #[test]
    fn rows_that_are_none_are_refused() {
        let sequences = [vec![0.0; 6]];
        assert!(windows(&sequences, 4, &[0], 1).is_err() && windows(&sequences, 2, &[2], 1).is_err());
        assert!(subsampled(&[0.0; 6], 4, 1).is_err() && subsampled(&[0.0; 6], 2, 0).is_err());
        assert!(windows(&[vec![f64::NAN; 6]], 2, &[0], 1).is_err() && windows(&[vec![]], 2, &[0], 1).is_err());
    }
}
