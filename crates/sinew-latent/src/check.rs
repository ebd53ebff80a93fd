//! Sizes that a latent model from a file may have, and that its tree leads to every column.
//!
//! Sizes are bounded so that what is computed from a model stays finite and small: a covariance of at most [`MAX_ROWS`] points whose entries and white noise are within these bounds has a Cholesky factor, at the latest with the jitter that
//! processes add to its diagonal.

use crate::Error;
use crate::covariance::Covariance;
use crate::model::{LatentModel, LatentNode, Outputs, RootPrior};

/// Rows of a model from a file at most.
pub const MAX_ROWS: usize = 4000;
/// Its columns at most.
pub const MAX_COLUMNS: usize = 1000;
/// Its nodes at most.
const MAX_NODES: usize = 256;
/// Entries of the covariances of all nodes together at most: each keeps a factor.
const MAX_ENTRIES: usize = 4 * MAX_ROWS * MAX_ROWS;
/// Data, latents and coefficients are at most this large.
const LARGEST: f64 = 1e6;
/// Parameters of covariances, divisors, weights, λ, κ and widths that are present are within these.
const LEAST_PARAMETER: f64 = 1e-12;
const LARGEST_PARAMETER: f64 = 1e12;
/// Least variance of white noise.
const LEAST_NOISE: f64 = 1e-9;

/// Sizes of a model from a file, before anything is computed from them.
///
/// # Errors
/// [`Error::TooMany`] and [`Error::OutOfRange`].
pub(crate) fn sizes(model: &LatentModel) -> Result<(), Error> {
    let most = |name, found, most| if found <= most { Ok(()) } else { Err(Error::TooMany { name, found, most }) };
    most("columns", model.columns, MAX_COLUMNS)?;
    most("numbers of data", model.data.len(), MAX_ROWS * model.columns)?;
    most("nodes", model.nodes.len(), MAX_NODES)?;
    let square = |node: &LatentNode| node.rows.len().saturating_mul(node.rows.len());
    let entries = model.nodes.iter().fold(0_usize, |sum, node| sum.saturating_add(square(node)));
    most("entries of the covariances of all nodes", entries, MAX_ENTRIES)?;
    within("number of the data", &model.data)?;
    within("mean", &model.standard.mean)?;
    moderate("divisor", &model.standard.scale)?;
    for node in &model.nodes {
        within("latent", &node.latents)?;
        moderate("weight", &node.weights)?;
        covariance(&node.covariance)?;
        if let Some(back) = &node.back {
            within("coefficient", &back.coefficients)?;
            moderate("inverse width of a back constraint", &[back.inverse_width])?;
        }
    }
    if let RootPrior::Dynamics { covariance: dynamics, balance, .. } = &model.prior {
        covariance(dynamics)?;
        moderate("balance", &[*balance])?;
    }
    model.kappa.map_or(Ok(()), |kappa| moderate("kappa", &[kappa]))
}

/// Every root leads to all columns, each by one leaf, and the roots' rows follow each other: every row has one root.
///
/// # Errors
/// [`Error::Shape`] and [`Error::OutOfRange`].
pub(crate) fn covers(model: &LatentModel) -> Result<(), Error> {
    let mut end = 0;
    for root in model.roots() {
        let rows = &model.nodes[root].rows;
        if rows.start != end {
            return Err(Error::Shape { name: "first row of a root", found: rows.start, expected: end });
        }
        end = rows.end;
        let mut generated = vec![0_u32; model.columns];
        let mut open = vec![root];
        while let Some(n) = open.pop() {
            match &model.nodes[n].outputs {
                Outputs::Nodes(children) => open.extend(children),
                Outputs::Columns(columns) => columns.iter().for_each(|&j| generated[j] += 1),
            }
        }
        if let Some(index) = generated.iter().position(|&count| count != 1) {
            let value = f64::from(generated[index]);
            let expected = "must be the number of leaves that generate it below each root, one";
            return Err(Error::OutOfRange { name: "column", index, value, expected });
        }
    }
    let (found, expected) = (end, model.rows());
    if found == expected { Ok(()) } else { Err(Error::Shape { name: "rows of all roots", found, expected }) }
}

fn covariance(covariance: &Covariance) -> Result<(), Error> {
    let present: Vec<f64> = covariance.to_array().into_iter().filter(|&x| x != 0.0).collect();
    moderate("covariance parameter", &present)?;
    if covariance.white < LEAST_NOISE {
        let (name, expected) = ("variance of white noise", "must be at least 1e-9");
        return Err(Error::OutOfRange { name, index: 0, value: covariance.white, expected });
    }
    Ok(())
}

fn within(name: &'static str, values: &[f64]) -> Result<(), Error> {
    match values.iter().position(|x| x.is_nan() || x.abs() > LARGEST) {
        Some(index) => Err(Error::OutOfRange { name, index, value: values[index], expected: "must be at most 1e6" }),
        None => Ok(()),
    }
}

fn moderate(name: &'static str, values: &[f64]) -> Result<(), Error> {
    match values.iter().position(|x| !(LEAST_PARAMETER..=LARGEST_PARAMETER).contains(x)) {
        Some(index) => {
            Err(Error::OutOfRange { name, index, value: values[index], expected: "must be from 1e-12 to 1e12" })
        }
        None => Ok(()),
    }
}
