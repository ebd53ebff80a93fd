//! A pose from how links are turned, as inertial sensors on them measure it, and where the feet stand.
//!
//! The sensors of a walking person are simulated: 2° of error each, on ten of thirteen links. Prints how far joints are from the truth.

use sinew_body::fit::{Config, Orientation, Target, fit_oriented};
use sinew_body::standard::h32;
use sinew_body::{Isa, Plan, Proportions, point_positions_each, rotation};

const SENSORS: [&str; 10] =
    ["spine", "head", "pelvis", "l_upper_arm", "l_forearm", "r_upper_arm", "r_forearm", "l_thigh", "r_thigh", "r_shin"];

fn main() {
    let body = h32(&Proportions::default());
    let plan = Plan::with_all_points(&body);
    let truth: Vec<f64> = (0..body.dof()).map(|j| if j < 6 { 0.0 } else { 0.3 * (1.7 * j as f64).sin() }).collect();
    let points = point_positions_each(&plan, Isa::baseline(), &truth);
    let frames = body.link_frames(&truth);
    let orientations: Vec<Orientation> = SENSORS
        .iter()
        .enumerate()
        .filter_map(|(k, name)| {
            let link = body.link_index(name)?;
            let (sin, cos) = (2.4 * k as f64).sin_cos();
            let error = rotation::about([cos, sin, 0.0], 2.0_f64.to_radians());
            Some(Orientation { link, rotation: rotation::product(&frames[link].0, &error), weight: 1.0 })
        })
        .collect();
    let stands = |(k, p): (usize, &[f64])| {
        let is_foot = body.points()[k].name.ends_with("Heel");
        is_foot.then(|| Target { position: [p[0], p[1], p[2]], weight: 1.0 })
    };
    let feet: Vec<Option<Target>> = points.chunks_exact(3).enumerate().map(stands).collect();
    let found = fit_oriented(&body, &feet, &orientations, &vec![0.0; body.dof()], &Config::default());
    let at = point_positions_each(&plan, Isa::baseline(), &found.pose);
    println!("{} steps, orientations to {:.1}°", found.steps, found.rms_rad.unwrap_or(f64::NAN).to_degrees());
    for (point, (a, b)) in body.points().iter().zip(at.chunks_exact(3).zip(points.chunks_exact(3))) {
        let apart = (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt();
        println!("{:12} {:5.1} mm", point.name, 1e3 * apart);
    }
}
