//! How a text names a setting: by the flag that sets it.
//!
//! Warnings, and what result files and pages advise, are texts in the notation of the command line. This is the one place of the libraries that knows it; the words of Python turn it into keyword arguments.

use std::fmt::Display;

/// The flag of a setting, as it is typed.
#[must_use]
pub fn typed(setting: &str) -> String {
    format!("--{}", setting.replace('_', "-"))
}

/// The flag of a setting, as a text quotes it.
#[must_use]
pub fn flag(setting: &str) -> String {
    format!("`{}`", typed(setting))
}

/// The flag of a setting with a value, as a text quotes it.
#[must_use]
pub fn flag_with(setting: &str, value: impl Display) -> String {
    format!("`{} {value}`", typed(setting))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_have_dashes_for_underscores() {
        assert_eq!(flag("setup_frames"), "`--setup-frames`");
        assert_eq!(flag_with("lag", "cam_03=-2"), "`--lag cam_03=-2`");
    }
}
