//! `sinew convert`: one motion file or calibration becomes another.

use super::args::General;
use super::convert_args::ConvertArgs;
use super::convert_calibration;
use super::ended::Ended;
use super::error::Error;
use super::report::{self, Report};
use serde_json::json;
use sinew_motion::convert::{self, ConvertedMotion, Format, rename_bones};
use sinew_results::{Occupied, write_whole};
use std::path::PathBuf;

/// Runs the command.
pub(crate) fn run(args: &ConvertArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    if let Some(input) = replaced_input(args) {
        return Err(sinew::Error::InputIsOutput(input.clone()).into());
    }
    if let Some(format) = convert_calibration::format(args) {
        check_free(args, general)?;
        convert_calibration::run(args, format, report)?;
        return Ok(Ended::Done);
    }
    let format = Format::of(&args.output).map_err(sinew_motion::Error::from)?;
    if let Some(fps) = args.fps.filter(|fps| !(*fps > 0.0 && fps.is_finite())) {
        return Err(Error::NotPositive { flag: "fps", value: fps, help: "give frames per second, for example 120" });
    }
    let is_c3d = format == Format::C3d && Format::of(&args.input).is_ok_and(|input| input == Format::C3d);
    let converted =
        if is_c3d && args.bones.is_none() && args.skeleton.is_none() { again(args)? } else { converted(args, format)? };
    check_free(args, general)?;
    report.warnings(&converted.warnings);
    write_whole(&args.output, &converted.bytes)?;
    let ConvertedMotion { frames, rate_hz, .. } = converted;
    if args.answer.json {
        report::answer_json(&json!({ "frames": frames, "rate_hz": rate_hz, "out": args.output.to_string_lossy() }))?;
    } else {
        report::answer(&format!("{}: {frames} frames at {rate_hz} per second", args.output.display()))?;
    }
    Ok(Ended::Done)
}

/// A C3D file with all that it holds.
fn again(args: &ConvertArgs) -> Result<ConvertedMotion, Error> {
    Ok(convert::rewritten_c3d(&args.input)?)
}

/// A motion in another format.
fn converted(args: &ConvertArgs, format: Format) -> Result<ConvertedMotion, Error> {
    let mut motion = convert::read(&args.input, args.skeleton.as_deref(), args.fps)?;
    if let Some(bones) = args.bones {
        rename_bones(&mut motion, bones.names()).map_err(sinew_motion::Error::from)?;
    }
    let name = args.output.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let bytes = convert::write(&motion, format, &name).map_err(sinew_motion::Error::from)?;
    Ok(ConvertedMotion { bytes, frames: motion.frames(), rate_hz: motion.rate_hz, warnings: motion.warnings })
}

/// Refuses to replace a file without `--force`.
fn check_free(args: &ConvertArgs, general: &General) -> Result<(), Error> {
    if args.output.exists() && !general.force {
        return Err(sinew_results::Error::OutputExists { path: args.output.clone(), found: Occupied::File }.into());
    }
    Ok(())
}

/// The file that is read and would be replaced.
fn replaced_input(args: &ConvertArgs) -> Option<&PathBuf> {
    let output = args.output.canonicalize().ok()?;
    let inputs = [Some(&args.input), args.skeleton.as_ref()];
    inputs.into_iter().flatten().find(|input| input.canonicalize().is_ok_and(|input| input == output))
}
