//! How angles change along trajectories: between the ends of a window around a frame.

use crate::marginals::{AngleChange, LaterFrame};
use sinew_dynamics::backward_pass::{FrameNumbers, TRAJECTORIES, state_blocks};
use sinew_tracking::moved::Rows;
use std::ops::Range;

/// The first and the last frame of a window of some frames on both sides of a frame, cut where tracking restarted and at the ends of `frames`.
///
/// # Errors
/// Errors of `is_restarted`.
pub fn window_around<E>(
    frame: u64,
    half: u64,
    frames: &Range<u64>,
    mut is_restarted: impl FnMut(u64) -> Result<bool, E>,
) -> Result<[u64; 2], E> {
    let [mut first, mut last] = [frame; 2];
    while first > frames.start && frame - first < half && !is_restarted(first)? {
        first -= 1;
    }
    while last + 1 < frames.end && last - frame < half && !is_restarted(last + 1)? {
        last += 1;
    }
    Ok([first, last])
}

/// How angles change between two frames of a pass that are `seconds` apart.
#[must_use]
pub fn change_between(numbers: [&FrameNumbers; 2], dim: usize, lasting_draws: usize, seconds: f64) -> AngleChange {
    let [earlier, later] = numbers.map(|numbers| {
        let (numbers, moves) = numbers.split_at((1 + TRAJECTORIES) * dim);
        let mut states = numbers[dim..].to_vec();
        if lasting_draws > 0 {
            Rows::new(moves, lasting_draws).add_columns(&mut states);
        }
        state_blocks(&states, dim)
    });
    AngleChange { earlier, later: LaterFrame::States(later), seconds }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_ends_where_tracking_restarted() {
        let window = |frame| window_around(frame, 2, &(0..10), |frame| Ok::<_, ()>(frame == 5)).unwrap();
        assert_eq!([0, 3, 4, 5, 6, 9].map(window), [[0, 2], [1, 4], [2, 4], [5, 7], [5, 8], [7, 9]]);
    }
}
