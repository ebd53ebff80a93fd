//! Tests that lack the shared data say so where it is seen, and fail where the data are required.

use sinew_tests::data::shared;
use std::process::{Command, Output};

/// Set for the runs of this program by itself.
const PROBE: &str = "SINEW_DATA_PROBE";

#[test]
fn a_test_on_data() {
    if std::env::var_os(PROBE).is_some() {
        let _ = shared("no/such/part");
    }
}

fn probe(required: &str) -> Output {
    let mut program = Command::new(std::env::current_exe().unwrap());
    program.args(["--exact", "missing_data::a_test_on_data", "--test-threads=2"]).env(PROBE, "1");
    program.env("SINEW_DATA", "/nowhere").env("SINEW_REQUIRE_DATA", required).output().unwrap()
}

#[test]
fn missing_data_are_seen_past_the_capture_of_tests_and_can_be_required() {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let skipped = probe("0");
    assert!(skipped.status.success());
    assert_eq!(text(&skipped.stderr), "skipped: no data (no/such/part): missing_data::a_test_on_data\n");
    assert!(!text(&skipped.stdout).contains("skipped"), "the harness captures what is printed");
    let required = probe("1");
    assert!(!required.status.success());
    assert!(
        text(&required.stdout).contains("no data: /nowhere/no/such/part is missing, and SINEW_REQUIRE_DATA is set")
    );
}
