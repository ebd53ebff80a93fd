//! Nearest known name, for "did you mean".
//!
//! Distance of optimal string alignment: insertions, deletions, substitutions and swaps of neighbours cost 1, letter
//! case and separators (`_`, `-`, space) nothing. A name is offered when at most a third of its letters, and at least
//! one, would have to change.
//!
//! ```
//! use sinew_formats::nearest::nearest;
//! assert_eq!(nearest("paticles", ["frames", "particles"]), Some("particles"));
//! assert_eq!(nearest("xyz", ["frames", "particles"]), None);
//! ```

/// Names longer than this are never compared: the table of distances grows with the product of lengths.
const MAX_LETTERS: usize = 64;

/// The known name nearest to `found`, if one is near enough to be meant; the first of equals.
pub fn nearest<'a>(found: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let letters = folded(found);
    if letters.is_empty() || letters.len() > MAX_LETTERS {
        return None;
    }
    known
        .into_iter()
        .filter_map(|name| {
            let candidate = folded(name);
            let allowed = (candidate.len().max(letters.len()) / 3).max(1);
            let distance = if candidate.len() > MAX_LETTERS { usize::MAX } else { distance(&letters, &candidate) };
            (distance <= allowed && distance < candidate.len()).then_some((distance, name))
        })
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

/// `; did you mean `x`?` or nothing, ready to be appended to a message.
pub(crate) fn suggestion(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|name| format!("; did you mean `{name}`?")).unwrap_or_default()
}

fn folded(name: &str) -> Vec<char> {
    name.chars().filter(|c| !matches!(c, '_' | '-' | ' ')).flat_map(char::to_lowercase).collect()
}

fn distance(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    let mut previous_letter = None;
    for (i, &x) in a.iter().enumerate() {
        let mut row = Vec::with_capacity(b.len() + 1);
        row.push(i + 1);
        for (j, &y) in b.iter().enumerate() {
            let mut cost = (above[j] + usize::from(x != y)).min(above[j + 1] + 1).min(row[j] + 1);
            if j > 0 && i > 0 && previous_letter == Some(y) && b[j - 1] == x {
                cost = cost.min(before[j - 1] + 1);
            }
            row.push(cost);
        }
        before = std::mem::replace(&mut above, row);
        previous_letter = Some(x);
    }
    above[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typing_errors_are_recognised() {
        for (found, meant) in [("parnet", "parent"), ("off-set", "offset"), ("Joint", "joints"), ("nme", "name")] {
            assert_eq!(nearest(found, ["name", "parent", "offset", "joints"]), Some(meant), "{found}");
        }
    }

    #[test]
    fn strangers_are_not() {
        for found in ["", "colour", "q", "日本"] {
            assert_eq!(nearest(found, ["name", "parent", "offset", "joints"]), None, "{found}");
        }
    }

    #[test]
    fn the_nearest_of_several_wins() {
        assert_eq!(nearest("halpe27", ["body_25", "halpe_26", "coco_17"]), Some("halpe_26"));
    }
}
