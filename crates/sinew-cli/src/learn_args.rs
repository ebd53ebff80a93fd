//! Arguments of `sinew learn`.

use super::answer_args::Answer;
use super::help_template::template;
use clap::{Args, Subcommand};
use sinew_latent::check::MAX_ROWS;
use sinew_latent::file::LatentKind;
use sinew_motion::follow::NamedBody;
use std::path::PathBuf;

/// What can be learned.
#[derive(Debug, Subcommand)]
pub(crate) enum LearnCommand {
    /// Learn action primitives: clusters of short pieces of recorded motion
    #[command(help_template = template!(
        "sinew learn primitives --motion walk1.bvh walk2.bvh --body h32 -o walk.json",
        "sinew learn primitives --motion 07_02.amc 07_05.amc --held-out 07_01.amc --body hppf24 -o w.json"
    ))]
    Primitives(PrimitivesArgs),
    /// Learn a latent model: a space of few coordinates in which poses lie
    #[command(help_template = template!(
        "sinew learn latent --motion walk1.bvh walk2.bvh --body h32 -o walk.json",
        "sinew learn latent --model hgplvm --motion 07_02.amc --held-out 07_01.amc --body hppf24 -o w.json"
    ))]
    Latent(LatentArgs),
}

/// Motion files, and how they are read.
#[derive(Args, Debug)]
pub(crate) struct MotionArgs {
    /// Motion files to learn from: .bvh, .trc, .csv or .amc
    #[arg(long, required = true, num_args = 1.., value_name = "FILES")]
    pub(crate) motion: Vec<PathBuf>,
    /// Motion files to try the model on
    #[arg(long, num_args = 1.., value_name = "FILES")]
    pub(crate) held_out: Vec<PathBuf>,
    /// Skeleton of the .amc files [default: <subject>.asf beside each]
    #[arg(long, value_name = "F.asf")]
    pub(crate) skeleton: Option<PathBuf>,
    /// Frames per second of the .amc files, which state none [default: 120]
    #[arg(long, value_name = "F", value_parser = rate, allow_negative_numbers = true)]
    pub(crate) amc_fps: Option<f64>,
    /// Body that is tracked: h32, cf28, hppf24 or hapf31
    #[arg(long, value_name = "NAME", hide_possible_values = true, value_parser = NamedBody::ALL.map(NamedBody::name))]
    pub(crate) body: String,
    /// Frames per second of the recordings to be tracked
    #[arg(long, value_name = "F", default_value_t = 20.0, value_parser = rate, allow_negative_numbers = true)]
    pub(crate) fps: f64,
}

#[derive(Args, Debug)]
pub(crate) struct PrimitivesArgs {
    #[command(flatten)]
    pub(crate) files: MotionArgs,
    /// Clusters of each feature vector
    #[arg(long, value_name = "N", default_value = "80", value_parser = clusters)]
    pub(crate) clusters: usize,
    /// Frames in an action primitive
    #[arg(long, value_name = "D", default_value = "3", value_parser = length)]
    pub(crate) length: usize,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

#[derive(Args, Debug)]
pub(crate) struct LatentArgs {
    #[command(flatten)]
    pub(crate) files: MotionArgs,
    /// Kind: gplvm, gpdm (with dynamics) or hgplvm (by limbs)
    #[arg(long, value_name = "KIND", default_value = "gpdm", hide_possible_values = true, value_parser = LatentKind::ALL.map(LatentKind::name))]
    pub(crate) model: String,
    /// Coordinates of a latent, at most
    #[arg(long, value_name = "Q", default_value = "3", value_parser = dim)]
    pub(crate) dim: usize,
    /// Frames to learn from, at most
    #[arg(long, value_name = "N", default_value = "400", value_parser = rows)]
    pub(crate) rows: usize,
    /// Whether the dynamics of gpdm count as much as the poses [default: true]
    #[arg(long, value_name = "BOOL", hide_possible_values = true)]
    pub(crate) balanced: Option<bool>,
    /// Let latents of gplvm or gpdm be a smooth function of the poses
    #[arg(long)]
    pub(crate) back: bool,
    /// Give each file a root of its own (hgplvm)
    #[arg(long)]
    pub(crate) root_per_motion: bool,
    /// Steps at most
    #[arg(long, value_name = "N", default_value = "1000", value_parser = steps)]
    pub(crate) steps: usize,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

/// Least and greatest frame rate of a model.
const RATES: std::ops::RangeInclusive<f64> = 1.0..=1000.0;

fn rate(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate| RATES.contains(rate));
    rate.ok_or_else(|| format!("expected frames per second from {} to {}", RATES.start(), RATES.end()))
}

/// More have no windows.
const MOST_CLUSTERS: usize = 10_000;
/// Longer ones have more numbers than their covariance has room for.
const LONGEST: usize = 100;

/// Coordinates of a latent at most: more are no map of a motion.
const MOST_DIMENSIONS: usize = 10;
/// Steps at most.
const MOST_STEPS: usize = 1_000_000;

fn dim(text: &str) -> Result<usize, String> {
    whole(text, MOST_DIMENSIONS)
}

fn rows(text: &str) -> Result<usize, String> {
    whole(text, MAX_ROWS)
}

fn steps(text: &str) -> Result<usize, String> {
    whole(text, MOST_STEPS)
}

fn clusters(text: &str) -> Result<usize, String> {
    whole(text, MOST_CLUSTERS)
}

fn length(text: &str) -> Result<usize, String> {
    whole(text, LONGEST)
}

fn whole(text: &str, most: usize) -> Result<usize, String> {
    let count = text.parse().ok().filter(|count| (1..=most).contains(count));
    count.ok_or_else(|| format!("expected a whole number from 1 to {most}"))
}
