//! What a setting is: name, kind, range, default and meaning.

use std::borrow::Cow;

/// What a setting's value may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SettingKind {
    /// A file or folder; relative ones are taken from the folder of the file that says so.
    Path,
    /// A known name, or a path if it ends in `.toml` or `.trc`.
    NameOrPath,
    /// One of these names.
    Choice(&'static [&'static str]),
    /// A whole number between these, both included.
    Count(u64, u64),
    /// A number between these, the first excluded if the flag says so.
    Number {
        /// Least value.
        least: f64,
        /// Whether the least value itself is out.
        excluded: bool,
        /// Greatest value.
        most: f64,
    },
    /// Yes or no.
    Flag,
    /// Frame numbers `A..B`, A included, B not.
    Frames,
    /// A short text.
    Text,
    /// A list of names.
    Names,
    /// `auto`, or a direction of three numbers `X,Y,Z`.
    Direction,
    /// Whole frames of cameras, `cam_01=1,cam_03=-2`.
    Lags,
}

/// Value where nobody gives one, as it would be typed.
#[derive(Clone, Copy, Debug)]
pub enum DefaultValue {
    /// None.
    Unset,
    /// A constant.
    Text(&'static str),
    /// That of the type which the setting becomes a part of.
    Computed(fn() -> String),
}

impl DefaultValue {
    /// The value, if there is one.
    #[must_use]
    pub fn text(&self) -> Option<Cow<'static, str>> {
        match self {
            Self::Unset => None,
            Self::Text(text) => Some(Cow::Borrowed(text)),
            Self::Computed(text) => Some(Cow::Owned(text())),
        }
    }
}

/// A setting.
#[derive(Clone, Copy, Debug)]
pub struct Setting {
    /// Heading under which the help shows it.
    pub group: &'static str,
    /// Name.
    pub key: &'static str,
    /// Values.
    pub kind: SettingKind,
    /// Word for the value in the help.
    pub value: &'static str,
    /// Value where nobody gives one.
    pub default: DefaultValue,
    /// Meaning, with the unit and what happens without it.
    pub help: &'static str,
    /// Whether it changes numbers: threads and paths do not.
    pub hashed: bool,
    /// Whether only the long help shows it.
    pub rare: bool,
}

impl Setting {
    /// As a row of a table: heading, name, values, word for the value, default as typed (empty for none), meaning.
    #[must_use]
    pub const fn new((group, key, kind, value, default, help): Row) -> Self {
        let hashed = !matches!(kind, SettingKind::Path);
        let default = if default.is_empty() { DefaultValue::Unset } else { DefaultValue::Text(default) };
        Self { group, key, kind, value, default, help, hashed, rare: false }
    }
}

/// A setting with a constant default.
pub type Row = (&'static str, &'static str, SettingKind, &'static str, &'static str, &'static str);

/// A setting whose default is computed.
pub type ComputedRow = (&'static str, &'static str, SettingKind, &'static str, fn() -> String, &'static str);

/// A setting that only the long help shows, whose default is that of the type it becomes a part of.
#[must_use]
pub const fn computed((group, key, kind, value, default, help): ComputedRow) -> Setting {
    let default = DefaultValue::Computed(default);
    Setting { group, key, kind, value, default, help, hashed: true, rare: true }
}

/// Heading of the settings that say how much is computed.
pub const SAMPLING: &str = "Sampling";

/// A share of one.
pub const SHARE: SettingKind = SettingKind::Number { least: 0.0, excluded: false, most: 1.0 };
