//! The whole chunks of `posterior.zarr`, listed in a file of the program's own, `chunks.partial`.
//!
//! Their number grows with the recording, and a checkpoint shall not.
//!
//! A row a chunk: CRC-32 in hexadecimal, bytes, key. The file itself has a [`super::Position`].

use super::partial::{FilePlace, PartialFile, checksum_of};
use crate::Error;
use crate::problem::Problem;
use crate::storage::Storage;
use std::io::{self, BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::sync::Arc;

/// Name of the file, but for `.partial`: it never gets another.
const NAME: &str = "chunks";

pub(crate) struct ChunkList {
    pub(crate) file: PartialFile,
}

impl ChunkList {
    pub(crate) fn open(place: &FilePlace<'_>) -> Result<Self, Error> {
        Ok(Self { file: place.file(NAME, |_| Ok(()))? })
    }

    /// The row of a chunk.
    pub(crate) fn row(key: &str, bytes: &[u8]) -> Vec<u8> {
        format!("{:08x} {} {key}\n", crc32fast::hash(bytes), bytes.len()).into_bytes()
    }

    pub(crate) fn append(&mut self, rows: &[u8]) -> Result<(), Error> {
        self.file.write(|out| out.write_all(rows))
    }

    /// Refuses a store in `partial` that lacks a chunk of the list or has another in its place.
    pub(crate) fn check(&mut self, storage: &Arc<dyn Storage>, folder: &Path, partial: &Path) -> Result<(), Error> {
        for row in BufReader::new(self.file.read_back()?).lines() {
            let row = row.map_err(Error::io("read", NAME))?;
            let Some((expected, key)) = row.rsplit_once(' ') else { continue };
            let path = partial.join(key);
            let found = match storage.read(&path) {
                Ok(mut chunk) => {
                    let mut checksum = crc32fast::Hasher::new();
                    let length = checksum_of(&mut chunk, &mut checksum).map_err(Error::io("read", &path))?;
                    Some(format!("{:08x} {length}", checksum.finalize()))
                }
                Err(error) if error.kind() == io::ErrorKind::NotFound => None,
                Err(error) => return Err(Error::io("read", &path)(error)),
            };
            if found.as_deref() != Some(expected) {
                return Err(Error::checkpoint(folder, Problem::Changed { path }));
            }
        }
        Ok(())
    }
}
