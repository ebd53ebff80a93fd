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

use super::draws::{normals, uniforms};
use super::render::bit_image;
use crate::core::random::Stage;
use crate::observe::bit_image::BitImage;
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
    let probability = FLIP * level.factor() as f64;
    for (y, row) in grid.cells.chunks_mut(width.max(1)).enumerate() {
        let chance = uniforms(&flips, row_number(y), width);
        row.iter_mut().zip(chance).for_each(|(cell, u)| *cell ^= u < probability);
    }
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

    /// Columns and rows from the first to the last flag, with so many more on each side.
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
