//! Fuzzes the reader of body files.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::body_toml(data));
