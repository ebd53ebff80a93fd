//! Whether keypoints fit the calibration, and what would if they do not.
//!
//! Keypoint files do not say how large their images were. When all images were resized by s after the calibration, keypoints (u, v) come from calibrated pixels
//! (u, v) / s, and only there do the rays of a keypoint meet. In the same way rays meet only where the poses of the cameras are what they are taken for, the camera
//! from the world and not the world from the camera. The median distance, in pixels of the calibrated images, between keypoints / s and the projection of their
//! triangulation is small for the right reading and large for others; readings other than the given one are tried only where that is large.

use super::setup_error::SetupError;
use sinew_core::estimators::median;
use sinew_observe::cameras::offsets::Sighted;
use sinew_observe::cameras::triangulate::{Seen, linear};
use sinew_observe::{Camera, Detection};

/// Residual, per 1000 px of image diagonal, up to which nothing is looked for.
const DOUBTFUL: f64 = 15.0;
/// Share of the present residual that another reading must fall below.
const BETTER: f64 = 0.3;
/// Sizes looked at: from a tenth to ten times, in steps of a 32nd of a doubling.
const STEPS: std::ops::RangeInclusive<i32> = -106..=106;
const STEPS_PER_DOUBLING: f64 = 32.0;
/// Usual ratios of image sizes. One of them is taken for the true ratio where its residual is at most [`AS_GOOD`] times the least one: constant offsets of the cameras move the ratio of least residual.
const USUAL: [f64; 9] = [1.0 / 4.0, 1.0 / 3.0, 1.0 / 2.0, 2.0 / 3.0, 3.0 / 4.0, 1.0, 4.0 / 3.0, 3.0 / 2.0, 2.0];
const AS_GOOD: f64 = 1.5;
/// Two cameras disagree in one number a point, and one that is turned a little looks like another size. Of two, sizes that are not usual are looked at only where the residual is this many times [`DOUBTFUL`].
const FAR: f64 = 3.0;
/// Keypoints below this confidence do not count.
const LEAST_CONFIDENCE: f64 = 0.3;
/// Comparisons below which nothing is said.
const FEWEST: usize = 20;

/// Refuses keypoints that fit the calibration only at another image size, or with the poses of its cameras inverted; `frames` show one person each, `declared` is the
/// scale that the cameras were resized by.
///
/// # Errors
/// What fits.
pub fn check(cameras: &[Camera], frames: &[Sighted], declared: f64) -> Result<(), SetupError> {
    let Some(now) = residual(cameras, frames, 1.0) else { return Ok(()) };
    if !is_doubtful(cameras, now) {
        return Ok(());
    }
    // Keypoints that are shrunk to a spot are near everything: distances count beside the size of the person.
    let beside_size = |(scale, px): &(f64, f64)| px * scale.max(1.0);
    let best_of = |scales: &mut dyn Iterator<Item = f64>| {
        let residuals = scales.filter_map(|scale| Some((scale, residual(cameras, frames, scale)?)));
        let best = residuals.min_by(|a, b| beside_size(a).total_cmp(&beside_size(b)));
        best.filter(|found| beside_size(found) < BETTER * now)
    };
    let any = cameras.len() > 2 || per_diagonal(cameras, now) > FAR * DOUBTFUL;
    let mut sizes = STEPS.filter(|_| any).map(|step| (f64::from(step) / STEPS_PER_DOUBLING).exp2());
    let best = best_of(&mut sizes);
    let usual = best_of(&mut USUAL.into_iter().map(|scale| scale / declared));
    let size = match (best, usual) {
        (Some((_, least)), Some(usual)) if usual.1 <= AS_GOOD * least => Some(usual),
        (None, usual) => usual,
        (best, _) => best,
    };
    let inverted: Vec<Camera> = cameras.iter().map(inverted).collect();
    let best_inverted = residual(&inverted, frames, 1.0).filter(|px| *px < BETTER * now);
    match (size, best_inverted) {
        (size, Some(px)) if size.is_none_or(|(_, other)| px < other) => {
            Err(SetupError::InvertedPoses { inverted_px: px, now_px: now })
        }
        (Some((scale, px)), _) => Err(SetupError::ResizedImages {
            camera: cameras[0].name.clone(),
            size_px: cameras[0].image_size_px.map(|size| size / declared),
            scale: scale * declared,
            fitting_px: px,
            now_px: now,
        }),
        (None, _) => Ok(()),
    }
}

/// Whether a residual, pixels, is larger than detectors and small errors of calibration make it.
pub(super) fn is_doubtful(cameras: &[Camera], residual_px: f64) -> bool {
    per_diagonal(cameras, residual_px) > DOUBTFUL
}

/// A residual, pixels, per 1000 px of image diagonal.
pub(super) fn per_diagonal(cameras: &[Camera], residual_px: f64) -> f64 {
    let diagonals = cameras.iter().map(|camera| camera.image_size_px[0].hypot(camera.image_size_px[1]));
    1000.0 * residual_px / median(&mut diagonals.collect::<Vec<_>>())
}

/// The camera whose pose is the world from the camera, read as the camera from the world.
fn inverted(camera: &Camera) -> Camera {
    let [a, b, c] = camera.rotation;
    let rotation = [0, 1, 2].map(|k: usize| [a[k], b[k], c[k]]);
    Camera { rotation, translation: camera.centre(), ..camera.clone() }
}

/// Median distance between keypoints and the projection of their triangulation, in pixels of the calibrated images; the image's diagonal where rays meet nowhere.
pub(super) fn residual(cameras: &[Camera], frames: &[Sighted], scale: f64) -> Option<f64> {
    let mut distances = vec![];
    for frame in frames {
        let keypoints = frame.iter().map(Vec::len).max().unwrap_or(0);
        for keypoint in 0..keypoints {
            let mut seen: Vec<Seen<'_>> = vec![];
            for (camera, points) in cameras.iter().zip(frame) {
                let detection = points.get(keypoint).copied().flatten();
                let Some(Detection { pixel, .. }) = detection.filter(|d| d.confidence >= LEAST_CONFIDENCE) else {
                    continue;
                };
                let Ok(pixel) = camera.undistort(pixel.map(|x| x / scale)) else { continue };
                seen.push(Seen { camera, pixel, confidence: 1.0 });
            }
            if seen.len() > 1 {
                let point = linear(&seen, true);
                distances.extend(seen.iter().map(|view| {
                    let [u, v] = view.camera.image_size_px;
                    let found = point.and_then(|point| view.camera.project_ideal(point));
                    found.map_or(u.hypot(v), |[a, b]| (view.pixel[0] - a).hypot(view.pixel[1] - b))
                }));
            }
        }
    }
    (distances.len() >= FEWEST).then(|| median(&mut distances))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_observe::cameras::camera_error::{NUMBERS, with_error};

    /// Two cameras a right angle apart, the second of which is turned about its axes, and what they see of a person in images that are `scale` times as large.
    fn seen(turn: [f64; 3], scale: f64) -> (Vec<Camera>, Vec<Sighted>) {
        let from = |place| Camera::look_at("C", [1280.0, 960.0], 900.0, place, [0.0, 0.0, 1.0]).unwrap();
        let cameras = vec![from([0.0, -4.0, 1.3]), from([4.0, 0.0, 1.3])];
        let mut error = [0.0; NUMBERS];
        error[..3].copy_from_slice(&turn);
        let turned = with_error(&cameras[1], &error);
        let detection = |camera: &Camera, k: u32| {
            let k = f64::from(k);
            let point = [0.3 * (2.0 * k).sin(), 0.3 * (3.0 * k).cos(), 0.1 + 0.07 * k];
            let pixel = camera.project(point).pixel()?.map(|x| scale * x);
            Some(Detection::new(pixel, 0.9))
        };
        let in_camera = |camera: &Camera| (0..25).map(|k| detection(camera, k)).collect::<Vec<_>>();
        (cameras.clone(), vec![vec![in_camera(&cameras[0]), in_camera(&turned)]])
    }

    /// A turned camera is no other image size, and images of half the size are one, also to two cameras.
    #[test]
    fn a_turned_camera_is_no_other_image_size() {
        for turn in [[0.08, 0.0, 0.0], [-0.12, 0.0, -0.12], [-0.2, -0.2, -0.2]] {
            let (cameras, frames) = seen(turn, 1.0);
            assert!(is_doubtful(&cameras, residual(&cameras, &frames, 1.0).unwrap()), "{turn:?}");
            assert!(check(&cameras, &frames, 1.0).is_ok(), "{turn:?}");
        }
        let (cameras, frames) = seen([0.0; 3], 0.5);
        let found = check(&cameras, &frames, 1.0);
        assert!(
            matches!(found, Err(SetupError::ResizedImages { scale, .. }) if (scale - 0.5).abs() < 1e-9),
            "{found:?}"
        );
    }
}
