//! Fuzzes the reader of mappings of points.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::point_mapping(data));
