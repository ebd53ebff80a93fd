//! What a comparison found.

use super::agreement::{Agreement, Pair, agreement};
use super::clock::RivalOffset;
use super::rigid::Similarity;
use sinew_core::estimators::mean;

/// What of a reference is aligned with the result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PartsToAlign {
    /// Its clock.
    pub time: bool,
    /// Its world.
    pub space: bool,
    /// Its size.
    pub scale: bool,
}

/// The world of a reference in that of the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlignedWorlds {
    /// From the reference's world into the result's.
    pub motion: Similarity,
    /// Standard deviations of the turn about the axes of the world, degrees; `None` where it is not fitted or left open.
    pub turn_sd_deg: Option<[f64; 3]>,
    /// The same of the place of the middle of all points, metres.
    pub place_sd_m: Option<[f64; 3]>,
    /// The same of the scale.
    pub scale_sd: Option<f64>,
}

/// How a reference is aligned with a result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    /// What was aligned.
    pub parts: PartsToAlign,
    /// Time of the reference less time of the result, seconds.
    pub offset_s: f64,
    /// Its standard deviation; `None` where it is not fitted or left open.
    pub offset_sd_s: Option<f64>,
    /// Another offset that fits nearly as well.
    pub rival: Option<RivalOffset>,
    /// How long both overlap, seconds.
    pub overlap_s: f64,
    /// Length of the pieces that are taken for independent, seconds.
    pub piece_s: f64,
    /// Root mean square misfit: distance of points, metres, or difference of angles without their biases, degrees.
    pub rms: f64,
    /// Worlds, of points.
    pub worlds: Option<AlignedWorlds>,
}

/// Length of pieces of time that are taken for independent, seconds, and how many there are at least.
const PIECE_S: f64 = 1.0;
const PIECES: f64 = 10.0;

impl Alignment {
    pub(super) const fn piece_s(overlap_s: f64) -> f64 {
        PIECE_S.min(overlap_s / PIECES).max(f64::MIN_POSITIVE)
    }

    /// Whether pieces are shorter than they should be.
    #[must_use]
    pub const fn is_short(&self) -> bool {
        self.piece_s < PIECE_S
    }
}

/// A coordinate of a point, or an angle, beside the reference.
#[derive(Clone, Debug, PartialEq)]
pub struct ComparedSeries {
    /// Our name.
    pub name: String,
    /// `x`, `y` or `z` of a point.
    pub axis: Option<&'static str>,
    /// In the order of time.
    pub pairs: Vec<Pair>,
}

/// A result beside a reference.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Alignment.
    pub alignment: Alignment,
    /// Points with their axes, or angles, those that were compared.
    pub series: Vec<ComparedSeries>,
    /// How each agrees, in the order of `series`.
    pub agreements: Vec<Agreement>,
    /// All together: of points a row for each axis, of angles one.
    pub all: Vec<(Option<&'static str>, Agreement)>,
    /// Mean distance of the points, metres; `None` of angles.
    pub mean_distance_m: Option<f64>,
    /// Names of the result without a reference, and of the reference that are not used.
    pub unmatched: [Vec<String>; 2],
    /// What a reader should know of it.
    pub warnings: Vec<String>,
}

impl Comparison {
    /// Whether points are compared, and not angles.
    #[must_use]
    pub const fn is_of_points(&self) -> bool {
        self.alignment.worlds.is_some()
    }

    pub(super) fn new(
        alignment: Alignment,
        series: Vec<ComparedSeries>,
        unmatched: [Vec<String>; 2],
        warnings: Vec<String>,
    ) -> Self {
        let axes: Vec<Option<&'static str>> = match alignment.worlds {
            Some(_) => [Some("x"), Some("y"), Some("z")].to_vec(),
            None => vec![None],
        };
        let shift = |axis: Option<&str>| {
            let own = series.iter().filter(|series| series.axis == axis).flat_map(|series| &series.pairs);
            mean(&own.map(Pair::difference).collect::<Vec<_>>())
        };
        let shifts: Vec<f64> = axes.iter().map(|axis| shift(*axis)).collect();
        let shift_of = |axis: Option<&str>| axes.iter().position(|own| *own == axis).map_or(0.0, |at| shifts[at]);
        let (mut kept, mut agreements) = (vec![], vec![]);
        for series in series {
            if let Some(found) = agreement(&series.pairs, shift_of(series.axis)) {
                agreements.push(found);
                kept.push(series);
            }
        }
        let together = |axis: &Option<&'static str>| {
            let own = kept.iter().filter(|series| series.axis == *axis).flat_map(|series| series.pairs.iter().copied());
            Some((*axis, agreement(&own.collect::<Vec<_>>(), shift_of(*axis))?))
        };
        let all = axes.iter().filter_map(together).collect();
        let mean_distance_m = alignment.worlds.map(|_| mean_distance(&kept));
        Self { alignment, all, mean_distance_m, agreements, series: kept, unmatched, warnings }
    }
}

/// Mean distance of points whose axes follow each other.
fn mean_distance(series: &[ComparedSeries]) -> f64 {
    let distances = series.chunks_exact(3).flat_map(|axes| {
        (0..axes[0].pairs.len()).map(|k| axes.iter().map(|axis| axis.pairs[k].difference().powi(2)).sum::<f64>().sqrt())
    });
    mean(&distances.collect::<Vec<_>>())
}
