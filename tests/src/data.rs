//! Where stored references are: the folder named by `SINEW_DATA`, or `../shared/data` beside the checkout.

use serde_json::Value;
use std::path::PathBuf;

/// A stored file by its path in the data folder; `None`, with a note, where there is none.
#[must_use]
pub fn stored(path: &str) -> Option<Value> {
    let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let folder = std::env::var_os("SINEW_DATA").map_or_else(beside, PathBuf::from);
    let Ok(text) = std::fs::read_to_string(folder.join(path)) else {
        println!("skipped: no data");
        return None;
    };
    Some(serde_json::from_str(&text).expect("valid JSON"))
}

/// A stored array of numbers.
#[must_use]
pub fn numbers(v: &Value) -> Vec<f64> {
    v.as_array().expect("array").iter().map(number).collect()
}

/// A stored number.
#[must_use]
pub fn number(v: &Value) -> f64 {
    v.as_f64().expect("number")
}
