//! Kalman filter (Kalman 1960), with covariances whole or as square roots.
//!
//! The model is s_t = A s_{t−1} + N(0, Q), z_t = C s_t + N(0, R); the backward pass is [`crate::smoother`].
//!
//! With the prediction (m⁻, P⁻), the innovation e = z − C m⁻ and its covariance S = C P⁻ Cᵀ + R:
//!
//! 1. K = P⁻ Cᵀ S⁻¹, m = m⁻ + K e
//! 2. log p(z_t | earlier) = −½ eᵀ S⁻¹ e − ½ log |2π S|
//! 3. [`Form::Joseph`]: P = (I − K C) P⁻ (I − K C)ᵀ + K R Kᵀ, a sum of two squares (Bucy & Joseph 1968);
//!    [`Form::SquareRoot`]: only roots are carried. P⁻ = L Lᵀ follows from the orthogonal triangularisation of (A L, Q½), and
//!
//! ```text
//! ( R½  C L )                     ( S½   0  )
//! (  0    L ) · orthogonal matrix = ( K S½  L⁺ )
//! ```
//!
//! gives gain and root at once (Kaminski, Bryson & Schmidt 1971). A covariance made of a root cannot have a negative eigenvalue beyond the rounding of its square.
//!
//! The first frame is updated without a prediction before it. A sensor that is missing in a frame (`None`) drops out of C, z and R there; without any the frame is its prediction and adds 0 to the log likelihood.
//!
//! ```
//! use sinew_core::transition::Moments;
//! use sinew_dynamics::kalman::{Form, Kalman, Model};
//!
//! let walk = Model { dim: 1, matrix: vec![1.0], noise: vec![0.5], observation: vec![1.0], error: vec![1.0] };
//! let filter = Kalman::new(walk, Form::Joseph)?;
//! let start = Moments { mean: vec![0.0], covariance: vec![1.0] };
//! let frames = filter.filter(&start, &[vec![Some(2.0)], vec![None]])?;
//! assert!((frames[0].filtered.mean[0] - 1.0).abs() < 1e-12 && (frames[0].filtered.covariance[0] - 0.5).abs() < 1e-12);
//! assert!((frames[1].filtered.covariance[0] - 1.0).abs() < 1e-12);
//! # Ok::<(), sinew_dynamics::Error>(())
//! ```

use crate::Error;
use crate::factor::{cholesky, root};
use crate::linear_motion::{predict, symmetric, to_rows};
use crate::smoother::Smoother;
use core::f64::consts::TAU;
use faer::{Mat, MatRef};
use sinew_core::transition::Moments;

/// How covariances are carried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Form {
    /// Whole, updated as a sum of two squares.
    #[default]
    Joseph,
    /// As roots.
    SquareRoot,
}

/// A linear-Gaussian model; matrices row after row.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Dimension d of the state.
    pub dim: usize,
    /// A, d × d.
    pub matrix: Vec<f64>,
    /// Q, d × d; may be semi-definite, even 0.
    pub noise: Vec<f64>,
    /// C, k × d.
    pub observation: Vec<f64>,
    /// R, k × k; may be semi-definite.
    pub error: Vec<f64>,
}

/// Moments of one frame and what it adds to the log likelihood.
#[derive(Clone, Debug, PartialEq)]
pub struct Filtered {
    /// Given the frames before.
    pub predicted: Moments,
    /// Given this one too.
    pub filtered: Moments,
    /// log p(z_t | z_1 … z_{t−1}).
    pub log_likelihood: f64,
}

/// What is known of a state: its mean, and its covariance in the filter's form.
#[derive(Clone, Debug)]
pub struct Belief {
    mean: Vec<f64>,
    spread: Spread,
}

#[derive(Clone, Debug)]
enum Spread {
    Whole(Vec<f64>),
    Root(Mat<f64>),
}

impl Belief {
    /// Mean and covariance.
    #[must_use]
    pub fn moments(&self) -> Moments {
        let covariance = match &self.spread {
            Spread::Whole(covariance) => covariance.clone(),
            Spread::Root(root) => to_rows(&symmetric(&(root * root.transpose()))),
        };
        Moments { mean: self.mean.clone(), covariance }
    }
}

/// The sensors seen in a frame: their rows of C, their values, their part of R.
struct Seen {
    rows: Mat<f64>,
    innovation: Mat<f64>,
    error: Vec<f64>,
}

/// The filter.
#[derive(Clone, Debug)]
pub struct Kalman {
    model: Model,
    form: Form,
    sensors: usize,
    noise_root: Mat<f64>,
}

fn square(rows: &[f64], dim: usize) -> MatRef<'_, f64> {
    MatRef::from_row_major_slice(rows, dim, dim)
}

/// Lower triangular L with L Lᵀ = M Mᵀ.
fn triangular(m: &Mat<f64>) -> Mat<f64> {
    m.transpose().qr().thin_R().transpose().to_owned()
}

impl Kalman {
    /// A filter for a model.
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`], [`Error::Indefinite`].
    pub fn new(model: Model, form: Form) -> Result<Self, Error> {
        let d = model.dim;
        if d == 0 {
            return Err(Error::Shape { name: "state", found: 0, expected: 1 });
        }
        let sensors = model.observation.len() / d;
        for (name, found, expected) in [("A", &model.matrix, d * d), ("C", &model.observation, sensors * d)] {
            if found.len() != expected {
                return Err(Error::Shape { name, found: found.len(), expected });
            }
            if let Some(index) = found.iter().position(|x| !x.is_finite()) {
                return Err(Error::OutOfRange { name, index, value: found[index], expected: "must be finite" });
            }
        }
        let noise_root = square(&root("Q", &model.noise, d)?, d).to_owned();
        root("R", &model.error, sensors)?;
        Ok(Self { model, form, sensors, noise_root })
    }

    /// What is known before the first frame.
    ///
    /// # Errors
    /// [`Error::Shape`], [`Error::OutOfRange`], [`Error::Indefinite`].
    pub fn start(&self, moments: &Moments) -> Result<Belief, Error> {
        let d = self.model.dim;
        if moments.mean.len() != d {
            return Err(Error::Shape { name: "mean", found: moments.mean.len(), expected: d });
        }
        if let Some(index) = moments.mean.iter().position(|x| !x.is_finite()) {
            let value = moments.mean[index];
            return Err(Error::OutOfRange { name: "mean", index, value, expected: "must be finite" });
        }
        let start_root = root("P0", &moments.covariance, d)?;
        let spread = match self.form {
            Form::Joseph => Spread::Whole(moments.covariance.clone()),
            Form::SquareRoot => Spread::Root(square(&start_root, d).to_owned()),
        };
        Ok(Belief { mean: moments.mean.clone(), spread })
    }

    /// One step of the motion.
    #[must_use]
    pub fn predict(&self, belief: &Belief) -> Belief {
        let d = self.model.dim;
        match &belief.spread {
            Spread::Whole(covariance) => {
                let now = Moments { mean: belief.mean.clone(), covariance: covariance.clone() };
                let Moments { mean, covariance } = predict(&self.model.matrix, &self.model.noise, &now);
                Belief { mean, spread: Spread::Whole(covariance) }
            }
            Spread::Root(root) => {
                let a = square(&self.model.matrix, d);
                let moved = a * root;
                let wide =
                    Mat::from_fn(d, 2 * d, |i, j| if j < d { moved[(i, j)] } else { self.noise_root[(i, j - d)] });
                let rows = self.model.matrix.chunks_exact(d);
                let mean = rows.map(|row| row.iter().zip(&belief.mean).map(|(a, m)| a * m).sum()).collect();
                Belief { mean, spread: Spread::Root(triangular(&wide)) }
            }
        }
    }

    fn seen(&self, mean: &[f64], z: &[Option<f64>]) -> Result<Seen, Error> {
        let (d, k) = (self.model.dim, self.sensors);
        if z.len() != k {
            return Err(Error::Shape { name: "observation", found: z.len(), expected: k });
        }
        let bad = |&(_, z): &(usize, f64)| !z.is_finite();
        let values: Vec<(usize, f64)> = z.iter().enumerate().filter_map(|(i, z)| Some((i, (*z)?))).collect();
        if let Some(&(index, value)) = values.iter().find(|seen| bad(seen)) {
            return Err(Error::OutOfRange { name: "observation", index, value, expected: "must be finite" });
        }
        let n = values.len();
        let rows = Mat::from_fn(n, d, |i, j| self.model.observation[values[i].0 * d + j]);
        let innovation = Mat::from_fn(n, 1, |i, _| values[i].1 - (0..d).map(|j| rows[(i, j)] * mean[j]).sum::<f64>());
        let error = (0..n * n).map(|e| self.model.error[values[e / n].0 * k + values[e % n].0]).collect();
        Ok(Seen { rows, innovation, error })
    }

    /// Takes in the sensors of a frame; returns what they add to the log likelihood.
    ///
    /// # Errors
    /// [`Error::Shape`] or [`Error::OutOfRange`] for the observation, [`Error::Singular`] where what is seen has no density.
    pub fn update(&self, belief: &Belief, z: &[Option<f64>]) -> Result<(Belief, f64), Error> {
        let seen = self.seen(&belief.mean, z)?;
        if seen.error.is_empty() {
            return Ok((belief.clone(), 0.0));
        }
        match &belief.spread {
            Spread::Whole(covariance) => self.joseph(&belief.mean, covariance, &seen),
            Spread::Root(root) => self.square_root(&belief.mean, root, &seen),
        }
    }

    fn joseph(&self, mean: &[f64], covariance: &[f64], seen: &Seen) -> Result<(Belief, f64), Error> {
        let (d, k) = (self.model.dim, seen.rows.nrows());
        let (p, r) = (square(covariance, d), square(&seen.error, k));
        let across = &seen.rows * p;
        let s = symmetric(&(&across * seen.rows.transpose() + r));
        let factor = cholesky("innovation covariance", &to_rows(&s), k)?;
        if factor.jitter > 0.0 {
            return Err(Error::Singular { name: "innovation covariance", jitter: 0.0 });
        }
        let lower = square(&factor.lower, k);
        let mut whitened = seen.innovation.clone();
        lower.solve_lower_triangular_in_place(whitened.as_mut());
        // Kᵀ = S⁻¹ C P by two triangular solves.
        let mut gain = across;
        lower.solve_lower_triangular_in_place(gain.as_mut());
        lower.transpose().solve_upper_triangular_in_place(gain.as_mut());
        let gain = gain.transpose();
        let kept = Mat::<f64>::identity(d, d) - gain * &seen.rows;
        let after = &kept * p * kept.transpose() + gain * r * gain.transpose();
        let shift = gain * &seen.innovation;
        let spread = Spread::Whole(to_rows(&symmetric(&after)));
        Ok((Belief { mean: moved(mean, &shift), spread }, log_density(&whitened, lower)))
    }

    fn square_root(&self, mean: &[f64], state_root: &Mat<f64>, seen: &Seen) -> Result<(Belief, f64), Error> {
        let (d, k) = (self.model.dim, seen.rows.nrows());
        let error = root("R", &seen.error, k)?;
        let across = &seen.rows * state_root;
        let before = Mat::from_fn(k + d, k + d, |i, j| match (i < k, j < k) {
            (true, true) => error[i * k + j],
            (true, false) => across[(i, j - k)],
            (false, true) => 0.0,
            (false, false) => state_root[(i - k, j - k)],
        });
        let after = triangular(&before);
        let lower = after.submatrix(0, 0, k, k);
        if (0..k).any(|i| lower[(i, i)] == 0.0) {
            return Err(Error::Singular { name: "innovation covariance", jitter: 0.0 });
        }
        let mut whitened = seen.innovation.clone();
        lower.solve_lower_triangular_in_place(whitened.as_mut());
        let shift = after.submatrix(k, 0, d, k) * &whitened;
        let spread = Spread::Root(after.submatrix(k, k, d, d).to_owned());
        Ok((Belief { mean: moved(mean, &shift), spread }, log_density(&whitened, lower)))
    }

    /// Filters a series, each frame with all its sensors, `None` where one is missing.
    ///
    /// # Errors
    /// As [`Kalman::start`] and [`Kalman::update`].
    pub fn filter(&self, start: &Moments, observations: &[Vec<Option<f64>>]) -> Result<Vec<Filtered>, Error> {
        let mut belief = self.start(start)?;
        let mut frames = Vec::with_capacity(observations.len());
        for (frame, z) in observations.iter().enumerate() {
            if frame > 0 {
                belief = self.predict(&belief);
            }
            let predicted = belief.moments();
            let (after, log_likelihood) = self.update(&belief, z)?;
            belief = after;
            frames.push(Filtered { predicted, filtered: belief.moments(), log_likelihood });
        }
        Ok(frames)
    }

    /// Smoothed moments of filtered frames (Rauch, Tung & Striebel 1965; see [`Smoother`]).
    ///
    /// # Errors
    /// As [`Smoother::step`].
    pub fn smooth(&self, frames: &[Filtered]) -> Result<Vec<Moments>, Error> {
        let Model { dim, matrix, noise, .. } = &self.model;
        let smoother = Smoother::new(*dim, matrix.clone(), noise.clone())?;
        let mut smoothed: Vec<Moments> = Vec::with_capacity(frames.len());
        for frame in frames.iter().rev() {
            let now = match smoothed.last() {
                None => frame.filtered.clone(),
                Some(next) => smoother.step(&frame.filtered, next)?,
            };
            smoothed.push(now);
        }
        smoothed.reverse();
        Ok(smoothed)
    }
}

fn moved(mean: &[f64], shift: &Mat<f64>) -> Vec<f64> {
    mean.iter().enumerate().map(|(i, m)| m + shift[(i, 0)]).collect()
}

/// −½ |S^{−½} e|² − ½ log |2π S| of a whitened innovation and the root that whitened it.
fn log_density(whitened: &Mat<f64>, lower: MatRef<'_, f64>) -> f64 {
    (0..whitened.nrows()).map(|i| -0.5 * whitened[(i, 0)].powi(2) - lower[(i, i)].abs().ln() - 0.5 * TAU.ln()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cart() -> Model {
        Model {
            dim: 2,
            matrix: vec![1.0, 0.1, 0.0, 0.98],
            noise: vec![0.002, 0.003, 0.003, 0.05],
            observation: vec![1.0, 0.0, 0.3, 1.0],
            error: vec![0.04, 0.01, 0.01, 0.5],
        }
    }

    fn start() -> Moments {
        Moments { mean: vec![0.0, 1.0], covariance: vec![0.25, 0.0, 0.0, 1.0] }
    }

    #[test]
    fn a_missing_sensor_drops_out_and_a_missing_frame_is_its_prediction() {
        let alone = Model { observation: vec![0.3, 1.0], error: vec![0.5], ..cart() };
        for form in [Form::Joseph, Form::SquareRoot] {
            let both = Kalman::new(cart(), form).expect("valid");
            let one = Kalman::new(alone.clone(), form).expect("valid");
            let found = both.filter(&start(), &[vec![None, Some(1.5)], vec![None, None]]).expect("seen");
            let expected = one.filter(&start(), &[vec![Some(1.5)], vec![None]]).expect("seen");
            assert_eq!(found, expected);
            assert_eq!(found[1].filtered, found[1].predicted);
            assert_eq!(found[1].log_likelihood, 0.0);
        }
    }

    #[test]
    fn what_is_certain_stays_certain() {
        let certain = Moments { mean: vec![1.0, 2.0], covariance: vec![0.0; 4] };
        let still = Model { noise: vec![0.0; 4], ..cart() };
        for form in [Form::Joseph, Form::SquareRoot] {
            let filter = Kalman::new(still.clone(), form).expect("valid");
            let frames = filter.filter(&certain, &[vec![Some(9.0), None], vec![Some(-9.0), Some(3.0)]]).expect("seen");
            assert_eq!(frames[1].filtered.covariance, [0.0; 4]);
            assert!((frames[1].filtered.mean[0] - 1.2).abs() < 1e-15);
        }
    }

    #[test]
    fn bad_models_and_observations_are_refused_by_name() {
        let refused = |model: Model| Kalman::new(model, Form::SquareRoot).map(|_| ()).unwrap_err();
        assert!(matches!(refused(Model { dim: 0, ..cart() }), Error::Shape { name: "state", .. }));
        assert!(matches!(refused(Model { matrix: vec![1.0], ..cart() }), Error::Shape { name: "A", .. }));
        assert!(matches!(refused(Model { observation: vec![1.0; 3], ..cart() }), Error::Shape { name: "C", .. }));
        assert!(matches!(refused(Model { error: vec![1.0], ..cart() }), Error::Shape { name: "R", .. }));
        let indefinite = vec![1.0, 2.0, 2.0, 1.0];
        assert!(matches!(refused(Model { noise: indefinite.clone(), ..cart() }), Error::Indefinite { name: "Q", .. }));
        assert!(matches!(refused(Model { error: indefinite.clone(), ..cart() }), Error::Indefinite { name: "R", .. }));
        let blind = Model { observation: vec![0.0; 4], error: vec![0.0; 4], ..cart() };
        for form in [Form::Joseph, Form::SquareRoot] {
            let filter = Kalman::new(cart(), form).expect("valid");
            let of = |z: Vec<Option<f64>>| filter.filter(&start(), &[z]).map(|_| ()).unwrap_err();
            assert!(matches!(of(vec![None]), Error::Shape { name: "observation", found: 1, expected: 2 }));
            assert!(matches!(of(vec![None, Some(f64::NAN)]), Error::OutOfRange { name: "observation", index: 1, .. }));
            let bad = Moments { covariance: indefinite.clone(), ..start() };
            assert!(matches!(filter.start(&bad), Err(Error::Indefinite { name: "P0", .. })));
            let filter = Kalman::new(blind.clone(), form).expect("semi-definite");
            let nothing = filter.filter(&start(), &[vec![Some(0.0); 2]]);
            assert!(matches!(nothing, Err(Error::Singular { name: "innovation covariance", .. })));
        }
    }
}
