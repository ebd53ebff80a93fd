//! `sinew report` and `track --report`: one page that does no harm, is small, and says what is missing.

use crate::common::{Trial, trial};
use sinew_report::page::{ReportRequest, page};
use std::fs;

fn printed(trial: &Trial, arguments: &[&str]) -> String {
    trial.printed(&trial.run(arguments))
}

#[test]
fn a_page_shows_a_result_without_harm_and_within_its_size() {
    let trial = trial(0.5);
    let tracked = trial.track(&["--report"]);
    assert!(tracked.status.success(), "{}", trial.printed(&tracked));
    let (out, html) = (trial.path("out"), trial.path("out/report.html"));
    let first = fs::read_to_string(&html).unwrap();
    for words in ["<!DOCTYPE html>", "C4", "medians of 90 % intervals", "id=\"payload\"", "Copyright © 2010"] {
        assert!(first.contains(words), "{words}");
    }
    assert!(!first.contains("{{") && !first.contains("src=\"http") && !first.contains("href=\"http"));
    let again = trial.run(&["report", "out", "--calibration=Calib.toml"]);
    assert!(String::from_utf8_lossy(&again.stdout).contains("out/report.html"), "{}", trial.printed(&again));
    assert!(fs::read_to_string(&html).unwrap() == first, "the same inputs give another page");

    // The calibration of the run is found by itself.
    let alone = trial.run(&["report", "out"]);
    assert!(alone.status.success(), "{}", trial.printed(&alone));
    assert!(fs::read_to_string(&html).unwrap() == first, "the page without --calibration is another");
    fs::write(&html, "mine").unwrap();
    insta::assert_snapshot!("not_over_another_page", printed(&trial, &["report", "out"]));
    insta::assert_snapshot!("track_not_over_another_page", trial.track_printed(&["--report"]));
    assert!(trial.run(&["report", "out", "--force"]).status.success());

    // Where all frames do not fit, some are left out, and the page says so.
    let request = ReportRequest { largest_bytes: first.len() - 5000, ..ReportRequest::default() };
    let small = page(&out, &request).unwrap();
    assert!(small.every > 1 && small.html.len() < first.len() - 5000, "{} {}", small.every, small.html.len());
    assert!(small.html.contains("would make this page too large"));

    // A camera with a name that is HTML, and a run that was interrupted.
    let name = "</script><b>";
    for file in ["setup.toml", "frames.csv", "summary.json"] {
        trial.edit(&out.join(file), |text| {
            text.replace("C1", name).replace("\"complete\": true", "\"complete\": false")
        });
    }
    let odd = page(&out, &ReportRequest::default()).unwrap().html;
    assert_eq!(odd.matches("</script>").count(), first.matches("</script>").count());
    assert!(odd.contains("&lt;/script&gt;&lt;b&gt;") && !odd.contains("<b>,"));
    assert!(odd.contains("The run was interrupted") && odd.contains("drawn as looking at the person"));

    // A run into the folder takes the page of the old results away.
    assert!(trial.track(&["--force"]).status.success());
    assert!(!html.exists());
    insta::assert_snapshot!("no_results", printed(&trial, &["report", "pose"]));
    insta::assert_snapshot!("no_folder", printed(&trial, &["report", "none"]));
    insta::assert_snapshot!("not_over_a_file", printed(&trial, &["report", "out", "-oCalib.toml"]));
    fs::remove_file(out.join("angles.csv")).unwrap();
    insta::assert_snapshot!("no_angles", printed(&trial, &["report", "out"]));
    trial.edit(&out.join("joints.csv"), |text| text.lines().take(9).collect::<Vec<_>>().join("\n"));
    insta::assert_snapshot!("other_joints", printed(&trial, &["report", "out"]));
    for file in ["summary.json", "frames.csv"] {
        fs::rename(out.join(file), out.join(format!("{file}.partial"))).unwrap();
    }
    insta::assert_snapshot!("stopped", printed(&trial, &["report", "out"]));
}
