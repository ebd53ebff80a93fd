//! The claims CF8 and CF10, about filters over frames in a row.

use super::multi::SHOWN;
use super::problem::MODELS;
use super::scene::Source;
use super::study::{MULTI, Study, series};
use crate::papers::claim::Claim;
use crate::support::outcome::Outcome;
use crate::support::statistics::mean;
use crate::support::store::Store;
use sinew_tests::finding::mean_and_error;

/// Mean and z of a difference that is zero if nothing is different.
fn paired(differences: &[f64]) -> [f64; 2] {
    let [middle, error] = mean_and_error(differences);
    [middle, middle / error]
}

/// What both filters reach over frames, from markers of one source.
struct OverFrames {
    likelihoods: String,
    errors: String,
    /// Whether hmc is ahead with z > 3 in every likelihood and prior, and in every error.
    higher: bool,
    nearer: bool,
}

fn over_all_frames(study: &Study, store: &Store, source: Source) -> Outcome<OverFrames> {
    let mut likelihoods = vec![];
    let (mut higher, mut nearer, mut errors) = (true, true, vec![]);
    for index in 0..MULTI.len() {
        let dim = MODELS[MULTI[index].0].dim;
        for (name, words) in [("log_likelihood", "log likelihood"), ("log_prior", "log prior")] {
            let [hmc, particles] = series(study, store, source, index, name)?;
            let late = |run: &Vec<f64>| mean(&run[4..]);
            let differences: Vec<f64> = hmc.iter().zip(&particles).map(|(a, b)| late(a) - late(b)).collect();
            let [middle, z] = paired(&differences);
            higher &= middle > 0.0 && z > 3.0;
            likelihoods.push(format!("{dim}-D {words} {middle:+.1} (z = {z:.1})"));
        }
        let [hmc, particles] = series(study, store, source, index, "error_m")?;
        let differences: Vec<f64> = hmc.iter().zip(&particles).map(|(a, b)| b[SHOWN - 1] - a[SHOWN - 1]).collect();
        let [_, z] = paired(&differences);
        let of = |all: &[Vec<f64>]| 1e3 * mean(all.iter().map(|run| run[SHOWN - 1]).collect::<Vec<_>>());
        nearer &= z > 3.0;
        errors.push(format!("{dim}-D {:.1} mm against {:.1} mm (z = {z:.1})", of(&hmc), of(&particles)));
    }
    Ok(OverFrames { likelihoods: likelihoods.join(", "), errors: errors.join(", "), higher, nearer })
}

/// Judges them.
pub(super) fn multi_claims(study: &Study, store: &Store, claims: &mut Vec<Claim>) -> Outcome<()> {
    let main = over_all_frames(study, store, Source::Recorded)?;
    let control = over_all_frames(study, store, Source::Fitted)?;
    claims.push(Claim {
        id: "CF8",
        paper: "over 25 frames hmc has the higher log likelihood of the mean and log prior of the truth",
        ours: format!("hmc − pf: {}; with markers of the fitted body: {}", main.likelihoods, control.likelihoods),
        criterion: "differences over frames 5–25 above 0 with z > 3, in 10-D and 28-D",
        pass: main.higher,
    });
    claims.push(Claim {
        id: "CF10",
        paper: "hmc's estimates are nearer to the truth at frame 10",
        ours: format!("{}; with markers of the fitted body: {}", main.errors, control.errors),
        criterion: "mean joint error lower with z > 3",
        pass: main.nearer,
    });
    Ok(())
}
