//! How much smaller a posterior is than its prior, by volumes.

/// Base-ten logarithms of the volume ratio of prior and posterior: by marginal standard deviations and by determinants. The covariance of the posterior is d × d, row after row; the prior's coordinates are independent.
#[must_use]
pub fn log10_volume_ratios(covariance: &[f64], prior_sd: &[f64]) -> [f64; 2] {
    let d = prior_sd.len();
    let prior: f64 = prior_sd.iter().map(|sd| sd.log10()).sum();
    let marginal: f64 = (0..d).map(|j| 0.5 * covariance[j * d + j].log10()).sum();
    [prior - marginal, prior - 0.5 * log10_det(covariance.to_vec(), d)]
}

/// Base-ten logarithm of the determinant of a positive definite matrix.
fn log10_det(mut m: Vec<f64>, d: usize) -> f64 {
    let mut log = 0.0;
    for k in 0..d {
        let pivot = m[k * d + k];
        log += pivot.log10();
        for i in k + 1..d {
            let factor = m[i * d + k] / pivot;
            for j in k..d {
                m[i * d + j] -= factor * m[k * d + j];
            }
        }
    }
    log
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn determinants_of_known_matrices() {
        assert!((log10_det(vec![4.0, 2.0, 2.0, 26.0], 2) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn correlation_makes_a_volume_smaller_by_determinants_alone() {
        let [by_sd, by_det] = log10_volume_ratios(&[1.0, 0.6, 0.6, 1.0], &[10.0, 10.0]);
        assert!((by_sd - 2.0).abs() < 1e-12 && (by_det - 2.0 - 0.5 * (1.0_f64 / 0.64).log10()).abs() < 1e-12);
    }
}
