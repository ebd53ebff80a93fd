//! Unpublished: exact references and statistical checks of the workspace, as functions of a seed and a size. The tests in this member's `tests/` folder call them in reduced size; statistical, conformance and
//! end-to-end tests live there too.

pub mod calibrated_samplers;
pub mod checks;
pub mod joint_distribution;
pub mod kernels;
pub mod outcome;
pub mod planted_hmc;
pub mod resampling_laws;
pub mod sampler_invariance;
pub mod simulators;
pub mod size;
