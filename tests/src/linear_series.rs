//! Linear-Gaussian series with their exact filter, stored and simulated.
//!
//! With the observation as a density, and the mixture prior between frames.

use crate::stored::{numbers, stored};
use serde_json::Value;
use sinew::core::density::{GaussNewton, GradLogDensity, Lanes, LogDensity};
use sinew::core::lanes::{Block, Isa, Kernel, LANES, Real, dispatch};
use sinew::core::random::Stage;
use sinew::core::transition::{Cloud, Moments, MotionModel, Predict, Transition};
use sinew::dynamics::factor::{cholesky, inverse_lower};
use sinew::dynamics::gaussian::Gaussian;
use sinew::dynamics::kalman::{Filtered, Form, Kalman, Model};
use sinew::dynamics::linear_gaussian::LinearGaussian;
use sinew::dynamics::mixture::Mixture;
use sinew::dynamics::prior::Prior;
use sinew::tracking::hmc_filter;

/// Rows of a matrix.
pub type Rows = Vec<Vec<f64>>;

/// z = C x + N(0, R) for one z, as a density of x with all constants: log p = c + bᵀx − ½ xᵀH x with H = Cᵀ R⁻¹ C, b = Cᵀ R⁻¹ z.
#[derive(Clone, Debug)]
pub struct Sight {
    h: Vec<f64>,
    b: Vec<f64>,
    constant: f64,
}

/// Value and gradient b − H x for eight states.
struct Eval<'a> {
    sight: &'a Sight,
    x: &'a [Block],
    grad: &'a mut [Block],
    value: &'a mut Block,
}

impl Kernel<Block> for Eval<'_> {
    #[inline(always)]
    fn run<V: Real<Mem = Block>>(&mut self) {
        let mut twice = V::splat(0.0);
        for (i, row) in self.sight.h.chunks_exact(self.x.len()).enumerate() {
            let mut g = V::splat(self.sight.b[i]);
            for (x, &h) in self.x.iter().zip(row) {
                g = V::load(x).fnma(V::splat(h), g);
            }
            g.store(&mut self.grad[i]);
            twice = (g + V::splat(self.sight.b[i])).fma(V::load(&self.x[i]), twice);
        }
        twice.fma(V::splat(0.5), V::splat(self.sight.constant)).store(self.value);
    }
}

impl LogDensity for Sight {
    fn dim(&self) -> usize {
        self.b.len()
    }
    fn workspace(&self) -> usize {
        self.b.len()
    }
    fn log_density(&self, x: &[f64]) -> f64 {
        self.log_density_grad(x, &mut vec![0.0; x.len()])
    }
    fn log_density_block(&self, x: &[Block], ws: &mut [Block]) -> Block {
        self.log_density_grad_block(x, &mut ws[..self.b.len()], &mut [])
    }
}

impl GradLogDensity for Sight {
    fn log_density_grad(&self, x: &[f64], grad: &mut [f64]) -> f64 {
        let block: Vec<Block> = x.iter().map(|&x| Block::splat(x)).collect();
        let mut grads = vec![Block::ZERO; x.len()];
        let value = self.log_density_grad_block(&block, &mut grads, &mut []);
        grad.iter_mut().zip(grads).for_each(|(g, b)| *g = b.0[0]);
        value.0[0]
    }
    fn log_density_grad_block(&self, x: &[Block], grad: &mut [Block], _ws: &mut [Block]) -> Block {
        let mut value = Block::ZERO;
        dispatch(Isa::best(), Eval { sight: self, x, grad, value: &mut value });
        value
    }
}

impl GaussNewton for Sight {
    fn gauss_newton_diagonal_block(&self, x: &[Block], diagonal: &mut [Block], _ws: &mut [Block]) {
        for (j, d) in diagonal.iter_mut().enumerate() {
            *d = Block::splat(self.h[j * (x.len() + 1)]);
        }
    }
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A model with its first frame's distribution and a series of observations.
#[derive(Clone, Debug)]
pub struct Series {
    /// Dimension of the state.
    pub dim: usize,
    /// Mean of the first frame.
    pub m0: Vec<f64>,
    /// Covariance of the first frame.
    pub p0: Vec<f64>,
    /// A.
    pub a: Vec<f64>,
    /// Q.
    pub q: Vec<f64>,
    /// C.
    pub c: Rows,
    /// R.
    pub r: Rows,
    /// Observations, frame by frame.
    pub z: Rows,
    /// The states that made them.
    pub truth: Rows,
    /// The whole file of a stored series.
    pub stored: Value,
}

/// Rows of a stored matrix.
#[must_use]
pub fn rows(v: &Value) -> Rows {
    v.as_array().expect("array").iter().map(numbers).collect()
}

impl Series {
    /// A stored series; `None`, with a note, where the data folder is missing.
    #[must_use]
    pub fn stored(name: &str) -> Option<Self> {
        let v = stored(&format!("kalman/{name}"))?;
        Some(Self {
            dim: v["n_state"].as_u64().expect("number") as usize,
            m0: numbers(&v["m0"]),
            p0: rows(&v["P0"]).concat(),
            a: rows(&v["A"]).concat(),
            q: rows(&v["Q"]).concat(),
            c: rows(&v["C"]),
            r: rows(&v["R"]),
            z: rows(&v["y"]),
            truth: rows(&v["x_true"]),
            stored: v,
        })
    }

    /// Rotations and a drift in `dim` coordinates of which every second sum is seen; simulated.
    #[must_use]
    pub fn simulated(dim: usize, frames: usize, stage: &Stage) -> Self {
        let entry = |i: usize, j: usize| match (i, j) {
            _ if i == j => 0.97,
            _ if i.is_multiple_of(2) && j == i + 1 => 0.12,
            _ if i % 2 == 1 && j + 1 == i => -0.12,
            _ => 0.0,
        };
        let matrix =
            |f: &dyn Fn(usize, usize) -> f64| (0..dim * dim).map(|k| f(k / dim, k % dim)).collect::<Vec<f64>>();
        let q = matrix(&|i, j| if i == j { 0.05 } else { 0.01 });
        let p0 = matrix(&|i, j| if i == j { 0.5 } else { 0.1 });
        let sensors = dim.div_ceil(2);
        let c: Rows = (0..sensors)
            .map(|s| {
                (0..dim)
                    .map(|j| {
                        if j == 2 * s {
                            1.0
                        } else if j == (2 * s + 3) % dim {
                            0.4
                        } else {
                            0.0
                        }
                    })
                    .collect()
            })
            .collect();
        let r: Rows = (0..sensors).map(|s| (0..sensors).map(|t| if s == t { 0.1 } else { 0.0 }).collect()).collect();
        let mut series = Self {
            dim,
            m0: vec![0.0; dim],
            p0,
            a: matrix(&entry),
            q,
            c,
            r,
            z: vec![],
            truth: vec![],
            stored: Value::Null,
        };
        let (model, mut rng, isa) = (series.model(), stage.block(0), Isa::best());
        let mut x = vec![Block::ZERO; dim];
        let mut next = x.clone();
        let mut noise = vec![Block::ZERO; sensors];
        for frame in 0..frames {
            if frame == 0 {
                model.sample_initial_block(&series.m0, &mut next, &mut rng);
            } else {
                model.sample_block(&x, &mut next, &mut rng);
            }
            x.copy_from_slice(&next);
            rng.fill_normal(isa, &mut noise);
            let state: Vec<f64> = x.iter().map(|b| b.0[0]).collect();
            series.z.push((0..sensors).map(|s| dot(&series.c[s], &state) + 0.1_f64.sqrt() * noise[s].0[0]).collect());
            series.truth.push(state);
        }
        series
    }

    /// Its motion.
    #[must_use]
    pub fn model(&self) -> LinearGaussian {
        LinearGaussian::new(self.dim, self.a.clone(), self.q.clone(), self.p0.clone(), Isa::best()).expect("valid")
    }

    /// A frame's observation as a density of the state.
    #[must_use]
    pub fn sight(&self, frame: usize) -> Sight {
        let k = self.r.len();
        let factor = cholesky("R", &self.r.concat(), k).expect("positive definite");
        let whitening: Rows = inverse_lower(&factor.lower, k).chunks(k).map(<[f64]>::to_vec).collect();
        let log_det: f64 = (0..k).map(|i| 2.0 * factor.lower[i * (k + 1)].ln()).sum();
        let whitened = |v: &[f64]| -> Vec<f64> { whitening.iter().map(|row| dot(row, v)).collect() };
        let z = whitened(&self.z[frame]);
        let column = |j: usize| whitened(&self.c.iter().map(|c| c[j]).collect::<Vec<f64>>());
        let columns: Rows = (0..self.dim).map(column).collect();
        Sight {
            h: (0..self.dim * self.dim).map(|e| dot(&columns[e / self.dim], &columns[e % self.dim])).collect(),
            b: columns.iter().map(|c| dot(c, &z)).collect(),
            constant: -0.5 * (dot(&z, &z) + log_det + k as f64 * std::f64::consts::TAU.ln()),
        }
    }

    /// The exact filter.
    #[must_use]
    pub fn filter(&self, form: Form) -> Kalman {
        let model = Model {
            dim: self.dim,
            matrix: self.a.clone(),
            noise: self.q.clone(),
            observation: self.c.concat(),
            error: self.r.concat(),
        };
        Kalman::new(model, form).expect("valid")
    }

    /// Moments of the first frame before it is seen.
    #[must_use]
    pub fn start(&self) -> Moments {
        Moments { mean: self.m0.clone(), covariance: self.p0.clone() }
    }

    /// What the exact filter finds.
    #[must_use]
    pub fn kalman(&self) -> Vec<Filtered> {
        let seen: Vec<Vec<Option<f64>>> = self.z.iter().map(|z| z.iter().copied().map(Some).collect()).collect();
        self.filter(Form::Joseph).filter(&self.start(), &seen).expect("positive definite")
    }

    /// The same series in coordinates x = L u with Q = L Lᵀ, in which the motion's noise is a unit matrix; and L, row after row.
    #[must_use]
    pub fn whitened(&self) -> (Self, Vec<f64>) {
        let d = self.dim;
        let lower = cholesky("Q", &self.q, d).expect("positive definite").lower;
        let inverse = inverse_lower(&lower, d);
        let unit = (0..d * d).map(|e| f64::from(u8::from(e / d == e % d))).collect();
        let start = product(&inverse, &self.p0, d);
        let apply = |m: &[f64], x: &Vec<f64>| -> Vec<f64> { m.chunks(d).map(|row| dot(row, x)).collect() };
        let series = Self {
            m0: apply(&inverse, &self.m0),
            p0: product(&start, &transposed(&inverse, d), d),
            a: product(&product(&inverse, &self.a, d), &lower, d),
            q: unit,
            c: self.c.iter().map(|row| apply(&transposed(&lower, d), row)).collect(),
            truth: self.truth.iter().map(|x| apply(&inverse, x)).collect(),
            stored: Value::Null,
            ..self.clone()
        };
        (series, lower)
    }
}

fn transposed(m: &[f64], d: usize) -> Vec<f64> {
    (0..d * d).map(|e| m[e % d * d + e / d]).collect()
}

/// Product of two d × d matrices.
#[must_use]
pub fn product(a: &[f64], b: &[f64], d: usize) -> Vec<f64> {
    (0..d * d).map(|e| (0..d).map(|k| a[e / d * d + k] * b[k * d + e % d]).sum()).collect()
}

/// Chains that mix on short series.
#[must_use]
pub fn chains_on_series() -> hmc_filter::Config {
    let usual = hmc_filter::Config { chains: 16, updates: 120, burn_in: 20, ..hmc_filter::Config::default() };
    hmc_filter::Config { step_size: 0.5, leapfrog_steps: 8, jitter: 0.2, ..usual }
}

/// Roots of the diagonal of the covariance.
#[must_use]
pub fn deviations(m: &Moments) -> Vec<f64> {
    m.covariance.iter().step_by(m.mean.len() + 1).map(|v| v.sqrt()).collect()
}

/// The prior of Choo & Fleet (eq. 9) for a linear motion with unit noise: one component N(A s, I) for each chain's last state s.
#[derive(Clone, Debug)]
pub struct MixtureBetween {
    matrix: Vec<f64>,
    start: Moments,
}

impl MixtureBetween {
    /// Of a series that is [whitened](Series::whitened).
    #[must_use]
    pub fn new(whitened: &Series) -> Self {
        Self { matrix: whitened.a.clone(), start: whitened.start() }
    }
}

impl MotionModel for MixtureBetween {
    fn dim(&self) -> usize {
        self.start.mean.len()
    }
}

impl Predict for MixtureBetween {
    type Prior = Prior;
    type Error = sinew::dynamics::Error;

    fn predict(&self, cloud: Cloud<'_>) -> Result<Prior, Self::Error> {
        let d = self.dim();
        let state =
            |i: usize| -> Vec<f64> { cloud.last[i / LANES * d..][..d].iter().map(|b| b.0[i % LANES]).collect() };
        let moved = |i: usize| self.matrix.chunks(d).map(|row| dot(row, &state(i))).collect();
        let leaf = Mixture::new((0..cloud.count).map(moved).collect(), &vec![1.0; d])?;
        Ok(Prior::Mixture(Lanes { leaf, isa: Isa::best() }))
    }

    fn initial(&self, centre: &[f64]) -> Result<Prior, Self::Error> {
        let leaf = Gaussian::new(centre.to_vec(), &self.start.covariance)?;
        Ok(Prior::Gaussian(Lanes { leaf, isa: Isa::best() }))
    }
}
