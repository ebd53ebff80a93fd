//! What a check has found: a statistic between two bounds.

/// One statistic of a check.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What was measured.
    pub name: String,
    /// The number.
    pub statistic: f64,
    /// Least and largest value with which the claim stands.
    pub bounds: [f64; 2],
    /// Probability that it leaves the bounds although the claim is true; 0 where nothing is random.
    pub false_alarm: f64,
    /// What else helps to judge it: means, errors, seeds.
    pub detail: String,
}

/// Probability that a standard normal deviate is beyond ±4.5.
pub const BEYOND_4_5: f64 = 6.8e-6;
/// The same of ±5.
pub const BEYOND_5: f64 = 5.7e-7;

impl Finding {
    /// A z score within ±`bound`; the false alarm is that of a normal deviate.
    #[must_use]
    pub fn score(name: impl Into<String>, z: f64, bound: f64, detail: impl Into<String>) -> Self {
        let false_alarm = if bound >= 5.0 {
            BEYOND_5
        } else if bound >= 4.5 {
            BEYOND_4_5
        } else {
            6.4e-5
        };
        Self { name: name.into(), statistic: z, bounds: [-bound, bound], false_alarm, detail: detail.into() }
    }

    /// A number of at most `bound`, exact or with bounds so wide that chance plays no part.
    #[must_use]
    pub fn at_most(name: impl Into<String>, statistic: f64, bound: f64, detail: impl Into<String>) -> Self {
        let bounds = [f64::NEG_INFINITY, bound];
        Self { name: name.into(), statistic, bounds, false_alarm: 0.0, detail: detail.into() }
    }

    /// A number between two bounds.
    #[must_use]
    pub fn between(name: impl Into<String>, statistic: f64, bounds: [f64; 2], detail: impl Into<String>) -> Self {
        Self { name: name.into(), statistic, bounds, false_alarm: 0.0, detail: detail.into() }
    }

    /// Whether it lies within its bounds; a number that is not one does not.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.bounds[0] <= self.statistic && self.statistic <= self.bounds[1]
    }
}

/// Prints all findings and fails, naming those that do not hold.
///
/// # Panics
/// Where one does not hold.
pub fn demand(findings: &[Finding]) {
    for f in findings {
        let mark = if f.holds() { "holds" } else { "FAILS" };
        println!(
            "{mark}  {}: {:.6} in [{}, {}], false alarm {:.0e}; {}",
            f.name, f.statistic, f.bounds[0], f.bounds[1], f.false_alarm, f.detail
        );
    }
    let failed: Vec<&Finding> = findings.iter().filter(|f| !f.holds()).collect();
    assert!(failed.is_empty(), "{failed:#?}");
}

/// Mean and standard error of independent numbers.
#[must_use]
pub fn mean_and_error(values: &[f64]) -> [f64; 2] {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
    [mean, (variance / n).sqrt()]
}

/// Ratio of the means of two columns of paired rows and its standard error, by the delta method.
#[must_use]
pub fn ratio_of_means(rows: &[Vec<f64>], top: usize, bottom: usize) -> [f64; 2] {
    let n = rows.len() as f64;
    let mean = |k: usize| rows.iter().map(|row| row[k]).sum::<f64>() / n;
    let (above, below) = (mean(top), mean(bottom));
    let ratio = above / below;
    let squares: f64 = rows.iter().map(|row| (row[top] - ratio * row[bottom]).powi(2)).sum();
    [ratio, (squares / (n * (n - 1.0))).sqrt() / below]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_of_paired_rows_have_paired_errors() {
        let rows = vec![vec![1.0, 2.0], vec![2.0, 4.0], vec![5.0, 10.0]];
        let [value, error] = ratio_of_means(&rows, 0, 1);
        assert!((value - 0.5).abs() < 1e-15 && error < 1e-15);
        let [value, error] = ratio_of_means(&[vec![1.0, 1.0], vec![3.0, 1.0]], 0, 1);
        assert!((value - 2.0).abs() < 1e-15 && (error - 1.0).abs() < 1e-15);
    }
}
