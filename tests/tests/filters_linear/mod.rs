//! Linear-Gaussian series with their exact filter: stored ones, simulated ones, and the observation as a density.

use serde_json::Value;
use sinew::core::density::{GaussNewton, GradLogDensity, LogDensity};
use sinew::core::lanes::{Block, Isa, Kernel, Real, dispatch};
use sinew::core::random::Stage;
use sinew::core::transition::{Moments, Transition};
use sinew::dynamics::linear_gaussian::LinearGaussian;
use sinew::dynamics::smoother::predict;
use std::path::PathBuf;

/// Rows of a matrix.
pub type Rows = Vec<Vec<f64>>;

/// z = C x + N(0, R) for one z, as a density of x with all constants: log p = c + bᵀx − ½ xᵀH x with H = Cᵀ R⁻¹ C, b = Cᵀ R⁻¹ z.
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

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Inverse and log determinant of a small positive definite matrix, by Gauss–Jordan.
pub fn inverse(m: &Rows) -> (Rows, f64) {
    let n = m.len();
    let mut a: Rows =
        (0..n).map(|i| m[i].iter().copied().chain((0..n).map(|j| f64::from(u8::from(i == j)))).collect()).collect();
    let mut log_det = 0.0;
    for k in 0..n {
        log_det += a[k][k].ln();
        let pivot = a[k][k];
        a[k].iter_mut().for_each(|x| *x /= pivot);
        let row = a[k].clone();
        for (i, other) in a.iter_mut().enumerate() {
            if i != k {
                let factor = other[k];
                other.iter_mut().zip(&row).for_each(|(x, r)| *x -= factor * r);
            }
        }
    }
    (a.into_iter().map(|row| row[n..].to_vec()).collect(), log_det)
}

/// A model with its first frame's distribution and a series of observations.
pub struct Series {
    pub dim: usize,
    pub m0: Vec<f64>,
    pub p0: Vec<f64>,
    pub a: Vec<f64>,
    pub q: Vec<f64>,
    pub c: Rows,
    pub r: Rows,
    pub z: Rows,
    pub truth: Rows,
    pub stored: Value,
}

fn numbers(v: &Value) -> Vec<f64> {
    v.as_array().expect("array").iter().map(|x| x.as_f64().expect("number")).collect()
}

pub fn rows(v: &Value) -> Rows {
    v.as_array().expect("array").iter().map(numbers).collect()
}

impl Series {
    /// A stored series; `None`, with a note, where the data folder is missing.
    pub fn stored(name: &str) -> Option<Self> {
        let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
        let folder = std::env::var_os("SINEW_DATA").map_or_else(beside, PathBuf::from);
        let Ok(text) = std::fs::read_to_string(folder.join("kalman").join(name)) else {
            println!("skipped: no data");
            return None;
        };
        let v: Value = serde_json::from_str(&text).expect("valid JSON");
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

    pub fn model(&self) -> LinearGaussian {
        LinearGaussian::new(self.dim, self.a.clone(), self.q.clone(), self.p0.clone(), Isa::best()).expect("valid")
    }

    pub fn sight(&self, frame: usize) -> Sight {
        let (precision, log_det) = inverse(&self.r);
        let z = &self.z[frame];
        let w: Vec<f64> = precision.iter().map(|p| dot(p, z)).collect();
        let column = |j: usize| self.c.iter().map(|c| c[j]).collect::<Vec<f64>>();
        let columns: Rows = (0..self.dim).map(column).collect();
        let weighted: Rows = columns.iter().map(|c| precision.iter().map(|p| dot(p, c)).collect()).collect();
        Sight {
            h: (0..self.dim * self.dim).map(|k| dot(&weighted[k / self.dim], &columns[k % self.dim])).collect(),
            b: columns.iter().map(|c| dot(c, &w)).collect(),
            constant: -0.5 * (dot(z, &w) + log_det + z.len() as f64 * std::f64::consts::TAU.ln()),
        }
    }

    /// The exact filter: moments after each frame, and log p(z_t | earlier).
    pub fn kalman(&self) -> Vec<(Moments, f64)> {
        let d = self.dim;
        let mut now = Moments { mean: self.m0.clone(), covariance: self.p0.clone() };
        let mut out: Vec<(Moments, f64)> = vec![];
        for (frame, z) in self.z.iter().enumerate() {
            if frame > 0 {
                now = predict(&self.a, &self.q, &now);
            }
            let p: Rows = now.covariance.chunks(d).map(<[f64]>::to_vec).collect();
            let pc: Rows = self.c.iter().map(|c| p.iter().map(|row| dot(row, c)).collect()).collect();
            let s: Rows =
                (0..z.len()).map(|i| (0..z.len()).map(|j| dot(&self.c[i], &pc[j]) + self.r[i][j]).collect()).collect();
            let (precision, log_det) = inverse(&s);
            let e: Vec<f64> = z.iter().zip(&self.c).map(|(z, c)| z - dot(c, &now.mean)).collect();
            let w: Vec<f64> = precision.iter().map(|row| dot(row, &e)).collect();
            let log = -0.5 * (dot(&e, &w) + log_det + z.len() as f64 * std::f64::consts::TAU.ln());
            for j in 0..d {
                now.mean[j] += pc.iter().zip(&w).map(|(pc, w)| pc[j] * w).sum::<f64>();
                for i in 0..d {
                    let taken: f64 = (0..z.len())
                        .map(|k| (0..z.len()).map(|l| pc[k][i] * precision[k][l] * pc[l][j]).sum::<f64>())
                        .sum();
                    now.covariance[i * d + j] -= taken;
                }
            }
            out.push((now.clone(), log));
        }
        out
    }
}
