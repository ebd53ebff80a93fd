//! Thicknesses of a tracked person, from masks of a few frames and the poses of a result.
//!
//! The poses are kept; radii of the solids are scaled until the body covers the masks best, with as few wrong pixels as possible: pixels of the masks that are not on the body, and of the body that are not on a mask, over the masks'
//! pixels.
//!
//! 1. Left and right solids of one name (`l_thigh`, `r_thigh`) are one part; each part has two scales, of its radii at base and top.
//! 2. One part after the other: golden section search over the logarithm of its scales, first both together, then each alone, in brackets about the best so far that shrink from round to round.
//! 3. A part that no mask shows keeps its radii: a weak pull towards the first ones decides between equals.
//!
//! Nothing is drawn at random and pixels are counted in whole numbers, so that the result does not depend on the number of threads. Masks of clothes give the thickness of clothes; where poses are wrong, thicknesses follow them.

pub(crate) mod error;

pub use error::ShapeFitError;

use crate::Error;
use rayon::prelude::*;
use sinew::input::silhouettes::{self, Silhouettes};
use sinew_body::KinematicTree;
use sinew_body::flesh::{Flesh, Solid};
use sinew_formats::body_toml;
use sinew_observe::golden_section::golden_section;
use sinew_observe::silhouettes::bit_image::Overlap;
use sinew_observe::silhouettes::girth::{Sight, before_cameras, mask_overlap};
use sinew_observe::{Camera, WorkingRaster};
use sinew_results;
use sinew_results::Occupied;
use sinew_results::tracked::{self, Tracked};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Where poses and masks come from.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeFitRequest {
    /// Calibration of the run.
    pub calibration: PathBuf,
    /// Masks.
    pub silhouettes: PathBuf,
    /// Size of the masks over that of the calibrated images.
    pub scale: Option<f64>,
    /// Frames to choose from, by number; all if `None`.
    pub frames: Option<Range<u64>>,
}

/// Scales of one part.
#[derive(Clone, Debug, PartialEq)]
pub struct PartScale {
    /// Name of the solid; of a left and a right one what both have in common.
    pub name: String,
    /// Factor on the radius at base and top.
    pub scale: [f64; 2],
}

/// What was found.
#[derive(Clone, Debug, PartialEq)]
pub struct FittedShape {
    /// Solids with their new radii.
    pub flesh: Flesh,
    /// Scale of each part.
    pub parts: Vec<PartScale>,
    /// Wrong pixels over the masks' pixels, with the radii as they were.
    pub before: f64,
    /// The same with the new ones.
    pub after: f64,
    /// Masks compared.
    pub masks: usize,
}

/// Frames that are compared; more of a recording add little.
const FRAMES: usize = 12;
/// Longest side of the raster in which masks are compared, pixels.
const RASTER: usize = 640;
/// Half widths of the brackets of each round, in logarithms of scales; the first round moves base and top together.
const ROUNDS: [f64; 6] = [0.35, 0.3, 0.15, 0.08, 0.04, 0.02];
/// Steps of a golden section: its bracket becomes 29 times narrower.
const STEPS: usize = 7;
/// Pull towards the first radii: wrong pixels over the masks' pixels that a scale of e costs.
const PULL: f64 = 1e-3;
/// Least and greatest scale.
const SCALES: [f64; 2] = [0.4, 2.5];

/// The part that a solid belongs to: its name without the side.
fn part_name(name: &str) -> &str {
    ["l_", "r_", "left_", "right_"].iter().find_map(|side| name.strip_prefix(side)).unwrap_or(name)
}

/// Names of the parts, in the order of the solids.
fn part_names(solids: &[Solid]) -> Vec<String> {
    let mut names: Vec<String> = vec![];
    for solid in solids {
        let name = part_name(&solid.name);
        if !names.iter().any(|known| known == name) {
            names.push(name.into());
        }
    }
    names
}

/// Solids with scaled radii.
fn scaled(flesh: &Flesh, names: &[String], logs: &[[f64; 2]]) -> Flesh {
    let part = |solid: &Solid| names.iter().position(|name| name == part_name(&solid.name));
    flesh.with_radii(|solid| part(solid).map_or([1.0; 2], |part| logs[part].map(f64::exp)))
}

/// Counts wrong pixels.
struct Judge<'a> {
    tree: &'a KinematicTree,
    flesh: &'a Flesh,
    names: &'a [String],
    cameras: &'a [Camera],
    sights: &'a [Sight],
}

impl Judge<'_> {
    /// Wrong pixels over the masks' pixels.
    fn mismatch(&self, logs: &[[f64; 2]]) -> Result<f64, ShapeFitError> {
        let flesh = scaled(self.flesh, self.names, logs);
        let model = before_cameras(self.tree, &flesh, self.cameras).map_err(ShapeFitError::Solids)?;
        let Overlap { both, first_only, second_only } =
            self.sights.par_iter().map(|sight| mask_overlap(&model, sight)).sum();
        Ok((first_only + second_only) as f64 / (both + first_only).max(1) as f64)
    }

    /// What is minimised.
    fn cost(&self, logs: &[[f64; 2]]) -> Result<f64, ShapeFitError> {
        Ok(self.mismatch(logs)? + PULL * logs.as_flattened().iter().map(|log| log * log).sum::<f64>())
    }

    /// Golden section search along some ends of a part; the best of all that was tried, the start included.
    fn search(
        &self,
        logs: &mut [[f64; 2]],
        best: &mut f64,
        part: usize,
        ends: &[usize],
        reach: f64,
    ) -> Result<(), ShapeFitError> {
        let start = logs[part];
        let [least, most] = SCALES.map(f64::ln);
        let moved = |step: f64| {
            let mut moved = start;
            ends.iter().for_each(|&end| moved[end] = (start[end] + step).clamp(least, most));
            moved
        };
        let (step, cost) = golden_section([-reach, reach], STEPS, |step| {
            logs[part] = moved(step);
            self.cost(logs)
        })?;
        logs[part] = if cost < *best { moved(step) } else { start };
        *best = best.min(cost);
        Ok(())
    }
}

/// Radii with which a body in known states covers masks best; `cameras` have perfect lenses and the size of the masks. The callback `progress` gets the number of rounds done, and of all.
///
/// # Errors
/// No mask with a person; solids that cannot be compared; masks of another size than their cameras.
pub fn fit(
    tree: &KinematicTree,
    flesh: &Flesh,
    cameras: &[Camera],
    sights: &[Sight],
    mut progress: impl FnMut(u64, u64),
) -> Result<FittedShape, ShapeFitError> {
    let masks = || sights.iter().flat_map(|sight| cameras.iter().zip(&sight.silhouettes));
    for (camera, mask) in masks().filter_map(|(camera, mask)| Some((camera, mask.as_ref()?))) {
        let (size, expected) = ([mask.width(), mask.height()], camera.image_size_px.map(|side| side as usize));
        if size != expected {
            return Err(ShapeFitError::OtherSize { camera: camera.name.clone(), size, expected });
        }
    }
    if masks().filter_map(|(_, mask)| mask.as_ref()).all(|mask| mask.count() == 0) {
        return Err(ShapeFitError::Nobody);
    }
    let names = part_names(flesh.solids());
    let judge = Judge { tree, flesh, names: &names, cameras, sights };
    let mut logs = vec![[0.0; 2]; names.len()];
    let before = judge.mismatch(&logs)?;
    let mut best = judge.cost(&logs)?;
    for (round, &reach) in ROUNDS.iter().enumerate() {
        for part in 0..names.len() {
            if round == 0 {
                judge.search(&mut logs, &mut best, part, &[0, 1], reach)?;
            } else {
                judge.search(&mut logs, &mut best, part, &[0], reach)?;
                judge.search(&mut logs, &mut best, part, &[1], reach)?;
            }
        }
        progress(round as u64 + 1, ROUNDS.len() as u64);
    }
    let (after, flesh) = (judge.mismatch(&logs)?, scaled(flesh, &names, &logs));
    let parts = names.iter().zip(&logs).map(|(name, log)| PartScale { name: name.clone(), scale: log.map(f64::exp) });
    Ok(FittedShape {
        flesh,
        parts: parts.collect(),
        before,
        after,
        masks: masks().filter(|(_, mask)| mask.is_some()).count(),
    })
}

/// Fits the radii of the body of a result folder and writes it as a body file; gives what was found, and what is odd about the masks.
///
/// # Errors
/// Errors of [`Tracked::read`], [`Silhouettes::open`] and [`fit`]; a file that is there (unless forced), an input or cannot be written.
pub fn fit_shape(
    results: &Path,
    request: &ShapeFitRequest,
    out: &Path,
    force: bool,
    progress: impl FnMut(u64, u64),
) -> Result<(FittedShape, Vec<String>), Error> {
    if let Some(input) = tracked::inputs(results, &request.calibration, Some(&request.silhouettes))
        .into_iter()
        .find(|input| out.canonicalize().is_ok_and(|out| input.canonicalize().is_ok_and(|input| out == input)))
    {
        return Err(sinew_results::Error::OutputIsInput { path: out.to_owned(), input }.into());
    }
    if out.exists() && !force {
        return Err(sinew_results::Error::OutputExists { path: out.to_owned(), found: Occupied::File }.into());
    }
    let tracked = Tracked::read(results)?;
    let in_range = tracked.chosen(request.frames.as_ref(), 1)?.len();
    let chosen = tracked.chosen(request.frames.as_ref(), in_range.div_ceil(FRAMES))?;
    let (cameras, calibrated) = tracked.cameras(&request.calibration)?;
    let numbers = match (chosen.first(), chosen.last()) {
        (Some((first, _)), Some((last, _))) => *first..last + 1,
        _ => 0..0,
    };
    let lag = tracked.lag.clone();
    let options =
        silhouettes::ImageFolderOptions { scale: request.scale, frames: Some(numbers), trim: true, lag, calibrated };
    let mut masks = Silhouettes::open(&request.silhouettes, &cameras, &options)?;
    let sized = tracked.as_seen(&masks.cameras(), &cameras);
    let raster = |camera| WorkingRaster::new(camera, WorkingRaster::factor_for(camera, RASTER));
    let rasters: Vec<WorkingRaster> = sized.iter().map(raster).collect();
    let mut sights = Vec::with_capacity(chosen.len());
    for (number, state) in chosen {
        let read = masks.frame(*number)?;
        let silhouettes = rasters.iter().zip(&read).map(|(raster, mask)| Some(raster.silhouette(mask.as_ref()?)));
        sights.push(Sight { state: state.clone(), silhouettes: silhouettes.collect() });
    }
    let perfect: Vec<Camera> = rasters.iter().map(|raster| raster.camera().clone()).collect();
    let (tree, flesh) = (tracked.setup.tree(), tracked.setup.flesh()?);
    let fitted = fit(&tree, &flesh, &perfect, &sights, progress)?;
    sinew_results::write_whole(out, body_toml::write(&tree, Some(&fitted.flesh)).as_bytes())?;
    Ok((fitted, masks.warnings()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_body::points::points_of_states;
    use sinew_body::standard_flesh::standard_flesh;
    use sinew_observe::silhouettes::bit_image::BitImage;
    use sinew_simulate::ring::{Ring, around};
    use sinew_simulate::walker::{Gait, Walker, walker_states};

    /// Scales of the parts of the person who is seen, at base and top.
    const TRUTH: [(&str, [f64; 2]); 8] = [
        ("pelvis", [0.92, 0.9]),
        ("spine", [1.1, 1.15]),
        ("head", [0.9, 1.1]),
        ("upper_arm", [1.25, 1.2]),
        ("forearm", [0.85, 0.9]),
        ("thigh", [1.2, 1.1]),
        ("shin", [0.9, 1.15]),
        ("foot", [1.1, 0.9]),
    ];
    /// Largest and mean error of a radius, as a share: ends lie inside other solids, where no mask shows them.
    const WORST: f64 = 0.12;
    const MEAN: f64 = 0.04;

    fn walk() -> (KinematicTree, Vec<Camera>, Vec<Vec<f64>>) {
        let walker = Walker::new(Gait { duration_s: 2.4, ..Gait::default() });
        let states: Vec<Vec<f64>> = walker_states(&walker, 10.0).into_iter().step_by(4).collect();
        let ring = Ring { image_size_px: [640.0, 480.0], ..Ring::SMALL_PICTURES };
        let cameras = around(&points_of_states(&walker.body, &states), &ring).expect("a ring");
        (walker.body, cameras, states)
    }

    fn sights(tree: &KinematicTree, flesh: &Flesh, cameras: &[Camera], states: &[Vec<f64>]) -> Vec<Sight> {
        let model = before_cameras(tree, flesh, cameras).expect("a body");
        let sight = |state: &Vec<f64>| {
            let silhouettes = model.silhouettes(state).into_iter().map(Some).collect();
            Sight { state: state.clone(), silhouettes }
        };
        states.iter().map(sight).collect()
    }

    #[test]
    fn radii_are_recovered_from_masks() {
        let (tree, cameras, states) = walk();
        let standard = standard_flesh(&tree).expect("links of people");
        let names = part_names(standard.solids());
        let logs: Vec<[f64; 2]> = names
            .iter()
            .map(|name| TRUTH.iter().find(|(known, _)| known == name).map_or([0.0; 2], |(_, scale)| scale.map(f64::ln)))
            .collect();
        let truth = scaled(&standard, &names, &logs);
        let seen = sights(&tree, &truth, &cameras, &states);
        let fitted = fit(&tree, &standard, &cameras, &seen, |_, _| {}).expect("masks of a person");
        assert!(fitted.before > 0.05 && fitted.after < 0.2 * fitted.before, "{} {}", fitted.before, fitted.after);
        let errors: Vec<f64> = fitted
            .parts
            .iter()
            .zip(&logs)
            .flat_map(|(part, log)| [0, 1].map(|end| (part.scale[end] / log[end].exp() - 1.0).abs()))
            .collect();
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        assert!(errors.iter().all(|error| *error < WORST) && mean < MEAN, "{mean} {:?}", fitted.parts);
        let radii = |name: &str| fitted.flesh.solids().iter().find(|s| s.name == name).expect("a solid").frustum.radii;
        assert_eq!(radii("l_thigh"), radii("r_thigh"));
        let again = fit(&tree, &fitted.flesh, &cameras, &seen, |_, _| {}).expect("masks of a person");
        assert!(again.after <= fitted.after + 1e-3, "{} {}", again.after, fitted.after);
    }

    /// What no camera sees keeps its size, and masks without anybody are refused.
    #[test]
    fn nothing_is_made_up() {
        let (tree, cameras, states) = walk();
        let flesh = standard_flesh(&tree).expect("links of people");
        let mut seen = sights(&tree, &flesh, &cameras, &states[..1]);
        let same = fit(&tree, &flesh, &cameras, &seen, |_, _| {}).expect("masks of a person");
        assert_eq!((same.before, same.after, same.masks), (0.0, 0.0, 4));
        assert_eq!(same.flesh, flesh);
        seen[0].silhouettes[1] = Some(BitImage::new(5, 5));
        assert!(fit(&tree, &flesh, &cameras, &seen, |_, _| {}).unwrap_err().to_string().contains("[5, 5]"));
        seen[0].silhouettes = vec![Some(BitImage::new(640, 480)), None, None, None];
        assert!(fit(&tree, &flesh, &cameras, &seen, |_, _| {}).unwrap_err().to_string().contains("no"));
    }
}
