//! `actions.csv`: which cluster and model moved each part of the body, by share of the particles.
//!
//! | a row is | columns |
//! |---|---|
//! | a way in which particles moved a part in a frame | frame, `time_s`, person, part, cluster, model, share |
//!
//! Ways that no particle has are left out, so that the shares of a part in a frame add to 1. Methods without action primitives have no such file.

use super::partial::{FilePlace, PartialFile};
use super::tables::{PERSON, integer};
use crate::Error;
use crate::estimate::{ActionShare, FrameEstimate, RunInfo};
use sinew_formats::tidy_csv::Cell;

/// Name of the table.
pub(crate) const NAME: &str = "actions.csv";

pub(crate) struct Actions {
    table: Option<PartialFile>,
    parts: Vec<String>,
}

impl Actions {
    pub(crate) fn open(place: &FilePlace<'_>, info: &RunInfo) -> Result<Self, Error> {
        let columns = ["frame", "time_s", "person", "part", "cluster", "model", "share"];
        let parts = info.acting_parts.clone();
        let table = (!parts.is_empty()).then(|| place.table(NAME, &columns)).transpose()?;
        Ok(Self { table, parts })
    }

    pub(crate) fn append(&mut self, estimate: &FrameEstimate) -> Result<(), Error> {
        let Some(table) = &mut self.table else { return Ok(()) };
        for ActionShare { part, cluster, model, share } in &estimate.actions {
            let Some(part) = self.parts.get(*part) else { continue };
            let cluster = cluster.map_or(Cell::Empty, |cluster| integer(cluster as u64));
            let (time, model) = (Cell::Number(estimate.time_s), Cell::Text(model.name()));
            let frame = integer(estimate.number);
            table.row(&[frame, time, PERSON, Cell::Text(part), cluster, model, Cell::Number(*share)])?;
        }
        Ok(())
    }

    /// The file, if the run has one.
    pub(crate) fn file(&mut self) -> Option<&mut PartialFile> {
        self.table.as_mut()
    }

    /// The file, if the run has one.
    pub(crate) fn finish(self) -> Option<PartialFile> {
        self.table
    }
}
