//! What every calibration must keep, whatever file it comes from: lenses, focal lengths, rotations.
//!
//! Formats give the same numbers under other names. Each reader finds them in its file, with the place where they stand,
//! and this module makes parts of a [`Camera`](sinew_observe::Camera) of them or says what is wrong.

use crate::rotation::{Matrix, determinant, nearest_rotation, orthonormality_error};
use crate::source_text::shortened;
use crate::{Error, Place, Warning};
use sinew_observe::{Intrinsics, Lens};

/// Deviation of `R'R` from the identity up to which a rotation matrix is repaired without a word.
const SILENT: f64 = 1e-6;

/// Deviation up to which it is repaired with a warning.
const REPAIRABLE: f64 = 1e-3;

/// Coefficients of the richest lens: later ones of OpenCV are thin prisms and tilt, which no lens here has.
const MOST_COEFFICIENTS: usize = 8;

/// Focal lengths and principal point of a camera matrix, for an image of that size (width and height, pixels).
pub(crate) fn intrinsics(
    place: Place,
    rows: &Matrix,
    [width, height]: [f64; 2],
    warnings: &mut Vec<Warning>,
) -> Result<Intrinsics, Error> {
    let [[fx, skew, cx], [m10, fy, cy], last] = *rows;
    let bad = |field: &str, found: String, expected: String| place.clone().bad_value(field, found, expected);
    if m10 != 0.0 || last != [0.0, 0.0, 1.0] {
        return Err(bad("matrix", shortened(&format!("{rows:?}")), "[[fx, 0, cx], [0, fy, cy], [0, 0, 1]]".into()));
    }
    for (field, focal) in [("fx", fx), ("fy", fy)] {
        if focal.is_nan() || focal <= 0.0 {
            return Err(bad(field, focal.to_string(), "positive".into()));
        }
    }
    for (field, centre, size) in [("cx", cx, width), ("cy", cy, height)] {
        if !(-size..=2.0 * size).contains(&centre) {
            let expected = format!("within one image of the image, {} to {}", -size, 2.0 * size);
            return Err(bad(field, centre.to_string(), expected));
        }
    }
    if skew != 0.0 {
        warnings.push(Warning::SkewIgnored { place, skew });
    }
    Ok(Intrinsics { fx, fy, cx, cy })
}

/// The lens of coefficients in OpenCV's order; what is expected where there is none such.
///
/// Zeros beyond the eighth coefficient, which OpenCV writes for models that were not fitted, are left out.
pub(crate) fn lens(is_fisheye: bool, coefficients: &[f64]) -> Result<Lens, String> {
    let mut kept = coefficients;
    while let [rest @ .., 0.0] = kept
        && kept.len() > MOST_COEFFICIENTS
    {
        kept = rest;
    }
    Lens::from_coefficients(is_fisheye, kept).map_err(|expected| {
        if is_fisheye || kept.len() <= MOST_COEFFICIENTS {
            return expected;
        }
        format!("{expected}; later ones are thin prisms and tilt, which no lens here has: calibrate without them")
    })
}

/// The rotation nearest to a matrix that is almost one.
pub(crate) fn rotation(place: Place, matrix: &Matrix, warnings: &mut Vec<Warning>) -> Result<Matrix, Error> {
    if determinant(matrix) < 0.0 {
        return Err(Error::MirrorRotation { place });
    }
    let deviation = orthonormality_error(matrix);
    if deviation.is_nan() || deviation > REPAIRABLE {
        return Err(Error::NotOrthonormal { place, deviation });
    }
    if deviation > SILENT {
        warnings.push(Warning::RotationRepaired { place, deviation });
    }
    Ok(nearest_rotation(matrix))
}

/// Three rows of nine numbers.
pub(crate) fn rows(numbers: &[f64]) -> Option<Matrix> {
    let &[a, b, c, d, e, f, g, h, i] = numbers else { return None };
    Some([[a, b, c], [d, e, f], [g, h, i]])
}
