//! How much wider a prior must be because few draws made it.
//!
//! A filter that makes the prior N(m̂, Ĉ + Q) of a frame from n draws of the frame before is too narrow, the more so the more dimensions there are. Let E be the error of Ĉ, Λ the precision of the prior, A that of the observation, P = (Λ + A)⁻¹,
//! F = P Λ what the frame keeps of its prior, and B = Λ − Λ P Λ. To second order in E
//!
//! ```text
//! mean of the posterior covariance               = P − F E[E B E] Fᵀ
//! covariance of the mean's error, by wrong gains =     F E[E B E] Fᵀ      E[E B E] = (C B C + tr(B C) C) / n
//! ```
//!
//! The left is P's expansion, the right the second moment of a sample covariance. So the posterior is narrow by as much as its mean errs, which ensemble Kalman filters know as inbreeding (Furrer & Bengtsson 2007; Sacher & Bartello 2008). An honest prior is wider by 2 E[E B E].
//! Where observations are precise this is twice the (d + 1) / n of an inverse Wishart matrix's mean; where nothing is seen B is 0 and nothing is lost.
//!
//! E is carried on: a frame later it is F E Fᵀ. In the axes in which the posterior has unit variances and F is diagonal, with the shares m_i that a frame keeps, after T frames that were seen alike,
//!
//! ```text
//! 2 E[E B E]_ii = (2 / n') Σ_l (1 + [l = i]) m_l (1 − m_l) Σ_{t < T} (m_i m_l)^(2 t)      1 / n' = n / (n + d)²
//! ```
//!
//! where n is the effective number of draws for squares and n' that after the shrinkage of [`crate::metric`]. The error of the mean of the draws themselves adds C / n̄, n̄ the effective number for means.
//! The axes are the metric's, so Ĉ gets what it lost in units of G⁻¹. The next frame is taken to be seen like this one, and the motion to be near the identity.

use crate::chains::ChainQuality;
use crate::metric::Metric;
use faer::{Col, MatRef, Side};
use sinew_core::transition::Moments;

/// 2 n' E[E B E]_ii of each axis after `frames` frames, from the shares m.
fn lost(shares: &[f64], frames: usize) -> Vec<f64> {
    // 1 + x + … + x^(frames − 1).
    let carried = |x: f64| if x < 1.0 { (1.0 - x.powf(frames as f64)) / (1.0 - x) } else { frames as f64 };
    let pair = |m: f64, l: f64| l * (1.0 - l) * carried((m * l).powi(2));
    shares.iter().map(|&m| 2.0 * (pair(m, m) + shares.iter().map(|&l| pair(m, l)).sum::<f64>())).collect()
}

/// Widens the shrunk moments of a frame's draws for the prior of the next frame, the last of `frames` frames that follow from each other. `metric` and `precision`, that of the frame's own prior, are what the draws were made with.
pub fn widen(moments: &mut Moments, quality: &ChainQuality, metric: &Metric, precision: &[f64], frames: usize) {
    let d = moments.mean.len();
    let from_mean = 1.0 + 1.0 / quality.ess.max(1.0);
    moments.covariance.iter_mut().for_each(|entry| *entry *= from_mean);
    let whitening = metric.whitening();
    let kept = whitening.transpose() * MatRef::from_row_major_slice(precision, d, d) * &whitening;
    let Ok(eigen) = kept.self_adjoint_eigen(Side::Lower) else { return };
    let shares: Vec<f64> = eigen.S().column_vector().iter().map(|m| m.clamp(0.0, 1.0)).collect();
    let draws = quality.ess_of_squares.max(0.0);
    let variance = draws / (draws + d as f64).powi(2);
    let mut wider = Col::<f64>::zeros(d);
    wider.iter_mut().zip(lost(&shares, frames)).for_each(|(wider, lost)| *wider = (variance * lost).sqrt());
    let root = whitening * eigen.U() * wider.as_diagonal();
    let added = &root * root.transpose();
    for (k, entry) in moments.covariance.iter_mut().enumerate() {
        *entry += 0.5 * (added[(k / d, k % d)] + added[(k % d, k / d)]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::moments::moments;
    use faer::Mat;
    use faer::linalg::solvers::Solve;
    use sinew_core::lanes::{Block, Isa, LANES};
    use sinew_core::random::Stage;
    use sinew_core::transition::diagonal_matrix;

    fn quality(ess: f64, ess_of_squares: f64) -> ChainQuality {
        ChainQuality { ess, r_hat: 1.0, ess_of_squares, energy_fraction: 1.0 }
    }

    fn unit(d: usize) -> Moments {
        Moments { mean: vec![0.0; d], covariance: diagonal_matrix(&vec![1.0; d]) }
    }

    #[test]
    fn axes_without_observation_lose_nothing() {
        let (mut moments, precision) = (unit(3), unit(3).covariance);
        widen(&mut moments, &quality(400.0, 100.0), &Metric::Diagonal(vec![1.0; 3]), &precision, 1000);
        let expected = unit(3).covariance.iter().map(|c| c * (1.0 + 1.0 / 400.0)).collect::<Vec<_>>();
        assert!(moments.covariance.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12), "{moments:?}");
    }

    #[test]
    fn losses_of_earlier_frames_are_carried() {
        assert_eq!(lost(&[0.5], 1), [1.0]);
        assert_eq!(lost(&[0.5, 1.0], 1), [1.0, 0.5]);
        assert!((lost(&[0.5], 2)[0] - (1.0 + 1.0 / 16.0)).abs() < 1e-15);
        assert!((lost(&[0.5], 500)[0] - 1.0 / (1.0 - 1.0 / 16.0)).abs() < 1e-15);
        assert_eq!(lost(&[0.0, 1.0], 500), [0.0, 0.0]);
    }

    /// One frame in four coordinates: the prior N(m̂, Ĉ + ½ I) of 60 independent draws from N(0, ½ I), each coordinate seen with errors of variance 1, so that the posterior's variance is ½ again and F is ½. What variance and squared error of the mean lack comes back, to an eighth (third order in E).
    #[test]
    fn one_frame_gets_back_what_it_loses() {
        let (d, n, runs) = (4, 60_usize, 4000);
        let mut rng = Stage::new(3, "one frame").whole();
        let mut draws = vec![Block::ZERO; d * n.div_ceil(LANES)];
        let (mut seen, mut lack) = (vec![Block::ZERO; d], 0.0);
        let weights = vec![1.0 / n as f64; n];
        for _ in 0..runs {
            rng.fill_normal(Isa::best(), &mut draws);
            rng.fill_normal(Isa::best(), &mut seen);
            let drawn = moments(Isa::best(), &draws, d, &weights, n as f64);
            let prior = Mat::from_fn(d, d, |i, j| 0.5 * (drawn.covariance[i * d + j] + f64::from(u8::from(i == j))));
            let total = &prior + Mat::<f64>::identity(d, d);
            let gain = prior * total.llt(Side::Lower).expect("positive definite").solve(Mat::<f64>::identity(d, d));
            for i in 0..d {
                let moved = |j: usize| gain[(i, j)] * (2.0 * seen[j].0[0] - drawn.mean[j]);
                let error = 0.5_f64.sqrt() * (drawn.mean[i] + (0..d).map(moved).sum::<f64>() - seen[i].0[0]);
                lack += (error * error + 0.5 - gain[(i, i)]) / (d * runs) as f64;
            }
        }
        // Draws that are not shrunk: the effective number at which n' is 60.
        let n = n as f64;
        let unshrunk = quality(n, 0.5 * (n - 8.0 + (n * n - 16.0 * n).sqrt()));
        let mut widened = Moments { mean: vec![0.0; d], covariance: diagonal_matrix(&vec![0.5; d]) };
        widen(&mut widened, &unshrunk, &Metric::Diagonal(vec![2.0; d]), &unit(d).covariance, 1);
        let given = 0.25 * (widened.covariance[0] - 0.5);
        assert!((lack / given - 1.0).abs() < 0.125, "{lack} for {given}");
    }
}
