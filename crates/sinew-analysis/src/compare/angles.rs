//! Angles of a result beside angles of a reference: alignment of clocks, then pairs.
//!
//! Angles of one name have other zeros in other programs, so the misfit of an offset in time is the mean square of the differences without the mean of each angle. Whole turns between the two are taken off.

use super::agreement::Pair;
use super::clock::{BestOffset, best_offset, possible, thinned};
use super::clusters::{MOST, ResidualRow, standard_deviations};
use super::estimates::Estimates;
use super::outcome::{Alignment, ComparedSeries, PartsToAlign};
use super::points::{LEAST_FRAMES, Unaligned};
use super::sampled::Sampled;
use sinew_core::estimators::mean;

const COARSE: usize = 300;
const FINE: usize = 4000;

/// Differences of each angle at an offset: frame, ours − the reference.
fn differences(
    ours: &Estimates<1>,
    reference: &Sampled<1>,
    frames: impl Iterator<Item = usize>,
    offset_s: f64,
) -> Vec<Vec<(usize, f64)>> {
    let mut found = vec![vec![]; ours.names.len()];
    for frame in frames {
        let values = reference.at(ours.times_s[frame] + offset_s);
        for ((series, value), found) in ours.series.iter().zip(values).zip(&mut found) {
            let mean = series[frame].mean[0];
            if let Some([value]) = value.filter(|_| mean.is_finite()) {
                found.push((frame, mean - value));
            }
        }
    }
    found
}

fn centre(series: &[(usize, f64)]) -> f64 {
    mean(&series.iter().map(|(_, value)| *value).collect::<Vec<_>>())
}

/// Mean square without the mean of each series.
fn spread(series: &[Vec<(usize, f64)>]) -> Option<f64> {
    let (mut square, mut count) = (0.0, 0);
    for series in series.iter().filter(|series| !series.is_empty()) {
        let centre = centre(series);
        square += series.iter().map(|(_, value)| (value - centre).powi(2)).sum::<f64>();
        count += series.len();
    }
    (count > 0).then(|| square / count as f64)
}

/// Aligns a reference with a result; channels of the reference are in the order of the names of `ours`.
pub(super) fn aligned(
    ours: &Estimates<1>,
    reference: &Sampled<1>,
    parts: PartsToAlign,
) -> Result<(Alignment, Vec<ComparedSeries>), Unaligned> {
    let frames = ours.times_s.len();
    let at = |most: usize| move |offset_s: f64| spread(&differences(ours, reference, thinned(frames, most), offset_s));
    let found = if parts.time {
        best_offset(possible(ours.ends_s(), reference.ends_s()), at(COARSE), at(FINE))
    } else {
        Some(BestOffset { offset_s: 0.0, rival: None })
    };
    let found = found.ok_or(Unaligned::Frames(0))?;
    let all = differences(ours, reference, 0..frames, found.offset_s);
    let mut seen: Vec<usize> = all.iter().flatten().map(|(frame, _)| *frame).collect();
    seen.sort_unstable();
    seen.dedup();
    if seen.len() < LEAST_FRAMES {
        return Err(Unaligned::Frames(seen.len()));
    }
    let overlap_s = ours.times_s[seen[seen.len() - 1]] - ours.times_s[seen[0]];
    let piece_s = Alignment::piece_s(overlap_s);
    let rows = rows(ours, reference, &all, found.offset_s, piece_s);
    let sd = if parts.time { standard_deviations(&rows, 1) } else { None };
    let alignment = Alignment {
        parts,
        offset_s: found.offset_s,
        offset_sd_s: sd.map(|sd| sd[0]),
        rival: found.rival,
        overlap_s,
        piece_s,
        rms: spread(&all).unwrap_or(f64::NAN).sqrt(),
        worlds: None,
    };
    Ok((alignment, series(ours, &all)))
}

/// Residuals by the offset: biases of the angles are taken off both sides.
fn rows(
    ours: &Estimates<1>,
    reference: &Sampled<1>,
    all: &[Vec<(usize, f64)>],
    offset_s: f64,
    piece_s: f64,
) -> Vec<ResidualRow> {
    let mut found = vec![];
    for (joint, series) in all.iter().enumerate().filter(|(_, series)| !series.is_empty()) {
        let rate = |frame: usize| reference.rate_at(ours.times_s[frame] + offset_s)[joint].map(|[rate]| rate);
        let rated: Vec<(usize, f64, f64)> =
            series.iter().filter_map(|(frame, value)| Some((*frame, *value, rate(*frame)?))).collect();
        let (middle, mean_rate) = (centre(series), mean(&rated.iter().map(|(_, _, rate)| *rate).collect::<Vec<_>>()));
        found.extend(rated.into_iter().map(|(frame, value, rate)| {
            let mut gradient = [0.0; MOST];
            gradient[0] = mean_rate - rate;
            let piece = ((ours.times_s[frame] - ours.times_s[0]) / piece_s) as usize;
            ResidualRow { piece, joint, residual: value - middle, gradient }
        }));
    }
    found
}

fn series(ours: &Estimates<1>, all: &[Vec<(usize, f64)>]) -> Vec<ComparedSeries> {
    let one = |(at, differences): (usize, &Vec<(usize, f64)>)| {
        let turns = 360.0 * (centre(differences) / 360.0).round();
        let pair = |(frame, difference): &(usize, f64)| {
            let own = &ours.series[at][*frame];
            let reference = own.mean[0] - (difference - turns);
            Pair { ours: own.mean[0], reference, sd: own.sd[0], sd_within: f64::NAN }
        };
        ComparedSeries { name: ours.names[at].clone(), axis: None, pairs: differences.iter().map(pair).collect() }
    };
    all.iter().enumerate().map(one).collect()
}
