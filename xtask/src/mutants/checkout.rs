//! A copy of the workspace to plant bugs in.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Copies the files that git tracks, and new ones that it does not ignore, to `target/mutants/checkout`; what is there and not among them is removed. Returns the copy's root.
pub fn copy(root: &Path) -> Result<PathBuf, String> {
    let listing = ["ls-files", "-z", "--cached", "--others", "--exclude-standard"];
    let output = Command::new("git").args(listing).current_dir(root).output().map_err(|e| format!("git: {e}"))?;
    if !output.status.success() {
        return Err(format!("git ls-files: {}", String::from_utf8_lossy(&output.stderr).trim()));
    }
    let listed = String::from_utf8(output.stdout).map_err(|_| "a path is not UTF-8".to_owned())?;
    let to = root.join("target/mutants/checkout");
    let wanted: BTreeSet<PathBuf> =
        listed.split('\0').filter(|p| !p.is_empty()).map(PathBuf::from).filter(|p| root.join(p).is_file()).collect();
    for path in &wanted {
        write_if_new(&root.join(path), &to.join(path)).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    remove_others(&to, &to, &wanted).map_err(|e| format!("{}: {e}", to.display()))?;
    Ok(to)
}

/// Leaves a file with the same content alone, so that its time does not make cargo build.
fn write_if_new(from: &Path, to: &Path) -> std::io::Result<()> {
    let content = fs::read(from)?;
    if fs::read(to).is_ok_and(|old| old == content) {
        return Ok(());
    }
    if let Some(folder) = to.parent() {
        fs::create_dir_all(folder)?;
    }
    fs::write(to, content)
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
