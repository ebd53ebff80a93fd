//! Draws of what is constant, for the cameras and points of a run.

use super::lasting_errors::MeasuredErrors;
use super::stored::Setup;
use sinew_body::KinematicTree;
use sinew_observe::Camera;
use sinew_observe::lasting::lasting_errors::{LastingErrors, common_shift};
use std::ops::Range;

/// The shift of the world that each draw of the cameras that showed somebody looks like at the middle of the set-up's frames; 0 where fewer than two see it.
#[must_use]
pub fn world_shifts(
    cameras: &[Camera],
    errors: &LastingErrors,
    deviations: &[f64],
    known: &MeasuredErrors,
) -> Vec<[f64; 3]> {
    let draws = known.draws();
    let showing: Vec<usize> = (0..cameras.len()).filter(|c| !known.blind_cameras.contains(&cameras[*c].name)).collect();
    let showing_cameras: Vec<Camera> = showing.iter().map(|camera| cameras[*camera].clone()).collect();
    let from_draw = |draw: usize| {
        let error = |camera: &usize| {
            let first = errors.camera(*camera).start;
            std::array::from_fn(|k| deviations[(first + k) * draws + draw])
        };
        let drawn: Vec<_> = showing.iter().map(error).collect();
        common_shift(&showing_cameras, &drawn, known.middle_m).unwrap_or_default()
    };
    (0..draws).map(from_draw).collect()
}

/// Standard deviation per axis, metres, of the shift of the world that the set-up's draws of these cameras look like; `None` without draws.
#[must_use]
pub fn world_shift_sd_m(setup: &Setup, cameras: &[Camera]) -> Option<f64> {
    let known = setup.lasting.as_ref()?;
    let errors = LastingErrors { cameras: cameras.len(), points: 0, ..known.layout() };
    let drawn =
        world_shifts(&setup.as_they_are(cameras, 1.0), &errors, &deviations(known, &errors, cameras, &[]), known);
    let count = drawn.len() as f64;
    let mean = [0, 1, 2].map(|axis: usize| drawn.iter().map(|shift| shift[axis]).sum::<f64>() / count);
    let square = |shift: &[f64; 3]| (0..3).map(|axis| (shift[axis] - mean[axis]).powi(2)).sum::<f64>();
    Some((drawn.iter().map(square).sum::<f64>() / (3.0 * count)).sqrt())
}

/// Points of a body that are where detectors see them, each with the place of its keypoint among `keypoints`, the indices of points.
#[must_use]
pub fn detected(setup: &Setup, tree: &KinematicTree, keypoints: &[usize]) -> Vec<(usize, usize)> {
    let follows = |(_, point): &(usize, &usize)| setup.follows_detectors(&tree.points()[**point].name);
    keypoints.iter().enumerate().filter(follows).map(|(place, point)| (*point, place)).collect()
}

/// Draws of the set-up for some cameras and points, less the values that tracking uses, in the order of `errors`, p × draws, row after row; what the set-up has no draws of stays where it is.
#[must_use]
pub fn deviations(known: &MeasuredErrors, errors: &LastingErrors, cameras: &[Camera], points: &[String]) -> Vec<f64> {
    let layout = known.layout();
    let camera_of = |camera: usize| known.cameras.iter().position(|name| *name == cameras[camera].name);
    let point_of = |point: usize| known.points.iter().position(|name| *name == points[point]);
    let mut from: Vec<Option<usize>> = vec![None; errors.count()];
    let mut put = |own: Range<usize>, theirs: Option<Range<usize>>| {
        let theirs = theirs.into_iter().flatten().map(Some).chain(std::iter::repeat(None));
        own.zip(theirs).for_each(|(place, theirs)| from[place] = theirs);
    };
    put(errors.lengths(), Some(layout.lengths()));
    for point in 0..points.len() {
        put(errors.place(point), point_of(point).map(|theirs| layout.place(theirs)));
    }
    for camera in 0..cameras.len() {
        put(errors.camera(camera), camera_of(camera).map(|theirs| layout.camera(theirs)));
        let lag = |camera| layout.lag(camera)..layout.lag(camera) + 1;
        put(errors.lag(camera)..errors.lag(camera) + 1, camera_of(camera).map(lag));
        for point in 0..points.len() {
            let theirs = camera_of(camera).zip(point_of(point)).map(|(camera, point)| layout.bias(camera, point));
            put(errors.bias(camera, point), theirs);
        }
    }
    let draws = known.draws();
    from.into_iter()
        .flat_map(|place| place.map_or_else(|| vec![0.0; draws], |place| known.number[place].draws.clone()))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collect::SetupRequest;
    use crate::lasting_errors::{DrawnNumber, VERSION};
    use crate::pass::unmeasured;
    use sinew_formats::layout;

    /// Four cameras around somebody, all of which one draw moves by 5 mm along x and another the other way: the world seems to lie 5 mm aside along x and not along y and z, whose mean square over the axes is (5 mm)²/3.
    #[test]
    fn the_shift_of_the_world_is_per_axis() {
        let at = [[4.0, 0.0, 1.5], [-4.0, 0.0, 1.5], [0.0, 4.0, 1.5], [0.0, -4.0, 1.5]];
        let names = ["C1", "C2", "C3", "C4"];
        let camera = |k: usize| Camera::look_at(names[k], [1000.0; 2], 900.0, at[k], [0.0, 0.0, 1.0]).unwrap();
        let cameras = [0, 1, 2, 3].map(camera);
        let mut known = MeasuredErrors {
            version: VERSION,
            cameras: names.map(str::to_owned).to_vec(),
            middle_m: [0.0, 0.0, 1.0],
            frames: 2,
            worth: 2.0,
            ..MeasuredErrors::default()
        };
        let still = DrawnNumber { name: "n".into(), value: 0.0, prior_mean: 0.0, prior_sd: 1.0, draws: vec![0.0; 2] };
        known.number = vec![still; known.layout().count()];
        for (camera, own) in cameras.iter().enumerate() {
            // A camera is moved along its own axes: x of the world by them is a column of its rotation.
            for (k, row) in own.rotation.iter().enumerate() {
                let place = known.layout().camera(camera).start + 3 + k;
                known.number[place].draws = vec![5e-3 * row[0], -5e-3 * row[0]];
            }
        }
        let layout = layout::find("body-25b").unwrap();
        let setup = Setup { lasting: Some(known), ..unmeasured(&layout, &SetupRequest::default(), vec![]) };
        let found = world_shift_sd_m(&setup, &cameras).unwrap();
        assert!((1e3 * found - 5.0 / 3.0_f64.sqrt()).abs() < 1e-6, "{found}");
    }
}
