//! Covariance functions: a radial basis function, a linear term, a bias and white noise.

use crate::Error;
use serde::{Deserialize, Serialize};

/// k(x, x′) = v exp(−(g/2) ‖x − x′‖²) + a xᵀx′ + b + w δ. A term whose factor is 0 is absent.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Covariance {
    /// v, the variance of the radial basis function.
    pub variance: f64,
    /// g, the inverse of its squared width.
    pub inverse_width: f64,
    /// a, the variance of the linear term.
    pub linear: f64,
    /// b, the variance of the bias.
    pub bias: f64,
    /// w, the variance of the white noise.
    pub white: f64,
}

/// Number of parameters of a [`Covariance`]: v, g, a, b and w, in this order.
pub const PARAMETERS: usize = 5;

/// Which of the five parameters are learned; those that are absent never are.
pub type Learned = [bool; PARAMETERS];

impl Default for Covariance {
    /// Start of GPLVM (Lawrence 2005): v = g = 1, b = w = e⁻², no linear term.
    fn default() -> Self {
        let small = (-2.0_f64).exp();
        Self { variance: 1.0, inverse_width: 1.0, linear: 0.0, bias: small, white: small }
    }
}

impl Covariance {
    /// The five parameters.
    #[must_use]
    pub const fn to_array(&self) -> [f64; PARAMETERS] {
        [self.variance, self.inverse_width, self.linear, self.bias, self.white]
    }

    /// From the five parameters.
    #[must_use]
    pub const fn from_array([variance, inverse_width, linear, bias, white]: [f64; PARAMETERS]) -> Self {
        Self { variance, inverse_width, linear, bias, white }
    }

    /// The covariance of two points, without the white noise.
    #[must_use]
    pub fn between(&self, x: &[f64], y: &[f64]) -> f64 {
        let square: f64 = x.iter().zip(y).map(|(a, b)| (a - b) * (a - b)).sum();
        let product: f64 = x.iter().zip(y).map(|(a, b)| a * b).sum();
        self.variance * (-0.5 * self.inverse_width * square).exp() + self.linear * product + self.bias
    }

    /// The variance of a point before anything is observed, without the white noise.
    #[must_use]
    pub fn at(&self, x: &[f64]) -> f64 {
        self.variance + self.linear * x.iter().map(|x| x * x).sum::<f64>() + self.bias
    }

    /// The parameters that can be learned: those that are present.
    #[must_use]
    pub fn present(&self) -> Learned {
        self.to_array().map(|x| x > 0.0)
    }

    /// Factors must be finite and not negative, and something must be there.
    ///
    /// # Errors
    /// [`Error::OutOfRange`].
    pub fn check(&self) -> Result<(), Error> {
        let name = "covariance parameter";
        let parameters = self.to_array();
        if let Some(index) = parameters.iter().position(|x| !(x.is_finite() && *x >= 0.0)) {
            let expected = "must be finite and not negative (v, g, a, b, w in this order)";
            return Err(Error::OutOfRange { name, index, value: parameters[index], expected });
        }
        if parameters.iter().enumerate().all(|(i, &x)| i == 1 || x == 0.0) {
            return Err(Error::OutOfRange {
                name,
                index: 0,
                value: 0.0,
                expected: "one of v, a, b, w must be positive",
            });
        }
        Ok(())
    }

    /// Only parameters that are present can be learned.
    pub(crate) fn check_learned(&self, learned: &Learned) -> Result<(), Error> {
        let present = self.present();
        match (0..PARAMETERS).find(|&i| learned[i] && !present[i]) {
            Some(index) => Err(Error::OutOfRange {
                name: "learned covariance parameter",
                index,
                value: 0.0,
                expected: "must be positive (v, g, a, b, w in this order)",
            }),
            None => Ok(()),
        }
    }

    /// Writes the logarithms of the learned parameters to the front of `values`; how many they are.
    pub(crate) fn write_logs(&self, learned: &Learned, values: &mut [f64]) -> usize {
        let logs = self.to_array().into_iter().zip(learned).filter(|(_, learned)| **learned).map(|(x, _)| x.ln());
        logs.zip(values).map(|(log, value)| *value = log).count()
    }

    /// With the learned parameters of these logarithms.
    pub(crate) fn with_logs(&self, learned: &Learned, values: &[f64]) -> Self {
        let mut parameters = self.to_array();
        let places = parameters.iter_mut().zip(learned).filter(|(_, learned)| **learned);
        places.zip(values).for_each(|((x, _), value)| *x = value.exp());
        Self::from_array(parameters)
    }
}

/// How many parameters are learned.
pub(crate) fn count(learned: &Learned) -> usize {
    learned.iter().filter(|&&learned| learned).count()
}
