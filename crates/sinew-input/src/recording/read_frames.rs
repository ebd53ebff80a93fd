//! Keypoint files that were read before: the passes of a run share what one of them has read.
//!
//! Up to [`MOST_BYTES`] of keypoints stay in memory; files beyond are read again by each pass.

use sinew_formats::openpose::{Keypoint, OpenposeFrame};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Bytes of keypoints that are kept: a person seen by four cameras at 60 frames a second for half an hour.
pub const MOST_BYTES: usize = 1 << 28;

/// Frames by their files, for recordings that are opened with the same confidence scale.
#[derive(Debug, Default)]
pub struct ReadFrames(Mutex<Kept>);

#[derive(Debug, Default)]
struct Kept {
    frames: HashMap<PathBuf, Hashed>,
    bytes: usize,
    read: u64,
}

/// A frame, with the hash of its file and the start value of that hash.
#[derive(Clone, Debug)]
struct Hashed {
    frame: OpenposeFrame,
    begun: u64,
    hash: u64,
}

impl ReadFrames {
    /// The frame of a file and the hash of the file with start value `begun`: from memory, else by `read`.
    ///
    /// # Errors
    /// Those of `read`.
    pub(super) fn frame<E>(
        &self,
        path: &Path,
        begun: u64,
        read: impl FnOnce() -> Result<(OpenposeFrame, u64), E>,
    ) -> Result<(OpenposeFrame, u64), E> {
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(Hashed { frame, hash, .. }) = kept().frames.get(path).filter(|kept| kept.begun == begun) {
            return Ok((frame.clone(), *hash));
        }
        let (frame, hash) = read()?;
        let mut kept = kept();
        kept.read += 1;
        let keypoints: usize = frame.people.iter().map(|person| person.keypoints.len()).sum();
        let bytes = size_of::<Hashed>() + path.as_os_str().len() + keypoints * size_of::<Option<Keypoint>>();
        if kept.bytes + bytes <= MOST_BYTES {
            kept.bytes += bytes;
            kept.frames.insert(path.to_owned(), Hashed { frame: frame.clone(), begun, hash });
        }
        Ok((frame, hash))
    }

    /// How often a file was read.
    #[must_use]
    pub fn files_read(&self) -> u64 {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).read
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_once_for_each_beginning_of_its_hash() {
        let frames = ReadFrames::default();
        let read =
            |begun| frames.frame(Path::new("a.json"), begun, || Ok::<_, ()>((OpenposeFrame::default(), begun + 1)));
        assert_eq!([read(1), read(1), read(7)].map(|read| read.unwrap().1), [2, 2, 8]);
        assert_eq!(frames.files_read(), 2);
        let refused = frames.frame(Path::new("b.json"), 1, || Err("no"));
        assert_eq!((refused, frames.files_read()), (Err("no"), 2));
    }
}
