//! The set-up pass: one reading of some frames, one [`Setup`].

use super::checks;
use super::collect::{Collected, SetupRequest, alone, collect};
use super::mistake_prior::{usual_elsewhere, usual_exchanged};
use super::own_body;
use super::pose_fit::pose_of;
use super::scale;
use super::setup_error::SetupError;
use super::shape;
use super::space_points::{Points, points_in_space};
use super::speed;
use super::stored::{Body, CameraSetup, SCHEMA, Setup};
use super::upward::{Upward, upward};
use super::warning::SetupWarning;
use sinew_body::Proportions;
use sinew_core::estimators::median;
use sinew_formats::Layout;
use sinew_input::up_axis::Z_UP;
use sinew_observe::Camera;
use sinew_observe::association::Person as Pixels;
use sinew_observe::cameras::offsets::{self, CameraNoise, Sighted};

/// Sets up the tracking of a person in calibrated cameras from the frames of an iterator (number, people of each camera), which must come in order.
///
/// # Errors
/// Errors of the iterator; no person found; a person behind the cameras; a calibration that fits only when it is read differently; a camera of another frame rate, or one
/// that shows someone else.
pub fn set_up<E: From<SetupError>>(
    cameras: &[Camera],
    layout: &Layout,
    request: &SetupRequest,
    frames: impl IntoIterator<Item = Result<(u64, Vec<Vec<Pixels>>), E>>,
) -> Result<(Setup, Vec<SetupWarning>), E> {
    let collected = collect(cameras, layout, request, frames)?;
    Ok(measure(cameras, layout, request, &collected)?)
}

/// Scatter per axis of keypoints of cameras that disagree, as a share of the image's width.
const TOLERATED: f64 = 0.02;

/// Where up is in the world of the cameras, by the person in the frames of an iterator, as for [`set_up`].
///
/// # Errors
/// Errors of the iterator and of [`collect`]; nobody who stands or walks, as far as two cameras see.
pub fn find_up<E: From<SetupError>>(
    cameras: &[Camera],
    layout: &Layout,
    request: &SetupRequest,
    frames: impl IntoIterator<Item = Result<(u64, Vec<Vec<Pixels>>), E>>,
) -> Result<Upward, E> {
    let mut lone: Vec<(u64, Sighted)> = vec![];
    let kept = frames.into_iter().map(|frame| {
        let (number, people) = frame?;
        lone.extend(alone(&people).map(|sighted| (number, sighted)));
        Ok::<_, E>((number, people))
    });
    let collected = collect(cameras, layout, request, kept)?;
    let noise = offsets::estimate(cameras, &collected.sighted(request.offset_frames), &request.offsets);
    let found = |noise: &[CameraNoise], frames: &[(u64, Sighted)]| {
        let in_space = |(number, sighted): &(u64, Sighted)| {
            (*number, points_in_space(cameras, noise, sighted, request.offsets.least_confidence))
        };
        let points: Vec<(u64, Points)> = frames.iter().map(in_space).collect();
        upward(layout, &points)
    };
    let wide = |(own, camera): (&CameraNoise, &Camera)| {
        let sigma_px = TOLERATED * camera.image_size_px[0];
        CameraNoise { offset_px: [0.0; 2], sigma_px, ..*own }
    };
    let tolerant = || noise.iter().zip(cameras).map(wide).collect::<Vec<_>>();
    // Cameras that disagree about the only person there is say where up is all the same, if less well.
    let up = found(&noise, &collected.spread).or_else(|| found(&tolerant(), &lone));
    Ok(up.ok_or(SetupError::NobodyUpright { frames: collected.spread.len() })?)
}

fn measure(
    cameras: &[Camera],
    layout: &Layout,
    request: &SetupRequest,
    collected: &Collected,
) -> Result<(Setup, Vec<SetupWarning>), SetupError> {
    let mut warnings = vec![];
    let tree = request.body.tree(&Proportions::default());
    let points: Vec<String> =
        layout.points.iter().flatten().filter(|name| tree.point_index(name).is_none()).cloned().collect();
    if !points.is_empty() {
        warnings.push(SetupWarning::PointsWithoutPlace { points });
    }
    let noise = offsets::estimate(cameras, &collected.sighted(request.offset_frames), &request.offsets);
    same_person(cameras, &noise)?;
    let camera: Vec<CameraSetup> =
        cameras.iter().zip(&noise).map(|(camera, n)| camera_setup(camera, n, &noise)).collect();
    let mut setup = unmeasured(layout, request, camera);
    if let [_] = cameras {
        warnings.push(SetupWarning::OneCamera);
        warnings.extend(scale::far_cameras(cameras));
        let found = collected.window.iter().find_map(|(n, s)| Some((*n, pose_of(&setup, cameras, layout, s, None)?)));
        (setup.start_frame, setup.start_pose) = found.ok_or(SetupError::NoPose)?;
        if !matches!(request.body, Body::File(_)) {
            setup.size_sd = SIZE_SD;
        }
        return Ok((setup, warnings));
    }
    checks::same_rate(cameras, request, &noise, collected)?;
    warnings.extend(speed::check(cameras, layout, request, &noise, collected)?);
    warnings.extend(checks::oddities(cameras, layout, request, &noise, collected));
    let shape = shape::measure(cameras, layout, request, &noise, collected, &mut warnings)?;
    setup.up_axis = shape.up_axis.into();
    setup.model_error_m = shape.model_error_m;
    setup.start_frame = shape.start_frame;
    setup.start_pose = shape.start_pose;
    setup.proportions = shape.proportions;
    if !request.body.is_measured() {
        let tree = setup.tree();
        let own = own_body::measure(&tree, cameras, layout, request, &noise, collected)
            .ok_or_else(|| no_pose_of(&tree, layout))?;
        setup.model_error_m = own.model_error_m;
        setup.start_frame = own.start_frame;
        setup.start_pose = own.start_pose;
    }
    Ok((setup, warnings))
}

/// A set-up of the default sizes, without a pose.
#[must_use]
pub fn unmeasured(layout: &Layout, request: &SetupRequest, camera: Vec<CameraSetup>) -> Setup {
    Setup {
        schema: SCHEMA,
        body: request.body.clone(),
        layout: layout.name.clone(),
        person: request.person,
        world_up: Z_UP.into(),
        world_up_sd_deg: None,
        up_axis: Z_UP.into(),
        model_error_m: ONE_CAMERA_ERROR_M,
        size_sd: 0.0,
        start_frame: 0,
        start_pose: vec![],
        step_size: None,
        leapfrog_steps: None,
        motion_sd: None,
        girth: None,
        colours: None,
        lasting: None,
        proportions: Proportions::default(),
        camera,
    }
}

/// Model error where none can be measured, metres.
const ONE_CAMERA_ERROR_M: f64 = 0.02;
/// Standard deviation of the stature of adults, men and women together, as a share of its mean: 2.85 and 2.58 in about means 5 in apart (National Health Survey
/// 1960–62, Vital and Health Statistics 11(8), table 2) are 3.7 in of 65.6 in together.
const SIZE_SD: f64 = 0.057;
/// Offset, as a share of the image's diagonal, beyond which a camera shows someone else.
const FARTHEST_OFFSET: f64 = 0.25;

/// Refuses cameras whose keypoints lie far from where the others see the person.
fn same_person(cameras: &[Camera], noise: &[CameraNoise]) -> Result<(), SetupError> {
    for (camera, noise) in cameras.iter().zip(noise) {
        let distance = noise.offset_px[0].hypot(noise.offset_px[1]);
        let farthest = FARTHEST_OFFSET * camera.image_size_px[0].hypot(camera.image_size_px[1]);
        if distance.is_nan() || distance > farthest {
            return Err(SetupError::SomebodyElse { camera: camera.name.clone(), distance_px: distance });
        }
    }
    Ok(())
}

/// Why a body of a file has no pose: its points.
fn no_pose_of(tree: &sinew_body::KinematicTree, layout: &Layout) -> SetupError {
    let names = tree.points().iter().map(|point| point.name.as_str());
    let shared = names.filter(|name| layout.index(name).is_some()).map(str::to_owned).collect();
    SetupError::NoPoseOfFile { layout: layout.name.clone(), shared }
}

/// Scatter assumed where nothing was seen and nothing can be borrowed, pixels.
const UNKNOWN_SIGMA_PX: f64 = 10.0;

pub(super) fn camera_setup(camera: &Camera, noise: &CameraNoise, all: &[CameraNoise]) -> CameraSetup {
    let usual = |of: fn(&CameraNoise) -> f64, otherwise: f64| {
        let own = of(noise);
        if own.is_finite() {
            return own;
        }
        let mut known: Vec<f64> = all.iter().map(of).filter(|x| x.is_finite()).collect();
        if known.is_empty() { otherwise } else { median(&mut known) }
    };
    CameraSetup {
        name: camera.name.clone(),
        offset_px: noise.offset_px,
        sigma_px: usual(|n| n.sigma_px, UNKNOWN_SIGMA_PX),
        usual_confidence: usual(|n| n.usual_confidence, 0.7),
        exchanged: usual_exchanged(),
        elsewhere: usual_elsewhere(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_camera_that_shows_someone_else_is_refused() {
        let camera = Camera::look_at("left", [1000.0, 1000.0], 900.0, [3.0, 3.0, 1.0], [0.0, 0.0, 1.0]).unwrap();
        let refusal = |offset_px| {
            let noise = CameraNoise { offset_px, sigma_px: 5.0, usual_confidence: 0.7, residuals: 90 };
            same_person(std::slice::from_ref(&camera), &[noise]).err().map(|error| error.to_string())
        };
        assert_eq!(refusal([30.0, -20.0]), None);
        let message =
            "`left` shows somebody else: the keypoints lie 500 px from where the other cameras see the person";
        assert_eq!(refusal([300.0, -400.0]).as_deref(), Some(message));
        assert!(refusal([f64::NAN, 0.0]).is_some());
    }
}
