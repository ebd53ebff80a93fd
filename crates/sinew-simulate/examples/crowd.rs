//! Four people for twenty seconds: how often a detector finds each of them.

use sinew_simulate::calibration_error::CalibrationError;
use sinew_simulate::crowd::{Crowd, CrowdNoise, CrowdRecording};
use sinew_simulate::ring::Ring;

fn main() -> Result<(), sinew_simulate::Error> {
    let crowd = Crowd {
        people: 4,
        duration_s: 20.0,
        rate_hz: 10.0,
        ring: Ring::default(),
        calibration: CalibrationError::NONE,
        noise: CrowdNoise::DETECTOR_LIKE,
    };
    let recording = CrowdRecording::new(&crowd, 1)?;
    let seen: Vec<&Vec<usize>> = recording.who.iter().flatten().collect();
    for person in 0..crowd.people {
        let found = seen.iter().filter(|names| names.contains(&person)).count();
        println!("person {person}: found in {:.1} % of {} views", 100.0 * found as f64 / seen.len() as f64, seen.len());
    }
    Ok(())
}
