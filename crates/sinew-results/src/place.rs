//! Where a file of an output folder is: the one way from a name to a path.
//!
//! Names come from others: cameras of a calibration, trials of a plan, files of an archive. A name may not lead out of the folder, neither by `..` nor from the root nor through a link below it. The folder itself may
//! be a link: it is what the user named.

use crate::Error;
use std::path::{Component, Path, PathBuf};

/// Path of a file or folder below an output folder, by its name in it (`.` is the folder itself).
///
/// # Errors
/// [`Error::OutputOutside`] for a name that leads out of the folder, [`Error::OutputLink`] where the way is a link.
pub fn place(folder: &Path, name: impl AsRef<Path>) -> Result<PathBuf, Error> {
    let name = name.as_ref();
    let mut path = folder.to_owned();
    for part in name.components() {
        match part {
            Component::Normal(part) => path.push(part),
            Component::CurDir => continue,
            _ => return Err(Error::OutputOutside { folder: folder.to_owned(), name: name.to_owned() }),
        }
        if path.is_symlink() {
            return Err(Error::OutputLink(path));
        }
    }
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_below_their_folder() {
        let root = tempfile::tempdir().unwrap();
        let out = root.path().join("out");
        let inside = |name: &str| place(&out, name).unwrap();
        assert_eq!(inside("a/b.csv"), out.join("a").join("b.csv"));
        assert_eq!((inside("."), inside("./a"), inside("..a")), (out.clone(), out.join("a"), out.join("..a")));
        for name in ["../a", "a/../../b", "a/..", "/etc/a", ".."] {
            let error = place(&out, name).unwrap_err();
            assert!(matches!(&error, Error::OutputOutside { name: found, .. } if found == Path::new(name)), "{error}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_below_a_folder_are_not_followed() {
        use std::os::unix::fs::symlink;
        let root = tempfile::tempdir().unwrap();
        let at = |name: &str| root.path().join(name);
        std::fs::create_dir(at("elsewhere")).unwrap();
        std::fs::create_dir(at("disk")).unwrap();
        symlink(at("disk"), at("out")).unwrap();
        symlink(at("elsewhere"), at("out/link")).unwrap();
        symlink(at("not there"), at("out/dangling")).unwrap();
        assert_eq!(place(&at("out"), "a").unwrap(), at("out/a"));
        for name in ["link", "link/a", "dangling"] {
            let error = place(&at("out"), name).unwrap_err();
            assert!(matches!(error, Error::OutputLink(_)), "{error}");
        }
    }
}
