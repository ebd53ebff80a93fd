//! Shell completions and the manual page, made from the arguments.

use super::ended::Ended;
use super::error::Error;
use super::misplaced;
use super::report;

/// Prints completions for a shell.
pub(crate) fn completions(shell: clap_complete::Shell) -> Result<Ended, Error> {
    let mut text = Vec::new();
    clap_complete::generate(shell, &mut misplaced::command(), "sinew", &mut text);
    report::answer(&String::from_utf8_lossy(&text))?;
    Ok(Ended::Done)
}

/// Prints the manual page of the program and of every command.
pub(crate) fn man() -> Result<Ended, Error> {
    let mut text = Vec::new();
    let command = misplaced::command();
    let below = |page| std::iter::once(page).chain(clap::Command::get_subcommands(page));
    let pages = std::iter::once(&command).chain(command.get_subcommands().flat_map(below));
    for page in pages.filter(|page| !page.is_hide_set()) {
        let rendered = clap_mangen::Man::new(page.clone()).render(&mut text);
        rendered.map_err(sinew::Error::io("write to", "the manual page"))?;
    }
    report::answer(&String::from_utf8_lossy(&text))?;
    Ok(Ended::Done)
}
