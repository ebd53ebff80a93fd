//! Which points of a laboratory's file make a point of ours.
//!
//! ```toml
//! [points]
//! RHip = "RHJC"
//! RKnee = ["RKNE", "RKNM"]    # the middle of both markers
//! ```
//!
//! A joint's centre is the mean of the points that are listed for it, as laboratories define knees and ankles by the
//! markers on either side.
//!
//! ```
//! let points = sinew_formats::point_mapping::read("names.toml", "[points]\nRKnee = ['RKNE', 'RKNM']")?;
//! assert_eq!((points[0].name.as_str(), &points[0].from[..]), ("RKnee", &["RKNE".to_owned(), "RKNM".to_owned()][..]));
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::Error;
use crate::toml_text::Document;

/// A point of ours, and the points of another file whose mean it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MappedPoint {
    /// Our name.
    pub name: String,
    /// Names in the other file, one or more.
    pub from: Vec<String>,
}

/// Reads a file, in its order.
///
/// # Errors
/// No table `points` or an empty one, other tables, a value that is no name and no list of names.
pub fn read(name: &str, text: &str) -> Result<Vec<MappedPoint>, Error> {
    let document = Document::parse(name, text)?;
    let root = document.root();
    root.allow(&["points"])?;
    let table = root.require("points")?;
    let found: Vec<MappedPoint> = table
        .as_table()?
        .values()
        .into_iter()
        .map(|(name, value)| {
            let expected = "a name, or a list of names";
            let from = match value.string() {
                Ok(one) => vec![one],
                Err(_) => {
                    let items = value.items().map_err(|_| value.must_be(expected))?;
                    items
                        .iter()
                        .map(|item| item.string().map_err(|_| value.must_be(expected)))
                        .collect::<Result<_, _>>()?
                }
            };
            if from.is_empty() { Err(value.must_be(expected)) } else { Ok(MappedPoint { name: name.to_owned(), from }) }
        })
        .collect::<Result<_, Error>>()?;
    if found.is_empty() { Err(table.must_be("a table with at least one point")) } else { Ok(found) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_no_mapping_are_refused_by_their_place() {
        let check = |text: &str, words: &str| {
            let found = read("names.toml", text).unwrap_err().to_string();
            assert!(found.contains(words), "{text}: {found}");
        };
        check("", "points");
        check("[points]", "at least one point");
        check("[point]\na = 'b'", "did you mean `points`");
        check("points = 3", "must be a table");
        check("[points]\na = 'b'\nc = 3", "names.toml:3");
        check("[points]\na = []", "a name, or a list of names");
        check("[points]\na = ['b', 1]", "a name, or a list of names");
    }

    #[test]
    fn points_keep_the_order_of_the_file() {
        let names: Vec<String> =
            read("n", "[points]\nZ = 'a'\nA = ['b', 'c']").unwrap().into_iter().map(|point| point.name).collect();
        assert_eq!(names, ["Z", "A"]);
    }
}
