//! Scatter of cameras whose residuals do not say whose errors they are.

/// Share of the difference of a camera's scatter from the others', in logarithms, that is taken for its own.
const OWN: f64 = 0.5;

/// Scatter of cameras, metres, nearer to their geometric mean: the residuals of few cameras do not say whose errors they are. A camera that is trusted more has smaller residuals, is trusted more again, and of three one may end at a third of its scatter.
pub(super) fn like_the_others(own: &[f64]) -> Vec<f64> {
    let known = || own.iter().filter(|x| x.is_finite()).map(|x| x.ln());
    let usual = known().sum::<f64>() / known().count() as f64;
    own.iter().map(|x| (usual + OWN * (x.ln() - usual)).exp()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half of the difference stays; a camera of which nothing is known stays so.
    #[test]
    fn scatter_is_drawn_to_that_of_the_others() {
        let found = like_the_others(&[0.01, 0.04, f64::NAN]);
        assert!((found[0] - 0.01 * 2.0_f64.sqrt()).abs() < 1e-12 && (found[1] - 0.04 / 2.0_f64.sqrt()).abs() < 1e-12);
        assert!(found[2].is_nan());
        assert!((like_the_others(&[0.02])[0] - 0.02).abs() < 1e-12);
    }
}
