//! Coverage of the 90 % intervals on synthetic recordings whose errors are the stated ones.

use sinew::body::standard::EVALUATION_JOINTS;
use sinew::evaluation;
use sinew::pipeline::Settings;
use sinew::synthetic::detector::DetectorNoise;
use sinew::synthetic::recording::{Recording, Script};

/// Two walks with known proportions: the intervals must mean what they say. With the proportions of the set-up and a few seconds of motion, `docs/accuracy.md` has the numbers.
#[test]
fn intervals_of_ninety_per_cent_cover_the_truth_of_a_walk() {
    let script = Script { duration_s: 2.5, noise: DetectorNoise::stated_gaussian(3.0), ..Script::default() };
    let mut shares = vec![];
    for seed in [1, 2] {
        let mut recording = Recording::new(&script, seed).unwrap();
        let frames = recording.truth.frames.len() as u64;
        let truth = recording.truth.clone();
        let settings = Settings { seed, fps: script.rate_hz, ..Settings::default() };
        let known = Some(&script.proportions);
        let run = evaluation::run(&mut recording, 0..frames, 0..frames, &settings, known).unwrap();
        let covered = evaluation::covered(&run.tree, &run.filtered, &truth, &EVALUATION_JOINTS);
        shares.push(covered.iter().map(|f| f.iter().sum::<f64>() / f.len() as f64).collect::<Vec<f64>>());
    }
    let count = shares.iter().map(Vec::len).sum::<usize>() as f64;
    let mean = shares.iter().flatten().sum::<f64>() / count;
    let error = evaluation::block_bootstrap(&shares, 15, 200, 1);
    println!("coverage {:.1} ± {:.1} %", 100.0 * mean, 100.0 * error);
    // The bound allows for two short recordings beside the 5 % of the statement.
    assert!((mean - 0.9).abs() < 0.05 + 2.0 * error, "{mean} ± {error}");
}
