//! Fuzzes the reader of the tables of a result folder.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::program_checks::result_tables(data));
