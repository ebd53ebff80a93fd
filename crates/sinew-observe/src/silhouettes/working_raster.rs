//! Images as a smaller camera with a perfect lens would have taken them: what bodies are compared with.
//!
//! Straight edges of a body stay straight there, so that outlines need no lens. Each pixel takes the pixel of the image in which its centre lies, looked up in a table that is made once; pixels that the image does not have are
//! background.

use crate::silhouettes::bit_image::BitImage;
use crate::{Camera, Lens, RgbImage};

/// The raster in which one camera's images are compared.
#[derive(Clone, Debug, PartialEq)]
pub struct WorkingRaster {
    camera: Camera,
    size: [usize; 2],
    /// For each pixel, row after row, that of the image.
    from: Vec<Option<[u32; 2]>>,
}

impl WorkingRaster {
    /// The raster of images of `camera` (which is calibrated for their size, pixels), `factor` times smaller along both sides; 0 counts as 1.
    #[must_use]
    pub fn new(camera: &Camera, factor: usize) -> Self {
        let factor = factor.max(1) as f64;
        let size = camera.image_size_px.map(|side| (side / factor).ceil().max(1.0) as usize);
        let ideal = Camera { lens: Lens::default(), ..camera.resized(1.0 / factor) };
        let ideal = Camera { image_size_px: size.map(|side| side as f64), ..ideal };
        let [width, height] = camera.image_size_px;
        let source = |x: usize, y: usize| {
            let at = ideal.normalised_from_pixel([x as f64 + 0.5, y as f64 + 0.5]);
            let [u, v] = camera.pixel_from_normalised(camera.lens.distorted(at)?);
            ((0.0..width).contains(&u) && (0.0..height).contains(&v)).then_some([u as u32, v as u32])
        };
        let from = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))).map(|(x, y)| source(x, y)).collect();
        Self { camera: ideal, size, from }
    }

    /// The smallest factor with which the longer side of a camera's images has at most `longest` pixels.
    #[must_use]
    pub fn factor_for(camera: &Camera, longest: usize) -> usize {
        let side = camera.image_size_px[0].max(camera.image_size_px[1]);
        (side / longest.max(1) as f64).ceil().max(1.0) as usize
    }

    /// The camera with a perfect lens that takes such images.
    #[must_use]
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Width and height, pixels.
    #[must_use]
    pub const fn size(&self) -> [usize; 2] {
        self.size
    }

    fn source(&self, x: usize, y: usize) -> Option<[usize; 2]> {
        self.from.get(y * self.size[0] + x).copied().flatten().map(|at| at.map(|x| x as usize))
    }

    /// A silhouette in this raster.
    #[must_use]
    pub fn silhouette(&self, image: &BitImage) -> BitImage {
        let [width, height] = self.size;
        BitImage::from_fn(width, height, |x, y| self.source(x, y).is_some_and(|[x, y]| image.get(x, y)))
    }

    /// A picture in this raster; black where there is none.
    #[must_use]
    pub fn picture(&self, image: &RgbImage) -> RgbImage {
        let [width, height] = self.size;
        let colour = |at: &Option<[u32; 2]>| {
            let [x, y] = at.map(|at| at.map(|x| x as usize))?;
            if x < image.width { image.pixels.get(y * image.width + x).copied() } else { None }
        };
        RgbImage { width, height, pixels: self.from.iter().map(|at| colour(at).unwrap_or_default()).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cameras::lens::Brown;

    fn camera(lens: impl Into<Lens>) -> Camera {
        let camera = Camera::look_at("C", [320.0, 240.0], 300.0, [0.0, -4.0, 1.0], [0.0, 0.0, 1.0]).expect("a view");
        Camera { lens: lens.into(), ..camera }
    }

    /// What the lens has moved is where a perfect lens would have shown it.
    #[test]
    fn a_point_is_found_where_the_ideal_camera_sees_it() {
        let camera = camera(Brown { k1: -0.3, p1: 0.01, ..Brown::default() });
        let raster = WorkingRaster::new(&camera, 2);
        assert_eq!((raster.size(), raster.camera().image_size_px), ([160, 120], [160.0, 120.0]));
        for point in [[0.3, 0.0, 1.2], [-1.4, 0.1, 1.9], [1.5, 0.2, 0.1]] {
            let [u, v] = camera.project(point).pixel().expect("in front");
            let spot = BitImage::from_fn(320, 240, |x, y| {
                (x as f64 + 0.5 - u).abs() < 3.0 && (y as f64 + 0.5 - v).abs() < 3.0
            });
            let [u, v] = raster.camera().project(point).pixel().expect("in front");
            let seen = raster.silhouette(&spot);
            assert!(seen.get(u as usize, v as usize), "{point:?} at {u}, {v}");
            assert!((5..15).contains(&seen.count()), "{}", seen.count());
        }
    }

    #[test]
    fn with_a_perfect_lens_and_factor_one_nothing_changes() {
        let raster = WorkingRaster::new(&camera(Lens::default()), 1);
        let image = BitImage::from_fn(320, 240, |x, y| (x * x + y * 3) % 7 == 0);
        assert_eq!(raster.silhouette(&image), image);
        let pixels = (0..320 * 240).map(|k| [k as u8, (k >> 8) as u8, 7]).collect();
        let picture = RgbImage { width: 320, height: 240, pixels };
        assert_eq!(raster.picture(&picture), picture);
        assert_eq!(
            [100, 160, 319, 320, 900].map(|most| WorkingRaster::factor_for(raster.camera(), most)),
            [4, 2, 2, 1, 1]
        );
    }

    /// Pixels that the image lacks are background.
    #[test]
    fn what_was_not_taken_is_background() {
        let raster = WorkingRaster::new(&camera(Brown { k1: 0.5, ..Brown::default() }), 1);
        let all = raster.silhouette(&BitImage::from_fn(320, 240, |_, _| true));
        assert!(!all.get(0, 0) && all.get(160, 120) && all.count() < 320 * 240);
    }
}
