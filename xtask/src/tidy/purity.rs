//! Who may do IO, print, write `unsafe` or draw random numbers.

use super::workspace::{File, Violation, Workspace};
use crate::source::lines_with;

/// What only programs do, with the reason.
const TERMINAL: [(&str, &str); 7] = [
    ("println!", "prints"),
    ("eprintln!", "prints"),
    ("print!", "prints"),
    ("eprint!", "prints"),
    ("stdout()", "prints"),
    ("stderr()", "prints"),
    ("stdin()", "reads a stream of the process"),
];

/// What whole runs and programs do, with the reason.
const POOLS: [(&str, &str); 1] = [("ThreadPoolBuilder", "sets up a thread pool")];

/// What the library and programs do, with the reason.
const INPUT_AND_OUTPUT: [(&str, &str); 13] = [
    ("std::fs", "touches files"),
    ("fs::", "touches files"),
    ("File::open", "touches files"),
    ("File::create", "touches files"),
    ("std::net", "touches the network"),
    ("std::env", "reads the environment"),
    ("env::var", "reads the environment"),
    ("std::process", "touches processes"),
    ("thread::spawn", "starts a thread"),
    ("thread::scope", "starts threads"),
    ("SystemTime", "reads a clock"),
    ("Instant::now", "reads a clock"),
    ("thread_rng", "draws from a global generator"),
];

/// Where `unsafe` is allowed.
const UNSAFE: &str = "crates/sinew-core/src/lanes.rs";

/// Checks product code; `unsafe` in all code.
pub fn check(workspace: &Workspace) -> Vec<Violation> {
    let mut violations = Vec::new();
    for file in &workspace.files {
        if file.path != UNSAFE && !file.path.starts_with("fuzz/") {
            for line in lines_with(&file.code, "unsafe") {
                violations.push(Violation::at(&file.path, line, format!("`unsafe` outside {UNSAFE}")));
            }
        }
        let Some(library) = file.library() else { continue };
        match library {
            "sinew-cli" | "sinew-studies" => {}
            "sinew-runs" => {
                forbid(file, &TERMINAL, "the program and xtask", &mut violations);
            }
            "sinew" | "sinew-recording" | "sinew-tools" | "sinew-laboratory" | "sinew-python" => {
                let all = [&TERMINAL[..], &POOLS[..]].concat();
                forbid(file, &all, "runs, the program and xtask", &mut violations);
            }
            _ => {
                let all = [&TERMINAL[..], &POOLS[..], &INPUT_AND_OUTPUT[..]].concat();
                forbid(
                    file,
                    &all,
                    "the library, recordings, tools, the laboratory, runs, the program and xtask",
                    &mut violations,
                );
            }
        }
        if library == "sinew-body" {
            for line in lines_with(&file.product, "rand::") {
                violations.push(Violation::at(&file.path, line, "bodies hold no randomness"));
            }
        }
    }
    violations
}

/// One violation for each line with any of the words.
fn forbid(file: &File, words: &[(&str, &str)], who_may: &str, violations: &mut Vec<Violation>) {
    let mut seen = Vec::new();
    for (words, why) in words {
        for line in lines_with(&file.product, words) {
            if !seen.contains(&line) {
                seen.push(line);
                let what = format!("`{words}`: a library {why}; only {who_may} may");
                violations.push(Violation::at(&file.path, line, what));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::planted;
    use super::*;

    const LIBRARY: &str = "crates/sinew-samplers/src/hmc.rs";

    #[test]
    fn io_in_a_library_is_caught() {
        for (is_printed, (words, _)) in TERMINAL
            .into_iter()
            .chain(POOLS)
            .map(|words| (true, words))
            .chain(INPUT_AND_OUTPUT.map(|words| (false, words)))
        {
            let bad = format!("fn f() {{ {words} }}");
            let good = format!("fn f() {{}} // {words}\n#[cfg(test)]\nmod tests {{ {words} }}");
            planted::check(check, LIBRARY, &bad, &good);
            assert_eq!(planted::violations(check, "crates/sinew/src/run.rs", &bad).len(), usize::from(is_printed));
            assert_eq!(planted::violations(check, "crates/sinew-cli/src/main.rs", &bad), []);
            assert_eq!(planted::violations(check, "crates/sinew-core/benches/x.rs", &bad), []);
        }
        planted::check(check, LIBRARY, "use std::{fs, io};\nfs::read(x)", "use std::io;");
    }

    #[test]
    fn unsafe_has_one_home() {
        let word = concat!("uns", "afe");
        let text = format!("fn f() {{ {word} {{ g() }} }}");
        planted::check(check, LIBRARY, &text, "#![deny(unsafe_code)]");
        assert_eq!(planted::violations(check, "tests/tests/x.rs", &text).len(), 1);
        assert_eq!(planted::violations(check, UNSAFE, &text), []);
    }

    #[test]
    fn randomness_in_a_body_is_caught() {
        planted::check(check, "crates/sinew-body/src/tree.rs", "use rand::Rng;", "use operand::Rng;");
    }
}
