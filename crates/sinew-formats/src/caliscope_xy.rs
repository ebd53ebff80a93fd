//! Caliscope's `xy_*.csv`: a row for each camera, frame and point that was seen, all cameras in one file.
//!
//! Read are the columns `sync_index` (the frame), `cam_id` or, of older versions, `port` (the camera), `point_id`,
//! `img_loc_x` and `img_loc_y` (pixels of the image as recorded, not turned); others are ignored. Quirks that are
//! ordinary input:
//!
//! - There is no confidence. What was seen has 1, the usual confidence; what was not seen has no row, an empty cell or
//!   `NaN`.
//! - Points are MediaPipe's: 0 to 32 are the pose. Hands (100 to 220) and face (from 300) are left out.
//! - A frame in which a camera sees nobody has no row: a missing frame is one without people.
//! - `frame_time` (seconds), where it is there, says the frame rate.
//! - `frame_index` counts the frames of each camera, `sync_index` the moments that they share: the latter is taken.
//!
//! ```
//! use sinew_formats::caliscope_xy::read;
//! let text = "sync_index,cam_id,frame_index,frame_time,point_id,img_loc_x,img_loc_y,obj_loc_x,obj_loc_y\n\
//!             0,0,0,9.1,11,520.5,193,,\n0,0,0,9.1,320,1,2,,\n0,2,0,9.1,11,400,,,\n";
//! let table = read("xy_HOLISTIC.csv", text, 1.0)?;
//! assert_eq!(table.layout.unwrap().name, "MEDIAPIPE_33");
//! assert!(table.leaves_out_nobody && table.rate_hz.is_none());
//! let shoulder = table.cameras[0].frames[&0].people[0].keypoints[11].unwrap();
//! assert_eq!((shoulder.x, shoulder.y, shoulder.confidence), (520.5, 193.0, 1.0));
//! assert!(table.cameras[1].frames[&0].people.is_empty());
//! # Ok::<(), sinew_formats::Error>(())
//! ```

use crate::csv_text::records;
use crate::keypoint_table::{Frames, KeypointTable, TableCamera};
use crate::openpose::{Keypoint, OpenposePerson};
use crate::source_text::{finite_or_missing, shortened};
use crate::{Error, Place, layout};
use csv::StringRecord;
use sinew_core::estimators::median;
use std::collections::BTreeMap;

/// Points of a person: MediaPipe's pose.
const POINTS: usize = 33;

/// Whether a file begins with the header of such a table.
#[must_use]
pub fn recognises(beginning: &str) -> bool {
    let header = beginning.lines().next().unwrap_or_default();
    let has = |name: &str| header.split(',').any(|column| column.trim() == name);
    has("sync_index") && has("point_id") && has("img_loc_x")
}

/// Places of the columns: frame, camera, point, x, y.
fn columns(name: &str, header: &StringRecord) -> Result<[usize; 5], Error> {
    let place = |names: &[&str]| {
        let found = header.iter().position(|column| names.contains(&column));
        found.ok_or_else(|| Place::file(name).at_line(1).lacks(names.join("` or `")))
    };
    Ok([
        place(&["sync_index"])?,
        place(&["cam_id", "port"])?,
        place(&["point_id"])?,
        place(&["img_loc_x"])?,
        place(&["img_loc_y"])?,
    ])
}

/// Reads the keypoints of all cameras. The confidence scale has no part in it.
///
/// # Errors
/// A column that is missing, rows that are cut, cells that are no numbers, a point that a camera has twice in a frame.
pub fn read(name: &str, text: &str, _confidence_scale: f64) -> Result<KeypointTable, Error> {
    let mut records = records(name, text, b',');
    let (_, header) = records.next().transpose()?.unwrap_or_default();
    let places = columns(name, &header)?;
    let mut cameras: BTreeMap<u64, Frames> = BTreeMap::new();
    let time_column = header.iter().position(|column| column == "frame_time");
    let mut spans: BTreeMap<u64, [(u64, f64); 2]> = BTreeMap::new();
    for record in records {
        let (line, cells) = record?;
        let place = || Place::file(name).at_line(line);
        if cells.len() != header.len() {
            return Err(Error::RowLength { place: place(), found: cells.len(), expected: header.len() });
        }
        let cell = |k: usize| places.get(k).and_then(|&at| cells.get(at)).unwrap_or_default();
        let (frame, camera, point) =
            (whole(place, "frame", cell(0))?, whole(place, "camera", cell(1))?, whole(place, "point", cell(2))?);
        if let Some(time_s) = time_column.and_then(|at| cells.get(at)?.parse::<f64>().ok()) {
            spans.entry(camera).or_insert([(frame, time_s); 2])[1] = (frame, time_s);
        }
        let frame = cameras.entry(camera).or_default().entry(frame).or_default();
        let (x, y) = (finite_or_missing(place, cell(3))?, finite_or_missing(place, cell(4))?);
        let (Some(x), Some(y), true) = (x, y, point < POINTS as u64) else { continue };
        if frame.people.is_empty() {
            frame.people.push(OpenposePerson { index: 0, keypoints: vec![None; POINTS] });
        }
        let own = frame.people.first_mut().and_then(|person| person.keypoints.get_mut(point as usize));
        if own.and_then(|own| own.replace(Keypoint { x, y, confidence: 1.0 })).is_some() {
            return Err(place().twice("point", format!("{point} of camera {camera}")));
        }
    }
    let camera = |(number, frames): (u64, Frames)| TableCamera { name: Some(number.to_string()), frames };
    Ok(KeypointTable {
        layout: Some(layout::find("MEDIAPIPE_33")?),
        leaves_out_nobody: true,
        rate_hz: rate_hz(spans.into_values()),
        ..KeypointTable::from_cameras(cameras.into_iter().map(camera).collect())
    })
}

/// The median of the rates of the cameras, from their first and last frame with its time, seconds.
fn rate_hz(spans: impl Iterator<Item = [(u64, f64); 2]>) -> Option<f64> {
    let rates = spans.map(|[(first, start_s), (last, end_s)]| last.saturating_sub(first) as f64 / (end_s - start_s));
    let mut rates: Vec<f64> = rates.filter(|rate| *rate > 0.0 && rate.is_finite()).collect();
    (!rates.is_empty()).then(|| median(&mut rates))
}

/// A number of a frame, camera or point; pandas writes them as `3.0` where some are missing.
fn whole(place: impl Fn() -> Place, what: &str, cell: &str) -> Result<u64, Error> {
    cell.strip_suffix(".0")
        .unwrap_or(cell)
        .parse()
        .map_err(|_| place().syntax(format!("`{}`", shortened(cell)), format!("the number of a {what}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "sync_index,port,frame_index,frame_time,point_id,img_loc_x,img_loc_y";

    fn check(rows: &str, message: &str) {
        let error = read("xy.csv", &format!("{HEADER}\n{rows}"), 1.0).unwrap_err();
        assert_eq!(error.to_string(), message, "{rows}");
    }

    #[test]
    fn cameras_and_frames_go_by_their_numbers() {
        let rows =
            "2,3,9,0.1,0,1,2\r\n2,3,9,0.1,32,3,4\n2,0,9,0.1,0,5.5,6\n10,0,3.0,0.2,500,5,6\n10,1.0,3,0.2,1,NaN,6\n";
        let table = read("xy.csv", &format!("\u{feff}{HEADER}\r\n{rows}"), 1.0).unwrap();
        let names: Vec<_> = table.cameras.iter().map(|camera| camera.name.as_deref().unwrap()).collect();
        assert_eq!(names, ["0", "1", "3"]);
        assert_eq!(table.cameras[0].frames.keys().collect::<Vec<_>>(), [&2, &10]);
        assert!(table.cameras[0].frames[&10].people.is_empty() && table.cameras[1].frames[&10].people.is_empty());
        let seen = &table.cameras[2].frames[&2].people[0].keypoints;
        assert_eq!((seen[0].unwrap().y, seen[32].unwrap().x, seen[1]), (2.0, 3.0, None));
    }

    #[test]
    fn times_say_the_rate() {
        let rate = |rows: &str| read("xy.csv", &format!("{HEADER}\n{rows}"), 1.0).unwrap().rate_hz;
        assert_eq!(rate("10,0,0,5.0,1,2,3\n11,0,1,5.05,1,2,3\n30,0,2,6.0,1,2,3\n10,1,0,5.0,1,2,3\n"), Some(20.0));
        for silent in
            ["", "10,0,0,5.0,1,2,3\n", "10,0,0,5.0,1,2,3\n11,0,1,5.0,1,2,3\n", "1,0,0,x,1,2,3\n2,0,0,,1,2,3\n"]
        {
            assert_eq!(rate(silent), None, "{silent}");
        }
    }

    #[test]
    fn faults_are_named() {
        check("0,0,0,0,1\n", "xy.csv:2: 5 values; expected 7");
        check("x,0,0,0,1,2,3\n", "xy.csv:2: `x`; expected the number of a frame");
        check("0,-1,0,0,1,2,3\n", "xy.csv:2: `-1`; expected the number of a camera");
        check("0,0,0,0,1,2,inf\n", "xy.csv: value out of range at line 2");
        check("0,0,0,0,1,2,3\n0,0,0,0,1,2,3\n", "xy.csv:3: the point `1 of camera 0` is there twice");
        let error = read("xy.csv", "sync_index,point_id,img_loc_x,img_loc_y\n", 1.0).unwrap_err();
        assert_eq!(error.to_string(), "xy.csv:1: `cam_id` or `port` is missing");
    }
}
