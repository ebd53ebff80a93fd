//! Fuzzes the reader of `setup.toml`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::program_checks::setup(data));
