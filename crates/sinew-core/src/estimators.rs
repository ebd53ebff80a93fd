//! Mean, variance, quantiles and median of plain numbers.

/// Mean; NaN of nothing.
#[must_use]
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Variance without bias, with one less than their number in the denominator.
#[must_use]
pub fn variance(values: &[f64]) -> f64 {
    let middle = mean(values);
    values.iter().map(|x| (x - middle) * (x - middle)).sum::<f64>() / (values.len() as f64 - 1.0)
}

/// Median, of an even number the mean of the two in the middle; NaN of nothing. The values are sorted on the way.
#[must_use]
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        n => 0.5 * (values[(n - 1) / 2] + values[n / 2]),
    }
}

/// Quantile of rising values, on the line between two order statistics (Hyndman & Fan 1996, type 7, NumPy's); NaN of nothing.
#[must_use]
pub fn quantile(rising: &[f64], p: f64) -> f64 {
    let Some(last) = rising.len().checked_sub(1) else { return f64::NAN };
    let place = p.clamp(0.0, 1.0) * last as f64;
    let low = place.floor() as usize;
    if place.fract() == 0.0 {
        return rising[low];
    }
    rising[low] + place.fract() * (rising[low + 1] - rising[low])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_numbers_and_none() {
        let mut values = [4.0, 1.0, 7.0, 2.0];
        assert_eq!((mean(&values), variance(&values), median(&mut values)), (3.5, 7.0, 3.0));
        assert_eq!([0.0, 0.5, 0.75, 1.0].map(|p| quantile(&values, p)), [1.0, 3.0, 4.75, 7.0]);
        assert_eq!(quantile(&[1.0, 2.0, f64::INFINITY], 0.5), 2.0);
        assert_eq!((median(&mut [5.0, 1.0, 2.0]), variance(&[2.0, 2.0])), (2.0, 0.0));
        assert!(mean(&[]).is_nan() && median(&mut []).is_nan() && quantile(&[], 0.5).is_nan());
    }
}
