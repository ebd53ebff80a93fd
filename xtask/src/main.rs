//! Chores of the workspace: `cargo xtask <command>`. A door: what needs the product is handed on to `sinew-studies`.

mod checkout;
mod drawn_mutants;
mod mutants;
mod source;
mod tidy;

use clap::{Parser, Subcommand};
use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, ExitCode};

/// Chores of the workspace.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    chore: Chore,
}

/// Arguments that are handed on as they are, `--help` too.
#[derive(clap::Args)]
struct HandedOn {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

#[derive(Subcommand)]
enum Chore {
    /// Draw mutants of the crates above the samplers, build them all at once and name the test that sees each.
    DrawnMutants(drawn_mutants::Args),
    /// Plant the bugs of tests/planted in a copy of the workspace and name the test that catches each.
    Mutants(mutants::Args),
    /// Reproduce a paper: its tables and figures on our data, its claims judged.
    #[command(disable_help_flag = true)]
    Reproduce(HandedOn),
    /// Run a study of crates/sinew-studies: `study --help` lists them.
    #[command(disable_help_flag = true)]
    Study(HandedOn),
    /// Put tables into the pages of docs: tables of the code, and tables that commands have written under target.
    #[command(disable_help_flag = true)]
    Tables(HandedOn),
    /// Check the rules that docs/ARCHITECTURE.md states: layers, who may do IO, leftovers, module docs.
    Tidy,
    /// Run every statistical check: does each claim of docs/evidence/correctness.md hold?
    #[command(disable_help_flag = true)]
    Verify(HandedOn),
}

fn main() -> ExitCode {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."));
    match Cli::parse().chore {
        Chore::DrawnMutants(args) => drawn_mutants::run(root, &args),
        Chore::Mutants(args) => mutants::run(root, &args),
        Chore::Reproduce(args) => study(root, Some("reproduce"), &args),
        Chore::Study(args) => study(root, None, &args),
        Chore::Tables(args) => study(root, Some("tables"), &args),
        Chore::Tidy => tidy::run(root),
        Chore::Verify(args) => study(root, Some("verify"), &args),
    }
}

/// Builds and runs a study, and ends with its exit code.
fn study(root: &Path, name: Option<&str>, handed_on: &HandedOn) -> ExitCode {
    let mut cargo = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    cargo.args(["run", "--quiet", "--release", "--package", "sinew-studies", "--manifest-path"]);
    cargo.arg(root.join("Cargo.toml")).arg("--").args(name).args(&handed_on.arguments);
    match cargo.status() {
        // A study that a signal ended has no code.
        Ok(status) => status.code().and_then(|code| u8::try_from(code).ok()).map_or(ExitCode::FAILURE, ExitCode::from),
        Err(error) => {
            eprintln!("error: cargo: {error}");
            ExitCode::FAILURE
        }
    }
}
