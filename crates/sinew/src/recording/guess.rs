//! Which layout keypoints have, when nobody says so.
//!
//! The length of a list settles most layouts. 75 numbers fit BODY_25B and BODY_25, which the body itself tells apart: point 8 of BODY_25 is the middle of points 9
//! and 12 (the hips), point 8 of BODY_25B an elbow.

use super::listing::CameraFiles;
use crate::{Error, files};
use sinew_formats::openpose::{self, Person};
use sinew_formats::source_text::MAX_KEYPOINT_BYTES;
use sinew_formats::{Layout, layout};
use std::path::Path;

/// People looked at before deciding.
const ENOUGH: usize = 20;

/// Files read in search of people.
const PATIENCE: usize = 400;

/// The layout of the first people found, and a warning if there was a choice.
pub(super) fn layout(cameras: &[CameraFiles], folder: &Path) -> Result<(Layout, Option<String>), Error> {
    let mut people: Vec<Person> = Vec::new();
    let paths =
        cameras.iter().flat_map(|camera| camera.numbers().filter_map(|number| Some((number, camera.path(number)?))));
    for (number, path) in paths.take(PATIENCE) {
        let text = files::read_text(&path, MAX_KEYPOINT_BYTES)?;
        let options = openpose::Options { frame: Some(number), layout: None, confidence_scale: f64::MAX };
        people.extend(openpose::read(&path.display().to_string(), &text, &options)?.people);
        if people.len() >= ENOUGH {
            break;
        }
    }
    let Some(first) = people.first() else {
        return Err(Error::Input {
            message: format!(
                "{}: nobody in the first {PATIENCE} files; the keypoint layout cannot be told",
                folder.display()
            ),
            help: Some(format!("name it with `--layout`: {}", layout::names().join(", "))),
        });
    };
    let numbers = 3 * first.keypoints.len();
    let mut fitting = layout::with_numbers(numbers);
    match fitting.len() {
        0 => Err(Error::Input {
            message: format!("{}: {numbers} numbers a person fit no known layout", folder.display()),
            help: Some(format!("known: {}; or give a mapping file with `--layout`", layout::names().join(", "))),
        }),
        1 => Ok((fitting.remove(0), None)),
        _ => {
            let name = if has_mid_hip_at_8(&people) { "BODY_25" } else { "BODY_25B" };
            let chosen = layout::find(name)?;
            let names: Vec<&str> = fitting.iter().map(|layout| layout.name.as_str()).collect();
            let warning = format!(
                "{numbers} numbers a person fit {}; {name} taken, by the place of the hips (`--layout` sets it)",
                names.join(" and ")
            );
            Ok((chosen, Some(warning)))
        }
    }
}

fn has_mid_hip_at_8(people: &[Person]) -> bool {
    let at = |person: &Person, index: usize| person.keypoints.get(index).copied().flatten().map(|k| [k.x, k.y]);
    let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let mut seen = 0;
    let mut near = 0;
    for person in people {
        let (Some(middle), Some(right), Some(left)) = (at(person, 8), at(person, 9), at(person, 12)) else { continue };
        seen += 1;
        let centre = [(right[0] + left[0]) / 2.0, (right[1] + left[1]) / 2.0];
        if distance(middle, centre) < 0.25 * distance(right, left).max(20.0) {
            near += 1;
        }
    }
    2 * near > seen
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_formats::openpose::Keypoint;

    fn person(points: &[(usize, f64, f64)]) -> Person {
        let mut keypoints = vec![None; 25];
        for &(index, x, y) in points {
            keypoints[index] = Some(Keypoint { x, y, confidence: 1.0 });
        }
        Person { index: 0, keypoints }
    }

    #[test]
    fn the_middle_of_the_hips_tells() {
        assert!(has_mid_hip_at_8(&[person(&[(8, 101.0, 300.0), (9, 80.0, 300.0), (12, 120.0, 300.0)])]));
        assert!(!has_mid_hip_at_8(&[person(&[(8, 200.0, 150.0), (9, 30.0, 200.0), (12, 120.0, 300.0)])]));
        assert!(!has_mid_hip_at_8(&[]));
    }
}
