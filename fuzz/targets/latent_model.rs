//! Fuzzes the reader of latent models.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::program_checks::latent_model(data));
