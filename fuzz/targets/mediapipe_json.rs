//! Fuzzes the reader of landmarks of MediaPipe.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::mediapipe_json(data));
