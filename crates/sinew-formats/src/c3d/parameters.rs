//! Parameters of a C3D file: groups of named values, kept as they are, and how they are looked up.

/// A group of parameters.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct C3dGroup {
    /// Name; empty where only parameters of the group are there.
    pub name: String,
    /// Description.
    pub description: String,
    /// Its parameters in the order of the file.
    pub parameters: Vec<C3dParameter>,
}

/// A parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct C3dParameter {
    /// Name.
    pub name: String,
    /// Description.
    pub description: String,
    /// Extents of its array, the fastest first; none for a single value. Of texts the first is their length in bytes.
    pub dimensions: Vec<u8>,
    /// Its values, the first dimension running fastest.
    pub values: C3dValues,
}

/// Values of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum C3dValues {
    /// Texts, without blanks at their ends.
    Texts(Vec<String>),
    /// Bytes.
    Bytes(Vec<u8>),
    /// Words of two bytes, signed; where a parameter has no sign, `as u16` gives its value.
    Integers(Vec<i16>),
    /// Reals.
    Reals(Vec<f64>),
}

/// The parameter of that name; case does not count.
#[must_use]
pub fn find<'a>(groups: &'a [C3dGroup], group: &str, name: &str) -> Option<&'a C3dParameter> {
    let mut named = groups.iter().filter(|found| found.name.eq_ignore_ascii_case(group));
    named.find_map(|group| group.parameters.iter().find(|found| found.name.eq_ignore_ascii_case(name)))
}

/// Continuations that are looked for: more than 65 535 labels, 255 in each, need.
const CONTINUATIONS: u32 = 300;

/// Values of a parameter and of its continuations: LABELS, LABELS2, LABELS3, …
fn continued<'a>(groups: &'a [C3dGroup], group: &str, name: &str) -> impl Iterator<Item = &'a C3dValues> {
    let named = move |number| if number == 1 { name.to_owned() } else { format!("{name}{number}") };
    let found = (1..=CONTINUATIONS).map_while(move |number| find(groups, group, &named(number)));
    found.map(|parameter| &parameter.values)
}

/// Texts of a parameter and of its continuations.
pub(super) fn texts<'a>(groups: &'a [C3dGroup], group: &str, name: &str) -> Vec<&'a str> {
    let mut all = Vec::new();
    for values in continued(groups, group, name) {
        if let C3dValues::Texts(texts) = values {
            all.extend(texts.iter().map(String::as_str));
        }
    }
    all
}

/// Numbers of a parameter and of its continuations; texts are none. Words have a sign.
pub(super) fn reals(groups: &[C3dGroup], group: &str, name: &str) -> Vec<f64> {
    numbers(groups, group, name, |word| word.into())
}

/// The same of words without sign.
pub(super) fn unsigned(groups: &[C3dGroup], group: &str, name: &str) -> Vec<f64> {
    numbers(groups, group, name, |word| f64::from(word as u16))
}

fn numbers(groups: &[C3dGroup], group: &str, name: &str, from_word: fn(i16) -> f64) -> Vec<f64> {
    let mut all = Vec::new();
    for values in continued(groups, group, name) {
        match values {
            C3dValues::Reals(values) => all.extend_from_slice(values),
            C3dValues::Integers(words) => all.extend(words.iter().map(|&word| from_word(word))),
            C3dValues::Bytes(values) => all.extend(values.iter().map(|&value| f64::from(value))),
            C3dValues::Texts(_) => {}
        }
    }
    all
}

/// A count, which has no sign. Two words are one number, the low word first.
pub(super) fn count(groups: &[C3dGroup], group: &str, name: &str) -> Option<u64> {
    match &find(groups, group, name)?.values {
        C3dValues::Integers(words) => match words[..] {
            [low, high] => Some(u64::from(low as u16) | u64::from(high as u16) << 16),
            [word, ..] => Some((word as u16).into()),
            [] => None,
        },
        C3dValues::Reals(values) => values.first().filter(|value| **value >= 0.0).map(|value| *value as u64),
        C3dValues::Bytes(values) => values.first().map(|value| u64::from(*value)),
        C3dValues::Texts(_) => None,
    }
}

/// Text of bytes: UTF-8, or else Latin-1, without the blanks and zeros at its ends.
pub(super) fn text(bytes: &[u8]) -> String {
    let text = std::str::from_utf8(bytes).map_or_else(|_| bytes.iter().map(|&b| char::from(b)).collect(), String::from);
    text.trim_matches(|c: char| c == '\0' || c.is_whitespace()).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn group(name: &str, parameters: &[(&str, C3dValues)]) -> C3dGroup {
        let parameter = |(name, values): &(&str, C3dValues)| C3dParameter {
            name: (*name).into(),
            description: String::new(),
            dimensions: vec![],
            values: values.clone(),
        };
        C3dGroup { name: name.into(), parameters: parameters.iter().map(parameter).collect(), ..C3dGroup::default() }
    }

    #[test]
    fn counts_have_no_sign_and_may_have_two_words() {
        let integers = |words: &[u16]| C3dValues::Integers(words.iter().map(|&word| word as i16).collect());
        let groups = [group(
            "Trial",
            &[("A", integers(&[65_535])), ("B", integers(&[4464, 1])), ("C", C3dValues::Reals(vec![7e4]))],
        )];
        let found = ["a", "b", "c", "d"].map(|name| count(&groups, "TRIAL", name));
        assert_eq!(found, [Some(65_535), Some(70_000), Some(70_000), None]);
    }

    #[test]
    fn labels_continue_under_the_next_number() {
        let label = |text: &str| C3dValues::Texts(vec![text.into()]);
        let groups = [group("POINT", &[("LABELS2", label("b")), ("LABELS", label("a")), ("LABELS4", label("d"))])];
        assert_eq!(texts(&groups, "POINT", "LABELS"), ["a", "b"]);
    }

    #[test]
    fn texts_are_utf8_or_latin1() {
        assert_eq!(text(b" R.Hip \0\0"), "R.Hip");
        assert_eq!(text("é ".as_bytes()), "é");
        assert_eq!(text(b"\xe9"), "é");
    }
}
