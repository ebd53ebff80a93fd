//! Words that made strangers stumble, in Rust files: comments, names and messages.

use super::tokens::tokens;
use super::workspace::{File, Violation, Workspace};

/// Words that made strangers stumble, and what to write for them.
pub const STUMBLES: [(&str, &str); 12] = [
    ("told", "warn, report, distinguish"),
    ("tells", "say, report, distinguish"),
    ("anew", "again"),
    ("go on", "continue, resume"),
    ("goes on", "continue, resume"),
    ("gone on", "continue, resume"),
    ("those of", "the noun"),
    ("looks on", "progress callback"),
    ("is asked of", "the noun"),
    ("asked for", "requested, required"),
    ("so many", "the number, or a number of"),
    ("so-manieth", "every n-th"),
];

/// The file that lists the words.
const LIST: &str = "xtask/src/tidy/words.rs";

/// Beginning of names that say of what they are, but not what.
const BARE: &str = "of_";

/// Checks all Rust files.
pub fn check(workspace: &Workspace) -> Vec<Violation> {
    let files = workspace.files.iter().filter(|file| file.is_rust() && file.path != LIST);
    files.flat_map(|file| stumbles(file).into_iter().chain(bare_names(file))).collect()
}

/// The words of a row that made strangers stumble, with what to write for them.
pub fn odd_words(row: &str) -> impl Iterator<Item = (&'static str, &'static str)> {
    let row = row.to_lowercase();
    STUMBLES.into_iter().filter(move |(phrase, _)| contains_phrase(&row, phrase))
}

/// Whether a phrase stands in a row between characters that are no letters.
fn contains_phrase(row: &str, phrase: &str) -> bool {
    row.match_indices(phrase).any(|(at, _)| {
        let before = row[..at].chars().next_back();
        let after = row[at + phrase.len()..].chars().next();
        ![before, after].into_iter().flatten().any(char::is_alphabetic)
    })
}

/// Rows with odd words; `_` in a name counts as a space.
fn stumbles(file: &File) -> Vec<Violation> {
    let mut found = Vec::new();
    for (number, row) in (1..).zip(file.text.lines()) {
        for (phrase, plain) in odd_words(&row.replace('_', " ")) {
            found.push(Violation::at(&file.path, number, format!("\"{phrase}\": write {plain}")).known_as(&file.path));
        }
    }
    found
}

/// Names that begin with a bare `of_`.
fn bare_names(file: &File) -> Vec<Violation> {
    let tokens = tokens(&file.code);
    let bare = tokens.iter().filter(|token| token.text.starts_with(BARE));
    let what = |name: &str| format!("`{name}`: say what it is, or where it is from (`from_…`)");
    bare.map(|token| Violation::at(&file.path, token.line, what(token.text))).collect()
}

#[cfg(test)]
mod tests {
    use super::super::planted;
    use super::*;

    const PATH: &str = "crates/sinew-core/src/random.rs";

    #[test]
    fn odd_words_are_caught_in_comments_names_and_messages() {
        planted::check(check, PATH, "/// It is Told.", "/// It is a manewver of Toldi.");
        planted::check(check, PATH, "fn angles_are_those_of_the_markers() {}", "fn angles_match_the_markers() {}");
        planted::check(check, PATH, "const A: &str = \"2 were asked for\";", "const A: &str = \"2 were requested\";");
        planted::check(check, PATH, "// every so many seconds", "// Every ten seconds, so. Many do.");
    }

    #[test]
    fn names_that_begin_with_of_are_caught() {
        planted::check(check, PATH, "fn of_states() {}", "fn points_of_states() {} // of_states");
    }

    #[test]
    fn the_list_itself_may_name_the_words() {
        assert_eq!(planted::violations(check, LIST, "// told"), []);
    }
}
