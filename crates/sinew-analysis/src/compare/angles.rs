//! Angles of a result beside angles of a reference: alignment of clocks, then pairs.
//!
//! Angles of one name have other zeros in other programs, so each has a mean square of its differences without their mean. The misfit of an offset in time is the geometric mean of these, weighted by how many values each has: the likelihood of normal errors whose size each angle has for itself, so that one that two programs see otherwise does not set the clock. Differences are those nearest to their mean direction: whole turns do not count.

use super::agreement::Pair;
use super::clock::{BestOffset, best_offset, possible, thinned};
use super::clusters::{MOST, ResidualRow, standard_deviations};
use super::estimates::Estimates;
use super::outcome::{Alignment, ComparedSeries, PartsToAlign};
use super::points::{LEAST_FRAMES, Unaligned};
use super::sampled::Sampled;
use sinew::angles::circle::{TURN_DEG, direction, near};
use sinew_core::estimators::mean;

const COARSE: usize = 300;
const FINE: usize = 4000;

/// Differences of each angle at an offset, each nearest to their mean direction, degrees: frame, ours − the reference.
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
    for series in &mut found {
        let middle = direction(series.iter().map(|(_, value)| *value), TURN_DEG);
        series.iter_mut().for_each(|(_, value)| *value = near(*value, middle, TURN_DEG));
    }
    found
}

fn centre(series: &[(usize, f64)]) -> f64 {
    mean(&series.iter().map(|(_, value)| *value).collect::<Vec<_>>())
}

/// Mean square of a series without its mean, square degrees.
fn own_square(series: &[(usize, f64)]) -> f64 {
    let centre = centre(series);
    series.iter().map(|(_, value)| (value - centre).powi(2)).sum::<f64>() / series.len() as f64
}

/// Mean square without the mean of each series; `of` of the mean square of each is what is averaged.
fn spread(series: &[Vec<(usize, f64)>], of: impl Fn(f64) -> f64) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0);
    for series in series.iter().filter(|series| !series.is_empty()) {
        sum += series.len() as f64 * of(own_square(series));
        count += series.len();
    }
    (count > 0).then(|| sum / count as f64)
}

/// Angles agree no better than they are written, square degrees.
const LEAST_SQUARE: f64 = 1e-4;

/// The misfit of an offset.
fn misfit(series: &[Vec<(usize, f64)>]) -> Option<f64> {
    spread(series, |square| square.max(LEAST_SQUARE).ln()).map(f64::exp)
}

/// Aligns a reference with a result; channels of the reference are in the order of the names of `ours`.
pub(super) fn aligned(
    ours: &Estimates<1>,
    reference: &Sampled<1>,
    parts: PartsToAlign,
) -> Result<(Alignment, Vec<ComparedSeries>), Unaligned> {
    let frames = ours.times_s.len();
    let at = |most: usize| move |offset_s: f64| misfit(&differences(ours, reference, thinned(frames, most), offset_s));
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
        rms: spread(&all, |square| square).unwrap_or(f64::NAN).sqrt(),
        worlds: None,
    };
    Ok((alignment, series(ours, &all)))
}

/// Residuals by the offset, over the standard deviation of their angle: biases of the angles are taken off both sides.
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
        let sd = own_square(series).max(LEAST_SQUARE).sqrt();
        found.extend(rated.into_iter().map(|(frame, value, rate)| {
            let mut gradient = [0.0; MOST];
            gradient[0] = (mean_rate - rate) / sd;
            let piece = ((ours.times_s[frame] - ours.times_s[0]) / piece_s) as usize;
            ResidualRow { piece, joint, residual: (value - middle) / sd, gradient }
        }));
    }
    found
}

fn series(ours: &Estimates<1>, all: &[Vec<(usize, f64)>]) -> Vec<ComparedSeries> {
    let one = |(at, differences): (usize, &Vec<(usize, f64)>)| {
        let pair = |(frame, difference): &(usize, f64)| {
            let own = &ours.series[at][*frame];
            Pair { ours: own.mean[0], reference: own.mean[0] - difference, sd: own.sd[0], sd_within: f64::NAN }
        };
        ComparedSeries { name: ours.names[at].clone(), axis: None, pairs: differences.iter().map(pair).collect() }
    };
    all.iter().enumerate().map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::super::estimates::Estimate;
    use super::*;
    use statrs::distribution::{ContinuousCDF as _, Normal};

    const ANGLES: usize = 10;
    const RATE_HZ: f64 = 60.0;

    /// Standard normal numbers by inversion of Lehmer's generator (Park and Miller 1988).
    fn normals(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state * 48_271 % 2_147_483_647;
            Normal::standard().inverse_cdf(state as f64 / 2_147_483_647.0)
        }
    }

    /// How an angle goes, degrees: the first turns round and back, the others swing.
    fn truth(angle: usize, time_s: f64) -> f64 {
        let k = angle as f64;
        if angle == 0 {
            return 150.0 + 260.0 * (0.9 * time_s).sin();
        }
        12.0 * (5.1 * time_s + 1.7 * k).sin() + 9.0 * (2.3 * time_s + 2.9 * k).cos()
    }

    fn estimates(frames: usize, value: impl Fn(usize, f64) -> f64) -> Estimates<1> {
        let times_s: Vec<f64> = (0..frames).map(|frame| frame as f64 / RATE_HZ).collect();
        let estimate = |mean: f64| Estimate { mean: [mean], sd: [1.0], sd_within: [f64::NAN] };
        let one = |angle: usize| times_s.iter().map(|time| estimate(value(angle, *time))).collect();
        let series = (0..ANGLES).map(one).collect();
        Estimates { names: (0..ANGLES).map(|angle| format!("A{angle}")).collect(), series, times_s }
    }

    /// A reference as files have it: at its own times, within half a turn, and read as `compare` reads it.
    fn reference(times_s: Vec<f64>, value: impl Fn(usize, f64) -> f64) -> Sampled<1> {
        let within = |x: f64| (x + 180.0).rem_euclid(360.0) - 180.0;
        let one = |angle: usize| {
            let values: Vec<f64> = times_s.iter().map(|time| within(value(angle, *time))).collect();
            super::super::channel(values.into_iter())
        };
        let channels = (0..ANGLES).map(one).collect();
        Sampled::new(times_s, channels)
    }

    const CLOCK: PartsToAlign = PartsToAlign { time: true, space: false, scale: false };

    /// The same angles, once continuous and once within half a turn and with another start, at another rate.
    #[test]
    fn equal_angles_are_equal_on_both_sides_of_the_cut() {
        let times: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
        let (found, series) =
            aligned(&estimates(500, truth), &reference(times, |angle, t| truth(angle, t - 0.5)), CLOCK).unwrap();
        assert!((found.offset_s - 0.5).abs() < 1e-4 && found.rms < 1e-2, "{found:?}");
        for one in &series {
            assert!(
                one.pairs.len() > 450 && one.pairs.iter().all(|pair| pair.difference().abs() < 0.1),
                "{}",
                one.name
            );
        }
    }

    /// Three angles of ten are of other definitions and go their own ways by 15°, the others err by 1° that lasts 0.2 s.
    /// The clock is within 3 ms, and its standard deviation what its errors are.
    #[test]
    fn angles_that_two_programs_see_otherwise_do_not_set_the_clock() {
        const RUNS: u64 = 40;
        let (mut square, mut standard) = (0.0, 0.0);
        for run in 1..=RUNS {
            let mut normal = normals(104_729 * run);
            let kept = (-1.0_f64 / (0.2 * RATE_HZ)).exp();
            let frames = 480;
            let errors: Vec<Vec<f64>> = (0..ANGLES)
                .map(|_| {
                    let mut error = normal();
                    let mut next = || {
                        error = kept * error + (1.0 - kept * kept).sqrt() * normal();
                        error
                    };
                    (0..frames).map(|_| next()).collect()
                })
                .collect();
            let phases: Vec<f64> = (0..ANGLES).map(|_| 10.0 * normal()).collect();
            let ours = estimates(frames, |angle, t| {
                let other = if angle >= 7 { 15.0 * (4.7 * t + phases[angle]).sin() } else { 0.0 };
                truth(angle, t) + other + errors[angle][(t * RATE_HZ).round() as usize]
            });
            let times = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
            let (found, _) = aligned(&ours, &reference(times, |angle, t| truth(angle, t - 0.317)), CLOCK).unwrap();
            let off = found.offset_s - 0.317;
            square += off * off / RUNS as f64;
            standard += (off / found.offset_sd_s.unwrap()).powi(2) / RUNS as f64;
        }
        assert!(square.sqrt() < 0.003, "{} s", square.sqrt());
        assert!((0.6..1.5).contains(&standard.sqrt()), "{} standard deviations, {} s", standard.sqrt(), square.sqrt());
    }
}
