//! How far the points of each frame scatter within the run, as ellipsoids.
//!
//! With x⁽ⁱ⁾ the place of a point in draw i, x̄ its mean over the draws and s⁽ⁱ⁾ the mean of x⁽ⁱ⁾ − x̄ over all frames and points, which is the shift of the whole world in draw i, the covariance of x⁽ⁱ⁾ − s⁽ⁱ⁾ is L Lᵀ. L maps a ball to the ellipsoid.
//! Where a folder has no draws, or more frames than are worth the memory, L is diagonal and holds the standard deviations of `joints.csv`.

use super::recorded::Recorded;
use crate::Error;
use sinew_formats::zarr::reader::NumberArray;
use sinew_results::ReadError;
use sinew_results::stored_array::stored_array;
use std::path::Path;

/// Lower triangle of L, row after row, metres.
pub(super) type Factor = [f64; 6];

/// Frames whose draws take about a gigabyte.
const MOST_FRAMES: usize = 20_000;

/// L of each frame, point by point in the order of `joints.csv`.
pub(super) fn factors(folder: &Path, recorded: &Recorded) -> Result<Vec<Vec<Factor>>, Error> {
    let is_short = recorded.numbers.len() <= MOST_FRAMES;
    let found = if is_short { stored_array(folder, "posterior/marker_position")? } else { None };
    let Some(draws) = found else {
        return Ok(recorded.points.iter().map(|point| diagonal(&point.sd_within)).collect());
    };
    let (frames, points) = (recorded.numbers.len(), recorded.points.len());
    match draws.shape[..] {
        [1, _, in_frames, at_points, 3] if in_frames == frames && at_points == points => {
            Ok(from_draws(&draws, frames, points))
        }
        _ => Err(ReadError::OtherRun(folder.join("posterior.zarr")).into()),
    }
}

fn diagonal([x, y, z]: &[Vec<f64>; 3]) -> Vec<Factor> {
    x.iter().zip(y).zip(z).map(|((x, y), z)| [*x, 0.0, *y, 0.0, 0.0, *z]).collect()
}

fn from_draws(draws: &NumberArray, frames: usize, points: usize) -> Vec<Vec<Factor>> {
    let stride = frames * points * 3;
    let count = draws.values.len() / stride.max(1);
    let column = |index: usize| (0..count).map(move |draw| draws.values[draw * stride + index]);
    let means: Vec<f64> = (0..stride).map(|index| column(index).sum::<f64>() / count as f64).collect();
    let mut shifts = vec![[0.0; 3]; count];
    for (draw, shift) in shifts.iter_mut().enumerate() {
        let values = draws.values[draw * stride..(draw + 1) * stride].chunks_exact(3);
        for (at, mean) in values.zip(means.chunks_exact(3)) {
            (0..3).for_each(|axis| shift[axis] += (at[axis] - mean[axis]) / (frames * points) as f64);
        }
    }
    let factor = |frame: usize, point: usize| {
        let first = (frame * points + point) * 3;
        let mut covariance = [0.0; 6];
        for (draw, shift) in shifts.iter().enumerate() {
            let away = [0, 1, 2]
                .map(|axis: usize| draws.values[draw * stride + first + axis] - means[first + axis] - shift[axis]);
            let products = LOWER.map(|[a, b]| away[a] * away[b] / (count.max(2) - 1) as f64);
            covariance.iter_mut().zip(products).for_each(|(sum, product)| *sum += product);
        }
        cholesky(covariance)
    };
    (0..points).map(|point| (0..frames).map(|frame| factor(frame, point)).collect()).collect()
}

/// Rows and columns of the lower triangle.
const LOWER: [[usize; 2]; 6] = [[0, 0], [1, 0], [1, 1], [2, 0], [2, 1], [2, 2]];

/// L of a covariance given by its lower triangle; a direction without spread has none in L.
fn cholesky([xx, xy, yy, xz, yz, zz]: [f64; 6]) -> Factor {
    let over = |value: f64, by: f64| if by > 0.0 { value / by } else { 0.0 };
    let a = xx.max(0.0).sqrt();
    let (b, c) = (over(xy, a), over(xz, a));
    let d = (yy - b * b).max(0.0).sqrt();
    let e = over(yz - b * c, d);
    [a, b, d, c, e, (zz - c * c - e * e).max(0.0).sqrt()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ellipsoids_are_without_the_shift_that_all_share() {
        // Two points in two frames; the draws shift all by ±1 m along x, and the first point by ±2 mm along y.
        let shifts = [-1.0, 1.0, -1.0, 1.0];
        let own = [-0.002, -0.002, 0.002, 0.002];
        let mut values = vec![];
        for draw in 0..4 {
            for index in 0..4 {
                let is_first = index % 2 == 0;
                values.extend([shifts[draw] + index as f64, if is_first { own[draw] } else { -own[draw] }, 3.0]);
            }
        }
        let draws = NumberArray { shape: vec![1, 4, 2, 2, 3], values };
        let found = from_draws(&draws, 2, 2);
        assert_eq!((found.len(), found[0].len()), (2, 2));
        let [a, b, d, c, e, f] = found[0][1];
        assert!(a < 1e-9 && f < 1e-9 && [b, c, e].iter().all(|x| x.abs() < 1e-9), "{found:?}");
        assert!((d - 0.002 * (4.0_f64 / 3.0).sqrt()).abs() < 1e-9, "{d}");
    }

    #[test]
    fn factors_give_the_covariance_back() {
        let covariance = [4.0, 2.0, 5.0, -1.0, 0.5, 3.0];
        let [a, b, d, c, e, f] = cholesky(covariance);
        let back = [a * a, a * b, b * b + d * d, a * c, b * c + d * e, c * c + e * e + f * f];
        assert!(back.iter().zip(covariance).all(|(x, y)| (x - y).abs() < 1e-12), "{back:?}");
        assert_eq!(cholesky([0.0; 6]), [0.0; 6]);
    }
}
