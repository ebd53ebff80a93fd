//! The program `sinew`.

mod cli;

fn main() -> std::process::ExitCode {
    cli::main()
}
