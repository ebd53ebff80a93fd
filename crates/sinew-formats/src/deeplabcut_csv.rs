//! DeepLabCut's CSV: a row a frame, three rows of header, four with several animals. One file holds one camera.
//!
//! The first cells of the header rows are `scorer`, `individuals` (several animals only), `bodyparts` and `coords`; below
//! them every column is `x`, `y` (pixels) or `likelihood` of a point. Quirks that are ordinary input:
//!
//! - The frame stands in the first column: a number, or for labelled pictures a path, whose last number counts. Newer
//!   versions split the path into three columns.
//! - Empty cells and `NaN` are missing, whatever the likelihood. So is a likelihood of 0; a low one stays as it is and
//!   makes the point count less, below `least_confidence` not at all. DeepLabCut's own cut-off is not applied.
//! - Labelled pictures have no likelihood: what was labelled has 1.
//! - Points have the names of the project. Those that mean a point of the body get our name (`left_shoulder` is
//!   `LShoulder`), others none. A mapping file names them in the order of the columns, each point once.
//! - The individual `single` of a project with several animals holds points that belong to none: it is left out, with a
//!   warning.
//! - Individuals without a point are absent, and keep their index.
//!
//! ```
//! use sinew_formats::deeplabcut_csv::read;
//! let text = "scorer,DLC,DLC,DLC,DLC,DLC,DLC\nbodyparts,left_hip,left_hip,left_hip,tail,tail,tail\n\
//!             coords,x,y,likelihood,x,y,likelihood\n0,100.5,200,0.98,,,\n1,NaN,NaN,1,5,6,0.2\n";
//! let table = read("cam01DLC_resnet50.csv", text, 1.0)?;
//! assert_eq!(table.layout.unwrap().points, [Some("LHip".into()), None]);
//! let frames = &table.cameras[0].frames;
//! assert_eq!(frames[&0].people[0].keypoints[0].unwrap().confidence, 0.98);
//! assert!(frames[&0].people[0].keypoints[1].is_none() && frames[&1].people[0].keypoints[0].is_none());
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::csv_text::records;
use crate::keypoint_table::{Frames, KeypointTable};
use crate::openpose::{OpenposeFrame, OpenposePerson, keypoint};
use crate::point_name::known_point;
use crate::source_text::{finite_or_missing, shortened};
use crate::{Error, Layout, Place, Warning, frame_number};
use csv::StringRecord;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Whether a file begins with such a header.
#[must_use]
pub fn recognises(beginning: &str) -> bool {
    let firsts = beginning.lines().take(4).map(|line| line.split(',').next().unwrap_or_default().trim());
    let firsts: Vec<&str> = firsts.collect();
    firsts.first() == Some(&"scorer") && firsts.contains(&"bodyparts") && firsts.contains(&"coords")
}

/// DeepLabCut's name for the individual whose points belong to none.
const SINGLE: &str = "single";

/// Points of individuals that may be without columns, beyond half of all.
const SPARSE: usize = 1000;

/// Columns of one point of one individual.
#[derive(Clone, Copy, Default)]
struct Columns {
    x: Option<usize>,
    y: Option<usize>,
    likelihood: Option<usize>,
}

/// What the header says.
struct Header {
    /// Column of the frame.
    frame: usize,
    /// Cells of a row.
    width: usize,
    /// Points by first appearance.
    points: Vec<String>,
    /// For each individual the columns of each point.
    individuals: Vec<Vec<Columns>>,
    /// Points that belong to no individual and are left out.
    single: usize,
}

/// A record with its line.
type Record = Result<(usize, StringRecord), Error>;

/// The rows of the header by their first cells, and the line of the last.
fn header_rows(
    name: &str,
    records: &mut impl Iterator<Item = Record>,
) -> Result<(HashMap<String, StringRecord>, usize), Error> {
    let mut rows = HashMap::new();
    let mut last = 1;
    for record in records {
        let (line, row) = record?;
        last = line;
        let key = row.get(0).unwrap_or_default().to_owned();
        if !["scorer", "individuals", "bodyparts", "coords"].contains(&&key[..]) {
            return Err(Place::file(name)
                .at_line(line)
                .syntax(format!("`{}`", shortened(&key)), "a row `bodyparts` and a row `coords`"));
        }
        let is_last = key == "coords";
        rows.insert(key, row);
        if is_last {
            break;
        }
    }
    Ok((rows, last))
}

/// The index of a name among those that came before, to which it is added.
fn place_among<'a>(known: &mut HashMap<&'a str, usize>, name: &'a str) -> usize {
    let next = known.len();
    *known.entry(name).or_insert(next)
}

fn header(name: &str, records: &mut impl Iterator<Item = Record>) -> Result<Header, Error> {
    let (rows, last) = header_rows(name, records)?;
    let place = || Place::file(name).at_line(last);
    let row = |key: &str| rows.get(key).ok_or_else(|| place().lacks(key));
    let (parts, coords) = (row("bodyparts")?, row("coords")?);
    let animals = rows.get("individuals");
    for other in [Some(parts), animals].into_iter().flatten() {
        if other.len() != coords.len() {
            return Err(Error::RowLength { place: place(), found: other.len(), expected: coords.len() });
        }
    }
    let frame = coords.iter().skip(1).take_while(|cell| cell.is_empty()).count();
    let is_single = |animal: &str| animals.is_some() && animal == SINGLE;
    let has_others = animals.is_some_and(|animals| animals.iter().skip(frame + 1).any(|animal| !is_single(animal)));
    let mut single = BTreeSet::new();
    let (mut known_parts, mut known_animals) = (HashMap::new(), HashMap::new());
    let mut groups: BTreeMap<(usize, usize), Columns> = BTreeMap::new();
    let mut points = vec![];
    for (column, coordinate) in coords.iter().enumerate().skip(frame + 1) {
        let part = parts.get(column).unwrap_or_default();
        let animal = animals.and_then(|animals| animals.get(column)).unwrap_or_default();
        if has_others && is_single(animal) {
            single.insert(part);
            continue;
        }
        let point = place_among(&mut known_parts, part);
        if point == points.len() {
            points.push(part.to_owned());
        }
        let own = groups.entry((place_among(&mut known_animals, animal), point)).or_default();
        let slot = match coordinate {
            "x" => &mut own.x,
            "y" => &mut own.y,
            "likelihood" => &mut own.likelihood,
            _ => continue,
        };
        if slot.replace(column).is_some() {
            return Err(place().twice("column", format!("{} of {}", shortened(coordinate), shortened(part))));
        }
    }
    if known_animals.len().saturating_mul(points.len()) > SPARSE + 2 * groups.len() {
        return Err(Error::Unsupported { place: place(), what: "individuals with other body parts each".into() });
    }
    let mut individuals = vec![vec![Columns::default(); points.len()]; known_animals.len()];
    for ((individual, point), columns) in groups {
        if let Some(own) = individuals.get_mut(individual).and_then(|own| own.get_mut(point)) {
            *own = columns;
        }
    }
    Ok(Header { frame, width: coords.len(), points, individuals, single: single.len() })
}

/// Reads the keypoints of a camera.
///
/// # Errors
/// A header without `bodyparts` or `coords`, columns that are there twice, rows that are cut, cells that are no numbers,
/// frames without a number or there twice, likelihoods outside the declared scale.
pub fn read(name: &str, text: &str, confidence_scale: f64) -> Result<KeypointTable, Error> {
    let mut records = records(name, text, b',');
    let header = header(name, &mut records)?;
    let mut frames = Frames::new();
    for record in records {
        let (line, row) = record?;
        let place = Place::file(name).at_line(line);
        if row.len() != header.width {
            return Err(Error::RowLength { place, found: row.len(), expected: header.width });
        }
        let shown = row.get(header.frame).unwrap_or_default();
        let Some(number) = frame_number::parse(shown) else {
            return Err(place.syntax(format!("`{}`", shortened(shown)), "the number of a frame"));
        };
        let frame = frame_of(&place, &header, &row, confidence_scale)?;
        if frames.insert(number, frame).is_some() {
            return Err(place.twice("frame", number.to_string()));
        }
    }
    let layout = layout(&header);
    let warning = || Warning::SingleLeftOut { place: Place::file(name), points: header.single };
    Ok(KeypointTable {
        layout: Some(layout),
        warnings: (header.single > 0).then(warning).into_iter().collect(),
        ..KeypointTable::from_one_camera(frames)
    })
}

fn frame_of(place: &Place, header: &Header, row: &StringRecord, scale: f64) -> Result<OpenposeFrame, Error> {
    let mut frame = OpenposeFrame::default();
    for (index, columns) in header.individuals.iter().enumerate() {
        let mut keypoints = vec![None; header.points.len()];
        for (own, columns) in keypoints.iter_mut().zip(columns) {
            let number = |column: Option<usize>| match column.and_then(|column| row.get(column)) {
                Some(cell) => finite_or_missing(|| place.clone(), cell),
                None => Ok(None),
            };
            let (x, y) = (number(columns.x)?, number(columns.y)?);
            let confidence = if columns.likelihood.is_some() { number(columns.likelihood)? } else { Some(scale) };
            // An empty point of labelled pictures was not labelled.
            let confidence = confidence.filter(|_| columns.likelihood.is_some() || x.is_some());
            *own = keypoint(place, [x, y, confidence], scale, &mut frame)?;
        }
        if keypoints.iter().any(Option::is_some) {
            frame.people.push(OpenposePerson { index, keypoints });
        }
    }
    Ok(frame)
}

/// Our names of the points, each once.
fn layout(header: &Header) -> Layout {
    let mut seen = BTreeSet::new();
    let points = header.points.iter().map(|point| known_point(point).filter(|name| seen.insert(name.clone())));
    Layout { name: "DeepLabCut".into(), points: points.collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, message: &str) {
        assert_eq!(read("a.csv", text, 1.0).unwrap_err().to_string(), message, "{text}");
    }

    #[test]
    fn several_animals_have_a_column_group_each() {
        let text = "scorer,D,D,D,D,D,D,D\nindividuals,a,a,a,b,b,b,single\nbodyparts,LHip,LHip,LHip,LHip,LHip,LHip,box\n\
            coords,x,y,likelihood,x,y,likelihood,x\n3,1,2,0.5,,,,\n4,,,,3,4,1,9\n5,,,0.9,,,,\n";
        let table = read("a.csv", text, 1.0).unwrap();
        let frames = &table.cameras[0].frames;
        let indices = |number: u64| frames[&number].people.iter().map(|person| person.index).collect::<Vec<_>>();
        assert_eq!((indices(3), indices(4), indices(5)), (vec![0], vec![1], vec![]));
        assert_eq!(frames[&5].without_coordinates, 1);
        assert_eq!(table.layout.unwrap().points, [Some("LHip".into())]);
        assert_eq!(
            table.warnings[0].to_string(),
            "a.csv: `single` (points: 1) is left out: it is DeepLabCut's name for points of no individual"
        );
    }

    #[test]
    fn a_lone_individual_of_that_name_is_kept() {
        let text = "scorer,D,D\nindividuals,single,single\nbodyparts,LHip,LHip\ncoords,x,y\n3,1,2\n";
        let table = read("a.csv", text, 1.0).unwrap();
        assert!(table.warnings.is_empty() && table.cameras[0].frames[&3].people.len() == 1);
    }

    #[test]
    fn labelled_pictures_have_paths_and_no_likelihood() {
        let text = "scorer,,,me,me\nbodyparts,,,nose,nose\ncoords,,,x,y\nlabeled-data,v,img012.png,1.5,2\nlabeled-data,v,img013.png,,\n";
        let frames = read("a.csv", text, 1.0).unwrap().cameras.remove(0).frames;
        assert_eq!(frames[&12].people[0].keypoints[0].unwrap().confidence, 1.0);
        assert!(frames[&13].people.is_empty() && frames[&13].without_coordinates == 0);
        let text = "scorer,me,me\r\nbodyparts,nose,nose\r\ncoords,x,y\r\nlabeled-data/v/img7.png,1,2\r\n";
        assert!(read("a.csv", text, 1.0).unwrap().cameras[0].frames.contains_key(&7));
    }

    #[test]
    fn individuals_that_share_no_part_are_refused() {
        let row = |first: &str, cell: &dyn Fn(usize) -> String| {
            (0..60).fold(first.to_owned(), |row, k| format!("{row},{}", cell(k)))
        };
        let named = |k: usize| format!("n{k}");
        let text = [row("individuals", &named), row("bodyparts", &named), row("coords", &|_| "x".into())].join("\n");
        check(&text, "a.csv:3: individuals with other body parts each is not supported");
    }

    #[test]
    fn faults_are_named() {
        let header = "scorer,D,D,D\nbodyparts,a,a,a\ncoords,x,y,likelihood\n";
        let with = |rows: &str| format!("{header}{rows}");
        check("scorer,D\nbodyparts,a\n0,1\n", "a.csv:3: `0`; expected a row `bodyparts` and a row `coords`");
        check("scorer,D\ncoords,x\n", "a.csv:2: `bodyparts` is missing");
        check("scorer,D\nbodyparts,a\ncoords,x,y\n", "a.csv:3: 2 values; expected 3");
        check("scorer,D,D\nbodyparts,a,a\ncoords,x,x\n", "a.csv:3: the column `x of a` is there twice");
        check(&with("0,1,2\n"), "a.csv:4: 3 values; expected 4");
        check(&with("0,1,2,0.5\n0,1,2,0.5\n"), "a.csv:5: the frame `0` is there twice");
        check(&with("x,1,2,0.5\n"), "a.csv:4: `x`; expected the number of a frame");
        check(&with("0,1,b,0.5\n"), "a.csv:4: `b`; expected a number");
        check(&with("0,1,2,87\n"), "a.csv:4: confidence 87.0 found; expected 0 to 1; set `confidence_scale = 100`");
    }
}
