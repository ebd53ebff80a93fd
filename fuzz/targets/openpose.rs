//! Fuzzes the reader of OpenPose-style keypoint files.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::openpose(data));
