//! Small joint laws of states and observations, for Geweke's test and simulation-based calibration.
//!
//! p(θ) and p(y | θ) can be drawn from; p(θ | y) is a sampler's target.

use sinew::body::standard::cf28;
use sinew::body::{Plan, Proportions, point_positions};
use sinew::core::combinators::{OnPart, Sum};
use sinew::core::density::{Lanes, LogDensity};
use sinew::core::lanes::Isa;
use sinew::core::part::Part;
use sinew::core::random::BlockRng;
use sinew::dynamics::gaussian::Gaussian;
use sinew::dynamics::prior::Prior;
use sinew::observe::ObservationModel;
use sinew_invariance::TestFunctions;
use sinew_invariance::draws::normals;
use sinew_markers::{MarkerLikelihood, MarkerModel};
use std::sync::Arc;

/// Posterior of a part of CF28, the rest held still, from its markers in one camera: prior N(0, 0.15² I) about a pose.
#[derive(Clone)]
pub struct PartOfBody {
    model: MarkerModel,
    part: Part,
    pose: Vec<f64>,
}

/// Standard deviation of the prior, radians.
pub const PRIOR_SD: f64 = 0.15;

/// Prior times likelihood.
pub type Posterior = Sum<OnPart<Lanes<MarkerLikelihood>>, Prior>;

impl PartOfBody {
    /// Degrees of freedom `first` to `first + dim − 1`, seen with errors of `sigma` in units of the focal length.
    ///
    /// # Panics
    /// When CF28 has no such degrees of freedom.
    #[must_use]
    pub fn new(first: usize, dim: usize, sigma: f64) -> Self {
        let plan = Arc::new(Plan::with_all_points(&cf28(&Proportions::default())));
        let pose: Vec<f64> = (0..28).map(|j| 0.2 * (1.7 * j as f64).sin() + if j == 2 { 1.0 } else { 0.0 }).collect();
        let model = MarkerModel { plan, centre: [0.0, -4.8, 1.0], sigma, isa: Isa::best() };
        Self { model, part: Part::new((first..first + dim).collect(), 28).expect("coordinates of CF28"), pose }
    }

    /// The arm, 4 degrees of freedom.
    #[must_use]
    pub fn arm(sigma: f64) -> Self {
        Self::new(14, 4, sigma)
    }

    /// The lower body, 10 degrees of freedom.
    #[must_use]
    pub fn lower_body(sigma: f64) -> Self {
        Self::new(18, 10, sigma)
    }

    /// Number of free coordinates.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.part.indices().len()
    }

    /// Middle of the prior.
    #[must_use]
    pub fn centre(&self) -> Vec<f64> {
        self.part.indices().iter().map(|&i| self.pose[i]).collect()
    }

    /// The prior as a density.
    ///
    /// # Panics
    /// Never: its covariance is positive.
    #[must_use]
    pub fn frame_prior(&self) -> Prior {
        let d = self.dim();
        let covariance: Vec<f64> =
            (0..d * d).map(|k| if k % (d + 1) == 0 { PRIOR_SD * PRIOR_SD } else { 0.0 }).collect();
        let leaf = Gaussian::new(self.centre(), &covariance).expect("positive covariance");
        Prior::Gaussian(Lanes { leaf, isa: self.model.isa })
    }

    /// θ ~ p(θ).
    #[must_use]
    pub fn prior(&self, rng: &mut BlockRng) -> Vec<f64> {
        self.centre().iter().zip(normals(self.dim(), rng)).map(|(c, z)| c + PRIOR_SD * z).collect()
    }

    /// y ~ p(y | θ): two coordinates for every point of the body.
    ///
    /// # Panics
    /// Never: the body stands before the camera.
    #[must_use]
    pub fn simulate(&self, theta: &[f64], rng: &mut BlockRng) -> Vec<f64> {
        let mut pose = self.pose.clone();
        self.part.indices().iter().zip(theta).for_each(|(&i, &x)| pose[i] = x);
        let mut points = vec![0.0; 3 * self.model.plan.points()];
        point_positions(&self.model.plan, Isa::baseline(), &pose, &mut points);
        let centre = self.model.centre;
        let image = points.chunks(3).flat_map(|p| {
            let depth = p[1] - centre[1];
            [(p[0] - centre[0]) / depth, (p[2] - centre[2]) / depth]
        });
        let noise = normals(2 * self.model.plan.points(), rng);
        image.zip(noise).map(|(x, z)| x + self.model.sigma * z).collect()
    }

    /// p(y | ·).
    #[must_use]
    pub fn likelihood(&self, y: &[f64]) -> OnPart<Lanes<MarkerLikelihood>> {
        let seen: Vec<Option<[f64; 2]>> = y.chunks(2).map(|p| Some([p[0], p[1]])).collect();
        OnPart { target: self.model.bind(&seen), part: self.part.clone(), fixed: self.pose.clone() }
    }

    /// p(· | y), up to a constant.
    #[must_use]
    pub fn posterior(&self, y: &[f64]) -> Posterior {
        Sum(self.likelihood(y), self.frame_prior())
    }

    /// What a sampler believes that takes the errors for `factor` times as large.
    #[must_use]
    pub fn believing(&self, factor: f64) -> Self {
        let mut other = self.clone();
        other.model.sigma *= factor;
        other
    }

    /// Coordinates about the prior's middle, in its standard deviations: themselves, squares, products of ten pairs, and the log likelihood.
    #[must_use]
    pub fn functions(&self) -> TestFunctions<'static> {
        let (of, d, centre) = (self.clone(), self.dim(), self.centre());
        let scaled = move |x: &[f64], i: usize| (x[i] - centre[i]) / PRIOR_SD;
        let mut all = TestFunctions::none();
        for i in 0..d {
            let (first, second) = (scaled.clone(), scaled.clone());
            all =
                all.with(format!("θ{i}"), move |x| first(x, i)).with(format!("θ{i}²"), move |x| second(x, i).powi(2));
        }
        for (i, j) in (0..d).map(|i| (i, (i + 1) % d)).take(10) {
            let scaled = scaled.clone();
            all = all.with(format!("θ{i} θ{j}"), move |x| scaled(x, i) * scaled(x, j));
        }
        all.with("log likelihood", move |x| of.likelihood(&x[d..]).log_density(&x[..d]))
    }
}

/// θ ~ N(0, I) in three dimensions, y = C θ + N(0, R): what every calculation can be checked on.
#[derive(Clone, Copy, Debug)]
pub struct Linear3;

/// Rows of C.
const C: [[f64; 3]; 2] = [[1.0, 0.5, 0.0], [0.0, -1.0, 1.5]];
/// Standard deviations of the observations.
const R: [f64; 2] = [0.4, 0.7];

impl Linear3 {
    /// y ~ p(y | θ).
    #[must_use]
    pub fn simulate(self, theta: &[f64], rng: &mut BlockRng) -> Vec<f64> {
        let dot = |row: &[f64; 3]| row.iter().zip(theta).map(|(c, x)| c * x).sum::<f64>();
        C.iter().zip(R).zip(normals(2, rng)).map(|((row, sd), z)| dot(row) + sd * z).collect()
    }

    /// Log posterior up to a constant, and its gradient, with observations believed `factor` times as uncertain.
    #[must_use]
    pub fn log_posterior(self, y: &[f64], factor: f64, x: &[f64], grad: &mut [f64]) -> f64 {
        grad.iter_mut().zip(x).for_each(|(g, x)| *g = -x);
        let mut value = -0.5 * x.iter().map(|x| x * x).sum::<f64>();
        for ((row, sd), y) in C.iter().zip(R).zip(y) {
            let information = 1.0 / (sd * factor).powi(2);
            let error = y - row.iter().zip(x).map(|(c, x)| c * x).sum::<f64>();
            value -= 0.5 * information * error * error;
            grad.iter_mut().zip(row).for_each(|(g, c)| *g += information * error * c);
        }
        value
    }
}
