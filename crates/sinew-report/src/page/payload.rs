//! The numbers of a result as the page's program reads them.
//!
//! Four bytes say how long the head is (least first), the head is JSON, then come columns ([`super::columns`]), each with a number for each frame shown, in this order: number of the frame, quality, restarted, R-hat, the residual of each camera; for each point, along each axis, mean, mean − q05 and q95 − mean, then the six numbers of its ellipsoid ([`super::spread`]); for each angle mean, mean − q05, q95 − mean and whether keypoints show it.

use super::angle_words::angle_words;
use super::bones::bones;
use super::columns::encode;
use super::recorded::{Band, Recorded};
use super::spread::Factor;
use super::views::Views;
use serde_json::json;

/// Steps to which numbers are rounded: metres, degrees, pixels, R-hat.
const POSITION_M: f64 = 0.0005;
const ANGLE_DEG: f64 = 0.05;
const RESIDUAL_PX: f64 = 0.05;
const R_HAT: f64 = 0.001;

/// Head and columns, of every n-th frame.
pub(super) fn payload(recorded: &Recorded, factors: &[Vec<Factor>], views: &Views, every: usize) -> Vec<u8> {
    let points: Vec<String> = recorded.points.iter().map(|point| point.name.clone()).collect();
    let angles: Vec<_> = recorded.angles.iter().map(|angle| (&angle.name, angle_words(&angle.name))).collect();
    let head = json!({
        "fps": recorded.fps(),
        "frames": recorded.numbers.len().div_ceil(every),
        "every": every,
        "steps": { "position": POSITION_M, "angle": ANGLE_DEG, "residual": RESIDUAL_PX, "rhat": R_HAT },
        "bones": bones(&points),
        "points": points,
        "angles": angles.iter().map(|(name, words)| json!({ "name": name, "of": words.group, "side": words.side, "rank": words.rank })).collect::<Vec<_>>(),
        "cameras": views.to_json(recorded.setup.camera.iter().map(|camera| camera.name.clone())),
    });
    let head = head.to_string().into_bytes();
    let mut out = u32::try_from(head.len()).unwrap_or(u32::MAX).to_le_bytes().to_vec();
    out.extend(head);
    let mut add = |values: &mut dyn Iterator<Item = f64>, step: f64| encode(&mut out, values.step_by(every), step);
    for column in [&recorded.numbers, &recorded.quality, &recorded.restarted] {
        add(&mut column.iter().copied(), 1.0);
    }
    add(&mut recorded.r_hat.iter().copied(), R_HAT);
    recorded.residuals_px.iter().for_each(|column| add(&mut column.iter().copied(), RESIDUAL_PX));
    let band = |band: &Band, step: f64, add: &mut dyn FnMut(&mut dyn Iterator<Item = f64>, f64)| {
        add(&mut band.mean.iter().copied(), step);
        add(&mut band.mean.iter().zip(&band.low).map(|(mean, low)| mean - low), step);
        add(&mut band.high.iter().zip(&band.mean).map(|(high, mean)| high - mean), step);
    };
    for (point, factors) in recorded.points.iter().zip(factors) {
        point.axes.iter().for_each(|axis| band(axis, POSITION_M, &mut add));
        (0..6).for_each(|k| add(&mut factors.iter().map(|factor| factor[k]), POSITION_M));
    }
    for angle in &recorded.angles {
        band(&angle.band, ANGLE_DEG, &mut add);
        add(&mut angle.seen.iter().copied(), 1.0);
    }
    out
}
