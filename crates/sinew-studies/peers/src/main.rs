//! Samplers beside each other on the benchmark problem, one thread.
//!
//! nuts-rs with our gradient of one state, and our samplers over eight lanes.
//!
//! `cargo run --release -p sinew-peers -- [seeds]` prints a table in Markdown; every row is the median over the seeds (3 by default). It ends with 1 where a
//! posterior mean is more than four standard errors from the long run's.
//!
//! Seconds are the thread's on a processor. Warm-up is everything before the first kept draw: mode, metric, starts, tuning of step size and length, burn-in. Effective sample sizes are the bulk's (rank-normalised, split chains), the least
//! over the 28 coordinates, of the coordinate and of its squared distance from the posterior mean.

mod measure;
mod ours;
mod peer;
mod problem;

use measure::{Row, Run};
use problem::Problem;
use sinew::core::density::{GradLogDensity, LogDensity};
use sinew::core::lanes::Block;
use std::error::Error;
use std::hint::black_box;
use std::process::ExitCode;
use std::time::Instant;

/// The least of many short measurements, since anything else on the core only adds.
fn nanoseconds(mut call: impl FnMut()) -> f64 {
    let measured = (0..200).map(|_| {
        let start = Instant::now();
        (0..500).for_each(|_| call());
        start.elapsed().as_secs_f64() * 1e9 / 500.0
    });
    measured.fold(f64::INFINITY, f64::min)
}

/// Nanoseconds of a gradient of one state, and of a state in a block of eight.
fn gradient_costs(problem: &Problem) -> (f64, f64) {
    let target = problem.target();
    let (x, mut g) = (&problem.middle, vec![0.0; 28]);
    let one = nanoseconds(|| {
        black_box(target.log_density_grad(black_box(x), &mut g));
    });
    let x: Vec<Block> = x.iter().map(|&x| Block::splat(x)).collect();
    let (mut g, mut ws) = (x.clone(), vec![Block::ZERO; target.workspace()]);
    let eight = nanoseconds(|| {
        black_box(target.log_density_grad_block(black_box(&x), &mut g, &mut ws));
    });
    (one, eight / 8.0)
}

type Sampler = Box<dyn Fn(&Problem, u64) -> Result<Run, Box<dyn Error>>>;

fn samplers() -> Vec<(String, Sampler)> {
    let mut all: Vec<(String, Sampler)> = vec![
        ("nuts-rs, low-rank metric".into(), Box::new(peer::low_rank)),
        ("nuts-rs, diagonal metric".into(), Box::new(peer::diagonal)),
    ];
    for chains in [8, 1] {
        for method in ours::Method::ALL {
            for metric in ours::Choice::ALL {
                // The proposal of jumps is learned, and so then is the metric.
                if method == ours::Method::Jumps && metric != ours::Choice::Learned {
                    continue;
                }
                let name = format!(
                    "{}, {}, {chains} chain{}",
                    method.name(),
                    metric.name(),
                    if chains > 1 { "s" } else { "" }
                );
                all.push((name, Box::new(move |problem, seed| ours::run(problem, method, metric, chains, seed))));
            }
        }
    }
    all
}

fn compare(seeds: u64) -> Result<bool, Box<dyn Error>> {
    let problem = Problem::load();
    let (one, lane) = gradient_costs(&problem);
    println!(
        "Instruction set {}; a gradient of one state {one:.0} ns, of a state in a block {lane:.0} ns.\n",
        problem.isa.name()
    );
    println!("{}", Row::HEAD);
    let mut worst = 0.0_f64;
    for (name, sampler) in samplers() {
        let mut runs = Vec::new();
        for seed in 1..=seeds {
            runs.push(sampler(&problem, seed)?);
        }
        let rows: Vec<Row> = runs.iter().map(|run| Row::new(run, 0.0)).collect();
        worst = rows.iter().map(|row| row.z).fold(worst, f64::max);
        println!("| {name} {}", Row::median(&rows));
        if name.starts_with("nuts-rs") {
            // The same run with the gradient's cost replaced.
            let dearer: Vec<Row> = runs.iter().map(|run| Row::new(run, (1000.0 - one) * 1e-9)).collect();
            println!("| {name}, a gradient taken as 1000 ns {}", Row::median(&dearer));
        }
    }
    println!("\nLargest |z| of a mean against the long run: {worst:.2} (bound 4).");
    Ok(worst <= 4.0)
}

fn main() -> ExitCode {
    let seeds = std::env::args().nth(1).and_then(|seeds| seeds.parse().ok()).unwrap_or(3);
    let pool = match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(pool) => pool,
        Err(error) => {
            eprintln!("error: {error}");
            return ExitCode::from(2);
        }
    };
    match pool.install(|| compare(seeds).map_err(|error| error.to_string())) {
        Ok(agrees) => ExitCode::from(u8::from(!agrees)),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
