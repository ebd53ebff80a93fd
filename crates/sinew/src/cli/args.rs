//! Arguments of every command. The settings of `track` come from the one table of settings.

use clap::{Arg, ArgAction, ArgMatches, Args, FromArgMatches, Parser, Subcommand, ValueEnum};
use sinew::config::setting::{Kind, SETTINGS, Setting};
use std::path::PathBuf;

macro_rules! template {
    ($($example:literal),+) => {
        concat!("{about}\n\n{usage-heading} {usage}\n\nExamples:\n", $("  ", $example, "\n"),+, "\n{all-args}{after-help}")
    };
}

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

/// Flags that every command takes.
#[derive(Args, Debug)]
#[command(next_help_heading = "General")]
pub(crate) struct General {
    /// Output folder or file [default: sinew-out/<trial>]
    #[arg(short, long, global = true, value_name = "DIR", help_heading = "Output")]
    pub(crate) out: Option<String>,
    /// Replace results that are there
    #[arg(long, global = true, help_heading = "Output")]
    pub(crate) force: bool,
    /// Give the answer as JSON
    #[arg(long, global = true, help_heading = "Output")]
    pub(crate) json: bool,
    /// Settings from this file instead of the trial's sinew.toml
    #[arg(long, global = true, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// Seed of all random streams [default: 1]
    #[arg(long, global = true, value_name = "N", allow_negative_numbers = true)]
    pub(crate) seed: Option<String>,
    /// Threads [default: what the system grants]
    #[arg(long, global = true, value_name = "N", allow_negative_numbers = true)]
    pub(crate) threads: Option<String>,
    /// Show errors only
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
    /// Show more; twice for still more
    #[arg(short, long, global = true, action = ArgAction::Count, hide_short_help = true)]
    pub(crate) verbose: u8,
    /// Colours on stderr; NO_COLOR is obeyed
    #[arg(long, global = true, value_enum, default_value_t, value_name = "WHEN", hide_short_help = true)]
    pub(crate) color: Color,
    /// Show no progress
    #[arg(long, global = true, hide_short_help = true)]
    pub(crate) no_progress: bool,
}

impl General {
    /// Flags that are settings.
    pub(crate) fn settings(&self) -> Vec<(&'static str, String)> {
        let given = [("out", &self.out), ("seed", &self.seed), ("threads", &self.threads)];
        let mut settings: Vec<_> = given.into_iter().filter_map(|(key, value)| Some((key, value.clone()?))).collect();
        if self.force {
            settings.push(("force", "true".into()));
        }
        settings
    }
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Track a synthetic walker: no data needed, a few seconds
    #[command(help_template = template!("sinew demo", "sinew demo -o /tmp/walk --seed 7"))]
    Demo,
    /// Say what files contain, what is odd, and whether calibration and keypoints fit
    #[command(help_template = template!("sinew inspect Calib.toml pose", "sinew inspect markers.trc sinew-out/trial"))]
    Inspect(InspectArgs),
    /// Track the person in a recording
    #[command(help_template = template!(
        "sinew track --calibration Calib.toml --keypoints pose --fps 60",
        "sinew track --config sinew.toml --frames 0..100 -o out"
    ))]
    Track(TrackArgs),
    /// Convert motion between TRC, BVH, MOT and CSV, and from ASF/AMC
    #[command(help_template = template!("sinew convert markers.trc markers.csv", "sinew convert 07_01.amc walk.bvh --skeleton 07.asf"))]
    Convert(ConvertArgs),
    /// Show a body as a tree
    #[command(help_template = template!("sinew body h32", "sinew body my_body.toml"))]
    Body {
        /// h32, cf28 or a body file
        #[arg(value_name = "NAME|FILE")]
        body: String,
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
    /// Calibrations, keypoint folders, motion files, result folders
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    /// Keypoint layout or mapping file [default: guessed]
    #[arg(long, value_name = "NAME")]
    pub(crate) layout: Option<String>,
    /// Take only the frames that all cameras have
    #[arg(long)]
    pub(crate) trim: bool,
}

#[derive(Args, Debug)]
pub(crate) struct ConvertArgs {
    /// Motion file: .trc, .bvh, .mot, .csv or .amc
    #[arg(value_name = "IN")]
    pub(crate) input: PathBuf,
    /// File to write: .trc, .bvh, .mot or .csv
    #[arg(value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Skeleton of an .amc file
    #[arg(long, value_name = "F.asf")]
    pub(crate) skeleton: Option<PathBuf>,
    /// Frames per second where the input has none [default: 120 for .amc]
    #[arg(long, value_name = "F")]
    pub(crate) fps: Option<f64>,
}

/// Settings of a run, as typed.
#[derive(Debug)]
pub(crate) struct TrackArgs {
    pub(crate) settings: Vec<(&'static str, String)>,
    pub(crate) print_config: bool,
}

const PRINT_CONFIG: &str = "print_config";

/// Settings that have a flag of their own in [`General`].
fn is_general(setting: &Setting) -> bool {
    matches!(setting.key, "out" | "force" | "seed" | "threads")
}

fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

fn argument(setting: &'static Setting) -> Arg {
    let argument = Arg::new(setting.key)
        .long(setting.key.replace('_', "-"))
        .help_heading(setting.group)
        .hide_short_help(setting.rare);
    if setting.kind == Kind::Flag {
        return argument.action(ArgAction::SetTrue).help(sentence(setting.help));
    }
    let default = if setting.default.is_empty() { String::new() } else { format!(" [default: {}]", setting.default) };
    argument
        .value_name(setting.value)
        .help(format!("{}{default}", sentence(setting.help)))
        .allow_negative_numbers(true)
        .allow_hyphen_values(setting.key == "up_axis")
}

impl Args for TrackArgs {
    fn augment_args(command: clap::Command) -> clap::Command {
        let arguments = SETTINGS.iter().filter(|setting| !is_general(setting)).map(argument);
        let print = Arg::new(PRINT_CONFIG).long("print-config").action(ArgAction::SetTrue).help_heading("General");
        command.args(arguments).arg(print.help("Show every setting with its origin, and stop"))
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for TrackArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut settings = Vec::new();
        for setting in SETTINGS.iter().filter(|setting| !is_general(setting)) {
            if setting.kind == Kind::Flag {
                if matches.get_flag(setting.key) {
                    settings.push((setting.key, "true".to_owned()));
                }
            } else if let Some(text) = matches.get_one::<String>(setting.key) {
                settings.push((setting.key, text.clone()));
            }
        }
        Ok(Self { settings, print_config: matches.get_flag(PRINT_CONFIG) })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}
