//! Tests of the whole workspace, one file a subject.
//!
//! They are modules of one test program, which is linked with the whole library once.

mod annealed_and_partitioned;
mod bad_masks;
mod bent_limbs;
mod clocks_of_crowds;
mod colours;
mod corpus;
mod corpus_mutations;
mod coverage;
mod detector_mistakes;
mod exact_filters;
mod filters;
mod footage;
mod frame_streams;
mod fuzzed;
mod girth;
mod hmc;
mod identifiability;
mod invariance;
mod joint_and_calibrated;
mod kalman;
mod kernels_with_faults;
mod latent_seam;
mod missing_data;
mod missing_limbs;
mod oil_flow;
mod posteriordb;
mod random_trees;
mod real_recording;
mod recorded_scenes;
mod references;
mod resampling;
mod robustness;
mod setup_real;
mod setup_rigs;
mod setup_synthetic;
mod silhouettes_real;
mod symmetry;
mod toy_method;
