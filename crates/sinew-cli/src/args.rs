//! Arguments of every command.
//!
//! Flags that are settings come from the one table of settings; a command has the ones that it uses.

use super::answer_args::Answer;
use super::batch_args::BatchCommand;
use super::compare_args::CompareArgs;
use super::convert_args::ConvertArgs;
use super::export_args::ExportCommand;
use super::gait_args::GaitArgs;
use super::help_template::template;
use super::learn_args::LearnCommand;
use super::setting_args::{InspectSettings, SyncSettings, TrackSettings, Typed};
use clap::{ArgAction, Args, Parser, Subcommand, ValueEnum};
use sinew::config::common::{FORCE, OUT, SEED, THREADS};
use sinew::config::resolved::Given;
use std::ops::Range;
use std::path::PathBuf;

#[derive(Debug, Parser)]
#[command(
    name = "sinew",
    version,
    about = "Tracks a human body from calibrated cameras: a posterior over 3D poses for every frame",
    help_template = template!("sinew demo", "sinew track --calibration Calib.toml --keypoints pose --fps 60"),
    subcommand_help_heading = "Commands",
    disable_help_subcommand = true,
    max_term_width = 100
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Command,
    #[command(flatten)]
    pub(crate) general: General,
}

/// When to use colours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum Color {
    #[default]
    Auto,
    Always,
    Never,
}

/// Place in the help after the flags of the command itself.
const LAST: usize = 100;

/// Flags that every command takes.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "General")]
pub(crate) struct General {
    /// Output folder, or file of learn and inspect [default: sinew-out/<trial>]
    #[arg(short, long, global = true, display_order = LAST, value_name = "DIR", help_heading = "Output")]
    pub(crate) out: Option<String>,
    /// Replace results that are there
    #[arg(long, global = true, display_order = LAST, help_heading = "Output")]
    pub(crate) force: bool,
    /// Settings from this file instead of the trial's sinew.toml
    #[arg(long, global = true, display_order = LAST, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// Seed of all random streams [default: 1]
    #[arg(long, global = true, display_order = LAST, value_name = "N", allow_negative_numbers = true)]
    pub(crate) seed: Option<String>,
    /// Threads [default: what the system grants]
    #[arg(long, global = true, display_order = LAST, value_name = "N", allow_negative_numbers = true)]
    pub(crate) threads: Option<String>,
    /// Show warnings and errors only; twice for errors only
    #[arg(short, long, global = true, display_order = LAST, action = ArgAction::Count)]
    pub(crate) quiet: u8,
    /// Show more; twice for still more
    #[arg(short, long, global = true, display_order = LAST, action = ArgAction::Count, hide_short_help = true)]
    pub(crate) verbose: u8,
    /// Colours on stderr; NO_COLOR is obeyed
    #[arg(long, global = true, display_order = LAST, value_enum, default_value_t, value_name = "WHEN", hide_short_help = true)]
    pub(crate) color: Color,
    /// Show no progress
    #[arg(long, global = true, display_order = LAST, hide_short_help = true)]
    pub(crate) no_progress: bool,
}

impl General {
    /// Flags that are settings.
    pub(crate) fn settings(&self) -> Given {
        let given = [(OUT.key, &self.out), (SEED.key, &self.seed), (THREADS.key, &self.threads)];
        let mut settings: Vec<_> = given.into_iter().filter_map(|(key, value)| Some((key, value.clone()?))).collect();
        if self.force {
            settings.push((FORCE.key, "true".into()));
        }
        settings
    }
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Track a synthetic walker: no data needed, a few seconds
    #[command(help_template = template!("sinew demo", "sinew demo -o /tmp/walk --seed 7"))]
    Demo(Answer),
    /// Say what files contain, what is odd, and whether calibration and keypoints fit
    #[command(help_template = template!("sinew inspect Calib.toml pose", "sinew inspect walk.json -o walk.svg"))]
    Inspect(InspectArgs),
    /// Say how late cameras are against each other, to a fraction of a frame
    #[command(help_template = template!(
        "sinew sync --calibration Calib.toml --keypoints pose --fps 60",
        "sinew track --sync --calibration Calib.toml --keypoints pose --fps 60"
    ))]
    Sync(SyncArgs),
    /// Track the people in a recording
    #[command(help_template = template!(
        "sinew track --calibration Calib.toml --keypoints pose --fps 60",
        "sinew track --config sinew.toml --frames 0..100 -o out"
    ))]
    Track(TrackArgs),
    /// Write a synthetic recording: keypoints, silhouettes and pictures
    #[command(help_template = template!("sinew simulate -o walk", "sinew simulate --motion 07_01.amc --skeleton 07.asf --segmentation hard"))]
    Simulate(SimulateArgs),
    /// Convert motion files (TRC, C3D, BVH, MOT, CSV, AMC) and calibrations
    #[command(help_template = template!("sinew convert 07_01.amc walk.bvh --skeleton 07.asf", "sinew convert camera_array.toml Calib.toml"))]
    Convert(ConvertArgs),
    /// Make masks of who stands before a background that does not move
    #[command(help_template = template!(
        "sinew segment --background empty --images images -o masks",
        "sinew segment --background before --background after --images images --shadow 0.5 -o masks"
    ))]
    Segment(SegmentArgs),
    /// Draw the tracked body over images or masks
    #[command(help_template = template!(
        "sinew overlay sinew-out/trial --calibration Calib.toml --images images -o pictures",
        "sinew overlay out --calibration Calib.toml --silhouettes masks --every 10 -o pictures"
    ))]
    Overlay(OverlayArgs),
    /// Write one HTML page that shows a result: the person in 3D, curves, doubts
    #[command(help_template = template!(
        "sinew report sinew-out/trial --calibration Calib.toml",
        "sinew report sinew-out/trial -o trial.html"
    ))]
    Report(ReportArgs),
    /// Events, strides and angles over the cycle of a person who walks, with intervals
    #[command(help_template = template!("sinew gait sinew-out/trial", "sinew gait sinew-out/trial --json -o gait"))]
    Gait(GaitArgs),
    /// Hold a result against a laboratory's markers, or another program's angles
    #[command(help_template = template!(
        "sinew compare sinew-out/trial trial.c3d",
        "sinew compare sinew-out/trial trial.c3d --names names.toml --json -o beside"
    ))]
    Compare(CompareArgs),
    /// Make a result ready for another program
    #[command(
        disable_help_subcommand = true,
        subcommand_help_heading = "Programs",
        help_template = template!(
            "sinew export opensim sinew-out/trial --model Model_Pose2Sim_simple.osim",
            "sinew export opensim sinew-out/trial -o opensim"
        )
    )]
    Export {
        #[command(subcommand)]
        what: ExportCommand,
    },
    /// Say what a camera that a run did not use should see
    #[command(help_template = template!(
        "sinew predict sinew-out/trial --calibration Calib.toml --camera cam4 -o predicted.csv",
        "sinew predict out --calibration Calib.toml --camera left --json -o left.csv"
    ))]
    Predict(PredictArgs),
    /// Leave each camera out in turn: what the intervals of a recording are worth
    #[command(help_template = template!(
        "sinew validate --calibration Calib.toml --keypoints pose -o worth",
        "sinew validate --frames 0..300 --json -o worth"
    ))]
    Validate(ValidateArgs),
    /// Fit the thickness of a tracked person to masks, and write a body file
    #[command(help_template = template!(
        "sinew fit-shape sinew-out/trial --calibration Calib.toml --silhouettes masks -o body.toml",
        "sinew track --body body.toml --calibration Calib.toml --silhouettes masks --init start.trc"
    ))]
    FitShape(FitShapeArgs),
    /// Learn a model of motion or poses from motion files
    #[command(
        disable_help_subcommand = true,
        subcommand_help_heading = "Models",
        help_template = template!(
            "sinew learn primitives --motion walk1.bvh walk2.bvh --body h32 -o walk.json",
            "sinew track --motion-model walk.json --calibration Calib.toml --keypoints pose --fps 20"
        )
    )]
    Learn {
        #[command(subcommand)]
        what: LearnCommand,
    },
    /// Track many trials: plan, run in parts, gather
    #[command(
        disable_help_subcommand = true,
        subcommand_help_heading = "Steps",
        help_template = template!("sinew batch plan recordings -o study", "sinew batch run study --shard 3/16")
    )]
    Batch {
        #[command(subcommand)]
        what: BatchCommand,
    },
    /// Show a body as a tree
    #[command(help_template = template!("sinew body h32", "sinew body my_body.toml"))]
    Body {
        /// h32, cf28, hppf24, hapf31 or a body file
        #[arg(value_name = "NAME|FILE")]
        body: String,
        #[command(flatten)]
        answer: Answer,
    },
    /// Print completions for a shell
    #[command(help_template = template!("sinew completions bash > sinew.bash", "sinew completions zsh > _sinew"))]
    Completions {
        /// Shell
        shell: clap_complete::Shell,
    },
    /// Print the manual page
    #[command(help_template = template!("sinew man > sinew.1", "sinew man | man -l -"))]
    Man,
}

#[derive(Args, Debug)]
pub(crate) struct InspectArgs {
    /// Calibrations, keypoint folders, motion files, motion models, results; our other files
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) settings: Typed<InspectSettings>,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

/// Frames that cameras are apart at most.
pub(crate) const MOST_APART: u64 = 120;

#[derive(Args, Debug)]
pub(crate) struct SyncArgs {
    #[command(flatten)]
    pub(crate) settings: Typed<SyncSettings>,
    /// Frames that cameras are apart at most
    #[arg(long, value_name = "N", default_value_t = MOST_APART, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub(crate) most: u64,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

#[derive(Args, Debug)]
pub(crate) struct SegmentArgs {
    /// Images without anybody; repeat the flag for more folders
    #[arg(long, required = true, value_name = "DIR")]
    pub(crate) background: Vec<PathBuf>,
    /// Images of the cameras: <camera>_<frame>.jpg, or folders <camera>
    #[arg(long, value_name = "DIR")]
    pub(crate) images: PathBuf,
    /// Standard deviations that make a pixel the person's
    #[arg(long, value_name = "N", default_value_t = 5.0, allow_negative_numbers = true)]
    pub(crate) threshold: f32,
    /// Darkest shadow, as a share of the background's brightness
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    pub(crate) shadow: Option<f32>,
    /// Least part that is kept, as a share of the largest
    #[arg(long, value_name = "SHARE", default_value_t = 0.1, allow_negative_numbers = true)]
    pub(crate) least_part: f64,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

#[derive(Args, Debug)]
pub(crate) struct OverlayArgs {
    /// Result folder of `sinew track`
    #[arg(value_name = "RESULTS")]
    pub(crate) results: PathBuf,
    /// Camera calibration that was tracked with
    #[arg(long, value_name = "FILE")]
    pub(crate) calibration: PathBuf,
    /// Images to draw on, <camera>_<frame>.jpg [default: black]
    #[arg(long, value_name = "DIR", conflicts_with = "silhouettes")]
    pub(crate) images: Option<PathBuf>,
    /// Masks to draw on, in grey
    #[arg(long, value_name = "DIR")]
    pub(crate) silhouettes: Option<PathBuf>,
    /// Size of the images or masks over that of the calibrated images
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(crate) mask_scale: Option<f64>,
    /// Frames to draw, by number [default: all]
    #[arg(long, value_name = "A..B", value_parser = frames)]
    pub(crate) frames: Option<Range<u64>>,
    /// Draw every N-th of them
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub(crate) every: u32,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

#[derive(Args, Debug)]
pub(crate) struct ReportArgs {
    /// Result folder of `sinew track`
    #[arg(value_name = "RESULTS")]
    pub(crate) results: PathBuf,
    /// Camera calibration that was tracked with: where cameras look
    #[arg(long, value_name = "FILE")]
    pub(crate) calibration: Option<PathBuf>,
    /// validation.csv of `sinew validate`: what the intervals are worth
    #[arg(long, value_name = "FILE")]
    pub(crate) validation: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

#[derive(Args, Debug)]
pub(crate) struct PredictArgs {
    /// Result folder of `sinew track`
    #[arg(value_name = "RESULTS")]
    pub(crate) results: PathBuf,
    /// Calibration that has the camera
    #[arg(long, value_name = "FILE")]
    pub(crate) calibration: PathBuf,
    /// The camera, which the run did not use
    #[arg(long, value_name = "NAME")]
    pub(crate) camera: String,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

#[derive(Args, Debug)]
pub(crate) struct ValidateArgs {
    #[command(flatten)]
    pub(crate) settings: Typed<TrackSettings>,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

#[derive(Args, Debug)]
pub(crate) struct FitShapeArgs {
    /// Result folder of `sinew track`
    #[arg(value_name = "RESULTS")]
    pub(crate) results: PathBuf,
    /// Camera calibration that was tracked with
    #[arg(long, value_name = "FILE")]
    pub(crate) calibration: PathBuf,
    /// Masks of the person: <camera>_<frame>.png, or folders <camera>
    #[arg(long, value_name = "DIR")]
    pub(crate) silhouettes: PathBuf,
    /// Size of the masks over that of the calibrated images
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(crate) mask_scale: Option<f64>,
    /// Frames to take a few of, by number [default: all]
    #[arg(long, value_name = "A..B", value_parser = frames)]
    pub(crate) frames: Option<Range<u64>>,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

fn frames(text: &str) -> Result<Range<u64>, String> {
    let ends =
        text.split_once("..").and_then(|(first, end)| Some((first.trim().parse().ok()?, end.trim().parse().ok()?)));
    match ends {
        Some((first, end)) if first < end => Ok(first..end),
        Some(_) => Err("the end must come after the start".into()),
        None => Err("expected frame numbers A..B, for example 0..60".into()),
    }
}

#[derive(Args, Debug)]
pub(crate) struct SimulateArgs {
    /// `walk`, or a motion file: .bvh, .trc, .csv or .amc
    #[arg(long, value_name = "walk|FILE", default_value = "walk")]
    pub(crate) motion: PathBuf,
    /// Skeleton of an .amc file
    #[arg(long, value_name = "F.asf")]
    pub(crate) skeleton: Option<PathBuf>,
    /// Seconds [default: 4 of a walk, all of a file]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(crate) duration: Option<f64>,
    /// Frames per second
    #[arg(long, value_name = "F", default_value_t = 30.0, allow_negative_numbers = true)]
    pub(crate) fps: f64,
    /// Cameras in a circle around the motion
    #[arg(long, value_name = "N", default_value = "4", value_parser = count)]
    pub(crate) cameras: usize,
    /// People whose ways cross; of several, keypoints only
    #[arg(long, value_name = "N", default_value = "1", value_parser = count)]
    pub(crate) people: usize,
    /// Width and height of the images, pixels
    #[arg(long, value_name = "WxH", default_value = "320x240", value_parser = size)]
    pub(crate) size: [u32; 2],
    /// Errors of the silhouettes: clean, normal or hard
    #[arg(long, value_name = "LEVEL", default_value = "normal", hide_possible_values = true, value_parser = LEVELS)]
    pub(crate) segmentation: String,
    /// Write pictures of every N-th frame, or `none`
    #[arg(long, value_name = "N", default_value = "10", value_parser = every)]
    pub(crate) images: Every,
    #[command(flatten)]
    pub(crate) answer: Answer,
}

const LEVELS: [&str; 3] = ["clean", "normal", "hard"];

/// Every n-th frame, or none.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Every(pub(crate) Option<usize>);

fn every(text: &str) -> Result<Every, String> {
    match text {
        "none" => Ok(Every(None)),
        _ => match text.parse() {
            Ok(0) | Err(_) => Err("expected a whole number from 1 on, or `none`".into()),
            Ok(every) => Ok(Every(Some(every))),
        },
    }
}

/// Most cameras of a simulation.
const MOST_CAMERAS: usize = 99;

fn count(text: &str) -> Result<usize, String> {
    let count = text.parse().ok().filter(|count| (1..=MOST_CAMERAS).contains(count));
    count.ok_or_else(|| format!("expected a whole number from 1 to {MOST_CAMERAS}"))
}

/// Least and greatest width and height of simulated images, pixels.
const PIXELS: std::ops::RangeInclusive<u32> = 32..=4096;

fn size(text: &str) -> Result<[u32; 2], String> {
    let side = |text: &str| text.parse().ok().filter(|side| PIXELS.contains(side));
    let sides = text.split_once('x').and_then(|(width, height)| Some([side(width)?, side(height)?]));
    sides.ok_or_else(|| format!("expected WIDTHxHEIGHT, each from {} to {}", PIXELS.start(), PIXELS.end()))
}

#[derive(Args, Debug)]
pub(crate) struct TrackArgs {
    #[command(flatten)]
    pub(crate) settings: Typed<TrackSettings>,
    /// Resume the run that was stopped in the output folder
    #[arg(long, help_heading = "Output", conflicts_with = "force")]
    pub(crate) resume: bool,
    /// Track frames as they come, a line of JSON each, from standard input (-) or tcp:127.0.0.1:PORT
    #[arg(long, help_heading = "Input", value_name = "FROM", num_args = 0..=1, default_missing_value = "-", hide_short_help = true, conflicts_with_all = ["resume", "sync", "write_calibration", "report"])]
    pub(crate) live: Option<String>,
    /// Seconds of frames for the set-up of a live run that has none [default: 5]
    #[arg(long, help_heading = "Method", value_name = "S", hide_short_help = true, requires = "live")]
    pub(crate) setup_seconds: Option<f64>,
    /// Skip live frames that come faster than they are tracked, so that answers are of now; else they wait
    #[arg(long, help_heading = "Method", hide_short_help = true, requires = "live")]
    pub(crate) skip: bool,
    /// Find how late cameras are first, as `sinew sync` does, and read them in step
    #[arg(long, help_heading = "Input", hide_short_help = true)]
    pub(crate) sync: bool,
    /// Write the calibration as the set-up refined it, in the format of Calib.toml
    #[arg(long, value_name = "FILE", help_heading = "Output", hide_short_help = true)]
    pub(crate) write_calibration: Option<PathBuf>,
    /// Write report.html into the results: a page that shows them
    #[arg(long, help_heading = "Output", hide_short_help = true)]
    pub(crate) report: bool,
    /// Show every setting with its origin, and stop
    #[arg(long, help_heading = "General")]
    pub(crate) print_config: bool,
    #[command(flatten)]
    pub(crate) answer: Answer,
}
