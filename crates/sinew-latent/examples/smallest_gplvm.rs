//! The smallest program: a table of four columns that depend on one number, learned and asked for a row between two of its own.
//!
//! `cargo run --release -p sinew-latent --example smallest_gplvm`

use sinew_core::lanes::Isa;
use sinew_latent::gplvm;
use sinew_latent::mapping::Mapping;
use sinew_latent::training::{Config, Training};

fn row(n: f64) -> [f64; 4] {
    [0.0, 0.7, 1.4, 2.1].map(|lag| (0.2 * n + lag).sin())
}

fn main() -> Result<(), sinew_latent::Error> {
    let rows: Vec<f64> = (0..30).flat_map(|n| row(f64::from(n))).collect();
    let start = gplvm::model(&rows, 4, &gplvm::Config { dim: 2, ..gplvm::Config::default() })?;
    let mut training = Training::new(start, Config { steps: 200, ..Config::default() }, Isa::best())?;
    let end = training.run(|_| true);
    println!("objective {:.1} after {} steps", end.objective, end.steps);
    let model = training.into_model();
    let mapping = Mapping::new(&model, 0)?;
    let (seven, eight) = (model.nodes[0].latent(7), model.nodes[0].latent(8));
    let between: Vec<f64> = seven.iter().zip(eight).map(|(a, b)| 0.5 * (a + b)).collect();
    println!("latents of rows 7 and 8: {seven:.2?}, {eight:.2?}");
    println!("row 7½ found  {:6.3?} ± {:.3}", mapping.mean_at(&between), mapping.variance_at(&between).sqrt());
    println!("       truly  {:6.3?}", row(7.5));
    Ok(())
}
