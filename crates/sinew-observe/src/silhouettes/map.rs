//! Images of one number a pixel: grey values, edges, distances.

/// An image of one number a pixel, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map {
    /// Pixels of a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Pixel (x, y) at `y * width + x`; `width * height` numbers.
    pub values: Vec<f32>,
}

impl Map {
    /// A map from the value of each pixel (x, y), asked row by row.
    #[must_use]
    pub fn from_fn(width: usize, height: usize, mut value: impl FnMut(usize, usize) -> f32) -> Self {
        let values = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| value(x, y)).collect();
        Self { width, height, values }
    }

    /// Value of a pixel; `None` outside the image.
    #[inline(always)]
    #[must_use]
    pub fn get(&self, x: usize, y: usize) -> Option<f32> {
        if x < self.width { self.values.get(y * self.width + x).copied() } else { None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_first() {
        let map = Map::from_fn(3, 2, |x, y| (10 * y + x) as f32);
        assert_eq!(map.values, [0.0, 1.0, 2.0, 10.0, 11.0, 12.0]);
        assert_eq!(map.get(2, 1), Some(12.0));
        assert_eq!((map.get(3, 0), map.get(0, 2)), (None, None));
    }
}
