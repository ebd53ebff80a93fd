//! Fuzzes the reader of calibrations.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::calib_toml(data));
