//! Fuzzes the reader of models of OpenSim.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::checks::osim_model(data));
