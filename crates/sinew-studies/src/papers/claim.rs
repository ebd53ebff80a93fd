//! A paper's claim and what became of it.

use crate::support::statistics::verdict;
use crate::support::table::{header, row};

/// A claim, judged by a criterion that was fixed before any run.
pub(super) struct Claim {
    pub(super) id: &'static str,
    pub(super) paper: &'static str,
    pub(super) ours: String,
    pub(super) criterion: &'static str,
    pub(super) pass: bool,
}

/// Claims as a table in Markdown.
pub(super) fn table(claims: &[Claim]) -> String {
    let mut out = header("| | paper | ours | criterion | |");
    for Claim { id, paper, ours, criterion, pass, .. } in claims {
        row!(out, "{id} | {paper} | {ours} | {criterion} | {}", verdict(*pass));
    }
    out
}
