//! Fuzzes the reader of names of files and cameras.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::file_names(data));
