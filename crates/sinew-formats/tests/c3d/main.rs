//! C3D files of laboratories, of all processors, built by hand, damaged, and written by ourselves.

#[path = "../../../../tests/src/data.rs"]
mod shared_data;

mod built;
mod by_hand;
mod damaged;
mod number_places;
mod returned;
mod samples;
mod storage;
mod transcoded;
mod whole;
