//! How late a camera is, from what it sees of somebody's swinging limbs.
//!
//! `cargo run --release -p sinew-observe --example late_camera`

use sinew_core::lanes::{Block, Isa, numbers};
use sinew_core::random::Stage;
use sinew_observe::cameras::offsets;
use sinew_observe::clocks::lag_estimate::{LagSearch, camera_clocks};
use sinew_observe::{Camera, Detection, Error};

const POINTS: usize = 12;
/// Frames that each camera is late.
const LATE: [f64; 4] = [0.0, 0.0, 1.4, 0.0];

/// Where a point is, in metres, at a time in frames: all swing and walk to and fro.
fn point_in_world(point: usize, time: f64) -> [f64; 3] {
    let (k, phase) = (point as f64, 0.15 * time + point as f64);
    let way = 0.5 * (0.008 * time).sin();
    [0.3 * k.sin() + 0.15 * phase.sin() + way, 0.3 * k.cos() + 0.1 * phase.cos(), 0.15 * k]
}

fn main() -> Result<(), Error> {
    let camera = |k: usize| {
        let (sin, cos) = (0.4 + 1.57 * k as f64).sin_cos();
        Camera::look_at(&format!("C{k}"), [1000.0; 2], 1000.0, [4.0 * cos, 4.0 * sin, 1.8], [0.0, 0.0, 1.0])
    };
    let cameras = (0..LATE.len()).map(camera).collect::<Result<Vec<_>, _>>()?;
    let mut noise = [Block::ZERO; POINTS * LATE.len() * 2 / 8];
    let frame = |number: u64| {
        Stage::new(1, "late camera").at_frame(number as u32).whole().fill_normal(Isa::best(), &mut noise);
        let mut errors = numbers(&noise).iter().map(|z| 3.0 * z);
        let mut view = |(camera, late): (&Camera, f64)| -> Vec<Option<Detection>> {
            let mut seen = |point| {
                let [u, v] = camera.project(point_in_world(point, number as f64 - late)).pixel()?;
                // The detector sees every keypoint a few pixels from where it is, always on the same side.
                Some(Detection::new([u + 4.0 + errors.next()?, v - 6.0 + errors.next()?], 0.9))
            };
            (0..POINTS).map(&mut seen).collect()
        };
        (number, cameras.iter().zip(LATE).map(&mut view).collect::<Vec<_>>())
    };
    let frames: Vec<_> = (0..180).map(frame).collect();
    let search = LagSearch { fps: 60.0, offsets: offsets::Config::default(), drifts: false };
    let Some(clocks) = camera_clocks((&cameras, &[0.0; LATE.len()]), &[&frames], &search) else { return Ok(()) };
    for ((camera, clock), late) in cameras.iter().zip(clocks).zip(LATE) {
        println!("{}: {:5.2} ± {:.2} frames late, truly {late}", camera.name, clock.lag.frames, clock.lag.sd);
    }
    Ok(())
}
