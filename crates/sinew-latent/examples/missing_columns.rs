//! Fills in what is missing of new rows of a table, with its uncertainty.
//!
//! `cargo run --release -p sinew-latent --example missing_columns`
//!
//! A GPLVM with two coordinates a latent is learned from 80 whole rows of eight columns, which depend on two hidden numbers only. Of ten new rows five columns are known. The posterior of each row's latent (modes, then importance weights) says
//! what the other three are; the truth should lie within two standard deviations nearly always.

use sinew_core::lanes::Isa;
use sinew_core::random::Stage;
use sinew_latent::gplvm;
use sinew_latent::inference::{Config as Inference, infer, predict};
use sinew_latent::latent_density::{LatentDensity, LatentPrior};
use sinew_latent::mapping::Mapping;
use sinew_latent::training::{Config, Training};
use std::error::Error;
use std::sync::Arc;

const COLUMNS: usize = 8;
const KNOWN: [usize; 5] = [0, 2, 3, 5, 6];
const MISSING: [usize; 3] = [1, 4, 7];

/// A row of the table: smooth functions of two hidden numbers that wander with n.
fn row(n: usize) -> [f64; COLUMNS] {
    let (a, b) = ((0.37 * n as f64).sin(), (0.23 * n as f64 + 1.0).cos());
    [a, b, a * b, a + 0.5 * b, (1.5 * a).sin() - b, a * a, b * b - a, (a - b).cos()]
}

fn main() -> Result<(), Box<dyn Error>> {
    let whole: Vec<f64> = (0..80).flat_map(row).collect();
    let start = gplvm::model(&whole, COLUMNS, &gplvm::Config { dim: 2, ..gplvm::Config::default() })?;
    let mut training = Training::new(start, Config { steps: 300, ..Config::default() }, Isa::best())?;
    training.run(|_| true);
    let model = training.into_model();
    let mapping = Arc::new(Mapping::new(&model, 0)?);
    let (mut within, mut count) = (0, 0);
    println!("row  column   truth  filled in");
    for n in 200..210 {
        let truth = row(n);
        let observed = KNOWN.iter().map(|&column| (column, truth[column])).collect();
        let density = LatentDensity::given(mapping.clone(), LatentPrior::of(&model, 0), observed)?;
        let posterior = infer(&density, &Inference::default(), Stage::new(1, "missing columns").round(n))?;
        let filled = predict(&density, &posterior);
        for column in MISSING {
            let (mean, sd) = (filled[column].mean, (filled[column].variance + filled[column].noise).sqrt());
            println!("{n:3}  {column:6}  {:6.3}  {mean:6.3} ± {:.3}", truth[column], 2.0 * sd);
            within += usize::from((truth[column] - mean).abs() <= 2.0 * sd);
            count += 1;
        }
    }
    println!("{within} of {count} within two standard deviations");
    Ok(())
}
