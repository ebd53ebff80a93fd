//! Reading whole files: size checked before memory is taken, text decoded, every failure with its path.

use crate::Error;
use crate::folder_contents::folder_contents;
use crate::input_error::InputError;
use sinew_formats::source_text::{check_size, decode};
use sinew_formats::{Error as FormatError, Place};
use std::fs;
use std::io::{self, Read as _};
use std::path::Path;

/// Bytes that show of which kind a file is.
const BEGINNING: usize = 1 << 16;

/// Opens a file for reading. A pipe or a device is refused: to open or read it may never end.
///
/// # Errors
/// Errors of the system; [`io::ErrorKind::InvalidInput`] for what is neither file nor folder.
pub fn open(path: &Path) -> io::Result<fs::File> {
    let kind = fs::metadata(path)?.file_type();
    if !kind.is_file() && !kind.is_dir() {
        let what = "it is a pipe or a device; expected a file: write what it gives into one";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, what));
    }
    fs::File::open(path)
}

/// Bytes of a file of at most `limit` bytes.
///
/// # Errors
/// [`Error::Io`] with the path, as [`open`], [`Error::Input`] for a folder, [`Error::Format`] for a file that is too large.
pub fn read_bytes(path: &Path, limit: u64) -> Result<Vec<u8>, Error> {
    read_checked(path, limit, |_| Ok(()))
}

/// As [`read_bytes`]; `check` sees the beginning before the rest is read.
fn read_checked(path: &Path, limit: u64, check: impl FnOnce(&[u8]) -> Result<(), Error>) -> Result<Vec<u8>, Error> {
    if path.is_dir() {
        return Err(InputError::FolderForFile { folder: path.to_owned(), contents: folder_contents(path) }.into());
    }
    let mut file = open(path).map_err(Error::io("read", path))?;
    let size = file.metadata().map_err(Error::io("read", path))?.len();
    let shown = path.display().to_string();
    check_size(&shown, size, limit)?;
    let mut bytes = Vec::new();
    (&mut file).take(BEGINNING as u64).read_to_end(&mut bytes).map_err(Error::io("read", path))?;
    check(&bytes)?;
    file.take((limit + 1).saturating_sub(bytes.len() as u64))
        .read_to_end(&mut bytes)
        .map_err(Error::io("read", path))?;
    check_size(&shown, bytes.len() as u64, limit)?;
    Ok(bytes)
}

/// Text of a file of at most `limit` bytes.
///
/// # Errors
/// As [`read_bytes`], and for bytes that are not UTF-8. Of a film or another file that is no text, the beginning alone is read.
pub fn read_text(path: &Path, limit: u64) -> Result<String, Error> {
    let name = path.display().to_string();
    let bytes = read_checked(path, limit, |beginning| {
        let Some(zero) = beginning.iter().position(|byte| *byte == 0) else { return Ok(()) };
        decode(&name, &beginning[..zero], limit)?;
        let (place, found, expected) = (Place::file(&name), "byte 0x00".into(), "text".into());
        Err(FormatError::Syntax { place, found, expected }.into())
    })?;
    Ok(decode(&name, &bytes, limit)?.to_owned())
}

/// The first bytes of a file, as far as they are text: enough to see of which kind it is.
///
/// # Errors
/// [`Error::Io`] with the path, as [`open`].
pub fn read_beginning(path: &Path) -> Result<String, Error> {
    let file = open(path).map_err(Error::io("read", path))?;
    let mut bytes = Vec::new();
    file.take(BEGINNING as u64).read_to_end(&mut bytes).map_err(Error::io("read", path))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Start value of [`fnv`].
pub const FNV_START: u64 = 0xcbf2_9ce4_8422_2325;

/// Folds bytes into a hash (FNV-1a, 64 bits; Fowler, Noll & Vo): to distinguish files and settings; it keeps no secrets.
#[must_use]
pub fn fnv(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(error: &Error) -> String {
        let cause = std::error::Error::source(error).map(|cause| format!(": {cause}")).unwrap_or_default();
        format!("{error}{cause}")
    }

    #[test]
    fn text_is_read_without_its_mark() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("a.txt");
        let long = "x".repeat(3 * BEGINNING);
        for text in ["", "caf\u{e9}", &long] {
            for mark in ["", "\u{feff}"] {
                fs::write(&path, format!("{mark}{text}")).unwrap();
                assert_eq!(read_text(&path, 1 << 20).unwrap(), text);
            }
        }
        assert!(words(&read_text(&path, 100).unwrap_err()).contains("at most 100 bytes are read"));
        fs::write(&path, b"caf\xE9\0").unwrap();
        assert!(words(&read_text(&path, 100).unwrap_err()).contains("byte 0xE9 at line 1 is not UTF-8"));
    }

    /// Files with holes: a film larger than what is read, and one that would fit.
    #[test]
    fn only_the_beginning_of_a_film_is_read() {
        let root = tempfile::tempdir().unwrap();
        let path = root.path().join("film.trc");
        for (bytes, said) in
            [(3 << 30, "the file has 3.2 GB; at most 2.1 GB are read"), (1 << 30, "byte 0x00; expected text")]
        {
            fs::File::create(&path).unwrap().set_len(bytes).unwrap();
            assert!(words(&read_text(&path, 2 << 30).unwrap_err()).ends_with(said));
        }
    }

    #[cfg(unix)]
    #[test]
    fn pipes_and_devices_are_refused_in_words() {
        let root = tempfile::tempdir().unwrap();
        let pipe = root.path().join("pipe.json");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        for path in [pipe.as_path(), Path::new("/dev/zero")] {
            let said = format!(
                "cannot read `{}`: it is a pipe or a device; expected a file: write what it gives into one",
                path.display()
            );
            for read in [read_text(path, 100), read_beginning(path), read_bytes(path, 100).map(|_| String::new())] {
                assert_eq!(words(&read.unwrap_err()), said);
            }
        }
    }
}
