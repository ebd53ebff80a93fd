//! What recordings say of numbers that they share, such as the cameras of a session.
//!
//! Each recording k knows g_k = (c, r_k): the shared numbers and its own. With the data of k as −½ gᵀ Λ g + λᵀ g and a normal prior of r_k, its own numbers are eliminated:
//!
//! ```text
//! Λ_c = Λ_cc − Λ_cr (Λ_rr + P_r)⁻¹ Λ_rc,   λ_c = λ_c − Λ_cr (Λ_rr + P_r)⁻¹ (λ_r + P_r m_r)
//! ```
//!
//! What is left is of c alone and without its prior, so that the sum over recordings and one prior of c give the posterior of c. Given draws of that, each recording draws its own numbers ([`crate::lasting_scales::draws_given`]): together they are draws of the joint posterior. Exact but for the scales of the priors of r_k, which stand at the given values.

use crate::Error;
use crate::lasting_scales::{LastingData, LastingPrior};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use std::ops::Range;

/// What data say of the numbers at some places, whatever the others are; `scales` belong to the prior.
///
/// # Errors
/// [`Error::Shape`] for a matrix of another size, [`Error::Indefinite`] where the others have no posterior.
pub fn said_of(
    data: &LastingData,
    prior: &LastingPrior,
    scales: &[f64],
    places: &Range<usize>,
) -> Result<LastingData, Error> {
    let p = data.pull.len();
    if data.information.len() != p * p {
        let (name, found, expected) = ("information of what lasts", data.information.len(), p * p);
        return Err(Error::Shape { name, found, expected });
    }
    let others: Vec<usize> = (0..p).filter(|place| !places.contains(place)).collect();
    let (mut precision, mut pull) = (vec![0.0; p], data.pull.clone());
    for cluster in &prior.clusters {
        let size = cluster.scale.map_or(1.0, |scale| scales[scale]);
        for &(place, mean, unit) in cluster.numbers.iter().filter(|(place, ..)| !places.contains(place)) {
            precision[place] = (unit * size).powi(-2);
            pull[place] += precision[place] * mean;
        }
    }
    let at = |i: usize, j: usize| data.information[i * p + j];
    let own = Mat::from_fn(others.len(), others.len(), |i, j| {
        at(others[i], others[j]) + if i == j { precision[others[i]] } else { 0.0 }
    });
    let Ok(factor) = own.llt(Side::Lower) else {
        return Err(Error::Indefinite { name: "information of what is not shared", smallest: f64::NAN });
    };
    // The last column is of the pull.
    let count = places.len();
    let solved = factor.solve(Mat::from_fn(others.len(), count + 1, |i, j| {
        if j < count { at(others[i], places.start + j) } else { pull[others[i]] }
    }));
    let less =
        |i: usize, j: usize| (0..others.len()).map(|k| at(places.start + i, others[k]) * solved[(k, j)]).sum::<f64>();
    let left = |i: usize, j: usize| at(places.start + i, places.start + j) - less(i, j);
    // Symmetric to the last bit, whatever the order of sums was.
    let information = (0..count * count).map(|k| (k / count, k % count)).map(|(i, j)| 0.5 * (left(i, j) + left(j, i)));
    Ok(LastingData {
        information: information.collect(),
        pull: (0..count).map(|i| pull[places.start + i] - less(i, count)).collect(),
    })
}

/// What several recordings say together.
#[must_use]
pub fn together<'a>(all: impl IntoIterator<Item = &'a LastingData>) -> Option<LastingData> {
    let mut all = all.into_iter();
    let mut sum = all.next()?.clone();
    for said in all {
        sum.information.iter_mut().zip(&said.information).for_each(|(sum, said)| *sum += said);
        sum.pull.iter_mut().zip(&said.pull).for_each(|(sum, said)| *sum += said);
    }
    Some(sum)
}

/// How far recordings disagree about the shared numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disagreement {
    /// Σ (c_k − c)ᵀ Λ_k (c_k − c), with c_k what a recording says and c what all say together.
    pub square: f64,
    /// Its mean where the numbers are the same in all: the square is then χ² with as many degrees of freedom.
    pub degrees: usize,
}

impl Disagreement {
    /// Whether the numbers are hardly the same in all: the square is more than five standard deviations above its mean.
    #[must_use]
    pub fn is_gross(&self) -> bool {
        self.degrees > 0 && self.square > self.degrees as f64 + 5.0 * (2.0 * self.degrees as f64).sqrt()
    }
}

/// Information in units of the prior below which a direction is not known from a recording.
const UNKNOWN: f64 = 1e-3;

/// How far recordings disagree about numbers with these units.
///
/// # Errors
/// [`Error::Indefinite`] for information without eigenvalues.
pub fn disagreement(said: &[LastingData], units: &[f64]) -> Result<Disagreement, Error> {
    let own = said.iter().map(|said| explained(said, units)).collect::<Result<Vec<_>, _>>()?;
    let all = together(said).map_or(Ok((0.0, 0)), |all| explained(&all, units))?;
    let square = own.iter().map(|(square, _)| square).sum::<f64>() - all.0;
    Ok(Disagreement { square, degrees: own.iter().map(|(_, rank)| rank).sum::<usize>().saturating_sub(all.1) })
}

/// λᵀ Λ⁺ λ, and the rank of Λ, as far as it is known.
fn explained(said: &LastingData, units: &[f64]) -> Result<(f64, usize), Error> {
    let count = units.len();
    let scaled = Mat::from_fn(count, count, |i, j| said.information[i * count + j] * units[i] * units[j]);
    let indefinite = |_| Error::Indefinite { name: "information of what is shared", smallest: f64::NAN };
    let eigen = scaled.self_adjoint_eigen(Side::Lower).map_err(indefinite)?;
    let (mut square, mut rank) = (0.0, 0);
    for k in (0..count).filter(|&k| eigen.S()[k] > UNKNOWN) {
        let along: f64 = (0..count).map(|i| eigen.U()[(i, k)] * said.pull[i] * units[i]).sum();
        (square, rank) = (square + along * along / eigen.S()[k], rank + 1);
    }
    Ok((square, rank))
}
