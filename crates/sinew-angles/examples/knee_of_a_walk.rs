//! A knee's angle over a stride with its interval and its rate, from draws of the pose, the zero of a standing trial taken off.
//!
//! `cargo run --release -p sinew-angles --example knee_of_a_walk`
//!
//! The draws are made up: each frame's poses lie about a walk's with an error of 3° in the shin, which lasts from frame to frame, and one of 1° that does not. Rates know of the former that it lasts.

use sinew_angles::marginals::{AngleChange, LaterFrame};
use sinew_angles::{AngleMarginals, AngleZero, Convention, JointAngles};
use sinew_body::{Proportions, standard};
use sinew_core::lanes::{Block, Isa, numbers};
use sinew_core::random::Stage;
use sinew_tracking::posterior::Posterior;

const DRAWS: usize = 400;
const FPS: f64 = 10.0;
/// Whoever stands straight has this angle in the body's own zero.
const STANDING_DEG: f64 = 4.0;

fn true_knee_deg(frame: u32) -> f64 {
    let phase = std::f64::consts::TAU * f64::from(frame) / 11.0;
    30.0 - 25.0 * phase.cos() - 8.0 * (2.0 * phase).cos()
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let body = standard::h32(&Proportions::default());
    let shin = body.dof_names().iter().position(|name| name == "r_shin.rx").ok_or("no shin")?;
    let angles = JointAngles::new(&body, &[], false, Convention::OpenSim);
    let knee = angles.names().iter().position(|name| name == "knee_angle_r").ok_or("no knee")?;
    let normals = |purpose, frame| {
        let mut normals = vec![Block::ZERO; DRAWS / 8];
        Stage::new(1, purpose).at_frame(frame).whole().fill_normal(Isa::best(), &mut normals);
        numbers(&normals).to_vec()
    };
    let lasting = normals("lasting", 0);
    // A standing trial of the same person: the same error lasts in it.
    let standing: Vec<f64> = lasting.iter().map(|z| (STANDING_DEG + 3.0 * z).to_radians()).collect();
    let zero = AngleZero::new(&angles, &["knee_angle_r".into()], &standing, Some(DRAWS));
    let mut with_zero = AngleMarginals::new(angles.clone(), Some(zero));
    let mut without = AngleMarginals::new(angles, None);
    let draws = |frame: u32| {
        let mut states = vec![Block::ZERO; DRAWS / 8 * body.dof()];
        for (draw, (z, own)) in lasting.iter().zip(normals("frame", frame)).enumerate() {
            let degrees = STANDING_DEG + true_knee_deg(frame) + 3.0 * z + own;
            states[draw / 8 * body.dof() + shin].0[draw % 8] = -degrees.to_radians();
        }
        states
    };
    let weights = [1.0 / DRAWS as f64; DRAWS];
    let (mut mean, mut earlier) = (vec![0.0; body.dof()], draws(0));
    println!("frame  truth | less the zero: mean, 5 % to 95 % | not: mean, 5 % to 95 % | rate, 5 % to 95 %, °/s");
    for frame in 1..12 {
        let states = draws(frame);
        mean[shin] = -(STANDING_DEG + true_knee_deg(frame)).to_radians();
        let (dim, effective) = (body.dof(), DRAWS as f64);
        let posterior = Posterior { dim, states: &states, weights: &weights, effective, chain_stats: &[] };
        let change = AngleChange { earlier, later: LaterFrame::States(states.clone()), seconds: 1.0 / FPS };
        let [less, whole] = [&mut with_zero, &mut without].map(|own| own.of(&mean, &posterior, Some(&change))[knee]);
        let degrees = |numbers: [f64; 3]| numbers.map(|x| format!("{:6.1}", x.to_degrees())).join(" ");
        let rate = less.rate.unwrap_or_default();
        let columns = [[less.mean, less.q05, less.q95], [whole.mean, whole.q05, whole.q95], rate].map(degrees);
        println!("{frame:5} {:6.1} | {}", true_knee_deg(frame), columns.join(" | "));
        earlier = states;
    }
    Ok(())
}
