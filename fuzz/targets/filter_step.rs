//! Fuzzes a step of a filter on a scene that the bytes make.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::program_checks::filter_step(data));
