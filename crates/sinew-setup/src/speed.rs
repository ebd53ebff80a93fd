//! Whether the person moves as fast as people do, at the frame rate that is taken.
//!
//! The displacement of a point over `SPAN` frames, less what the errors of its two places make of it, over the time that they last; the 90th percentile of all. Nobody's
//! hips are faster than the fastest sprinter, 12.4 m/s (Bolt in Berlin 2009, Graubner & Nixdorf 2011, New Studies in Athletics 26), and nobody's hands and feet faster than
//! the fastest ball that a hand has thrown, 47.3 m/s (105.8 miles an hour, Guinness World Records). A rate that is too low slows the motion down, which no bound shows.

use super::collect::{Collected, SetupRequest};
use super::setup_error::SetupError;
use super::space_points::{Points, points_in_space};
use super::warning::SetupWarning;
use sinew_formats::Layout;
use sinew_observe::Camera;
use sinew_observe::cameras::offsets::CameraNoise;

/// Frames between two places.
const SPAN: usize = 10;
/// Pairs of places below which nothing is said.
const FEWEST: usize = 10;
/// Share of the speeds that lie below the one that counts.
const SHARE: f64 = 0.9;
/// Times the fastest people at which no sport explains a speed.
const ABSURD: f64 = 4.0;

/// Name for messages, points whose middle counts, and the speed of the fastest, metres a second.
const PARTS: [(&str, &[&str], f64); 5] = [
    ("hips", &["LHip", "RHip"], 12.4),
    ("left hand", &["LWrist"], 47.3),
    ("right hand", &["RWrist"], 47.3),
    ("left foot", &["LAnkle"], 47.3),
    ("right foot", &["RAnkle"], 47.3),
];

/// A warning about a speed that nobody has; `None` without a frame rate.
///
/// # Errors
/// A speed that is absurd, unless any speed is allowed.
pub fn check(
    cameras: &[Camera],
    layout: &Layout,
    request: &SetupRequest,
    noise: &[CameraNoise],
    collected: &Collected,
) -> Result<Option<SetupWarning>, SetupError> {
    let Some(fps) = request.fps else { return Ok(None) };
    let points = |(number, sighted): &(u64, _)| {
        (*number, points_in_space(cameras, noise, sighted, request.offsets.least_confidence))
    };
    let frames: Vec<(u64, Points)> = collected.window.iter().map(points).collect();
    let speeds = PARTS.iter().filter_map(|(part, names, fastest)| {
        let speed = usual_speed(layout, &frames, names, fps)?;
        (speed > *fastest).then_some((*part, speed, *fastest))
    });
    let Some((part, m_per_s, fastest_m_per_s)) = speeds.max_by(|a, b| (a.1 / a.2).total_cmp(&(b.1 / b.2))) else {
        return Ok(None);
    };
    let warning = SetupWarning::Fast { part, m_per_s, fastest_m_per_s, fps };
    if m_per_s > ABSURD * fastest_m_per_s && !request.any_size {
        return Err(SetupError::Fast(warning));
    }
    Ok(Some(warning))
}

/// Speed of the middle of some points, metres a second, which a tenth of the pairs of frames exceed.
fn usual_speed(layout: &Layout, frames: &[(u64, Points)], names: &[&str], fps: f64) -> Option<f64> {
    let middle = |points: &Points| {
        let found = names.iter().map(|name| points.get(layout.index(name)?).copied().flatten());
        let found: Vec<([f64; 3], f64)> = found.collect::<Option<_>>()?;
        let count = found.len() as f64;
        let place = [0, 1, 2].map(|k: usize| found.iter().map(|(p, _)| p[k]).sum::<f64>() / count);
        Some((place, found.iter().map(|(_, variance)| variance).sum::<f64>() / (count * count)))
    };
    let places: Vec<Option<([f64; 3], f64)>> = frames.iter().map(|(_, points)| middle(points)).collect();
    let mut speeds: Vec<f64> = (SPAN..frames.len())
        .filter_map(|later| {
            let ((a, variance_a), (b, variance_b)) = (places[later - SPAN]?, places[later]?);
            let seconds = (frames[later].0 - frames[later - SPAN].0) as f64 / fps;
            let squared = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>() - 3.0 * (variance_a + variance_b);
            Some(squared.max(0.0).sqrt() / seconds)
        })
        .collect();
    speeds.sort_by(f64::total_cmp);
    (speeds.len() >= FEWEST).then(|| speeds[(SHARE * (speeds.len() - 1) as f64) as usize])
}
