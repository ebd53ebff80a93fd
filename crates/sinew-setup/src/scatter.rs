//! Scatter of cameras, drawn towards their geometric mean: the residuals of few cameras do not tell which camera erred.

/// Share of the difference between the logarithm of a camera's scatter and the mean logarithm of all that is kept.
const OWN: f64 = 0.5;

/// For each camera `exp(m + OWN (ln s − m))`, metres, with s its scatter and m the mean of ln s over the cameras with a finite one; NaN stays NaN. Without this a camera that is trusted more gets smaller residuals and is trusted more again, so that one of three may end at a third of its true scatter.
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
