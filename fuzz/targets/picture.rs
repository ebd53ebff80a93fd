//! Fuzzes the reader of pictures.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::picture(data));
