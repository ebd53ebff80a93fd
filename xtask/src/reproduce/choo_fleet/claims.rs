//! The paper's claims CF1–CF10, judged by criteria that were fixed before any run.
//!
//! Costs are counted in likelihood evaluations, a gradient as c_g of them (measured); wall times on one thread stand beside them in the files ([`super::tables`]).

use super::chains::Variant;
use super::curves::{At, Axis, Cell, Ratio, curve, ratio, slope, volumes};
use super::multi::SHOWN;
use super::problem::{MODELS, Model};
use super::scene::Source;
use super::store::{Store, numbers};
use super::{MULTI, Outcome, Study, filters, multi_key};
use crate::reproduce::claim::Claim;
use sinew::core::random::Stage;
use std::fmt::Write as _;

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => sorted[n / 2],
        n => 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]),
    }
}

fn range(values: &[f64], digits: usize) -> String {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    format!("{low:.digits$}–{high:.digits$}")
}

/// Geometric mean of ratios over frames with the 95 % interval that follows from those of the frames.
pub(super) fn over_frames(ratios: &[Ratio]) -> [f64; 3] {
    let logs: Vec<f64> = ratios.iter().map(|r| r.value.ln()).collect();
    let variance = |r: &Ratio| ((r.interval[1] / r.interval[0]).ln() / (2.0 * 1.96)).powi(2);
    let error = ratios.iter().map(variance).sum::<f64>().sqrt() / ratios.len() as f64;
    let middle = mean(&logs);
    [middle, middle - 1.96 * error, middle + 1.96 * error].map(f64::exp)
}

/// A ratio with three significant digits.
fn shown(x: f64) -> String {
    if x >= 100.0 { format!("{x:.0}") } else { format!("{x:.2}") }
}

/// Curves of the particles and of one variant in every frame of a model.
fn curves(
    study: &Study,
    store: &Store,
    source: Source,
    model: usize,
    variant: Variant,
) -> Outcome<Vec<[Vec<Cell>; 2]>> {
    let of = |&frame: &usize| {
        let model = &MODELS[model];
        Ok([
            curve(study, store, source, frame, model, None)?,
            curve(study, store, source, frame, model, Some(variant))?,
        ])
    };
    study.size.frames.iter().map(of).collect()
}

/// Ratios of cost, particles over chains, of every frame.
pub(super) fn ratios(
    study: &Study,
    store: &Store,
    source: Source,
    model: usize,
    variant: Variant,
    axis: Axis,
    at: At,
) -> Outcome<Vec<Ratio>> {
    let stage = Stage::new(study.seed, "choo-fleet bootstrap");
    let all = curves(study, store, source, model, variant)?;
    Ok(all.iter().map(|[particles, chains]| ratio(particles, chains, axis, at, &stage)).collect())
}

fn single_claims(study: &Study, store: &Store, claims: &mut Vec<Claim>) -> Outcome<()> {
    let full = study.size.doublings.len() == 7;
    let main = Source::Recorded;
    let other_ratios = |model: usize, at: At| -> Outcome<String> {
        let mut text = String::new();
        for &variant in study.size.variants.iter().filter(|v| **v != Variant::Paper) {
            let [middle, ..] = over_frames(&ratios(study, store, main, model, variant, Axis::Units, at)?);
            let _ = write!(text, "; {}: {}", variant.name(), shown(middle));
        }
        let [middle, ..] = over_frames(&ratios(study, store, main, model, Variant::Paper, Axis::Seconds, at)?);
        let _ = write!(text, "; by wall time: {}", shown(middle));
        Ok(text)
    };

    let arm = ratios(study, store, main, 0, Variant::Paper, Axis::Units, At::Common)?;
    let inverse: Vec<f64> = arm.iter().map(|r| 1.0 / r.value).collect();
    let inside = inverse.iter().filter(|r| (1.5..=40.0).contains(*r)).count();
    claims.push(Claim {
        id: "CF1",
        paper: "4-D: the particle filter is about 8 times faster at equal variance",
        ours: format!(
            "hmc/pf {} (geometric mean {}), {inside} of {} frames inside{}",
            range(&inverse, 2),
            shown(1.0 / over_frames(&arm)[0]),
            inverse.len(),
            other_ratios(0, At::Common)?.replace(": ", ", pf/hmc: ")
        ),
        criterion: "hmc/pf in 1.5–40 on at least 4 of 6 frames",
        pass: full && inside >= 4,
        direction: over_frames(&arm)[0] < 1.0,
    });

    let lower = ratios(study, store, main, 1, Variant::Paper, Axis::Units, At::Common)?;
    let [middle, low, high] = over_frames(&lower);
    claims.push(Claim {
        id: "CF2",
        paper: "10-D: hmc is about 50 times faster",
        ours: format!(
            "pf/hmc {} (95 %: {}–{}){}",
            shown(middle),
            shown(low),
            shown(high),
            other_ratios(1, At::Common)?
        ),
        criterion: "pf/hmc at least 5, lower bound above 1",
        pass: middle >= 5.0 && low > 1.0,
        direction: middle > 1.0,
    });

    if full {
        let whole = ratios(study, store, main, 2, Variant::Paper, Axis::Units, At::Extrapolated)?;
        let [middle, low, high] = over_frames(&whole);
        claims.push(Claim {
            id: "CF3",
            paper: "28-D: hmc is more than 2000 times faster (extrapolated)",
            ours: format!(
                "pf/hmc {} (95 %: {}–{}){}",
                shown(middle),
                shown(low),
                shown(high),
                other_ratios(2, At::Extrapolated)?
            ),
            criterion: "pf/hmc at least 200, extrapolated by 1/N from N = 1 728 000",
            pass: middle >= 200.0,
            direction: middle > 1.0,
        });
        let all = curves(study, store, main, 2, Variant::Paper)?;
        let effective: Vec<f64> = all.iter().map(|[particles, _]| particles[4].effective).collect();
        let fall: Vec<f64> = all.iter().map(|[p, _]| (p[6].log_mean() - p[0].log_mean()).exp()).collect();
        claims.push(Claim {
            id: "CF4",
            paper: "28-D: the particle filter's variance hardly falls with N, its effective number is near 1",
            ours: format!(
                "effective number at N = 432 000: median {:.1} ({}); v(1728k)/v(27k): median {:.2} ({})",
                median(&effective),
                range(&effective, 1),
                median(&fall),
                range(&fall, 2)
            ),
            criterion: "median effective number below 10; ratio of variances above 0.2",
            pass: median(&effective) < 10.0 && median(&fall) > 0.2,
            direction: median(&effective) < 100.0,
        });
    }

    let mut by_det = vec![];
    let mut by_sd = vec![];
    for model in MODELS {
        let sd = model.walk(study.isa)?.sd().to_vec();
        let of = |&frame: &usize| volumes(store, main, frame, &model, &sd);
        let found = study.size.frames.iter().map(of).collect::<Outcome<Vec<[f64; 2]>>>()?;
        by_sd.push(found.iter().map(|v| v[0]).collect::<Vec<f64>>());
        by_det.push(found.iter().map(|v| v[1]).collect::<Vec<f64>>());
    }
    let bounds = [0.8..=2.5, 3.0..=6.0, 8.5..=14.5];
    let inside = by_det.iter().zip(&bounds).all(|(values, bound)| values.iter().all(|v| bound.contains(v)));
    let line = |i: usize| by_det[0][i] + (by_det[1][i] - by_det[0][i]) / 6.0 * 24.0;
    let misses: Vec<f64> = (0..by_det[0].len()).map(|i| line(i) - by_det[2][i]).collect();
    let means: Vec<f64> = by_det.iter().map(|v| mean(v)).collect();
    claims.push(Claim {
        id: "CF5",
        paper: "the bound on N by volumes is 10² (4-D), 10⁵ (10-D), 10¹³ (28-D, extrapolated)",
        ours: format!(
            "log10 by determinants {}, {}, {}; by standard deviations {}, {}, {}; extrapolated minus measured {}",
            range(&by_det[0], 1),
            range(&by_det[1], 1),
            range(&by_det[2], 1),
            range(&by_sd[0], 1),
            range(&by_sd[1], 1),
            range(&by_sd[2], 1),
            range(&misses, 1)
        ),
        criterion: "log10 in 0.8–2.5, 3–6, 8.5–14.5; line through 4-D and 10-D within 3 decades at 28-D",
        pass: inside && misses.iter().all(|miss| miss.abs() <= 3.0),
        direction: means[0] < means[1] && means[1] < means[2],
    });

    if full {
        let slopes: Vec<f64> = (0..3)
            .map(|model| {
                let all = curves(study, store, main, model, Variant::Paper)?;
                Ok(mean(&all.iter().map(|[_, chains]| slope(study, chains)).collect::<Vec<_>>()))
            })
            .collect::<Outcome<_>>()?;
        claims.push(Claim {
            id: "CF6",
            paper: "the variance of hmc falls as 1/R",
            ours: format!("slopes {:.2}, {:.2}, {:.2}", slopes[0], slopes[1], slopes[2]),
            criterion: "slope of log variance against log R in −1.3 to −0.7 from R = 32, in all three",
            pass: slopes.iter().all(|s| (-1.3..=-0.7).contains(s)),
            direction: slopes.iter().all(|s| *s < 0.0),
        });
        let signs: Vec<usize> = (0..3)
            .map(|model| {
                let at = if model == 2 { At::Extrapolated } else { At::Common };
                let all = ratios(study, store, main, model, Variant::Paper, Axis::Units, at)?;
                Ok(all.iter().filter(|r| r.value > 1.0).count())
            })
            .collect::<Outcome<_>>()?;
        let frames = study.size.frames.len();
        claims.push(Claim {
            id: "CF7",
            paper: "geometric means behave like single variables: the comparison has the same sign everywhere",
            ours: format!(
                "frames with hmc ahead: {} (4-D), {} (10-D), {} (28-D) of {frames}",
                signs[0], signs[1], signs[2]
            ),
            criterion: "the same sign on all frames",
            pass: signs.iter().all(|s| *s == 0 || *s == frames),
            direction: true,
        });
        let mut own = vec![];
        let mut others = vec![];
        for model in 0..3 {
            for (i, [_, chains]) in curves(study, store, main, model, Variant::Paper)?.iter().enumerate() {
                let rejection = 100.0 * (1.0 - chains.last().map_or(f64::NAN, |cell| cell.acceptance));
                if i == 0 { own.push(rejection) } else { others.push(rejection) }
            }
        }
        claims.push(Claim {
            id: "CF9",
            paper: "step sizes are tuned to about 15 % rejection",
            ours: format!("tuning frame {} %, other frames {} %", range(&own, 0), range(&others, 0)),
            criterion: "10–20 % on the tuning frame, 5–35 % on the others",
            pass: own.iter().all(|r| (10.0..=20.0).contains(r)) && others.iter().all(|r| (5.0..=35.0).contains(r)),
            direction: true,
        });
    }
    Ok(())
}

/// Mean and z of a difference that is zero if nothing is different.
fn paired(differences: &[f64]) -> [f64; 2] {
    let n = differences.len() as f64;
    let middle = mean(differences);
    let spread = differences.iter().map(|d| (d - middle).powi(2)).sum::<f64>() / (n - 1.0);
    [middle, middle / (spread / n).sqrt()]
}

/// A series of each noise draw for both filters of a model: hmc, then particles.
pub(super) fn series(
    study: &Study,
    store: &Store,
    source: Source,
    index: usize,
    name: &str,
) -> Outcome<[Vec<Vec<f64>>; 2]> {
    let (model, both) = filters(store, index)?;
    let of = |filter: &super::multi::Filter| -> Outcome<Vec<Vec<f64>>> {
        let run = |noise| {
            let key = multi_key(source, &model, filter, noise);
            Ok(numbers(&store.get(&key).ok_or(format!("the cell {key} is missing"))?[name]))
        };
        (0..study.size.noises).map(run).collect()
    };
    Ok([of(&both[0])?, of(&both[1])?])
}

/// What both filters reach over frames, from markers of one source.
struct OverFrames {
    told: String,
    errors: String,
    /// Whether hmc is ahead with z > 3 in every likelihood and prior, and in every error.
    higher: bool,
    nearer: bool,
}

fn over_all_frames(study: &Study, store: &Store, source: Source) -> Outcome<OverFrames> {
    let mut told = vec![];
    let (mut higher, mut nearer, mut errors) = (true, true, vec![]);
    for index in 0..MULTI.len() {
        let dim = MODELS[MULTI[index].0].dim;
        for (name, words) in [("log_likelihood", "log likelihood"), ("log_prior", "log prior")] {
            let [hmc, particles] = series(study, store, source, index, name)?;
            let late = |run: &Vec<f64>| mean(&run[4..]);
            let differences: Vec<f64> = hmc.iter().zip(&particles).map(|(a, b)| late(a) - late(b)).collect();
            let [middle, z] = paired(&differences);
            higher &= middle > 0.0 && z > 3.0;
            told.push(format!("{dim}-D {words} {middle:+.1} (z = {z:.1})"));
        }
        let [hmc, particles] = series(study, store, source, index, "error_m")?;
        let differences: Vec<f64> = hmc.iter().zip(&particles).map(|(a, b)| b[SHOWN - 1] - a[SHOWN - 1]).collect();
        let [_, z] = paired(&differences);
        let of = |all: &[Vec<f64>]| 1e3 * mean(&all.iter().map(|run| run[SHOWN - 1]).collect::<Vec<_>>());
        nearer &= z > 3.0;
        errors.push(format!("{dim}-D {:.1} mm against {:.1} mm (z = {z:.1})", of(&hmc), of(&particles)));
    }
    Ok(OverFrames { told: told.join(", "), errors: errors.join(", "), higher, nearer })
}

fn multi_claims(study: &Study, store: &Store, claims: &mut Vec<Claim>) -> Outcome<()> {
    let main = over_all_frames(study, store, Source::Recorded)?;
    let control = over_all_frames(study, store, Source::Fitted)?;
    claims.push(Claim {
        id: "CF8",
        paper: "over 25 frames hmc has the higher log likelihood of the mean and log prior of the truth",
        ours: format!("hmc − pf: {}; with markers of the fitted body: {}", main.told, control.told),
        criterion: "differences over frames 5–25 above 0 with z > 3, in 10-D and 28-D",
        pass: main.higher,
        direction: main.higher,
    });
    claims.push(Claim {
        id: "CF10",
        paper: "hmc's estimates are nearer to the truth at frame 10",
        ours: format!("{}; with markers of the fitted body: {}", main.errors, control.errors),
        criterion: "mean joint error lower with z > 3",
        pass: main.nearer,
        direction: main.nearer,
    });
    Ok(())
}

/// Judges what was run.
pub(super) fn judge(study: &Study, store: &Store, single: bool, multi: bool) -> Outcome<Vec<Claim>> {
    let mut claims = vec![];
    if single {
        single_claims(study, store, &mut claims)?;
    }
    if multi {
        multi_claims(study, store, &mut claims)?;
    }
    claims.sort_by_key(|claim| claim.id[2..].parse::<u32>().unwrap_or(u32::MAX));
    Ok(claims)
}

/// Cost of particles over that of chains in a dimension: geometric mean over frames with its interval.
pub(super) struct Crossover {
    pub(super) dim: usize,
    pub(super) variant: Variant,
    pub(super) ratio: [f64; 3],
}

/// The ratio at equal variance for every part of a nested series, particles extrapolated by 1/N where they must be.
pub(super) fn crossover(study: &Study, store: &Store, models: &[Model], frames: &[usize]) -> Outcome<Vec<Crossover>> {
    let stage = Stage::new(study.seed, "choo-fleet bootstrap");
    let mut found = vec![];
    for variant in [Variant::Best, Variant::Dense] {
        for model in models {
            let of = |&frame: &usize| -> Outcome<Ratio> {
                let particles = curve(study, store, Source::Recorded, frame, model, None)?;
                let chains = curve(study, store, Source::Recorded, frame, model, Some(variant))?;
                Ok(ratio(&particles, &chains, Axis::Units, At::Extrapolated, &stage))
            };
            let ratios = frames.iter().map(of).collect::<Outcome<Vec<_>>>()?;
            found.push(Crossover { dim: model.dim, variant, ratio: over_frames(&ratios) });
        }
    }
    Ok(found)
}
