//! The diagnostics of a frame as a row of numbers, bit for bit; NaN where there is none.
//!
//! For files that the program keeps for itself during a run.

use super::{FrameEstimate, Quality};

/// Numbers before the residuals of the cameras.
const SCALARS: usize = 12;

/// Numbers of a frame seen by `cameras` cameras.
#[must_use]
pub const fn count(cameras: usize) -> usize {
    SCALARS + cameras
}

/// The row of a frame.
#[must_use]
pub fn numbers(estimate: &FrameEstimate, cameras: usize) -> Vec<f64> {
    let none = f64::NAN;
    let mut row = vec![
        estimate.number as f64,
        f64::from(u8::from(estimate.observed)),
        f64::from(estimate.quality as u8),
        f64::from(u8::from(estimate.restarted)),
        estimate.ess,
        estimate.log_evidence.unwrap_or(none),
        estimate.r_hat.unwrap_or(none),
        estimate.acceptance.unwrap_or(none),
        estimate.energy_fraction.unwrap_or(none),
        estimate.off_manifold.unwrap_or(none),
        estimate.divergences as f64,
        estimate.trajectories as f64,
    ];
    row.extend((0..cameras).map(|c| estimate.residual_px.get(c).copied().flatten().unwrap_or(none)));
    row
}

/// The frame of a row that [`numbers`] gave, with nothing in it but its diagnostics; `None` for a row that is too short.
#[must_use]
pub fn estimate(row: &[f64], fps: f64) -> Option<FrameEstimate> {
    let (scalars, residuals) = row.split_first_chunk::<SCALARS>()?;
    let [number, observed, quality, restarted, ess, optional @ .., divergences, trajectories] = *scalars;
    let [log_evidence, r_hat, acceptance, energy_fraction, off_manifold] = optional.map(some);
    Some(FrameEstimate {
        number: number as u64,
        time_s: number / fps,
        observed: observed > 0.0,
        restarted: restarted > 0.0,
        quality: match quality as u8 {
            0 => Quality::Predicted,
            1 => Quality::OneCamera,
            _ => Quality::Good,
        },
        ess,
        log_evidence,
        r_hat,
        acceptance,
        energy_fraction,
        off_manifold,
        divergences: divergences as u64,
        trajectories: trajectories as u64,
        residual_px: residuals.iter().copied().map(some).collect(),
        ..FrameEstimate::default()
    })
}

fn some(number: f64) -> Option<f64> {
    Some(number).filter(|number| !number.is_nan())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_gives_the_frame_back() {
        let frame = FrameEstimate {
            number: 90,
            time_s: 3.0,
            observed: true,
            quality: Quality::OneCamera,
            ess: 0.1 + 0.2,
            r_hat: Some(f64::INFINITY),
            energy_fraction: Some(1e-300),
            off_manifold: Some(0.0),
            divergences: 3,
            trajectories: 512,
            residual_px: vec![None, Some(4.5)],
            ..FrameEstimate::default()
        };
        let row = numbers(&frame, 2);
        assert_eq!((row.len(), estimate(&row, 30.0)), (count(2), Some(frame)));
        assert_eq!(estimate(&row[..10], 30.0), None);
    }
}
