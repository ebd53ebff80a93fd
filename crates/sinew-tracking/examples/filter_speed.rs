//! Times of the filter on the model of `crates/sinew-studies/peers/particles_filter.py`, which runs it: numbers of a series from the standard input, the number of particles as its argument.
//!
//! With `one` or `eight` behind it only that way of writing the model is run, for counting instructions:
//!
//! ```text
//! seq 100 | RAYON_NUM_THREADS=1 valgrind --tool=callgrind target/release/examples/filter_speed 120 eight
//! seq 100 | RAYON_NUM_THREADS=1 valgrind --tool=callgrind target/release/examples/filter_speed 240 eight
//! ```
//!
//! The difference of the two counts, divided by 5 · 100 · 120, is the number of instructions a particle and frame. Copies of more than 2 KB would be counted byte by byte.

mod walk;

use sinew_core::lanes::Isa;
use sinew_tracking::Error;
use sinew_tracking::state_space::{Settings, filter};
use std::time::Instant;
use walk::Walk;

/// Least time of five runs in nanoseconds a particle and frame, and the log evidence.
fn time<const BLOCKS: bool>(series: &[f64], particles: usize) -> Result<String, Error> {
    let settings = Settings { particles, resample_below: 1.0, ..Settings::default() };
    let (mut least, mut log_evidence) = (f64::INFINITY, 0.0);
    for _ in 0..5 {
        let start = Instant::now();
        log_evidence = filter(&Walk::<BLOCKS>(Isa::best()), series, settings.clone())?.log_evidence;
        least = least.min(start.elapsed().as_nanos() as f64 / (particles * series.len()) as f64);
    }
    Ok(format!("{least:.2} {log_evidence:.3}"))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let particles = arguments.next().ok_or("the number of particles is missing")?.parse()?;
    let only = arguments.next();
    let series = std::io::read_to_string(std::io::stdin())?;
    let series = series.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>()?;
    let mut found = vec![];
    if only.as_deref() != Some("eight") {
        found.push(time::<false>(&series, particles)?);
    }
    if only.as_deref() != Some("one") {
        found.push(time::<true>(&series, particles)?);
    }
    println!("{}", found.join(" "));
    Ok(())
}
