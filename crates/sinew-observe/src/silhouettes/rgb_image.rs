//! Colour images of eight bits a channel.

use crate::Map;

/// A colour image, row by row.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RgbImage {
    /// Pixels of a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue of pixel (x, y) at `y * width + x`; `width * height` pixels.
    pub pixels: Vec<[u8; 3]>,
}

impl RgbImage {
    /// Brightness in \[0, 1\]: 0.299 R + 0.587 G + 0.114 B (ITU-R BT.601), of the values as stored.
    #[must_use]
    pub fn grey(&self) -> Map {
        let values = self.pixels.iter().map(|&[red, green, blue]| {
            (0.299 * f32::from(red) + 0.587 * f32::from(green) + 0.114 * f32::from(blue)) / 255.0
        });
        Map { width: self.width, height: self.height, values: values.collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_one_and_green_is_brightest() {
        let pixels = vec![[0; 3], [255; 3], [255, 0, 0], [0, 255, 0], [0, 0, 255]];
        let grey = RgbImage { width: 5, height: 1, pixels }.grey();
        for (found, wanted) in grey.values.iter().zip([0.0, 1.0, 0.299, 0.587, 0.114]) {
            assert!((found - wanted).abs() < 1e-6, "{found} for {wanted}");
        }
    }
}
