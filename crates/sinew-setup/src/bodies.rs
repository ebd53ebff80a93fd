//! Bodies by name or from a body file.

pub(crate) mod error;

pub use error::UnknownBody;

use crate::Error;
use crate::{Body, FileBody};
use sinew_body::{KinematicTree, Proportions};
use sinew_formats::nearest::nearest;
use sinew_formats::source_text::MAX_CONFIG_BYTES;
use sinew_input::files;
use std::path::Path;

/// Names of the bodies that come with the project.
pub const NAMES: [&str; 4] = ["h32", "cf28", "hppf24", "hapf31"];

/// The body of that name with the sizes of an adult of 1.75 m, or the body in a file.
///
/// # Errors
/// An unknown name, a file that cannot be read or is no body.
pub fn find(name: &str) -> Result<KinematicTree, Error> {
    Ok(to_track(name)?.tree(&Proportions::default()))
}

/// The body of that name for the set-up pass to size, or the body in a file, which keeps its sizes.
///
/// # Errors
/// As [`find`].
pub fn to_track(name: &str) -> Result<Body, Error> {
    match name.to_lowercase().as_str() {
        "h32" => Ok(Body::H32),
        "cf28" => Ok(Body::CF28),
        "hppf24" => Ok(Body::HPPF24),
        "hapf31" => Ok(Body::HAPF31),
        _ => from_file(name).map(Body::File),
    }
}

fn from_file(name: &str) -> Result<FileBody, Error> {
    let path = Path::new(name);
    if path.extension().is_some_and(|extension| extension == "toml") || path.exists() {
        return FileBody::read(name, &files::read_text(path, MAX_CONFIG_BYTES)?);
    }
    Err(UnknownBody { name: name.into(), known: &NAMES, nearest: nearest(name, NAMES) }.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each of them has solids on all of its coordinates, and comes back from the name that a set-up stores.
    #[test]
    fn bodies_are_found_by_name_and_have_solids() {
        for name in NAMES {
            let body = to_track(name).unwrap();
            assert_eq!(Body::try_from(String::from(body.clone())), Ok(body.clone()));
            assert_eq!(body.name().to_lowercase(), name);
            let tree = body.tree(&Proportions::default());
            let mut coordinates = body.flesh(&tree).unwrap().coordinates(&tree).concat();
            coordinates.sort_unstable();
            assert!(coordinates.into_iter().eq(0..tree.dof()), "{name}");
        }
    }
}
