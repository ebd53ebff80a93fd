//! Gaussian smoothing of maps by a mask of limited size.
//!
//! The mask of radius r has (2r + 1)² weights ∝ exp(−(i² + j²)/2σ²) that sum to 1; being a product, it is applied along rows and then along columns. Beyond the
//! image the pixels of its border are repeated, so that a constant map stays constant.

use crate::Map;

/// A Gaussian mask.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaussianMask {
    /// Pixels from the middle to the end: 3 for a mask of 7 x 7.
    pub radius_px: usize,
    /// Standard deviation, pixels, above 0.
    pub std_px: f32,
}

impl GaussianMask {
    /// The weights of a row of the mask, from left to right.
    fn weights(self) -> Vec<f32> {
        let radius = self.radius_px as f32;
        let weight = |i: usize| (-0.5 * ((i as f32 - radius) / self.std_px).powi(2)).exp();
        let weights: Vec<f32> = (0..=2 * self.radius_px).map(weight).collect();
        let sum: f32 = weights.iter().sum();
        weights.iter().map(|weight| weight / sum).collect()
    }
}

/// The map, smoothed; values keep their range.
#[must_use]
pub fn smoothed(map: &Map, mask: GaussianMask) -> Map {
    let weights = mask.weights();
    let Map { width, height, .. } = *map;
    let mut along_rows = vec![0.0; map.values.len()];
    let mut padded = vec![0.0; width + 2 * mask.radius_px];
    for (row, out) in map.values.chunks_exact(width.max(1)).zip(along_rows.chunks_exact_mut(width.max(1))) {
        for (x, value) in padded.iter_mut().enumerate() {
            *value = row[x.saturating_sub(mask.radius_px).min(width - 1)];
        }
        for (window, out) in padded.windows(weights.len()).zip(out) {
            *out = window.iter().zip(&weights).map(|(value, weight)| value * weight).sum();
        }
    }
    let mut values = vec![0.0; map.values.len()];
    for (y, out) in values.chunks_exact_mut(width.max(1)).enumerate() {
        for (i, weight) in weights.iter().enumerate() {
            let from = (y + i).saturating_sub(mask.radius_px).min(height - 1);
            for (out, value) in out.iter_mut().zip(&along_rows[from * width..][..width]) {
                *out += weight * value;
            }
        }
    }
    Map { width, height, values }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_sum_over_the_square_mask() {
        let map = Map::from_fn(9, 7, |x, y| ((7 * x + 3 * y * y) % 11) as f32);
        for mask in [GaussianMask { radius_px: 2, std_px: 1.0 }, GaussianMask { radius_px: 5, std_px: 3.0 }] {
            let smooth = smoothed(&map, mask);
            let r = mask.radius_px as i32;
            for (x, y) in (0..7).flat_map(|y| (0..9).map(move |x| (x, y))) {
                let (mut sum, mut total) = (0.0, 0.0);
                for (i, j) in (-r..=r).flat_map(|j| (-r..=r).map(move |i| (i, j))) {
                    let weight = (-0.5 * (i * i + j * j) as f64 / f64::from(mask.std_px).powi(2)).exp();
                    let value = map.get((x + i).clamp(0, 8) as usize, (y + j).clamp(0, 6) as usize).unwrap();
                    sum += weight * f64::from(value);
                    total += weight;
                }
                let found = smooth.get(x as usize, y as usize).unwrap();
                assert!((f64::from(found) - sum / total).abs() < 1e-5, "{found} for {} at {x}, {y}", sum / total);
            }
        }
    }

    #[test]
    fn nothing_stays_nothing() {
        let mask = GaussianMask { radius_px: 3, std_px: 3.0 };
        for size in [[0, 0], [0, 4], [4, 0]] {
            assert!(smoothed(&Map::from_fn(size[0], size[1], |_, _| 1.0), mask).values.is_empty());
        }
    }
}
