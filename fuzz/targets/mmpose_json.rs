//! Fuzzes the reader of predictions of MMPose.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::mmpose_json(data));
