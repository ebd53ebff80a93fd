//! The shared recordings and references, and what tests say that lack them.
//!
//! They lie in the folder named by `SINEW_DATA`, or in `../shared/data` beside the checkout. A test without them is skipped and says so on the terminal, past the capture of
//! the test harness; with `SINEW_REQUIRE_DATA=1` it fails.
//!
//! Only the standard library is used, so that test programs of other crates can include this file.

use std::io::Write as _;
use std::path::{Path, PathBuf};

/// A folder or file of the shared data; `None` where it is not there.
///
/// # Panics
/// With `SINEW_REQUIRE_DATA=1` where it is not there.
#[must_use]
pub fn shared(part: &str) -> Option<PathBuf> {
    let path = folder().join(part);
    if path.exists() {
        return Some(path);
    }
    let is_required = std::env::var("SINEW_REQUIRE_DATA").is_ok_and(|value| value == "1");
    assert!(!is_required, "no data: {} is missing, and SINEW_REQUIRE_DATA is set", path.display());
    skipped(&format!("no data ({part})"));
    None
}

/// Says on the terminal that the present test is skipped.
pub fn skipped(why: &str) {
    // For programs that read the captured output.
    println!("skipped: {why}");
    let thread = std::thread::current();
    // What is printed by macros is captured where a test passes; what is written to the stream is not.
    let _ = writeln!(std::io::stderr(), "skipped: {why}: {}", thread.name().unwrap_or("a test"));
}

/// Where shared data are sought.
#[must_use]
pub fn folder() -> PathBuf {
    let checkout = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().find(|folder| folder.join("Cargo.lock").exists());
    let beside = || checkout.unwrap_or(Path::new("..")).join("../shared/data");
    std::env::var_os("SINEW_DATA").map_or_else(beside, PathBuf::from)
}
