//! How much of an image a body explains: the weighting functions of the papers. Their arguments were looked up at the measurement points of its solids.

use crate::silhouettes::bit_image::Overlap;
use crate::silhouettes::measurement::{EDGE_POINTS, Hiding, PointTally, REGION_POINTS};

/// A weighting function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ImageScore {
    /// Deutscher, Blake & Reid (2000): log w = −κ Σ_c (E_e + E_r), where E_e and E_r are the means of (1 − p)² over the edge points in the edge map and over the region points in the silhouette. Hidden points are left out, points
    /// out of the image count as 1.
    DeutscherReid {
        /// Factor κ: 1 in the paper, where annealing finds the exponents; some 100 for a likelihood.
        kappa: f64,
        /// With a, E_r is the mismatch of the silhouettes in both directions (Sigal, Balan & Black 2010): (1 − a) B/(B + Y) + a R/(R + Y) with the pixels B of the silhouette alone, R of the body alone and Y of both.
        bidirectional: Option<f64>,
    },
    /// The coarse-to-fine tracker, eq. 3: log p = −½ Σ_c (E_e/σ_g² + E_r/σ_r²) with the contour of the whole body. It says nothing of pixels of the silhouette that the body leaves uncovered.
    CoarseToFine {
        /// Standard deviation σ_g of a miss at an edge.
        sigma_edge: f64,
        /// Standard deviation σ_r of a miss in the region.
        sigma_region: f64,
    },
    /// Husz, Wallace & Green (2007), eq. 9: log λ = Σ_c Σ_i R_i log M_i over the solids i, with the mean R_i over the cues of the share of points that are seen and the mean M_i of the share of those that match.
    Parts,
}

/// Least M_i.
const LEAST_MATCH: f64 = 1e-3;

/// What was looked up of one solid, or of several together, in one view.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Looked {
    /// In the silhouette.
    pub region: PointTally,
    /// In the edge map, if there is one.
    pub edges: Option<PointTally>,
    /// Match of the colours, if they are used.
    pub colour: Option<f64>,
}

impl ImageScore {
    /// What hides measurement points.
    #[must_use]
    pub const fn hiding(&self) -> Hiding {
        match self {
            Self::DeutscherReid { .. } | Self::Parts => Hiding::Nearer,
            Self::CoarseToFine { .. } => Hiding::Others,
        }
    }

    /// Whether it compares colours.
    #[must_use]
    pub const fn compares_colours(&self) -> bool {
        matches!(self, Self::Parts)
    }

    /// Whether it counts the pixels of whole silhouettes.
    #[must_use]
    pub const fn counts_pixels(&self) -> bool {
        matches!(self, Self::DeutscherReid { bidirectional: Some(_), .. })
    }

    /// Log weight of one solid in one view. One of which nothing is seen there weighs nothing.
    #[inline(always)]
    #[must_use]
    pub fn score_part(&self, part: &Looked) -> f64 {
        let edges = part.edges.map_or(0.0, |edges| edges.mean_or(0.0));
        match *self {
            Self::Parts => log_match(part),
            _ => self.score_means(edges, part.region.mean_or(0.0)),
        }
    }

    #[inline(always)]
    fn score_means(&self, edges: f64, region: f64) -> f64 {
        match *self {
            Self::DeutscherReid { kappa, .. } => -kappa * (edges + region),
            Self::CoarseToFine { sigma_edge, sigma_region } => {
                -0.5 * (edges / (sigma_edge * sigma_edge) + region / (sigma_region * sigma_region))
            }
            Self::Parts => 0.0,
        }
    }

    /// Log weight of all solids in one view, with the pixels of the silhouette and of the body where they are counted. A body of which nothing is seen misses everything: to leave the view is no way out.
    #[inline(always)]
    #[must_use]
    pub fn score_view(&self, parts: &[Looked], pixels: Option<Overlap>) -> f64 {
        if *self == Self::Parts {
            return parts.iter().map(log_match).sum();
        }
        let mut all = Looked::default();
        for part in parts {
            all.region.add(part.region);
            if let Some(edges) = part.edges {
                all.edges.get_or_insert_default().add(edges);
            }
        }
        let edges = all.edges.map_or(0.0, |edges| edges.mean_or(1.0));
        let region = match (self, pixels) {
            (Self::DeutscherReid { bidirectional: Some(a), .. }, Some(pixels)) => mismatch(pixels, *a),
            _ => all.region.mean_or(1.0),
        };
        self.score_means(edges, region)
    }
}

/// R log M of a solid.
#[inline(always)]
fn log_match(part: &Looked) -> f64 {
    let (mut cues, mut relevance, mut matched) = (1.0, 0.0, 0.0);
    let mut add = |points: u32, of: usize, hit: f64| {
        relevance += f64::from(points) / of as f64;
        matched += hit;
    };
    let hits = |tally: PointTally| match tally.inside {
        0 => 1.0,
        inside => 1.0 - tally.misses / f64::from(inside),
    };
    add(part.region.inside, REGION_POINTS, hits(part.region));
    if let Some(edges) = part.edges {
        cues += 1.0;
        add(edges.inside, EDGE_POINTS, hits(edges));
    }
    if let Some(colour) = part.colour {
        cues += 1.0;
        add(part.region.inside, REGION_POINTS, colour);
    }
    relevance / cues * (matched / cues).max(LEAST_MATCH).ln()
}

/// (1 − a) B/(B + Y) + a R/(R + Y). A silhouette without pixels misses nothing; a body without any explains nothing.
#[inline(always)]
fn mismatch(silhouette_and_body: Overlap, a: f64) -> f64 {
    let Overlap { both, first_only, second_only } = silhouette_and_body;
    let share = |part: u64, of: u64, otherwise: f64| if of > 0 { part as f64 / of as f64 } else { otherwise };
    (1.0 - a) * share(first_only, first_only + both, 0.0) + a * share(second_only, second_only + both, 1.0)
}

/// Share of the body's pixels that are the silhouette's, 0 for a body without any; and share of the silhouette's that are the body's, 1 for a silhouette without any.
#[must_use]
pub fn precision_and_recall(silhouette_and_body: Overlap) -> [f64; 2] {
    let Overlap { both, first_only, second_only } = silhouette_and_body;
    let share = |of: u64, otherwise: f64| if of > 0 { both as f64 / of as f64 } else { otherwise };
    [share(both + second_only, 0.0), share(both + first_only, 1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tally(inside: u32, outside: u32, misses: f64) -> PointTally {
        PointTally { inside, outside, misses }
    }

    #[test]
    fn scores_are_the_formulas() {
        let part = Looked { region: tally(40, 10, 5.0), edges: Some(tally(16, 0, 4.0)), colour: None };
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} for {b}");
        let (edges, region) = (0.25, 15.0 / 50.0);
        let reid = ImageScore::DeutscherReid { kappa: 3.0, bidirectional: None };
        close(reid.score_part(&part), -3.0 * (edges + region));
        let fine = ImageScore::CoarseToFine { sigma_edge: 0.2, sigma_region: 0.5 };
        close(fine.score_part(&part), -0.5 * (edges / 0.04 + region / 0.25));
        let relevance = 0.5 * (40.0 / 60.0 + 16.0 / 24.0);
        let matched = 0.5 * ((1.0 - 5.0 / 40.0) + (1.0 - 4.0 / 16.0));
        close(ImageScore::Parts.score_part(&part), relevance * f64::ln(matched));
        let other = Looked { region: tally(10, 0, 10.0), edges: None, colour: None };
        close(reid.score_view(&[part, other], None), -3.0 * (edges + 25.0 / 60.0));
        close(reid.score_view(&[Looked::default()], None), -3.0);
        close(
            ImageScore::Parts.score_view(&[part, other], None),
            relevance * f64::ln(matched) + 10.0 / 60.0 * LEAST_MATCH.ln(),
        );
    }

    /// Relevance of a part (K13): a solid of which nothing is seen says nothing.
    #[test]
    fn what_is_hidden_has_no_weight() {
        let hidden = Looked { region: tally(0, 0, 0.0), edges: Some(tally(0, 0, 0.0)), colour: Some(1.0) };
        assert_eq!(ImageScore::Parts.score_part(&hidden), 0.0);
    }

    #[test]
    fn silhouettes_are_compared_in_both_directions() {
        let both = ImageScore::DeutscherReid { kappa: 2.0, bidirectional: Some(0.25) };
        let pixels = Overlap { both: 30, first_only: 10, second_only: 20 };
        let value = both.score_view(&[], Some(pixels));
        assert!((value + 2.0 * (0.75 * 0.25 + 0.25 * 0.4)).abs() < 1e-12, "{value}");
        assert_eq!(mismatch(Overlap::default(), 0.5), 0.5);
        assert_eq!(mismatch(Overlap { first_only: 9, ..Overlap::default() }, 0.5), 1.0);
        let [precision, recall] = precision_and_recall(pixels);
        assert!((precision - 0.6).abs() < 1e-12 && (recall - 0.75).abs() < 1e-12);
        assert_eq!(precision_and_recall(Overlap { first_only: 3, ..Overlap::default() }), [0.0, 0.0]);
    }
}
