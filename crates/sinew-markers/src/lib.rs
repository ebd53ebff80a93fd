//! Gaussian likelihoods of markers in normalised images (Choo & Fleet 2001), for studies and exact tests: no program of ours has markers as its input.

pub mod one_view;
pub mod several_views;
pub use one_view::{MarkerLikelihood, MarkerModel};
pub use several_views::{MarkerView, MarkerViewsLikelihood, MarkerViewsModel};
