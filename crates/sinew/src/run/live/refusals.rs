//! Lines that are refused: each is answered, each kind is said once, and all are counted.

use std::collections::BTreeMap;

/// Why a line is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// No frame can be read from it.
    Malformed,
    /// It is longer than any frame.
    TooLong,
    /// Its frame came before.
    Repeated,
    /// A later frame came before.
    Late,
    /// Its frame is far ahead of the last one.
    FarAhead,
    /// Nobody was seen yet, so that it is not known what the keypoints are.
    NobodyYet,
}

impl Kind {
    const fn words(self) -> &'static str {
        match self {
            Self::Malformed => "could not be read",
            Self::TooLong => "were too long",
            Self::Repeated => "repeated a frame",
            Self::Late => "came after a later frame",
            Self::FarAhead => "were far ahead of the frame before",
            Self::NobodyYet => "came before anybody was seen",
        }
    }
}

/// Counts, with the first of each kind in words.
#[derive(Debug, Default)]
pub(super) struct Refusals {
    of: BTreeMap<Kind, (u64, String)>,
    unsaid: Vec<String>,
}

impl Refusals {
    /// Counts a line.
    pub(super) fn add(&mut self, kind: Kind, text: &str) {
        let (count, _) = self.of.entry(kind).or_insert_with(|| {
            self.unsaid.push(format!("refused: {text}"));
            (0, text.to_owned())
        });
        *count += 1;
    }

    /// The first of each kind that was not said yet.
    pub(super) fn take_unsaid(&mut self) -> Vec<String> {
        std::mem::take(&mut self.unsaid)
    }

    /// A sentence for each kind.
    pub(super) fn warnings(&self) -> Vec<String> {
        let sentence = |(kind, (count, first)): (&Kind, &(u64, String))| {
            format!("{count} lines {} and were refused; the first: {first}", kind.words())
        };
        self.of.iter().map(sentence).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_kind_is_said_once_and_counted() {
        let mut refusals = Refusals::default();
        refusals.add(Kind::Late, "frame 3 came after frame 5");
        assert_eq!(refusals.take_unsaid(), ["refused: frame 3 came after frame 5"]);
        refusals.add(Kind::Late, "frame 4 came after frame 5");
        assert!(refusals.take_unsaid().is_empty());
        let expected = "2 lines came after a later frame and were refused; the first: frame 3 came after frame 5";
        assert_eq!(refusals.warnings(), [expected]);
    }
}
