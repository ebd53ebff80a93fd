//! Calibrations as Anipose and FreeMoCap write them: `calibration.toml`.
//!
//! ```toml
//! [cam_0]                         # numbered from 0
//! name = "A"
//! size = [1280, 720]              # pixels
//! matrix = [[822.4, 0.0, 639.5], [0.0, 822.4, 359.5], [0.0, 0.0, 1.0]]
//! distortions = [-0.06, 0.0, 0.0, 0.0, 0.0]
//! rotation = [0.014, 0.136, 0.009]                  # Rodrigues vector, camera from world
//! translation = [-94.3, 8.8, -97.2]                 # in the unit of the board
//! fisheye = true                                    # else missing
//!
//! [metadata]
//! adjusted = true
//! error = 0.263
//! charuco_square_size = 58.0      # FreeMoCap only: millimetres
//! unit = "mm"                     # neither writes it; it settles the unit
//! ```
//!
//! Numbers mean what they mean in [`calib_toml`], but for the unit of `translation`, which the format does not
//! state: `unit` under `[metadata]` does, FreeMoCap's files are in millimetres, and of others metres are assumed where no camera stands more than 100 units from the origin, millimetres with a warning where
//! one does. The world is that of the board or of the first camera: no axis need point up.
//!
//! Pose2Sim and Caliscope write tables of the same shape, in metres. Their `[metadata]` says that nothing was adjusted and that
//! the error is 0, which Anipose never finds: such files are [`calib_toml`]'s.
//!
//! ```
//! # let text = "[cam_0]\nname = \"A\"\nsize = [640, 480]\nmatrix = [[500, 0, 320], [0, 500, 240], [0, 0, 1]]\ndistortions = [0, 0, 0, 0, 0]\nrotation = [0, 0, 0]\ntranslation = [0, 0, 3000]\n[metadata]\ncharuco_square_size = 58.0\n";
//! let calibration = sinew_formats::anipose_cameras::read("calibration.toml", text)?;
//! assert_eq!(calibration.cameras[0].translation, [0.0, 0.0, 3.0]);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::calib_toml::{self, Calibration, camera_fields};
use crate::length_unit::{self, LengthUnit, to_metres};
use crate::numbers::plain;
use crate::toml_text::{Document, Table, quoted};
use crate::{Error, Place};
use sinew_observe::Camera;
use std::fmt::Write as _;

const METADATA: &str = "metadata";

/// Whether the document is of this format.
pub(crate) fn is_of(root: Table<'_>) -> bool {
    let is_counted = cameras(root).all(|(index, (title, _))| title == format!("cam_{index}"));
    let metadata = metadata(root);
    let number = |key| metadata.and_then(|table| table.get(key)?.number().ok());
    let is_unadjusted = metadata.and_then(|table| table.get("adjusted")?.bool().ok()) == Some(false);
    let says_so =
        metadata.is_some_and(|table| table.get("unit").is_some() || table.get("charuco_square_size").is_some());
    let is_of_others = is_unadjusted && number("error") == Some(0.0);
    says_so || (metadata.is_some() && is_counted && !is_of_others)
}

fn metadata(root: Table<'_>) -> Option<Table<'_>> {
    root.tables().into_iter().find(|(title, _)| *title == METADATA).map(|(_, table)| table.within(METADATA))
}

fn cameras<'a>(root: Table<'a>) -> impl Iterator<Item = (usize, (&'a str, Table<'a>))> {
    root.tables().into_iter().filter(|(title, _)| *title != METADATA).enumerate()
}

/// Reads a calibration.
///
/// # Errors
/// What [`calib_toml::read`] refuses; a `unit` that is none.
pub fn read(name: &str, text: &str) -> Result<Calibration, Error> {
    let mut calibration = calib_toml::read(name, text)?;
    let document = Document::parse(name, text)?;
    let unit = metadata(document.root()).map_or(Ok(None), stated_unit)?;
    to_metres(&mut calibration.cameras, unit, Place::file(name), &mut calibration.warnings);
    Ok(calibration)
}

fn stated_unit(metadata: Table<'_>) -> Result<Option<LengthUnit>, Error> {
    if let Some(value) = metadata.get("unit") {
        let unit = LengthUnit::named(&value.string()?);
        return unit.map(Some).ok_or_else(|| value.must_be(length_unit::NAMES));
    }
    Ok(metadata.get("charuco_square_size").map(|_| LengthUnit::Millimetre))
}

/// Writes a calibration that [`read`], Anipose and FreeMoCap read: in millimetres.
#[must_use]
pub fn write(cameras: &[Camera]) -> String {
    let mut out = String::new();
    for (index, camera) in cameras.iter().enumerate() {
        let [width, height] = camera.image_size_px.map(plain);
        // Writing to a String cannot fail.
        let _ = write!(
            out,
            "[cam_{index}]\nname = {}\nsize = [{width}, {height}]\n{}",
            quoted(&camera.name),
            camera_fields(camera, camera.translation.map(|metres| 1000.0 * metres)),
        );
    }
    out.push_str("[metadata]\nadjusted = false\nerror = 0.0\nunit = \"mm\"\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(title: &str, metadata: &str) -> String {
        format!(
            "[{title}]\nname = \"A\"\nsize = [640, 480]\nmatrix = [[500, 0, 320], [0, 500, 240], [0, 0, 1]]\n\
             distortions = [0.1, 0, 0, 0, 0]\nrotation = [0, 0, 0]\ntranslation = [0, 0, 3200]\n{metadata}"
        )
    }

    #[test]
    fn files_of_other_programs_are_not_taken() {
        let check = |title: &str, metadata: &str, expected: bool| {
            let text = file(title, metadata);
            let document = Document::parse("a.toml", &text).unwrap();
            assert_eq!(is_of(document.root()), expected, "{text}");
        };
        check("cam_0", "[metadata]\nadjusted = true\nerror = 0.26\n", true);
        check("cam_0", "[metadata]\nadjusted = false\nerror = 0.26\n", true);
        check("cam_0", "[metadata]\n", true);
        check("cam_0", "[metadata]\nadjusted = false\nerror = 0.0\n", false);
        check("cam_0", "[metadata]\nadjusted = false\nerror = 0.0\nunit = \"mm\"\n", true);
        check("left", "[metadata]\ncharuco_square_size = 58.0\n", true);
        check("cam_01", "[metadata]\nadjusted = true\nerror = 0.26\n", false);
        check("cam_0", "", false);
    }

    #[test]
    fn lengths_are_put_into_metres() {
        let check = |metadata: &str, depth: f64, warnings: usize| {
            let read = read("calibration.toml", &file("cam_0", metadata)).unwrap();
            assert_eq!((read.cameras[0].translation, read.warnings.len()), ([0.0, 0.0, depth], warnings), "{metadata}");
        };
        check("[metadata]\nerror = 0.26\n", 3.2, 1);
        check("[metadata]\ncharuco_square_size = 58.0\n", 3.2, 0);
        check("[metadata]\nunit = \"m\"\n", 3200.0, 0);
        let error = read("calibration.toml", &file("cam_0", "[metadata]\nunit = \"inch\"\n")).unwrap_err();
        assert_eq!(
            error.to_string(),
            "calibration.toml:9 (metadata): unit = \"inch\"; must be \"m\", \"cm\" or \"mm\""
        );
    }
}
