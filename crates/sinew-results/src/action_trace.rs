//! The action trace of a run: what share of the particles each cluster moved, part by part over time.
//!
//! It is what `actions.csv` holds, without the difference between the two models of a cluster: next and step are one, and a walk is no action primitive whatever cluster its particle was matched with.

use crate::Error;
use crate::results_error::{Expected, ResultsError};
use crate::tracked::{bad_cell, column};
use sinew_dynamics::primitives::switching::Branch;
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_formats::tidy_csv;
use sinew_input::files;
use std::path::Path;

/// Shares of the particles that clusters moved; `None` is a random walk.
pub type Shares = Vec<(Option<usize>, f64)>;

/// The actions of one part of the body.
#[derive(Clone, Debug, PartialEq)]
pub struct PartActions {
    /// Name of the part.
    pub name: String,
    /// Shares in each frame, which add to 1; empty where nothing is known of the part.
    pub frames: Vec<Shares>,
}

/// The actions of all parts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ActionTrace {
    /// Time of each frame, seconds.
    pub time_s: Vec<f64>,
    /// The parts.
    pub parts: Vec<PartActions>,
}

/// How far the shares of a part may be from 1 in all.
const ROUNDING: f64 = 1e-6;

/// Adds what a model of a cluster moved.
pub fn add_share(shares: &mut Shares, cluster: Option<usize>, model: Branch, share: f64) {
    let by = cluster.filter(|_| model != Branch::Walk);
    match shares.iter_mut().find(|(known, _)| *known == by) {
        Some((_, sum)) => *sum += share,
        None => shares.push((by, share)),
    }
}

impl ActionTrace {
    /// Reads `actions.csv`.
    ///
    /// # Errors
    /// A file that cannot be read, lacks a column, has cells of another kind, times that do not rise, or shares that do not add to 1.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let name = path.display().to_string();
        let table = tidy_csv::read_cells(&name, &files::read_text(path, MAX_TEXT_BYTES)?)?;
        let place = |wanted| column(&name, &table, wanted);
        let places = [place("time_s")?, place("part")?, place("cluster")?, place("model")?, place("share")?];
        let mut trace = Self::default();
        for (line, row) in &table.rows {
            let [time, part, cluster, model, share] = places.map(|column| row[column].as_str());
            let bad = |found: &str, expected| bad_cell(&name, *line, found, expected);
            let last = trace.time_s.last().copied().unwrap_or(f64::NEG_INFINITY);
            let time_s = time.parse().ok().filter(|time_s: &f64| time_s.is_finite() && *time_s >= last);
            let time_s = time_s.ok_or_else(|| bad(time, Expected::LaterTime))?;
            let number = match cluster {
                "" => None,
                _ => Some(cluster.parse().map_err(|_| bad(cluster, Expected::Cluster))?),
            };
            let branch = Branch::ALL.into_iter().find(|branch| branch.name() == model);
            let branch = branch.ok_or_else(|| bad(model, Expected::Model))?;
            let value = share.parse().ok().filter(|share| (0.0..=1.0 + ROUNDING).contains(share));
            let value = value.ok_or_else(|| bad(share, Expected::Share))?;
            add_share(trace.shares_at(time_s, part), number, branch, value);
        }
        trace.parts.iter_mut().for_each(|part| part.frames.resize(trace.time_s.len(), vec![]));
        trace.check(&name)?;
        Ok(trace)
    }

    /// The shares of a part at the last time or a later one.
    fn shares_at(&mut self, time_s: f64, name: &str) -> &mut Shares {
        if self.time_s.last() != Some(&time_s) {
            self.time_s.push(time_s);
        }
        let known = self.parts.iter().position(|part| part.name == name);
        let index = known.unwrap_or_else(|| {
            self.parts.push(PartActions { name: name.into(), frames: vec![] });
            self.parts.len() - 1
        });
        let (frames, last) = (&mut self.parts[index].frames, self.time_s.len() - 1);
        frames.resize(last + 1, vec![]);
        &mut frames[last]
    }

    fn check(&self, file: &str) -> Result<(), ResultsError> {
        for PartActions { name, frames } in &self.parts {
            for (shares, time_s) in frames.iter().zip(&self.time_s).filter(|(shares, _)| !shares.is_empty()) {
                let sum: f64 = shares.iter().map(|(_, share)| share).sum();
                if (sum - 1.0).abs() > ROUNDING {
                    return Err(ResultsError::Shares { file: file.into(), part: name.clone(), time_s: *time_s, sum });
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "frame,time_s,person,part,cluster,model,share\n";

    fn read(rows: &str) -> Result<ActionTrace, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("actions.csv");
        std::fs::write(&path, HEADER.to_owned() + rows).unwrap();
        ActionTrace::read(&path).map_err(|error| {
            let text = error.to_string();
            text.replace(&folder.path().display().to_string(), "")
        })
    }

    #[test]
    fn models_of_a_cluster_are_one_and_walks_are_none() {
        let rows = "3,0.1,0,torso,,walk,1\n\
                    4,0.2,0,torso,5,next,0.25\n4,0.2,0,torso,5,step,0.25\n4,0.2,0,torso,5,walk,0.5\n\
                    4,0.2,0,head,7,step,1\n";
        let trace = read(rows).unwrap();
        assert_eq!(trace.time_s, [0.1, 0.2]);
        let [torso, head] = &trace.parts[..] else { panic!("{trace:?}") };
        assert_eq!(torso.frames, [vec![(None, 1.0)], vec![(Some(5), 0.5), (None, 0.5)]]);
        assert_eq!(head.frames, [vec![], vec![(Some(7), 1.0)]]);
    }

    #[test]
    fn bad_files_are_refused_by_place_and_reason() {
        let refused = |rows: &str, words: &str| assert_eq!(read(rows).unwrap_err(), format!("/actions.csv{words}"));
        refused("1,0.1,0,torso,x,next,1\n", ":2: `x`; must be the number of a cluster, or nothing");
        refused("1,0.1,0,torso,1,jump,1\n", ":2: `jump`; must be `next`, `step` or `walk`");
        refused("1,0.1,0,torso,1,next,2\n", ":2: `2`; must be a share from 0 to 1");
        refused(
            "1,0.1,0,a,1,next,1\n2,0.05,0,a,1,next,1\n",
            ":3: `0.05`; must be a time in seconds, not before the row above",
        );
        refused("1,0.5,0,head,1,next,0.5\n", ": the shares of part `head` at 0.5 s add to 0.5; must be 1");
    }
}
