//! Arguments of `sinew gait`.

use super::answer_args::Answer;
use clap::Args;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub(crate) struct GaitArgs {
    /// Result folder of `sinew track`, best with `--smooth`
    #[arg(value_name = "RESULTS")]
    pub(crate) results: PathBuf,
    #[command(flatten)]
    pub(crate) answer: Answer,
}
