//! Images of one bit a pixel, 64 pixels a word: silhouettes, and the shapes of a model.
//!
//! Pixel (x, y) is bit x mod 64 of word x / 64 of row y; bits beyond the width are 0, so that counts need no mask.

use std::ops::Range;

/// An image of one bit a pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BitImage {
    width: usize,
    height: usize,
    /// Words of a row.
    stride: usize,
    words: Vec<u64>,
}

const BITS: usize = u64::BITS as usize;

/// The bits of a word from `from` to its end, for `from` below 64.
const fn upwards(from: usize) -> u64 {
    u64::MAX << from
}

impl BitImage {
    /// An image without a pixel set.
    #[must_use]
    pub fn new(width: usize, height: usize) -> Self {
        let stride = width.div_ceil(BITS);
        Self { width, height, stride, words: vec![0; stride * height] }
    }

    /// An image from what each pixel (x, y) is; each is asked once, row by row.
    #[must_use]
    pub fn from_fn(width: usize, height: usize, mut is_set: impl FnMut(usize, usize) -> bool) -> Self {
        let mut image = Self::new(width, height);
        for y in 0..height {
            let mut start = None;
            for x in 0..width {
                match (is_set(x, y), start) {
                    (true, None) => start = Some(x),
                    (false, Some(from)) => {
                        image.fill(y, from..x);
                        start = None;
                    }
                    _ => {}
                }
            }
            if let Some(from) = start {
                image.fill(y, from..width);
            }
        }
        image
    }

    /// Pixels of a row.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    #[must_use]
    pub const fn height(&self) -> usize {
        self.height
    }

    /// Whether a pixel is set; none outside the image is.
    #[must_use]
    pub fn get(&self, x: usize, y: usize) -> bool {
        x < self.width && y < self.height && self.words[y * self.stride + x / BITS] >> (x % BITS) & 1 == 1
    }

    /// Sets the pixels `columns` of a row; what lies outside the image is left out.
    pub fn fill(&mut self, y: usize, columns: Range<usize>) {
        let (from, to) = (columns.start, columns.end.min(self.width));
        if y >= self.height || from >= to {
            return;
        }
        let row = &mut self.words[y * self.stride..][..self.stride];
        let (first, last) = (from / BITS, (to - 1) / BITS);
        let (head, tail) = (upwards(from % BITS), !(upwards((to - 1) % BITS) << 1));
        if first == last {
            row[first] |= head & tail;
            return;
        }
        row[first] |= head;
        row[first + 1..last].fill(u64::MAX);
        row[last] |= tail;
    }

    /// Takes all pixels away.
    pub fn clear(&mut self) {
        self.words.fill(0);
    }

    /// Pixels that are set.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.words.iter().map(|word| u64::from(word.count_ones())).sum()
    }
}

/// Pixels of two images of one size by who has them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Overlap {
    /// Pixels that both have.
    pub both: u64,
    /// Only the first.
    pub first_only: u64,
    /// Only the second.
    pub second_only: u64,
}

/// Counts the pixels of two images in some rows.
///
/// # Panics
/// Where the images differ in size, or the rows lie outside them.
#[must_use]
pub fn overlap(first: &BitImage, second: &BitImage, rows: Range<usize>) -> Overlap {
    assert_eq!((first.width, first.height), (second.width, second.height), "sizes of the images");
    let words = rows.start * first.stride..rows.end * first.stride;
    let mut counts = Overlap::default();
    for (a, b) in first.words[words.clone()].iter().zip(&second.words[words]) {
        counts.both += u64::from((a & b).count_ones());
        counts.first_only += u64::from((a & !b).count_ones());
        counts.second_only += u64::from((b & !a).count_ones());
    }
    counts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_span_sets_its_pixels_and_no_other() {
        for width in [1_usize, 63, 64, 65, 130, 200] {
            for from in 0..width + 2 {
                for to in from.saturating_sub(1)..width + 3 {
                    let mut image = BitImage::new(width, 3);
                    image.fill(1, from..to);
                    let expected = (0..width).filter(|x| (from..to).contains(x)).count() as u64;
                    assert_eq!(image.count(), expected, "{from}..{to} of {width}");
                    assert!((0..width).all(|x| image.get(x, 1) == (from..to).contains(&x)), "{from}..{to} of {width}");
                }
            }
        }
        let mut image = BitImage::new(70, 2);
        image.fill(2, 0..70);
        assert_eq!(image, BitImage::new(70, 2));
        assert!(!image.get(70, 0) && !image.get(0, 2));
    }

    #[test]
    fn a_pattern_is_kept() {
        for (width, height) in [(0, 0), (0, 3), (1, 1), (63, 2), (64, 70), (131, 3)] {
            let pattern = |x: usize, y: usize| (x * x + 3 * y) % 7 < 3 || x + 1 == width;
            let mut asked = Vec::new();
            let image = BitImage::from_fn(width, height, |x, y| {
                asked.push((y, x));
                pattern(x, y)
            });
            assert!(asked.is_sorted() && asked.len() == width * height);
            assert!((0..height).all(|y| (0..width).all(|x| image.get(x, y) == pattern(x, y))));
        }
    }

    #[test]
    fn overlaps_are_counted_in_the_rows_that_are_asked_for() {
        let (mut a, mut b) = (BitImage::new(100, 4), BitImage::new(100, 4));
        for y in 0..4 {
            a.fill(y, 10..70);
            b.fill(y, 60..90 + y);
        }
        assert_eq!(overlap(&a, &b, 0..1), Overlap { both: 10, first_only: 50, second_only: 20 });
        assert_eq!(overlap(&a, &b, 1..4), Overlap { both: 30, first_only: 150, second_only: 21 + 22 + 23 });
        assert_eq!(overlap(&a, &b, 2..2), Overlap::default());
        a.clear();
        assert_eq!(a, BitImage::new(100, 4));
    }
}
