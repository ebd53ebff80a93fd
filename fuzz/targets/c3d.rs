//! Fuzzes the reader of C3D files.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::c3d(data));
