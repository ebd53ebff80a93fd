//! Fuzzes the reader of Caliscope's tables of keypoints.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::caliscope_xy(data));
