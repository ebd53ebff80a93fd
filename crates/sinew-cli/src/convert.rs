//! `sinew convert`: one motion file becomes another.

use super::args::{ConvertArgs, General};
use super::ended::Ended;
use super::error::Error;
use super::report::{self, Report};
use serde_json::json;
use sinew::results::error::Occupied;
use sinew::results::write_whole;
use sinew_tools::motion::{self, Format};

/// Runs the command.
pub(crate) fn run(args: &ConvertArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let format = Format::of(&args.output).map_err(sinew_tools::Error::from)?;
    if let Some(fps) = args.fps.filter(|fps| !(*fps > 0.0 && fps.is_finite())) {
        return Err(Error::NotPositive { flag: "fps", value: fps, help: "give frames per second, for example 120" });
    }
    if same_file(args) {
        return Err(Error::InputIsOutput(args.input.clone()));
    }
    let motion = motion::read(&args.input, args.skeleton.as_deref(), args.fps)?;
    if args.output.exists() && !general.force {
        return Err(sinew::Error::OutputExists { path: args.output.clone(), found: Occupied::File }.into());
    }
    report.warnings(&motion.warnings);
    let name = args.output.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    write_whole(&args.output, &motion::write(&motion, format, &name).map_err(sinew_tools::Error::from)?)?;
    if args.answer.json {
        report::answer_json(
            &json!({ "frames": motion.frames(), "rate_hz": motion.rate_hz, "out": args.output.to_string_lossy() }),
        )?;
    } else {
        report::answer(&format!(
            "{}: {} frames at {} per second",
            args.output.display(),
            motion.frames(),
            motion.rate_hz
        ))?;
    }
    Ok(Ended::Done)
}

fn same_file(args: &ConvertArgs) -> bool {
    let input = args.input.canonicalize();
    input.is_ok() && input.ok() == args.output.canonicalize().ok()
}
