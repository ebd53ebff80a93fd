//! Small data sets.

use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;

/// Rows of smooth functions of a few hidden coordinates with a little noise: sequences that go round a circle, of these lengths.
pub fn circles(columns: usize, lengths: &[usize], noise: f64, seed: u64) -> Vec<f64> {
    let mut normals = vec![Block::ZERO; (columns * lengths.iter().sum::<usize>()).div_ceil(8)];
    Stage::new(seed, "circles").whole().fill_normal(Isa::baseline(), &mut normals);
    let mut normals = normals.iter().flat_map(|block| block.0);
    let mut rows = Vec::new();
    for (s, &length) in lengths.iter().enumerate() {
        for n in 0..length {
            let angle = 0.35 * n as f64 + s as f64;
            for j in 0..columns {
                let (phase, size) = (0.8 * j as f64, 1.0 + 0.2 * (j % 3) as f64);
                rows.push(
                    size * (angle + phase).sin()
                        + 0.3 * (2.0 * angle - phase).cos()
                        + noise * normals.next().unwrap_or_default()
                        + j as f64,
                );
            }
        }
    }
    rows
}

/// Central differences of a function at `x`, with steps of 1e-5 times the size of each unknown.
pub fn differences(x: &[f64], mut function: impl FnMut(&[f64]) -> f64) -> Vec<f64> {
    let mut moved = x.to_vec();
    let difference = |i: usize| {
        let step = 1e-5 * x[i].abs().max(0.1);
        moved[i] = x[i] + step;
        let above = function(&moved);
        moved[i] = x[i] - step;
        let below = function(&moved);
        moved[i] = x[i];
        (above - below) / (2.0 * step)
    };
    (0..x.len()).map(difference).collect()
}

/// Largest difference over the largest entry.
pub fn relative_error(found: &[f64], expected: &[f64]) -> f64 {
    let size = expected.iter().fold(0.0, |size: f64, x| size.max(x.abs()));
    found.iter().zip(expected).fold(0.0, |worst: f64, (a, b)| worst.max((a - b).abs())) / size
}
