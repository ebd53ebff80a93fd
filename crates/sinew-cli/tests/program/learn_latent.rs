//! `sinew learn latent`, what `inspect` makes of its model, and what the user reads about bad input.

use crate::common::walks::{learned, walks};
use crate::common::{Trial, files};
use std::fs;

const LEARN: [&str; 11] = [
    "learn",
    "latent",
    "--motion",
    "a.trc",
    "--body",
    "hppf24",
    "--steps",
    "40",
    "--no-progress",
    "-omodel.json",
    "--force",
];

fn learn(trial: &Trial, more: &[&str]) -> String {
    learned(trial, &LEARN, more)
}

#[test]
fn help_names_every_flag() {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let text = String::from_utf8(trial.run(&["learn", "latent", "-h"]).stdout).unwrap();
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    insta::assert_snapshot!("help", text);
}

#[test]
fn a_model_of_each_kind_is_learned_reported_inspected_and_drawn() {
    let trial = walks("2");
    for (kind, panels) in [("gpdm", 1), ("gplvm", 1), ("hgplvm", 8)] {
        let printed = learn(&trial, &["--model", kind, "--held-out", "b.trc"]);
        for words in
            ["motion ", "held out ", "rows ", "objective ", "there and back ", "degrees root mean square", "40 steps"]
        {
            assert!(printed.contains(words), "{words}\n{printed}");
        }
        let model = fs::read(trial.path("model.json")).unwrap();
        let json = learn(&trial, &["--model", kind, "--threads", "1", "--json"]);
        assert_eq!(fs::read(trial.path("model.json")).unwrap(), model, "{kind}, another number of threads");
        let json: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!((json["rows"].as_u64(), json["model"].as_str()), (Some(40), Some(kind)), "{json}");
        assert!(json["training_rms_deg"].as_f64().unwrap() < 3.0, "{json}");

        let inspected = trial.run(&["inspect", "model.json", "-o", "model.svg", "--force"]);
        let text = String::from_utf8_lossy(&inspected.stdout).into_owned();
        assert!(text.starts_with("model.json: latent model of poses\n"), "{text}\n{}", trial.printed(&inspected));
        assert!(text.contains(&format!("{kind}, ")) && text.contains("20 frames per second"), "{text}");
        let svg = fs::read_to_string(trial.path("model.svg")).unwrap();
        assert_eq!(svg.matches(": 3 coordinates").count() + svg.matches(": 2 coordinates").count(), panels, "{kind}");
    }
    assert_eq!(files(trial.folder.path()).len(), 4, "no file is left over");
}

/// Covariances of more rows than one thread takes at a time.
#[test]
fn a_model_of_many_rows_is_the_same_on_any_number_of_threads() {
    let trial = walks("2");
    let model = |threads: &str| {
        let more = ["--motion", "b.trc", "--fps", "60", "--balanced", "true", "--threads", threads];
        learn(&trial, &more);
        fs::read(trial.path("model.json")).unwrap()
    };
    let one = model("1");
    assert!(String::from_utf8_lossy(&one).contains("\"sequences\":[119,119]"));
    assert!(model("3") == one && model("4") == one);
}

#[test]
fn flags_change_the_model_and_idle_ones_are_named() {
    let trial = walks("2");
    let model = |more: &[&str]| {
        learn(&trial, more);
        fs::read(trial.path("model.json")).unwrap()
    };
    let plain = model(&[]);
    assert_eq!(model(&["--balanced", "true"]), plain);
    for more in [&["--balanced", "false"][..], &["--dim", "2"], &["--back"], &["--rows", "20"]] {
        assert_ne!(model(more), plain, "{more:?}");
    }
    let short = learn(&trial, &["--rows", "20", "--motion", "b.trc"]);
    assert!(short.contains("20 in 2 sequences, the middle of each; 80 in all"), "{short}");
    let idle = trial.run(&[&LEARN[..], &["--model", "hgplvm", "--back", "--balanced", "true"]].concat());
    insta::assert_snapshot!("idle_of_a_tree", trial.printed(&idle));
    let idle = trial.run(&[&LEARN[..], &["--model", "gplvm", "--root-per-motion", "--seed", "3"]].concat());
    insta::assert_snapshot!("idle_of_a_plain_model", trial.printed(&idle));
    let shown = trial.run(&[&LEARN[..8], &["-omodel.json", "--force"]].concat());
    let shown = String::from_utf8(shown.stderr).unwrap();
    assert!(shown.contains("learning: step 20, objective "), "{shown}");
    assert!(shown.contains("learning: 100 % (40 of 40 steps)"), "{shown}");
}

/// The report says how many coordinates each node has, whatever was requested, and the allowed steps are kept.
#[test]
fn the_report_says_what_was_learned() {
    let trial = walks("2");
    let learn =
        ["learn", "latent", "--motion", "a.trc", "--body", "hppf24", "--steps", "13", "--force", "-omodel.json"];
    let json = |more: &[&str]| -> serde_json::Value {
        serde_json::from_str(&learned(&trial, &learn, &[more, &["--json", "--no-progress"]].concat())).unwrap()
    };
    let tree = json(&["--model", "hgplvm", "--dim", "10"]);
    let dimensions: Vec<u64> = tree["dimensions"].as_array().unwrap().iter().map(|dim| dim.as_u64().unwrap()).collect();
    assert!(dimensions.len() == 8 && dimensions.iter().any(|&dim| dim < 10), "{dimensions:?}");
    assert_eq!(json(&["--model", "gpdm"])["steps"], 13);
}

/// Numbers that are no joints in metres, and poses that are all the same.
#[test]
fn impossible_and_still_motion_is_refused() {
    let trial = walks("2");
    let text = fs::read_to_string(trial.path("a.trc")).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let first = lines.iter().position(|line| line.starts_with("1\t")).unwrap();
    let cells = |line: &str| line.split('\t').map(str::to_owned).collect::<Vec<_>>();
    let changed = |change: &dyn Fn(usize, &mut Vec<String>)| {
        let row = |(n, line): (usize, &&str)| {
            let mut cells = cells(line);
            if n >= first {
                change(n, &mut cells);
            }
            cells.join("\t")
        };
        let rows: Vec<String> = lines.iter().enumerate().map(row).collect();
        fs::write(trial.path("a.trc"), rows.join("\n") + "\n").unwrap();
        trial.printed(&trial.run(&LEARN))
    };
    let far = changed(&|n, cells| {
        if n == first + 3 {
            cells[2] = "1e9".into();
        }
    });
    assert!(far.starts_with("exit 3") && far.contains("m on average") && far.contains("units"), "{far}");
    let pose = cells(lines[first]);
    let still = changed(&|_, cells| cells[2..].clone_from_slice(&pose[2..]));
    assert!(still.starts_with("exit 3") && still.contains("principal components of the motion: "), "{still}");
}

#[test]
fn unusable_motion_and_files_are_refused() {
    let trial = walks("2");
    let printed = |arguments: &[&str]| trial.printed(&trial.run(arguments));
    let with = |more: &[&str]| {
        printed(&[&["learn", "latent", "--motion", "a.trc", "--body", "hppf24", "--no-progress"], more].concat())
    };
    insta::assert_snapshot!("no_output", with(&[]));
    insta::assert_snapshot!("exists", with(&["-ob.trc"]));
    insta::assert_snapshot!("output_is_input", with(&["-oa.trc", "--force"]));
    insta::assert_snapshot!("unknown_kind", with(&["-om", "--model", "pca"]));
    insta::assert_snapshot!("no_coordinate", with(&["-om", "--dim", "0"]));
    insta::assert_snapshot!("few_rows", with(&["-om", "--rows", "3", "--motion", "b.trc"]));
    insta::assert_snapshot!("few_components", with(&["-om", "--rows", "4", "--dim", "10"]));
    assert!(!trial.path("m").exists() && !trial.path("model.json").exists());

    learn(&trial, &[]);
    let model = fs::read_to_string(trial.path("model.json")).unwrap();
    let inspected = |from: &str, to: &str| {
        assert!(model.contains(from), "{from}");
        fs::write(trial.path("model.json"), model.replacen(from, to, 1)).unwrap();
        printed(&["inspect", "model.json"])
    };
    insta::assert_snapshot!("other_version", inspected("\"version\":1", "\"version\":7"));
    insta::assert_snapshot!("broken_value", inspected("\"frame_rate\":20.0", "\"frame_rate\":-20.0"));
    insta::assert_snapshot!("other_kind", inspected("\"kind\":\"gpdm\"", "\"kind\":\"gplvm\""));
    insta::assert_snapshot!("cut_sequence", inspected("\"sequences\":[40]", "\"sequences\":[39,1]"));
}
