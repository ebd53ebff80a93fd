//! Angles of the pelvis over the cycle, whatever the convention of the run and wherever somebody walks.
//!
//! 1. OpenSim's angles of each frame become Baker's ([`sinew::angles::pelvis`]), in the mean pose from `angles.mot`, ends of intervals from the draws of the rotations: three angles of which each has an interval say nothing of how they go together.
//! 2. `pelvic_rotation` is taken against the direction of walking ([`super::progression`]), of which no error is known: the pelvis errs by some millimetres on a way of a metre. Where nobody walks it is that of the last frame in which somebody did.

use super::cycles::Series;
use super::progression::directions;
use super::varied::interval;
use super::walk::{MOST_FRAMES, Walk};
use crate::Error;
use serde_json::Value;
use sinew::angles::circle::{TURN_DEG, near};
use sinew::angles::pelvis::{ISB_PELVIS, OPENSIM_PELVIS, baker_from_opensim};
use sinew::angles::{AngleDraws, Convention, JointAngles};
use sinew::files::read_text;
use sinew::setup::Setup;
use sinew_formats::source_text::MAX_CONFIG_BYTES;
use sinew_input::flag::flag_with;
use sinew_results::stored_array::stored_array;
use std::path::Path;

/// What is said where they cannot be had.
const LEFT_OUT: &str = "`pelvis_tilt`, `pelvis_list` and `pelvis_rotation` depend on where somebody faces, and a standing \
     trial was taken off them: they are left out of the cycles; track with";

/// The series of a folder with a run's summary, with angles of the pelvis that do not depend on the heading; and what a reader should know.
pub(super) fn heading_free(
    folder: &Path,
    summary: &Value,
    walk: &Walk,
    mut series: Vec<Series>,
) -> Result<(Vec<Series>, Vec<String>), Error> {
    let mut warnings = vec![];
    let is_own = |series: &Series| OPENSIM_PELVIS.contains(&series.name.as_str());
    let (own, others): (Vec<Series>, Vec<Series>) = series.into_iter().partition(is_own);
    series = others;
    if let [tilt, list, rotation] = &own[..] {
        let zeros = &summary["angles"]["zero_deg"];
        if OPENSIM_PELVIS.iter().any(|name| zeros[*name].is_array()) {
            warnings.push(format!("{LEFT_OUT} {}", flag_with("angles", "isb")));
        } else {
            series.splice(0..0, turned(folder, [tilt, list, rotation])?);
        }
    }
    if let Some(rotation) = series.iter_mut().find(|series| series.name == ISB_PELVIS[2]) {
        against_walking(rotation, &headings_deg(walk));
    }
    Ok((series, warnings))
}

/// Baker's angles from OpenSim's.
fn turned(folder: &Path, own: [&Series; 3]) -> Result<[Series; 3], Error> {
    let frames = own[0].mean_deg.len();
    let mut before = None;
    let means: Vec<[f64; 3]> = (0..frames)
        .map(|frame| {
            let found = baker_from_opensim(own.map(|series| series.mean_deg[frame].to_radians()), before);
            before = Some(found);
            found.map(f64::to_degrees)
        })
        .collect();
    let ends = ends_deg(folder, &means)?;
    let one = |k: usize| Series {
        name: ISB_PELVIS[k].to_owned(),
        mean_deg: means.iter().map(|all| all[k]).collect(),
        ends_deg: ends.as_ref().map(|ends| [0, 1].map(|end: usize| ends.iter().map(|all| all[k][end]).collect())),
    };
    Ok([one(0), one(1), one(2)])
}

/// Ends of the 90 % intervals of Baker's angles in each frame, degrees, about their means; `None` without draws.
fn ends_deg(folder: &Path, means_deg: &[[f64; 3]]) -> Result<Option<Vec<[[f64; 2]; 3]>>, Error> {
    let path = folder.join("setup.toml");
    if !path.exists() || means_deg.len() > MOST_FRAMES {
        return Ok(None);
    }
    let setup = Setup::from_toml(&path.display().to_string(), &read_text(&path, MAX_CONFIG_BYTES)?)?;
    let array = stored_array(folder, "posterior/angle")?;
    let draws = array.and_then(|array| AngleDraws::new(setup.tree(), &array.shape, array.values));
    let Some(draws) = draws.filter(|draws| draws.frames() == means_deg.len()) else { return Ok(None) };
    let angles = JointAngles::new(draws.tree(), &[], true, Convention::Isb);
    let place = |name: &&str| angles.names().iter().position(|own| own == name);
    let places: Vec<usize> = ISB_PELVIS.iter().filter_map(place).collect();
    let Ok(places) = <[usize; 3]>::try_from(places) else { return Ok(None) };
    let mut raw = vec![0.0; angles.raw_count()];
    let mut in_frame = |frame: usize| -> Option<[[f64; 2]; 3]> {
        let mut drawn = [(); 3].map(|()| Vec::with_capacity(draws.draws()));
        for draw in 0..draws.draws() {
            angles.raw(&draws.state(draw, frame), None, &mut raw);
            for (k, drawn) in drawn.iter_mut().enumerate() {
                drawn.push(near(angles.signed(places[k], &raw).to_degrees(), means_deg[frame][k], TURN_DEG));
            }
        }
        let [tilt, obliquity, rotation] = drawn.map(|drawn| interval(&drawn));
        Some([tilt?, obliquity?, rotation?])
    };
    Ok((0..means_deg.len()).map(&mut in_frame).collect())
}

/// The direction in which somebody walks, frame by frame: degrees to the left of the world's y; empty where nobody ever walks.
fn headings_deg(walk: &Walk) -> Vec<f64> {
    let found = directions(&walk.times_s, &walk.pelvis.mean);
    let Some(mut last) = found.iter().flatten().next().copied() else { return vec![] };
    let heading = |direction: &Option<[f64; 2]>| {
        last = direction.unwrap_or(last);
        (-last[0]).atan2(last[1]).to_degrees()
    };
    found.iter().map(heading).collect()
}

/// Takes headings off a rotation, to within half a turn.
fn against_walking(rotation: &mut Series, headings_deg: &[f64]) {
    for (frame, heading) in headings_deg.iter().enumerate() {
        let mean = rotation.mean_deg[frame];
        let off = near(mean - heading, 0.0, TURN_DEG) - mean;
        rotation.mean_deg[frame] += off;
        rotation.ends_deg.iter_mut().flatten().for_each(|ends| ends[frame] += off);
    }
}

#[cfg(test)]
mod tests {
    use super::super::walk::Path3;
    use super::*;
    use serde_json::json;

    fn series(name: &str, degrees: f64) -> Series {
        Series { name: name.into(), mean_deg: vec![degrees; 60], ends_deg: None }
    }

    /// Someone walks with a direction to the left of y, degrees.
    fn walk(heading: f64) -> Walk {
        let times_s: Vec<f64> = (0..60).map(|k| f64::from(k) / 30.0).collect();
        let (sin, cos) = heading.to_radians().sin_cos();
        let mean = times_s.iter().map(|t| [-sin * t, cos * t, 1.0]).collect();
        Walk { pelvis: Path3 { mean, draws: vec![] }, times_s, ..Walk::default() }
    }

    fn found(heading: f64, summary: &Value) -> (Vec<Series>, Vec<String>) {
        // Facing aside by 10° more, leaning forward by 20°: OpenSim's angles of R_z(h + 10°) R_x(−20°).
        let m = sinew_formats::rotation::product(
            &sinew_formats::rotation::about_axis(2, (heading + 10.0_f64).to_radians()),
            &sinew_formats::rotation::about_axis(0, -20.0_f64.to_radians()),
        );
        let opensim = sinew::angles::decomposition::AngleSequence::FlexionAdductionRotation.angles(&m);
        let all = OPENSIM_PELVIS.iter().zip(opensim).map(|(name, angle)| series(name, angle.to_degrees()));
        let all = all.chain([series("knee_angle_r", 5.0)]).collect();
        heading_free(Path::new("nowhere"), summary, &walk(heading), all).unwrap()
    }

    #[test]
    fn angles_of_the_pelvis_are_the_same_wherever_somebody_walks() {
        for heading in [0.0, 90.0, 180.0, -90.0, 37.0] {
            let (series, warnings) = found(heading, &json!({}));
            let names: Vec<&str> = series.iter().map(|series| series.name.as_str()).collect();
            assert_eq!(names, ["pelvic_tilt", "pelvic_obliquity", "pelvic_rotation", "knee_angle_r"]);
            for (series, expected) in series.iter().zip([20.0, 0.0, 10.0, 5.0]) {
                assert!(series.mean_deg.iter().all(|x| (x - expected).abs() < 1e-6), "{heading} {}", series.name);
            }
            assert!(warnings.is_empty());
        }
    }

    #[test]
    fn a_zero_of_another_heading_leaves_them_out() {
        let zeroed = json!({ "angles": { "zero_deg": { "pelvis_tilt": [3.0, 0.1] } } });
        let (series, warnings) = found(0.0, &zeroed);
        assert_eq!((series.len(), series[0].name.as_str()), (1, "knee_angle_r"));
        assert!(warnings.len() == 1 && warnings[0].contains("--angles isb"), "{warnings:?}");
    }
}
