//! What can be wrong with a recording.

use crate::{FileError, InputError, Problems};
use std::io;
use std::path::PathBuf;

/// A recording that cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file that its reader refuses.
    #[error(transparent)]
    Format(#[from] sinew_formats::Error),
    /// A recording that cannot be read as it stands.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A file or folder that cannot be read.
    #[error(transparent)]
    Io(#[from] FileError),
    /// A settings or set-up file with mistakes.
    #[error(transparent)]
    Config(#[from] Problems),
}

/// `From` of errors of the crates below, in the variant that holds them.
///
/// `errors_from_below!(Error::Input: sinew_formats::Error, FileError);` takes each of these into `Error::Input` by way of the error that the variant holds.
#[macro_export]
macro_rules! errors_from_below {
    ($error:ident::$variant:ident: $($below:ty),+ $(,)?) => {
        $(impl From<$below> for $error {
            fn from(error: $below) -> Self {
                Self::$variant(error.into())
            }
        })+
    };
}

impl Error {
    /// An [`Error::Io`] in the making: `map_err(Error::io("read", path))`.
    pub fn io(doing: &'static str, path: impl Into<PathBuf>) -> impl FnOnce(io::Error) -> Self {
        let on = FileError::on(doing, path);
        move |source| Self::Io(on(source))
    }
}
