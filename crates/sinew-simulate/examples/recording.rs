//! A recording as the files that trackers read: `recording FOLDER [SECONDS]`. Keypoints in OpenPose's format, a calibration, the truth as TRC.

use sinew_simulate::recording::{Script, SyntheticRecording};
use std::error::Error;
use std::fs;
use std::path::PathBuf;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("give a folder")?);
    let duration_s = arguments.next().map_or(Ok(4.0), |text| text.parse())?;
    let recording = SyntheticRecording::new(&Script { duration_s, ..Script::default() }, 1)?;
    for (name, text) in recording.keypoint_files() {
        let path = folder.join("keypoints").join(name);
        fs::create_dir_all(path.parent().ok_or("a folder")?)?;
        fs::write(path, text)?;
    }
    fs::write(folder.join("Calib.toml"), recording.calibration_toml())?;
    recording.write_truth_trc(&mut fs::File::create(folder.join("truth.trc"))?)?;
    println!("{} cameras, {} frames in {}", recording.cameras.len(), recording.truth.frames.len(), folder.display());
    Ok(())
}
