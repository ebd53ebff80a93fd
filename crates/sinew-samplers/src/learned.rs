//! A dense metric learned from draws and their gradients.
//!
//! With the covariance C of the draws and B = E[∇ log p ∇ log pᵀ] of the gradients there, G is the positive definite matrix with G C G = B: the geometric mean of C⁻¹ and B, and the precision
//! of the Gaussian whose gradients are closest to the target's, in the mean over the target and in the units of the metric (Fisher divergence). C⁻¹ alone makes steps too short where
//! a valley bends, since its walls are steeper than the valley is wide; B alone makes trajectories too short for the valley's length. Of a Gaussian target both are the precision.
//!
//! With C = L Lᵀ and the eigendecomposition Lᵀ B L = U D Uᵀ, G = L⁻ᵀ U √D Uᵀ L⁻¹.
//!
//! Draws come from a warm-up and are then thrown away; the metric stays fixed while chains run.

use crate::Error;
use crate::chains::ChainDraws;
use crate::metric::{Dense, Metric};
use crate::moments::{moments, shrink};
use faer::{Mat, MatRef, Side};
use sinew_core::density::GradLogDensity;
use sinew_core::lanes::{Block, Isa, LANES};

/// The geometric mean of the draws' precision and the covariance of their gradients. `effective` is the number of independent draws that they are worth; both matrices are shrunk towards their
/// diagonals by it (see [`crate::moments`]).
///
/// # Errors
/// [`Error::Metric`] where a coordinate does not vary or a gradient is not finite; [`Error::Empty`] without a whole block of draws.
pub fn metric<T: GradLogDensity + ?Sized>(
    target: &T,
    draws: &ChainDraws,
    effective: f64,
    isa: Isa,
) -> Result<Metric, Error> {
    let d = target.dim();
    let blocks = draws.stats.len() / LANES;
    if d == 0 || blocks == 0 || draws.dim != d {
        return Err(Error::Empty { count: draws.stats.len(), dim: draws.dim });
    }
    let states = &draws.states[..blocks * d];
    let mut gradients = vec![Block::ZERO; states.len()];
    let mut workspace = vec![Block::ZERO; target.workspace()];
    for (state, gradient) in states.chunks_exact(d).zip(gradients.chunks_exact_mut(d)) {
        target.log_density_grad_block(state, gradient, &mut workspace);
    }
    let weights = vec![1.0 / (blocks * LANES) as f64; blocks * LANES];
    let [covariance, gradient_covariance] = [states, &gradients].map(|values| {
        let mut moments = moments(isa, values, d, &weights, effective);
        shrink(&mut moments, effective);
        moments.covariance
    });
    if covariance.iter().chain(&gradient_covariance).any(|x| !x.is_finite()) {
        return Err(Error::Metric);
    }
    let covariance = MatRef::from_row_major_slice(&covariance, d, d);
    let factor = covariance.llt(Side::Lower).map_err(|_| Error::Metric)?;
    let l = factor.L();
    let inner = l.transpose() * MatRef::from_row_major_slice(&gradient_covariance, d, d) * l;
    let eigen = inner.self_adjoint_eigen(Side::Lower).map_err(|_| Error::Metric)?;
    // With R = D^¼ Uᵀ L⁻¹, G = Rᵀ R.
    let mut root = Mat::<f64>::identity(d, d);
    l.solve_lower_triangular_in_place(root.as_mut());
    let mut root = eigen.U().transpose() * &root;
    for i in 0..d {
        let scale = eigen.S()[i].max(0.0).sqrt().sqrt();
        (0..d).for_each(|j| root[(i, j)] *= scale);
    }
    let metric = root.transpose() * &root;
    let whole: Vec<f64> = (0..d * d).map(|e| metric[(e / d, e % d)]).collect();
    Ok(Metric::Dense(Dense::new(&whole, d)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chains::{Schedule, draw_trajectories};
    use crate::hmc::Hmc;
    use sinew_core::density::Lanes;
    use sinew_core::lanes::triangle;
    use sinew_core::random::Stage;
    use sinew_core::toy::Quadratic;

    #[test]
    fn the_metric_of_a_gaussian_is_its_precision() {
        let isa = Isa::best();
        let precision = vec![1.0, 25.0, 0.04];
        let target = Lanes { leaf: Quadratic { centre: vec![1.0, 0.0, -3.0], precision: precision.clone() }, isa };
        let hmc = Hmc::new(0.5, &precision, 3, 0.2, isa).expect("valid");
        let schedule = Schedule { updates: 2000, burn_in: 100 };
        let draws = draw_trajectories(&target, &hmc, &[Block::ZERO; 3], 8, schedule, &Stage::new(1, "learn"))
            .expect("finite start");
        let Ok(Metric::Dense(dense)) = metric(&target, &draws, 15_000.0, isa) else { panic!("no dense metric") };
        for j in 0..3 {
            // A = G^(−1/2), and gradient and draw of a coordinate scatter alike: their ratio has no Monte Carlo error.
            let found = dense.columns[triangle(j, j)] * precision[j].sqrt();
            assert!((found - 1.0).abs() < 2e-3, "coordinate {j}: {found}");
            assert!((0..j).all(|i| (dense.columns[triangle(j, i)] * precision[i].sqrt()).abs() < 1e-3));
        }
        let flat = Lanes { leaf: Quadratic { centre: vec![0.0; 3], precision: vec![0.0; 3] }, isa };
        assert!(metric(&flat, &draws, 15_000.0, isa).is_err());
        assert!(matches!(metric(&target, &ChainDraws::default(), 1.0, isa), Err(Error::Empty { count: 0, dim: 0 })));
    }
}
