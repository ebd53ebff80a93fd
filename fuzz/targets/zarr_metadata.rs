//! Fuzzes the reader of the metadata of `posterior.zarr`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| sinew_fuzz::program_checks::zarr_metadata(data));
