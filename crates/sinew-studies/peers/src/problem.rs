//! The benchmark problem of 28 dimensions, a posterior of one body in one frame.

use sinew::core::combinators::Sum;
use sinew::core::density::Lanes;
use sinew::core::lanes::Isa;
use sinew::dynamics::prior::Prior;
use sinew_markers::MarkerLikelihood;
use sinew_tests::problem28;

/// The problem in the forms that samplers ask for.
pub struct Problem {
    /// The likelihood alone.
    pub likelihood: Lanes<MarkerLikelihood>,
    /// The prior alone.
    pub prior: Prior,
    /// Mean of the prior's components.
    pub middle: Vec<f64>,
    /// Instruction set.
    pub isa: Isa,
}

impl Problem {
    /// Of the repository.
    pub fn load() -> Self {
        let (problem, isa) = (problem28::load(), Isa::best());
        let components = problem.prior_centres.len() as f64;
        let middle = (0..28).map(|j| problem.prior_centres.iter().map(|c| c[j]).sum::<f64>() / components).collect();
        Self { likelihood: problem.likelihood(isa), prior: Prior::Mixture(problem.prior(isa)), middle, isa }
    }

    /// The posterior.
    pub fn target(&self) -> Sum<&Lanes<MarkerLikelihood>, &Prior> {
        Sum(&self.likelihood, &self.prior)
    }
}
