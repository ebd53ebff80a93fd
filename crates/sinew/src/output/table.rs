//! Comma-separated tables: a header row, numbers with all their digits, an empty cell for what a method does not have.

use super::partial::PartialFile;
use super::storage::Storage;
use crate::Error;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::PathBuf;
use std::sync::Arc;

/// A table being written.
pub(crate) struct Table {
    pub(crate) file: PartialFile,
    line: String,
}

/// A row being filled.
pub(crate) struct Row<'a> {
    table: &'a mut Table,
}

impl Table {
    pub(crate) fn create(
        storage: &Arc<dyn Storage>,
        path: PathBuf,
        columns: impl IntoIterator<Item = String>,
    ) -> Result<Self, Error> {
        let mut table = Self { file: PartialFile::create(storage, path)?, line: String::new() };
        let mut row = table.row();
        columns.into_iter().for_each(|column| {
            row.text(&column);
        });
        row.end()?;
        Ok(table)
    }

    pub(crate) fn row(&mut self) -> Row<'_> {
        self.line.clear();
        Row { table: self }
    }
}

impl Row<'_> {
    fn cell(&mut self) -> &mut String {
        if !self.table.line.is_empty() {
            self.table.line.push(',');
        }
        &mut self.table.line
    }

    pub(crate) fn text(&mut self, text: &str) -> &mut Self {
        let quoted = text.contains([',', '"', '\n', '\r']);
        let cell = self.cell();
        if quoted {
            let _ = write!(cell, "\"{}\"", text.replace('"', "\"\""));
        } else {
            cell.push_str(text);
        }
        self
    }

    pub(crate) fn integer(&mut self, value: u64) -> &mut Self {
        let _ = write!(self.cell(), "{value}");
        self
    }

    pub(crate) fn number(&mut self, value: f64) -> &mut Self {
        let _ = write!(self.cell(), "{value:?}");
        self
    }

    pub(crate) fn optional(&mut self, value: Option<f64>) -> &mut Self {
        match value {
            Some(value) => self.number(value),
            None => {
                self.cell();
                self
            }
        }
    }

    pub(crate) fn end(self) -> Result<(), Error> {
        let Table { file, line } = self.table;
        line.push('\n');
        file.write(|out| out.write_all(line.as_bytes()))
    }
}
