//! Keypoints of a trial as DeepLabCut writes them, a file a camera.

use crate::support::outcome::Outcome;
use sinew::formats::openpose::Keypoint;
use sinew::observe::Camera;
use sinew_simulate::recording::SyntheticRecording;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// Writes keypoints of a camera into the folder of a trial, as DeepLabCut does.
pub(super) fn write_keypoints(
    walk: &SyntheticRecording,
    camera: &Camera,
    frames: &[Vec<Option<Keypoint>>],
    trial: &Path,
) -> Outcome<()> {
    fs::create_dir_all(trial.join("points"))?;
    fs::write(trial.join("sinew.toml"), "keypoints = \"points\"\n")?;
    Ok(fs::write(trial.join("points").join(format!("{}.csv", camera.name)), table(walk, frames))?)
}

fn table(walk: &SyntheticRecording, frames: &[Vec<Option<Keypoint>>]) -> String {
    let names: Vec<&str> = walk.layout.points.iter().map(|name| name.as_deref().unwrap_or("none")).collect();
    let row = |head: &str, cell: &dyn Fn(&str) -> String| {
        head.to_owned() + &names.iter().map(|name| cell(name)).collect::<String>() + "\n"
    };
    let mut text = row("scorer", &|_| ",s,s,s".into())
        + &row("bodyparts", &|name| format!(",{name},{name},{name}"))
        + &row("coords", &|_| ",x,y,likelihood".into());
    for (number, frame) in frames.iter().enumerate() {
        let _ = write!(text, "{number}");
        for point in frame {
            let _ = match point {
                Some(k) => write!(text, ",{:.3},{:.3},{:.3}", k.x, k.y, k.confidence),
                None => write!(text, ",,,"),
            };
        }
        text.push('\n');
    }
    text
}
