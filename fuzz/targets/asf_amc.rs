//! Fuzzes the reader of ASF skeletons and AMC motions.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::asf_amc(data));
