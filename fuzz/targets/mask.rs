//! Fuzzes the reader of masks.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::mask(data));
