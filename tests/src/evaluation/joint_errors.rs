//! Distances of a body's joints from a motion's, as they are and from the middle of the hips.

use sinew::body::standard::EVALUATION_JOINTS;
use sinew_body::points::Trajectories;

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

/// Mean distances of the joints of evaluation in each frame that both have, millimetres: as they are, all 15; and from the middle of the hips, the other 14. Joints that a motion lacks must be lacking in both.
#[must_use]
pub fn joint_errors_mm(found: &Trajectories, truth: &Trajectories) -> [Vec<f64>; 2] {
    let [found, truth] = [found, truth].map(|points| points.select(&EVALUATION_JOINTS));
    let count = found.names.len() as f64;
    let pairs = || found.frames.iter().zip(&truth.frames);
    let absolute = pairs().map(|(a, b)| a.iter().zip(b).map(|(a, b)| 1e3 * distance(*a, *b)).sum::<f64>() / count);
    let moved = |frame: &[[f64; 3]], k: usize| [0, 1, 2].map(|i| frame[k][i] - frame[0][i]);
    let relative = pairs()
        .map(|(a, b)| (1..a.len()).map(|k| 1e3 * distance(moved(a, k), moved(b, k))).sum::<f64>() / (count - 1.0));
    [absolute.collect(), relative.collect()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_that_is_moved_has_no_error_from_its_hips() {
        let names: Vec<String> = EVALUATION_JOINTS.map(String::from).into();
        let frame = |x: f64| (0..15).map(|k| [x, f64::from(k), 1.0]).collect::<Vec<_>>();
        let truth = Trajectories { names: names.clone(), frames: vec![frame(0.0), frame(0.0), frame(0.0)] };
        let mut found = Trajectories { names, frames: vec![frame(0.003), frame(0.0)] };
        found.frames[1][5][2] += 0.015;
        let [absolute, relative] = joint_errors_mm(&found, &truth);
        let near = |found: &[f64], expected: [f64; 2]| {
            assert!(found.len() == 2 && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
        };
        near(&absolute, [3.0, 1.0]);
        near(&relative, [0.0, 15.0 / 14.0]);
    }
}
