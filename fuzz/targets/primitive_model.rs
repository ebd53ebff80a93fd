//! Fuzzes the reader of motion models.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::program_checks::primitive_model(data));
