//! The unit of length of calibrations whose format states none.
//!
//! Anipose and OpenCV calibrate in whatever unit the board was measured. FreeMoCap's is the millimetre, which its
//! `charuco_square_size` gives away. A file may say it: `unit = "m"`, `"cm"` or `"mm"`, in TOML under `[metadata]`.
//! Of other files lengths are taken as metres where the farthest camera stands within [`FARTHEST_M`] of the origin, and
//! as millimetres, with a warning, where it stands farther away: nobody films a person from there.

use crate::{Place, Warning};
use sinew_observe::Camera;

/// Distance from the origin of the world, in the file's unit, beyond which it cannot be metres.
const FARTHEST_M: f64 = 100.0;

/// A unit of length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LengthUnit {
    Metre,
    Centimetre,
    Millimetre,
}

/// What a file may call its unit.
pub(crate) const NAMES: &str = "\"m\", \"cm\" or \"mm\"";

impl LengthUnit {
    pub(crate) fn named(name: &str) -> Option<Self> {
        match name {
            "m" => Some(Self::Metre),
            "cm" => Some(Self::Centimetre),
            "mm" => Some(Self::Millimetre),
            _ => None,
        }
    }

    /// How many of it are a metre: a division by it rounds once, a product with its inverse twice.
    const fn per_metre(self) -> f64 {
        match self {
            Self::Metre => 1.0,
            Self::Centimetre => 100.0,
            Self::Millimetre => 1000.0,
        }
    }
}

/// Puts translations into metres.
pub(crate) fn to_metres(cameras: &mut [Camera], stated: Option<LengthUnit>, place: Place, warnings: &mut Vec<Warning>) {
    let length = |[x, y, z]: [f64; 3]| x.hypot(y).hypot(z);
    let distance = cameras.iter().map(|camera| length(camera.translation)).fold(0.0, f64::max);
    let unit = stated.unwrap_or_else(|| {
        if distance <= FARTHEST_M {
            return LengthUnit::Metre;
        }
        warnings.push(Warning::MillimetresAssumed { place, distance });
        LengthUnit::Millimetre
    });
    for camera in cameras {
        camera.translation = camera.translation.map(|length| length / unit.per_metre());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(translation: [f64; 3], stated: Option<LengthUnit>, expected: [f64; 3], warned: usize) {
        let camera = Camera::look_at("C1", [640.0, 480.0], 500.0, [0.0, -4.0, 1.0], [0.0, 0.0, 1.0]).unwrap();
        let mut cameras = [Camera { translation, ..camera }];
        let mut warnings = vec![];
        to_metres(&mut cameras, stated, Place::file("a.toml"), &mut warnings);
        assert_eq!(cameras[0].translation, expected);
        assert_eq!(warnings.len(), warned);
    }

    #[test]
    fn the_unit_is_stated_or_seen_from_the_distance() {
        check([3.0, 0.0, 4.0], None, [3.0, 0.0, 4.0], 0);
        check([-2512.0, -645.0, 738.0], None, [-2.512, -0.645, 0.738], 1);
        check([-2512.0, -645.0, 738.0], Some(LengthUnit::Millimetre), [-2.512, -0.645, 0.738], 0);
        check([300.0, 0.0, 400.0], Some(LengthUnit::Metre), [300.0, 0.0, 400.0], 0);
        check([300.0, 0.0, 400.0], LengthUnit::named("cm"), [3.0, 0.0, 4.0], 0);
    }
}
