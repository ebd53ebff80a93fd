//! `sinew convert`: one motion file becomes another.

use super::Ended;
use super::args::{ConvertArgs, General};
use super::report::{self, Report};
use serde_json::json;
use sinew::Error;
use sinew::motion::{self, Format};
use sinew::results::write_whole;

/// Runs the command.
pub(crate) fn run(args: &ConvertArgs, general: &General, report: &Report) -> Result<Ended, Error> {
    let format = Format::of(&args.output)?;
    if let Some(fps) = args.fps.filter(|fps| !(*fps > 0.0 && fps.is_finite())) {
        return Err(Error::Usage {
            message: format!("`--fps` is {fps}; it must be greater than 0"),
            help: "give frames per second, for example 120".into(),
        });
    }
    if same_file(args) {
        return Err(Error::Usage {
            message: format!("{} is both input and output", args.input.display()),
            help: "write to another file".into(),
        });
    }
    if args.output.exists() && !general.force {
        return Err(Error::OutputExists { path: args.output.clone(), why: "" });
    }
    let motion = motion::read(&args.input, args.skeleton.as_deref(), args.fps)?;
    report.warnings(&motion.warnings);
    let name = args.output.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    write_whole(&args.output, &motion::write(&motion, format, &name)?)?;
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
