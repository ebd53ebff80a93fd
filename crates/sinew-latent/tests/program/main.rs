//! Tests of latent models, one file a subject.
//!
//! They are modules of one test program, which is linked once.

mod common;
mod files;
mod formulas;
mod inference;
mod mappings;
mod objectives;
mod optimiser;
mod scaled_conjugate_gradients;
mod sequences;
mod standard_problems;
