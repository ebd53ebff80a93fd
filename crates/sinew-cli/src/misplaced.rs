//! Flags given to a command that has no use for them.

use super::args::{Cli, General};
use super::error::Error;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use clap::{ArgMatches, CommandFactory as _};

/// General flags that not every command uses.
const USED_BY_SOME: [&str; 5] = ["out", "force", "config", "seed", "threads"];

/// Which of these a command uses.
fn used(command: &str) -> &'static [&'static str] {
    match command {
        "demo" | "track" | "validate" => &USED_BY_SOME,
        "inspect" => &["config", "out", "force"],
        "sync" => &["config"],
        "latent" => &["out", "force", "threads"],
        "simulate" | "primitives" => &["out", "force", "seed", "threads"],
        "convert" => &["force"],
        "plan" | "unpack" => &["out", "force"],
        "run" => &["threads"],
        "segment" | "overlay" | "report" | "gait" | "compare" | "opensim" | "predict" | "fit-shape" => {
            &["out", "force"]
        }
        _ => &[],
    }
}

/// The program's arguments; the help of a command shows the flags that it uses.
pub(crate) fn command() -> clap::Command {
    let mut command = Cli::command();
    command.build();
    hide_unused(&mut command);
    command
}

fn hide_unused(command: &mut clap::Command) {
    for below in command.get_subcommands_mut() {
        let used = used(below.get_name());
        if below.has_subcommands() {
            hide_unused(below);
        } else {
            let is_unused = |flag: &str| USED_BY_SOME.contains(&flag) && !used.contains(&flag);
            let hidden = |flag: clap::Arg| if is_unused(flag.get_id().as_str()) { flag.hide(true) } else { flag };
            *below = std::mem::take(below).mut_args(hidden);
        }
    }
}

/// General flags that were given and that the command has no use for.
pub(crate) fn unused(general: &General, matches: &ArgMatches) -> Vec<&'static str> {
    let mut innermost = ("", matches);
    while let Some(below) = innermost.1.subcommand() {
        innermost = below;
    }
    let used = used(innermost.0);
    let given = general.settings().into_iter().map(|(key, _)| key).chain(general.config.as_ref().map(|_| "config"));
    given.filter(|key| !used.contains(key)).collect()
}

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
