//! Fuzzes the reader of MOT files.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::mot(data));
