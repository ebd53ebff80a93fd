//! Arguments of `sinew export`.

use super::answer_args::Answer;
use super::help_template::template;
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// Programs that a result can be made ready for.
#[derive(Debug, Subcommand)]
pub(crate) enum ExportCommand {
    /// Settings for OpenSim's scaling and inverse kinematics, with weights of markers
    #[command(help_template = template!(
        "sinew export opensim sinew-out/trial --model Model_Pose2Sim_simple.osim",
        "sinew export opensim sinew-out/trial -o opensim"
    ))]
    Opensim(OpensimArgs),
}

#[derive(Args, Debug)]
pub(crate) struct OpensimArgs {
    /// Result folder of `sinew track`
    #[arg(value_name = "RESULT")]
    pub(crate) results: PathBuf,
    /// Model to be scaled, Pose2Sim's or another [default: model.osim in the folder]
    #[arg(long, value_name = "FILE")]
    pub(crate) model: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) answer: Answer,
}
