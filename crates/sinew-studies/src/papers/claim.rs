//! A paper's claim and what became of it.

use crate::support::statistics::verdict;
use std::fmt::Write as _;

/// A claim, judged by a criterion that was fixed before any run.
pub(super) struct Claim {
    pub(super) id: &'static str,
    pub(super) paper: &'static str,
    pub(super) ours: String,
    pub(super) criterion: &'static str,
    pub(super) pass: bool,
    /// Whether at least the direction is the paper's.
    pub(super) direction: bool,
}

/// Claims as a table in Markdown.
pub(super) fn table(claims: &[Claim]) -> String {
    let mut out = String::from("| | paper | ours | criterion | |\n|---|---|---|---|---|\n");
    for Claim { id, paper, ours, criterion, pass, .. } in claims {
        let _ = writeln!(out, "| {id} | {paper} | {ours} | {criterion} | {} |", verdict(*pass));
    }
    out
}
