//! Evaluates a density through a linear decoder a given number of times, for counting instructions.
//! The density has 32 coordinates, the decoder 8:
//!
//! ```text
//! valgrind --tool=callgrind target/release/examples/count_decoders avx2 through 1000
//! valgrind --tool=callgrind target/release/examples/count_decoders avx2 through 2000
//! ```
//!
//! The difference of the two counts, divided by 8 · 1000, is the number of instructions a state. Valgrind shows the program a processor without AVX-512.

use sinew_core::combinators::Through;
use sinew_core::decode::{Decode, Linear};
use sinew_core::density::{GradLogDensity, Lanes, LogDensity};
use sinew_core::lanes::{Block, Isa};
use sinew_core::toy::Quadratic;
use std::hint::black_box;

const SOURCE: usize = 8;
const TARGET: usize = 32;

fn main() -> Result<(), String> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [set, part, blocks] = &arguments[..] else {
        return Err("give an instruction set, `target`, `decoder` or `through`, and a number of blocks".into());
    };
    let isa = Isa::by_name(set).ok_or(format!("this processor has no `{set}`"))?;
    let entries = (0..SOURCE * TARGET).map(|e| (e as f64).sin()).collect();
    let decoder = Lanes { leaf: Linear::new(entries, SOURCE).map_err(|error| error.to_string())?, isa };
    let target = Lanes { leaf: Quadratic { centre: vec![0.1; TARGET], precision: vec![4.0; TARGET] }, isa };
    let through = Through { target: &target, decoder: &decoder };
    let (x, y) = (vec![Block::splat(0.3); SOURCE], vec![Block::splat(0.3); TARGET]);
    let (mut grad, mut grad_out) = (x.clone(), y.clone());
    let mut ws = vec![Block::ZERO; through.workspace()];
    for _ in 0..blocks.parse::<usize>().map_err(|error| error.to_string())? {
        match part.as_str() {
            "target" => {
                black_box(target.log_density_grad_block(black_box(&y), &mut grad_out, &mut ws));
            }
            "decoder" => {
                decoder.decode_block(black_box(&x), &mut grad_out, &mut ws);
                decoder.pullback_block(black_box(&x), black_box(&y), &mut grad, &mut ws);
                black_box(&grad);
            }
            "through" => {
                black_box(through.log_density_grad_block(black_box(&x), &mut grad, &mut ws));
            }
            other => return Err(format!("no part `{other}`")),
        }
    }
    Ok(())
}
