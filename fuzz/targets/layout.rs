//! Fuzzes the reader of layout mapping files.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::layout(data));
