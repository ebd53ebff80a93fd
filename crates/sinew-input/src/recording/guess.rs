//! Which layout keypoints have when none is named, and whether they contradict the named one.
//!
//! The length of a list settles most layouts. 75 numbers fit BODY_25B and BODY_25, which the body itself distinguishes: point 8 of BODY_25 is the middle of points 9
//! and 12 (the hips), point 8 of BODY_25B an elbow.

use super::keypoint_camera::KeypointCamera;
use crate::Error;
use crate::files::FNV_START;
use crate::flag::flag;
use crate::input_error::InputError;
use sinew_formats::openpose::{OpenposeOptions, OpenposePerson};
use sinew_formats::{Layout, layout};
use std::path::Path;

const BODY_25: &str = "BODY_25";
const BODY_25B: &str = "BODY_25B";

/// People looked at before deciding.
const ENOUGH: usize = 20;

/// Files read in search of people.
const PATIENCE: usize = 400;

/// The layout of the first people found, and a warning if there was a choice.
pub(super) fn layout(cameras: &[KeypointCamera], folder: &Path) -> Result<(Layout, Option<String>), Error> {
    let mut people: Vec<OpenposePerson> = Vec::new();
    for found in first_people(cameras) {
        people.extend(found?);
        if people.len() >= ENOUGH {
            break;
        }
    }
    if people.is_empty() {
        let folder = folder.to_owned();
        let files = cameras.iter().map(|camera| camera.files().len()).sum::<usize>().min(PATIENCE);
        return Err(InputError::NobodyForLayout { folder, files, known: layout::names() }.into());
    }
    people_layout(&people, folder)
}

/// The layout of some people, and a warning if there was a choice; `place` is where they were found.
pub(crate) fn people_layout(people: &[OpenposePerson], place: &Path) -> Result<(Layout, Option<String>), Error> {
    let numbers = 3 * people.first().map_or(0, |first| first.keypoints.len());
    let mut fitting = layout::with_numbers(numbers);
    match fitting.len() {
        0 => Err(InputError::NoSuchLength { folder: place.to_owned(), numbers, known: layout::names() }.into()),
        1 => Ok((fitting.remove(0), None)),
        _ => {
            let name = if has_mid_hip_at_8(people) == Some(true) { BODY_25 } else { BODY_25B };
            let chosen = layout::find(name)?;
            let names: Vec<&str> = fitting.iter().map(|layout| layout.name.as_str()).collect();
            let warning = format!(
                "{numbers} numbers a person fit {}; {name} taken, by the place of the hips ({} sets it)",
                names.join(" and "),
                flag("layout")
            );
            Ok((chosen, Some(warning)))
        }
    }
}

/// A warning if the first people found do not look like the layout that was named. Files that cannot be read are reported when their frame is read.
pub(super) fn contradiction(cameras: &[KeypointCamera], named: &Layout) -> Option<String> {
    let expected = match named.name.as_str() {
        BODY_25 => true,
        BODY_25B => false,
        _ => return None,
    };
    let numbers = named.points.len();
    let readable = first_people(cameras).filter_map(Result::ok).flatten();
    let people: Vec<OpenposePerson> =
        readable.filter(|person| person.keypoints.len() == numbers).take(ENOUGH).collect();
    let found = has_mid_hip_at_8(&people)?;
    let look = if found { BODY_25 } else { BODY_25B };
    (found != expected).then(|| {
        format!(
            "keypoints look like {look}, by the place of the hips; {} was requested ({})",
            named.name,
            flag("layout")
        )
    })
}

/// People of the first files of every camera in turn, file by file.
fn first_people(cameras: &[KeypointCamera]) -> impl Iterator<Item = Result<Vec<OpenposePerson>, Error>> + '_ {
    let most = cameras.iter().map(|camera| camera.files().len()).max().unwrap_or_default();
    let frames = (0..most).flat_map(move |index| {
        cameras.iter().filter_map(move |camera| Some((camera, camera.files().numbers().nth(index)?)))
    });
    frames.take(PATIENCE).map(|(camera, number)| {
        let options = OpenposeOptions { frame: Some(number), layout: None, confidence_scale: f64::MAX };
        let read = camera.read(number, &options, FNV_START)?;
        Ok(read.map(|(frame, _)| frame.people).unwrap_or_default())
    })
}

/// Whether point 8 lies between points 9 and 12 in most of the people; `None` where nobody shows all three.
fn has_mid_hip_at_8(people: &[OpenposePerson]) -> Option<bool> {
    let at = |person: &OpenposePerson, index: usize| person.keypoints.get(index).copied().flatten().map(|k| [k.x, k.y]);
    let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
    let mut seen = 0;
    let mut near = 0;
    for person in people {
        let (Some(middle), Some(right), Some(left)) = (at(person, 8), at(person, 9), at(person, 12)) else { continue };
        seen += 1;
        let centre = [(right[0] + left[0]) / 2.0, (right[1] + left[1]) / 2.0];
        // From the side the hips lie upon each other; what is near then is a matter of the person's size.
        if distance(middle, centre) < 0.25 * distance(right, left).max(0.1 * extent(person)) {
            near += 1;
        }
    }
    (seen > 0).then_some(2 * near > seen)
}

/// Height of a person in the image, pixels.
fn extent(person: &OpenposePerson) -> f64 {
    let rows = person.keypoints.iter().flatten().map(|keypoint| keypoint.y);
    let (top, bottom) = rows.fold((f64::INFINITY, f64::NEG_INFINITY), |(top, bottom), y| (top.min(y), bottom.max(y)));
    bottom - top
}

#[cfg(test)]
mod tests {
    use super::*;
    use sinew_formats::openpose::Keypoint;

    fn person(points: &[(usize, f64, f64)]) -> OpenposePerson {
        let mut keypoints = vec![None; 25];
        for &(index, x, y) in points {
            keypoints[index] = Some(Keypoint { x, y, confidence: 1.0 });
        }
        OpenposePerson { index: 0, keypoints }
    }

    #[test]
    fn the_middle_of_the_hips_decides() {
        let found = |points| has_mid_hip_at_8(&[person(points)]);
        assert_eq!(found(&[(8, 101.0, 300.0), (9, 80.0, 300.0), (12, 120.0, 300.0)]), Some(true));
        assert_eq!(found(&[(8, 200.0, 150.0), (9, 30.0, 200.0), (12, 120.0, 300.0)]), Some(false));
        assert_eq!(found(&[(8, 200.0, 150.0)]), None);
    }
}
