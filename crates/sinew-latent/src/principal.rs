//! Start of latents: leading principal components.

use crate::Error;
use sinew_dynamics::pca::{Keep, fit};

/// Scores of rows of length `cols` on their `dim` leading components, each with unit variance: rows of `dim`.
///
/// # Errors
/// [`Error::Principal`] for rows without variance, [`Error::Shape`] where they have fewer components than that.
pub fn principal_scores(rows: &[f64], cols: usize, dim: usize) -> Result<Vec<f64>, Error> {
    let pca = fit(rows, cols, Keep { share: 1.0, most: dim })?;
    if pca.len() < dim {
        return Err(Error::Shape { name: "principal components of the data", found: pca.len(), expected: dim });
    }
    let scores = rows.chunks_exact(cols).flat_map(|row| pca.project(row));
    Ok(scores.enumerate().map(|(k, score)| score / pca.variances[k % dim].max(f64::MIN_POSITIVE).sqrt()).collect())
}
