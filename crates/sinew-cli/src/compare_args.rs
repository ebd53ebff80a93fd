//! Arguments of `sinew compare`.

use super::answer_args::Answer;
use clap::{Args, ValueEnum};
use sinew_analysis::compare::PartsToAlign;
use std::path::PathBuf;

#[derive(Args, Debug)]
pub(crate) struct CompareArgs {
    /// Result folder of `sinew track`
    #[arg(value_name = "RESULT")]
    pub(crate) results: PathBuf,
    /// Markers or joint centres (.c3d, .trc, .csv, .bvh), or angles (.mot)
    #[arg(value_name = "REFERENCE")]
    pub(crate) reference: PathBuf,
    /// TOML that says which of its points are ours: [points] RKnee = ["RKNE", "RKNM"]
    #[arg(long, value_name = "FILE")]
    pub(crate) names: Option<PathBuf>,
    /// Align first: both (clock and world), time, space or none
    #[arg(long, value_enum, value_name = "WHAT", default_value_t, hide_possible_values = true)]
    pub(crate) align: AlignedParts,
    /// Fit a scale of the reference as well, if space is aligned
    #[arg(long)]
    pub(crate) scale: bool,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

/// What of a reference is aligned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum AlignedParts {
    #[default]
    Both,
    Time,
    Space,
    None,
}

impl AlignedParts {
    pub(crate) const fn parts(self, scale: bool) -> PartsToAlign {
        let space = matches!(self, Self::Both | Self::Space);
        PartsToAlign { time: matches!(self, Self::Both | Self::Time), space, scale }
    }
}
