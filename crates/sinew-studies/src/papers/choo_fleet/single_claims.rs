//! The claims CF1–CF7 and CF9, about single frames.

use super::chains::Variant;
use super::curves::{curve, slope, volumes};
use super::problem::MODELS;
use super::scene::Source;
use super::study::Study;
use super::summary::{range, shown};
use crate::papers::claim::Claim;
use crate::support::outcome::Outcome;
use crate::support::statistics::{mean, median};
use crate::support::store::Store;
use sinew::core::random::Stage;
use sinew_tests::evaluation::equal_variance::{At, Axis, Cell, Ratio, over_frames, ratio};
use std::fmt::Write as _;

/// Markers of the recording, as the paper's.
const MAIN: Source = Source::Recorded;

/// Whether everything of the paper is run.
fn is_full(study: &Study) -> bool {
    study.size.doublings.len() == 7
}

/// Judges them; in a reduced size CF1, CF2 and CF5 alone.
pub(super) fn single_claims(study: &Study, store: &Store, claims: &mut Vec<Claim>) -> Outcome<()> {
    let judges: &[fn(&Study, &Store) -> Outcome<Claim>] = if is_full(study) {
        &[four, ten, whole_body, effective_numbers, volume_bounds, slopes, signs, rejections]
    } else {
        &[four, ten, volume_bounds]
    };
    for judge in judges {
        claims.push(judge(study, store)?);
    }
    Ok(())
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
fn ratios(
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

/// Ratios with the other metrics, and by wall time, in words.
fn other_ratios(study: &Study, store: &Store, model: usize, at: At) -> Outcome<String> {
    let mut text = String::new();
    for &variant in study.size.variants.iter().filter(|v| **v != Variant::Paper) {
        let [middle, ..] = over_frames(&ratios(study, store, MAIN, model, variant, Axis::Units, at)?);
        let _ = write!(text, "; {}: {}", variant.name(), shown(middle));
    }
    let [middle, ..] = over_frames(&ratios(study, store, MAIN, model, Variant::Paper, Axis::Seconds, at)?);
    let _ = write!(text, "; by wall time: {}", shown(middle));
    Ok(text)
}

/// CF1: particles lead in 4-D.
fn four(study: &Study, store: &Store) -> Outcome<Claim> {
    let arm = ratios(study, store, MAIN, 0, Variant::Paper, Axis::Units, At::Common)?;
    let inverse: Vec<f64> = arm.iter().map(|r| 1.0 / r.value).collect();
    let inside = inverse.iter().filter(|r| (1.5..=40.0).contains(*r)).count();
    Ok(Claim {
        id: "CF1",
        paper: "4-D: the particle filter is about 8 times faster at equal variance",
        ours: format!(
            "hmc/pf {} (geometric mean {}), {inside} of {} frames inside{}",
            range(&inverse, 2),
            shown(1.0 / over_frames(&arm)[0]),
            inverse.len(),
            other_ratios(study, store, 0, At::Common)?.replace(": ", ", pf/hmc: ")
        ),
        criterion: "hmc/pf in 1.5–40 on at least 4 of 6 frames",
        pass: is_full(study) && inside >= 4,
    })
}

/// CF2: chains lead in 10-D.
fn ten(study: &Study, store: &Store) -> Outcome<Claim> {
    let lower = ratios(study, store, MAIN, 1, Variant::Paper, Axis::Units, At::Common)?;
    let [middle, low, high] = over_frames(&lower);
    Ok(Claim {
        id: "CF2",
        paper: "10-D: hmc is about 50 times faster",
        ours: format!(
            "pf/hmc {} (95 %: {}–{}){}",
            shown(middle),
            shown(low),
            shown(high),
            other_ratios(study, store, 1, At::Common)?
        ),
        criterion: "pf/hmc at least 5, lower bound above 1",
        pass: middle >= 5.0 && low > 1.0,
    })
}

/// CF3: and by far in 28-D.
fn whole_body(study: &Study, store: &Store) -> Outcome<Claim> {
    let whole = ratios(study, store, MAIN, 2, Variant::Paper, Axis::Units, At::Extrapolated)?;
    let [middle, low, high] = over_frames(&whole);
    Ok(Claim {
        id: "CF3",
        paper: "28-D: hmc is more than 2000 times faster (extrapolated)",
        ours: format!(
            "pf/hmc {} (95 %: {}–{}){}",
            shown(middle),
            shown(low),
            shown(high),
            other_ratios(study, store, 2, At::Extrapolated)?
        ),
        criterion: "pf/hmc at least 200, extrapolated by 1/N from N = 1 728 000",
        pass: middle >= 200.0,
    })
}

/// CF4: more particles hardly help in 28-D.
fn effective_numbers(study: &Study, store: &Store) -> Outcome<Claim> {
    let all = curves(study, store, MAIN, 2, Variant::Paper)?;
    let effective: Vec<f64> = all.iter().map(|[particles, _]| particles[4].effective).collect();
    let fall: Vec<f64> = all.iter().map(|[p, _]| (p[6].log_mean() - p[0].log_mean()).exp()).collect();
    Ok(Claim {
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
    })
}

/// Logarithms of the volume ratio of each model, frame by frame: by standard deviations, and by determinants.
fn log_volumes(study: &Study, store: &Store) -> Outcome<[Vec<Vec<f64>>; 2]> {
    let [mut by_sd, mut by_det] = [vec![], vec![]];
    for model in MODELS {
        let sd = model.walk(study.isa)?.sd().to_vec();
        let of = |&frame: &usize| volumes(store, MAIN, frame, &model, &sd);
        let found = study.size.frames.iter().map(of).collect::<Outcome<Vec<[f64; 2]>>>()?;
        by_sd.push(found.iter().map(|v| v[0]).collect());
        by_det.push(found.iter().map(|v| v[1]).collect());
    }
    Ok([by_sd, by_det])
}

/// Whether at least the directions of CF1, CF2 and CF5 are the paper's, which is asserted of a reduced size.
pub(super) fn directions_hold(study: &Study, store: &Store) -> Outcome<bool> {
    let of = |model| ratios(study, store, MAIN, model, Variant::Paper, Axis::Units, At::Common);
    let [arm, lower] = [of(0)?, of(1)?].map(|found| over_frames(&found)[0]);
    let [_, by_det] = log_volumes(study, store)?;
    let means: Vec<f64> = by_det.iter().map(mean).collect();
    Ok(arm < 1.0 && lower > 1.0 && means[0] < means[1] && means[1] < means[2])
}

/// CF5: how many particles the volumes ask for.
fn volume_bounds(study: &Study, store: &Store) -> Outcome<Claim> {
    let [by_sd, by_det] = log_volumes(study, store)?;
    let bounds = [0.8..=2.5, 3.0..=6.0, 8.5..=14.5];
    let inside = by_det.iter().zip(&bounds).all(|(values, bound)| values.iter().all(|v| bound.contains(v)));
    let line = |i: usize| by_det[0][i] + (by_det[1][i] - by_det[0][i]) / 6.0 * 24.0;
    let misses: Vec<f64> = (0..by_det[0].len()).map(|i| line(i) - by_det[2][i]).collect();
    Ok(Claim {
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
    })
}

/// CF6: variance falls with the number of updates.
fn slopes(study: &Study, store: &Store) -> Outcome<Claim> {
    let slopes: Vec<f64> = (0..3)
        .map(|model| {
            let all = curves(study, store, MAIN, model, Variant::Paper)?;
            Ok(mean(all.iter().map(|[_, chains]| slope(study, chains)).collect::<Vec<_>>()))
        })
        .collect::<Outcome<_>>()?;
    Ok(Claim {
        id: "CF6",
        paper: "the variance of hmc falls as 1/R",
        ours: format!("slopes {:.2}, {:.2}, {:.2}", slopes[0], slopes[1], slopes[2]),
        criterion: "slope of log variance against log R in −1.3 to −0.7 from R = 32, in all three",
        pass: slopes.iter().all(|s| (-1.3..=-0.7).contains(s)),
    })
}

/// CF7: every frame says the same.
fn signs(study: &Study, store: &Store) -> Outcome<Claim> {
    let signs: Vec<usize> = (0..3)
        .map(|model| {
            let at = if model == 2 { At::Extrapolated } else { At::Common };
            let all = ratios(study, store, MAIN, model, Variant::Paper, Axis::Units, at)?;
            Ok(all.iter().filter(|r| r.value > 1.0).count())
        })
        .collect::<Outcome<_>>()?;
    let frames = study.size.frames.len();
    Ok(Claim {
        id: "CF7",
        paper: "geometric means behave like single variables: the comparison has the same sign everywhere",
        ours: format!(
            "frames with hmc ahead: {} (4-D), {} (10-D), {} (28-D) of {frames}",
            signs[0], signs[1], signs[2]
        ),
        criterion: "the same sign on all frames",
        pass: signs.iter().all(|s| *s == 0 || *s == frames),
    })
}

/// CF9: what was tuned to.
fn rejections(study: &Study, store: &Store) -> Outcome<Claim> {
    let mut own = vec![];
    let mut others = vec![];
    for model in 0..3 {
        for (i, [_, chains]) in curves(study, store, MAIN, model, Variant::Paper)?.iter().enumerate() {
            let rejection = 100.0 * (1.0 - chains.last().map_or(f64::NAN, |cell| cell.acceptance));
            if i == 0 { own.push(rejection) } else { others.push(rejection) }
        }
    }
    Ok(Claim {
        id: "CF9",
        paper: "step sizes are tuned to about 15 % rejection",
        ours: format!("tuning frame {} %, other frames {} %", range(&own, 0), range(&others, 0)),
        criterion: "10–20 % on the tuning frame, 5–35 % on the others",
        pass: own.iter().all(|r| (10.0..=20.0).contains(r)) && others.iter().all(|r| (5.0..=35.0).contains(r)),
    })
}
