//! Where the contour of a silhouette is: a map from 0 to 1 that falls off within two pixels. The likelihood of the coarse-to-fine particle filter reads it.
//!
//! The silhouette S in {0, 1} is smoothed to G by a 5 x 5 Gaussian of σ = 1 px. G is 1/2 on the contour, so that 4 G (1 − G) is 1 there and 0 deep inside
//! and outside. (The paper says only that the silhouette is smoothed, which is no map of edges.)
//! The border of the image is no contour: beyond it the silhouette continues.

use crate::Map;
use crate::silhouettes::bit_image::BitImage;
use crate::silhouettes::smoothing::{GaussianMask, smoothed};

/// The mask that smooths a silhouette.
const MASK: GaussianMask = GaussianMask { radius_px: 2, std_px: 1.0 };

fn smoothed_silhouette(silhouette: &BitImage) -> Map {
    let (width, height) = (silhouette.width(), silhouette.height());
    let mut all = Map { width, height, values: vec![0.0; width * height] };
    // Beyond the mask's reach all is 0, and most of an image is.
    let Some([columns, rows]) = silhouette.bounds() else { return all };
    let reach = MASK.radius_px;
    let (left, right) = (columns.start.saturating_sub(reach), (columns.end + reach).min(width));
    let (top, bottom) = (rows.start.saturating_sub(reach), (rows.end + reach).min(height));
    let part = Map::from_fn(right - left, bottom - top, |x, y| f32::from(silhouette.get(left + x, top + y)));
    let smooth = smoothed(&part, MASK);
    for (row, values) in smooth.values.chunks_exact(smooth.width).enumerate() {
        let from = (top + row) * width + left;
        all.values[from..from + values.len()].copy_from_slice(values);
    }
    all
}

/// 4 G (1 − G) of the smoothed silhouette.
#[must_use]
pub fn contour_map(silhouette: &BitImage) -> Map {
    let mut map = smoothed_silhouette(silhouette);
    // Sums of weights may miss 1 by rounding.
    map.values.iter_mut().for_each(|g| *g = (4.0 * *g * (1.0 - *g)).clamp(0.0, 1.0));
    map
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> BitImage {
        BitImage::from_fn(30, 24, |x, y| (8..20).contains(&x) && (6..18).contains(&y))
    }

    /// Leaving out what the mask does not reach changes nothing, also at the borders of the image.
    #[test]
    fn a_part_is_as_good_as_the_whole() {
        for (columns, rows) in [(10..14, 8..20), (0..3, 5..9), (27..30, 21..24), (0..30, 0..24), (12..13, 23..24)] {
            let silhouette =
                BitImage::from_fn(30, 24, |x, y| columns.contains(&x) && rows.contains(&y) && (x + y) % 5 > 0);
            let whole = smoothed(&Map::from_fn(30, 24, |x, y| f32::from(silhouette.get(x, y))), MASK);
            assert_eq!(smoothed_silhouette(&silhouette), whole, "{columns:?} {rows:?}");
        }
    }

    #[test]
    fn the_contour_is_bright_and_all_else_dark() {
        let map = contour_map(&square());
        assert!(map.values.iter().all(|value| (0.0..=1.0).contains(value)));
        for (x, y, least, most) in [(8, 12, 0.7, 1.0), (7, 12, 0.7, 1.0), (12, 12, 0.0, 1e-6), (2, 2, 0.0, 0.0)] {
            let value = map.get(x, y).unwrap();
            assert!((least..=most).contains(&value), "{value} at {x}, {y}");
        }
    }

    /// Weights e^(-i²/2) for i = 0, 1, 2 are 1, 0.606531, 0.135335: of a straight edge, the pixel beside it sees 0.701 of the mask on its own side.
    #[test]
    fn a_straight_edge_has_the_value_of_the_weights() {
        let g = (1.0 + 0.606_531 + 0.135_335) / (1.0 + 2.0 * (0.606_531 + 0.135_335));
        let found = contour_map(&square()).get(8, 12).unwrap();
        assert!((found - 4.0 * g * (1.0 - g)).abs() < 1e-5, "{found}");
    }

    #[test]
    fn neither_the_border_nor_an_empty_mask_has_a_contour() {
        for silhouette in [BitImage::new(12, 9), BitImage::from_fn(12, 9, |_, _| true)] {
            assert!(contour_map(&silhouette).values.iter().all(|value| *value < 1e-5));
        }
    }
}
