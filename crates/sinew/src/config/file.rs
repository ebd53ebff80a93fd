//! `sinew.toml`: one file as a layer of settings, with all its mistakes.

use super::setting::Value;
use super::table::{find, settings};
use super::value::from_toml;
use crate::{Error, files};
use sinew_formats::nearest::nearest;
use sinew_formats::source_text::MAX_CONFIG_BYTES;
use sinew_input::{Error as InputError, Problems};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toml::de::DeTable;

/// Name of the file in the folder of a trial and in those above.
pub const FILE_NAME: &str = "sinew.toml";

/// A key that is no setting: the search for files ends here.
pub const ROOT: &str = "root";

/// Settings of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConfigFile {
    /// Where it was read.
    pub path: PathBuf,
    /// Settings.
    pub values: BTreeMap<&'static str, Value>,
    /// Whether files in the folders above are ignored.
    pub is_root: bool,
}

/// Reads a file.
///
/// # Errors
/// A file that cannot be read or written, and [`sinew_input::Error::Config`] with everything that is wrong in it.
pub fn read(path: &Path) -> Result<ConfigFile, Error> {
    let text = files::read_text(path, MAX_CONFIG_BYTES).map_err(|error| match error {
        InputError::Format(error) => {
            let (file, problem) = (path.display().to_string(), error.to_string());
            let problem = problem.strip_prefix(&format!("{file}: ")).unwrap_or(&problem).to_owned();
            Problems { file, problems: vec![problem] }.into()
        }
        other => other,
    })?;
    let folder = path.parent().unwrap_or_else(|| Path::new(""));
    let (values, is_root) =
        parse(&text, folder).map_err(|problems| Problems { file: path.display().to_string(), problems })?;
    Ok(ConfigFile { path: path.to_owned(), values, is_root })
}

/// The settings in a text; relative paths are seen from `folder`.
fn parse(text: &str, folder: &Path) -> Result<(BTreeMap<&'static str, Value>, bool), Vec<String>> {
    let line = |offset: usize| 1 + text.bytes().take(offset).filter(|&b| b == b'\n').count();
    let (table, errors) = DeTable::parse_recoverable(text);
    let mut problems: Vec<(usize, String)> = Vec::new();
    // What follows an error of syntax may be its consequence: only the first is reported, and too deep nesting before all that it leaves open.
    let is_syntax = |error: &&toml::de::Error| error.message() != "duplicate key";
    let too_deep = errors.iter().find(|error| error.message().contains("recurs"));
    if let Some(error) = too_deep.or_else(|| errors.iter().find(is_syntax)) {
        let at = line(error.span().map_or(0, |span| span.start));
        let message = if too_deep.is_some() { "nested too deep" } else { error.message() };
        return Err(vec![format!("line {at}: {message}")]);
    }
    for error in errors {
        let span = error.span().unwrap_or(0..0);
        let shown = text.get(span.clone()).unwrap_or_default().trim();
        problems.push((line(span.start), format!("the key `{shown}` is there twice")));
    }
    let mut values = BTreeMap::new();
    let mut is_root = false;
    for (key, value) in table.get_ref() {
        let at = line(key.span().start);
        let name = key.get_ref().as_ref();
        if name == ROOT {
            match value.get_ref().as_bool() {
                Some(flag) => is_root = flag,
                None => problems.push((at, "`root` must be true or false".into())),
            }
            continue;
        }
        let Some(setting) = find(name) else {
            let known = settings().iter().map(|setting| setting.key).chain([ROOT]);
            let meant = match value.get_ref().is_table() {
                true => "; settings stand at the top of the file, without tables".into(),
                false => nearest(name, known).map(|name| format!("; did you mean `{name}`?")).unwrap_or_default(),
            };
            problems.push((at, format!("unknown key `{name}`{meant}")));
            continue;
        };
        let shown = text.get(value.span()).unwrap_or_default().trim();
        match from_toml(setting, value.get_ref(), shown, folder) {
            Ok(value) => {
                values.insert(setting.key, value);
            }
            Err(problem) => problems.push((at, problem)),
        }
    }
    if problems.is_empty() {
        return Ok((values, is_root));
    }
    problems.sort();
    Err(problems.into_iter().map(|(line, problem)| format!("line {line}: {problem}")).collect())
}

/// Files in a folder and those above it, nearest first, up to the one that calls itself the root.
///
/// # Errors
/// As [`read`].
pub fn search(folder: &Path) -> Result<Vec<ConfigFile>, Error> {
    let mut found = Vec::new();
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let absolute = std::path::absolute(folder).map_err(Error::io("read", folder))?;
    for folder in absolute.ancestors() {
        let path = folder.join(FILE_NAME);
        if path.is_file() {
            let file = read(&path)?;
            let is_root = file.is_root;
            found.push(file);
            if is_root {
                break;
            }
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::value::to_toml;
    use crate::methods::METHODS;
    use sinew_input::lag::ClockLag;

    fn problems(text: &str) -> Vec<String> {
        parse(text, Path::new("")).unwrap_err()
    }

    #[test]
    fn all_mistakes_are_reported_at_once() {
        let text = "paticles = 10\nseed = -1\nmethod = \"hcm\"\njitter = 1.5\nframes = \"9..2\"\nthreads = 0\nsmooth = \"yes\"\nfps = nan\n";
        let names = METHODS.map(|about| about.name).join(", ");
        assert_eq!(
            problems(text),
            [
                "line 1: unknown key `paticles`; did you mean `particles`?",
                "line 2: `seed` is -1; it must be a whole number from 0 to 18446744073709551615",
                &format!("line 3: `method` is `hcm`; it must be one of {names}; did you mean `hmc`?"),
                "line 4: `jitter` is 1.5; it must be from 0 to 1",
                "line 5: `frames` is 9..2; the end must come after the start",
                "line 6: `threads` is 0; it must be a whole number from 1 to 1024",
                "line 7: `smooth` is \"yes\"; it must be true or false",
                "line 8: `fps` is nan; it must be from 0.01 to 100000",
            ]
        );
    }

    #[test]
    fn a_key_is_there_once() {
        assert_eq!(problems("seed = 1\nseed = 2\n"), ["line 2: the key `seed` is there twice"]);
    }

    #[test]
    fn broken_files_are_refused() {
        assert!(problems("seed = \n")[0].starts_with("line 1: "));
        assert!(problems("[track]\nseed = 1\n")[0].starts_with("line 1: unknown key `track`"));
    }

    #[test]
    fn values_read_back() {
        let text = "frames = \"3..7\"\nlag = [\"cam_01=1\", \"b=-2\"]\ncameras = [\"a\", \"b\"]\njitter = 0.1\nseed = 18446744073709551615\ncalibration = \"x/Calib.toml\"\nlayout = \"BODY_25\"\n";
        let (values, _) = parse(text, Path::new("/trial")).unwrap();
        assert_eq!(values["calibration"], Value::Path("/trial/x/Calib.toml".into()));
        assert_eq!(values["layout"], Value::Text("BODY_25".into()));
        assert_eq!(
            values["lag"],
            Value::Lags(vec![("cam_01".into(), ClockLag::whole(1)), ("b".into(), ClockLag::whole(-2))])
        );
        let again: String = values.iter().map(|(key, value)| format!("{key} = {}\n", to_toml(value))).collect();
        assert_eq!(parse(&again, Path::new("/other")).unwrap().0, values);
    }
}
