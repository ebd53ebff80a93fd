//! A copy of the workspace to make mistakes in.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Copies the files that git tracks, and new ones that it does not ignore; what is there and not among them is removed. The `others` are left as they are: the caller writes them.
pub fn copy(root: &Path, to: &Path, others: &BTreeSet<String>) -> Result<(), String> {
    let listing = ["ls-files", "-z", "--cached", "--others", "--exclude-standard"];
    let output = Command::new("git").args(listing).current_dir(root).output().map_err(|e| format!("git: {e}"))?;
    if !output.status.success() {
        return Err(format!("git ls-files: {}", String::from_utf8_lossy(&output.stderr).trim()));
    }
    let listed = String::from_utf8(output.stdout).map_err(|_| "a path is not UTF-8".to_owned())?;
    let wanted: BTreeSet<PathBuf> =
        listed.split('\0').filter(|p| !p.is_empty()).map(PathBuf::from).filter(|p| root.join(p).is_file()).collect();
    for path in wanted.iter().filter(|path| !others.contains(&*path.to_string_lossy())) {
        fs::read(root.join(path))
            .and_then(|content| write_if_new(&to.join(path), &content))
            .map_err(|e| format!("{}: {e}", path.display()))?;
    }
    remove_others(to, to, &wanted).map_err(|e| format!("{}: {e}", to.display()))
}

/// Leaves a file with the same content alone, so that its time does not make cargo build.
pub fn write_if_new(path: &Path, content: &[u8]) -> std::io::Result<()> {
    if fs::read(path).is_ok_and(|old| old == content) {
        return Ok(());
    }
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(path, content)
}

fn remove_others(root: &Path, folder: &Path, wanted: &BTreeSet<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            remove_others(root, &path, wanted)?;
        } else if path.strip_prefix(root).is_ok_and(|p| !wanted.contains(p)) {
            fs::remove_file(&path)?;
        }
    }
    Ok(())
}
