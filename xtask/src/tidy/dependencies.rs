//! How many packages the library builds, counted from `cargo metadata`.

use super::workspace::Violation;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

/// Fewer packages than this.
const LIMIT: usize = 150;

/// Complains where there are too many.
pub fn check(packages: usize) -> Vec<Violation> {
    if packages < LIMIT {
        return Vec::new();
    }
    let what = format!(
        "the library builds {packages} packages; keep it under {LIMIT}, or say why in docs/reference/dependencies.md"
    );
    vec![Violation::in_file("Cargo.lock", what)]
}

/// Packages that the library builds on this platform, itself included.
pub fn library_packages(root: &Path) -> Result<BTreeSet<String>, String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let host = host(&cargo)?;
    let arguments = ["metadata", "--format-version", "1", "--locked", "--filter-platform", &host];
    let output = Command::new(&cargo).args(arguments).current_dir(root).output();
    let output = output.map_err(|error| format!("cargo metadata does not run: {error}"))?;
    if !output.status.success() {
        return Err(format!("cargo metadata fails: {}", String::from_utf8_lossy(&output.stderr).trim()));
    }
    let metadata: Value = serde_json::from_slice(&output.stdout).map_err(|error| error.to_string())?;
    closure(&metadata, "sinew").ok_or_else(|| "cargo metadata does not list the library".into())
}

fn host(cargo: &std::ffi::OsStr) -> Result<String, String> {
    let output = Command::new(cargo).args(["-vV"]).output().map_err(|error| format!("cargo does not run: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let host = text.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).ok_or_else(|| "cargo does not name its host".into())
}

/// Ids of the packages that the package of that name needs to be built and run (no dev-dependencies).
fn closure(metadata: &Value, name: &str) -> Option<BTreeSet<String>> {
    let packages = metadata.get("packages")?.as_array()?;
    let root = packages.iter().find(|package| package["name"] == name)?["id"].as_str()?;
    let nodes = metadata.get("resolve")?.get("nodes")?.as_array()?;
    let nodes: BTreeMap<&str, &Value> = nodes.iter().filter_map(|node| Some((node["id"].as_str()?, node))).collect();
    let mut found = BTreeSet::new();
    let mut open = vec![root];
    while let Some(id) = open.pop() {
        if !found.insert(id.to_owned()) {
            continue;
        }
        for dependency in nodes.get(id)?["deps"].as_array()? {
            let needed = dependency["dep_kinds"].as_array()?.iter().any(|kind| kind["kind"] != "dev");
            open.extend(dependency["pkg"].as_str().filter(|_| needed));
        }
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_many_packages_are_caught() {
        assert_eq!(check(LIMIT - 1), []);
        assert_eq!(check(LIMIT).len(), 1);
    }

    #[test]
    fn dev_dependencies_do_not_count() {
        let dependency = |id: &str, kind: Value| serde_json::json!({"pkg": id, "dep_kinds": [{"kind": kind}]});
        let metadata = serde_json::json!({
            "packages": [{"name": "sinew", "id": "a"}, {"name": "x", "id": "b"}],
            "resolve": {"nodes": [
                {"id": "a", "deps": [dependency("b", Value::Null), dependency("d", "dev".into())]},
                {"id": "b", "deps": [dependency("c", "build".into())]},
                {"id": "c", "deps": []},
                {"id": "d", "deps": []},
            ]},
        });
        let found = closure(&metadata, "sinew").unwrap();
        assert_eq!(found.into_iter().collect::<Vec<_>>(), ["a", "b", "c"]);
        assert!(closure(&metadata, "nothing").is_none());
    }
}
