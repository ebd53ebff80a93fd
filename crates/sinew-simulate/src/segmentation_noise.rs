//! A silhouette as segmentation of a real picture gives it.
//!
//! 1. Jitter of the border: the silhouette is smoothed by a Gaussian of 1.5 pixels; where that is neither 0 nor 1, a smooth Gaussian field is added and the sum compared with ½. The field has standard deviation 0.15 and correlation
//!    `exp(−d²/(2 · 4²))` at a distance of d pixels.
//! 2. With a shadow: a blob on the ground counts as person.
//! 3. Elliptical holes about random pixels of the person, 3 ± 1 of them, and false blobs about random other pixels, 2 ± 1; both axes uniform from 3 to 12 pixels, any direction.
//! 4. Salt and pepper: every pixel is turned over with probability 0.01.
//! 5. Median over 3 × 3 pixels; what lies outside the image counts as its border.
//!
//! [`Level::Normal`] does 1, 3, 4 and 5; [`Level::Hard`] all of it with twice the standard deviation, numbers and probability. Lengths in pixels hold for images of 240 rows and go with the height. Numbers of blobs are uniform
//! on their three (or five) values. What the field does and how many pixels are turned over depends on camera and frame alone, not on the frames before.

use crate::draws::{normals, uniforms};
use crate::render::bit_image;
use sinew_core::random::Stage;
use sinew_observe::silhouettes::bit_image::BitImage;
use std::f64::consts::TAU;
use std::ops::Range;

/// How badly silhouettes are segmented.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Level {
    /// Not at all.
    Clean,
    /// As usual.
    #[default]
    Normal,
    /// Twice that, and a shadow on the ground.
    Hard,
}

impl Level {
    /// All levels by their names.
    pub const ALL: [(&'static str, Self); 3] = [("clean", Self::Clean), ("normal", Self::Normal), ("hard", Self::Hard)];

    /// The level of that name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|(known, _)| *known == name).map(|(_, level)| level)
    }

    /// Whether it counts a shadow as person.
    #[must_use]
    pub const fn has_shadow(self) -> bool {
        matches!(self, Self::Hard)
    }

    const fn factor(self) -> usize {
        match self {
            Self::Clean => 0,
            Self::Normal => 1,
            Self::Hard => 2,
        }
    }
}

/// Rows of the image for which lengths are stated.
const ROWS: f64 = 240.0;
/// Standard deviation of the Gaussian that smooths a silhouette, pixels.
const SMOOTHING_PX: f64 = 1.5;
/// Standard deviation of the field.
const FIELD_SD: f64 = 0.15;
/// Correlation length of the field, pixels.
const FIELD_PX: f64 = 4.0;
/// Probability that a pixel is turned over.
const FLIP: f64 = 0.01;
const HOLES: usize = 3;
const FALSE_BLOBS: usize = 2;
/// Range of the axes of holes and false blobs, pixels.
const AXES_PX: [f64; 2] = [3.0, 12.0];

/// A silhouette with the errors of a level; `shadow` are the pixels of the shadow, used if the level has one. The stage belongs to a camera and a frame.
#[must_use]
pub fn segmented(silhouette: &BitImage, shadow: Option<&BitImage>, level: Level, stage: Stage) -> BitImage {
    if level == Level::Clean {
        return silhouette.clone();
    }
    let (width, height) = (silhouette.width(), silhouette.height());
    let [field, blobs, flips] = stage.split(["field", "blobs", "flips"]);
    let mut grid = Grid::of(silhouette);
    jitter_border(&mut grid, level, &field);
    if let Some(shadow) = shadow.filter(|_| level.has_shadow()) {
        grid.cells.iter_mut().zip(Grid::of(shadow).cells).for_each(|(cell, shadow)| *cell |= shadow);
    }
    add_blobs(&mut grid, level, &blobs);
    turn_over(&mut grid, level, &flips);
    bit_image(width, height, &median(&grid))
}

fn row_number(y: usize) -> u32 {
    u32::try_from(y).unwrap_or(u32::MAX)
}

/// A flag for every pixel, rows first.
struct Grid {
    width: usize,
    height: usize,
    cells: Vec<bool>,
}

impl Grid {
    fn of(image: &BitImage) -> Self {
        let (width, height) = (image.width(), image.height());
        let cells = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| image.get(x, y)).collect();
        Self { width, height, cells }
    }

    /// Factor on lengths in pixels.
    fn scale(&self) -> f64 {
        self.height as f64 / ROWS
    }

    /// Columns and rows from the first to the last flag, with `margin` more on each side.
    fn extent(&self, margin: usize) -> Option<[Range<usize>; 2]> {
        let set =
            || self.cells.iter().enumerate().filter(|(_, set)| **set).map(|(i, _)| [i % self.width, i / self.width]);
        let first = set().next()?;
        let [low, high] = set().fold([first; 2], |[low, high], p| {
            [[low[0].min(p[0]), low[1].min(p[1])], [high[0].max(p[0]), high[1].max(p[1])]]
        });
        let ends = [self.width, self.height];
        Some([0, 1].map(|i: usize| low[i].saturating_sub(margin)..(high[i] + 1 + margin).min(ends[i])))
    }
}

/// Weights of a Gaussian at whole distances from −n to n, with sum 1.
fn weights(sd: f64) -> Vec<f64> {
    let reach = (3.0 * sd).ceil().max(1.0) as i32;
    let raw: Vec<f64> = (-reach..=reach).map(|d| (-0.5 * (f64::from(d) / sd).powi(2)).exp()).collect();
    let sum: f64 = raw.iter().sum();
    raw.iter().map(|w| w / sum).collect()
}

/// A field smoothed along rows and columns; outside it is 0.
fn smoothed(field: &[f64], width: usize, weights: &[f64]) -> Vec<f64> {
    let reach = weights.len() / 2;
    let height = field.len() / width.max(1);
    let mut rows = vec![0.0; field.len()];
    for (from, to) in field.chunks(width.max(1)).zip(rows.chunks_mut(width.max(1))) {
        for (k, weight) in weights.iter().enumerate() {
            // Cell x takes from cell x + k − reach.
            let first = reach.saturating_sub(k);
            let last = (width + reach).saturating_sub(k).min(width);
            for x in first..last {
                to[x] += weight * from[x + k - reach];
            }
        }
    }
    let mut all = vec![0.0; field.len()];
    for y in 0..height {
        for (k, weight) in weights.iter().enumerate() {
            let Some(other) = (y + k).checked_sub(reach).filter(|other| *other < height) else { continue };
            let (to, from) = (&mut all[y * width..][..width], &rows[other * width..][..width]);
            to.iter_mut().zip(from).for_each(|(to, from)| *to += weight * from);
        }
    }
    all
}

/// Part 1. Works on the part of the image around the silhouette: elsewhere nothing can change.
fn jitter_border(grid: &mut Grid, level: Level, stage: &Stage) {
    let smoothing = weights(SMOOTHING_PX * grid.scale());
    // White noise smoothed by a Gaussian of ℓ/√2 is correlated by exp(−d²/(2ℓ²)).
    let field = weights(FIELD_PX * grid.scale() / 2_f64.sqrt());
    let (near, far) = (smoothing.len() / 2, field.len() / 2);
    let Some([columns, rows]) = grid.extent(near + far) else { return };
    let width = columns.len();
    let (mut inside, mut noise) = (Vec::new(), Vec::new());
    for y in rows.clone() {
        let row = &grid.cells[y * grid.width..][..grid.width];
        inside.extend(row[columns.clone()].iter().map(|set| f64::from(u8::from(*set))));
        noise.extend_from_slice(&normals(stage, row_number(y), grid.width)[columns.clone()]);
    }
    // The variance left of white noise by smoothing along both axes is (Σ w²)².
    let left: f64 = field.iter().map(|w| w * w).sum();
    let size = FIELD_SD * level.factor() as f64 / left;
    let soft = smoothed(&inside, width, &smoothing);
    let field = smoothed(&noise, width, &field);
    for (k, (soft, field)) in soft.iter().zip(&field).enumerate() {
        if *soft > 1e-9 && *soft < 1.0 - 1e-9 {
            let (x, y) = (columns.start + k % width, rows.start + k / width);
            grid.cells[y * grid.width + x] = soft + size * field > 0.5;
        }
    }
}

/// Part 3.
fn add_blobs(grid: &mut Grid, level: Level, stage: &Stage) {
    let [numbers, places] = [0, 1].map(|block| uniforms(stage, block, 128));
    let mut places = places.chunks_exact(4);
    let factor = level.factor();
    for (k, mean, fills) in [(0, HOLES, false), (1, FALSE_BLOBS, true)] {
        let candidates: Vec<usize> = (0..grid.cells.len()).filter(|&i| grid.cells[i] != fills).collect();
        let values = (2 * factor + 1) as f64;
        let count = factor * mean - factor + (numbers[k] * values) as usize;
        for u in places.by_ref().take(count) {
            let Some(&centre) = candidates.get((u[0] * candidates.len() as f64) as usize) else { continue };
            let half = [u[1], u[2]].map(|u| 0.5 * grid.scale() * (AXES_PX[0] + u * (AXES_PX[1] - AXES_PX[0])));
            draw_ellipse(grid, [centre % grid.width, centre / grid.width], half, TAU * u[3], fills);
        }
    }
}

fn draw_ellipse(grid: &mut Grid, centre: [usize; 2], half_axes: [f64; 2], angle: f64, value: bool) {
    let reach = half_axes[0].max(half_axes[1]).ceil() as usize;
    let (sin, cos) = angle.sin_cos();
    let around = |middle: usize, end: usize| middle.saturating_sub(reach)..(middle + reach + 1).min(end);
    for y in around(centre[1], grid.height) {
        for x in around(centre[0], grid.width) {
            let [dx, dy] = [x as f64 - centre[0] as f64, y as f64 - centre[1] as f64];
            let [a, b] = [(cos * dx + sin * dy) / half_axes[0], (cos * dy - sin * dx) / half_axes[1]];
            if a * a + b * b <= 1.0 {
                grid.cells[y * grid.width + x] = value;
            }
        }
    }
}

/// Part 4.
fn turn_over(grid: &mut Grid, level: Level, stage: &Stage) {
    let probability = FLIP * level.factor() as f64;
    let width = grid.width;
    for (y, row) in grid.cells.chunks_mut(width.max(1)).enumerate() {
        let chance = uniforms(stage, row_number(y), width);
        row.iter_mut().zip(chance).for_each(|(cell, u)| *cell ^= u < probability);
    }
}

/// Part 5.
fn median(grid: &Grid) -> Vec<bool> {
    let (width, height) = (grid.width, grid.height);
    // Of each pixel, flags in its column of three.
    let threes: Vec<u8> = (0..grid.cells.len())
        .map(|i| {
            let (x, y) = (i % width, i / width);
            let row = |y: usize| u8::from(grid.cells[y * width + x]);
            row(y.saturating_sub(1)) + row(y) + row((y + 1).min(height - 1))
        })
        .collect();
    (0..grid.cells.len())
        .map(|i| {
            let (x, row) = (i % width, i - i % width);
            threes[row + x.saturating_sub(1)] + threes[i] + threes[row + (x + 1).min(width - 1)] > 4
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEVELS: [Level; 2] = [Level::Normal, Level::Hard];

    fn disc(radius: f64) -> BitImage {
        BitImage::from_fn(320, 240, |x, y| {
            let half = (radius * radius - (y as f64 - 120.0).powi(2)).max(0.0).sqrt() as usize;
            (160 - half..160 + half).contains(&x)
        })
    }

    fn stage(frame: u32) -> Stage {
        Stage::new(1, "test").at_frame(frame)
    }

    fn differing(a: &BitImage, b: &BitImage, of: impl Fn(usize, usize) -> bool) -> usize {
        let all = (0..a.height()).flat_map(|y| (0..a.width()).map(move |x| (x, y)));
        all.filter(|&(x, y)| of(x, y) && a.get(x, y) != b.get(x, y)).count()
    }

    #[test]
    fn a_clean_silhouette_stays_as_it_is_and_a_seed_fixes_the_errors() {
        let (image, shadow) = (disc(40.0), disc(20.0));
        assert_eq!(segmented(&image, Some(&shadow), Level::Clean, stage(0)), image);
        for level in LEVELS {
            let of = |frame| segmented(&image, None, level, stage(frame));
            assert_eq!(of(3), of(3));
            assert!(of(3) != of(4));
        }
        let none = BitImage::new(0, 0);
        assert_eq!(segmented(&none, None, Level::Hard, stage(0)), none);
    }

    /// 60 frames of 76 800 pixels: the share of turned pixels has a standard error of 0.5 %.
    #[test]
    fn one_pixel_in_a_hundred_is_turned_over() {
        for (level, expected) in [(Level::Normal, 0.01), (Level::Hard, 0.02)] {
            let mut turned = 0;
            for frame in 0..60 {
                let mut grid = Grid::of(&BitImage::new(320, 240));
                turn_over(&mut grid, level, &stage(frame));
                turned += grid.cells.iter().filter(|cell| **cell).count();
            }
            let share = turned as f64 / (60.0 * 76_800.0);
            assert!((share / expected - 1.0).abs() < 0.025, "{share}");
        }
    }

    /// In an image whose left half is person, patches that change; of a few that touch, one is missed, and at the middle some are cut.
    #[test]
    fn holes_and_false_blobs_are_as_many_and_as_large_as_stated() {
        for (level, most, mean) in [(Level::Normal, 7, 5.0), (Level::Hard, 14, 10.0)] {
            let (mut patches, mut pixels) = (0.0, 0.0);
            for frame in 0..200 {
                let cells: Vec<bool> = (0..76_800).map(|i| i % 320 < 160).collect();
                let mut grid = Grid { width: 320, height: 240, cells: cells.clone() };
                add_blobs(&mut grid, level, &stage(frame));
                let changed: Vec<bool> = grid.cells.iter().zip(&cells).map(|(a, b)| a != b).collect();
                let count = count_patches(&changed, 320);
                assert!(count <= most, "{count} of {most}");
                patches += count as f64;
                pixels += changed.iter().filter(|changed| **changed).count() as f64;
            }
            assert!((patches / 200.0 / mean - 1.0).abs() < 0.12, "{} of {mean}", patches / 200.0);
            // Area π/4 · E[axis]² with axes uniform from 3 to 12.
            let area = pixels / patches;
            assert!((36.0..52.0).contains(&area), "{area} pixels");
        }
    }

    fn count_patches(cells: &[bool], width: usize) -> usize {
        let mut seen = vec![false; cells.len()];
        let mut patches = 0;
        for start in 0..cells.len() {
            if !cells[start] || seen[start] {
                continue;
            }
            patches += 1;
            let mut open = vec![start];
            seen[start] = true;
            while let Some(i) = open.pop() {
                let (x, y) = (i % width, i / width);
                let around = [(x.wrapping_sub(1), y), (x + 1, y), (x, y.wrapping_sub(1)), (x, y + 1)];
                for (x, y) in around.into_iter().filter(|(x, y)| *x < width && *y < cells.len() / width) {
                    let j = y * width + x;
                    if cells[j] && !seen[j] {
                        seen[j] = true;
                        open.push(j);
                    }
                }
            }
        }
        patches
    }

    #[test]
    fn the_field_has_its_deviation_and_correlation() {
        let weights = weights(FIELD_PX / 2_f64.sqrt());
        let left: f64 = weights.iter().map(|w| w * w).sum();
        let (width, height) = (200, 200);
        let noise = normals(&stage(0), 0, width * height);
        let field = smoothed(&noise, width, &weights);
        let inner = |dx: usize, dy: usize| {
            let mut sum = 0.0;
            for y in 20..170 {
                for x in 20..170 {
                    sum += field[y * width + x] * field[(y + dy) * width + x + dx];
                }
            }
            sum / (150.0 * 150.0) / (left * left)
        };
        assert!((inner(0, 0) - 1.0).abs() < 0.12, "{}", inner(0, 0));
        for (dx, dy) in [(4, 0), (0, 4), (3, 3)] {
            let distance = (dx as f64).hypot(dy as f64);
            let expected = (-distance * distance / (2.0 * 16.0)).exp();
            assert!((inner(dx, dy) / inner(0, 0) - expected).abs() < 0.08, "{} {expected}", inner(dx, dy));
        }
    }

    #[test]
    fn borders_move_by_less_than_a_pixel_on_average_and_hard_ones_further() {
        let image = disc(50.0);
        let mut changed = [0.0; 2];
        for (level, changed) in LEVELS.into_iter().zip(&mut changed) {
            for frame in 0..20 {
                let mut grid = Grid::of(&image);
                jitter_border(&mut grid, level, &stage(frame));
                for (i, cell) in grid.cells.iter().enumerate() {
                    let (x, y) = (i % 320, i / 320);
                    if *cell != image.get(x, y) {
                        *changed += 1.0;
                        let from_centre = (x as f64 - 160.0).hypot(y as f64 - 120.0);
                        assert!((from_centre - 50.0).abs() < 9.5, "{from_centre}");
                    }
                }
            }
            // Pixels per frame and pixel of the circumference.
            *changed /= 20.0 * TAU * 50.0;
        }
        assert!((0.2..0.8).contains(&changed[0]) && changed[1] > 1.4 * changed[0], "{changed:?}");
    }

    #[test]
    fn a_shadow_counts_as_person_only_where_it_is_hard() {
        let image = disc(20.0);
        let mut shadow = BitImage::new(320, 240);
        (100..160).for_each(|x| shadow.fill(x, 200..220));
        let inside = |x: usize, y: usize| (200..220).contains(&y) && (100..160).contains(&x);
        let with = |level, shadow| segmented(&image, shadow, level, stage(9));
        assert_eq!(with(Level::Normal, Some(&shadow)), with(Level::Normal, None));
        assert!(differing(&with(Level::Hard, Some(&shadow)), &with(Level::Hard, None), inside) > 800);
    }

    #[test]
    fn single_pixels_do_not_survive_the_median() {
        let mut cells = vec![false; 64];
        (cells[3 * 8 + 3], cells[0]) = (true, true);
        assert!(median(&Grid { width: 8, height: 8, cells }).iter().all(|cell| !cell));
        let half: Vec<bool> = (0..64).map(|i| i % 8 < 4).collect();
        assert_eq!(median(&Grid { width: 8, height: 8, cells: half.clone() }), half);
    }

    #[test]
    fn levels_are_known_by_name() {
        assert!(Level::ALL.into_iter().all(|(name, level)| Level::named(name) == Some(level)));
        assert_eq!(Level::named("soft"), None);
    }
}
