//! A point in space from its pixels in several cameras.
//!
//! Direct linear transform (Hartley & Zisserman 2004, §12.2): with the rows m1, m2, m3 of each camera's matrix `K [R | t]`, the homogeneous point X minimises
//!
//! ```text
//! Σ c² ((u m3 − m1) · X)² + c² ((v m3 − m2) · X)²,   |X| = 1        c: confidence of the detection, or 1
//! ```
//!
//! by the singular vector of the smallest singular value. Its error is the mean pixel distance over the cameras used. While that is too large, cameras are left
//! out: every subset of one camera less (as the reference recipe of Pose2Sim does, whose cost grows exponentially with the cameras at fault), or only the one
//! camera whose absence helps most ([`Search::Greedy`], quadratic). [`refined`] then minimises the robust reprojection error itself, distortion included.
//!
//! ```
//! use sinew_observe::{Camera, cameras::triangulate::{self, Seen}};
//! let look = |x: f64| Camera::look_at("C", [640.0, 480.0], 500.0, [x, -4.0, 1.0], [0.0, 0.0, 1.0]);
//! let (left, right) = (look(-2.0)?, look(2.0)?);
//! let point = [0.1, 0.2, 1.3];
//! let seen = [&left, &right].map(|camera| Seen { camera, pixel: camera.project(point).pixel().unwrap(), confidence: 0.9 });
//! let found = triangulate::triangulate(&seen, &triangulate::Config::default()).unwrap();
//! assert!((0..3).all(|k| (found.point[k] - point[k]).abs() < 1e-12));
//! # Ok::<(), sinew_observe::Error>(())
//! ```

use crate::cameras::camera::Camera;
use nalgebra::{DMatrix, Matrix3, Vector3};

/// A pixel in a camera, freed of the camera's constant offset.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// Image position, pixels.
    pub pixel: [f64; 2],
    /// The detector's confidence, 0 to 1.
    pub confidence: f64,
}

/// Which subsets of the cameras are tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// All subsets of a size before the next size.
    Exhaustive,
    /// The best of those that lack one camera more.
    Greedy,
}

/// How to triangulate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// Detections of lower confidence do not count.
    pub least_confidence: f64,
    /// Multiply the rows of a detection by its confidence.
    pub weigh: bool,
    /// Undo the lens distortion first; else the lens is taken to be perfect.
    pub undistort: bool,
    /// Mean pixel distance that is small enough, exclusive.
    pub error_px: f64,
    /// How cameras are left out.
    pub search: Search,
}

impl Default for Config {
    fn default() -> Self {
        Self { least_confidence: 0.3, weigh: true, undistort: true, error_px: 15.0, search: Search::Greedy }
    }
}

impl Config {
    /// What Pose2Sim does (version of 2024-02): raw pixels, exhaustive search, 15 px, confidence at least 0.3.
    #[must_use]
    pub const fn reference_recipe() -> Self {
        Self { least_confidence: 0.3, weigh: true, undistort: false, error_px: 15.0, search: Search::Exhaustive }
    }
}

/// A point in space.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangulated {
    /// World position, metres.
    pub point: [f64; 3],
    /// Mean pixel distance over the cameras used.
    pub error_px: f64,
    /// Indices of the detections used.
    pub used: Vec<usize>,
}

/// Triangulates; `None` where fewer than two detections count or no two cameras agree well enough.
#[must_use]
pub fn triangulate(seen: &[Seen<'_>], config: &Config) -> Option<Triangulated> {
    let ideal: Vec<(usize, Seen<'_>)> = seen
        .iter()
        .enumerate()
        .filter(|(_, s)| s.confidence >= config.least_confidence && s.pixel.iter().all(|x| x.is_finite()))
        .filter_map(|(index, s)| {
            let pixel = if config.undistort { s.camera.undistort(s.pixel).ok()? } else { s.pixel };
            Some((index, Seen { pixel, ..*s }))
        })
        .collect();
    let all: Vec<usize> = (0..ideal.len()).collect();
    let mut best = candidate(&ideal, all, config)?;
    while best.error_px.is_nan() || best.error_px >= config.error_px {
        let size = best.used.len() - 1;
        if size < 2 {
            return None;
        }
        let subsets = match config.search {
            Search::Exhaustive => subsets(ideal.len(), size),
            Search::Greedy => {
                (0..=size).map(|gone| (0..=size).filter(|&i| i != gone).map(|i| best.used[i]).collect()).collect()
            }
        };
        best = subsets
            .into_iter()
            .filter_map(|subset| candidate(&ideal, subset, config))
            .min_by(|a, b| a.error_px.total_cmp(&b.error_px))?;
    }
    best.used = best.used.into_iter().map(|i| ideal[i].0).collect();
    Some(best)
}

/// Error of a point of which nothing is known, so that smaller subsets are tried.
fn candidate(ideal: &[(usize, Seen<'_>)], used: Vec<usize>, config: &Config) -> Option<Triangulated> {
    if used.len() < 2 {
        return None;
    }
    let chosen: Vec<Seen<'_>> = used.iter().map(|&i| ideal[i].1).collect();
    let (point, error_px) = match linear(&chosen, config.weigh) {
        Some(point) => (point, mean_distance(&chosen, point)),
        None => ([f64::NAN; 3], f64::INFINITY),
    };
    Some(Triangulated { point, error_px, used })
}

/// The direct linear transform of pixels of perfect lenses; `None` for fewer than two and for points at infinity.
#[must_use]
pub fn linear(seen: &[Seen<'_>], weigh: bool) -> Option<[f64; 3]> {
    if seen.len() < 2 {
        return None;
    }
    let mut rows = DMatrix::zeros(2 * seen.len(), 4);
    for (i, s) in seen.iter().enumerate() {
        let weight = if weigh { s.confidence } else { 1.0 };
        let [m1, m2, m3] = s.camera.matrix();
        for k in 0..4 {
            rows[(2 * i, k)] = weight * (m1[k] - s.pixel[0] * m3[k]);
            rows[(2 * i + 1, k)] = weight * (m2[k] - s.pixel[1] * m3[k]);
        }
    }
    if !rows.iter().all(|x| x.is_finite()) {
        return None;
    }
    let svd = rows.try_svd(false, true, f64::EPSILON, 1000)?;
    let smallest = svd.singular_values.imin();
    let v = svd.v_t?;
    let w = v[(smallest, 3)];
    let point = [0, 1, 2].map(|k: usize| v[(smallest, k)] / w);
    point.iter().all(|x| x.is_finite()).then_some(point)
}

fn mean_distance(seen: &[Seen<'_>], point: [f64; 3]) -> f64 {
    let total: f64 = seen
        .iter()
        .map(|s| match s.camera.project_ideal(point) {
            Some([u, v]) => (u - s.pixel[0]).hypot(v - s.pixel[1]),
            None => f64::INFINITY,
        })
        .sum();
    total / seen.len() as f64
}

fn subsets(n: usize, size: usize) -> Vec<Vec<usize>> {
    let mut all = vec![];
    let mut chosen: Vec<usize> = (0..size).collect();
    loop {
        all.push(chosen.clone());
        let Some(i) = (0..size).rev().find(|&i| chosen[i] < n - size + i) else { return all };
        chosen[i] += 1;
        for j in i + 1..size {
            chosen[j] = chosen[j - 1] + 1;
        }
    }
}

/// A point with what the pixels know about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Refined {
    /// World position, metres.
    pub point: [f64; 3],
    /// Covariance for independent errors of the stated standard deviations, square metres.
    pub covariance: [[f64; 3]; 3],
    /// Observed minus projected, pixels, for each detection; `None` where the point has no pixel.
    pub residual_px: Vec<Option<[f64; 2]>>,
    /// Share of each detection's own error that its residual does not show, per axis, 0 to 1.
    pub leverage: Vec<[f64; 2]>,
}

/// Residuals beyond this many standard deviations weigh less (Huber 1964).
const HUBER: f64 = 1.345;
const STEPS: usize = 12;

/// Minimises `Σ ρ(|observed − projected| / sigma)` from a start, by Gauss–Newton steps with Huber's weights; `None` where fewer than two cameras have the point
/// before them or the point is not determined.
#[must_use]
pub fn refined(seen: &[Seen<'_>], sigma_px: &[f64], start: [f64; 3]) -> Option<Refined> {
    let mut point = start;
    let mut step_m = f64::INFINITY;
    for _ in 0..STEPS {
        let (normal, gradient, _) = normal_equations(seen, sigma_px, point)?;
        let step = normal.cholesky()?.solve(&gradient);
        for k in 0..3 {
            point[k] += step[k];
        }
        step_m = step.norm();
        if !step_m.is_finite() {
            return None;
        }
        if step_m < 1e-7 {
            break;
        }
    }
    if step_m > 1e-2 {
        return None;
    }
    let (normal, _, rows) = normal_equations(seen, sigma_px, point)?;
    let covariance = normal.cholesky()?.inverse();
    let leverage = rows
        .iter()
        .map(|row| match row {
            Some((weight, [du, dv], _)) => {
                let share = |d: &[f64; 3]| {
                    let d = Vector3::from(*d);
                    (weight * d.dot(&(covariance * d))).clamp(0.0, 1.0)
                };
                [share(du), share(dv)]
            }
            None => [0.0; 2],
        })
        .collect();
    let covariance = [0, 1, 2].map(|i: usize| [0, 1, 2].map(|j: usize| covariance[(i, j)]));
    let residual_px = rows.into_iter().map(|row| row.map(|(_, _, residual)| residual)).collect();
    Some(Refined { point, covariance, residual_px, leverage })
}

/// Weight, Jacobian rows and residual of a detection.
type Row = Option<(f64, [[f64; 3]; 2], [f64; 2])>;

fn normal_equations(
    seen: &[Seen<'_>],
    sigma_px: &[f64],
    point: [f64; 3],
) -> Option<(Matrix3<f64>, Vector3<f64>, Vec<Row>)> {
    let mut normal = Matrix3::zeros();
    let mut gradient = Vector3::zeros();
    let rows: Vec<Row> = seen
        .iter()
        .zip(sigma_px)
        .map(|(s, sigma)| {
            let ([u, v], jacobian) = s.camera.project_with_jacobian(point)?;
            let residual = [s.pixel[0] - u, s.pixel[1] - v];
            let scaled = residual[0].hypot(residual[1]) / sigma;
            let weight = (HUBER / scaled).min(1.0) / (sigma * sigma);
            Some((weight, jacobian, residual))
        })
        .collect();
    for (weight, jacobian, residual) in rows.iter().flatten() {
        for (d, r) in jacobian.iter().zip(residual) {
            let d = Vector3::from(*d);
            normal += *weight * d * d.transpose();
            gradient += *weight * *r * d;
        }
    }
    (rows.iter().flatten().count() >= 2).then_some((normal, gradient, rows))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(n: usize) -> Vec<Camera> {
        (0..n)
            .map(|i| {
                let angle = 0.3 + std::f64::consts::TAU * i as f64 / n as f64;
                let centre = [4.0 * angle.cos(), 4.0 * angle.sin(), 2.0];
                Camera::look_at(&format!("C{i}"), [640.0, 480.0], 500.0, centre, [0.0, 0.0, 1.0]).unwrap()
            })
            .collect()
    }

    fn seen<'a>(cameras: &'a [Camera], point: [f64; 3]) -> Vec<Seen<'a>> {
        cameras
            .iter()
            .map(|camera| Seen { camera, pixel: camera.project(point).pixel().unwrap(), confidence: 0.8 })
            .collect()
    }

    fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
        (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    }

    const POINT: [f64; 3] = [0.2, -0.3, 1.4];

    #[test]
    fn cameras_that_are_wrong_are_left_out() {
        let cameras = ring(5);
        for search in [Search::Exhaustive, Search::Greedy] {
            let mut seen = seen(&cameras, POINT);
            seen[1].pixel[0] += 150.0;
            seen[4].pixel[1] -= 220.0;
            let config = Config { search, error_px: 1.0, ..Config::default() };
            let found = triangulate(&seen, &config).unwrap();
            assert_eq!(found.used, [0, 2, 3], "{search:?}");
            assert!(distance(found.point, POINT) < 1e-9);
        }
    }

    #[test]
    fn too_little_gives_nothing() {
        let cameras = ring(2);
        let good = seen(&cameras, POINT);
        assert_eq!(triangulate(&good[..1], &Config::default()), None);
        assert_eq!(triangulate(&[], &Config::default()), None);
        let mut unsure = good.clone();
        unsure[0].confidence = 0.1;
        assert_eq!(triangulate(&unsure, &Config::default()), None);
        let mut lost = good.clone();
        lost[0].pixel = [f64::NAN, 3.0];
        assert_eq!(triangulate(&lost, &Config::default()), None);
        let mut apart = good;
        apart[0].pixel[1] += 200.0;
        assert_eq!(triangulate(&apart, &Config::default()), None);
        let twice = vec![seen(&cameras[..1], POINT)[0]; 2];
        assert!(refined(&twice, &[1.0; 2], POINT).is_none_or(|r| r.point.iter().all(|x| x.is_finite())));
    }

    #[test]
    fn refinement_finds_the_point_and_its_covariance() {
        let cameras = ring(4);
        let exact = seen(&cameras, POINT);
        let found = refined(&exact, &[2.0; 4], [0.3, -0.2, 1.3]).unwrap();
        assert!(distance(found.point, POINT) < 1e-9);
        let shown: f64 = found.leverage.iter().flatten().sum();
        assert!((shown - 3.0).abs() < 1e-9, "leverages sum to the unknowns, {shown}");
        // A pixel is 4.1/500 m here; two axes and four cameras share the horizontal plane.
        let sd = found.covariance[2][2].sqrt();
        assert!((0.5..1.2).contains(&(sd / (2.0 * 4.1 / 500.0 / 2.0))), "{sd}");
    }

    #[test]
    fn one_gross_error_moves_the_refined_point_little() {
        let cameras = ring(6);
        let mut wrong = seen(&cameras, POINT);
        wrong[2].pixel[0] += 100.0;
        let found = refined(&wrong, &[1.0; 6], POINT).unwrap();
        assert!(distance(found.point, POINT) < 0.01, "{:?}", found.point);
    }

    #[test]
    fn subsets_match_combinatorics() {
        assert_eq!(subsets(4, 3), [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]]);
        assert_eq!(subsets(5, 2).len(), 10);
    }
}
