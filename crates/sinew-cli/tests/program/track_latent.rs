//! `sinew track --latent`: what the user reads where the model is missing or is one of another body, rate or kind.

use crate::common::Trial;

/// A folder with a short recording, and a model of its walk.
fn recorded() -> Trial {
    let trial = Trial { folder: tempfile::tempdir().unwrap() };
    let made = ["simulate", "-o", "walk", "--duration", "1.5", "--cameras", "2", "--size", "64x64", "--images", "none"];
    let learn = ["learn", "latent", "--motion", "walk/truth.trc", "--body", "h32", "--steps", "20", "--fps", "30"];
    for command in [&made[..], &[&learn[..], &["-o", "space.json", "--dim", "2"]].concat()] {
        let output = trial.run(&[command, &["--no-progress"]].concat());
        assert!(output.status.success(), "{}", trial.printed(&output));
    }
    trial
}

fn tracked(trial: &Trial, more: &[&str]) -> (Option<i32>, String) {
    let track = ["track", "--calibration", "walk/Calib.toml", "--keypoints", "walk/keypoints", "--layout", "BODY_25B"];
    let output = trial.run(&[&track[..], &["-o", "out", "--force", "--no-progress"], more].concat());
    (output.status.code(), trial.printed(&output))
}

#[test]
fn latent_models_that_do_not_fit_are_refused_in_words() {
    let trial = recorded();
    let inspected = String::from_utf8(trial.run(&["inspect", "space.json"]).stdout).unwrap();
    assert!(
        inspected.contains("the first 6 coordinates of a state are not in it, nor the last 4, of the feet"),
        "{inspected}"
    );
    for (name, more) in [
        ("none", &["--fps", "30", "--method", "gpapf"][..]),
        ("another_body", &["--fps", "30", "--method", "gpapf", "--latent", "space.json", "--body", "cf28"]),
        ("another_rate", &["--fps", "60", "--method", "h-apf", "--latent", "space.json"]),
        ("without_feet", &["--fps", "30", "--method", "h-apf", "--latent", "space.json"]),
        ("smoothed", &["--fps", "30", "--latent", "space.json", "--smooth"]),
        ("no_model", &["--fps", "30", "--latent", "walk/truth.trc"]),
    ] {
        let (code, printed) = tracked(&trial, more);
        assert!(code.is_some_and(|code| code == 2 || code == 3), "{code:?} {printed}");
        insta::assert_snapshot!(name, printed);
    }
}

#[test]
fn a_latent_model_changes_nothing_with_other_methods_and_the_run_says_so() {
    let trial = recorded();
    let (_, printed) =
        tracked(&trial, &["--fps", "30", "--method", "bootstrap", "--particles", "50", "--latent", "space.json"]);
    assert!(printed.contains("`--latent` changes nothing with `--method bootstrap`"), "{printed}");
    let few = ["--fps", "30", "--latent", "space.json", "--prior", "mixture", "--frames", "0..4", "--updates", "4"];
    let (_, printed) = tracked(&trial, &[&few[..], &["--burn-in", "2"]].concat());
    assert!(printed.contains("`--prior` changes nothing with `--latent`"), "{printed}");
}

/// The column of `frames.csv`, and the median of `summary.json`.
#[test]
fn particles_off_the_manifold_are_counted_by_gpapf_alone() {
    let trial = recorded();
    for (method, counts) in [("gpapf", true), ("hmc", false)] {
        let short = ["--fps", "30", "--method", method, "--latent", "space.json", "--frames", "0..6"];
        let few = if counts { &["--particles", "20"][..] } else { &["--updates", "4", "--burn-in", "2"] };
        let (_, printed) = tracked(&trial, &[&short[..], few].concat());
        let rows = std::fs::read_to_string(trial.path("out/frames.csv")).expect(&printed);
        let cells = |row: &str| row.split(',').map(str::to_owned).collect::<Vec<_>>();
        let mut rows = rows.lines().map(cells);
        let column = rows.next().and_then(|names| names.iter().position(|name| name == "off_manifold")).unwrap();
        let shares: Vec<Option<f64>> = rows.map(|row| row[column].parse().ok()).collect();
        assert!(shares.len() > 3 && shares.iter().all(|share| share.is_some() == counts), "{method}: {shares:?}");
        assert!(shares.iter().flatten().all(|share| (0.0..=1.0).contains(share)), "{shares:?}");
        let summary = std::fs::read_to_string(trial.path("out/summary.json")).unwrap();
        let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
        assert_eq!(summary["diagnostics"]["off_manifold"].is_f64(), counts, "{method}");
    }
}

#[test]
fn a_model_without_dynamics_is_refused_by_searches() {
    let trial = recorded();
    let learn = ["learn", "latent", "--motion", "walk/truth.trc", "--body", "h32", "--steps", "5", "--fps", "30"];
    let learn = [&learn[..], &["--model", "gplvm", "-o", "poses.json", "--no-progress"]].concat();
    let output = trial.run(&learn);
    assert!(output.status.success(), "{}", trial.printed(&output));
    let (code, printed) = tracked(&trial, &["--fps", "30", "--method", "gpapf", "--latent", "poses.json"]);
    assert_eq!(code, Some(2), "{printed}");
    insta::assert_snapshot!("no_dynamics", printed);
}
