//! The axis of the world that points from feet to head.

use super::space_points::Points;
use sinew_core::estimators::median;
use sinew_formats::Layout;
use sinew_input::up_axis::AXES;

const LOW: [&str; 6] = ["LAnkle", "RAnkle", "LHeel", "RHeel", "LKnee", "RKnee"];
const HIGH: [&str; 6] = ["Head", "Nose", "Neck", "LShoulder", "RShoulder", "MidShoulder"];

/// World axis nearest to the median direction from feet to head; `+z` where nothing is known.
#[must_use]
pub fn up_axis(layout: &Layout, frames: &[(u64, Points)]) -> &'static str {
    let mut directions: [Vec<f64>; 3] = [vec![], vec![], vec![]];
    for (_, points) in frames {
        let middle = |names: &[&str]| {
            let found: Vec<[f64; 3]> =
                names.iter().filter_map(|n| Some(points.get(layout.index(n)?).copied().flatten()?.0)).collect();
            let count = found.len() as f64;
            (!found.is_empty()).then(|| [0, 1, 2].map(|k: usize| found.iter().map(|p| p[k]).sum::<f64>() / count))
        };
        if let (Some(low), Some(high)) = (middle(&LOW), middle(&HIGH)) {
            for k in 0..3 {
                directions[k].push(high[k] - low[k]);
            }
        }
    }
    let direction = directions.map(|mut d| median(&mut d));
    let largest = (0..3).max_by(|&a, &b| direction[a].abs().total_cmp(&direction[b].abs())).unwrap_or(2);
    if direction[largest].is_nan() { "+z" } else { AXES[largest][usize::from(direction[largest] > 0.0)] }
}
