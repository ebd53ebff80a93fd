//! Which rows a latent model is learned from: its cost grows with their cube.
//!
//! 1. By rate: of each recording one phase, every frame at the rate of the model, though the recording may have more between them.
//! 2. By cutting: where all together are too many, each sequence keeps its middle, the same share of each.

use super::LearnError;
use super::sequences::Sequences;
use std::ops::Range;

/// The rows that were chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenRows {
    /// Coordinates from the first that is in the model on, row after row.
    pub rows: Vec<f64>,
    /// Rows of each sequence.
    pub lengths: Vec<usize>,
    /// Rows at the rate of the model before anything was cut.
    pub available: usize,
}

/// Rows that a sequence keeps at least: a step of the dynamics.
const LEAST: usize = 2;

/// One phase of each file: of `dim` coordinates those that are chosen.
#[must_use]
pub fn first_phases(sequences: &Sequences, dim: usize, chosen: &Range<usize>) -> Vec<Vec<f64>> {
    let mut states = sequences.states.iter();
    let mut firsts = Vec::new();
    for file in &sequences.files {
        let own = states.by_ref().take(file.sequences).collect::<Vec<_>>();
        firsts.extend(
            own.first().map(|rows| rows.chunks_exact(dim).flat_map(|row| &row[chosen.clone()]).copied().collect()),
        );
    }
    firsts
}

/// The middle of each sequence (rows of length `columns`), so that all together have at most `most` rows.
///
/// # Errors
/// [`LearnError::TooManySequences`] where not even two rows of each find room, [`LearnError::ShortSequence`] for a sequence of one row.
pub fn middles(sequences: &[Vec<f64>], columns: usize, most: usize) -> Result<ChosenRows, LearnError> {
    let available: usize = sequences.iter().map(|rows| rows.len() / columns).sum();
    let (mut rows, mut lengths) = (Vec::new(), Vec::new());
    for (index, sequence) in sequences.iter().enumerate() {
        let whole = sequence.len() / columns;
        if whole < LEAST {
            return Err(LearnError::ShortSequence { index, rows: whole });
        }
        let kept = if available > most { (whole * most / available).max(LEAST) } else { whole };
        let first = (whole - kept) / 2;
        rows.extend_from_slice(&sequence[first * columns..][..kept * columns]);
        lengths.push(kept);
    }
    if lengths.iter().sum::<usize>() > most {
        return Err(LearnError::TooManySequences { files: sequences.len(), most });
    }
    Ok(ChosenRows { rows, lengths, available })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sequence_keeps_the_same_share_of_its_middle() {
        let sequence = |first: f64, rows: usize| (0..rows).map(|n| first + n as f64).collect::<Vec<_>>();
        let sequences = [sequence(0.0, 10), sequence(100.0, 20), sequence(200.0, 3)];
        let all = middles(&sequences, 1, 33).unwrap();
        assert_eq!((all.rows, all.lengths, all.available), (sequences.concat(), vec![10, 20, 3], 33));
        let some = middles(&sequences, 1, 17).unwrap();
        assert_eq!(some.lengths, [5, 10, 2]);
        assert_eq!(some.rows[..6], [2.0, 3.0, 4.0, 5.0, 6.0, 105.0]);
        assert!(matches!(middles(&sequences, 1, 5), Err(LearnError::TooManySequences { files: 3, most: 5 })));
        assert!(matches!(middles(&[vec![1.0]], 1, 5), Err(LearnError::ShortSequence { index: 0, rows: 1 })));
    }
}
