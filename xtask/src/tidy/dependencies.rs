//! Every dependency of ours has a row in docs/reference/dependencies.md, and every row a dependency.

use super::workspace::{File, Violation, Workspace};
use std::collections::BTreeMap;

/// The page with the rows.
const PAGE: &str = "docs/reference/dependencies.md";

/// Tables of a manifest that name dependencies.
const TABLES: [&str; 3] = ["dependencies", "dev-dependencies", "build-dependencies"];

/// Checks all manifests against the page.
pub fn check(workspace: &Workspace) -> Vec<Violation> {
    let Some(page) = workspace.files.iter().find(|file| file.path == PAGE) else { return Vec::new() };
    let rows = rows(&page.text);
    let mut used: BTreeMap<String, &str> = BTreeMap::new();
    for manifest in workspace.files.iter().filter(|file| file.path.ends_with("/Cargo.toml")) {
        used.extend(foreign(manifest).into_iter().map(|name| (name, manifest.path.as_str())));
    }
    let lacks = |(name, manifest): (&String, &&str)| {
        Violation::in_file(manifest, format!("`{name}` has no row in {PAGE}: what for, why not our own"))
    };
    let mut found: Vec<Violation> = used.iter().filter(|(name, _)| !rows.contains_key(*name)).map(lacks).collect();
    let stale = rows.iter().filter(|(name, _)| !used.contains_key(*name));
    found.extend(stale.map(|(name, line)| Violation::at(PAGE, *line, format!("no manifest names `{name}`"))));
    found
}

/// Names in the first cells of tables, with their lines; heads and rules of tables are none.
fn rows(page: &str) -> BTreeMap<String, usize> {
    let mut rows = BTreeMap::new();
    for (line, text) in (1..).zip(page.lines()) {
        let first = text.strip_prefix("| ").and_then(|row| row.split(" |").next()).unwrap_or_default();
        for name in first.split(", ").filter(|name| !name.is_empty() && *name != "package") {
            rows.insert(name.to_owned(), line);
        }
    }
    rows
}

/// What a manifest depends on that is not ours; what is none is said by the rule on layers.
fn foreign(manifest: &File) -> Vec<String> {
    let table: toml::Table = manifest.text.parse().unwrap_or_default();
    let by_platform = table.get("target").and_then(toml::Value::as_table).into_iter().flatten();
    let tables = by_platform.filter_map(|(_, table)| table.as_table()).chain([&table]);
    let tables = tables.flat_map(|table| TABLES.iter().filter_map(|key| table.get(*key)?.as_table()));
    let names = tables.flat_map(|table| table.keys());
    names.filter(|name| *name != "sinew" && !name.starts_with("sinew-")).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dependencies_and_rows_belong_together() {
        let manifest =
            "[dependencies]\nrand.workspace = true\nsinew-core.workspace = true\n[dev-dependencies]\nproptest = \"1\"";
        let found = |page: &str| -> Vec<String> {
            let files = vec![File::new("crates/a/Cargo.toml", manifest), File::new(PAGE, page)];
            check(&Workspace { files, ..Workspace::default() }).into_iter().map(|violation| violation.what).collect()
        };
        let head = "| package | what for |\n|---|---|\n";
        assert_eq!(found(&format!("{head}| rand | a |\n| proptest | b |")), [""; 0]);
        assert_eq!(found(&format!("{head}| proptest, rand | a |")), [""; 0]);
        assert_eq!(found(&format!("{head}| rand | a |")).len(), 1);
        assert_eq!(found(&format!("{head}| proptest, rand, tar | a |")), ["no manifest names `tar`"]);
    }
}
