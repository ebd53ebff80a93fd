//! The three-phase oil flow data (Bishop & James 1993), on which latent variable models are compared.

use sinew::latent::gplvm::{self, Config};
use sinew::latent::model::{LatentModel, RootPrior};
use sinew::latent::outputs::Preparation;
use std::path::Path;

/// Measurements of a row.
pub const COLUMNS: usize = 12;

/// Rows with their class.
#[derive(Clone, Debug, PartialEq)]
pub struct OilFlow {
    /// Class of each row.
    pub classes: Vec<u8>,
    /// Measurements, rows one after the other.
    pub rows: Vec<f64>,
}

impl OilFlow {
    /// The first rows of the training set in a folder.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub fn read(folder: &Path, count: usize) -> Result<Self, String> {
        let path = folder.join("trn.csv");
        let text = std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let (mut classes, mut rows) = (vec![], vec![]);
        for (number, line) in text.lines().enumerate().skip(1).take(count) {
            let cells = line.split(',').map(str::parse::<f64>).collect::<Result<Vec<_>, _>>();
            match cells.as_deref() {
                Ok([class, row @ ..]) if row.len() == COLUMNS => {
                    classes.push(*class as u8);
                    rows.extend_from_slice(row);
                }
                _ => {
                    return Err(format!(
                        "{}, line {}: expected a class and {COLUMNS} numbers",
                        path.display(),
                        number + 1
                    ));
                }
            }
        }
        Ok(Self { classes, rows })
    }

    /// The model that GPy learns of them: two coordinates from principal components, no prior of latents, columns centred.
    ///
    /// # Errors
    /// Rows without two principal components.
    pub fn model(&self) -> Result<LatentModel, sinew::latent::Error> {
        let config = Config { dim: 2, preparation: Preparation::Centred, prior: RootPrior::Flat, ..Config::default() };
        gplvm::model(&self.rows, COLUMNS, &config)
    }

    /// Rows whose nearest neighbour among latents of two coordinates is of another class.
    #[must_use]
    pub fn neighbour_errors(&self, latents: &[f64]) -> usize {
        let latents = latents.as_chunks::<2>().0;
        let square = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
        let is_wrong = |&n: &usize| {
            let others = (0..latents.len()).filter(|&m| m != n);
            let nearest =
                others.min_by(|&a, &b| square(&latents[a], &latents[n]).total_cmp(&square(&latents[b], &latents[n])));
            nearest.is_some_and(|m| self.classes[m] != self.classes[n])
        };
        (0..latents.len()).filter(is_wrong).count()
    }
}
