//! Columns of the tables that `sinew` writes.

use crate::Error;
use crate::read_error::ReadError;
use crate::results_error::{Expected, ResultsError};
use sinew_formats::source_text::MAX_TEXT_BYTES;
use sinew_formats::tidy_csv::{self, Cells};
use sinew_input::files::read_text;
use std::path::{Path, PathBuf};

/// A table with its place.
pub struct FolderTable {
    path: PathBuf,
    cells: Cells,
}

/// What the rows of one name hold: a series for each column.
pub type NamedSeries = (String, Vec<Vec<f64>>);

impl FolderTable {
    /// Reads a table of a folder.
    pub fn read(folder: &Path, file: &'static str) -> Result<Self, Error> {
        let path = folder.join(file);
        if !path.exists() {
            return Err(ReadError::NoFile { folder: folder.to_owned(), file }.into());
        }
        Self::open(&path)
    }

    /// Reads a table.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let cells = tidy_csv::read_cells(&path.display().to_string(), &read_text(path, MAX_TEXT_BYTES)?)?;
        Ok(Self { path: path.to_owned(), cells })
    }

    fn shown(&self) -> String {
        self.path.display().to_string()
    }

    /// Cells of the column of that name.
    pub fn texts(&self, wanted: &'static str) -> Result<Vec<String>, Error> {
        let place = self.place(wanted)?;
        Ok(self.cells.rows.iter().map(|(_, row)| row[place].clone()).collect())
    }

    fn place(&self, wanted: &'static str) -> Result<usize, Error> {
        let place = self.cells.columns.iter().position(|column| column == wanted);
        let columns = || self.cells.columns.clone();
        let lacking = || ResultsError::NoColumn { file: self.shown(), wanted, columns: columns() };
        Ok(place.ok_or_else(lacking)?)
    }

    /// Numbers of a column, NaN where a cell is empty.
    fn numbers(&self, place: usize) -> Result<Vec<f64>, Error> {
        let number = |(line, row): &(usize, Vec<String>)| match row[place].as_str() {
            "" => Ok(f64::NAN),
            cell => cell.parse().map_err(|_| {
                let (file, found) = (self.shown(), cell.to_owned());
                crate::Error::from(ResultsError::Cell { file, line: *line, found, expected: Expected::Number })
            }),
        };
        self.cells.rows.iter().map(number).collect()
    }

    /// Numbers of the column of that name.
    pub fn column(&self, wanted: &'static str) -> Result<Vec<f64>, Error> {
        self.numbers(self.place(wanted)?)
    }

    /// Numbers of a column that may be missing.
    pub fn optional(&self, wanted: &str) -> Result<Option<Vec<f64>>, Error> {
        let place = self.cells.columns.iter().position(|column| column == wanted);
        place.map(|place| self.numbers(place)).transpose()
    }

    /// Columns of a table with a row for each name in each of `frames` frames, the names in one order.
    pub fn by_name(
        &self,
        head: &'static str,
        wanted: &[&'static str],
        frames: usize,
    ) -> Result<Vec<NamedSeries>, Error> {
        let other = || Error::from(ReadError::OtherRun(self.path.clone()));
        let (rows, place) = (&self.cells.rows, self.place(head)?);
        let names = rows.len() / frames.max(1);
        if names == 0 || names * frames != rows.len() {
            return Err(other());
        }
        let columns = wanted.iter().map(|column| self.column(column)).collect::<Result<Vec<_>, _>>()?;
        let first = &rows[..names];
        if rows.chunks(names).any(|rows| rows.iter().zip(first).any(|(row, first)| row.1[place] != first.1[place])) {
            return Err(other());
        }
        let series =
            |name: usize| columns.iter().map(move |all| all.iter().skip(name).step_by(names).copied().collect());
        Ok(first.iter().enumerate().map(|(name, row)| (row.1[place].clone(), series(name).collect())).collect())
    }
}
