//! Settings that have a value, by name, and where each comes from.

use super::value::Value;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;

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

/// Values by the name of their setting.
#[derive(Clone, Debug, Default)]
pub struct SettingValues {
    /// Value and origin.
    pub of: BTreeMap<&'static str, (Value, Origin)>,
}

impl SettingValues {
    /// Value of a setting.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Value> {
        self.of.get(key).map(|(value, _)| value)
    }

    /// A path, where one is set.
    #[must_use]
    pub fn path(&self, key: &str) -> Option<PathBuf> {
        match self.get(key) {
            Some(Value::Path(path)) => Some(path.clone()),
            _ => None,
        }
    }

    /// A name, or a path as text, where one is set.
    #[must_use]
    pub fn text(&self, key: &str) -> Option<String> {
        match self.get(key) {
            Some(Value::Text(text)) => Some(text.clone()),
            Some(Value::Path(path)) => Some(path.to_string_lossy().into_owned()),
            _ => None,
        }
    }

    /// A whole number, where one is set.
    #[must_use]
    pub fn count(&self, key: &str) -> Option<u64> {
        match self.get(key) {
            Some(Value::Count(count)) => Some(*count),
            _ => None,
        }
    }

    /// A whole number as a size; 0 where none is set.
    #[must_use]
    pub fn size(&self, key: &str) -> usize {
        usize::try_from(self.count(key).unwrap_or_default()).unwrap_or(usize::MAX)
    }

    /// A number, where one is set.
    #[must_use]
    pub fn number(&self, key: &str) -> Option<f64> {
        match self.get(key) {
            Some(Value::Number(number)) => Some(*number),
            _ => None,
        }
    }

    /// Whether a flag is set.
    #[must_use]
    pub fn flag(&self, key: &str) -> bool {
        self.get(key) == Some(&Value::Flag(true))
    }

    /// Frame numbers, where they are set.
    #[must_use]
    pub fn frames(&self, key: &str) -> Option<Range<u64>> {
        match self.get(key) {
            Some(Value::Frames(frames)) => Some(frames.clone()),
            _ => None,
        }
    }

    /// A whole number, or another where none is set.
    #[must_use]
    pub fn size_or(&self, key: &str, otherwise: usize) -> usize {
        self.count(key).map_or(otherwise, |_| self.size(key))
    }

    /// Whether somebody gave the value.
    #[must_use]
    pub fn is_given(&self, key: &str) -> bool {
        self.of.get(key).is_some_and(|(_, origin)| *origin != Origin::Default)
    }
}
