//! Fuzzes the reader of tables.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::tidy_csv(data));
