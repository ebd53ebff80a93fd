//! Fuzzes the reader of COCO results and AlphaPose files.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::coco_results(data));
