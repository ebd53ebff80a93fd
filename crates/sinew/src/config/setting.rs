//! What a setting is: name, type, range, default and meaning, in one constant; and the values that sources give.

use sinew_input::footage::Init;
use sinew_input::lag::ClockLag;
use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::path::PathBuf;

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

/// A setting; of values of one type as [`Typed`].
#[derive(Clone, Copy, Debug)]
pub struct Setting<D = Option<Value>> {
    /// Heading under which the help shows it.
    pub group: &'static str,
    /// Name.
    pub key: &'static str,
    /// Values.
    pub kind: SettingKind,
    /// Word for the value in the help.
    pub value: &'static str,
    /// Value where nobody gives one.
    pub default: D,
    /// Meaning, with the unit and what happens without it.
    pub help: &'static str,
    /// Whether it changes numbers: threads and paths do not.
    pub hashed: bool,
    /// Whether only the long help shows it.
    pub rare: bool,
}

/// A setting whose values are read as `T`.
pub type Typed<T> = Setting<fn() -> T>;

impl<T> Typed<T> {
    /// The same, shown by the long help only.
    #[must_use]
    pub const fn rare(self) -> Self {
        Self { rare: true, ..self }
    }

    /// The same, of a setting that changes no numbers.
    #[must_use]
    pub const fn unhashed(self) -> Self {
        Self { hashed: false, ..self }
    }
}

/// A setting of any type.
pub trait AnySetting: fmt::Debug + Sync {
    /// As a row of the table of settings.
    fn row(&self) -> Setting;
}

impl<T: SettingType> AnySetting for Typed<T> {
    fn row(&self) -> Setting {
        let Self { group, key, kind, value, default, help, hashed, rare } = *self;
        Setting { group, key, kind, value, default: default().value(), help, hashed, rare }
    }
}

/// A setting as a row: heading, name, values, word for the value, default, meaning.
pub type Row<T> = (&'static str, &'static str, SettingKind, &'static str, fn() -> T, &'static str);

/// A setting that the short help shows, too, and that changes numbers unless it is a path; its kind is to be that of its type.
#[must_use]
pub const fn setting<T: SettingType>((group, key, kind, value, default, help): Row<T>) -> Typed<T> {
    Setting { group, key, kind, value, default, help, hashed: !matches!(kind, SettingKind::Path), rare: false }
}

/// A setting of a single method, which the long help shows alone: name, values, word for the value, default, meaning.
#[must_use]
pub const fn method_setting<T: SettingType>(
    (key, kind, value, default, help): (&'static str, SettingKind, &'static str, fn() -> T, &'static str),
) -> Typed<T> {
    setting((SAMPLING, key, kind, value, default, help)).rare()
}

/// A setting with a few named values, the first by default: heading, name, word for the value, meaning.
#[must_use]
pub const fn choice<T: NamedValues>(
    (group, key, value, help): (&'static str, &'static str, &'static str, &'static str),
) -> Typed<T> {
    setting((group, key, SettingKind::Choice(T::NAMES), value, || T::ALL[0], help))
}

/// A type with a few values, each with a name.
pub trait NamedValues: Copy + PartialEq + 'static {
    /// Their names.
    const NAMES: &'static [&'static str];
    /// The values, in the order of their names; one or more.
    const ALL: &'static [Self];
}

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A file or folder.
    Path(PathBuf),
    /// A name.
    Text(String),
    /// A whole number.
    Count(u64),
    /// A number.
    Number(f64),
    /// Yes or no.
    Flag(bool),
    /// Frame numbers.
    Frames(Range<u64>),
    /// Names.
    Names(Vec<String>),
    /// Names of cameras, each with frames that it is late.
    Lags(Vec<(String, ClockLag)>),
}

/// A type that settings have.
pub trait SettingType: Sized {
    /// What a source gave; `None` for a value of another kind.
    fn read(value: &Value) -> Option<Self>;
    /// As a source would give it; `None` where nothing is set.
    fn value(self) -> Option<Value>;
}

/// Types that values hold as they are.
macro_rules! held_as {
    ($($held:ty: $form:ident),*) => {
        $(impl SettingType for $held {
            fn read(value: &Value) -> Option<Self> {
                if let Value::$form(held) = value { Some(held.to_owned()) } else { None }
            }
            fn value(self) -> Option<Value> {
                Some(Value::$form(self))
            }
        })*
    };
}

held_as!(
    PathBuf: Path, u64: Count, f64: Number, bool: Flag, Range<u64>: Frames, Vec<String>: Names,
    Vec<(String, ClockLag)>: Lags
);

impl SettingType for String {
    fn read(value: &Value) -> Option<Self> {
        match value {
            Value::Text(text) => Some(text.clone()),
            Value::Path(path) => Some(path.to_string_lossy().into_owned()),
            _ => None,
        }
    }
    fn value(self) -> Option<Value> {
        Some(Value::Text(self))
    }
}

impl SettingType for usize {
    fn read(value: &Value) -> Option<Self> {
        u64::read(value).map(|count| Self::try_from(count).unwrap_or(Self::MAX))
    }
    fn value(self) -> Option<Value> {
        (self as u64).value()
    }
}

impl SettingType for Init {
    fn read(value: &Value) -> Option<Self> {
        match value {
            Value::Path(path) => Some(Self::Points(path.clone())),
            _ => String::read(value).map(|_| Self::Keypoints),
        }
    }
    fn value(self) -> Option<Value> {
        match self {
            Self::Points(path) => path.value(),
            Self::Keypoints => "keypoints".to_owned().value(),
        }
    }
}

impl<T: NamedValues> SettingType for T {
    fn read(value: &Value) -> Option<Self> {
        let name = String::read(value)?;
        T::NAMES.iter().zip(T::ALL).find(|(known, _)| **known == name).map(|(_, value)| *value)
    }
    fn value(self) -> Option<Value> {
        T::NAMES.iter().zip(T::ALL).find(|(_, known)| **known == self)?.0.to_string().value()
    }
}

impl<T: SettingType> SettingType for Option<T> {
    fn read(value: &Value) -> Option<Self> {
        T::read(value).map(Some)
    }
    fn value(self) -> Option<Value> {
        self.and_then(T::value)
    }
}

/// Where a value comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Command line.
    Flag,
    /// Environment variable.
    Environment,
    /// A file.
    File(PathBuf),
    /// Nobody gave one.
    Default,
}

impl Origin {
    /// In words.
    #[must_use]
    pub fn describe(&self) -> String {
        match self {
            Self::Flag => "flag".into(),
            Self::Environment => "environment".into(),
            Self::File(path) => path.display().to_string(),
            Self::Default => "default".into(),
        }
    }
}

/// What sources gave, by the names of settings, each with its origin. A value is put in by the row of its setting, so that it is of the setting's type.
#[derive(Clone, Debug, Default)]
pub struct SettingValues {
    pub(super) by_key: BTreeMap<&'static str, (Value, Origin)>,
}

impl SettingValues {
    /// Value of a setting; its default where no source gave one.
    #[must_use]
    pub fn of<T: SettingType>(&self, setting: &Typed<T>) -> T {
        let given = self.by_key.get(setting.key).and_then(|(value, _)| T::read(value));
        given.unwrap_or_else(setting.default)
    }

    /// Gives a setting another value; none where the value is that of nothing set.
    pub fn set<T: SettingType>(&mut self, setting: &Typed<T>, value: T, origin: Origin) {
        match value.value() {
            Some(value) => drop(self.by_key.insert(setting.key, (value, origin))),
            None => drop(self.by_key.remove(setting.key)),
        }
    }
}

/// Heading of the settings that say how much is computed.
pub const SAMPLING: &str = "Sampling";

/// A share of one.
pub const SHARE: SettingKind = SettingKind::Number { least: 0.0, excluded: false, most: 1.0 };
