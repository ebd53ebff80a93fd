//! Motion that is learned from a recording and predicts steps of another, beside a random walk and constant velocity.
//!
//! `cargo run --release -p sinew-dynamics --example learned_steps`
//!
//! The recordings are made up: two angles that swing at one pace, with noise. Action primitives are clusters of short pieces of such motion; the motion model that they make draws where a state goes.

use sinew_core::lanes::{Block, Isa, splat};
use sinew_core::random::Stage;
use sinew_core::transition::{MotionModel, Transition};
use sinew_dynamics::primitives::learning::{Config, TrainingMotion, learn};
use sinew_dynamics::primitives::model::FeatureVector;
use sinew_dynamics::primitives::motion::PrimitiveMotion;
use sinew_dynamics::primitives::summary::prediction_errors;

const FPS: f64 = 20.0;

/// Hip and knee, radians, a row a frame.
fn recording(seed: u64, frames: usize) -> Vec<f64> {
    let mut noise = vec![Block::ZERO; frames];
    Stage::new(seed, "recording").whole().fill_normal(Isa::best(), &mut noise);
    let row = |(t, z): (usize, &Block)| {
        let phase = 0.5 * t as f64 + seed as f64;
        [0.4 * phase.sin() + 0.01 * z.0[0], 0.5 * (1.0 - (phase + 0.9).cos()) + 0.01 * z.0[1]]
    };
    noise.iter().enumerate().flat_map(row).collect()
}

fn main() -> Result<(), sinew_dynamics::Error> {
    let (sequences, new) = ([recording(1, 300), recording(2, 300)], recording(3, 200));
    let motion = TrainingMotion { state: "leg", dim: 2, frame_rate: FPS, sequences: &sequences, horizontal: &[] };
    let feature = FeatureVector { name: "leg".into(), coordinates: vec![0, 1] };
    let mut config = Config::default();
    config.mixture.components = 12;
    let model = learn(&motion, &[feature], &config, Stage::new(1, "learning"), &mut |_| {})?;
    if let Some(errors) = prediction_errors(&model.primitives[0], std::slice::from_ref(&new), 2)? {
        println!("errors of {} steps that were not learned from, root mean square, radians", errors.steps);
        println!("  no change {:.3}", errors.no_change);
        println!("  constant velocity {:.3}", errors.constant_velocity.unwrap_or(f64::NAN));
        println!("  action primitives {:.3}", errors.switching);
    }
    let mut leg = PrimitiveMotion::new(&model, "leg", 1.0 / FPS, Isa::best())?;
    let rows = new.as_chunks::<2>().0;
    leg.follow(None, &rows[0]);
    (1..20).for_each(|t| leg.follow(Some(&rows[t - 1]), &rows[t]));
    let mut drawn = [Block::ZERO; 2];
    leg.sample_block(&splat(&rows[19]), &mut drawn, &mut Stage::new(2, "draws").whole());
    println!("frame 19 {:.2?}, frame 20 {:.2?}, drawn for it:", rows[19], rows[20]);
    println!("  hip  {:.2?}\n  knee {:.2?}", drawn[0].0, drawn[1].0);
    Ok(())
}
