//! How large a check is.

/// Sizes of statistical checks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// For the ordinary suite: seconds.
    Reduced,
    /// For `cargo xtask verify --nightly`: minutes.
    Full,
}

impl Size {
    /// One of two numbers.
    #[must_use]
    pub fn pick(self, reduced: usize, full: usize) -> usize {
        match self {
            Self::Reduced => reduced,
            Self::Full => full,
        }
    }
}
