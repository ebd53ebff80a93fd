//! Fuzzes the reader of TRC files.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::trc(data));
