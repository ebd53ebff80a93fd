//! Fuzzes the reader of lines of a live run.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::live_frame(data));
