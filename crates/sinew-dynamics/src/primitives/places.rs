//! Which coordinates of a state a feature vector covers, and how wide a step of the random walk is.

/// Which coordinates the feature vector covers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Places {
    /// A: the coordinates of the feature vector.
    pub(crate) covered: Vec<usize>,
    /// R: all others.
    pub(crate) rest: Vec<usize>,
    /// Standard deviations B of all coordinates.
    pub(crate) sd: Vec<f64>,
    /// 1 / B.
    pub(crate) inverse_sd: Vec<f64>,
}
