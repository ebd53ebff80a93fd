//! A pose as OpenSim and as the ISB name its angles.
//!
//! `cargo run --release -p sinew-angles --example two_conventions`

use sinew_angles::{Convention, JointAngles};
use sinew_body::{Proportions, standard};

fn main() {
    let body = standard::h32(&Proportions::default());
    let names = body.dof_names();
    let mut state = vec![0.0; body.dof()];
    // A step with the right leg, its arm behind, and half a quarter turn to the left.
    for (name, degrees) in [
        ("r_thigh.rx", 30.0),
        ("r_shin.rx", -20.0),
        ("r_foot.rx", 5.0),
        ("l_thigh.rx", -15.0),
        ("r_upper_arm.rx", -25.0),
        ("pelvis.rz", 45.0_f64),
    ] {
        if let Some(k) = names.iter().position(|own| own == name) {
            state[k] = degrees.to_radians();
        }
    }
    for convention in [Convention::OpenSim, Convention::Isb] {
        let angles = JointAngles::new(&body, &[], false, convention);
        let mut raw = vec![0.0; angles.raw_count()];
        angles.raw(&state, None, &mut raw);
        println!("{convention:?}: {} angles; not 0 are", angles.names().len());
        for (k, name) in angles.names().iter().enumerate() {
            let degrees = angles.signed(k, &raw).to_degrees();
            if degrees.abs() > 0.05 {
                println!("  {name:24} {degrees:7.1}°");
            }
        }
    }
}
