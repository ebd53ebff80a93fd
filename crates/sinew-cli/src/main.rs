//! The program `sinew`: arguments in, answers to stdout, everything else to stderr.
//!
//! Exit codes are listed in the table of [`sinew_words::exit_codes`].

mod answer_args;
mod args;
mod batch;
mod batch_args;
mod body;
mod compare;
mod compare_args;
mod convert;
mod convert_args;
mod convert_calibration;
mod demo;
mod ended;
mod error;
mod export_args;
mod export_opensim;
mod fit_shape;
mod gait;
mod gait_args;
mod help_template;
mod inspect;
mod interrupt;
mod learn;
mod learn_args;
mod live;
mod manual;
mod misplaced;
mod overlay;
mod predict;
mod progress;
mod report;
mod report_page;
mod segment;
mod setting_args;
mod simulate;
mod simulate_crowd;
mod simulated_files;
mod study_words;
mod sync;
mod table;
mod terminal;
mod track;
mod validate;

use args::{Cli, Command, General};
use clap::FromArgMatches as _;
use export_args::ExportCommand;
use learn_args::LearnCommand;
use report::Report;
use std::process::ExitCode;

fn main() -> ExitCode {
    let parsed =
        misplaced::command().try_get_matches().and_then(|matches| Ok((Cli::from_arg_matches(&matches)?, matches)));
    let (cli, matches) = match parsed {
        Ok(parsed) => parsed,
        Err(wrong) => {
            let Some(error) = misplaced::flag(&wrong) else { wrong.exit() };
            Report::new(&General::default()).error(&error);
            return ExitCode::from(error.exit_code());
        }
    };
    let report = Report::new(&cli.general);
    let unused: Vec<String> = misplaced::unused(&cli.general, &matches)
        .iter()
        .map(|flag| format!("`--{flag}` has no use in this command"))
        .collect();
    report.warnings(&unused);
    let ended = match &cli.command {
        Command::Demo(answer) => demo::run(*answer, &cli.general, &report),
        Command::Sync(args) => sync::run(args, &cli.general, &report),
        Command::Inspect(args) => inspect::run(args, &cli.general, &report),
        Command::Track(args) => track::run(args, &cli.general, &report),
        Command::Simulate(args) => simulate::run(args, &cli.general, &report),
        Command::Convert(args) => convert::run(args, &cli.general, &report),
        Command::Segment(args) => segment::run(args, &cli.general, &report),
        Command::Overlay(args) => overlay::run(args, &cli.general, &report),
        Command::Report(args) => report_page::run(args, &cli.general, &report),
        Command::Compare(args) => compare::run(args, &cli.general, &report),
        Command::Export { what: ExportCommand::Opensim(args) } => export_opensim::run(args, &cli.general, &report),
        Command::Gait(args) => gait::run(args, &cli.general, &report),
        Command::Predict(args) => predict::run(args, &cli.general, &report),
        Command::Validate(args) => validate::run(args, &cli.general, &report),
        Command::FitShape(args) => fit_shape::run(args, &cli.general, &report),
        Command::Learn { what: LearnCommand::Primitives(args) } => learn::primitives::run(args, &cli.general, &report),
        Command::Learn { what: LearnCommand::Latent(args) } => learn::latent::run(args, &cli.general, &report),
        Command::Batch { what } => batch::run(what, &cli.general, &report),
        Command::Body { body, answer } => body::run(body, *answer),
        Command::Completions { shell } => manual::completions(*shell),
        Command::Man => manual::man(),
    };
    match ended {
        Ok(ended) => ExitCode::from(ended.code()),
        // The reader of our answer has enough of it.
        Err(error) if report::is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            report.error(&error);
            ExitCode::from(error.exit_code())
        }
    }
}
