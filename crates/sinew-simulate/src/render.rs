//! Silhouettes and pictures of solids, exact by the pixel.
//!
//! A pixel shows what the ray through its centre meets first, through any lens that can be undone.
//!
//! Pixel (x, y) has its centre at (x + ½, y + ½). A [`RayCamera`] keeps the place before the lens of every pixel, and of every row and column the least and greatest place: a
//! solid is asked only for pixels whose row and column overlap its bounds. No supersampling.
//!
//! Pictures: Lambert's cosine law with one light and an ambient part, the colour by material; behind it a floor of tiles and a wall with panels, fixed in the world, and noise of
//! the sensor.

use crate::cast::Cast;
use crate::draws::normals;
use crate::evaluation_body::{Material, MaterialSolid};
use crate::space::{Vector, along, dot};
use sinew_core::random::Stage;
use sinew_observe::silhouettes::bit_image::BitImage;
use sinew_observe::{Camera, RgbImage};
use std::ops::Range;

/// A camera with the place before the lens of each of its pixels.
#[derive(Clone, Debug)]
pub struct RayCamera {
    camera: Camera,
    width: usize,
    height: usize,
    /// NaN where the lens cannot be undone.
    places: Vec<[f64; 2]>,
    columns: Vec<[f64; 2]>,
    rows: Vec<[f64; 2]>,
}

impl RayCamera {
    /// Works out the rays of a camera.
    #[must_use]
    pub fn new(camera: &Camera) -> Self {
        let [width, height] = camera.image_size_px.map(|size| size.round().max(0.0) as usize);
        let place = |x: usize, y: usize| {
            let observed = camera.normalised_from_pixel([x as f64 + 0.5, y as f64 + 0.5]);
            camera.lens.undistorted(observed).unwrap_or([f64::NAN; 2])
        };
        let places: Vec<[f64; 2]> =
            (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| place(x, y)).collect();
        let mut columns = vec![NOTHING; width];
        let mut rows = vec![NOTHING; height];
        for (i, [x, y]) in places.iter().enumerate() {
            let (column, row) = (&mut columns[i % width], &mut rows[i / width]);
            // Minimum and maximum pass over NaN.
            *column = [column[0].min(*x), column[1].max(*x)];
            *row = [row[0].min(*y), row[1].max(*y)];
        }
        Self { camera: camera.clone(), width, height, places, columns, rows }
    }

    /// The camera.
    #[must_use]
    pub const fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Pixels in which some solid is seen.
    #[must_use]
    pub fn silhouette(&self, solids: &[MaterialSolid]) -> BitImage {
        let mut covered = vec![false; self.places.len()];
        for cast in solids.iter().filter_map(|solid| Cast::new(&self.camera, &solid.shape)) {
            self.each_pixel(&cast, |i, place| {
                if !covered[i] && cast.entry(place).is_some() {
                    covered[i] = true;
                }
            });
        }
        bit_image(self.width, self.height, &covered)
    }

    /// Pixels whose ray meets the ground (z = 0) inside an ellipse about a point, metres, with its long axis at an angle to the x axis, radians.
    #[must_use]
    pub fn ground_ellipse(&self, centre: [f64; 2], half_axes: [f64; 2], angle: f64) -> BitImage {
        let (sin, cos) = angle.sin_cos();
        let from = self.camera.centre();
        let inside = |place: &[f64; 2]| {
            self.ground(from, *place).is_some_and(|(ground, _)| {
                let [x, y] = [ground[0] - centre[0], ground[1] - centre[1]];
                let [a, b] = [(cos * x + sin * y) / half_axes[0], (cos * y - sin * x) / half_axes[1]];
                a * a + b * b <= 1.0
            })
        };
        bit_image(self.width, self.height, &self.places.iter().map(inside).collect::<Vec<_>>())
    }

    /// The empty room: the same in every frame, another with another seed.
    #[must_use]
    pub fn room(&self, seed: u64) -> RgbImage {
        let centre = self.camera.centre();
        let pixel = |place: &[f64; 2]| {
            if let Some((ground, away)) = self.ground(centre, *place).filter(|(_, away)| *away < WALL_M) {
                return floor(ground, away, seed);
            }
            let ray = self.in_world([place[0], place[1], 1.0]);
            let flat = ray[0].hypot(ray[1]).max(1e-9);
            wall(ray[1].atan2(ray[0]), centre[2] + WALL_M * ray[2] / flat, seed)
        };
        RgbImage { width: self.width, height: self.height, pixels: self.places.iter().map(pixel).collect() }
    }

    /// The solids before a room, with noise of the sensor from a stage.
    #[must_use]
    pub fn picture(&self, solids: &[MaterialSolid], room: &RgbImage, stage: &Stage) -> RgbImage {
        let casts: Vec<(Cast, Material)> =
            solids.iter().filter_map(|solid| Some((Cast::new(&self.camera, &solid.shape)?, solid.material))).collect();
        let mut nearest = vec![(f64::INFINITY, 0); self.places.len()];
        for (k, (cast, _)) in casts.iter().enumerate() {
            self.each_pixel(cast, |i, place| {
                if let Some(depth) = cast.entry(place).filter(|depth| *depth < nearest[i].0) {
                    nearest[i] = (depth, k);
                }
            });
        }
        let light = self.camera.rotation.map(|row| dot(row, LIGHT));
        let mut pixels = room.pixels.clone();
        for (y, row) in pixels.chunks_mut(self.width.max(1)).enumerate() {
            let noise = normals(stage, u32::try_from(y).unwrap_or(u32::MAX), row.len());
            for ((x, pixel), noise) in row.iter_mut().enumerate().zip(noise) {
                let i = y * self.width + x;
                let (depth, k) = nearest[i];
                let mut colour = pixel.map(f64::from);
                if depth.is_finite() {
                    let (cast, material) = &casts[k];
                    let lit = AMBIENT + (1.0 - AMBIENT) * dot(cast.normal(self.places[i], depth), light).max(0.0);
                    colour = paint(*material).map(|c| lit * c);
                }
                *pixel = colour.map(|c| (c + SENSOR_SD * noise).round().clamp(0.0, 255.0) as u8);
            }
        }
        RgbImage { width: self.width, height: self.height, pixels }
    }

    /// Calls with the index and place of every pixel that a solid may cover.
    fn each_pixel(&self, cast: &Cast, mut call: impl FnMut(usize, [f64; 2])) {
        let columns = overlapping(&self.columns, cast.bounds[0]);
        for y in overlapping(&self.rows, cast.bounds[1]) {
            for x in columns.clone() {
                let i = y * self.width + x;
                if !self.places[i][0].is_nan() {
                    call(i, self.places[i]);
                }
            }
        }
    }

    fn in_world(&self, v: Vector) -> Vector {
        let [a, b, c] = self.camera.rotation;
        [0, 1, 2].map(|i: usize| a[i] * v[0] + b[i] * v[1] + c[i] * v[2])
    }

    /// Where a pixel's ray from the centre of projection meets the ground, and how far away over ground that is.
    fn ground(&self, centre: Vector, place: [f64; 2]) -> Option<(Vector, f64)> {
        let ray = self.in_world([place[0], place[1], 1.0]);
        let depth = -centre[2] / ray[2];
        let away = depth * ray[0].hypot(ray[1]);
        (depth > 0.0 && away.is_finite()).then(|| (along(centre, depth, ray), away))
    }
}

/// Bounds of what has no pixel.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// From the first to the last of some intervals that overlap another.
fn overlapping(intervals: &[[f64; 2]], [low, high]: [f64; 2]) -> Range<usize> {
    let meets = |interval: &[f64; 2]| interval[0] <= high && interval[1] >= low;
    let first = intervals.iter().position(meets).unwrap_or(0);
    first..intervals.iter().rposition(meets).map_or(first, |last| last + 1)
}

/// An image from a flag for every pixel, rows first.
pub(super) fn bit_image(width: usize, height: usize, covered: &[bool]) -> BitImage {
    BitImage::from_fn(width, height, |x, y| covered[y * width + x])
}

/// Distance of the wall from the camera over ground, metres.
const WALL_M: f64 = 11.0;
/// Direction towards the light, nearly a unit vector.
const LIGHT: Vector = [0.40, -0.30, 0.866];
/// Share of light that comes from everywhere.
const AMBIENT: f64 = 0.45;
/// Standard deviation of the sensor's noise, of 255.
const SENSOR_SD: f64 = 3.0;

/// Colour in full light.
const fn paint(material: Material) -> [f64; 3] {
    match material {
        Material::Skin => [226.0, 172.0, 140.0],
        Material::Hair => [70.0, 48.0, 34.0],
        Material::Shirt => [196.0, 52.0, 48.0],
        Material::Trousers => [46.0, 66.0, 138.0],
        Material::Shoes => [44.0, 42.0, 40.0],
    }
}

/// Colour of the floor: square tiles of half a metre with grain, darker from afar.
fn floor(point: Vector, away: f64, seed: u64) -> [u8; 3] {
    let tile = point.map(|x| (x / 0.5).floor() as i64);
    let shade = if (tile[0] + tile[1]).rem_euclid(2) == 0 { 1.0 } else { 0.86 };
    let grain = grain([point[0] / 0.07, point[1] / 0.07], seed) + grain([point[0] / 0.6, point[1] / 0.6], seed ^ 1);
    let light = shade * (1.0 - 0.02 * away) * (1.0 + 0.08 * grain);
    [150.0, 140.0, 122.0].map(|c| (c * light).round().clamp(0.0, 255.0) as u8)
}

/// Colour of the wall at an azimuth (radians) and a height (metres): panels of 12°, a dark base, grain.
fn wall(azimuth: f64, height: f64, seed: u64) -> [u8; 3] {
    let panel = (azimuth.to_degrees() / 12.0).floor() as i64;
    let tint = 0.25 * hash(panel, 0, seed ^ 2);
    let base = if height < 0.3 { 0.7 } else { 1.0 };
    let grain = grain([azimuth * 40.0, height / 0.25], seed ^ 3);
    let light = base * (1.0 + 0.06 * grain - tint);
    [164.0, 170.0, 168.0].map(|c| (c * light).round().clamp(0.0, 255.0) as u8)
}

/// Smooth noise between −1 and 1 with a cell of 1: bilinear between random corners.
fn grain([x, y]: [f64; 2], seed: u64) -> f64 {
    let (i, j) = (x.floor(), y.floor());
    let (u, v) = (x - i, y - j);
    let corner = |di: i64, dj: i64| 2.0 * hash(i as i64 + di, j as i64 + dj, seed) - 1.0;
    (1.0 - v) * ((1.0 - u) * corner(0, 0) + u * corner(1, 0)) + v * ((1.0 - u) * corner(0, 1) + u * corner(1, 1))
}

/// A number in \[0, 1) of a cell (the mixing of SplitMix64; Steele, Lea & Flood 2014).
fn hash(i: i64, j: i64, seed: u64) -> f64 {
    let mut z = seed ^ (i as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (j as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation_body::ConvexShape;
    use sinew_observe::cameras::lens::Brown;

    fn cameras() -> [Camera; 2] {
        let straight = Camera::look_at("C1", [160.0, 120.0], 150.0, [2.5, -3.0, 2.2], [0.0, 0.0, 1.0]).unwrap();
        let lens = Brown { k1: -0.25, k2: 0.06, p1: 2e-3, p2: -1e-3, k3: 0.0 };
        [straight.clone(), Camera { lens: lens.into(), ..straight }]
    }

    fn solids() -> Vec<MaterialSolid> {
        let capsule =
            |ends, radii| MaterialSolid { shape: ConvexShape::Capsule { ends, radii }, material: Material::Shirt };
        let half_axes = [[0.2, 0.1, 0.0], [-0.05, 0.1, 0.0], [0.0, 0.0, 0.3]];
        vec![
            capsule([[0.0, 0.0, 1.0], [0.3, 0.1, 1.5]], [0.15, 0.07]),
            capsule([[-0.9, 0.2, 0.4], [-0.2, 0.1, 0.9]], [0.04, 0.09]),
            MaterialSolid {
                shape: ConvexShape::Ellipsoid { centre: [0.2, 0.1, 0.5], half_axes },
                material: Material::Trousers,
            },
        ]
    }

    /// Neither bounds nor lens cut anything off: every pixel is tested against every solid.
    #[test]
    fn a_silhouette_is_where_rays_meet_a_solid() {
        for camera in cameras() {
            let view = RayCamera::new(&camera);
            let silhouette = view.silhouette(&solids());
            let casts: Vec<Cast> = solids().iter().map(|solid| Cast::new(&camera, &solid.shape).unwrap()).collect();
            for y in 0..120 {
                for x in 0..160 {
                    let place = camera.lens.undistorted(camera.normalised_from_pixel([x as f64 + 0.5, y as f64 + 0.5]));
                    let expected = place.is_some_and(|place| casts.iter().any(|cast| cast.entry(place).is_some()));
                    assert_eq!(silhouette.get(x, y), expected, "{x} {y}");
                }
            }
            assert!((400..1000).contains(&silhouette.count()), "{}", silhouette.count());
        }
    }

    /// Points of the solids, projected by the camera, against the silhouette: pixels around the image of an inner point are covered.
    #[test]
    fn points_of_a_solid_appear_inside_its_silhouette() {
        for camera in cameras() {
            let silhouette = RayCamera::new(&camera).silhouette(&solids());
            for k in 0..=20 {
                let s = f64::from(k) / 20.0;
                for [dx, dz] in [[0.0, 0.0], [0.6, 0.0], [-0.6, 0.0], [0.0, 0.6], [0.0, -0.6]] {
                    let radius = 0.15 - 0.08 * s;
                    let point = [0.3 * s + radius * dx, 0.1 * s, 1.0 + 0.5 * s + radius * dz];
                    let [u, v] = camera.project(point).pixel().unwrap();
                    assert!(silhouette.get(u as usize, v as usize), "{point:?} at {u} {v}");
                }
            }
        }
    }

    #[test]
    fn a_lens_moves_the_silhouette() {
        let [straight, bent] = cameras().map(|camera| RayCamera::new(&camera).silhouette(&solids()));
        assert!(straight != bent);
    }

    #[test]
    fn the_nearest_solid_is_what_is_seen() {
        let camera = &cameras()[0];
        let view = RayCamera::new(camera);
        let ball = |m: f64, material| {
            let centre = along(camera.centre(), m, camera.rotation[2]);
            MaterialSolid { shape: ConvexShape::Capsule { ends: [centre; 2], radii: [0.3; 2] }, material }
        };
        let room = view.room(1);
        let middle =
            |solids: &[MaterialSolid]| view.picture(solids, &room, &Stage::new(1, "test")).pixels[60 * 160 + 80];
        let near = middle(&[ball(3.0, Material::Trousers), ball(2.0, Material::Shirt)]);
        assert!(near[0] > near[2], "{near:?}");
        let other = middle(&[ball(3.0, Material::Shirt), ball(2.0, Material::Trousers)]);
        assert!(other[0] < other[2], "{other:?}");
        assert!(view.picture(&[], &room, &Stage::new(1, "test")) != view.picture(&[], &room, &Stage::new(2, "test")));
    }

    #[test]
    fn ellipses_on_the_ground_are_where_their_points_are() {
        for camera in cameras() {
            let blob = RayCamera::new(&camera).ground_ellipse([0.2, 0.3], [0.8, 0.3], 0.5);
            let at = |along_it: f64, across: f64| {
                let (sin, cos) = 0.5_f64.sin_cos();
                let [x, y] = [0.2 + cos * along_it - sin * across, 0.3 + sin * along_it + cos * across];
                let [u, v] = camera.project([x, y, 0.0]).pixel().unwrap();
                blob.get(u as usize, v as usize)
            };
            assert!(at(0.0, 0.0) && at(0.7, 0.0) && at(-0.7, 0.0) && at(0.0, 0.25));
            assert!(!at(0.95, 0.0) && !at(0.0, 0.45) && !at(0.6, 0.3));
        }
    }

    #[test]
    fn runs_of_flags_become_pixels() {
        for (width, height) in [(1, 3), (5, 4), (64, 2), (70, 3)] {
            let covered: Vec<bool> = (0..width * height).map(|i| (i * i) % 7 < 3).collect();
            let image = bit_image(width, height, &covered);
            assert!((0..covered.len()).all(|i| image.get(i % width, i / width) == covered[i]));
        }
        assert_eq!(bit_image(0, 3, &[]).count(), 0);
    }
}
