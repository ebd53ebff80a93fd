//! Calibrations as Pose2Sim writes them: `Calib.toml`, one table per camera.
//!
//! ```toml
//! [cam_01]
//! name = "cam_01"                 # the table's name where this is missing
//! size = [1088.0, 1920.0]         # pixels
//! matrix = [[1681.2, 0.0, 533.0], [0.0, 1681.1, 948.1], [0.0, 0.0, 1.0]]
//! distortions = [-0.0007, 0.0022, 9.5e-6, 1.1e-5]   # k1 k2 p1 p2 [k3 [k4 k5 k6]]; of a fisheye lens k1 k2 k3 k4
//! rotation = [1.688, 1.048, -0.420]                 # Rodrigues vector, camera from world
//! translation = [0.321, 0.956, 2.891]               # metres
//! fisheye = false
//! ```
//!
//! `distortions` are OpenCV's, as [`sinew_observe::cameras::lens`] lists them: 4, 5 or 8 numbers, or the 4 of its fisheye model where `fisheye` is
//! true. Cameras keep the order of the file. `[metadata]` is not a camera; unknown keys are ignored. The rotation may also be
//! a 3 × 3 matrix: one that is orthonormal to 1e-6 is repaired silently, to 1e-3 with a warning, a worse one and a mirror
//! image are refused. Writing and reading again gives every number bit for bit, rotations to
//! 1e-15 (they are stored as Rodrigues vectors).
//!
//! ```
//! # let text = "[cam_1]\nsize = [640, 480]\nmatrix = [[500, 0, 320], [0, 500, 240], [0, 0, 1]]\ndistortions = [0, 0, 0, 0]\nrotation = [0, 0, 0]\ntranslation = [0, 0, 3]\n";
//! let calibration = sinew_formats::calib_toml::read("Calib.toml", text)?;
//! assert_eq!(calibration.cameras[0].name, "cam_1");
//! assert_eq!(calibration.cameras[0].translation, [0.0, 0.0, 3.0]);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::camera_checks;
use crate::rotation::{Matrix, from_rodrigues, to_rodrigues};
use crate::toml_text::{Document, Table, Value, array, key, quoted};
use crate::{Error, Warning};
use sinew_core::estimators::median;
use sinew_observe::{Camera, Intrinsics, Lens};
use std::fmt::Write as _;

/// Cameras of a calibration file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Calibration {
    /// Cameras in the order of the file.
    pub cameras: Vec<Camera>,
    /// What was odd.
    pub warnings: Vec<Warning>,
}

/// Reads a calibration.
///
/// # Errors
/// TOML that is malformed, no camera at all, and for each camera: missing fields, numbers that are no numbers, focal
/// lengths that are not positive, a principal point more than one image outside, a rotation that is none, as many
/// distortion coefficients as no lens has.
pub fn read(name: &str, text: &str) -> Result<Calibration, Error> {
    let document = Document::parse(name, text)?;
    let mut calibration = Calibration::default();
    for (title, table) in document.root().tables() {
        if !title.eq_ignore_ascii_case("metadata") {
            add_camera(&mut calibration, title, table.within(title))?;
        }
    }
    if calibration.cameras.is_empty() {
        return Err(document.root().place().lacks("[camera]"));
    }
    Ok(calibration)
}

/// Reads the camera of a table; its name is the title where it has none.
pub(crate) fn add_camera(calibration: &mut Calibration, title: &str, table: Table<'_>) -> Result<(), Error> {
    let name = table.optional_string("name")?.unwrap_or_else(|| title.to_owned());
    if calibration.cameras.iter().any(|other| other.name == name) {
        return Err(table.place().twice("camera", name));
    }
    let camera = camera(name, table, &mut calibration.warnings)?;
    calibration.cameras.push(camera);
    Ok(())
}

fn camera(name: String, table: Table<'_>, warnings: &mut Vec<Warning>) -> Result<Camera, Error> {
    let size = table.numbers::<2>("size")?;
    if !size.iter().all(|&pixels| pixels > 0.0) {
        return Err(table.require("size")?.must_be("two positive numbers, width and height in pixels"));
    }
    let value = table.require("matrix")?;
    Ok(Camera {
        name,
        image_size_px: size,
        intrinsics: camera_checks::intrinsics(value.place(), &matrix(value)?, size, warnings)?,
        lens: lens(table)?,
        rotation: rotation(table, warnings)?,
        translation: table.numbers::<3>("translation")?,
    })
}

fn lens(table: Table<'_>) -> Result<Lens, Error> {
    let is_fisheye = table.get("fisheye").map_or(Ok(false), |value| value.bool())?;
    let value = table.require("distortions")?;
    let numbers = value.items()?.iter().map(Value::number).collect::<Result<Vec<f64>, Error>>()?;
    camera_checks::lens(is_fisheye, &numbers).map_err(|expected| value.must_be(expected))
}

fn rotation(table: Table<'_>, warnings: &mut Vec<Warning>) -> Result<Matrix, Error> {
    let value = table.require("rotation")?;
    if value.items()?.iter().any(|item| item.items().is_err()) {
        return value.numbers::<3>().map(from_rodrigues).map_err(|error| match error {
            Error::BadValue { .. } => value.must_be("a Rodrigues vector of 3 numbers or a 3 x 3 matrix"),
            other => other,
        });
    }
    camera_checks::rotation(value.place(), &matrix(value)?, warnings)
}

fn matrix(value: Value<'_>) -> Result<Matrix, Error> {
    let rows = value.items()?;
    let [a, b, c] = rows[..] else { return Err(value.must_be("a 3 x 3 matrix")) };
    Ok([a.numbers()?, b.numbers()?, c.numbers()?])
}

/// The table of a camera, without its title and name, as Pose2Sim, Caliscope and Anipose have it.
pub(crate) fn camera_fields(camera: &Camera, translation: [f64; 3]) -> String {
    let Intrinsics { fx, fy, cx, cy } = camera.intrinsics;
    let rows = [[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]].map(|row| array(&row));
    format!(
        "matrix = [{}]\ndistortions = {}\nrotation = {}\ntranslation = {}\nfisheye = {}\n\n",
        rows.join(", "),
        array(&camera.lens.coefficients()),
        array(&to_rodrigues(&camera.rotation)),
        array(&translation),
        camera.lens.is_fisheye(),
    )
}

/// Writes a calibration that [`read`] and Pose2Sim read.
#[must_use]
pub fn write(cameras: &[Camera]) -> String {
    let mut out = String::new();
    for camera in cameras {
        // Writing to a String cannot fail.
        let _ = write!(
            out,
            "[{}]\nname = {}\nsize = {}\n{}",
            key(&camera.name),
            quoted(&camera.name),
            array(&camera.image_size_px),
            camera_fields(camera, camera.translation),
        );
    }
    out.push_str("[metadata]\nadjusted = false\nerror = 0.0\n");
    out
}

/// Warns when the cameras stand implausibly far from the origin for a body of that height: are they in millimetres?
#[must_use]
pub fn far_cameras(cameras: &[Camera], height_m: f64) -> Option<Warning> {
    let length = |[x, y, z]: [f64; 3]| x.hypot(y).hypot(z);
    let mut distances: Vec<f64> = cameras.iter().map(|camera| length(camera.translation)).collect();
    let distance = median(&mut distances);
    (distance > 100.0 * height_m).then_some(Warning::FarCameras { distance, height: height_m })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINES: [&str; 7] = [
        "[cam1]",
        "size = [1088, 1920]",
        "matrix = [[1681.5, 0, 533.0], [0, 1681.0, 948.0], [0, 0, 1]]",
        "distortions = [-0.1, 0.2, 0.001, 0.002]",
        "rotation = [1.5, 1.0, -0.5]",
        "translation = [0.5, 1.0, 3.0]",
        "fisheye = false",
    ];

    fn with(line: usize, text: &str) -> String {
        let mut lines = LINES;
        lines[line] = text;
        lines.join("\n")
    }

    fn check(line: usize, text: &str, message: &str) {
        assert_eq!(read("Calib.toml", &with(line, text)).unwrap_err().to_string(), message, "{text}");
    }

    #[test]
    fn what_is_written_reads_back() {
        for (coefficients, fisheye) in [
            ("-0.1, 1e-7, 0.001, 0.002", false),
            ("-0.1, 1e-7, 0.001, 0.002, 0.3", false),
            ("-0.1, 1e-7, 0.001, 0.002, 0.3, 0.4, -0.05, 0.006", false),
            ("-0.01, 0.02, -0.003, 0.0", true),
        ] {
            let text = with(3, &format!("distortions = [{coefficients}]"));
            check_round_trip(&text.replace("fisheye = false", &format!("fisheye = {fisheye}")));
        }
    }

    fn check_round_trip(text: &str) {
        let calibration = read("Calib.toml", text).unwrap();
        assert_eq!(calibration.warnings, []);
        let mut again = read("Calib.toml", &write(&calibration.cameras)).unwrap();
        let turn = |c: &Calibration| c.cameras[0].rotation;
        for (a, b) in turn(&calibration).iter().flatten().zip(turn(&again).iter().flatten()) {
            assert!((a - b).abs() <= 1e-15);
        }
        again.cameras[0].rotation = turn(&calibration);
        assert_eq!(again, calibration);
    }

    #[test]
    fn bad_cameras_are_named() {
        check(2, "matrix = [[0, 0, 533], [0, 1681, 948], [0, 0, 1]]", "Calib.toml:3 (cam1): fx = 0; must be positive");
        check(2, "matrix = [[5, 0, 533], [0, -2, 948], [0, 0, 1]]", "Calib.toml:3 (cam1): fy = -2; must be positive");
        check(2, "matrix = [[nan, 0, 533], [0, 2, 948], [0, 0, 1]]", "Calib.toml (cam1): value out of range at line 3");
        check(
            2,
            "matrix = [[5, 0, 2177], [0, 2, 948], [0, 0, 1]]",
            "Calib.toml:3 (cam1): cx = 2177; must be within one image of the image, -1088 to 2176",
        );
        check(4, "", "Calib.toml:1 (cam1): `rotation` is missing");
        check(
            3,
            "distortions = [1, 2]",
            "Calib.toml:4 (cam1): distortions = [1, 2]; must be 4 or 5 numbers: k1, k2, p1, p2 and perhaps k3, or 8: k1, k2, p1, p2, k3, k4, k5, k6",
        );
        check(6, "fisheye = 1", "Calib.toml:7 (cam1): fisheye = 1; must be true or false");
        assert!(read("Calib.toml", "[metadata]\nerror = 0").is_err());
    }

    #[test]
    fn matrices_are_repaired_or_refused() {
        let matrix = |off: f64| format!("rotation = [[1, {off}, 0], [0, 1, 0], [0, 0, 1]]");
        let silent = read("Calib.toml", &with(4, &matrix(9e-7))).unwrap();
        assert_eq!(silent.warnings, []);
        assert!(crate::rotation::orthonormality_error(&silent.cameras[0].rotation) < 1e-15);
        let warned = read("Calib.toml", &with(4, &matrix(5e-4))).unwrap();
        assert_eq!(
            warned.warnings[0].to_string(),
            "Calib.toml:5 (cam1): R'R differs from identity by 0.0005; repaired"
        );
        check(4, &matrix(0.04), "Calib.toml:5 (cam1): R'R differs from identity by 0.04");
        check(
            4,
            "rotation = [[-1, 0, 0], [0, 1, 0], [0, 0, 1]]",
            "Calib.toml:5 (cam1): R is a mirror image (determinant -1); axes are left-handed",
        );
    }

    #[test]
    fn millimetres_are_suspected() {
        let mut cameras = read("Calib.toml", &LINES.join("\n")).unwrap().cameras;
        assert_eq!(far_cameras(&cameras, 1.7), None);
        cameras[0].translation = [0.0, 0.0, 4200.0];
        assert_eq!(
            far_cameras(&cameras, 1.7).unwrap().to_string(),
            "cameras stand 4200 units from the origin but the skeleton is 1.7 tall; are translations in millimetres?"
        );
    }
}
