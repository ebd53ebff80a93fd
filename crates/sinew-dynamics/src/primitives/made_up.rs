//! Made-up motion and action primitives of two coordinates, for tests.

use crate::primitives::learning::{Config, TrainingMotion, learn};
use crate::primitives::model::{FeatureVector, PrimitiveModel, Primitives};
use sinew_core::lanes::{Block, Isa};
use sinew_core::random::Stage;

/// Two sequences of four coordinates: 0 and 2 walk at random, 1 and 3 swing, the latter at another pace.
pub fn sequences(frames: usize) -> Vec<Vec<f64>> {
    let sequence = |number: usize| {
        let mut noise = vec![Block::ZERO; frames * 2];
        Stage::new(number as u64, "made up").whole().fill_normal(Isa::baseline(), &mut noise);
        let (mut x, mut y) = (0.0, 0.0);
        let row = |t: usize| {
            let z = noise[2 * t].0;
            x += 0.05 * z[0];
            y += 0.02 * z[1];
            let phase = 0.37 * t as f64 + 2.0 * number as f64;
            let swings = [phase.sin() + 0.05 * z[2], 0.6 * (0.8 * phase).cos() + 0.05 * z[3]];
            [x, swings[0], y, swings[1]]
        };
        (0..frames).flat_map(row).collect()
    };
    [0, 1].map(sequence).to_vec()
}

/// A model of the two swinging coordinates, the later first.
pub fn model() -> PrimitiveModel {
    let sequences = sequences(150);
    let motion = TrainingMotion { state: "made up", dim: 4, frame_rate: 20.0, sequences: &sequences, horizontal: &[] };
    let feature = FeatureVector { name: "swing".into(), coordinates: vec![3, 1] };
    let mut config = Config::default();
    config.mixture.components = 8;
    learn(&motion, &[feature], &config, Stage::new(1, "model"), &mut |_| {}).expect("valid")
}

/// Its action primitives.
pub fn primitives() -> Primitives {
    model().primitives.remove(0)
}
