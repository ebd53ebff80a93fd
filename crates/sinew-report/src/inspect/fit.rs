//! Whether a calibration and keypoints belong together, before any tracking.
//!
//! The person is followed through the first frames. For each camera:
//!
//! - *RMS*: distance of the keypoints from the projection of their plain triangulation from all cameras, pixels;
//! - *offset*: the constant part of it (observed − projected), and the *scatter* that remains per axis;
//! - *lag*: the frames that the camera is late, with their standard deviation; 0 for synchronised cameras.
//!
//! Where there are several people, it is said who was seen where in all frames, and the rest is about the one whom two cameras see most.
//!
//! The set-up pass over the same frames adds what it finds odd: units, axes, cameras that look away, sides swapped.

use super::facts::{Facts, Odd};
use crate::Error;
use sinew::input::recording::Recording;
use sinew::input::roll::Roll;
use sinew::setup::SetupError;
use sinew::setup::{self, SetupRequest, clocks, collect};
use sinew_observe::cameras::offsets::{self, Sighted};
use sinew_observe::cameras::triangulate::{Seen, linear};
use sinew_observe::clocks::lag_estimate::CameraLag;
use sinew_observe::{Camera, Detection, association};

/// Frames looked at.
const FRAMES: u64 = 600;

/// Standard deviation of a lag above which it counts as unknown, frames.
const UNKNOWN_LAG: f64 = 2.0;

/// Looks at a recording of `fps` frames a second; what is `known` to be odd is not repeated.
///
/// # Errors
/// Files that cannot be read.
pub fn facts(recording: &mut Recording, fps: f64, known: &[String]) -> Result<Facts, Error> {
    let cameras = recording.cameras().to_vec();
    let layout = recording.layout().clone();
    let range = recording.frames();
    let numbers = range.start..range.end.min(range.start + FRAMES);
    let mut frames = Vec::new();
    for number in numbers.clone() {
        frames.push((number, recording.people(number)?));
    }
    let (image_scale, lag) = (recording.image_scale(), recording.lag().to_vec());
    let mut facts = Facts::new(format!("fit of calibration and keypoints, frames {}..{}", numbers.start, numbers.end));
    let roll = Roll::call(recording, range, fps, &association::Config::default(), |_| Ok::<(), sinew::Error>(()))?;
    let several = roll.people.len() > 1;
    let config = offsets::Config::default();
    let no_stop = || Ok::<(), sinew_input::Error>(());
    let of_all = several.then(|| clocks::lags_of_all(recording, &roll, (Some(fps), config), no_stop)).transpose()?;
    let asked = SetupRequest { image_scale, lag, lags_of_all: of_all.clone(), ..SetupRequest::default() };
    let who = if several { most_seen(&roll, numbers.end) } else { 0 };
    if several {
        for (number, people) in &mut frames {
            let [own, _] = roll.parted(*number, who, std::mem::take(people));
            *people = own;
        }
        for person in 0..roll.people.len() {
            facts.row(format!("person {}", person + 1), roll.words(person, &cameras));
        }
    }
    let request = SetupRequest { frames: frames.len(), ..asked.clone() };
    let collected = match collect(&cameras, &layout, &request, frames.iter().cloned().map(Ok::<_, SetupError>)) {
        Ok(collected) => collected,
        Err(error) => {
            facts.odd.push(error.to_string().into());
            verdict(&mut facts);
            return Ok(facts);
        }
    };
    let name = if several { format!("of person {}", who + 1) } else { "person".to_owned() };
    facts.row(name, format!("found in {} of {} frames", collected.found, collected.read));
    let sighted: Vec<Sighted> = collected.window.iter().map(|(_, sighted)| sighted.clone()).collect();
    let noise = offsets::estimate(&cameras, &sighted, &config);
    let lags = match &of_all {
        Some(lags) => lags.clone(),
        None => clocks::lags(&cameras, &collected, (Some(fps), config)),
    };
    let rms = reprojection_rms(&cameras, &sighted, config.least_confidence);
    for (index, camera) in cameras.iter().enumerate() {
        let lag = lags.get(index).filter(|lag| lag.sd < UNKNOWN_LAG);
        let clock = lag.map_or("lag unknown".into(), |CameraLag { frames, sd }| {
            format!("lag {:+.1} ± {sd:.1} frames", (10.0 * frames).round() / 10.0 + 0.0)
        });
        let [u, v] = noise[index].offset_px;
        let rms = rms[index].map_or("RMS unknown".into(), |rms| format!("RMS {rms:.1} px"));
        let scatter = noise[index].sigma_px;
        facts.row(&camera.name, format!("{rms}, offset ({u:+.1}, {v:+.1}) px, then {scatter:.1} px per axis, {clock}"));
    }
    match setup::set_up(&cameras, &layout, &asked, frames.into_iter().map(Ok::<_, SetupError>)) {
        Ok((_, warnings)) => facts.odd.extend(warnings.iter().map(|warning| Odd::Words(warning.to_string()))),
        Err(error) => facts.odd.push(error.to_string().into()),
    }
    facts.odd.retain(|odd| !matches!(odd, Odd::Words(words) if known.contains(words)));
    verdict(&mut facts);
    Ok(facts)
}

/// The person whom two cameras see in most frames, the first of several, of those who come before a frame.
fn most_seen(roll: &Roll, before: u64) -> usize {
    let seen = |person: &usize| (roll.people[*person].seen, std::cmp::Reverse(*person));
    let there = (0..roll.people.len()).filter(|person| roll.people[*person].frames.start < before);
    there.max_by_key(seen).unwrap_or_default()
}

fn verdict(facts: &mut Facts) {
    let fits = facts.odd.is_empty();
    facts.row(
        "verdict",
        if fits { "calibration and keypoints fit" } else { "look at what is odd here before tracking" },
    );
}

/// Root mean square reprojection distance of each camera, pixels.
fn reprojection_rms(cameras: &[Camera], frames: &[Sighted], least_confidence: f64) -> Vec<Option<f64>> {
    let mut sums = vec![(0.0, 0_u32); cameras.len()];
    for frame in frames {
        let keypoints = frame.iter().map(Vec::len).max().unwrap_or_default();
        for keypoint in 0..keypoints {
            let at = |camera: usize| -> Option<Detection> {
                let detection = frame.get(camera)?.get(keypoint).copied().flatten()?;
                (detection.confidence >= least_confidence).then_some(detection)
            };
            let seen: Vec<(usize, Seen<'_>)> = cameras
                .iter()
                .enumerate()
                .filter_map(|(index, camera)| {
                    let Detection { pixel, confidence, .. } = at(index)?;
                    Some((index, Seen { camera, pixel: camera.undistort(pixel).ok()?, confidence }))
                })
                .collect();
            let views: Vec<Seen<'_>> = seen.iter().map(|(_, seen)| *seen).collect();
            let Some(point) = linear(&views, true).filter(|_| views.len() > 1) else { continue };
            for (index, seen) in &seen {
                if let Some([u, v]) = seen.camera.project_ideal(point) {
                    sums[*index].0 += (seen.pixel[0] - u).powi(2) + (seen.pixel[1] - v).powi(2);
                    sums[*index].1 += 1;
                }
            }
        }
    }
    sums.into_iter().map(|(sum, count)| (count > 0).then(|| (sum / f64::from(count)).sqrt())).collect()
}
