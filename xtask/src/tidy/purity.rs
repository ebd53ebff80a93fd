//! Who may do IO, print, write `unsafe` or draw random numbers.

use super::workspace::{File, Violation, Workspace};
use crate::source::lines_with;

/// What a crate does that reaches beyond its arguments, with the tokens that show it, and who may.
struct Reach {
    shown_by: &'static [(&'static str, &'static str)],
    may: &'static [&'static str],
}

const TERMINAL: Reach = Reach {
    shown_by: &[
        ("println !", "prints"),
        ("eprintln !", "prints"),
        ("print !", "prints"),
        ("eprint !", "prints"),
        ("stdout ( )", "prints"),
        ("stderr ( )", "prints"),
        ("stdin ( )", "reads a stream of the process"),
    ],
    may: &["sinew-cli", "sinew-studies"],
};

const POOLS: Reach = Reach {
    shown_by: &[("ThreadPoolBuilder", "sets up a thread pool")],
    may: &["sinew-cli", "sinew-studies", "sinew", "sinew-batch"],
};

const INPUT_AND_OUTPUT: Reach = Reach {
    shown_by: &[
        ("std :: fs", "touches files"),
        ("fs ::", "touches files"),
        ("File :: open", "touches files"),
        ("File :: create", "touches files"),
        ("std :: net", "touches the network"),
        ("std :: env", "reads the environment"),
        ("env :: var", "reads the environment"),
        ("std :: process", "touches processes"),
        ("thread :: spawn", "starts a thread"),
        ("thread :: scope", "starts threads"),
        ("SystemTime", "reads a clock"),
        ("Instant :: now", "reads a clock"),
        ("thread_rng", "draws from a global generator"),
    ],
    may: &[
        "sinew",
        "sinew-analysis",
        "sinew-batch",
        "sinew-cli",
        "sinew-input",
        "sinew-motion",
        "sinew-python",
        "sinew-report",
        "sinew-results",
        "sinew-setup",
        "sinew-studies",
    ],
};

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
        for reach in [TERMINAL, POOLS, INPUT_AND_OUTPUT].iter().filter(|reach| !reach.may.contains(&library)) {
            forbid(file, reach, &mut violations);
        }
        if library == "sinew-body" {
            for line in lines_with(&file.product, "rand ::") {
                violations.push(Violation::at(&file.path, line, "bodies hold no randomness"));
            }
        }
    }
    violations
}

/// One violation for each line that shows the reach.
fn forbid(file: &File, reach: &Reach, violations: &mut Vec<Violation>) {
    let mut seen = Vec::new();
    for (tokens, why) in reach.shown_by {
        for line in lines_with(&file.product, tokens) {
            if !seen.contains(&line) {
                seen.push(line);
                let what = format!("{why} (`{tokens}`); only {} may", reach.may.join(", "));
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
        for (is_file, reach) in [(false, TERMINAL), (false, POOLS), (true, INPUT_AND_OUTPUT)] {
            for (words, _) in reach.shown_by {
                let bad = format!("fn f() {{ {words} }}");
                let good = format!("fn f() {{}} // {words}\n#[cfg(test)]\nmod tests {{ {words} }}");
                planted::check(check, LIBRARY, &bad, &good);
                let in_report = planted::violations(check, "crates/sinew-report/src/page.rs", &bad);
                assert_eq!(in_report.len(), usize::from(!is_file), "{words}");
                assert_eq!(planted::violations(check, "crates/sinew-cli/src/main.rs", &bad), []);
                assert_eq!(planted::violations(check, "crates/sinew-core/benches/x.rs", &bad), []);
            }
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
