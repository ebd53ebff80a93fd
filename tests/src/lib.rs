//! Unpublished: exact references and statistical checks of the workspace, as functions of a seed and a size. The tests in this member's `tests/` folder call them in reduced size; statistical, conformance and
//! end-to-end tests live there too.

pub mod camera_point;
pub mod data;
pub mod depth_flip;
pub mod evidence;
pub mod filter_priors;
pub mod finding;
pub mod full_size;
pub mod growth;
pub mod kept_targets;
pub mod linear_series;
pub mod mixture_filter;
pub mod posteriordb;
pub mod quadrature;
pub mod resample_counts;
pub mod static_posteriors;
pub mod two_samples;
