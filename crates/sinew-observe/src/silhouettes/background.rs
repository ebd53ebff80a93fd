//! A background that stands still, learned pixel by pixel, and what stands before it.
//!
//! Each pixel is a Gaussian in red, green and blue with independent channels (Wren et al., *Pfinder*, 1997): mean and variance over images without anybody. A pixel of a
//! new image is foreground where its Mahalanobis distance
//!
//! d² = Σ_c (I_c − μ_c)² / (s_c² + σ₀²)
//!
//! exceeds a threshold; σ₀ stands for what few images do not show. With shadows allowed, a pixel is background too where its colour is that of the background but
//! darker: at the brightness α = Σ I_c μ_c / Σ μ_c² between a least share and 1, the same distance to α μ is below the threshold (after Horprasert, Harwood & Davis
//! 1999).
//!
//! Known limits: light that changes, a camera that moves, and clothes of the colour of the wall.

use crate::RgbImage;
use crate::silhouettes::bit_image::BitImage;

/// When a pixel is foreground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Mahalanobis distance above which a pixel is foreground.
    pub threshold: f32,
    /// σ₀ in every channel, of 255.
    pub least_std: f32,
    /// Share of the background's brightness down to which a pixel of its colour is a shadow; none is if `None`.
    pub shadow: Option<f32>,
}

impl Default for Config {
    /// Five standard deviations, with at least 5 of 255; no shadows. Chosen, not taken from a paper.
    fn default() -> Self {
        Self { threshold: 5.0, least_std: 5.0, shadow: None }
    }
}

/// Means and sums of squares of the pixels of a camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Background {
    width: usize,
    height: usize,
    images: u32,
    mean: Vec<[f32; 3]>,
    /// Σ (I − mean)², by Welford's recursion.
    squares: Vec<[f32; 3]>,
}

/// An image of another size than its background's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OtherSize;

impl Background {
    /// The background of images of this size, before any.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        let nothing = vec![[0.0; 3]; width * height];
        Self { width, height, images: 0, mean: nothing.clone(), squares: nothing }
    }

    /// Number of images that it was learned from.
    #[must_use]
    pub const fn images(&self) -> u32 {
        self.images
    }

    /// Width and height, pixels.
    #[must_use]
    pub const fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Learns from an image without anybody.
    ///
    /// # Errors
    /// An image of another size.
    pub fn add(&mut self, image: &RgbImage) -> Result<(), OtherSize> {
        self.check(image)?;
        self.images += 1;
        let share = 1.0 / self.images as f32;
        for ((pixel, mean), squares) in image.pixels.iter().zip(&mut self.mean).zip(&mut self.squares) {
            for channel in 0..3 {
                let value = f32::from(pixel[channel]);
                let before = value - mean[channel];
                mean[channel] += share * before;
                squares[channel] += before * (value - mean[channel]);
            }
        }
        Ok(())
    }

    /// Pixels of an image that are not background.
    ///
    /// # Errors
    /// An image of another size.
    pub fn foreground(&self, image: &RgbImage, config: &Config) -> Result<BitImage, OtherSize> {
        self.check(image)?;
        let freedom = self.images.saturating_sub(1).max(1) as f32;
        let least = config.least_std.powi(2);
        let limit = config.threshold.powi(2);
        Ok(BitImage::from_fn(self.width, self.height, |x, y| {
            let place = y * self.width + x;
            let (mean, squares) = (self.mean[place], self.squares[place]);
            let pixel = image.pixels[place].map(f32::from);
            let distance = |brightness: f32| {
                let off = |c: usize| (pixel[c] - brightness * mean[c]).powi(2) / (squares[c] / freedom + least);
                (0..3).map(off).sum::<f32>()
            };
            let is_shadow = |darkest: f32| {
                let length: f32 = mean.iter().map(|mean| mean * mean).sum();
                let brightness = (0..3).map(|c| pixel[c] * mean[c]).sum::<f32>() / length.max(1.0);
                (darkest..=1.0).contains(&brightness) && distance(brightness) <= limit
            };
            distance(1.0) > limit && !config.shadow.is_some_and(is_shadow)
        }))
    }

    fn check(&self, image: &RgbImage) -> Result<(), OtherSize> {
        let fits = [image.width, image.height] == self.size() && image.pixels.len() == self.mean.len();
        if fits { Ok(()) } else { Err(OtherSize) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn even(color: [u8; 3]) -> RgbImage {
        RgbImage { width: 2, height: 1, pixels: vec![color; 2] }
    }

    fn is_foreground(images: &[[u8; 3]], color: [u8; 3], shadow: Option<f32>) -> bool {
        let mut background = Background::new(2, 1);
        images.iter().for_each(|color| background.add(&even(*color)).unwrap());
        let config = Config { threshold: 4.0, least_std: 3.0, shadow };
        background.foreground(&even(color), &config).unwrap().get(1, 0)
    }

    #[test]
    fn the_distance_is_that_of_the_channels_with_their_variances() {
        let still = [[100, 100, 100]; 3];
        assert!(!is_foreground(&still, [112, 100, 100], None));
        assert!(is_foreground(&still, [113, 100, 100], None));
        assert!(!is_foreground(&still, [106, 106, 106], None));
        assert!(is_foreground(&still, [107, 107, 107], None));
        // Variance 100 in red: 4 √(100 + 9) is 41.8.
        let flickering = [[90, 100, 100], [100, 100, 100], [110, 100, 100]];
        assert!(!is_foreground(&flickering, [141, 100, 100], None));
        assert!(is_foreground(&flickering, [142, 100, 100], None));
    }

    #[test]
    fn shadows_are_darker_and_of_the_same_colour() {
        let wall = [[200, 160, 120]];
        assert!(is_foreground(&wall, [120, 96, 72], None));
        assert!(!is_foreground(&wall, [120, 96, 72], Some(0.5)));
        assert!(is_foreground(&wall, [80, 64, 48], Some(0.5)));
        assert!(is_foreground(&wall, [72, 96, 120], Some(0.5)));
        assert!(is_foreground(&wall, [240, 192, 144], Some(0.5)));
    }

    #[test]
    fn other_sizes_are_refused() {
        let mut background = Background::new(3, 1);
        assert_eq!(background.add(&even([0; 3])), Err(OtherSize));
        assert_eq!(background.foreground(&even([0; 3]), &Config::default()), Err(OtherSize));
        assert_eq!(background.images(), 0);
    }
}
