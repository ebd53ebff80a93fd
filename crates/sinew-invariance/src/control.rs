//! How much evidence a verdict needs, and what decides in each stage ([`crate::Control`]).

/// How much evidence a verdict needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Probability α that a right sampler fails the test.
    pub false_alarm_rate: f64,
    /// Most stages K, at least 1.
    pub stages: usize,
    /// Factor by which the number of draws grows after each stage that did not decide.
    pub growth: usize,
}

impl Default for Control {
    fn default() -> Self {
        Self { false_alarm_rate: 1e-6, stages: 3, growth: 4 }
    }
}

/// What decides in one stage, of q = d · min p.
pub(crate) struct Threshold {
    /// β: the test fails at this q and below.
    pub fails: f64,
    /// γ + β: at this q and below it does not hold yet.
    pub doubtful: f64,
    /// Draws, in those of the first stage.
    pub growth: usize,
    gamma: f64,
    stages_left: usize,
    by: usize,
}

impl Threshold {
    pub fn first(control: &Control) -> Self {
        let stages = control.stages.max(1);
        let fails = control.false_alarm_rate / stages as f64;
        let gamma = fails.powf(1.0 / stages as f64);
        Self { fails, doubtful: gamma + fails, growth: 1, gamma, stages_left: stages - 1, by: control.growth.max(1) }
    }

    pub fn is_last(&self) -> bool {
        self.stages_left == 0
    }

    pub fn next(&self) -> Self {
        let fails = self.fails / self.gamma;
        let (growth, stages_left) = (self.growth * self.by, self.stages_left - 1);
        Self { fails, doubtful: self.gamma + fails, growth, stages_left, ..*self }
    }
}
