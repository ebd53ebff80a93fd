//! Code with all drawn mutants in it, each behind a switch, so that one build serves all.

use super::candidates::{Mutant, SWITCH};
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// Variable that says which mutant is on; none where it is not set.
pub const VARIABLE: &str = "DRAWN_MUTANT";

/// The function that every mutant asks; it stands at the end of each crate's root.
pub const FUNCTION: &str = r#"
/// Whether the mutant of this number is on.
pub(crate) fn drawn_mutant(number: usize) -> bool {
    static CHOSEN: std::sync::LazyLock<Option<usize>> =
        std::sync::LazyLock::new(|| std::env::var("DRAWN_MUTANT").ok().and_then(|text| text.parse().ok()));
    *CHOSEN == Some(number)
}
"#;

/// A file with its mutants, and the lines that each has taken.
pub struct Switched {
    /// Text of the file.
    pub code: String,
    /// Lines from 1, by the number of the mutant.
    pub lines: BTreeMap<usize, RangeInclusive<usize>>,
}

/// Whether two places have a byte in common, or one lies inside the other.
pub fn collide(a: &Mutant, b: &Mutant) -> bool {
    let (a, b) = (&a.place, &b.place);
    let is_inside = |at: usize, place: &std::ops::Range<usize>| place.start < at && at < place.end;
    a.start < b.end && b.start < a.end || is_inside(a.start, b) || is_inside(b.start, a)
}

/// Puts mutants of one file, none of which [`collide`], into its text.
pub fn switched(code: &str, mutants: &BTreeMap<usize, &Mutant>) -> Switched {
    let mut ordered: Vec<(&usize, &&Mutant)> = mutants.iter().collect();
    ordered.sort_by_key(|(number, mutant)| (mutant.place.start, mutant.place.end, **number));
    let mut result = Switched { code: String::new(), lines: BTreeMap::new() };
    let mut at = 0;
    for (number, mutant) in ordered {
        result.code += &code[at..mutant.place.start];
        let line = |code: &str| 1 + code.matches('\n').count();
        let first = line(&result.code);
        result.code += &mutant.instead.replace(SWITCH, &format!("crate::drawn_mutant({number})"));
        result.lines.insert(*number, first..=line(&result.code));
        at = mutant.place.end;
    }
    result.code += &code[at..];
    result
}

#[cfg(test)]
mod tests {
    use super::super::candidates::find;
    use super::*;

    #[test]
    fn one_of_them_is_on_and_the_rest_is_as_it_was() {
        let code = "fn f(a: bool) -> bool {\n    !a\n}\nfn g() {}\n";
        let found = find("x.rs", code, &Default::default());
        let chosen = BTreeMap::from([(3, &found[2]), (4, &found[0]), (8, &found[3])]);
        let switched = switched(code, &chosen);
        assert_eq!(
            switched.code,
            "fn f(a: bool) -> bool { if crate::drawn_mutant(4) { return true; } \n    (if crate::drawn_mutant(3) { a } else { !a })\n}\n\
             fn g() { if crate::drawn_mutant(8) { return (); } }\n"
        );
        assert_eq!(switched.lines, BTreeMap::from([(4, 1..=1), (3, 2..=2), (8, 4..=4)]));
        assert!(FUNCTION.contains(VARIABLE));
        // Two answers stand one after the other; an operator is exchanged once.
        assert!(!collide(&found[0], &found[1]) && collide(&found[2], &found[2]));
    }
}
