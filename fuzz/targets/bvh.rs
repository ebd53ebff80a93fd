//! Fuzzes the reader of BVH files.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::bvh(data));
