//! Lines, discs and numbers with soft edges on colour images.

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

/// Strokes of a digit: top, upper left, upper right, middle, lower left, lower right, bottom, on a field one wide and two high.
const STROKES: [[[f64; 2]; 2]; 7] = [
    [[0.0, 0.0], [1.0, 0.0]],
    [[0.0, 0.0], [0.0, 1.0]],
    [[1.0, 0.0], [1.0, 1.0]],
    [[0.0, 1.0], [1.0, 1.0]],
    [[0.0, 1.0], [0.0, 2.0]],
    [[1.0, 1.0], [1.0, 2.0]],
    [[0.0, 2.0], [1.0, 2.0]],
];
/// Which strokes each digit has, in the order of [`STROKES`].
const DIGITS: [&[u8; 7]; 10] = [
    b"1110111", b"0010010", b"1011101", b"1011011", b"0111010", b"1101011", b"1101111", b"1010010", b"1111111",
    b"1111011",
];

/// Writes a number above a place, with a black rim; a digit is eight half widths wide.
pub(super) fn number(image: &mut RgbImage, above: [f64; 2], half_width: f64, number: usize, colour: [u8; 3]) {
    let digits: Vec<usize> = number.to_string().bytes().map(|digit| usize::from(digit - b'0')).collect();
    let (side, step) = (8.0 * half_width, 13.0 * half_width);
    let left = above[0] - 0.5 * (step * digits.len() as f64 - 5.0 * half_width);
    let top = above[1] - 2.0 * side - 8.0 * half_width;
    for (half_width, colour) in [(2.2 * half_width, [0; 3]), (1.2 * half_width, colour)] {
        for (place, digit) in digits.iter().enumerate() {
            let corner = |[x, y]: [f64; 2]| [left + step * place as f64 + side * x, top + side * y];
            for (ends, _) in STROKES.iter().zip(DIGITS[*digit]).filter(|(_, drawn)| **drawn == b'1') {
                line(image, ends.map(corner), half_width, colour);
            }
        }
    }
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

    /// Ones and sevens differ by the upper stroke, and nothing is drawn below the place.
    #[test]
    fn digits_have_their_strokes() {
        let drawn = |digit: usize| {
            let mut image = RgbImage { width: 30, height: 40, pixels: vec![[0; 3]; 1200] };
            number(&mut image, [15.0, 30.0], 1.0, digit, [0, 200, 0]);
            assert!(image.pixels[30 * 30..].iter().all(|pixel| *pixel == [0; 3]), "{digit}");
            image.pixels.iter().map(|pixel| pixel[1] > 100).collect::<Vec<bool>>()
        };
        let all: Vec<Vec<bool>> = (0..10).map(drawn).collect();
        for a in 0..10 {
            for b in 0..a {
                assert_ne!(all[a], all[b], "{a} {b}");
            }
        }
        let count = |digit: usize| all[digit].iter().filter(|lit| **lit).count();
        assert!(count(1) < count(7) && count(7) < count(8) && count(1) > 0);
    }

    #[test]
    fn a_disc_has_its_area() {
        let mut image = black();
        disc(&mut image, [10.0, 5.0], 3.0, [255; 3]);
        let area: f64 = image.pixels.iter().map(|pixel| f64::from(pixel[0]) / 255.0).sum();
        assert!((area - std::f64::consts::PI * 9.0).abs() < 2.0, "{area}");
    }
}
