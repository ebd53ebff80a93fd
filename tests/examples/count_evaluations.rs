//! Evaluates problem28 a given number of times, for counting instructions:
//!
//! ```text
//! valgrind --tool=callgrind target/release/examples/count_evaluations avx2 posterior 1000
//! valgrind --tool=callgrind target/release/examples/count_evaluations avx2 posterior 2000
//! ```
//!
//! The difference of the two counts, divided by 8 · 1000, is the number of instructions a state. Valgrind shows the program a processor without AVX-512.

use sinew::core::density::GradLogDensity;
use sinew::core::lanes::{Block, Isa};
use sinew_tests::problem28;
use std::hint::black_box;

fn main() -> Result<(), String> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [set, part, blocks] = &arguments[..] else {
        return Err(
            "give an instruction set, `posterior`, `likelihood`, `views` or `prior`, and a number of blocks".into()
        );
    };
    let isa = Isa::by_name(set).ok_or(format!("this processor has no `{set}`"))?;
    let problem = problem28::load();
    let target: Box<dyn GradLogDensity> = match part.as_str() {
        "posterior" => Box::new(problem.target(isa)),
        "likelihood" => Box::new(problem.likelihood(isa)),
        "views" => Box::new(problem.likelihood_by_views(isa)),
        "prior" => Box::new(problem.prior(isa)),
        other => return Err(format!("no part `{other}`")),
    };
    let x: Vec<Block> = problem.true_pose.iter().map(|&x| Block::splat(x)).collect();
    let mut gradient = vec![Block::ZERO; x.len()];
    let mut workspace = vec![Block::ZERO; target.workspace()];
    for _ in 0..blocks.parse::<usize>().map_err(|error| error.to_string())? {
        black_box(target.log_density_grad_block(black_box(&x), &mut gradient, &mut workspace));
    }
    Ok(())
}
