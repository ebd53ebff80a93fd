//! Arguments of `sinew batch`.

use super::answer_args::Answer;
use super::help_template::template;
use clap::{Args, Subcommand};
use sinew_batch::gather::GroupBy;
use sinew_batch::plan::Share;
use sinew_batch::shard::Shard;
use std::path::PathBuf;

/// What is done with many trials.
#[derive(Debug, Subcommand)]
pub(crate) enum BatchCommand {
    /// Find trials by their sinew.toml, and write what is to be done
    #[command(help_template = template!(
        "sinew batch plan recordings -o study",
        "sinew batch plan recordings -o study --pack --shards 64"
    ))]
    Plan(PlanArgs),
    /// Track what is missing, all of it or one part
    #[command(help_template = template!("sinew batch run study", "sinew batch run study --shard 3/16"))]
    Run(RunArgs),
    /// Make one table and one page over all trials
    #[command(help_template = template!("sinew batch gather study", "sinew batch gather study --by name --json"))]
    Gather(GatherArgs),
    /// Take the results of a trial out of a packed study
    #[command(help_template = template!(
        "sinew batch unpack study S1/walk -o walk",
        "sinew batch unpack study S1/walk -o walk --force"
    ))]
    Unpack(UnpackArgs),
}

#[derive(Args, Debug)]
pub(crate) struct PlanArgs {
    /// Folder with trials in it and below
    #[arg(value_name = "TRIALS")]
    pub(crate) trials: PathBuf,
    /// Pack results into one archive a shard in place of a folder a trial
    #[arg(long)]
    pub(crate) pack: bool,
    /// What trials share: subject (a set-up), session (that, and its cameras) or nothing
    #[arg(long, value_name = "WHAT", default_value = "subject")]
    pub(crate) share: Share,
    /// Parts into which the files for schedulers cut the work
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = shards)]
    pub(crate) shards: usize,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

#[derive(Args, Debug)]
pub(crate) struct RunArgs {
    /// Folder that `sinew batch plan` wrote
    #[arg(value_name = "STUDY")]
    pub(crate) study: PathBuf,
    /// Part I of N, counted from 0 [default: as Slurm says, else all]
    #[arg(long, value_name = "I/N", conflicts_with = "shards")]
    pub(crate) shard: Option<Shard>,
    /// Number of parts where the environment says which (JOB_COMPLETION_INDEX)
    #[arg(long, value_name = "N", value_parser = shards)]
    pub(crate) shards: Option<usize>,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

#[derive(Args, Debug)]
pub(crate) struct GatherArgs {
    /// Folder that `sinew batch plan` wrote
    #[arg(value_name = "STUDY")]
    pub(crate) study: PathBuf,
    /// Groups for statistics: folder, name, subject or all
    #[arg(long, value_name = "BY", default_value = "folder")]
    pub(crate) by: GroupBy,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

#[derive(Args, Debug)]
pub(crate) struct UnpackArgs {
    /// Folder that `sinew batch plan` wrote
    #[arg(value_name = "STUDY")]
    pub(crate) study: PathBuf,
    /// Name of the trial, as summary.csv has it
    #[arg(value_name = "TRIAL")]
    pub(crate) trial: String,
}

/// Parts, of which there are some.
fn shards(text: &str) -> Result<usize, String> {
    let count = text.parse().ok().filter(|count| (1..=100_000).contains(count));
    count.ok_or_else(|| "expected a whole number from 1 to 100000".into())
}
