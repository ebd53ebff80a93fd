//! Cameras of a calibration in any format that is read: `calibration FILE`.

use sinew_formats::calibration;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let file = std::env::args().nth(1).ok_or("give a calibration, for example Calib.toml")?;
    let found = calibration::read(&file, &std::fs::read_to_string(&file)?)?;
    for camera in &found.cameras {
        let [x, y, z] = camera.centre();
        let [width, height] = camera.image_size_px;
        println!(
            "{:10} at {x:6.2} {y:6.2} {z:6.2} m, {width} × {height} px, f {:.0} px",
            camera.name, camera.intrinsics.fx
        );
    }
    for warning in &found.warnings {
        println!("{warning}");
    }
    Ok(())
}
