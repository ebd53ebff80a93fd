//! Three angles of a rotation by two sequences, while an arm is raised to the side and over the head.
//!
//! `cargo run --release -p sinew-angles --example raised_arm`
//!
//! At the side and straight up the sequence of the ISB is singular; flexion, adduction and rotation are at 90°. Behind it adduction would fall again, with half a turn in the others; the nearest angles to those before go on.

use sinew_angles::decomposition::{AngleSequence, near, turned};

fn main() {
    let upright = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let thirds = [AngleSequence::FlexionAdductionRotation, AngleSequence::LeftElevation];
    let mut before = [[0.0; 3]; 2];
    println!("raised | flexion, adduction, rotation | nearest to those before | plane, elevation, rotation (ISB)");
    for raised in (5..=175).step_by(17) {
        // About the axis that points forward, with the arm turned by 10° about its own.
        let m = turned(turned(upright, 1, f64::from(raised).to_radians()), 2, 10_f64.to_radians());
        let mut texts = vec![];
        for (sequence, before) in thirds.into_iter().zip(&mut before) {
            let angles = sequence.angles(&m);
            *before = near(sequence, angles, *before);
            texts.push([angles, *before].map(|own| own.map(|a| format!("{:6.1}", a.to_degrees())).join(" ")));
        }
        println!("{raised:5}° | {:>28} | {:>23} | {}", texts[0][0], texts[0][1], texts[1][1]);
    }
}
