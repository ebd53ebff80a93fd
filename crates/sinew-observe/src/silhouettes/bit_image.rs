//! Images of one bit a pixel, 64 pixels a word: silhouettes, and the shapes of a model.
//!
//! Words run down the columns: pixel (x, y) is bit y mod 64 of word y / 64 of column x; bits beyond the height are 0, so that counts need no mask. People are taller than wide, so their limbs have fewer columns than rows, and
//! most spans lie in one word or two.

use std::ops::Range;

/// An image of one bit a pixel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BitImage {
    width: usize,
    height: usize,
    /// Words of a column.
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
        let stride = height.div_ceil(BITS);
        Self { width, height, stride, words: vec![0; stride * width] }
    }

    /// An image from what each pixel (x, y) is; each is asked once, row by row.
    #[must_use]
    pub fn from_fn(width: usize, height: usize, mut is_set: impl FnMut(usize, usize) -> bool) -> Self {
        let mut image = Self::new(width, height);
        for y in 0..height {
            for x in 0..width {
                if is_set(x, y) {
                    image.words[x * image.stride + y / BITS] |= 1 << (y % BITS);
                }
            }
        }
        image
    }

    /// Columns.
    #[must_use]
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Pixels of a column.
    #[must_use]
    pub const fn height(&self) -> usize {
        self.height
    }

    /// Whether a pixel is set; none outside the image is.
    #[inline(always)]
    #[must_use]
    pub fn get(&self, x: usize, y: usize) -> bool {
        x < self.width && y < self.height && self.words[x * self.stride + y / BITS] >> (y % BITS) & 1 == 1
    }

    /// [`BitImage::get`] for a pixel that is known to be in the image.
    #[inline(always)]
    pub(crate) fn is_set_inside(&self, x: usize, y: usize) -> bool {
        self.words.get(x * self.stride + y / BITS).is_some_and(|word| word >> (y % BITS) & 1 == 1)
    }

    /// Sets the pixels `rows` of a column; what lies outside the image is left out.
    #[inline(always)]
    pub fn fill(&mut self, x: usize, rows: Range<usize>) {
        let (from, to) = (rows.start, rows.end.min(self.height));
        if x >= self.width || from >= to {
            return;
        }
        let column = &mut self.words[x * self.stride..][..self.stride];
        let (first, last) = (from / BITS, (to - 1) / BITS);
        let (head, tail) = (upwards(from % BITS), !(upwards((to - 1) % BITS) << 1));
        if first == last {
            column[first] |= head & tail;
            return;
        }
        column[first] |= head;
        column[first + 1..last].fill(u64::MAX);
        column[last] |= tail;
    }

    /// Takes all pixels of some columns away; what lies outside the image is left out.
    #[inline(always)]
    pub fn clear(&mut self, columns: Range<usize>) {
        let end = columns.end.min(self.width);
        self.words[columns.start.min(end) * self.stride..end * self.stride].fill(0);
    }

    /// Columns and rows of the smallest rectangle that holds all pixels that are set; `None` without any.
    #[must_use]
    pub fn bounds(&self) -> Option<[Range<usize>; 2]> {
        let columns = self.words.chunks_exact(self.stride.max(1));
        let is_used = |column: &&[u64]| column.iter().any(|word| *word != 0);
        let first = columns.clone().position(|column| is_used(&column))?;
        let last = columns.clone().rposition(|column| is_used(&column))?;
        let mut all = vec![0; self.stride];
        for column in columns {
            all.iter_mut().zip(column).for_each(|(all, word)| *all |= word);
        }
        let top = all.iter().position(|word| *word != 0)?;
        let bottom = all.iter().rposition(|word| *word != 0)?;
        let rows = [
            top * BITS + all[top].trailing_zeros() as usize,
            (bottom + 1) * BITS - all[bottom].leading_zeros() as usize,
        ];
        Some([first..last + 1, rows[0]..rows[1]])
    }

    /// Pixels that are set in a rectangle that lies in the image.
    #[inline(always)]
    #[must_use]
    pub fn count_inside(&self, columns: Range<usize>, rows: Range<usize>) -> u64 {
        if columns.is_empty() || rows.is_empty() {
            return 0;
        }
        let (first, last) = (rows.start / BITS, (rows.end - 1) / BITS);
        let (head, tail) = (upwards(rows.start % BITS), !(upwards((rows.end - 1) % BITS) << 1));
        let mut count = 0;
        for column in self.words[columns.start * self.stride..columns.end * self.stride].chunks_exact(self.stride) {
            if first == last {
                count += u64::from((column[first] & head & tail).count_ones());
                continue;
            }
            count += u64::from((column[first] & head).count_ones() + (column[last] & tail).count_ones());
            for word in &column[first + 1..last] {
                count += u64::from(word.count_ones());
            }
        }
        count
    }

    /// Takes the size of another image, with no pixel set, where it has another size.
    #[inline(always)]
    pub(crate) fn fit(&mut self, other: &Self) {
        if (self.width, self.height) != (other.width, other.height) {
            *self = Self::new(other.width, other.height);
        }
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

impl core::iter::Sum for Overlap {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        let add = |a: Self, b: Self| Self {
            both: a.both + b.both,
            first_only: a.first_only + b.first_only,
            second_only: a.second_only + b.second_only,
        };
        all.fold(Self::default(), add)
    }
}

/// Counts the pixels of two images in some columns.
///
/// # Panics
/// Where the images differ in size, or the columns lie outside them.
#[inline(always)]
#[must_use]
pub fn overlap(first: &BitImage, second: &BitImage, columns: Range<usize>) -> Overlap {
    assert_eq!((first.width, first.height), (second.width, second.height), "sizes of the images");
    let words = columns.start * first.stride..columns.end * first.stride;
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
        for height in [1_usize, 63, 64, 65, 130, 200] {
            for from in 0..height + 2 {
                for to in from.saturating_sub(1)..height + 3 {
                    let mut image = BitImage::new(3, height);
                    image.fill(1, from..to);
                    let expected = (0..height).filter(|y| (from..to).contains(y)).count() as u64;
                    assert_eq!(image.count(), expected, "{from}..{to} of {height}");
                    assert!(
                        (0..height).all(|y| image.get(1, y) == (from..to).contains(&y)),
                        "{from}..{to} of {height}"
                    );
                    assert_eq!(image, BitImage::from_fn(3, height, |x, y| x == 1 && (from..to).contains(&y)));
                }
            }
        }
        let mut image = BitImage::new(2, 70);
        image.fill(2, 0..70);
        assert_eq!(image, BitImage::new(2, 70));
        assert!(!image.get(0, 70) && !image.get(2, 0));
    }

    #[test]
    fn pixels_are_counted_in_a_rectangle() {
        let image = BitImage::from_fn(6, 200, |x, y| (3 * x + 7 * y) % 5 < 2);
        for columns in [0..6, 2..3, 1..5, 4..4] {
            for rows in [0..200, 63..64, 64..65, 10..20, 60..70, 5..190, 128..200, 9..9] {
                let inside = |x: usize, y: usize| columns.contains(&x) && rows.contains(&y) && image.get(x, y);
                let expected = (0..6).flat_map(|x| (0..200).map(move |y| (x, y))).filter(|&(x, y)| inside(x, y));
                assert_eq!(
                    image.count_inside(columns.clone(), rows.clone()),
                    expected.count() as u64,
                    "{columns:?}, {rows:?}"
                );
            }
        }
    }

    #[test]
    fn bounds_hold_all_pixels_and_no_more() {
        assert_eq!(BitImage::new(9, 200).bounds(), None);
        for (columns, rows) in [(0..1, 0..1), (2..5, 63..65), (8..9, 199..200), (1..7, 64..128), (3..4, 10..190)] {
            let image = BitImage::from_fn(9, 200, |x, y| columns.contains(&x) && rows.contains(&y));
            assert_eq!(image.bounds(), Some([columns.clone(), rows.clone()]));
        }
        let corners = BitImage::from_fn(9, 200, |x, y| (x, y) == (7, 3) || (x, y) == (1, 150));
        assert_eq!(corners.bounds(), Some([1..8, 3..151]));
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
    fn overlaps_are_counted_in_the_columns_that_are_requested() {
        let (mut a, mut b) = (BitImage::new(4, 100), BitImage::new(4, 100));
        for x in 0..4 {
            a.fill(x, 10..70);
            b.fill(x, 60..90 + x);
        }
        assert_eq!(overlap(&a, &b, 0..1), Overlap { both: 10, first_only: 50, second_only: 20 });
        assert_eq!(overlap(&a, &b, 1..4), Overlap { both: 30, first_only: 150, second_only: 21 + 22 + 23 });
        assert_eq!(overlap(&a, &b, 2..2), Overlap::default());
        a.clear(1..9);
        assert_eq!((a.count(), a.get(0, 20), a.get(3, 20)), (60, true, false));
        a.clear(0..4);
        assert_eq!(a, BitImage::new(4, 100));
    }
}
