//! Flags given to a command that has no use for them.

use super::args::Cli;
use super::error::Error;
use clap::CommandFactory as _;
use clap::error::{ContextKind, ContextValue, ErrorKind};

/// What is wrong, if the arguments hold a flag of other commands.
pub(crate) fn flag(error: &clap::Error) -> Option<Error> {
    let Some(ContextValue::String(flag)) = error.get(ContextKind::InvalidArg) else { return None };
    if error.kind() != ErrorKind::UnknownArgument {
        return None;
    }
    let command = Cli::command();
    let has = |command: &&clap::Command| {
        command.get_arguments().any(|argument| {
            let long = argument.get_long().is_some_and(|long| *flag == format!("--{long}"));
            long || argument.get_short().is_some_and(|short| *flag == format!("-{short}"))
        })
    };
    let owners: Vec<String> =
        command.get_subcommands().filter(has).map(|command| format!("`sinew {}`", command.get_name())).collect();
    (!owners.is_empty()).then(|| Error::ForeignFlag { flag: flag.clone(), owners })
}
