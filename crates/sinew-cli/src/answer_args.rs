//! The flag that gives an answer a form for programs.

use clap::Args;

/// The flag of commands whose answer has a form for programs.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct Answer {
    /// Give the answer as JSON
    #[arg(long, help_heading = "Output")]
    pub(crate) json: bool,
}
