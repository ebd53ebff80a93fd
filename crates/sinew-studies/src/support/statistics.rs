//! Means, medians and verdicts of what runs have left.

use super::table::with_spread;
use sinew::core::estimators;
pub(crate) use sinew_tests::finding::mean_and_error;
use std::borrow::Borrow;

/// Mean; NaN of nothing.
pub(crate) fn mean(values: impl IntoIterator<Item = impl Borrow<f64>>) -> f64 {
    estimators::mean(&values.into_iter().map(|x| *x.borrow()).collect::<Vec<f64>>())
}

/// Root of the mean square.
pub(crate) fn rms(values: &[f64]) -> f64 {
    mean(values.iter().map(|x| x * x)).sqrt()
}

/// Mean and standard error as tables show them; one value alone has no error.
pub(crate) fn with_error(values: &[f64], decimals: usize) -> String {
    let [mean, error] = mean_and_error(values);
    with_spread([mean, if values.len() > 1 { error } else { 0.0 }], decimals)
}

/// Median; NaN of nothing.
pub(crate) fn median(values: impl IntoIterator<Item = impl Borrow<f64>>) -> f64 {
    estimators::median(&mut values.into_iter().map(|x| *x.borrow()).collect::<Vec<f64>>())
}

/// The value below which a share lies, that of the nearest rank; none of nothing.
pub(crate) fn quantile(values: &[f64], share: f64) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get((share * sorted.len().saturating_sub(1) as f64).round() as usize).copied()
}

/// Whether a claim or a bound holds (docs/reference/claims.md).
pub(crate) fn verdict(holds: bool) -> &'static str {
    if holds { "holds" } else { "**does not hold**" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_and_the_ends_are_found() {
        let values = [4.0, 1.0, 3.0, 2.0];
        assert_eq!((mean(values), median(values), rms(&[3.0, -3.0])), (2.5, 2.5, 3.0));
        assert_eq!([0.0, 0.34, 1.0].map(|share| quantile(&values, share)), [Some(1.0), Some(2.0), Some(4.0)]);
        assert_eq!((quantile(&[], 0.5), with_error(&[1.25], 1).as_str()), (None, "1.2 ± 0.0"));
        assert_eq!(with_error(&[1.0, 3.0], 2), "2.00 ± 1.00");
    }
}
