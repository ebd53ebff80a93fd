//! Advice about a path that is not there: the nearest folder that is, and the likely name.

use sinew_formats::nearest::nearest;
use std::ffi::OsStr;
use std::fs;
use std::path::Path;

/// Names of a folder that are listed.
const LISTED: usize = 8;

/// Advice about a path that is not there; `None` where it is there, or nothing above it can be read.
#[must_use]
pub fn advice(path: &Path) -> Option<String> {
    if path.exists() {
        return None;
    }
    let parent = path.ancestors().skip(1).find(|above| above.as_os_str().is_empty() || above.exists())?;
    let shown =
        if parent.as_os_str().is_empty() { "the current folder".into() } else { format!("`{}`", parent.display()) };
    if parent.is_file() {
        return Some(format!("{shown} is a file, not a folder"));
    }
    let rest = path.strip_prefix(parent).ok()?;
    let missing = rest.iter().next()?;
    let names = names(parent)?;
    let lacks = format!("{shown} has no `{}`", missing.display());
    Some(match meant(missing, &names) {
        Some(name) => {
            let named = parent.join(name);
            let whole = rest.iter().skip(1).fold(named.clone(), |path, below| path.join(below));
            let likely = if whole.exists() { whole } else { named };
            format!("{lacks}; did you mean `{}`?", likely.display())
        }
        None if names.is_empty() => format!("{lacks}; it is empty"),
        None => {
            let more = names.len().saturating_sub(LISTED);
            let listed = names.iter().take(LISTED).cloned().collect::<Vec<_>>().join(", ");
            let more = if more > 0 { format!(" and {more} more") } else { String::new() };
            format!("{lacks}; it holds {listed}{more}")
        }
    })
}

/// Names in a folder that are text and not hidden, sorted.
fn names(folder: &Path) -> Option<Vec<String>> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries = fs::read_dir(folder).ok()?.flatten();
    let mut names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.retain(|name| !name.starts_with('.'));
    names.sort();
    Some(names)
}

/// A name that differs by a few letters, or by its extension only.
fn meant<'a>(missing: &OsStr, names: &'a [String]) -> Option<&'a str> {
    let stem = |name: &str| Path::new(name).file_stem().map(|stem| stem.to_string_lossy().to_lowercase());
    let missing = missing.to_str()?;
    let near = nearest(missing, names.iter().map(String::as_str));
    near.or_else(|| names.iter().map(String::as_str).find(|name| stem(name) == stem(missing)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_folder_and_the_likely_name_are_given() {
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        fs::create_dir_all(at("trial/pose")).unwrap();
        fs::create_dir_all(at("empty")).unwrap();
        fs::write(at("trial/Calib.toml"), "").unwrap();
        let check = |path: &str, wanted: Option<&str>| {
            let found = advice(&at(path)).map(|text| text.replace(&root.path().display().to_string(), "R"));
            assert_eq!(found.as_deref(), wanted, "{path}");
        };
        check("trial/pose", None);
        check("trial/pse", Some("`R/trial` has no `pse`; did you mean `R/trial/pose`?"));
        check("trail/pose", Some("`R` has no `trail`; did you mean `R/trial/pose`?"));
        check("trail/other", Some("`R` has no `trail`; did you mean `R/trial`?"));
        check("trial/calib", Some("`R/trial` has no `calib`; did you mean `R/trial/Calib.toml`?"));
        check("trial/video/01", Some("`R/trial` has no `video`; it holds Calib.toml, pose"));
        check("empty/x", Some("`R/empty` has no `x`; it is empty"));
        check("trial/Calib.toml/x", Some("`R/trial/Calib.toml` is a file, not a folder"));
    }
}
