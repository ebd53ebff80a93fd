//! Calibrations of any program, recognised by what they contain.
//!
//! | program | file | module | written |
//! |---|---|---|---|
//! | Pose2Sim | `Calib.toml` | [`calib_toml`] | yes |
//! | Caliscope | `camera_array.toml` | [`caliscope_cameras`] | yes |
//! | Anipose, FreeMoCap | `calibration.toml` | [`anipose_cameras`] | yes |
//! | Qualisys | `.qca.txt` | [`qualisys_cameras`] | lenses with k1, k2, k3, p1 and p2 |
//! | OpenCV | YAML, XML | [`opencv_cameras`] | YAML |
//!
//! XML and OpenCV's YAML are known by their first words, TOML by its tables: `[cameras.N]` or `[cam_N]` with a `port` is
//! Caliscope's, `[cam_0]` … with a `[metadata]` of Anipose's or FreeMoCap's kind theirs, any other Pose2Sim's. The name
//! of a file says nothing. Whatever it is read from, a camera has metres, pixels and the axes of OpenCV.
//!
//! ```
//! use sinew_formats::calibration::{self, CalibrationFormat};
//! # let text = "[cameras.3]\ncam_id = 3\nsize = [640, 480]\nmatrix = [[500, 0, 320], [0, 500, 240], [0, 0, 1]]\ndistortions = [0, 0, 0, 0, 0]\nrotation = [0, 0, 0]\ntranslation = [0, 0, 3]\n";
//! assert_eq!(calibration::recognised("camera_array.toml", text)?, CalibrationFormat::Caliscope);
//! let cameras = calibration::read("camera_array.toml", text)?.cameras;
//! let yaml = calibration::write(&cameras, CalibrationFormat::OpenCv)?;
//! assert_eq!(calibration::read("cameras.yml", &yaml)?.cameras, cameras);
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::calib_toml::Calibration;
use crate::source_text::{shortened, without_mark};
use crate::toml_text::Document;
use crate::xml_text::Xml;
use crate::{
    Error, Place, anipose_cameras, calib_toml, caliscope_cameras, opencv_cameras, opencv_storage, qualisys_cameras,
};
use sinew_observe::Camera;

/// A format of calibrations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CalibrationFormat {
    /// `Calib.toml`.
    Pose2Sim,
    /// `camera_array.toml`.
    Caliscope,
    /// `calibration.toml`, also FreeMoCap's.
    Anipose,
    /// `.qca.txt`.
    Qualisys,
    /// YAML or XML of `FileStorage`.
    OpenCv,
}

impl CalibrationFormat {
    /// Program that writes the format.
    #[must_use]
    pub const fn program(self) -> &'static str {
        match self {
            Self::Pose2Sim => "Pose2Sim",
            Self::Caliscope => "Caliscope",
            Self::Anipose => "Anipose or FreeMoCap",
            Self::Qualisys => "Qualisys",
            Self::OpenCv => "OpenCV",
        }
    }

    /// The format of a file to be written, by its name.
    ///
    /// `.yml` and `.yaml` are OpenCV's, `.qca.txt` Qualisys's, `camera_array.toml` is Caliscope's, and any other `.toml`
    /// Pose2Sim's.
    #[must_use]
    pub fn from_file_name(name: &str) -> Option<Self> {
        let name = name.to_lowercase();
        if name == "camera_array.toml" {
            Some(Self::Caliscope)
        } else if name.ends_with(".toml") {
            Some(Self::Pose2Sim)
        } else if name.ends_with(".yml") || name.ends_with(".yaml") {
            Some(Self::OpenCv)
        } else if name.ends_with(".qca.txt") {
            Some(Self::Qualisys)
        } else {
            None
        }
    }
}

/// The format of a text.
///
/// # Errors
/// [`Error::UnknownCalibration`] for what is none of them; XML and TOML that is malformed.
pub fn recognised(name: &str, text: &str) -> Result<CalibrationFormat, Error> {
    let start = without_mark(text).trim_start();
    let unknown = |found: String| Error::UnknownCalibration { place: Place::file(name), found };
    if opencv_storage::is_of(text) {
        return Ok(CalibrationFormat::OpenCv);
    }
    if start.starts_with('<') {
        let xml = Xml::parse(name, text)?;
        let found = || unknown(format!("XML with the element <{}>", shortened(xml.root().name())));
        return if qualisys_cameras::is_of(xml.root()) { Ok(CalibrationFormat::Qualisys) } else { Err(found()) };
    }
    if start.is_empty() {
        return Err(unknown("the file is empty".into()));
    }
    if start.starts_with('{') {
        return Err(unknown("JSON".into()));
    }
    let mut lines = start.lines().map(str::trim_start).filter(|line| !line.is_empty() && !line.starts_with('#'));
    if !lines.next().is_some_and(|line| line.starts_with('[') || line.contains('=')) {
        let first = shortened(start.lines().next().unwrap_or_default());
        return Err(unknown(format!("a text that begins with `{first}`")));
    }
    let document = Document::parse(name, text)?;
    Ok(if caliscope_cameras::is_of(document.root()) {
        CalibrationFormat::Caliscope
    } else if anipose_cameras::is_of(document.root()) {
        CalibrationFormat::Anipose
    } else {
        CalibrationFormat::Pose2Sim
    })
}

/// Reads a calibration of any format.
///
/// # Errors
/// What [`recognised`] and the reader of the format refuse.
pub fn read(name: &str, text: &str) -> Result<Calibration, Error> {
    match recognised(name, text)? {
        CalibrationFormat::Pose2Sim => calib_toml::read(name, text),
        CalibrationFormat::Caliscope => caliscope_cameras::read(name, text),
        CalibrationFormat::Anipose => anipose_cameras::read(name, text),
        CalibrationFormat::Qualisys => qualisys_cameras::read(name, text),
        CalibrationFormat::OpenCv => opencv_cameras::read(name, text),
    }
}

/// Writes a calibration.
///
/// # Errors
/// [`Error::CameraUnwritable`] for a lens that the format has not.
pub fn write(cameras: &[Camera], format: CalibrationFormat) -> Result<String, Error> {
    match format {
        CalibrationFormat::Pose2Sim => Ok(calib_toml::write(cameras)),
        CalibrationFormat::Caliscope => Ok(caliscope_cameras::write(cameras)),
        CalibrationFormat::Anipose => Ok(anipose_cameras::write(cameras)),
        CalibrationFormat::Qualisys => qualisys_cameras::write(cameras),
        CalibrationFormat::OpenCv => Ok(opencv_cameras::write(cameras)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, message: &str) {
        assert_eq!(recognised("a.toml", text).unwrap_err().to_string(), format!("a.toml: {message}"));
    }

    #[test]
    fn what_is_no_calibration_is_named() {
        let expected = "expected a calibration of Pose2Sim, Caliscope, Anipose, FreeMoCap, Qualisys or OpenCV";
        check("", &format!("the file is empty; {expected}"));
        check("{\"a\": 1}", &format!("JSON; {expected}"));
        check("<html><calibration/></html>", &format!("XML with the element <html>; {expected}"));
        check("camera 1 2 3", &format!("a text that begins with `camera 1 2 3`; {expected}"));
        check("[cam1]\nsize = [1,", "ends inside an array at byte 17 (line 2)");
    }
}
