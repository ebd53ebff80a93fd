//! Means over recordings and seeds: one table of simulated walkers, one of the real recording.

use super::entries::{ENTRIES, Entry};
use super::films::{Film, key};
use super::worth::{Worth, held_mm};
use crate::support::outcome::Outcome;
use crate::support::store::Store;
use crate::support::table::{header, row, with_spread};
use sinew::methods::{Gives, METHODS};
use sinew_tests::finding::mean_and_error;
use std::fmt::Write as _;

/// Mean over recordings and its standard error; of one recording over seeds.
fn over(store: &Store, films: &[&Film], entry: &Entry, seeds: u64, of: fn(&Worth) -> f64) -> Outcome<[f64; 2]> {
    let mut each: Vec<Vec<f64>> = vec![];
    for film in films {
        let value = |seed| {
            let cell = store.get(&key(film, entry, seed)).ok_or("a run is missing")?;
            Ok(of(&Worth::from_json(cell)))
        };
        each.push((1..=seeds).map(value).collect::<Outcome<_>>()?);
    }
    Ok(match &each[..] {
        [single] => mean_and_error(single),
        _ => mean_and_error(&each.iter().map(|values| mean_and_error(values)[0]).collect::<Vec<_>>()),
    })
}

/// Both tables.
pub(super) fn text(store: &Store, films: &[Film], seeds: u64) -> Outcome<String> {
    let (real, simulated): (Vec<&Film>, Vec<&Film>) = films.iter().partition(|film| film.is_real());
    let mut out = String::new();
    for (title, films) in [("Simulated walkers", simulated), ("The real recording", real)] {
        let _ = writeln!(out, "## {title}\n");
        out += &header(
            "| method | observes | learned model | error, mm | frames below 150 mm, % | begun again, % | 90 % intervals hold, % | frames a second |",
        );
        for entry in &ENTRIES {
            let about = METHODS.iter().find(|method| method.name == entry.method).ok_or("no such method")?;
            let mean = |of| over(store, &films, entry, seeds, of);
            let covered = match about.gives {
                Gives::Search => "–".to_owned(),
                _ => with_spread(mean(|worth| 100.0 * worth.covered)?, 0),
            };
            row!(
                out,
                "`{}` | {} | {} | {} | {:.0} | {:.0} | {covered} | {:.0}",
                entry.method,
                entry.seen.name(),
                entry.learned.map_or("–", |learned| learned.name()),
                with_spread(mean(|worth| worth.error_mm)?, 0),
                mean(|worth| 100.0 * worth.followed)?[0],
                mean(|worth| 100.0 * worth.restarted)?[0],
                mean(|worth| worth.frames_per_second)?[0]
            );
        }
        let held = films.iter().map(|film| held_mm(&film.truth(1)?)).collect::<Outcome<Vec<f64>>>()?;
        let held = held.iter().sum::<f64>() / held.len() as f64;
        let _ = writeln!(out, "| first pose held at the true hips | – | – | {held:.0} | – | – | – | – |\n");
    }
    Ok(out)
}
