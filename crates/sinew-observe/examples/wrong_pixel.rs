//! A point in space from its pixels in four cameras, of which one shows something else.
//!
//! `cargo run --release -p sinew-observe --example wrong_pixel`

use sinew_observe::cameras::lens::Brown;
use sinew_observe::cameras::triangulate::{Config, Seen, triangulate};
use sinew_observe::{Camera, Error};

fn main() -> Result<(), Error> {
    let camera = |name: &str, x: f64, y: f64| {
        let perfect = Camera::look_at(name, [1280.0, 960.0], 900.0, [x, y, 2.0], [0.0, 0.0, 1.0])?;
        let lens = Brown { k1: -0.2, k2: 0.05, p1: 0.0, p2: 0.0, k3: 0.0 }.into();
        Ok::<_, Error>(Camera { lens, ..perfect })
    };
    let cameras = [camera("A", -3.0, -3.0)?, camera("B", 3.0, -3.0)?, camera("C", 3.0, 3.0)?, camera("D", -3.0, 3.0)?];
    let wrist = [0.3, 0.2, 1.4];
    // Pixels are some tenths off, and camera C shows the other wrist, 40 cm away.
    let shown = [wrist, wrist, [0.3, -0.2, 1.4], wrist];
    let errors = [[0.4, -0.2], [-0.3, 0.5], [0.1, 0.1], [0.2, 0.3]];
    let seen: Vec<Seen<'_>> = (cameras.iter().zip(shown).zip(errors))
        .filter_map(|((camera, point), error)| {
            let [u, v] = camera.project(point).pixel()?;
            Some(Seen { camera, pixel: [u + error[0], v + error[1]], confidence: 0.9 })
        })
        .collect();
    for (config, name) in [
        (Config { error_px: f64::INFINITY, ..Config::default() }, "all cameras"),
        (Config::default(), "cameras that agree within 15 px"),
    ] {
        let Some(found) = triangulate(&seen, &config) else { continue };
        let used: Vec<&str> = found.used.iter().map(|&i| &*seen[i].camera.name).collect();
        let off_mm = (0..3).map(|k| (found.point[k] - wrist[k]).powi(2)).sum::<f64>().sqrt() * 1e3;
        println!("{name}: {used:?}, {:.3?}, {off_mm:.1} mm off, {:.1} px on average", found.point, found.error_px);
    }
    Ok(())
}
