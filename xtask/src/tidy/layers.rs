//! Arrows between crates point down: what each crate's manifest and product code may name.

use super::workspace::{File, Violation, Workspace};
use crate::source::{Token, lines_with};
use std::collections::BTreeSet;

/// What each crate may depend on, of ours, from the lowest up; `*` is all above its row.
const LAYERS: [(&str, &str); 28] = [
    ("core", ""),
    ("body", "core"),
    ("observe", "body core"),
    ("dynamics", "core"),
    ("latent", "dynamics core"),
    ("samplers", "core"),
    ("tracking", "samplers core"),
    ("formats", "core body observe"),
    ("simulate", "core body observe formats"),
    ("angles", "core body dynamics tracking"),
    ("input", "core body observe formats dynamics"),
    ("setup", "input core body observe formats dynamics"),
    ("results", "setup input core body observe formats dynamics angles"),
    ("motion", "results setup input core body observe formats dynamics latent"),
    ("sinew", "results setup input core body observe formats dynamics latent samplers tracking angles"),
    ("analysis", "sinew motion results setup input core body observe formats dynamics"),
    ("report", "analysis sinew motion results setup input core body observe formats dynamics latent"),
    ("batch", "report sinew results setup input formats"),
    ("words", "report analysis sinew motion results setup input"),
    ("cli", "*"),
    ("python", "*"),
    ("invariance", "core"),
    ("markers", "core body observe"),
    ("tests", "*"),
    ("studies", "*"),
    ("peers", "*"),
    ("fuzz", "*"),
    ("xtask", ""),
];

/// What only a program needs: arguments, manuals, progress bars and interrupts.
const TERMINAL: [&str; 5] = ["clap", "clap_complete", "clap_mangen", "ctrlc", "indicatif"];

/// The programs: what people run, and our chores.
const PROGRAMS: [&str; 3] = ["sinew-cli", "sinew-studies", "xtask"];

/// Modules of core that bodies may use: lanes and what runs on them, medians; no probability and no randomness.
const CORE_FOR_BODY: [&str; 4] = ["lanes", "elementary", "estimators", "kernel"];

/// Checks manifests and imports.
pub fn check(workspace: &Workspace) -> Vec<Violation> {
    let mut violations = Vec::new();
    for file in &workspace.files {
        if file.path.ends_with("Cargo.toml") {
            check_manifest(file, &mut violations);
            check_use(file, workspace, &mut violations);
        } else {
            check_imports(file, &mut violations);
        }
    }
    violations
}

/// What a package may depend on, of ours; none where it has no row.
fn allowed(package: &str) -> Option<Vec<String>> {
    let full = |row: &str| if matches!(row, "sinew" | "xtask") { row.to_owned() } else { format!("sinew-{row}") };
    let at = LAYERS.iter().position(|(row, _)| full(row) == package)?;
    let below = match LAYERS[at].1 {
        "*" => LAYERS[..at].iter().map(|(row, _)| full(row)).collect(),
        rows => rows.split_whitespace().map(full).collect(),
    };
    Some(below)
}

fn check_manifest(file: &File, violations: &mut Vec<Violation>) {
    let mut complain = |what: String| violations.push(Violation::in_file(&file.path, what));
    let manifest: toml::Table = match file.text.parse() {
        Ok(manifest) => manifest,
        Err(error) => return complain(format!("not TOML: {error}")),
    };
    let Some(name) = manifest.get("package").and_then(|package| package.get("name")).and_then(toml::Value::as_str)
    else {
        return;
    };
    let inherits = manifest.get("lints").and_then(|lints| lints.get("workspace")).and_then(toml::Value::as_bool);
    if inherits != Some(true) {
        complain("does not inherit the workspace's lints".into());
    }
    let names = |key: &str| -> BTreeSet<String> {
        let table = manifest.get(key).and_then(toml::Value::as_table);
        table.map(|table| table.keys().cloned().collect()).unwrap_or_default()
    };
    let Some(allowed) = allowed(name) else {
        return complain(format!("`{name}` has no place among the layers; give it one in xtask/src/tidy/layers.rs"));
    };
    for dependency in names("dependencies").iter().chain(&names("build-dependencies")) {
        if (dependency == "sinew" || dependency.starts_with("sinew-")) && !allowed.contains(dependency) {
            complain(format!("`{name}` must not depend on `{dependency}`"));
        }
        if name == "sinew-body" && dependency.starts_with("rand") {
            complain("bodies hold no randomness".into());
        }
        if TERMINAL.contains(&dependency.as_str()) && !PROGRAMS.contains(&name) {
            complain(format!("`{name}` must not depend on `{dependency}`: only programs have a terminal"));
        }
    }
}

/// A dependency of a published crate that no file of its `src` names is paid for by every user.
fn check_use(manifest: &File, workspace: &Workspace, violations: &mut Vec<Violation>) {
    let Some(folder) = manifest.path.strip_suffix("Cargo.toml").filter(|path| path.starts_with("crates/")) else {
        return;
    };
    let Ok(table) = manifest.text.parse::<toml::Table>() else { return };
    let Some(dependencies) = table.get("dependencies").and_then(toml::Value::as_table) else { return };
    let sources = format!("{folder}src/");
    for dependency in dependencies.keys() {
        let word = dependency.replace('-', "_");
        let mut files = workspace.files.iter().filter(|file| file.path.starts_with(&sources));
        if !files.any(|file| !lines_with(&file.product, &word).is_empty()) {
            violations.push(Violation::in_file(&manifest.path, format!("`{dependency}` is never used; remove it")));
        }
    }
}

fn check_imports(file: &File, violations: &mut Vec<Violation>) {
    let Some(name) = file.library() else { return };
    let Some(allowed) = allowed(name) else { return };
    let text = |at: usize| file.product.get(at).map_or("", |token| token.text.as_str());
    for (at, Token { text: word, line }) in file.product.iter().enumerate() {
        let is_import = text(at + 1) == "::" || at > 0 && text(at - 1) == "use";
        if !is_import || !(word == "sinew" || word.starts_with("sinew_")) {
            continue;
        }
        let import = word.replace('_', "-");
        if import != name && !allowed.contains(&import) {
            violations.push(Violation::at(&file.path, *line, format!("`{name}` must not know `{word}`")));
        }
        if name == "sinew-body" && word == "sinew_core" && !CORE_FOR_BODY.contains(&text(at + 2)) {
            violations.push(Violation::at(&file.path, *line, "bodies know only the lanes of core"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::planted;
    use super::*;

    fn manifest(name: &str, dependency: &str) -> String {
        format!("[package]\nname = \"{name}\"\n[lints]\nworkspace = true\n[dependencies]\n{dependency} = \"1\"\n")
    }

    /// What is wrong with a manifest whose dependency is used.
    fn complaints(path: &str, text: &str, used: &str) -> Vec<Violation> {
        let source = format!("{}src/main.rs", path.trim_end_matches("Cargo.toml"));
        let source = File::new(&source, used);
        let manifest = File::new(path, text);
        let mut violations = Vec::new();
        check_manifest(&manifest, &mut violations);
        check_use(&manifest, &Workspace { top: Vec::new(), files: vec![source] }, &mut violations);
        violations
    }

    #[test]
    fn manifests_that_point_up_are_caught() {
        for (name, bad, good) in [
            ("sinew-core", "sinew-body", "rand"),
            ("sinew-body", "sinew-observe", "sinew-core"),
            ("sinew-body", "rand_chacha", "nalgebra"),
            ("sinew-dynamics", "sinew-body", "sinew-core"),
            ("sinew-samplers", "sinew-tracking", "sinew-core"),
            ("sinew-tracking", "sinew-body", "sinew-samplers"),
            ("sinew-formats", "sinew-dynamics", "sinew-body"),
            ("sinew-motion", "sinew", "sinew-formats"),
            ("sinew-simulate", "sinew-tracking", "sinew-observe"),
            ("sinew-simulate", "sinew", "sinew-formats"),
            ("sinew", "sinew-cli", "sinew-tracking"),
            ("sinew", "sinew-simulate", "sinew-samplers"),
            ("sinew", "clap", "rayon"),
            ("sinew-samplers", "indicatif", "faer"),
            ("sinew-cli", "sinew-tests", "clap"),
            ("sinew-cli", "sinew-invariance", "sinew-simulate"),
            ("sinew-new", "rand", ""),
        ] {
            let path = format!("crates/{name}/Cargo.toml");
            let found = complaints(&path, &manifest(name, bad), &bad.replace('-', "_"));
            assert_eq!(found.len(), 1, "{name} on {bad}: {found:?}");
            if !good.is_empty() {
                assert_eq!(complaints(&path, &manifest(name, good), &good.replace('-', "_")), [], "{name} on {good}");
            }
        }
        let lints = "[package]\nname = \"sinew-core\"\n";
        assert_eq!(planted::violations(check, "crates/sinew-core/Cargo.toml", lints).len(), 1);
        assert_eq!(planted::violations(check, "xtask/Cargo.toml", &manifest("xtask", "sinew-core")).len(), 1);
    }

    #[test]
    fn unused_dependencies_are_caught() {
        let (path, text) = ("crates/sinew-core/Cargo.toml", manifest("sinew-core", "rand_chacha"));
        assert_eq!(complaints(path, &text, "use rand_chacha::ChaCha8Rng;"), []);
        assert_eq!(complaints(path, &text, "use rand_chacha8::Rng;").len(), 1);
    }

    #[test]
    fn imports_that_point_up_are_caught() {
        let tracker = "crates/sinew-tracking/src/bootstrap.rs";
        planted::check(check, tracker, "use sinew_body::Plan;", "use sinew_samplers::resample; // sinew_body");
        planted::check(
            check,
            tracker,
            "fn f(x: sinew_formats::Layout) {}",
            "#[cfg(test)]\nmod tests { use sinew_dynamics::x; }",
        );
        let body = "crates/sinew-body/src/tree.rs";
        planted::check(check, body, "use sinew_core::random::Stage;", "use sinew_core::lanes::Real;");
        planted::check(check, body, "use sinew_core::density::LogDensity;", "use sinew_core::elementary::sin_cos;");
        let library = "crates/sinew/src/run.rs";
        planted::check(check, library, "pub use sinew_simulate as simulate;", "struct A { sinew_version: u8 }");
        let simulated = "crates/sinew-simulate/src/walker.rs";
        planted::check(check, simulated, "use sinew_results::Estimate;", "use sinew_observe::Camera;");
        planted::check(check, simulated, "use sinew_tracking::Tracker;", "mod sinew; use sinew_core::random::Stage;");
    }
}
