//! Mean and spread over strides of each gait parameter, with the interval of the mean.
//!
//! The mean is over the strides of the recording, and so is its interval: in each draw the mean is taken over the strides, so that errors that last over the run do not average out. It says nothing of strides that were not recorded; the standard deviation between strides does.

use super::strides::{PARAMETERS, Stride};
use super::varied::Varied;

/// A parameter over strides.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterSummary {
    /// Strides that show it.
    pub strides: usize,
    /// Mean over the strides, from the means and in each draw.
    pub mean: Varied,
    /// Standard deviation between the strides; NaN for one stride.
    pub sd: f64,
}

/// The summary of each of [`PARAMETERS`] over the strides of a side, or of both.
#[must_use]
pub fn summary(strides: &[Stride], side: Option<usize>) -> [Option<ParameterSummary>; PARAMETERS.len()] {
    std::array::from_fn(|parameter| {
        let own = strides.iter().filter(|stride| side.is_none_or(|side| stride.side == side));
        let shown: Vec<&Varied> = own.filter_map(|stride| stride.parameters[parameter].as_ref()).collect();
        let draws = shown.iter().map(|varied| varied.draws.len()).min()?;
        let count = shown.len() as f64;
        let mean = Varied::new(draws, |draw| shown.iter().map(|varied| varied.at(draw)).sum::<f64>() / count);
        let square = shown.iter().map(|varied| (varied.mean - mean.mean).powi(2)).sum::<f64>();
        Some(ParameterSummary { strides: shown.len(), sd: (square / (count - 1.0)).sqrt(), mean })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_that_all_draws_share_do_not_average_out() {
        let stride = |side: usize, mean: f64| Stride {
            side,
            start_s: 0.0,
            end_s: 1.0,
            toe_off_s: None,
            parameters: std::array::from_fn(|k| (k == 0).then(|| Varied { mean, draws: vec![mean - 1.0, mean + 1.0] })),
        };
        let strides = [stride(0, 1.0), stride(1, 5.0), stride(0, 3.0)];
        let left = summary(&strides, Some(0))[0].clone().unwrap();
        assert_eq!((left.strides, left.mean.mean, left.sd), (2, 2.0, 2.0_f64.sqrt()));
        assert_eq!(left.mean.draws, [1.0, 3.0]);
        assert_eq!(summary(&strides, None)[0].clone().unwrap().mean.mean, 3.0);
        assert!(summary(&strides, Some(1))[0].clone().unwrap().sd.is_nan());
        assert!(summary(&strides, None)[1].is_none() && summary(&[], None)[0].is_none());
    }
}
