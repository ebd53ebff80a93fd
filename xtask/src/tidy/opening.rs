//! First sentences of module documentation: how many words they may have.

use super::workspace::{Violation, Workspace};

/// Fewer words than this.
const WORDS: usize = 20;

/// Full stops that end no sentence.
const ABBREVIATIONS: [&str; 11] = ["e.g.", "i.e.", "al.", "cf.", "eq.", "eqs.", "fig.", "sec.", "p.", "pp.", "vs."];

/// Checks the module documentation of all Rust files.
pub fn check(workspace: &Workspace) -> Vec<Violation> {
    let files = workspace.files.iter().filter(|file| file.is_rust());
    let long = files.filter_map(|file| {
        let sentence = first_sentence(&file.text);
        let count = words(&sentence);
        let what = format!("its first sentence has {count} words, {} at most: say what the module is", WORDS - 1);
        (count >= WORDS).then(|| Violation::in_file(&file.path, what))
    });
    long.collect()
}

/// The first sentence of the module documentation: to its full stop or the end of the paragraph.
fn first_sentence(text: &str) -> String {
    let lines = text.lines().skip_while(|line| !line.starts_with("//!"));
    let paragraph = lines.map_while(|line| Some(line.strip_prefix("//!")?.trim())).take_while(|line| !line.is_empty());
    let mut sentence = String::new();
    for word in paragraph.flat_map(str::split_whitespace) {
        sentence += if sentence.is_empty() { "" } else { " " };
        sentence += word;
        let bare = word.trim_end_matches([')', '*', '_', '"', '”']);
        let is_abbreviated = ABBREVIATIONS.contains(&bare.trim_start_matches(['(', '*', '_']).to_lowercase().as_str());
        if bare.ends_with(['.', '!', '?']) && !is_abbreviated && sentence.matches('`').count().is_multiple_of(2) {
            break;
        }
    }
    sentence
}

/// Words of a sentence; a code span counts as one, dashes and signs as none.
fn words(sentence: &str) -> usize {
    let plain: String =
        sentence.split('`').enumerate().map(|(i, part)| if i % 2 == 0 { part } else { "code" }).collect();
    plain.split_whitespace().filter(|word| word.contains(char::is_alphanumeric)).count()
}

#[cfg(test)]
mod tests {
    use super::super::planted;
    use super::*;

    #[test]
    fn long_first_sentences_are_caught() {
        let text =
            |count: usize| format!("#![no_main]\n//! {}word.\n//! {}", "word ".repeat(count - 1), "more ".repeat(30));
        planted::check(check, "crates/a/src/b.rs", &text(WORDS), &text(WORDS - 1));
    }

    #[test]
    fn sentences_end_at_full_stops_and_paragraphs() {
        let check = |text: &str, expected: &str| assert_eq!(first_sentence(text), expected);
        check(
            "//! A filter of Gordon et al. (1993), eq. (4): weights.\n//! More.",
            "A filter of Gordon et al. (1993), eq. (4): weights.",
        );
        check("//! Heading without a stop\n//!\n//! More.", "Heading without a stop");
        check("//! Reads `a. b` and\n//! c. Then d.", "Reads `a. b` and c.");
        check("//! 1.5 m (so far.) And more.", "1.5 m (so far.)");
        check("fn f() {}", "");
    }

    #[test]
    fn code_spans_count_as_one_word() {
        assert_eq!(words("A map `x ↦ a x + b` — of one `f(a, b)`-variable."), 6);
    }
}
