//! Unpublished: exact references and statistical checks of the workspace, as functions of a seed and a size. The tests in this member's `tests/` folder call them in reduced size; statistical, conformance and
//! end-to-end tests live there too.

pub mod annealing_laws;
pub mod calibrated_samplers;
pub mod camera_draws;
pub mod camera_point;
pub mod checks;
pub mod data;
pub mod depth_flip;
pub mod evaluation;
pub mod evidence;
pub mod faulty_kernels;
pub mod filter_calibration;
pub mod filter_priors;
pub mod finding;
pub mod frozen_tuning;
pub mod growth;
pub mod joint_distribution;
pub mod kernels;
pub mod linear_series;
pub mod missing_limbs;
pub mod mixture_filter;
pub mod outcome;
pub mod partitioned_laws;
pub mod planted_hmc;
pub mod posteriordb;
pub mod problem28;
pub mod quadrature;
pub mod recorded_motion;
pub mod resampling_laws;
pub mod sampler_invariance;
pub mod simulated_source;
pub mod simulators;
pub mod size;
pub mod static_posteriors;
pub mod stored;
pub mod walls;
