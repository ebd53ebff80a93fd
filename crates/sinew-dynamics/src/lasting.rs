//! How a filter's estimates answer to parameters g that are constant over a run (Friedland 1969).
//!
//! The model is s_t = F_t s_{t−1} + N(0, Q_t), z_t = H_t s_t + G_t g + N(0, R_t), g ~ N(0, Λ₀⁻¹). A filter runs as if g were 0; beside it [`Lasting`] carries J_t = ∂m_t/∂g and what the observations say of g. With the filtered covariance P_t of that filter
//! and the frame's information A = Hᵀ R⁻¹ H, B = Hᵀ R⁻¹ G, C = Gᵀ R⁻¹ G, a = Hᵀ R⁻¹ r, c = Gᵀ R⁻¹ r (r the innovation of the filter, z − H m⁻):
//!
//! ```text
//! U = F J_{t−1},   N = B + A U = Hᵀ R⁻¹ D  with D = G + H U
//! J_t = U − P_t N                                       (K D = P_t N)
//! Λ_t = Λ_{t−1} + C + Bᵀ U + Uᵀ N − Nᵀ P_t N            (= … + Dᵀ V⁻¹ D, V the innovation covariance)
//! λ_t = λ_{t−1} + c + Uᵀ a − Nᵀ P_t a                   (= … + Dᵀ V⁻¹ r)
//! ```
//!
//! so that no matrix as large as an observation is inverted. Given all frames so far, g ~ N(Λ⁻¹ λ, Λ⁻¹) and s_t ~ N(m_t + J_t Λ⁻¹ λ, P_t + J_t Λ⁻¹ J_tᵀ): exact in the linear-Gaussian case. J_t is not what the frame alone would say, −P_t B: it inherits through the prior of
//! the frame. Backwards, J^s_t = J_t + C_t (J^s_{t+1} − F J_t) with the smoother's gain C_t.

use crate::Error;
use crate::factor::cholesky;
use crate::linear_motion::{symmetric, to_rows};
use faer::linalg::matmul::matmul;
use faer::{Accum, Mat, MatRef, Par};
use sinew_core::transition::Moments;

/// What a frame says of its state (dimension d) and of what lasts (dimension p), linearised at the filter's prediction and g = 0; matrices row after row.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameInformation {
    /// A = Hᵀ R⁻¹ H, d × d.
    pub state: Vec<f64>,
    /// B = Hᵀ R⁻¹ G, d × p.
    pub between: Vec<f64>,
    /// Rows of R^(−½) G, whose squares are C = Gᵀ R⁻¹ G: of each, the places that are not 0 and what stands there.
    pub lasting: Vec<Vec<(usize, f64)>>,
    /// a = Hᵀ R⁻¹ r, length d.
    pub state_pull: Vec<f64>,
    /// c = Gᵀ R⁻¹ r, length p.
    pub lasting_pull: Vec<f64>,
}

/// The answer of a filter to what lasts, and what is known of it.
#[derive(Clone, Debug)]
pub struct Lasting {
    /// J, d × p.
    response: Mat<f64>,
    /// Λ, p × p.
    information: Mat<f64>,
    /// λ, p × 1.
    pull: Mat<f64>,
}

pub(crate) fn rows(name: &'static str, values: &[f64], height: usize, width: usize) -> Result<Mat<f64>, Error> {
    if values.len() != height * width {
        return Err(Error::Shape { name, found: values.len(), expected: height * width });
    }
    if let Some(index) = values.iter().position(|x| !x.is_finite()) {
        return Err(Error::OutOfRange { name, index, value: values[index], expected: "must be finite" });
    }
    Ok(MatRef::from_row_major_slice(values, height, width).to_owned())
}

impl Lasting {
    /// Before the first frame of a state of dimension `dim`: J = 0, and g ~ N(0, `covariance`), p × p, row after row.
    ///
    /// # Errors
    /// [`Error::Shape`] for an empty state or no parameter, and as [`cholesky`].
    pub fn new(dim: usize, count: usize, covariance: &[f64]) -> Result<Self, Error> {
        for (name, found) in [("state", dim), ("what lasts", count)] {
            if found == 0 {
                return Err(Error::Shape { name, found, expected: 1 });
            }
        }
        let information = inverse("covariance of what lasts", covariance, count)?;
        Ok(Self { response: Mat::zeros(dim, count), information, pull: Mat::zeros(count, 1) })
    }

    /// Λ, p × p, row after row: what the prior and the frames so far say of g.
    #[must_use]
    pub fn information(&self) -> Vec<f64> {
        to_rows(&symmetric(&self.information))
    }

    /// λ, length p.
    #[must_use]
    pub fn pull(&self) -> Vec<f64> {
        to_rows(&self.pull)
    }

    /// J, d × p, row after row.
    #[must_use]
    pub fn response(&self) -> Vec<f64> {
        to_rows(&self.response)
    }

    /// One step of the motion F, d × d, row after row.
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`].
    pub fn predict(&mut self, motion: &[f64]) -> Result<(), Error> {
        let d = self.response.nrows();
        self.response = rows("motion", motion, d, d)? * &self.response;
        Ok(())
    }

    /// The filter begins again: its estimate no longer answers to what lasts by what it inherited.
    pub fn restart(&mut self) {
        self.response.fill(0.0);
    }

    /// Takes in a frame, whose filtered covariance is P, d × d, row after row.
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`].
    pub fn update(&mut self, covariance: &[f64], frame: &FrameInformation) -> Result<(), Error> {
        let (d, p) = (self.response.nrows(), self.response.ncols());
        let covariance = rows("filtered covariance", covariance, d, d)?;
        let a = rows("information of the state", &frame.state, d, d)?;
        let b = rows("information between state and what lasts", &frame.between, d, p)?;
        let state_pull = rows("pull of the state", &frame.state_pull, d, 1)?;
        let lasting_pull = rows("pull of what lasts", &frame.lasting_pull, p, 1)?;
        self.add_squares(&frame.lasting)?;
        let n = &b + &a * &self.response;
        let gained = &covariance * &n;
        let u = &self.response;
        for (left, right, sign) in [(&b, u, 1.0), (u, &n, 1.0), (&n, &gained, -1.0)] {
            matmul(self.information.as_mut(), Accum::Add, left.transpose(), right, sign, Par::Seq);
        }
        self.pull = &self.pull + lasting_pull + u.transpose() * &state_pull - gained.transpose() * &state_pull;
        self.response = u - gained;
        Ok(())
    }

    /// Adds the squares of some rows to Λ.
    fn add_squares(&mut self, rows: &[Vec<(usize, f64)>]) -> Result<(), Error> {
        let (name, p) = ("row of what lasts", self.information.nrows());
        for row in rows {
            for &(index, value) in row {
                if index >= p {
                    return Err(Error::Shape { name, found: index + 1, expected: p });
                }
                if !value.is_finite() {
                    return Err(Error::OutOfRange { name, index, value, expected: "must be finite" });
                }
                row.iter().for_each(|(other, by)| self.information[(*other, index)] += value * by);
            }
        }
        Ok(())
    }

    /// Mean and covariance of g given the frames so far.
    ///
    /// # Errors
    /// As [`cholesky`].
    pub fn posterior(&self) -> Result<Moments, Error> {
        let p = self.pull.nrows();
        let covariance = inverse("information of what lasts", &self.information(), p)?;
        let mean = &covariance * &self.pull;
        Ok(Moments { mean: (0..p).map(|i| mean[(i, 0)]).collect(), covariance: to_rows(&covariance) })
    }

    /// Moments of the state, whatever g is: the filter's as if g were 0, moved and widened by what is known of g.
    ///
    /// # Errors
    /// As [`Lasting::posterior`], and [`Error::Shape`].
    pub fn total(&self, filtered: &Moments, posterior: &Moments) -> Result<Moments, Error> {
        total(&self.response, filtered, posterior)
    }

    /// The response of the smoothed estimate: `gain` is that of the smoother, C_t, `motion` F_{t+1}, both d × d, and `next` the smoothed response of the next frame, d × p; rows one after the other.
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`].
    pub fn smoothed(&self, gain: &[f64], motion: &[f64], next: &[f64]) -> Result<Vec<f64>, Error> {
        let (d, p) = (self.response.nrows(), self.response.ncols());
        let (gain, motion) = (rows("gain of the smoother", gain, d, d)?, rows("motion", motion, d, d)?);
        let next = rows("smoothed response", next, d, p)?;
        Ok(to_rows(&(&self.response + gain * (next - motion * &self.response))))
    }
}

/// Filtered moments from predicted ones N(m⁻, P⁻) and a frame's information A and pull a at m⁻: P = (P⁻⁻¹ + A)⁻¹, m = m⁻ + P a; matrices d × d, row after row.
///
/// # Errors
/// [`Error::Shape`], [`Error::OutOfRange`], and as [`cholesky`].
pub fn informed(predicted: &Moments, information: &[f64], pull: &[f64]) -> Result<Moments, Error> {
    let d = predicted.mean.len();
    let before = inverse("predicted covariance", &predicted.covariance, d)?;
    let after = before + rows("information of the state", information, d, d)?;
    let covariance = inverse("information of the state", &to_rows(&after), d)?;
    let moved = &covariance * rows("pull of the state", pull, d, 1)?;
    let mean = predicted.mean.iter().enumerate().map(|(i, m)| m + moved[(i, 0)]).collect();
    Ok(Moments { mean, covariance: to_rows(&covariance) })
}

/// Moments N(m + J ḡ, P + J Σ Jᵀ) of a state whose response to g ~ N(ḡ, Σ) is J, d × p, row after row.
///
/// # Errors
/// [`Error::Shape`], [`Error::OutOfRange`].
pub fn widened(response: &[f64], moments: &Moments, lasting: &Moments) -> Result<Moments, Error> {
    let (d, p) = (moments.mean.len(), lasting.mean.len());
    total(&rows("response", response, d, p)?, moments, lasting)
}

fn total(response: &Mat<f64>, moments: &Moments, lasting: &Moments) -> Result<Moments, Error> {
    let (d, p) = (response.nrows(), response.ncols());
    let (mean, shift) = (rows("mean", &moments.mean, d, 1)?, rows("mean of what lasts", &lasting.mean, p, 1)?);
    let covariance = rows("covariance", &moments.covariance, d, d)?;
    let spread = rows("covariance of what lasts", &lasting.covariance, p, p)?;
    let mean = mean + response * shift;
    let covariance = covariance + response * spread * response.transpose();
    Ok(Moments { mean: (0..d).map(|i| mean[(i, 0)]).collect(), covariance: to_rows(&symmetric(&covariance)) })
}

/// Inverse of a covariance.
pub(crate) fn inverse(name: &'static str, matrix: &[f64], dim: usize) -> Result<Mat<f64>, Error> {
    let lower = cholesky(name, matrix, dim)?.lower;
    let lower = MatRef::from_row_major_slice(&lower, dim, dim);
    let mut inverse = Mat::<f64>::identity(dim, dim);
    lower.solve_lower_triangular_in_place(inverse.as_mut());
    lower.transpose().solve_upper_triangular_in_place(inverse.as_mut());
    Ok(symmetric(&inverse))
}
