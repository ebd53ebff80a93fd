//! What a run needs to resume where it was stopped: `checkpoint.bin` in its output folder.
//!
//! ```text
//! "sinew checkpoint"  16 bytes
//! format version       4 bytes, little-endian
//! length of the body   8 bytes, little-endian
//! body                 [`Checkpoint`] in the wire format of postcard: numbers bit for bit
//! CRC-32 of all that   4 bytes, little-endian
//! ```
//!
//! Random streams are keyed by seed, purpose, frame and block, so no generator has a state. What is kept is what the next frame needs of those before it, how far every file was written, and what shows that the run that
//! resumes is the same one: versions, settings, hashes of the inputs. The file is written beside its place, synced and renamed, after the files that it speaks of were synced. Its size does not depend on the number of frames.
//!
//! A reader checks in this order: is it a checkpoint, is it whole, does the checksum fit, is the format known, can the body be decoded; each has a [`Problem`] of its own.

use super::error::TrackError;
use super::pipeline;
use crate::Error;
use crate::files::read_bytes;
use crate::input::flag::flag_with;
use crate::input::upright::FramesRead;
use serde::{Deserialize, Serialize};
use sinew_results::problem::{FORMAT, NAME, Problem, state};
use sinew_results::write_whole_in;
use sinew_results::{Claim, Position, Written};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

const MAGIC: &[u8; 16] = b"sinew checkpoint";
/// Bytes before the body and after it.
const HEAD: usize = 16 + 4 + 8;
const TAIL: usize = 4;
/// Larger files are none of ours: a hundred million particles fill more, which is reported when they are written.
const MOST_BYTES: u64 = 1 << 34;

/// Everything that a run needs to resume.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// Version of the program.
    pub program: String,
    /// Settings that change numbers, by name.
    pub settings: BTreeMap<String, String>,
    /// Instruction set.
    pub isa: String,
    /// Numbers of the frames to be tracked.
    pub frames: Range<u64>,
    /// How many of them are tracked.
    pub done: u64,
    /// Frames that the set-up read.
    pub read: FramesRead,
    /// Hashes of the inputs as far as they were read.
    pub inputs: BTreeMap<String, String>,
    /// The value of the set-up pass.
    pub setup_toml: String,
    /// Warnings so far that neither source nor tracker repeats.
    pub warnings: Vec<String>,
    /// `config.toml`, the settings with their origins as JSON, and their hash.
    pub texts: [String; 3],
    /// The tracker and what surrounds it; every file has it.
    pub pipeline: Option<pipeline::State>,
    /// How far the result files were written; none for a smoother, which writes them at the end.
    pub written: Option<Written>,
    /// How far a smoother's moments were written.
    pub spool: Option<Position>,
    /// The last frames of a fixed lag, the bits of their numbers.
    pub window: Option<Vec<u64>>,
}

impl Checkpoint {
    /// The file's bytes.
    ///
    /// # Errors
    /// A value that the wire format cannot hold.
    pub fn encode(&self) -> Result<Vec<u8>, Error> {
        let mut bytes = Vec::from(MAGIC);
        bytes.extend(FORMAT.to_le_bytes());
        bytes.extend([0; 8]);
        let body = postcard::to_extend(self, bytes);
        let mut bytes = body.map_err(TrackError::Encoding)?;
        let length = (bytes.len() - HEAD) as u64;
        bytes[HEAD - 8..HEAD].copy_from_slice(&length.to_le_bytes());
        let checksum = crc32fast::hash(&bytes);
        bytes.extend(checksum.to_le_bytes());
        Ok(bytes)
    }

    /// The checkpoint of a file's bytes.
    ///
    /// # Errors
    /// Every [`Problem`] that shows without knowing the run.
    pub fn decode(bytes: &[u8]) -> Result<Self, Problem> {
        let found = bytes.len() as u64;
        if !bytes.starts_with(&MAGIC[..bytes.len().min(MAGIC.len())]) {
            return Err(Problem::Foreign);
        }
        let shortest = (HEAD + TAIL) as u64;
        let Some((head, rest)) = bytes.split_first_chunk::<HEAD>().filter(|_| found >= shortest) else {
            return Err(Problem::Length { found, expected: shortest });
        };
        let [.., a, b, c, d, e, f, g, h] = *head;
        let expected = u64::from_le_bytes([a, b, c, d, e, f, g, h]).saturating_add(shortest);
        let Some((body, tail)) = rest.split_last_chunk::<TAIL>().filter(|_| found == expected) else {
            return Err(Problem::Length { found, expected });
        };
        let (found, expected) = (crc32fast::hash(&bytes[..bytes.len() - TAIL]), u32::from_le_bytes(*tail));
        if found != expected {
            return Err(Problem::Checksum { found, expected });
        }
        let found = u32::from_le_bytes([head[16], head[17], head[18], head[19]]);
        if found != FORMAT {
            return Err(Problem::Format { found });
        }
        let (checkpoint, rest): (Self, _) =
            postcard::take_from_bytes(body).map_err(|error| state("body", error, "a checkpoint"))?;
        match rest.len() {
            0 => Ok(checkpoint),
            more => Err(state("body", format!("{more} bytes more"), "its end")),
        }
    }
}

/// Reads the checkpoint of a folder.
///
/// # Errors
/// [`sinew_results::Error::Checkpoint`] and A file that cannot be read or written.
pub fn read(folder: &Path) -> Result<Checkpoint, Error> {
    let path = folder.join(NAME);
    if !path.exists() {
        return Err(sinew_results::Error::checkpoint(folder, Problem::Missing).into());
    }
    let bytes = read_bytes(&path, MOST_BYTES)?;
    let checkpoint = Checkpoint::decode(&bytes).map_err(|problem| sinew_results::Error::checkpoint(folder, problem))?;
    if checkpoint.program != env!("CARGO_PKG_VERSION") {
        return Err(sinew_results::Error::checkpoint(folder, Problem::Program { found: checkpoint.program }).into());
    }
    Ok(checkpoint)
}

/// Writes the checkpoint of a claimed folder, in place of the one before.
///
/// # Errors
/// A file that cannot be read or written with the path; the one before is then still there.
pub(crate) fn write(claim: &Claim, checkpoint: &Checkpoint) -> Result<(), Error> {
    // The names of the files that it speaks of before its own.
    claim.storage().sync(claim.folder()).map_err(Error::io("write", claim.folder()))?;
    Ok(write_whole_in(claim.storage(), &claim.folder().join(NAME), &checkpoint.encode()?)?)
}

impl Checkpoint {
    /// Refuses a run with other settings or on another instruction set than the one that was stopped.
    ///
    /// # Errors
    /// [`Problem::Settings`] with all that differ.
    pub fn check_settings(&self, now: &BTreeMap<String, String>, isa: &str) -> Result<(), Problem> {
        let mut differing = differences(&self.settings, now, |key, before, now| match (before, now) {
            (Some(before), Some(now)) => format!("`{key}` was {before} and is {now}"),
            (Some(before), None) => format!("`{key}` was {before} and is not set"),
            (None, now) => format!("`{key}` was not set and is {}", now.unwrap_or_default()),
        });
        if self.isa != isa {
            let again = flag_with("simd", &self.isa);
            differing.push(format!("the instruction set was {} and is {isa} ({again})", self.isa));
        }
        if differing.is_empty() { Ok(()) } else { Err(Problem::Settings(differing)) }
    }

    /// Refuses other data than the run that was stopped had.
    ///
    /// # Errors
    /// [`Problem::Inputs`] with all that differ.
    pub fn check_inputs(&self, now: &BTreeMap<String, String>, frames: &Range<u64>) -> Result<(), Problem> {
        let mut differing = differences(&self.inputs, now, |name, before, now| match (before, now) {
            (Some(_), Some(_)) => format!("the content of `{name}` has changed"),
            (Some(_), None) => format!("`{name}` was given and is not"),
            (None, _) => format!("`{name}` was not given and is"),
        });
        if self.frames != *frames {
            let (was, is) = (&self.frames, frames);
            differing.push(format!("the frames were {}..{} and are {}..{}", was.start, was.end, is.start, is.end));
        }
        if !differing.is_empty() {
            return Err(Problem::Inputs(differing));
        }
        let total = frames.end.saturating_sub(frames.start);
        if self.done <= total { Ok(()) } else { Err(state("number of frames", self.done, format!("{total} at most"))) }
    }
}

/// What differs between two maps, in words made from the key, the former value and the present one.
fn differences(
    before: &BTreeMap<String, String>,
    now: &BTreeMap<String, String>,
    describe: impl Fn(&str, Option<&str>, Option<&str>) -> String,
) -> Vec<String> {
    let mut keys: Vec<&String> = before.keys().chain(now.keys()).collect();
    keys.sort();
    keys.dedup();
    let value = |map: &BTreeMap<String, String>, key: &String| map.get(key).cloned();
    keys.into_iter()
        .map(|key| (key, value(before, key), value(now, key)))
        .filter(|(_, before, now)| before != now)
        .map(|(key, before, now)| describe(key, before.as_deref(), now.as_deref()))
        .collect()
}
