//! Everybody in a result folder, with the colour of each.

use crate::Error;
use sinew_results::people::person_folder;
use sinew_results::tracked::Tracked;
use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;

/// Colours that colour-blind people tell apart on dark and light ground: Okabe and Ito (2008), Color Universal Design, without black.
const PALETTE: [[u8; 3]; 7] =
    [[230, 159, 0], [86, 180, 233], [0, 158, 115], [240, 228, 66], [204, 121, 167], [213, 94, 0], [0, 114, 178]];

/// Colour of a person by number, from 1 on; an eighth has that of the first.
pub(super) const fn colour_of_person(number: usize) -> [u8; 3] {
    PALETTE[number.saturating_sub(1) % PALETTE.len()]
}

/// Number and poses of each tracked person of a folder `people`; else the one of the folder, without a number.
///
/// # Errors
/// Errors of [`Tracked::read`].
pub(super) fn read(results: &Path) -> Result<Vec<(Option<usize>, Tracked)>, Error> {
    let folders = (0..).map(|index| (index + 1, results.join(person_folder(index))));
    let tracked = folders.take_while(|(_, folder)| folder.is_dir());
    let tracked = tracked.filter(|(_, folder)| folder.join("summary.json").is_file());
    let people = tracked.map(|(number, folder)| Ok((Some(number), Tracked::read(&folder)?)));
    let people = people.collect::<Result<Vec<_>, Error>>()?;
    if people.is_empty() { Ok(vec![(None, Tracked::read(results)?)]) } else { Ok(people) }
}

/// Every n-th frame of a range in which somebody is.
///
/// # Errors
/// A range without a frame.
pub(super) fn frames(
    people: &[(Option<usize>, Tracked)],
    range: Option<&Range<u64>>,
    every: usize,
) -> Result<Vec<u64>, Error> {
    let mut all = BTreeSet::new();
    let mut refused = None;
    for (_, tracked) in people {
        match tracked.chosen(range, 1) {
            Ok(chosen) => all.extend(chosen.into_iter().map(|(number, _)| *number)),
            Err(error) => refused = Some(error),
        }
    }
    match refused.filter(|_| all.is_empty()) {
        Some(error) => Err(error.into()),
        None => Ok(all.into_iter().step_by(every.max(1)).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seven_people_have_seven_colours() {
        let colours: BTreeSet<[u8; 3]> = (1..=7).map(colour_of_person).collect();
        assert_eq!((colours.len(), colour_of_person(8)), (7, colour_of_person(1)));
    }
}
