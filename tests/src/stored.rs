//! Stored references: files of the shared data in JSON.

use crate::data::shared;
use serde_json::Value;

/// A stored file by its path in the data folder; `None`, with a note, where there is none.
#[must_use]
pub fn stored(path: &str) -> Option<Value> {
    let text = std::fs::read_to_string(shared(path)?).expect("readable data");
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
