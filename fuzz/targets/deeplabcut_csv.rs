//! Fuzzes the reader of DeepLabCut's tables.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::deeplabcut_csv(data));
