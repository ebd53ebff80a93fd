//! Nearest neighbours: each row filled in from the training row nearest to it in the columns that are there.

use super::task::{Row, Task};

/// The judged rows, filled in by distances of raw columns, or of columns in standard deviations.
#[must_use]
pub fn fill(task: &Task<'_>, is_scaled: bool) -> Vec<Row> {
    let scales = task.scales();
    let weights: Row = match is_scaled {
        true => scales.sd.iter().map(|sd| sd.powi(-2)).collect(),
        false => vec![1.0; scales.sd.len()],
    };
    let observed = task.observed();
    let distance = |a: &Row, b: &Row| observed.iter().map(|&j| weights[j] * (a[j] - b[j]).powi(2)).sum::<f64>();
    let nearest = |row: &Row| {
        let near = |a: &&Row, b: &&Row| distance(a, row).total_cmp(&distance(b, row));
        let nearest = task.training.iter().copied().flatten().min_by(near);
        nearest.map_or_else(Row::new, |row| row[task.missing.clone()].to_vec())
    };
    task.with(nearest)
}
