//! Colour histograms of a part of the body, and their similarity (Husz, Wallace & Green 2007).
//!
//! Eight bins a channel, 512 in all, normalised. With the Bhattacharyya coefficient ρ = Σ √(h r) the distance is √(1 − ρ) and the match 1 − √(1 − ρ): 1 for equal histograms, 0 for those without a common colour.

/// Bins of a histogram.
pub const BINS: usize = 512;

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
    fn bins_are_eight_a_channel() {
        assert_eq!((bin([0; 3]), bin([255; 3]), bin([32, 0, 0]), bin([31, 32, 64])), (0, 511, 64, 10));
    }
}
