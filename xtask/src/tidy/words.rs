//! Libraries know no flags, no advice and no exit codes: what users are told of them is said by `sinew-words` and the program.

use super::workspace::{Violation, Workspace};
use crate::source::lines_with;

/// Crates that speak to users.
const SPEAKERS: [&str; 4] = ["sinew-cli", "sinew-python", "sinew-studies", "sinew-words"];

/// Where a text names a setting by its flag, and where flags have their help.
const NOTATION: [&str; 2] = ["crates/sinew-input/src/flag.rs", "crates/sinew/src/config/common.rs"];

/// Functions that belong to `sinew-words`.
const SAID: [&str; 2] = ["fn exit_code", "fn help"];

/// Checks libraries.
pub fn check(workspace: &Workspace) -> Vec<Violation> {
    let mut violations = Vec::new();
    let libraries = workspace.files.iter().filter(|file| file.library().is_some_and(|name| !SPEAKERS.contains(&name)));
    for file in libraries {
        for function in SAID {
            let lines = lines_with(&file.product, function).into_iter();
            let what = format!("`{function}` in a library; `sinew-words` says what belongs to an error");
            violations.extend(lines.map(|line| Violation::at(&file.path, line, what.clone())));
        }
        if NOTATION.contains(&file.path.as_str()) {
            continue;
        }
        let flags = file.strings().into_iter().filter(|string| names_a_flag(&string.text));
        violations.extend(flags.map(|string| {
            Violation::at(&file.path, string.line, "a flag in a library; name the setting by `sinew_input::flag`")
        }));
    }
    violations
}

/// Whether a word begins with two dashes.
fn names_a_flag(text: &str) -> bool {
    text.split("--").skip(1).any(|rest| rest.starts_with(|first: char| first.is_ascii_lowercase() || first == '{'))
}

#[cfg(test)]
mod tests {
    use super::super::planted;
    use super::*;

    #[test]
    fn advice_and_exit_codes_of_libraries_are_caught() {
        for function in SAID {
            let text = format!("{function}() {{}}");
            planted::check(check, "crates/sinew-setup/src/x.rs", &text, &text.replace("fn ", "fn no_"));
            assert_eq!(planted::violations(check, "crates/sinew-words/src/x.rs", &text), []);
        }
    }

    #[test]
    fn flags_of_libraries_are_caught() {
        let path = "crates/sinew-setup/src/x.rs";
        let plain =
            "/// Set by `--lag`.\nfn f() { g(\"a -- b\") }\n#[cfg(test)]\nmod tests { const A: &str = \"--lag\"; }";
        planted::check(check, path, "fn f() { g(\"set\n`--lag`\") }", plain);
        planted::check(
            check,
            path,
            "#[error(\"`--{flag}` is 0\")]\nstruct E;",
            "#[error(\"{} is 0\", flag(\"lag\"))]\nstruct E;",
        );
        for path in ["crates/sinew-cli/src/x.rs", NOTATION[0], NOTATION[1]] {
            assert_eq!(planted::violations(check, path, "const A: &str = \"--lag\";"), []);
        }
    }
}
