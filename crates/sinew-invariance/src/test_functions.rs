//! What a test looks at: functions of a state whose distribution must not change.

/// Named functions of a state.
///
/// [`TestFunctions::moments`] is where to begin. Add what your target is about: its log density (the strongest single function for a wrong temperature or step), the indicator of a mode, a ratio that matters to you.
pub struct TestFunctions<'a> {
    names: Vec<String>,
    evaluate: Vec<Function<'a>>,
    /// Of a function that is the square of another: the place of that one.
    coordinates_of_squares: Vec<Option<usize>>,
}

type Function<'a> = Box<dyn Fn(&[f64]) -> f64 + 'a>;

/// Most products of two coordinates in [`TestFunctions::moments`].
const PAIRS: usize = 10;

impl<'a> TestFunctions<'a> {
    /// No function yet.
    #[must_use]
    pub fn none() -> Self {
        Self { names: vec![], evaluate: vec![], coordinates_of_squares: vec![] }
    }

    /// Every coordinate of a state of `dim`, its square, and products of pairs, at most ten, spread over all.
    #[must_use]
    pub fn moments(dim: usize) -> Self {
        let mut all = Self::none();
        for i in 0..dim {
            all = all.with(format!("x{i}"), move |x| x[i]).with(format!("x{i}²"), move |x| x[i] * x[i]);
            all.coordinates_of_squares[2 * i + 1] = Some(2 * i);
        }
        let pairs: Vec<(usize, usize)> = (0..dim).flat_map(|i| (0..i).map(move |j| (i, j))).collect();
        let every = pairs.len().div_ceil(PAIRS).max(1);
        for &(i, j) in pairs.iter().step_by(every) {
            all = all.with(format!("x{i} x{j}"), move |x| x[i] * x[j]);
        }
        all
    }

    /// One more.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, function: impl Fn(&[f64]) -> f64 + 'a) -> Self {
        self.names.push(name.into());
        self.evaluate.push(Box::new(function));
        self.coordinates_of_squares.push(None);
        self
    }

    /// For a kernel that moves `chains` states together: its state is theirs one after the other, and each function becomes its mean over them.
    ///
    /// # Panics
    /// When `chains` is 0; later, when a state does not have `chains` chains.
    #[must_use]
    pub fn together(self, chains: usize) -> Self {
        assert!(chains > 0, "a kernel moves at least one state");
        let pooled = |function: Function<'a>| -> Function<'a> {
            Box::new(move |x: &[f64]| {
                assert!(
                    !x.is_empty() && x.len().is_multiple_of(chains),
                    "{} numbers are no states of {chains} chains",
                    x.len()
                );
                x.chunks_exact(x.len() / chains).map(&*function).sum::<f64>() / chains as f64
            })
        };
        Self { evaluate: self.evaluate.into_iter().map(pooled).collect(), ..self }
    }

    /// Panics when there is none: a test that looks at nothing passes.
    #[track_caller]
    pub(crate) fn assert_some(&self) {
        assert!(!self.names.is_empty(), "at least one test function");
    }

    /// For each function that is the square of a coordinate, the place of that coordinate.
    pub(crate) fn coordinates_of_squares(&self) -> impl Iterator<Item = Option<usize>> {
        self.coordinates_of_squares.iter().copied()
    }

    /// Their names.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Their values at a state, in the order of [`TestFunctions::names`].
    #[must_use]
    pub fn at(&self, x: &[f64]) -> Vec<f64> {
        self.evaluate.iter().map(|function| function(x)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_named_and_bounded_in_number() {
        let two = TestFunctions::moments(2);
        assert_eq!(two.names(), ["x0", "x0²", "x1", "x1²", "x1 x0"]);
        assert_eq!(two.at(&[2.0, 3.0]), [2.0, 4.0, 3.0, 9.0, 6.0]);
        let many = TestFunctions::moments(28).names().len();
        assert!((56 + 9..=56 + 10).contains(&many), "{many}");
        assert_eq!(TestFunctions::moments(1).names().len(), 2);
    }

    #[test]
    fn chains_that_move_together_are_averaged() {
        let functions = TestFunctions::none().with("sum", |x| x[0] + x[1]).together(2);
        assert_eq!(functions.at(&[1.0, 2.0, 3.0, 6.0]), [6.0]);
    }
}
