//! Fuzzes the readers of calibrations, which are recognised by content.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::calibration(data));
