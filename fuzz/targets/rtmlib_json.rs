//! Fuzzes the reader of stored results of RTMLib.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::rtmlib_json(data));
