//! The shift of the world that offsets of cameras cannot tell, and how far it may reach.
//!
//! Offsets b_c of cameras (observed − projected) and a shift δ of everything that is seen show the same keypoints: with b_c goes b_c − J_c δ, J_c the derivative of camera c's pixels at the middle of the recording ([`crate::offsets`]). What distinguishes them is
//! only how large offsets are. In units of the focal length, that is in radians,
//!
//! ```text
//! b_c | τ ~ t₄(0, τ² I₂) independently,   ln τ ~ N(ln 0.003, 1),   δ flat
//! ```
//!
//! Student's t, since one camera that was moved is off by more than the others. τ is between 0.4 and 21 mrad with 95 % and is integrated, never set to an estimate: with four cameras five of eight numbers tell it. Its middle is that of extrinsic calibrations whose errors are some
//! 5 mm or 0.2° (3.5 mrad) from a few metres away.
//!
//! Draws are from Gibbs sampling of t as a mixture of Gaussians, λ_c ~ Gamma(2, 2), with r_c = b_c − J_c δ:
//!
//! 1. λ_c ~ Gamma(3, 2 + |r_c|² / 2 τ²)
//! 2. δ ~ N(H⁻¹ Σ λ_c J_cᵀ b_c, τ² H⁻¹), H = Σ λ_c J_cᵀ J_c
//! 3. ln τ from its conditional on a grid, at a random place within the cell

use crate::camera::Camera;
use nalgebra::{Matrix2x3, Matrix3, Vector2, Vector3};
use sinew_core::lanes::{Block, Isa};
use sinew_core::random::{BlockRng, Stage};

/// Half the degrees of freedom of Student's t.
const HALF_FREEDOM: f64 = 2.0;
/// Middle of the prior of τ, radians.
const USUAL: f64 = 0.003;
/// Grid of ln τ about its middle: half the width, and the number of cells.
const REACH: f64 = 5.0;
const CELLS: usize = 120;
/// Rounds before the first draw, and from each draw to the next.
const BURN_IN: usize = 200;
const APART: usize = 5;
/// Draws of a mean.
const DRAWS: usize = 4000;

/// One camera: J_c and b_c over the focal length.
#[derive(Clone, Debug)]
struct View {
    jacobian: Matrix2x3<f64>,
    offset: Vector2<f64>,
}

/// What is known of the shift.
#[derive(Clone, Debug)]
pub struct CommonShift {
    views: Vec<View>,
}

/// Random numbers of one round: normals for δ, uniforms for λ and τ.
struct Luck {
    rng: BlockRng,
    normal: [Block; 3],
    uniform: Vec<Block>,
    lane: usize,
}

impl Luck {
    fn new(rng: BlockRng, views: usize) -> Self {
        Self { rng, normal: [Block::ZERO; 3], uniform: vec![Block::ZERO; 3 * views + 2], lane: 8 }
    }

    fn next(&mut self) -> usize {
        self.lane += 1;
        if self.lane > 7 {
            self.rng.fill_normal(Isa::baseline(), &mut self.normal);
            self.rng.fill_uniform(&mut self.uniform);
            self.lane = 0;
        }
        self.lane
    }
}

impl CommonShift {
    /// From offsets (pixels) of cameras and the middle of what they see (metres); `None` where fewer than two see it.
    #[must_use]
    pub fn new(cameras: &[Camera], offsets_px: &[[f64; 2]], at: [f64; 3]) -> Option<Self> {
        let view = |(camera, offset): (&Camera, &[f64; 2])| {
            let (_, rows) = camera.project_with_jacobian(at)?;
            let focal = [camera.intrinsics.fx, camera.intrinsics.fy];
            let jacobian = Matrix2x3::from_fn(|axis, k| rows[axis][k] / focal[axis]);
            let offset = Vector2::from_fn(|axis, _| offset[axis] / focal[axis]);
            Some(View { jacobian, offset })
        };
        let views: Vec<View> = cameras.iter().zip(offsets_px).filter_map(view).collect();
        let information: Matrix3<f64> = views.iter().map(|view| view.jacobian.transpose() * view.jacobian).sum();
        (views.len() > 1 && information.try_inverse().is_some()).then_some(Self { views })
    }

    /// One round; nothing moves where rounding leaves no Cholesky factor.
    fn round(&self, shift: &mut Vector3<f64>, log_tau: &mut f64, luck: &mut Luck) {
        let lane = luck.next();
        let (mut information, mut pull) = (Matrix3::<f64>::zeros(), Vector3::<f64>::zeros());
        let mut squares = 0.0;
        for (view, uniform) in self.views.iter().zip(luck.uniform.chunks_exact(3)) {
            let remains = view.offset - view.jacobian * *shift;
            let rate = HALF_FREEDOM + 0.5 * remains.norm_squared() * (-2.0 * *log_tau).exp();
            let weight = uniform.iter().map(|u| -(1.0 - u.0[lane]).ln()).sum::<f64>() / rate;
            information += weight * view.jacobian.transpose() * view.jacobian;
            pull += weight * view.jacobian.transpose() * view.offset;
            squares += weight * view.offset.norm_squared();
        }
        let Some(factor) = information.cholesky() else { return };
        let normal = Vector3::from_fn(|k, _| luck.normal[k].0[lane]);
        let mean = factor.solve(&pull);
        let Some(away) = factor.l().transpose().solve_upper_triangular(&normal) else { return };
        *shift = mean + log_tau.exp() * away;
        // Σ λ |b − J δ|² of the new δ.
        let remains = (squares - 2.0 * pull.dot(shift) + (information * *shift).dot(shift)).max(0.0);
        let count = 2.0 * self.views.len() as f64;
        let place = |cell: f64| USUAL.ln() + REACH * (2.0 * cell / CELLS as f64 - 1.0);
        let log = |cell: usize| {
            let x = place(cell as f64 + 0.5);
            -count * x - 0.5 * remains * (-2.0 * x).exp() - 0.5 * (x - USUAL.ln()).powi(2)
        };
        let logs: [f64; CELLS] = std::array::from_fn(log);
        let largest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let total: f64 = logs.iter().map(|log| (log - largest).exp()).sum();
        let [chosen, within] = [2, 1].map(|back: usize| luck.uniform[luck.uniform.len() - back].0[lane]);
        let mut left = chosen * total;
        let cell = logs.iter().position(|log| {
            left -= (log - largest).exp();
            left <= 0.0
        });
        *log_tau = place(cell.unwrap_or(CELLS - 1) as f64 + within);
    }

    /// Mean of δ, metres, of the same draws whatever the run.
    #[must_use]
    pub fn mean(&self) -> [f64; 3] {
        mean_of(&self.draws(DRAWS, Stage::new(0, "common shift")))
    }

    /// Standard deviation of δ per axis, metres: the root of a third of the trace of its covariance.
    #[must_use]
    pub fn sd_m(&self) -> f64 {
        let draws = self.draws(DRAWS, Stage::new(0, "common shift"));
        let mean = mean_of(&draws);
        let square = |draw: &[f64; 3]| draw.iter().zip(mean).map(|(x, mean)| (x - mean) * (x - mean)).sum::<f64>();
        (draws.iter().map(square).sum::<f64>() / (3 * draws.len()) as f64).sqrt()
    }

    /// Draws of δ, metres: where everything lies, less where it seems to lie.
    #[must_use]
    pub fn draws(&self, count: usize, stage: Stage) -> Vec<[f64; 3]> {
        let mut luck = Luck::new(stage.whole(), self.views.len());
        let (mut shift, mut log_tau) = (Vector3::zeros(), USUAL.ln());
        (0..BURN_IN).for_each(|_| self.round(&mut shift, &mut log_tau, &mut luck));
        let mut draw = || {
            (0..APART).for_each(|_| self.round(&mut shift, &mut log_tau, &mut luck));
            [shift.x, shift.y, shift.z]
        };
        (0..count).map(|_| draw()).collect()
    }
}

fn mean_of(draws: &[[f64; 3]]) -> [f64; 3] {
    [0, 1, 2].map(|k: usize| draws.iter().map(|draw| draw[k]).sum::<f64>() / draws.len() as f64)
}
