//! What a calibration holds: image, lens and place of each camera.

use super::facts::{Facts, Odd};
use crate::Error;
use sinew::files::read_text;
use sinew_formats::source_text::MAX_CONFIG_BYTES;
use sinew_formats::{calib_toml, calibration};
use std::path::Path;

/// Height of a person for the question whether a calibration is in metres.
const HEIGHT_M: f64 = 1.7;

/// A length to the centimetre, without the sign of a zero.
fn in_centimetres(metres: f64) -> f64 {
    (100.0 * metres).round() / 100.0 + 0.0
}

pub(super) fn facts(path: &Path) -> Result<Facts, Error> {
    let text = read_text(path, MAX_CONFIG_BYTES)?;
    let name = path.display().to_string();
    let program = calibration::recognised(&name, &text)?.program();
    let calibration = calibration::read(&name, &text)?;
    let count = calibration.cameras.len();
    let many = if count == 1 { "camera" } else { "cameras" };
    let mut facts = Facts::new(format!("{name}: calibration of {count} {many} ({program})"));
    for camera in &calibration.cameras {
        let [width, height] = camera.image_size_px;
        let [x, y, z] = camera.centre().map(in_centimetres);
        let lens = if camera.lens.is_perfect() { "no distortion" } else { "distortion" };
        let place = format!(
            "{width} x {height} px, focal length {:.0} px, {lens}, at ({x:.2}, {y:.2}, {z:.2}) m",
            camera.intrinsics.fx
        );
        facts.row(&camera.name, place);
    }
    facts.odd.extend(calibration.warnings.iter().map(|warning| Odd::Words(warning.to_string())));
    facts
        .odd
        .extend(calib_toml::far_cameras(&calibration.cameras, HEIGHT_M).map(|warning| Odd::Words(warning.to_string())));
    for (index, camera) in calibration.cameras.iter().enumerate() {
        let near = |other: &&sinew_observe::Camera| {
            camera.centre().iter().zip(other.centre()).all(|(a, b)| (a - b).abs() < 0.01)
        };
        if let Some(other) = calibration.cameras[..index].iter().find(near) {
            facts.odd.push(format!("{} and {} stand at the same place", other.name, camera.name).into());
        }
    }
    Ok(facts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_have_no_sign() {
        let shown = |metres: f64| format!("{:.2}", in_centimetres(metres));
        assert_eq!([-0.0, -1e-17, -0.004, -0.006, 2.345].map(shown), ["0.00", "0.00", "0.00", "-0.01", "2.35"]);
    }
}
