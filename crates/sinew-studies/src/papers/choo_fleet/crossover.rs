//! The dimension in which hybrid Monte Carlo overtakes particles: the ratio of costs along a nested series of parts.

use super::chains::Variant;
use super::curves::curve;
use super::problem::Model;
use super::scene::Source;
use super::study::Study;
use crate::support::outcome::Outcome;
use crate::support::store::Store;
use sinew::core::random::Stage;
use sinew_tests::evaluation::equal_variance::{At, Axis, Ratio, over_frames, ratio};

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
