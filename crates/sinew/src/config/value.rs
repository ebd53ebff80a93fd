//! Values of settings as they are written: from text (flags, environment), from TOML, and back to TOML and JSON.

use super::common::PEOPLE;
use super::setting::{Setting, SettingKind, Value};
use sinew_formats::nearest::nearest;
use sinew_input::flag::flag_with;
use sinew_input::lag::{ClockLag, LagTextError, MOST_FRAMES, MOST_PPM};
use sinew_input::up_axis::direction;
use std::path::Path;
use toml::de::DeValue;

fn checked_number(setting: &Setting, value: f64, shown: &str) -> Result<Value, String> {
    let SettingKind::Number { least, excluded, most } = setting.kind else { return Ok(Value::Number(value)) };
    // NaN fails the comparison.
    let low = if excluded { value > least } else { value >= least };
    if low && value <= most && value.is_finite() {
        return Ok(Value::Number(value));
    }
    let wanted = match (excluded, most.is_finite()) {
        (true, false) => format!("greater than {least}"),
        (true, true) => format!("greater than {least} and at most {most}"),
        (false, false) => format!("at least {least}"),
        (false, true) => format!("from {least} to {most}"),
    };
    Err(format!("`{}` is {shown}; it must be {wanted}", setting.key))
}

fn checked_count(setting: &Setting, value: Option<u64>, shown: &str) -> Result<Value, String> {
    let SettingKind::Count(least, most) = setting.kind else { return Err(unexpected(setting, shown)) };
    match value {
        Some(value) if (least..=most).contains(&value) => Ok(Value::Count(value)),
        _ => Err(format!("`{}` is {shown}; it must be a whole number from {least} to {most}", setting.key)),
    }
}

fn checked_choice(setting: &Setting, known: &[&'static str], text: &str) -> Result<Value, String> {
    if known.contains(&text) {
        return Ok(Value::Text(text.into()));
    }
    if setting.key == PEOPLE.key && text.parse::<u64>().is_ok_and(|number| number > 1) {
        return Err(format!(
            "`people` is `{text}`; it must be one of {}; one of several is tracked with {}",
            known.join(", "),
            flag_with("person", text)
        ));
    }
    let meant =
        nearest(text, known.iter().copied()).map(|name| format!("; did you mean `{name}`?")).unwrap_or_default();
    Err(format!("`{}` is `{text}`; it must be one of {}{meant}", setting.key, known.join(", ")))
}

fn frames(setting: &Setting, text: &str) -> Result<Value, String> {
    let parts = text.split_once("..").and_then(|(a, b)| Some((a.trim().parse().ok()?, b.trim().parse().ok()?)));
    match parts {
        Some((first, end)) if first < end => Ok(Value::Frames(first..end)),
        Some(_) => Err(format!("`{}` is {text}; the end must come after the start", setting.key)),
        None => Err(format!("`{}` is `{text}`; it must be frame numbers A..B, for example 0..60", setting.key)),
    }
}

fn unexpected(setting: &Setting, shown: &str) -> String {
    let wanted = match setting.kind {
        SettingKind::Path => "a path in quotes",
        SettingKind::NameOrPath => "a name or a path in quotes",
        SettingKind::Choice(_) => "a name in quotes",
        SettingKind::Text => "a text in quotes",
        SettingKind::Count(..) => "a whole number",
        SettingKind::Number { .. } => "a number",
        SettingKind::Flag => "true or false",
        SettingKind::Frames => "frame numbers in quotes, for example \"0..60\"",
        SettingKind::Names => "a list of names, for example [\"cam1\", \"cam2\"]",
        SettingKind::Direction => "auto or a direction of three numbers in quotes, for example \"0,-1,0.2\"",
        SettingKind::Lags => "a list of cameras with frames, for example [\"cam1=1\", \"cam3=-2.4\"]",
    };
    format!("`{}` is {shown}; it must be {wanted}", setting.key)
}

/// A direction that is to be found.
pub const AUTO: &str = "auto";

fn lags<'a>(setting: &Setting, items: impl Iterator<Item = &'a str>, shown: &str) -> Result<Value, String> {
    let mut lags: Vec<(String, ClockLag)> = vec![];
    for item in items.map(str::trim).filter(|item| !item.is_empty()) {
        let parts = item.split_once('=').map(|(name, lag)| (name.trim(), lag.trim().parse::<ClockLag>()));
        match parts {
            Some((name, Err(LagTextError::Size))) if !name.is_empty() => {
                return Err(format!(
                    "`{}` holds `{item}`; a camera may be {MOST_FRAMES} frames late at most, and drift by {MOST_PPM} ppm",
                    setting.key
                ));
            }
            Some((name, Ok(lag))) if !name.is_empty() => {
                if lags.iter().any(|(known, _)| known == name) {
                    return Err(format!("`{}` names `{name}` twice", setting.key));
                }
                lags.push((name.to_owned(), lag));
            }
            _ => {
                return Err(format!(
                    "`{}` holds `{item}`; it must be a camera and the frames that it is late, for example cam_03=-2, cam_03=0.4, or with a drift cam_03=0.4+80ppm",
                    setting.key
                ));
            }
        }
    }
    if lags.is_empty() { Err(unexpected(setting, shown)) } else { Ok(Value::Lags(lags)) }
}

/// A path, or a name that is one if it ends in `.toml` or `.trc`, seen from a folder.
fn placed(kind: SettingKind, text: &str, folder: &Path) -> Value {
    let is_file = || Path::new(text).extension().is_some_and(|extension| extension == "toml" || extension == "trc");
    let is_path = kind == SettingKind::Path || is_file();
    if is_path { Value::Path(folder.join(text)) } else { Value::Text(text.into()) }
}

/// A value as typed on the command line or in the environment; paths are seen from `folder`.
///
/// # Errors
/// One sentence that names the setting, what was found and what was expected.
pub fn from_text(setting: &Setting, text: &str, folder: &Path) -> Result<Value, String> {
    let shown = format!("`{text}`");
    match setting.kind {
        SettingKind::Path | SettingKind::NameOrPath if text.is_empty() => Err(unexpected(setting, "empty")),
        SettingKind::Path | SettingKind::NameOrPath => Ok(placed(setting.kind, text, folder)),
        SettingKind::Choice(known) => checked_choice(setting, known, text),
        SettingKind::Text if text.trim().is_empty() => Err(unexpected(setting, "empty")),
        SettingKind::Text => Ok(Value::Text(text.trim().into())),
        SettingKind::Count(..) => match text.parse::<u64>() {
            Ok(value) => checked_count(setting, Some(value), text),
            Err(_) => checked_count(setting, None, &shown),
        },
        SettingKind::Number { .. } => match text.parse() {
            Ok(value) => checked_number(setting, value, text),
            Err(_) => Err(unexpected(setting, &shown)),
        },
        SettingKind::Flag => match text {
            "true" | "1" | "yes" => Ok(Value::Flag(true)),
            "false" | "0" | "no" => Ok(Value::Flag(false)),
            _ => Err(unexpected(setting, &shown)),
        },
        SettingKind::Frames => frames(setting, text),
        SettingKind::Direction if text == AUTO || direction(text).is_some() => Ok(Value::Text(text.into())),
        SettingKind::Direction => Err(unexpected(setting, &shown)),
        SettingKind::Lags => lags(setting, text.split(','), text),
        SettingKind::Names => {
            let names: Vec<String> =
                text.split(',').map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect();
            if names.is_empty() { Err(unexpected(setting, &shown)) } else { Ok(Value::Names(names)) }
        }
    }
}

/// A value in a TOML file of the given folder.
///
/// # Errors
/// As [`from_text`].
pub fn from_toml(setting: &Setting, value: &DeValue<'_>, shown: &str, folder: &Path) -> Result<Value, String> {
    let bad = || Err(unexpected(setting, shown));
    match (setting.kind, value) {
        (SettingKind::Count(..), DeValue::Integer(found)) => {
            checked_count(setting, u64::from_str_radix(found.as_str(), found.radix()).ok(), shown)
        }
        (SettingKind::Count(..), DeValue::Float(_)) => checked_count(setting, None, shown),
        (SettingKind::Number { .. }, DeValue::Float(found)) => match found.as_str().parse() {
            Ok(number) => checked_number(setting, number, shown),
            Err(_) => bad(),
        },
        (SettingKind::Number { .. }, DeValue::Integer(found)) => match found.as_str().parse() {
            Ok(number) => checked_number(setting, number, shown),
            Err(_) => bad(),
        },
        (SettingKind::Flag, DeValue::Boolean(flag)) => Ok(Value::Flag(*flag)),
        (SettingKind::Names, DeValue::Array(items)) => {
            let names: Option<Vec<String>> =
                items.iter().map(|item| Some(item.get_ref().as_str()?.to_owned())).collect();
            names.filter(|names| !names.is_empty()).map_or_else(bad, |names| Ok(Value::Names(names)))
        }
        (SettingKind::Lags, DeValue::Array(items)) => {
            let items: Option<Vec<&str>> = items.iter().map(|item| item.get_ref().as_str()).collect();
            items.map_or_else(bad, |items| lags(setting, items.into_iter(), shown))
        }
        (
            SettingKind::Path
            | SettingKind::NameOrPath
            | SettingKind::Choice(_)
            | SettingKind::Text
            | SettingKind::Frames
            | SettingKind::Direction
            | SettingKind::Lags,
            DeValue::String(text),
        ) => from_text(setting, text, folder),
        _ => bad(),
    }
}

/// The value as it would be typed.
#[must_use]
pub fn to_text(value: &Value) -> String {
    match value {
        Value::Path(path) => path.to_string_lossy().into_owned(),
        Value::Text(text) => text.clone(),
        Value::Count(count) => count.to_string(),
        Value::Number(number) => number.to_string(),
        Value::Flag(flag) => flag.to_string(),
        Value::Frames(frames) => format!("{}..{}", frames.start, frames.end),
        Value::Names(names) => names.join(","),
        Value::Lags(lags) => lag_texts(lags).join(","),
    }
}

/// The value as TOML, which [`from_toml`] reads back equal.
#[must_use]
pub fn to_toml(value: &Value) -> String {
    let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
    let list = |texts: &[String]| format!("[{}]", texts.iter().map(|text| quoted(text)).collect::<Vec<_>>().join(", "));
    match value {
        Value::Path(_) | Value::Text(_) | Value::Frames(_) => quoted(&to_text(value)),
        Value::Count(_) | Value::Flag(_) => to_text(value),
        Value::Number(number) => format!("{number:?}"),
        Value::Names(names) => list(names),
        Value::Lags(lags) => list(&lag_texts(lags)),
    }
}

fn lag_texts(lags: &[(String, ClockLag)]) -> Vec<String> {
    lags.iter().map(|(name, lag)| format!("{name}={lag}")).collect()
}

/// The value as JSON.
#[must_use]
pub fn to_json(value: &Value) -> serde_json::Value {
    match value {
        Value::Path(_) | Value::Text(_) | Value::Frames(_) => to_text(value).into(),
        Value::Count(count) => (*count).into(),
        Value::Number(number) => (*number).into(),
        Value::Flag(flag) => (*flag).into(),
        Value::Names(names) => names.clone().into(),
        Value::Lags(lags) => lag_texts(lags).into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::table::settings;

    fn refused(key: &str, text: &str) -> String {
        let setting = settings().iter().find(|setting| setting.key == key).unwrap();
        from_text(setting, text, Path::new("")).unwrap_err()
    }

    #[test]
    fn a_lag_beyond_its_limits_names_them() {
        for lag in ["cam=1e9", "cam=1+900000ppm"] {
            let words = refused("lag", lag);
            assert!(words.contains("100000 frames late at most, and drift by 5000 ppm"), "{words}");
        }
        assert!(refused("lag", "cam=late").contains("for example cam_03=-2"));
    }

    #[test]
    fn a_number_of_people_points_to_the_choice_of_one() {
        assert!(refused("people", "3").ends_with("one of several is tracked with `--person 3`"));
        assert!(!refused("people", "0").contains("--person"));
    }
}
