//! What a run is worth: effective samples a second and a gradient, and agreement with the long run.

use sinew::core::diagnostics::{bulk_ess, mcse_of_mean};
use sinew::core::estimators::median;
use sinew_tests::problem28;
use std::fmt;
use std::fs;
use std::time::Instant;

/// Seconds of this thread on a processor, where the system gives them (Linux), so that what else runs on the machine counts for less; else seconds of the wall clock.
pub struct Clock {
    start: Instant,
    on_processor: Option<f64>,
}

fn on_processor() -> Option<f64> {
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(text.split_whitespace().next()?.parse::<f64>().ok()? * 1e-9)
}

impl Clock {
    /// Starts to measure.
    pub fn start() -> Self {
        Self { start: Instant::now(), on_processor: on_processor() }
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        match (self.on_processor, on_processor()) {
            (Some(before), Some(now)) => now - before,
            _ => self.start.elapsed().as_secs_f64(),
        }
    }
}

/// A finished run.
pub struct Run {
    /// Draws by coordinate and chain.
    pub series: Vec<Vec<Vec<f64>>>,
    /// Seconds of the thread before the first kept draw, and from there on.
    pub seconds: [f64; 2],
    /// Gradients before the first kept draw where counted, and from there on.
    pub gradients: [usize; 2],
    /// Mean acceptance probability, where known.
    pub acceptance: Option<f64>,
    /// Mean leapfrog steps of a transition.
    pub length: f64,
    /// Mean depth of a tree, where there are trees.
    pub depth: Option<f64>,
    /// Divergent transitions that were kept.
    pub divergences: usize,
}

/// A row of the table.
pub struct Row {
    numbers: [f64; 11],
    /// Largest distance of a mean from the long run's, in combined standard errors.
    pub z: f64,
}

impl Row {
    /// Heading of the table.
    pub const HEAD: &str = "| sampler | ESS/s | with warm-up | ESS/s of squares | with warm-up | ESS per 1000 gradients | of squares | acceptance | steps | depth | divergences | warm-up, s | largest \\|z\\| |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|";

    /// The row of one run, were a gradient dearer by that many seconds.
    pub fn new(run: &Run, dearer: f64) -> Self {
        let long_run = problem28::long_run();
        let (mut ess, mut squares, mut z) = (f64::INFINITY, f64::INFINITY, 0.0_f64);
        for (j, chains) in run.series.iter().enumerate() {
            let centre = long_run.mean[j];
            let square = |chain: &Vec<f64>| chain.iter().map(|x| (x - centre) * (x - centre)).collect();
            ess = ess.min(bulk_ess(chains));
            squares = squares.min(bulk_ess(&chains.iter().map(square).collect::<Vec<Vec<f64>>>()));
            let mean = chains.iter().flatten().sum::<f64>() / chains.iter().map(Vec::len).sum::<usize>() as f64;
            z = z.max(((mean - centre) / mcse_of_mean(chains).hypot(long_run.mcse[j])).abs());
        }
        let [before, sampling] = [0, 1].map(|k| run.seconds[k] + dearer * run.gradients[k] as f64);
        let thousands = run.gradients[1] as f64 / 1000.0;
        let numbers = [
            ess / sampling,
            ess / (before + sampling),
            squares / sampling,
            squares / (before + sampling),
            ess / thousands,
            squares / thousands,
            run.acceptance.unwrap_or(f64::NAN),
            run.length,
            run.depth.unwrap_or(f64::NAN),
            run.divergences as f64,
            before,
        ];
        Self { numbers, z }
    }

    /// Medians of all numbers, and the largest z.
    pub fn median(rows: &[Self]) -> Self {
        let mut numbers = [f64::NAN; 11];
        for (k, middle) in numbers.iter_mut().enumerate() {
            let mut values: Vec<f64> = rows.iter().map(|row| row.numbers[k]).collect();
            *middle = median(&mut values);
        }
        Self { numbers, z: rows.iter().map(|row| row.z).fold(0.0, f64::max) }
    }
}

impl fmt::Display for Row {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = [0, 0, 0, 0, 2, 2, 2, 1, 1, 0, 2];
        for (number, digits) in self.numbers.iter().zip(digits) {
            if number.is_nan() {
                write!(f, "| – ")?;
            } else {
                write!(f, "| {number:.digits$} ")?;
            }
        }
        write!(f, "| {:.1} |", self.z)
    }
}
