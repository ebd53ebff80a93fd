//! Virtual cameras on a circle around a motion.
//!
//! With the smallest box around all points of the motion, the circle has the radius 2.5 m + half the box's longer horizontal side (at least 4 m) about the middle of the box.
//! Camera k stands [`Ring::height_m`] high at the azimuth 45° + 360° k/n (from x towards y) and looks at the middle at [`Ring::target_height_m`]. Its focal length lets a subject
//! of [`Ring::subject_m`] at the middle span the fraction [`Ring::span`] of the image's height, or less where a point of the motion would come closer to the border of
//! an image than 5 % of half its size ([`Ring::flesh_m`] around it included); it is the same for all cameras. No distortion; the principal point is the middle of the image.

use crate::detector::pixel;
use sinew_body::points::Trajectories;
use sinew_observe::{Camera, Error};
use std::f64::consts::TAU;

/// How cameras stand around a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ring {
    /// Number of cameras.
    pub cameras: usize,
    /// Height of the cameras, metres.
    pub height_m: f64,
    /// Height of the point they look at, metres.
    pub target_height_m: f64,
    /// Smallest radius of the circle, metres.
    pub least_radius_m: f64,
    /// Radius beyond half the motion's extent, metres.
    pub margin_m: f64,
    /// Width and height of the images, pixels.
    pub image_size_px: [f64; 2],
    /// Height of the subject, metres.
    pub subject_m: f64,
    /// Fraction of the image's height that the subject spans at the middle.
    pub span: f64,
    /// Flesh around the points of the motion, metres: it keeps as far from the border of an image as the points without it.
    pub flesh_m: f64,
}

impl Ring {
    /// Cameras of the experiments on silhouettes: images of 320 × 240 pixels, and room for flesh and hands around the joints.
    pub const SMALL_PICTURES: Self = Self { image_size_px: [320.0, 240.0], flesh_m: 0.08, ..Self::WIDE_PICTURES };

    const WIDE_PICTURES: Self = Self {
        cameras: 4,
        height_m: 2.2,
        target_height_m: 1.0,
        least_radius_m: 4.0,
        margin_m: 2.5,
        image_size_px: [1280.0, 960.0],
        subject_m: 1.75,
        span: 0.6,
        flesh_m: 0.0,
    };
}

impl Default for Ring {
    fn default() -> Self {
        Self::WIDE_PICTURES
    }
}

/// Cameras `C1`, `C2`, … around a motion; around the origin where it has no points.
///
/// # Errors
/// Sizes and lengths of the ring that are not finite and positive.
pub fn around(motion: &Trajectories, ring: &Ring) -> Result<Vec<Camera>, Error> {
    let [low, high] = motion.bounds().unwrap_or_default();
    let centre = [0, 1].map(|i| 0.5 * (low[i] + high[i]));
    let extent = (high[0] - low[0]).max(high[1] - low[1]);
    let radius = (ring.margin_m + 0.5 * extent).max(ring.least_radius_m);
    let focal = ring.span * ring.image_size_px[1] * radius.hypot(ring.height_m - ring.target_height_m) / ring.subject_m;
    let target = [centre[0], centre[1], ring.target_height_m];
    let cameras = |focal: f64| -> Result<Vec<Camera>, Error> {
        let camera = |k: usize| {
            let (sin, cos) = (TAU * (0.125 + k as f64 / ring.cameras as f64)).sin_cos();
            let place = [centre[0] + radius * cos, centre[1] + radius * sin, ring.height_m];
            Camera::look_at(&format!("C{}", k + 1), ring.image_size_px, focal, place, target)
        };
        (0..ring.cameras).map(camera).collect()
    };
    let reach = cameras(focal)?.iter().map(|camera| reach(camera, motion, ring.flesh_m)).fold(0.0, f64::max);
    cameras(focal * (INSIDE / reach).min(1.0))
}

/// Height in pixels that a camera gives the subject of a ring who stands at the middle of a motion, and the motion's longer horizontal extent, metres.
#[must_use]
pub fn subject_px_and_extent_m(camera: &Camera, motion: &Trajectories, ring: &Ring) -> (f64, f64) {
    let [low, high] = motion.bounds().unwrap_or_default();
    let middle = [0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), ring.target_height_m];
    let squares: f64 = camera.centre().iter().zip(middle).map(|(a, b)| (a - b) * (a - b)).sum();
    (ring.subject_m * camera.intrinsics.fx / squares.sqrt(), (high[0] - low[0]).max(high[1] - low[1]))
}

/// Fraction of half an image that a motion may use.
const INSIDE: f64 = 0.95;

/// Largest distance of a motion's points and the flesh around them from the middle of the image, as a fraction of half the image; proportional to the focal length.
fn reach(camera: &Camera, motion: &Trajectories, flesh_m: f64) -> f64 {
    let half = camera.image_size_px.map(|size| 0.5 * size);
    let points = motion.frames.iter().flatten();
    let pixels = points.filter_map(|&point| Some((pixel(camera, point)?, camera.point_in_camera(point)[2])));
    pixels.fold(0.0, |reach, (p, depth)| {
        let flesh = flesh_m * camera.intrinsics.fx / depth;
        (0..2).map(|i| (p[i] / half[i] - 1.0).abs() + flesh / half[i]).fold(reach, f64::max)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion() -> Trajectories {
        let frames = vec![vec![[-0.4, 0.0, 0.0], [0.4, 0.3, 1.75]], vec![[0.0, 5.0, 0.9], [0.1, 4.7, 1.0]]];
        Trajectories { names: vec!["A".into(), "B".into()], frames }
    }

    #[test]
    fn cameras_look_at_the_middle_with_their_heads_up() {
        let cameras = around(&motion(), &Ring::default()).unwrap();
        assert_eq!(cameras.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), ["C1", "C2", "C3", "C4"]);
        for camera in &cameras {
            let [u, v] = pixel(camera, [0.0, 2.5, 1.0]).unwrap();
            assert!((u - 640.0).abs() < 1e-9 && (v - 480.0).abs() < 1e-9);
            let above = pixel(camera, [0.0, 2.5, 1.5]).unwrap();
            assert!((above[0] - 640.0).abs() < 1e-9 && above[1] < 480.0);
            let span = pixel(camera, [0.0, 2.5, 0.0]).unwrap()[1] - pixel(camera, [0.0, 2.5, 1.75]).unwrap()[1];
            assert!((0.3..0.65).contains(&(span / 960.0)), "{span}");
        }
    }

    #[test]
    fn the_subject_shrinks_with_the_way() {
        let along = |metres: f64| {
            let frames = vec![vec![[0.0, 0.0, 0.0], [0.0, 0.0, 1.75]], vec![[0.0, metres, 0.0], [0.0, metres, 1.75]]];
            let motion = Trajectories { names: vec!["A".into(), "B".into()], frames };
            let cameras = around(&motion, &Ring::default()).unwrap();
            subject_px_and_extent_m(&cameras[0], &motion, &Ring::default())
        };
        let (near, far) = (along(0.0), along(70.0));
        // 0.6 of the image's height, unless the way needs more.
        assert!((near.0 - 576.0).abs() < 1.0 && near.1 == 0.0, "{near:?}");
        assert!(far.0 < 40.0 && far.1 == 70.0, "{far:?}");
    }

    #[test]
    fn the_focal_length_gives_way_to_a_wide_motion() {
        let mut motion = motion();
        motion.frames.push(vec![[0.0, 2.5, 2.8]; 2]);
        let cameras = around(&motion, &Ring::default()).unwrap();
        let reach = cameras.iter().map(|camera| reach(camera, &motion, 0.0)).fold(0.0, f64::max);
        assert!((reach - 0.95).abs() < 1e-9, "{reach}");
    }

    #[test]
    fn cameras_keep_their_distance() {
        for camera in around(&motion(), &Ring::default()).unwrap() {
            let place = camera.centre();
            assert!((place[0].hypot(place[1] - 2.5) - 5.0).abs() < 1e-9);
            assert!((place[2] - 2.2).abs() < 1e-9);
        }
    }

    #[test]
    fn a_subject_to_the_right_of_the_line_of_sight_is_on_the_right_of_the_image() {
        let camera = &around(&Trajectories::default(), &Ring::default()).unwrap()[0];
        // A viewer at azimuth 45° who looks along (−1, −1) has (−1, 1) on the right.
        let [u, _] = pixel(camera, [-1.0, 1.0, 1.0]).unwrap();
        assert!(u > 640.0);
    }
}
