//! What the rules do not hold for yet, each with its reason; whatever holds again must leave its list.

use super::workspace::Violation;

/// What a violation is known as, and why it may stay for now.
pub type Exception = (&'static str, &'static str);

/// Files with too many lines.
pub const LARGE_FILES: &[Exception] = &[(
    "crates/sinew-core/src/lanes.rs",
    "the one file of lane types: three instruction sets, the same operators each; `unsafe` has one home",
)];
/// Crates with too many lines.
pub const LARGE_CRATES: &[Exception] = &[("crates/sinew-studies", "experiments; no user builds it")];
/// Files with words that made strangers stumble.
pub const ODD_WORDS: &[Exception] = &[(
    "crates/sinew-formats/src/zarr/inference_data.rs",
    "the text is an attribute in files that are written already",
)];

/// The violations that are not excepted, and one for each exception that is none any more.
pub fn apply(excepted: &[Exception], found: Vec<Violation>) -> Vec<Violation> {
    let stale = excepted.iter().filter(|(key, _)| !found.iter().any(|violation| violation.key == *key));
    let what = "keeps the rule: take it off its list in xtask/src/tidy/exceptions.rs";
    let mut left: Vec<Violation> = stale.map(|(key, _)| Violation::in_file(key, what)).collect();
    left.extend(found.into_iter().filter(|violation| !excepted.iter().any(|(key, _)| violation.key == *key)));
    left
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exceptions_hold_for_what_they_name_and_for_nothing_else() {
        let long = |name: &str| Violation::at("a.rs", 3, "long").known_as(name);
        let excepted: [Exception; 1] = [("a.rs: f", "to be split")];
        assert_eq!(apply(&excepted, vec![long("a.rs: f"), long("a.rs: g")]), [long("a.rs: g")]);
    }

    #[test]
    fn exceptions_that_are_none_any_more_are_caught() {
        let found =
            apply(&[("a.rs", "to be split"), ("b.rs", "to be split")], vec![Violation::in_file("b.rs", "large")]);
        assert_eq!(found.iter().map(|violation| violation.path.as_str()).collect::<Vec<_>>(), ["a.rs"]);
    }
}
