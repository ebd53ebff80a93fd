//! `sinew convert` of a calibration: from any program to the one that is named.

use super::convert_args::{ConvertArgs, Program};
use super::error::Error;
use super::report::{self, Report};
use serde_json::json;
use sinew::formats::calibration::{self, CalibrationFormat};
use sinew::formats::caliscope_cameras;
use sinew::input::recording::Calibrated;
use sinew::observe::Camera;
use sinew_motion::convert::MotionError;
use sinew_results::write_whole;

/// The format to write, if what is to be written is a calibration.
pub(crate) fn format(args: &ConvertArgs) -> Option<CalibrationFormat> {
    let name = args.output.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    args.to.map(Program::format).or_else(|| CalibrationFormat::from_file_name(&name))
}

/// Converts.
pub(crate) fn run(args: &ConvertArgs, format: CalibrationFormat, report: &Report) -> Result<(), Error> {
    if args.skeleton.is_some() {
        return Err(sinew_motion::Error::from(MotionError::NeedlessSkeleton { path: args.input.clone() }).into());
    }
    if args.bones.is_some() {
        return Err(Error::BonesOfCalibration);
    }
    if args.fps.is_some() {
        return Err(Error::RateOfCalibration);
    }
    let read = Calibrated::read(&args.input)?;
    report.warnings(&read.warnings);
    report.warnings(renamed(&read.cameras, format).as_slice());
    let text = calibration::write(&read.cameras, format).map_err(sinew_input::Error::from)?;
    write_whole(&args.output, text.as_bytes())?;
    let out = args.output.display();
    if args.answer.json {
        report::answer_json(&json!({ "cameras": read.names, "out": out.to_string(), "program": format.program() }))?;
    } else {
        report::answer(&format!("{out}: {} cameras, for {}", read.cameras.len(), format.program()))?;
    }
    Ok(())
}

/// Cameras that Caliscope will know by a number that is not in their name.
fn renamed(cameras: &[Camera], format: CalibrationFormat) -> Option<String> {
    if format != CalibrationFormat::Caliscope {
        return None;
    }
    let numbers = caliscope_cameras::numbers(cameras);
    let pairs = cameras.iter().zip(numbers).map(|(camera, number)| (&camera.name, number));
    let renamed = pairs.filter(|(name, number)| **name != format!("cam_{number}"));
    let listed: Vec<String> = renamed.map(|(name, number)| format!("`{name}` is {number}")).collect();
    (!listed.is_empty()).then(|| format!("Caliscope knows cameras by number: {}", listed.join(", ")))
}
