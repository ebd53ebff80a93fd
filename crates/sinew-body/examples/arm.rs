//! An arm from a table of offsets, and the angles that bring its wrist to a place.

use sinew_body::bones::{Bone, skeleton};
use sinew_body::fit::{Config, Target, fit_pose};
use sinew_body::{Error, Plan};

fn main() -> Result<(), Error> {
    let bone = |name, parent, offset, joints| Bone { name, parent, offset, joints };
    let arm = skeleton(&[
        bone("shoulder", "", [0.0, 0.0, 1.4], "rz ry rx"),
        bone("elbow", "shoulder", [0.0, 0.0, -0.30], "rx"),
        bone("wrist", "elbow", [0.0, 0.0, -0.26], ""),
    ])?;
    let wrist = Target { position: [0.1, 0.35, 1.3], weight: 1.0 };
    let found = fit_pose(&Plan::with_all_points(&arm), &[None, None, Some(wrist)], &[0.1; 4], &Config::default());
    for (name, angle) in arm.dof_names().iter().zip(&found.pose) {
        println!("{name} {:.1}°", angle.to_degrees());
    }
    println!("{:.2} mm from the place", 1e3 * found.rms_m);
    Ok(())
}
