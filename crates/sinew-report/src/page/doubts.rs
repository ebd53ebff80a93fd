//! What a run doubts: failed diagnostics and warnings, those that differ in a name or number alone together.

use super::advice::advice;
use super::html::with_code;
use super::recorded::Recorded;

/// Doubts of one kind.
pub(super) struct Doubt<'a> {
    /// Whether a diagnostic failed.
    pub(super) is_failed: bool,
    /// What is said.
    pub(super) text: &'a str,
    /// What is said of other cameras, limbs or frames in the same words.
    pub(super) others: Vec<&'a str>,
}

/// The doubts of a run, failed diagnostics first.
pub(super) fn doubts(recorded: &Recorded) -> Vec<Doubt<'_>> {
    let failed = recorded.sentences("failed_diagnostics").into_iter().map(|text| (true, text));
    let warned = recorded.sentences("warnings").into_iter().map(|text| (false, text));
    grouped(failed.chain(warned))
}

fn grouped<'a>(all: impl Iterator<Item = (bool, &'a str)>) -> Vec<Doubt<'a>> {
    let mut found: Vec<Doubt<'a>> = vec![];
    for (is_failed, text) in all {
        match found.iter_mut().find(|known| known.is_failed == is_failed && words(known.text) == words(text)) {
            Some(known) => known.others.push(text),
            None => found.push(Doubt { is_failed, text, others: vec![] }),
        }
    }
    found
}

/// A text without the name before its first colon and without its digits.
fn words(text: &str) -> String {
    let said = text.split_once(": ").map_or(text, |(_, said)| said);
    said.chars().filter(|letter| !letter.is_ascii_digit()).collect()
}

/// The list as HTML.
pub(super) fn list(recorded: &Recorded) -> String {
    let items: Vec<String> = doubts(recorded).iter().map(item).collect();
    match items.is_empty() {
        true => "<p>Nothing: every check that a run makes of itself was passed.</p>\n".into(),
        false => format!("<ul class=\"doubts\">\n{}</ul>\n", items.concat()),
    }
}

fn item(Doubt { is_failed, text, others }: &Doubt<'_>) -> String {
    let (class, word) = if *is_failed { ("bad", "failed") } else { ("warn", "doubt") };
    let first = |text: &str| sentence(text.split(". ").next().unwrap_or_default());
    let others: String = others.iter().map(|text| format!("<p>{}</p>", first(text))).collect();
    let to_do = advice(text)
        .map_or_else(String::new, |to_do| format!("<p class=\"todo\"><b>What to do:</b> {}</p>", sentence(&to_do)));
    format!("<li class=\"{class}\"><p><b>{word}</b> {}</p>{others}{to_do}</li>\n", sentence(text))
}

/// A text as HTML that ends as a sentence does.
fn sentence(text: &str) -> String {
    let end = if text.ends_with(['.', '?', '!']) { "" } else { "." };
    format!("{}{end}", with_code(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_in_names_and_numbers_is_said_once() {
        let all = ["C1: scatter 1.3 times. Do this", "errors persist", "C2: scatter 1.5 times. Do this"];
        let found = grouped(all.into_iter().map(|text| (false, text)));
        assert_eq!(found.iter().map(|doubt| doubt.text).collect::<Vec<_>>(), all[..2]);
        assert_eq!(found[0].others, all[2..]);
        let asked = "C1: is it the same camera?";
        assert!(item(&Doubt { is_failed: false, text: asked, others: vec![] }).contains("same camera?</p>"));
        let html = item(&found[0]);
        assert!(
            html.contains("C1: scatter 1.3 times. Do this.") && html.contains("<p>C2: scatter 1.5 times.</p>"),
            "{html}"
        );
    }
}
