//! Fuzzes the reader of `sinew.toml`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::program_checks::settings(data));
