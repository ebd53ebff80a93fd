//! Edges of a grey image, as maps that say how near a projected contour is to an edge.
//!
//! The gradient is Sobel's, divided by 8, of grey values in \[0, 1\]: a step from black to white has magnitude 1/2 on both its sides. Beyond the image the pixels
//! of its border are repeated.
//!
//! [`edge_map`] (Deutscher, Blake & Reid 2000): pixels above a threshold, smoothed with a Gaussian mask and rescaled to a maximum of 1.

use crate::Map;
use crate::silhouettes::smoothing::{GaussianMask, smoothed};

/// How an [`edge_map`] is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Magnitude of the gradient from which on a pixel is an edge.
    pub threshold: f32,
    /// Mask that spreads the edges.
    pub mask: GaussianMask,
}

impl Default for Config {
    /// A mask of 7 x 7 pixels with σ = 3 px. The paper gives no threshold; above 0.1 are some 5 % of the pixels of a real recording of four cameras, above 0.04
    /// some 13 %.
    fn default() -> Self {
        Self { threshold: 0.1, mask: GaussianMask { radius_px: 3, std_px: 3.0 } }
    }
}

/// Magnitude of the gradient of a grey image, per pixel.
#[must_use]
pub fn gradient_magnitude(grey: &Map) -> Map {
    let Map { width, height, ref values } = *grey;
    Map::from_fn(width, height, |x, y| {
        let columns = [x.saturating_sub(1), x, (x + 1).min(width - 1)];
        let [above, here, below] =
            [y.saturating_sub(1), y, (y + 1).min(height - 1)].map(|row| columns.map(|x| values[row * width + x]));
        let across = above[2] - above[0] + 2.0 * (here[2] - here[0]) + below[2] - below[0];
        let down = below[0] - above[0] + 2.0 * (below[1] - above[1]) + below[2] - above[2];
        (across * across + down * down).sqrt() / 8.0
    })
}

/// Nearness to an edge, from 0 (none under the mask) to 1 (where there are most); 0 everywhere if there is none.
#[must_use]
pub fn edge_map(grey: &Map, config: &Config) -> Map {
    let mut map = gradient_magnitude(grey);
    map.values.iter_mut().for_each(|value| *value = f32::from(*value >= config.threshold));
    let mut map = smoothed(&map, config.mask);
    let most = map.values.iter().copied().fold(0.0, f32::max);
    if most > 0.0 {
        map.values.iter_mut().for_each(|value| *value /= most);
    }
    map
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noisy(width: usize, height: usize) -> Map {
        Map::from_fn(width, height, |x, y| ((37 * x + 91 * y * y + 13 * x * y) % 101) as f32 / 100.0)
    }

    #[test]
    fn a_step_has_half_its_height_on_both_sides() {
        let step = gradient_magnitude(&Map::from_fn(6, 4, |x, _| if x < 3 { 0.0 } else { 0.8 }));
        for y in 0..4 {
            let row: Vec<f32> = (0..6).map(|x| step.get(x, y).unwrap()).collect();
            assert!(row.iter().zip([0.0, 0.0, 0.4, 0.4, 0.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-6), "{row:?}");
        }
        let slope = gradient_magnitude(&Map::from_fn(8, 8, |x, y| 0.03 * x as f32 + 0.04 * y as f32));
        assert!((slope.get(4, 4).unwrap() - 0.05).abs() < 1e-6);
    }

    #[test]
    fn the_gradient_is_that_of_the_two_masks() {
        let grey = noisy(9, 6);
        let found = gradient_magnitude(&grey);
        let (smooth, slope) = ([1.0, 2.0, 1.0], [-1.0, 0.0, 1.0]);
        for (x, y) in (0..6).flat_map(|y| (0..9).map(move |x| (x, y))) {
            let mut sums = [0.0_f64; 2];
            for (i, j) in (0..3).flat_map(|j| (0..3).map(move |i| (i, j))) {
                let at = grey.get((x + i - 1).clamp(0, 8) as usize, (y + j - 1).clamp(0, 5) as usize).unwrap();
                sums[0] += slope[i as usize] * smooth[j as usize] * f64::from(at);
                sums[1] += smooth[i as usize] * slope[j as usize] * f64::from(at);
            }
            let wanted = sums[0].hypot(sums[1]) / 8.0;
            assert!((f64::from(found.get(x as usize, y as usize).unwrap()) - wanted).abs() < 1e-6);
        }
    }

    #[test]
    fn a_line_spreads_and_reaches_one() {
        let grey = Map::from_fn(40, 30, |x, _| if x < 20 { 0.2 } else { 0.9 });
        let map = edge_map(&grey, &Config::default());
        let row: Vec<f32> = (0..40).map(|x| map.get(x, 15).unwrap()).collect();
        assert_eq!((row[19], row[20]), (1.0, 1.0));
        assert!(row[15..20].is_sorted() && row[16] > 0.0 && row[15] == 0.0);
        let flat = edge_map(&Map::from_fn(10, 10, |_, _| 0.4), &Config::default());
        assert!(flat.values.iter().all(|value| *value == 0.0));
    }
}
