//! Numbers of result files against exact ones, over some runs.
//!
//! Of each column: how far its numbers lie from the exact ones, in exact standard deviations, and the mean of its widths over the exact widths. The latter must be 1 within four standard errors, which come from the differences between runs;
//! and these must be small enough that widths wrong by 3 % are noticed.

use std::collections::BTreeMap;

/// Error of a width that every check must notice.
const NOTICED: f64 = 0.03;
/// What a linearised search, few draws and rounding may add to four standard errors.
const ALLOWED: f64 = 0.004;

/// P(N(0, 1) < x), to 1e-7 (Abramowitz & Stegun 1964, 26.2.17).
pub fn normal_below(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.231_641_9 * x.abs());
    let series = [1.330_274_429, -1.821_255_978, 1.781_477_937, -0.356_563_782, 0.319_381_53];
    let tail = series.iter().fold(0.0, |sum, a| t * (sum + a)) * (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
    if x < 0.0 { tail } else { 1.0 - tail }
}

/// Where a rising function reaches a value between `low` and `high`, by bisection.
pub fn reached(function: impl Fn(f64) -> f64, value: f64, [mut low, mut high]: [f64; 2]) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        *(if function(middle) < value { &mut low } else { &mut high }) = middle;
    }
    low
}

fn normal_quantile(p: f64) -> f64 {
    reached(normal_below, p, [-10.0, 10.0])
}

/// What the runs so far said.
#[derive(Default)]
pub struct Tally {
    /// By column, distances in standard deviations, and how large they may be (root mean square).
    places: BTreeMap<String, (Vec<f64>, f64)>,
    /// By column and run, ratios of widths.
    widths: BTreeMap<String, Vec<Vec<f64>>>,
    runs: usize,
}

impl Tally {
    /// Begins another run.
    pub fn begin_run(&mut self) {
        self.runs += 1;
        self.widths.values_mut().for_each(|runs| runs.push(vec![]));
    }

    /// Adds a number that should be `exact`, where the exact standard deviation is `sd`, and as a mean of so many draws is at most twice their error from it.
    pub fn place(&mut self, column: &str, found: f64, exact: f64, sd: f64, draws: usize) {
        assert!(found.is_finite(), "{column}: {found}");
        let (all, allowed) = self.places.entry(column.to_owned()).or_default();
        all.push((found - exact) / sd);
        *allowed = 2.0 / (draws as f64).sqrt();
    }

    /// Adds a width that should be `exact`.
    pub fn width(&mut self, column: &str, found: f64, exact: f64) {
        assert!(found.is_finite(), "{column}: {found}");
        let runs = self.runs;
        let by_run = self.widths.entry(column.to_owned()).or_insert_with(|| vec![vec![]; runs]);
        by_run.last_mut().unwrap().push(found / exact);
    }

    /// Adds a standard deviation that should be `exact`, where it is that of so many draws: theirs is less by ¾ of the share of one of them.
    pub fn sd(&mut self, column: &str, found: f64, exact: f64, draws: usize) {
        self.width(column, found, exact * (1.0 - 0.75 / draws as f64));
    }

    /// Adds both ends of a 90 % interval of which these are the exact ones, where they are the k-th least and the k-th largest of so many draws, k = ⌈n/20⌉.
    ///
    /// The k-th of n lies where a share (k − 3/8)/(n + 1/4) is below (Blom 1958).
    pub fn interval(&mut self, column: &str, [low, high]: [f64; 2], exact: [f64; 2], draws: usize) {
        let (middle, width) = (0.5 * (exact[0] + exact[1]), exact[1] - exact[0]);
        self.place(&format!("{column}, middle"), 0.5 * (low + high), middle, width / (2.0 * 1.644_853_6), draws);
        let (n, k) = (draws as f64, (0.05 * draws as f64).ceil());
        let end = -normal_quantile((k - 0.375) / (n + 0.25));
        self.width(&format!("{column}, width"), high - low, width * end / 1.644_853_6);
    }

    /// Asserts that places and widths are right.
    pub fn check(&self) {
        let mut wrong = vec![];
        for (column, (z, allowed)) in &self.places {
            let count = z.len() as f64;
            let rms = (z.iter().map(|z| z * z).sum::<f64>() / count).sqrt();
            println!("{column}: {count} numbers, {rms:.4} sd from the exact ones");
            if rms > *allowed {
                wrong.push(format!("{column}: {rms:.4} sd from the exact numbers, {allowed:.4} are allowed"));
            }
        }
        for (column, runs) in &self.widths {
            let means: Vec<f64> = runs.iter().map(|ratios| ratios.iter().sum::<f64>() / ratios.len() as f64).collect();
            let count = means.len() as f64;
            let mean = means.iter().sum::<f64>() / count;
            let error = (means.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0) / count).sqrt();
            println!("{column}: {mean:.4} ± {error:.4} of the exact width");
            let tolerance = 4.0 * error + ALLOWED;
            if (mean - 1.0).abs() > tolerance {
                wrong.push(format!("{column}: {mean:.4} ± {error:.4} of the exact width"));
            }
            if tolerance > NOTICED {
                wrong.push(format!("{column}: ± {error:.4}: an error of 3 % would not be noticed"));
            }
        }
        assert!(wrong.is_empty(), "{wrong:#?}");
    }
}
