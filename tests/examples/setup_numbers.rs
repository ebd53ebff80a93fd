//! Prints what the set-up pass finds in a recording.
//! Offsets, scatter, sizes, and how well the body fits the points.
//!
//! `cargo run --release --example setup_numbers -- Calib.toml KEYPOINT_FOLDER [FIRST LAST [reference.trc]]`

use sinew::input::frame::detections;
use sinew::input::recording::{Recording, RecordingOptions};
use sinew::observe::cameras::offsets;
use sinew::setup::{self, SetupRequest};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [calibration, keypoints, rest @ ..] = &arguments[..] else {
        return Err("give a calibration and a folder of keypoints".into());
    };
    let frames = match rest {
        [first, last, ..] => Some(first.parse()?..last.parse::<u64>()? + 1),
        _ => None,
    };
    let mut recording = Recording::open(
        Path::new(calibration),
        Path::new(keypoints),
        &RecordingOptions { frames, ..RecordingOptions::default() },
    )?;
    let (cameras, layout) = (recording.cameras().to_vec(), recording.layout().clone());
    let request = SetupRequest::default();
    let mut frames = Vec::new();
    for number in recording.frames() {
        frames.push((number, detections(&recording.frame(number)?)));
    }
    let started = std::time::Instant::now();
    let (found, warnings) =
        setup::set_up(&cameras, &layout, &request, frames.iter().cloned().map(Ok::<_, sinew::Error>))?;
    println!("set up in {:?}", started.elapsed());
    for warning in warnings {
        println!("warning: {warning}");
    }
    print!("{}", found.to_toml()?);

    let collected = setup::collect(&cameras, &layout, &request, frames.into_iter().map(Ok::<_, sinew::Error>))?;
    let noise = offsets::estimate(&cameras, &collected.sighted(request.offset_frames), &request.offsets);
    let shape = setup::shape::measure(&cameras, &layout, &request, &noise, &collected, &mut vec![])?;
    println!("fit error {:.1} mm", 1e3 * shape.fit_error_m);
    for (name, error) in &shape.point_error_m {
        println!("  {name:10} {:.1} mm", 1e3 * error);
    }
    Ok(())
}
