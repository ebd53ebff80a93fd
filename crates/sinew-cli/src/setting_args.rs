//! Flags that are settings, made from the one table of settings, with values for completion.

use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches, ValueHint};
use sinew::bodies;
use sinew::config::common::{
    BODY, CALIBRATION, CAMERAS, CONFIDENCE_SCALE, FORCE, FPS, FRAMES, IMAGE_SCALE, KEYPOINTS, LAG, LAYOUT, OUT, SEED,
    THREADS, TRIM, UP, UP_AXIS,
};
use sinew::config::resolved::Given;
use sinew::config::setting::{Setting, SettingKind};
use sinew::config::table::settings;
use sinew::config::value::to_text;
use sinew::formats::layout;
use std::ffi::OsStr;
use std::marker::PhantomData;

/// Which settings a command takes as flags.
pub(crate) trait Takes {
    fn takes(setting: &Setting) -> bool;
}

#[derive(Debug)]
pub(crate) struct TrackSettings;

impl Takes for TrackSettings {
    /// All but those that every command has.
    fn takes(setting: &Setting) -> bool {
        ![OUT.key, FORCE.key, SEED.key, THREADS.key].contains(&setting.key)
    }
}

/// What it takes to read a recording.
#[derive(Debug)]
pub(crate) struct InspectSettings;

impl Takes for InspectSettings {
    fn takes(setting: &Setting) -> bool {
        let which = [LAYOUT.key, FRAMES.key, FPS.key, CAMERAS.key, TRIM.key, LAG.key];
        which.contains(&setting.key) || [CONFIDENCE_SCALE.key, IMAGE_SCALE.key].contains(&setting.key)
    }
}

/// What it takes to read a recording that is named by its settings.
#[derive(Debug)]
pub(crate) struct SyncSettings;

impl Takes for SyncSettings {
    fn takes(setting: &Setting) -> bool {
        InspectSettings::takes(setting) || [CALIBRATION.key, KEYPOINTS.key].contains(&setting.key)
    }
}

/// Settings of a command, as typed.
#[derive(Debug)]
pub(crate) struct Typed<C> {
    pub(crate) given: Given,
    command: PhantomData<C>,
}

/// Takes any text, since the settings check it together with what other sources say, and offers known values to completion.
#[derive(Clone)]
struct Offered(Vec<&'static str>);

impl TypedValueParser for Offered {
    type Value = String;

    fn parse_ref(&self, command: &Command, argument: Option<&Arg>, value: &OsStr) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        if self.0.is_empty() { None } else { Some(Box::new(self.0.iter().map(PossibleValue::new))) }
    }
}

/// Values that completion offers.
fn offered(setting: &Setting) -> Vec<&'static str> {
    match setting.kind {
        SettingKind::Choice(names) => names.to_vec(),
        _ if setting.key == LAYOUT.key => layout::names(),
        _ if setting.key == BODY.key => bodies::NAMES.to_vec(),
        _ => vec![],
    }
}

/// What a shell completes where no values are known.
fn hint(setting: &Setting) -> ValueHint {
    match (setting.kind, setting.value) {
        (SettingKind::Path, "DIR") => ValueHint::DirPath,
        (SettingKind::Path | SettingKind::NameOrPath, _) => ValueHint::FilePath,
        _ => ValueHint::Other,
    }
}

/// The text with a capital, unless it begins with a value, which is shown as it is typed.
fn sentence(text: &str, values: &[&str]) -> String {
    let first_word = text.split([' ', ',', ':']).next().unwrap_or_default();
    let mut letters = text.chars();
    match letters.next() {
        Some(first) if !values.contains(&first_word) => first.to_uppercase().chain(letters).collect(),
        _ => text.to_owned(),
    }
}

/// Characters of a row of the short help beside its flags.
const HELP_WIDTH: usize = 70;

/// The text in rows of at most `width` characters, where its words allow it.
fn in_rows(text: &str, width: usize) -> String {
    let (mut rows, mut used) = (String::new(), 0);
    for word in text.split(' ') {
        let length = word.chars().count();
        if used > 0 && used + 1 + length > width {
            rows.push('\n');
            used = 0;
        } else if used > 0 {
            rows.push(' ');
            used += 1;
        }
        rows.push_str(word);
        used += length;
    }
    rows
}

fn argument(setting: &'static Setting) -> Arg {
    let values = offered(setting);
    let help = sentence(setting.help, &values);
    let argument = Arg::new(setting.key)
        .long(setting.key.replace('_', "-"))
        .help_heading(setting.group)
        .hide_short_help(setting.rare);
    if setting.kind == SettingKind::Flag {
        return argument.action(ArgAction::SetTrue).help(help);
    }
    let default =
        setting.default.as_ref().map(|default| format!(" [default: {}]", to_text(default))).unwrap_or_default();
    let is_named = values.iter().all(|value| setting.help.contains(value));
    let named = if is_named { String::new() } else { format!("; known: {}", values.join(", ")) };
    argument
        .value_name(setting.value)
        .long_help(format!("{help}{named}{default}"))
        .help(in_rows(&format!("{help}{default}"), HELP_WIDTH))
        .allow_negative_numbers(true)
        .allow_hyphen_values([UP_AXIS.key, UP.key].contains(&setting.key))
        .hide_possible_values(true)
        .value_hint(hint(setting))
        .value_parser(Offered(values))
}

impl<C: Takes> Args for Typed<C> {
    fn augment_args(command: Command) -> Command {
        command.args(settings().iter().filter(|setting| C::takes(setting)).map(argument))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl<C: Takes> FromArgMatches for Typed<C> {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut given = Vec::new();
        for setting in settings().iter().filter(|setting| C::takes(setting)) {
            if setting.kind == SettingKind::Flag {
                if matches.get_flag(setting.key) {
                    given.push((setting.key, "true".to_owned()));
                }
            } else if let Some(text) = matches.get_one::<String>(setting.key) {
                given.push((setting.key, text.clone()));
            }
        }
        Ok(Self { given, command: PhantomData })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}
