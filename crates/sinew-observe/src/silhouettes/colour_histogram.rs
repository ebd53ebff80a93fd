//! Colour histograms of a part of the body, and their similarity (Husz, Wallace & Green 2007).
//!
//! Eight bins a channel, 512 in all, normalised. With the Bhattacharyya coefficient ρ = Σ √(h r) the distance is √(1 − ρ) and the match 1 − √(1 − ρ): 1 for equal histograms, 0 for those without a common colour.

/// Bins of a channel.
pub const LEVELS: usize = 8;
/// Bins of a histogram.
pub const BINS: usize = LEVELS * LEVELS * LEVELS;

/// Bin of a colour.
#[inline(always)]
#[must_use]
pub fn bin([red, green, blue]: [u8; 3]) -> usize {
    (usize::from(red >> 5) << 6) | (usize::from(green >> 5) << 3) | usize::from(blue >> 5)
}

/// Counts of colours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counts([u32; BINS]);

impl Default for Counts {
    fn default() -> Self {
        Self([0; BINS])
    }
}

impl Counts {
    /// Counts a colour.
    #[inline(always)]
    pub fn add(&mut self, colour: [u8; 3]) {
        self.0[bin(colour)] += 1;
    }

    /// Adds other counts.
    pub fn merge(&mut self, other: &Self) {
        self.0.iter_mut().zip(other.0).for_each(|(count, more)| *count += more);
    }

    /// Levels of red, green and blue, each from 0 to [`LEVELS`] − 1, with how often that colour was counted, where it was.
    pub fn levels(&self) -> impl Iterator<Item = ([u8; 3], u32)> + '_ {
        let level = |bin: usize, shift: usize| (bin >> shift & (LEVELS - 1)) as u8;
        let counted = self.0.iter().enumerate().filter(|(_, count)| **count > 0);
        counted.map(move |(bin, &count)| ([level(bin, 6), level(bin, 3), level(bin, 0)], count))
    }

    /// Counts by levels of red, green and blue; `None` with a level that is not below [`LEVELS`].
    #[must_use]
    pub fn from_levels(levels: impl IntoIterator<Item = ([u8; 3], u32)>) -> Option<Self> {
        let mut counts = Self::default();
        for (levels, count) in levels {
            if levels.iter().any(|&level| usize::from(level) >= LEVELS) {
                return None;
            }
            let [red, green, blue] = levels.map(usize::from);
            counts.0[red << 6 | green << 3 | blue] += count;
        }
        Some(counts)
    }

    /// Colours counted.
    #[must_use]
    pub fn total(&self) -> u32 {
        self.0.iter().sum()
    }

    /// The reference histogram of these counts; `None` without any.
    #[must_use]
    pub fn reference(&self) -> Option<Reference> {
        let total = self.total();
        (total > 0).then(|| Reference(self.0.map(|count| (f64::from(count) / f64::from(total)).sqrt())))
    }
}

/// Square roots of a normalised histogram.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference([f64; BINS]);

impl Reference {
    /// How well counts match it, from 0 to 1; 1 without any.
    #[inline(always)]
    #[must_use]
    pub fn matched(&self, counts: &Counts) -> f64 {
        let (mut total, mut sum) = (0, 0.0);
        for (&count, root) in counts.0.iter().zip(&self.0) {
            if count > 0 {
                total += count;
                sum += f64::from(count).sqrt() * root;
            }
        }
        if total == 0 { 1.0 } else { 1.0 - (1.0 - sum / f64::from(total).sqrt()).max(0.0).sqrt() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(colours: &[[u8; 3]]) -> Counts {
        let mut counts = Counts::default();
        colours.iter().for_each(|colour| counts.add(*colour));
        counts
    }

    #[test]
    fn equal_colours_match_and_others_do_not() {
        let red = counts(&[[255, 0, 0], [250, 10, 3]]);
        let mixed = counts(&[[255, 0, 0], [0, 0, 255]]);
        let reference = red.reference().expect("two pixels");
        assert!((reference.matched(&red) - 1.0).abs() < 1e-7);
        assert_eq!(reference.matched(&counts(&[[0, 0, 255]])), 0.0);
        assert!((reference.matched(&mixed) - (1.0 - (1.0 - 0.5_f64.sqrt()).sqrt())).abs() < 1e-12);
        assert_eq!((Counts::default().reference(), reference.matched(&Counts::default())), (None, 1.0));
    }

    #[test]
    fn counts_come_back_from_their_levels() {
        let mut counts = counts(&[[255, 0, 31], [250, 10, 3], [40, 90, 200]]);
        let levels: Vec<_> = counts.levels().collect();
        assert_eq!(levels, [([1, 2, 6], 1), ([7, 0, 0], 2)]);
        assert_eq!(Counts::from_levels(levels).as_ref(), Some(&counts));
        assert_eq!(Counts::from_levels([([0, 8, 0], 1)]), None);
        counts.merge(&counts.clone());
        assert_eq!(counts.levels().map(|(_, count)| count).collect::<Vec<_>>(), [2, 4]);
    }

    #[test]
    fn bins_are_eight_a_channel() {
        assert_eq!((bin([0; 3]), bin([255; 3]), bin([32, 0, 0]), bin([31, 32, 64])), (0, 511, 64, 10));
    }
}
