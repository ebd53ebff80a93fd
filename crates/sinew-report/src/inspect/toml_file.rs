//! Which of our TOML files a text is, by its keys.
//!
//! | keys | file |
//! |---|---|
//! | `schema` and `body` | set-up of a run, `setup.toml` |
//! | `[cameras.N]`, or `[cam_N]` with a `port` | calibration of Caliscope |
//! | `[[link]]` | body |
//! | `points = […]` | mapping of keypoints |
//! | a setting outside tables, `root` | configuration, `sinew.toml` |
//! | others, and what is no TOML | calibration |

use super::subject::Subject;
use sinew::config::{file, table};
use sinew_formats::calibration::{self, CalibrationFormat};
use std::path::PathBuf;
use toml::de::{DeTable, DeValue};

/// What a TOML file is.
pub(super) fn subject(path: PathBuf, text: &str) -> Subject {
    // The calibration's reader says what is wrong with a text that is no TOML.
    let Ok(table) = DeTable::parse(text.trim_start_matches('\u{feff}')) else { return Subject::Calibration(path) };
    if calibration::recognised("", text) == Ok(CalibrationFormat::Caliscope) {
        return Subject::Calibration(path);
    }
    let table = table.get_ref();
    let value = |key: &str| table.iter().find(|(name, _)| name.get_ref() == key).map(|(_, value)| value.get_ref());
    let is_array = |key: &str| matches!(value(key), Some(DeValue::Array(_)));
    let is_setting = |name: &str| table::find(name).is_some() || name == file::ROOT;
    if value("schema").is_some() && value("body").is_some() {
        Subject::Setup(path)
    } else if is_array("link") {
        Subject::Body(path)
    } else if is_array("points") {
        Subject::Layout(path)
    } else if table.iter().any(|(name, value)| is_setting(name.get_ref()) && !value.get_ref().is_table()) {
        Subject::Configuration(path)
    } else {
        Subject::Calibration(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_known_by_their_keys() {
        let check = |text: &str, expected: fn(PathBuf) -> Subject| {
            assert_eq!(subject("a.toml".into(), text), expected("a.toml".into()), "{text}");
        };
        check("schema = 2\nbody = \"H32\"\n", Subject::Setup);
        check("[[link]]\nname = \"arm\"\n", Subject::Body);
        check("points = [\"Nose\"]\n", Subject::Layout);
        check("\u{feff}fps = 60\nparticels = 3\n", Subject::Configuration);
        check("root = true\n", Subject::Configuration);
        check("fps = 6\n[cam_1]\nport = 1\n", Subject::Calibration);
        check("[body]\nname = \"a camera of that name\"\n", Subject::Calibration);
        check("fps = = 60\n", Subject::Calibration);
        check("", Subject::Calibration);
    }
}
