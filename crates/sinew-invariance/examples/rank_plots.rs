//! Rank histograms and ECDF differences of two samplers of one posterior, one of them too sure of itself.
//! Writes `ranks.svg` and `ecdf.svg` to the folder given, or here.
//!
//! `cargo run -p sinew-invariance --features svg --example rank_plots -- FOLDER`

use sinew_core::random::BlockRng;
use sinew_invariance::draws::normals;
use sinew_invariance::plot::{ecdf_differences, rank_histograms};
use sinew_invariance::{RankCalibration, Ranks, TestFunctions, calibration};
use std::error::Error;
use std::path::PathBuf;

/// Ranks of θ ~ N(0, 1) seen four times with errors of 1, within draws whose spread is `factor` times that of the posterior.
fn ranks(name: &str, factor: f64) -> Ranks {
    let posterior = |y: &[f64], n: usize, rng: &mut BlockRng| {
        let (mean, sd) = (y.iter().sum::<f64>() / 5.0, 0.2_f64.sqrt());
        normals(n, rng).into_iter().map(|z| vec![mean + factor * sd * z]).collect()
    };
    let prior = |rng: &mut BlockRng| normals(1, rng);
    let simulate = |theta: &[f64], rng: &mut BlockRng| normals(4, rng).iter().map(|z| theta[0] + z).collect();
    let functions = TestFunctions::none().with(name, |x| x[0]);
    let (report, ranks) = calibration(&RankCalibration::default(), prior, simulate, posterior, &functions);
    println!("{report}\n");
    ranks
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).map_or_else(PathBuf::new, PathBuf::from);
    let mut both = ranks("the posterior", 1.0);
    let narrow = ranks("30 % too narrow", 0.7);
    both.names.extend(narrow.names);
    both.ranks.extend(narrow.ranks);
    std::fs::write(folder.join("ranks.svg"), rank_histograms(&both, 20)?)?;
    std::fs::write(folder.join("ecdf.svg"), ecdf_differences(&both)?)?;
    Ok(())
}
