//! What a latent model is: nodes whose latents generate columns of data, or the latents of other nodes.
//!
//! Each node n has latents X_n (N rows of q_n coordinates) and generates its outputs O_n by independent Gaussian processes on X_n, one an output, all with the same covariance: log p = Σ_n log GP(O_n W_n | X_n) + log p(X_root). A GPLVM
//! (Lawrence 2005) and a GPDM (Wang, Fleet & Hertzmann 2008) have one node, an HGPLVM (Lawrence & Moore 2007) a tree of them: leaves generate columns of the data, inner nodes the latents of their children.

use crate::Error;
use crate::back_constraint::BackConstraint;
use crate::columns::count_rows;
use crate::covariance::{Covariance, Learned};
use crate::outputs::Standard;
use crate::ranges::{finite, positive};
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// What a node generates.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outputs {
    /// Columns of the data.
    Columns(Vec<usize>),
    /// All latents of these nodes, one after the other; they stand behind this node.
    Nodes(Vec<usize>),
}

/// A latent space and the Gaussian processes on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LatentNode {
    /// What it generates.
    pub outputs: Outputs,
    /// Rows of the data that it has latents of: all, or the rows of one motion.
    pub rows: Range<usize>,
    /// Coordinates q of a latent.
    pub dim: usize,
    /// Latents, one row of q after the other.
    pub latents: Vec<f64>,
    /// Covariance of all its processes.
    pub covariance: Covariance,
    /// Which of the covariance's parameters are learned.
    pub learned: Learned,
    /// W: factors of the outputs, one an output.
    pub weights: Vec<f64>,
    /// A map from data to latents that the latents obey.
    pub back: Option<BackConstraint>,
}

/// The prior of the latents that no other node generates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RootPrior {
    /// None: the density is 1 everywhere.
    Flat,
    /// Each latent is N(0, I).
    Normal,
    /// A Gaussian process from each latent to the one after it in its sequence; the first is N(0, I).
    Dynamics {
        /// Its covariance.
        covariance: Covariance,
        /// Which of its parameters are learned.
        learned: Learned,
        /// λ, the factor of the log prior: 1, or D/q where it is balanced (Urtasun, Fleet & Fua 2006).
        balance: f64,
    },
}

/// A latent model with the data that it was learned from.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LatentModel {
    /// Columns D of the data.
    pub columns: usize,
    /// The data, one row of D after the other, in their own units.
    pub data: Vec<f64>,
    /// Rows of each sequence; sequences follow each other.
    pub sequences: Vec<usize>,
    /// Means and divisors of the columns.
    pub standard: Standard,
    /// The nodes, each before those that it generates.
    pub nodes: Vec<LatentNode>,
    /// The prior of the roots' latents.
    pub prior: RootPrior,
    /// κ of the half-normal prior of the weights W, where these are learned; learned parameters θ of covariances then have the prior 1/θ (1/θ⁻¹ for the white noise, whose parameter is a precision there).
    pub kappa: Option<f64>,
}

impl LatentNode {
    /// A node over all rows whose latents are to be set.
    #[must_use]
    pub fn new(outputs: Outputs, rows: Range<usize>, dim: usize, latents: Vec<f64>, covariance: Covariance) -> Self {
        let count = match &outputs {
            Outputs::Columns(columns) => columns.len(),
            Outputs::Nodes(_) => 0,
        };
        let learned = covariance.present();
        Self { outputs, rows, dim, latents, covariance, learned, weights: vec![1.0; count], back: None }
    }

    /// The latent of a row of the node.
    #[must_use]
    pub fn latent(&self, row: usize) -> &[f64] {
        &self.latents[row * self.dim..][..self.dim]
    }
}

impl LatentModel {
    /// Number of rows of the data.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.data.len() / self.columns
    }

    /// A row of the data.
    #[must_use]
    pub fn row(&self, row: usize) -> &[f64] {
        &self.data[row * self.columns..][..self.columns]
    }

    /// The nodes that no other node generates.
    #[must_use]
    pub fn roots(&self) -> Vec<usize> {
        let generated =
            |n: usize| self.nodes.iter().any(|node| matches!(&node.outputs, Outputs::Nodes(c) if c.contains(&n)));
        (0..self.nodes.len()).filter(|&n| !generated(n)).collect()
    }

    /// Number of outputs of a node.
    #[must_use]
    pub fn output_count(&self, node: usize) -> usize {
        match &self.nodes[node].outputs {
            Outputs::Columns(columns) => columns.len(),
            Outputs::Nodes(nodes) => nodes.iter().map(|&c| self.nodes[c].dim).sum(),
        }
    }

    /// Lengths of the sequences within some rows.
    pub(crate) fn sequences_within(&self, rows: &Range<usize>) -> Vec<usize> {
        let mut start = 0;
        let mut within = Vec::new();
        for &length in &self.sequences {
            if start >= rows.start && start + length <= rows.end {
                within.push(length);
            }
            start += length;
        }
        within
    }

    /// Outputs of a node, rows one after the other: standardised columns, or latents.
    #[must_use]
    pub fn prepared(&self, node: usize) -> Vec<f64> {
        let LatentNode { outputs, rows, .. } = &self.nodes[node];
        let mut values = Vec::with_capacity(rows.len() * self.output_count(node));
        for row in rows.clone() {
            match outputs {
                Outputs::Columns(columns) => {
                    let (data, Standard { mean, scale }) = (self.row(row), &self.standard);
                    values.extend(columns.iter().map(|&j| (data[j] - mean[j]) / scale[j]));
                }
                Outputs::Nodes(nodes) => {
                    for &c in nodes {
                        let child = &self.nodes[c];
                        values.extend_from_slice(child.latent(row - child.rows.start));
                    }
                }
            }
        }
        values
    }

    /// Outputs of a node as its processes see them: prepared, times W.
    #[must_use]
    pub fn weighed(&self, node: usize) -> Vec<f64> {
        let mut values = self.prepared(node);
        let weights = &self.nodes[node].weights;
        if !weights.is_empty() {
            values
                .chunks_exact_mut(weights.len())
                .for_each(|row| row.iter_mut().zip(weights).for_each(|(x, w)| *x *= w));
        }
        values
    }

    /// Everything that a model from a file must fulfil, so that it can be used without an error.
    ///
    /// # Errors
    /// [`Error::Shape`] and [`Error::OutOfRange`] with the place.
    pub fn check(&self) -> Result<(), Error> {
        let rows = count_rows("data", &self.data, self.columns)?;
        let shape = |name, found, expected| {
            if found == expected { Ok(()) } else { Err(Error::Shape { name, found, expected }) }
        };
        let total = self.sequences.iter().try_fold(0_usize, |sum, &length| sum.checked_add(length));
        shape("all sequences together", total.unwrap_or(usize::MAX), rows)?;
        shape("means of the columns", self.standard.mean.len(), self.columns)?;
        shape("divisors of the columns", self.standard.scale.len(), self.columns)?;
        finite("mean", &self.standard.mean)?;
        positive("divisor", &self.standard.scale)?;
        if self.nodes.is_empty() {
            return Err(Error::Shape { name: "nodes", found: 0, expected: 1 });
        }
        for (n, node) in self.nodes.iter().enumerate() {
            self.check_node(n, node, rows)?;
        }
        if let Some(kappa) = self.kappa {
            positive("kappa", &[kappa])?;
        }
        if let RootPrior::Dynamics { covariance, balance, learned } = &self.prior {
            covariance.check()?;
            covariance.check_learned(learned)?;
            positive("balance", &[*balance])?;
        }
        self.check_sequences()?;
        self.check_parents()
    }

    /// Sequences have rows (two where latents have dynamics), and each node has whole ones.
    fn check_sequences(&self) -> Result<(), Error> {
        let least = if matches!(self.prior, RootPrior::Dynamics { .. }) { 2 } else { 1 };
        if let Some(&found) = self.sequences.iter().find(|&&length| length < least) {
            return Err(Error::Shape { name: "a sequence", found, expected: least });
        }
        for node in &self.nodes {
            let (found, expected) = (self.sequences_within(&node.rows).iter().sum(), node.rows.len());
            if found != expected {
                return Err(Error::Shape { name: "rows of whole sequences in a node", found, expected });
            }
        }
        Ok(())
    }

    /// No row of a node is generated by two others.
    fn check_parents(&self) -> Result<(), Error> {
        let mut parents = vec![Vec::new(); self.nodes.len()];
        for node in &self.nodes {
            if let Outputs::Nodes(children) = &node.outputs {
                children.iter().for_each(|&c| parents[c].push(&node.rows));
            }
        }
        for (index, parents) in parents.iter_mut().enumerate() {
            parents.sort_unstable_by_key(|rows| rows.start);
            if let Some(pair) = parents.windows(2).find(|pair| pair[1].start < pair[0].end) {
                let (name, value) = ("row of node", pair[1].start as f64);
                return Err(Error::OutOfRange { name, index, value, expected: "must not be generated by two nodes" });
            }
        }
        Ok(())
    }

    fn check_node(&self, n: usize, node: &LatentNode, rows: usize) -> Result<(), Error> {
        let shape = |name, found, expected| {
            if found == expected { Ok(()) } else { Err(Error::Shape { name, found, expected }) }
        };
        let Range { start, end } = node.rows;
        if start >= end || end > rows {
            return Err(Error::Shape { name: "rows of a node", found: end, expected: rows });
        }
        if node.dim == 0 || node.dim > MAX_DIM {
            return Err(Error::Shape {
                name: "coordinates of a latent",
                found: node.dim,
                expected: node.dim.clamp(1, MAX_DIM),
            });
        }
        shape("latents of a node", node.latents.len(), node.rows.len() * node.dim)?;
        finite("latent", &node.latents)?;
        node.covariance.check()?;
        node.covariance.check_learned(&node.learned)?;
        match &node.outputs {
            Outputs::Columns(columns) => {
                within("column of a node", columns, self.columns)?;
                shape("weights of a node", node.weights.len(), columns.len())?;
                positive("weight", &node.weights)?;
            }
            Outputs::Nodes(nodes) => {
                within("child of a node", nodes, self.nodes.len())?;
                shape("weights of a node", node.weights.len(), 0)?;
                for &c in nodes {
                    let child = &self.nodes[c].rows;
                    if c <= n || child.start > start || child.end < end {
                        return Err(Error::OutOfRange {
                            name: "child of a node",
                            index: n,
                            value: c as f64,
                            expected: "must stand behind it and cover its rows",
                        });
                    }
                }
            }
        }
        node.back.as_ref().map_or(Ok(()), |back| back.check(node.rows.len(), node.dim))
    }
}

/// Coordinates of a latent at most.
pub const MAX_DIM: usize = 32;

/// Places must exist, once each, and there must be some.
fn within(name: &'static str, places: &[usize], count: usize) -> Result<(), Error> {
    if places.is_empty() {
        return Err(Error::Shape { name, found: 0, expected: 1 });
    }
    for (index, &place) in places.iter().enumerate() {
        if place >= count || places[..index].contains(&place) {
            return Err(Error::OutOfRange {
                name,
                index,
                value: place as f64,
                expected: "must exist, and stand there once",
            });
        }
    }
    Ok(())
}
