//! Lines and discs with soft edges on colour images.

use sinew_observe::RgbImage;

/// Draws a line from `a` to `b`, pixels; pixels count by how much of them lies within `half_width` of it, roughly.
pub(super) fn line(image: &mut RgbImage, [a, b]: [[f64; 2]; 2], half_width: f64, colour: [u8; 3]) {
    let along = [b[0] - a[0], b[1] - a[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let reach = half_width + 1.0;
    let bounds = |axis: usize, size: usize| {
        let (low, high) = (a[axis].min(b[axis]) - reach, a[axis].max(b[axis]) + reach);
        // What is not a number or outside becomes an empty range.
        (low.max(0.0) as usize)..(high.min(size as f64).ceil().max(0.0) as usize)
    };
    for y in bounds(1, image.height) {
        for x in bounds(0, image.width) {
            let from = [x as f64 + 0.5 - a[0], y as f64 + 0.5 - a[1]];
            let share = if square > 0.0 { (from[0] * along[0] + from[1] * along[1]) / square } else { 0.0 };
            let share = share.clamp(0.0, 1.0);
            let distance = (from[0] - share * along[0]).hypot(from[1] - share * along[1]);
            let cover = (half_width + 0.5 - distance).clamp(0.0, 1.0);
            if cover > 0.0 {
                let pixel = &mut image.pixels[y * image.width + x];
                for (old, new) in pixel.iter_mut().zip(colour) {
                    *old = (f64::from(*old) + cover * (f64::from(new) - f64::from(*old))).round() as u8;
                }
            }
        }
    }
}

/// Draws a disc.
pub(super) fn disc(image: &mut RgbImage, centre: [f64; 2], radius: f64, colour: [u8; 3]) {
    line(image, [centre, centre], radius, colour);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn black() -> RgbImage {
        RgbImage { width: 20, height: 10, pixels: vec![[0; 3]; 200] }
    }

    #[test]
    fn lines_are_where_they_should_be_and_stay_inside() {
        let mut image = black();
        line(&mut image, [[-100.0, 4.5], [10.0, 4.5]], 0.5, [200, 0, 0]);
        assert_eq!((image.pixels[4 * 20 + 3], image.pixels[3 * 20 + 3]), ([200, 0, 0], [0; 3]));
        assert_eq!(image.pixels[4 * 20 + 12], [0; 3]);
        let before = image.clone();
        for far in [[f64::NAN, 3.0], [-1e9, -1e9], [1e9, 5.0]] {
            disc(&mut image, far, 3.0, [9; 3]);
        }
        assert_eq!(image, before);
    }

    #[test]
    fn a_disc_has_its_area() {
        let mut image = black();
        disc(&mut image, [10.0, 5.0], 3.0, [255; 3]);
        let area: f64 = image.pixels.iter().map(|pixel| f64::from(pixel[0]) / 255.0).sum();
        assert!((area - std::f64::consts::PI * 9.0).abs() < 2.0, "{area}");
    }
}
