//! What the user reads about settings: mistakes in files, flags and variables; and where values come from.

use crate::common::trial;
use sinew::config::setting::SettingKind;
use sinew::config::table::settings;
use std::fs;

fn check_file(name: &str, text: &str) {
    let trial = trial(0.1);
    fs::write(trial.path("sinew.toml"), text).unwrap();
    let output = trial.run(&["track", "--calibration", "Calib.toml", "--keypoints", "pose"]);
    insta::assert_snapshot!(name, trial.printed(&output));
    assert!(!trial.path("sinew-out").exists());
}

#[test]
fn mistakes_in_a_file() {
    check_file("unknown_key", "paticles = 10\n");
    check_file("duplicate_key", "seed = 1\nfps = 30\nseed = 2\n");
    check_file("three_problems", "particles = 0\nfps = -1.0\nmethod = \"nuts\"\n");
    check_file("not_a_number", "fps = nan\nmax_r_hat = 1e999\n");
    check_file("no_toml", "seed = = 1\n");
    check_file("a_table", "[track]\nseed = 1\n");
    check_file("burn_in", "burn_in = 400\n");
    check_file("nested", &format!("cameras = {}", "[".repeat(100_000)));
}

#[test]
fn a_file_that_is_no_text() {
    let trial = trial(0.1);
    fs::write(trial.path("sinew.toml"), b"seed = 1\nmethod = \"\xE9\"\n").unwrap();
    let output = trial.run(&["track", "--calibration", "Calib.toml", "--keypoints", "pose"]);
    insta::assert_snapshot!("no_text", trial.printed(&output));
}

#[test]
fn an_output_folder_that_is_a_file() {
    let trial = trial(0.1);
    fs::write(trial.path("out"), "").unwrap();
    let output = trial.run(&["track", "--calibration", "Calib.toml", "--keypoints", "pose", "-oout", "--force"]);
    insta::assert_snapshot!("out_is_a_file", trial.printed(&output));
}

#[test]
fn mistakes_on_the_command_line() {
    let trial = trial(0.1);
    let printed = |arguments: &[&str]| trial.printed(&trial.run(arguments));
    insta::assert_snapshot!("bad_flags", printed(&["track", "--method", "hcm", "--frames", "9..3", "--seed", "-1"]));
    insta::assert_snapshot!("too_large", printed(&["track", "--seed", "99999999999999999999", "--threads", "2000"]));
    for (name, arguments) in [
        ("no_use_in_body", &["body", "h32", "-o", "x"][..]),
        ("no_use_in_inspect", &["inspect", "Calib.toml", "--seed", "3"]),
        ("no_use_in_convert", &["convert", "a.trc", "b.csv", "--threads", "2"]),
        ("no_use_in_man", &["man", "--json"]),
        ("before_the_command", &["--seed=3", "track"]),
        ("no_use_before_the_command", &["--chains=8", "track"]),
        ("no_use_without_keypoints", &["inspect", "Calib.toml", "--cameras", "C1"]),
    ] {
        insta::assert_snapshot!(name, printed(arguments));
    }
    insta::assert_snapshot!("unknown_flag", printed(&["track", "--keypoint", "pose"]));
    insta::assert_snapshot!("unknown_command", printed(&["trac"]));
    insta::assert_snapshot!("no_such_config", printed(&["track", "--config", "none.toml"]));
    insta::assert_snapshot!("unknown_body", printed(&["body", "h33"]));
    insta::assert_snapshot!("no_input", printed(&["track"]));
}

#[test]
fn flags_that_change_nothing() {
    let trial = trial(0.1);
    let printed = |flags: &[&str]| trial.printed(&trial.run(&[&["track", "--print-config"], flags].concat()));
    insta::assert_snapshot!(
        "idle_with_hmc",
        printed(&["--particles=5", "--degrees=3", "--setup=a.toml", "--setup-frames=0..9"])
    );
    insta::assert_snapshot!(
        "idle_with_bootstrap",
        printed(&[
            "--method=bootstrap",
            "--chains=8",
            "--updates=5",
            "--prior=mixture",
            "--noise=student-t",
            "--outlier=0.1"
        ])
    );
    // Methods with gradients compare masks by their contours alone.
    let looks = ["--keypoints=pose", "--silhouettes=masks", "--images=images", "--score=parts", "--kappa=50"];
    insta::assert_snapshot!("idle_beside_contours", printed(&looks));
}

#[test]
fn mistakes_in_the_environment() {
    let trial = trial(0.1);
    let output = trial.command(&["track"]).env("SINEW_CHAINS", "none").output().unwrap();
    insta::assert_snapshot!("bad_variable", trial.printed(&output));
    let output = trial.command(&["track", "--print-config"]).env("SINEW_CHAIN", "8").output().unwrap();
    insta::assert_snapshot!("unknown_variable", trial.printed(&output));
}

#[test]
fn values_show_their_origin() {
    let trial = trial(0.1);
    fs::write(trial.path("sinew.toml"), "root = true\nfps = 50\nchains = 24\nkeypoints = \"pose\"\n").unwrap();
    let output = trial
        .command(&["track", "--print-config", "--seed", "5", "-o", "x"])
        .env("SINEW_CHAINS", "8")
        .output()
        .unwrap();
    let text = String::from_utf8(output.stdout).unwrap().replace(&trial.folder.path().display().to_string(), "[trial]");
    let text: Vec<&str> = text.lines().map(|line| line.split("  # ").last().map_or(line, |_| line)).collect();
    let shown: Vec<String> = text.iter().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect();
    insta::assert_snapshot!("origins", shown.join("\n"));
}

#[test]
fn help_fits_one_screen_and_starts_with_examples() {
    let trial = trial(0.1);
    for command in [
        "",
        "demo",
        "inspect",
        "track",
        "simulate",
        "convert",
        "segment",
        "overlay",
        "report",
        "sync",
        "gait",
        "compare",
        "fit-shape",
        "body",
        "completions",
        "man",
    ] {
        let arguments: Vec<&str> = [command, "-h"].into_iter().filter(|word| !word.is_empty()).collect();
        let text = String::from_utf8(trial.run(&arguments).stdout).unwrap();
        assert!(text.lines().count() <= 44, "{command}: {} lines", text.lines().count());
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{command}");
        let examples = text.find("Examples:").unwrap();
        assert!(text[examples..].lines().skip(1).take(2).all(|line| line.starts_with("  sinew ")), "{command}");
        let name = if command.is_empty() { "sinew" } else { command };
        insta::assert_snapshot!(format!("help_{name}"), text);
    }
    for setting in settings() {
        let SettingKind::Choice(values) = setting.kind else { continue };
        let flag = format!("--{}", setting.key.replace('_', "-"));
        let help = String::from_utf8(trial.run(&["track", "--help"]).stdout).unwrap();
        let flag_help = help.split(&format!("      {flag} ")).nth(1).unwrap_or_default().split("\n\n").next().unwrap();
        // As they are typed, and offered as they are typed.
        assert!(values.iter().all(|value| flag_help.contains(value)), "{flag}: {flag_help}");
        let bash = String::from_utf8(trial.run(&["completions", "bash"]).stdout).unwrap();
        // Other commands may have a flag of that name.
        let case = format!("                {flag})\n");
        let mut offered = bash.split(&case).skip(1).filter_map(|part| part.lines().next());
        assert!(offered.any(|line| line.contains(&format!("compgen -W \"{}\"", values.join(" ")))), "{flag}");
    }
    for shell in ["bash", "zsh", "fish", "powershell"] {
        assert!(!trial.run(&["completions", shell]).stdout.is_empty());
    }
    assert!(String::from_utf8(trial.run(&["man"]).stdout).unwrap().contains("confidence\\-scale"));
}
