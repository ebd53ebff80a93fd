//! Fuzzes the reader of `summary.json`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::program_checks::summary(data));
